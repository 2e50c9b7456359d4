#!/usr/bin/python3
"""Every file compiles by itself, so that it includes what it uses: the builds take each target as one translation unit, and would not notice.

usage: lint_alone.py BUILD_DIR     an ordinary build is configured in BUILD_DIR/alone
"""
import concurrent.futures
import json
import os
import pathlib
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


def compile_alone(entry):
    """What the compiler says."""
    words = shlex.split(entry["command"])
    target = words.index("-o")
    run = subprocess.run([*words[:target], *words[target + 2:], "-fsyntax-only"], cwd=entry["directory"], capture_output=True, text=True, check=False)
    return run.stderr if run.returncode else ""


def main():
    build = pathlib.Path(sys.argv[1]).resolve() / "alone"
    subprocess.run(["cmake", "-S", ROOT, "-B", build, "-G", "Ninja"], stdout=subprocess.DEVNULL, check=True)
    entries = [entry for entry in json.loads((build / "compile_commands.json").read_text())
               if not pathlib.Path(entry["file"]).is_relative_to(build)]
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        complaints = [said for said in pool.map(compile_alone, entries) if said]
    print(*complaints, f"{len(entries)} files, {len(complaints)} do not compile by themselves", sep="\n")
    return 0 if entries and not complaints else 1


if __name__ == "__main__":
    sys.exit(main())
