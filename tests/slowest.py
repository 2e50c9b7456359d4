#!/usr/bin/python3
"""The twenty tests and the twenty compile units that took longest when they last ran; `./rig test --slowest`.

usage: slowest.py BUILD_DIR
"""
import pathlib
import re
import sys

COUNT = 20


def units(log):
    """{object file: seconds of its last compilation}, from ninja's own log: start and end in ms, time stamp, output, hash."""
    rows = [line.split("\t") for line in log.read_text().splitlines() if not line.startswith("#")]
    return {output: (int(end) - int(start)) / 1000 for start, end, _, output, *_ in rows if output.endswith((".o", ".gch"))}


def tests(log):
    return {name: float(seconds) for name, seconds in re.findall(r"Test +#\d+: (\S+) .* (\d+\.\d+) sec", log.read_text())}


def table(title, times):
    print(f"{title}: {len(times)}, {sum(times.values()):.0f} s one after the other")
    for name, seconds in sorted(times.items(), key=lambda item: -item[1])[:COUNT]:
        print(f"{seconds:8.1f} s  {name}")


def main():
    build = pathlib.Path(sys.argv[1])
    logs = {"Compile units": (build / ".ninja_log", units), "Tests": (build / "ctest.txt", tests)}
    for title, (log, read) in logs.items():
        if not log.exists():
            sys.exit(f"slowest: there is no {log}; run ./rig test first")
        table(title, read(log))
    return 0


if __name__ == "__main__":
    sys.exit(main())
