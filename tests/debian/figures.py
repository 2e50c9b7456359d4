#!/usr/bin/python3
"""What one run of `./rig check debian` gave: a table on standard output, the same as JSON. The bytes of its stop have to be those of every other
compiler of the same release whose figures lie beside the JSON and are of the same tree; another release has another C library.

Exit status 0; 1 if no test was run, one failed, one was skipped without saying why, or the bytes differ.
"""
import argparse
import hashlib
import json
import os
import pathlib
import sys
import xml.etree.ElementTree


def digest(folder):
    """Of the names and bytes of all files in a folder."""
    files = sorted(path for path in pathlib.Path(folder).rglob("*") if path.is_file())
    if not files:
        sys.exit(f"figures: no file in {folder}")
    lines = (f"{path.relative_to(folder)} {hashlib.sha256(path.read_bytes()).hexdigest()}\n" for path in files)
    return hashlib.sha256("".join(lines).encode()).hexdigest()


def outcomes(junit):
    """(names that passed, names that failed, {name that was skipped: the reason it printed})."""
    passed, failed, skipped = [], [], {}
    for case in xml.etree.ElementTree.parse(junit).getroot().iter("testcase"):
        name = case.get("name")
        if case.get("status") == "run":
            passed.append(name)
        elif case.find("skipped") is not None:
            said = [line for line in (case.findtext("system-out") or "").splitlines() if line.startswith("skipped: ")]
            skipped[name] = said[0].removeprefix("skipped: ") if said else ""
        else:
            failed.append(name)
    return passed, failed, skipped


def write(path, figures):
    aside = path.with_suffix(".part")
    with open(aside, "w", encoding="utf-8") as out:
        json.dump(figures, out, indent=2)
        out.write("\n")
        out.flush()
        os.fsync(out.fileno())
    aside.rename(path)


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("junit", help="what ctest --output-junit wrote")
    for name in ("release", "compiler", "version", "tree", "stop"):
        options.add_argument(f"--{name}", required=True)
    for name in ("built-s", "tested-s"):
        options.add_argument(f"--{name}", required=True, type=int)
    options.add_argument("--json", required=True, type=pathlib.Path)
    given = options.parse_args()

    passed, failed, skipped = outcomes(given.junit)
    figures = {
        "release": given.release, "compiler": given.compiler, "version": given.version, "tree": given.tree,
        "passed": len(passed), "failed": failed, "skipped": skipped,
        "built_s": given.built_s, "tested_s": given.tested_s, "stop_sha256": digest(given.stop),
    }
    wrong = [f"failed: {name}" for name in failed]
    wrong += [f"skipped without a reason: {name}" for name, reason in skipped.items() if not reason]
    wrong += [] if passed else ["no test passed"]
    for path in sorted(given.json.parent.glob("*.json")):
        other = json.loads(path.read_text())
        alike = all(other[key] == figures[key] for key in ("release", "tree"))
        if path != given.json and alike and other["stop_sha256"] != figures["stop_sha256"]:
            wrong.append(f"the stop has other bytes than in {path}")
    write(given.json, figures)

    print(f"\nDebian {given.release}, {given.version}: {len(passed)} of {len(passed) + len(failed)} tests passed, {len(skipped)} skipped; "
          f"build {given.built_s} s, tests {given.tested_s} s; stop {figures['stop_sha256'][:16]}")
    for name, reason in skipped.items():
        print(f"  {name} skipped: {reason}")
    for text in wrong:
        print(f"  {text}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
