#!/usr/bin/python3
"""cppcheck's MISRA add-on over firmware/control: every rule holds but those that docs/engineering/misra.md lists with a reason, and the add-on bites. [CTL-240]

usage: lint_misra.py ROOT WORK_DIR
"""
import collections
import json
import pathlib
import re
import shutil
import subprocess
import sys

# One violation each, in the body of a function that is otherwise like ours.
SEEDS = {
    "7.1": "const int b = 010; return b + a;",
    "13.4": "int b = 0; if ((b = a) != 0) { return b; } return 1;",
    "13.5": "int b = 0; const bool both = (a == 1) && (b++ == 2); return both ? b : a;",
    "14.1": "int b = 0; for (float x = 0.0F; x < 1.0F; x += 0.1F) { b = b + a; } return b;",
    "15.1": "goto out; out: return a;",
    "16.4": "int b = 0; switch (a) { case 1: b = 2; break; case 2: b = 3; break; } return b;",
    "16.6": "int b = 0; switch (a) { default: b = 2; break; } return b;",
    "17.2": "return seeded(a - 1);",
    "19.2": "union Both { int i; float f; }; Both both{}; both.i = a; return both.i;",
    "21.3": "void* const p = malloc(4); free(p); return a;",
}


def violations(folder, root):
    """rule -> places, in the files of `folder`."""
    files = sorted(str(f) for f in folder.glob("*.cxx"))
    subprocess.run(["cppcheck", "--dump", "--quiet", "--std=c++20", f"-I{root}", *files], check=True)
    addons = [p for p in pathlib.Path("/usr").glob("lib/*/cppcheck/addons/misra.py")] + [
        p for p in [pathlib.Path("/usr/share/cppcheck/addons/misra.py")] if p.exists()]
    if not addons:
        sys.exit("lint_misra: cppcheck has no MISRA add-on here")
    done = subprocess.run([sys.executable, str(addons[0]), "--cli", *(f + ".dump" for f in files)], check=False, capture_output=True, text=True)
    found = collections.defaultdict(set)
    for line in done.stdout.splitlines():
        if not line.startswith("{"):
            continue
        problem = json.loads(line)
        if pathlib.Path(problem["file"]).parent == folder:
            found[problem["errorId"].removeprefix("c2012-")].add(f"{pathlib.Path(problem['file']).stem}:{problem['linenr']}")
    return found


def main():
    root, work = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    pinned = subprocess.run([root / "tests/front_door/lint_pinned.sh", "cppcheck"], check=False)
    if pinned.returncode != 0:
        return pinned.returncode
    shutil.rmtree(work, ignore_errors=True)
    control, seeded = work / "control", work / "seeded"
    for folder in (control, seeded):
        folder.mkdir(parents=True)
    for source in (root / "firmware/control").glob("*.[ch]pp"):
        shutil.copy(source, control / f"{source.name}.cxx")
    for rule, body in SEEDS.items():
        (seeded / f"rule_{rule}.cxx").write_text(f"#include <cstdlib>\nint seeded(int a);\nint seeded(int a) {{ {body} }}\n")

    listed = set(re.findall(r"^\| (\d+\.\d+) \|", (root / "docs/engineering/misra.md").read_text(), re.M))
    found = violations(control, root)
    wrong = [f"rule {rule} is broken and not in docs/engineering/misra.md: {', '.join(sorted(places))}"
             for rule, places in sorted(found.items()) if rule not in listed]
    wrong += [f"docs/engineering/misra.md lists rule {rule}, which nothing breaks" for rule in sorted(listed - set(found))]
    bitten = violations(seeded, root)
    wrong += [f"the violation of rule {rule} that was planted is not found" for rule in SEEDS if f"rule_{rule}:3" not in bitten[rule]]
    print("\n".join(wrong) or f"{len(found)} rules broken for the reasons listed, {len(SEEDS)} planted violations found")
    return bool(wrong)


if __name__ == "__main__":
    sys.exit(main())
