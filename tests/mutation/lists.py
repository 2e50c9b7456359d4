#!/usr/bin/python3
"""Every line of equivalent.txt, open.txt and known.txt names a line that is in its file. What `./rig check mutate` finds in minutes of building, a
change of code is told at once.

usage: lists.py PROJECT
"""
import pathlib
import sys

LISTS = ("equivalent.txt", "open.txt", "known.txt")


def problems(root):
    for name in LISTS:
        for number, entry in enumerate((root / "tests/mutation" / name).read_text().splitlines(), 1):
            if not entry.strip() or entry.startswith("#"):
                continue
            file, _, rest = entry.partition(" | ")
            source = root / file
            lines = {line.strip() for line in source.read_text().splitlines()} if source.is_file() else set()
            # Each of LINE | CHANGE | REASON may have " | " in it, so the longest text that is a line is looked for.
            if not any(rest.startswith(f"{line} | ") for line in lines if line):
                yield f"tests/mutation/{name}:{number}: {file} has no such line: take it out, or copy it anew from what `./rig check mutate` leaves"


if __name__ == "__main__":
    found = list(problems(pathlib.Path(sys.argv[1])))
    print("\n".join(found) or "every listed mutant is of a line that is there")
    sys.exit(1 if found else 0)
