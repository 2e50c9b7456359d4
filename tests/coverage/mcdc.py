#!/usr/bin/python3
"""MC/DC of firmware/control and firmware/can by the tests labelled `coverage`: has each condition of each decision been shown to change the
outcome by itself?

  ./rig check mcdc                         a table on the screen
  ./rig check mcdc --json out/mcdc.json    the same as JSON

Exit status 0; 1 if a test failed, a condition was not shown, or && or || stands in a line of which clang made no decision

A decision is what clang takes for one: conditions joined by && and ||. One condition alone is a branch: ./rig build coverage counts those. In a
template, and in what several units inline, a condition counts once, shown if any of them shows it.
"""
import argparse
import collections
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
ROOMS = ("firmware/control/", "firmware/can/")


def programs(build):
    listed = subprocess.run(["ctest", "--show-only=json-v1", "-L", "coverage"], cwd=build, capture_output=True, text=True, check=True)
    return sorted({test["command"][0] for test in json.loads(listed.stdout)["tests"]})


def run_tests(build):
    """The merged counts of all tests; None if one failed."""
    counts = build / "profile"
    shutil.rmtree(counts, ignore_errors=True)
    counts.mkdir()
    environment = dict(os.environ, LLVM_PROFILE_FILE=str(counts / "%p.profraw"))
    run = subprocess.run(["ctest", "-L", "coverage", "-j", str(len(os.sched_getaffinity(0))), "--output-on-failure"], cwd=build, env=environment,
                         check=False)
    if run.returncode:
        return None
    merged = build / "merged.profdata"
    subprocess.run(["llvm-profdata-19", "merge", "-sparse", "-o", merged, *sorted(counts.glob("*.profraw"))], check=True)
    return merged


def records(build, merged):
    """(file, line, column) of a decision -> (its last line, whether each of its conditions was shown)."""
    first, *others = programs(build)
    objects = [word for other in others for word in ("-object", other)]
    export = subprocess.run(["llvm-cov-19", "export", "-instr-profile", merged, first, *objects], capture_output=True, text=True, check=True)
    decisions = {}
    for function in json.loads(export.stdout)["data"][0]["functions"]:
        for line, column, end_line, _, file_id, _, shown in function["mcdc_records"]:
            path = pathlib.Path(function["filenames"][file_id])
            name = str(path.relative_to(ROOT)) if path.is_relative_to(ROOT) else ""
            if not name.startswith(ROOMS):
                continue
            place = (name, line, column)
            before = decisions.get(place, (end_line, [False] * len(shown)))
            decisions[place] = (end_line, [a or b for a, b in zip(before[1], shown)])
    return decisions


def not_counted(decisions):
    """Lines with && or || that belong to no decision: clang leaves out an expression that it cannot follow."""
    counted = collections.defaultdict(set)
    for (name, line, _), (end_line, _) in decisions.items():
        counted[name].update(range(line, end_line + 1))
    for room in ROOMS:
        for path in sorted((ROOT / room).glob("*.[ch]pp")):
            name = str(path.relative_to(ROOT))
            for number, line in enumerate(path.read_text().splitlines(), 1):
                if re.search(r"\|\|| && ", line.split("//")[0]) and number not in counted[name]:
                    yield f"{name}:{number}: no decision: {line.strip()}"


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("--json", type=pathlib.Path)
    given = options.parse_args()
    build = ROOT / "build/mcdc"

    merged = run_tests(build)
    if merged is None:
        return 1
    decisions = records(build, merged)
    rooms = {room.rstrip("/"): {"decisions": 0, "conditions": 0, "shown": 0} for room in ROOMS}
    wrong = list(not_counted(decisions))
    for (name, line, _), (_, shown) in sorted(decisions.items()):
        count = rooms[str(pathlib.Path(name).parent)]
        count["decisions"] += 1
        count["conditions"] += len(shown)
        count["shown"] += sum(shown)
        wrong += [f"{name}:{line}: condition {number} is not shown to decide by itself" for number, was_shown in enumerate(shown, 1) if not was_shown]
    print(f"{'':20}{'decisions':>10}{'conditions':>12}{'shown':>8}")
    for room, count in rooms.items():
        print(f"{room:20}{count['decisions']:>10}{count['conditions']:>12}{count['shown']:>8}")
    for text in wrong:
        print(text)
    if given.json:
        given.json.write_text(json.dumps({"rooms": rooms, "wrong": wrong}, indent=2) + "\n")
    empty = [room for room, count in rooms.items() if not count["decisions"]]
    return 1 if wrong or empty else 0


if __name__ == "__main__":
    sys.exit(main())
