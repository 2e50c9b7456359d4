#!/usr/bin/python3
"""clang-tidy over the project's own files, on all cores.

What a target compiles is analysed as one translation unit, and so are all tests of a folder: most of the time would go into the headers, again
for every file. A unit that was clean is not analysed again until something changes that the result depends on: the text of its files or of
anything they include, how they are compiled, the checks in force for them, or clang-tidy itself. The evidence is an empty file of that hash in the
user's cache directory; it does not depend on where the project lies, so that another clone finds it too.

A build of its own is configured in BUILD_DIR/UnifiedSource. With --one-in N the analyser follows paths in one unit in N, drawn by the commit
(drawn.py); it is three quarters of the time. All other checks look at every unit.
"""

import argparse
import collections
import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import typing

from drawn import drawn

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Follows no calls into templates: all but a few are the libraries', and on their paths the analyser spends its budget for a function before it has
# seen the rest of it. Without them it reaches more of the project's own code (rig_bridge/bridge: 53 of 57 functions to the end, 40 of 60 with them).
ANALYSER = [f"--extra-arg={word}" for word in ("-Xclang", "-analyzer-config", "-Xclang", "c++-template-inlining=false")]
CHECKS = "--checks=-bugprone-suspicious-include,antiskid-own-code"  # a unit includes sources
INCLUDE = re.compile(r'^#include "(.+)"$', re.MULTILINE)


class Unit(typing.NamedTuple):
    """Sources that one file includes."""
    file: pathlib.Path
    flags: list
    sources: list


@functools.cache
def digest(path):
    # A unity file names its sources by their whole path.
    return hashlib.sha256(pathlib.Path(path).read_bytes().replace(bytes(ROOT), b".")).hexdigest()


def output_of(command, **more):
    return subprocess.run(command, capture_output=True, text=True, check=True, **more).stdout


def configure(build):
    """The units, by the compile commands of a unity build that is configured anew; beside their files the checks of the folders that they stand for."""
    output_of(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
               "-DCMAKE_UNITY_BUILD=ON", "-DCMAKE_UNITY_BUILD_BATCH_SIZE=0"])
    together = collections.defaultdict(list)  # a unit's file: entries
    folders = set()
    for entry in json.loads((build / "compile_commands.json").read_text()):
        if sources(entry):
            folder = pathlib.Path(sources(entry)[0]).parent.relative_to(ROOT)
            folders |= {folder, *folder.parents}
            together[folder / "tests.cpp" if folder.parts[0] == "tests" else object_file(entry) + ".cpp"].append(entry)
    for folder in folders:
        (build / folder).mkdir(parents=True, exist_ok=True)
        (build / folder / ".clang-tidy").unlink(missing_ok=True)
        if (ROOT / folder / ".clang-tidy").exists():
            shutil.copy(ROOT / folder / ".clang-tidy", build / folder)
    return [unit(build / file, entries) for file, entries in together.items()]


def object_file(entry):
    return re.search(r" -o (\S+)", entry["command"])[1]


def sources(entry):
    """The project's own files of a translation unit; none if CMake generated it otherwise."""
    file = pathlib.Path(entry["file"])
    if file.parent.name == "Unity":
        return INCLUDE.findall(file.read_text())
    return [] if pathlib.Path(entry["directory"]) in file.parents else [str(file)]


def unit(file, entries):
    file.parent.mkdir(parents=True, exist_ok=True)
    files = list(dict.fromkeys(source for entry in entries for source in sources(entry)))
    file.write_text("".join(f'#include "{source}"\n' for source in files))
    flags = {}  # in order, each once
    for entry in entries:
        command = entry["command"].replace("-isystem ", "-isystem")
        flags |= dict.fromkeys(shlex.split(command[:command.index(" -o ")])[1:])
    return Unit(file, list(flags), files)


def included_files(unit):
    """The source and everything it includes, system headers too, as the compiler sees it."""
    rule = output_of(["c++", *unit.flags, "-M", unit.file])
    return sorted({os.path.realpath(word) for word in rule.split(":", 1)[1].replace("\\\n", " ").split()})


def plugin_of(tool, folder):
    """The plugin that keeps the checks out of system headers, for the clang-tidy that is installed; compiled once."""
    plugin = folder / f"own_code_{hashlib.sha256(tool.encode()).hexdigest()}.so"
    if not plugin.exists():
        clang = pathlib.Path(shutil.which("clang-tidy")).resolve().parents[1]
        made = folder / f"own_code_{os.getpid()}.so"
        output_of([clang / "bin/clang++", "-std=c++17", "-O1", "-fPIC", "-fno-rtti", "-shared", "-isystem", clang / "include",
                   ROOT / "tests/front_door/lint_own_code.cpp", "-o", made])
        made.rename(plugin)
    return plugin


def check(unit, evidence, tool, plugin, follows_paths):
    """Returns (what clang-tidy complained about or None, whether it was known to be clean)."""
    def evidence_of(checks):
        return evidence / hashlib.sha256("\n".join([checks, *parts]).replace(str(ROOT), ".").encode()).hexdigest()

    try:
        parts = [tool, *ANALYSER, *unit.flags, output_of(["clang-tidy", "--dump-config", unit.file, "--"]),
                 *(f"{path} {digest(path)}" for path in included_files(unit))]
    except subprocess.CalledProcessError as failure:
        return failure.stderr, False
    checks = CHECKS if follows_paths else CHECKS + ",-clang-analyzer-*"
    if evidence_of(CHECKS).exists() or evidence_of(checks).exists():
        return None, True
    run = subprocess.run(["clang-tidy", "--quiet", "--load", plugin, *ANALYSER, checks, unit.file, "--", *unit.flags],
                         capture_output=True, text=True, check=False)
    if run.returncode != 0:
        return run.stdout + run.stderr, False
    evidence_of(checks).touch()
    return None, False


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("build", type=pathlib.Path, metavar="BUILD_DIR")
    parser.add_argument("--one-in", type=int, default=1, metavar="N")
    arguments = parser.parse_args()
    pinned = subprocess.run([ROOT / "tests/front_door/lint_pinned.sh", "clang-tidy"], check=False)
    if pinned.returncode != 0:
        return pinned.returncode
    # clang's analyzer follows paths in included sources only where the including file's name has this in it (isInCodeFile).
    build = arguments.build.resolve() / "UnifiedSource"
    cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    evidence = pathlib.Path(cache) / "antiskid/clang-tidy"
    evidence.mkdir(parents=True, exist_ok=True)
    units = configure(build)
    if not units:
        sys.exit(f"{build}/compile_commands.json names no file of {ROOT}")
    units.sort(key=lambda unit: -len(unit.sources))  # the longest must not come last
    tool = output_of(["clang-tidy", "--version"]) + digest(ROOT / "tests/front_door/lint_own_code.cpp")
    plugin = plugin_of(tool, evidence)
    followed = drawn({str(unit.file.relative_to(build)) for unit in units}, arguments.one_in)
    complaints = known = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        jobs = [pool.submit(check, unit, evidence, tool, plugin, str(unit.file.relative_to(build)) in followed) for unit in units]
        for job in concurrent.futures.as_completed(jobs):
            complaint, was_known = job.result()
            known += was_known
            if complaint is not None:
                complaints += 1
                print(complaint, flush=True)
    files = sum(len(unit.sources) for unit in units)
    print(f"{files} files in {len(units)} units: {known} unchanged since they were clean, paths followed in {len(followed)}, "
          f"{complaints} with complaints")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
