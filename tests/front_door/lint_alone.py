#!/usr/bin/python3
"""Every file compiles by itself, so that it includes what it uses: the builds take each target as one translation unit, and would not notice.

A target's only file is alone there, too, and not compiled again, but for the benchmarks, which no other check compiles. Bodies of functions in system headers are left out (lint_own_bodies.cpp), and the
test framework's header, a third of the time of a test, is compiled once for all tests: every test includes it, and nothing but them.

An ordinary build is configured in BUILD_DIR/alone. With --one-in N one file in N is compiled, drawn by the commit (drawn.py).
"""
import argparse
import collections
import concurrent.futures
import json
import os
import pathlib
import shlex
import shutil
import subprocess
import sys

from drawn import drawn

ROOT = pathlib.Path(__file__).resolve().parents[2]
FRAMEWORK = ROOT / "tests/catch.hpp"


def compile_plugin(build):
    """clang, and how it loads the plugin that leaves out the bodies of functions in system headers."""
    clang = pathlib.Path(shutil.which("clang-tidy")).resolve().parents[1]
    plugin = build / "own_bodies.so"
    subprocess.run([clang / "bin/clang++", "-std=c++17", "-O1", "-fPIC", "-fno-rtti", "-shared", "-isystem", clang / "include",
                    ROOT / "tests/front_door/lint_own_bodies.cpp", "-o", plugin], check=True)
    return clang / "bin/clang++", f"-fplugin={plugin}"


def options_of(entry):
    """The compiler's options, without the file that it compiles and the one that it writes."""
    words = shlex.split(entry["command"])[1:]
    target = words.index("-o")
    return [word for word in words[:target] + words[target + 2:] if word not in ("-c", entry["file"])]


def precompile_framework(clang, entry, folder):
    """What a test's options take besides."""
    header = folder / "framework.hpp"
    header.write_text(f'#include "{FRAMEWORK}"\n')
    subprocess.run([*clang, *options_of(entry), "-x", "c++-header", header, "-o", f"{header}.pch"], cwd=entry["directory"], check=True)
    return ["-include-pch", f"{header}.pch"]


def compile_alone(clang, entry, more):
    """What the compiler says."""
    command = [*clang, *options_of(entry), *more, "-fsyntax-only", entry["file"]]
    run = subprocess.run(command, cwd=entry["directory"], capture_output=True, text=True, check=False)
    return run.stderr if run.returncode else ""


def target_of(entry):
    """The folder of its target's object files."""
    words = shlex.split(entry["command"])
    return words[words.index("-o") + 1].split(".dir/")[0]


def name_of(entry):
    """The file's, wherever the project lies."""
    return os.path.relpath(entry["file"], ROOT)


def is_test(entry):
    return '#include "tests/catch.hpp"' in pathlib.Path(entry["file"]).read_text()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, metavar="BUILD_DIR")
    parser.add_argument("--one-in", type=int, default=1, metavar="N")
    arguments = parser.parse_args()
    build = arguments.build.resolve() / "alone"
    build.mkdir(parents=True, exist_ok=True)
    clang = compile_plugin(build)
    subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", f"-DCMAKE_CXX_COMPILER={clang[0]}", "-DANTISKID_BENCH=ON"],
                   stdout=subprocess.DEVNULL, check=True)
    everything = [entry for entry in json.loads((build / "compile_commands.json").read_text())
                  if not pathlib.Path(entry["file"]).is_relative_to(build)]
    files = collections.Counter(map(target_of, everything))
    alone = [entry for entry in everything if files[target_of(entry)] > 1 or "/plant_sim/bench/" in entry["file"]]
    chosen = drawn({name_of(entry) for entry in alone}, arguments.one_in)
    entries = [entry for entry in alone if name_of(entry) in chosen]
    test = next(filter(is_test, entries), None)
    framework = precompile_framework(clang, test, build) if test else []
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        said = pool.map(lambda entry: compile_alone(clang, entry, framework if is_test(entry) else []), entries)
        complaints = [complaint for complaint in said if complaint]
    print(*complaints, f"{len(entries)} files of {len(alone)}, {len(complaints)} do not compile by themselves", sep="\n")
    return 0 if entries and not complaints else 1


if __name__ == "__main__":
    sys.exit(main())
