#!/usr/bin/python3
"""What `./rig test` runs of all tests, and the tables about time that the front door makes. [DOOR-060]

usage: tiers.py BUILD_DIR
"""
import json
import pathlib
import subprocess
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parents[1]


def check(what, holds, evidence=""):
    if not holds:
        sys.exit(f"FAILED  {what}: {evidence}")
    print(f"ok      {what}")


def listed(build, *options):
    shown = subprocess.run(["ctest", "--test-dir", build, "--show-only=json-v1", *options], capture_output=True, text=True, check=True).stdout
    labels = lambda test: next((p["value"] for p in test.get("properties", []) if p["name"] == "LABELS"), [])
    return {test["name"]: set(labels(test)) for test in json.loads(shown)["tests"]}


def tiers(build):
    every, basic = listed(build), listed(build, "-LE", "^all$")
    check("the basic tests are some of all", basic.keys() < every.keys())
    missing = {name for name, labels in every.items() if "inprocess" in labels} - basic.keys()
    check("all that works in process is among them, but for what asks Octave", missing == {"test_margins_octave"}, missing)
    missing = {name for name in every if name.endswith("_verb") or name == "front_door.verbs"} - basic.keys()
    check("so are the programs' command lines", not missing, missing)
    check("and one landing over a real vcan0", {name for name, labels in basic.items() if "vcan" in labels} == {"vcan.bridge_landing"})


def slowest(folder):
    (folder / ".ninja_log").write_text("# ninja log v5\n0\t1500\t1\tquick.o\tab\n100\t9100\t1\tslow.o\tcd\n0\t99000\t1\tprogram\tef\n")
    (folder / "ctest.txt").write_text("1/2 Test #1: one ....   Passed    0.50 sec\n2/2 Test  #2: two ...***Failed   12.25 sec\n")
    said = subprocess.run([TESTS / "slowest.py", folder], capture_output=True, text=True, check=True).stdout.splitlines()
    check("the slowest units come first, links apart", said[0].startswith("Compile units: 2") and said[1].split() == ["9.0", "s", "slow.o"], said)
    check("so do the slowest tests", said[3].startswith("Tests: 2") and said[4].split() == ["12.2", "s", "two"], said)
    (folder / "ctest.txt").unlink()
    done = subprocess.run([TESTS / "slowest.py", folder], capture_output=True, text=True, check=False)
    check("a run that is missing is named", done.returncode == 1 and "run ./rig test first" in done.stderr, done.stderr)


def first_use(folder):
    def judge(demo, test):
        files = []
        for verb, text in (("demo", demo), ("test", test)):
            files.append(folder / f"first-use-12.{verb}.txt")
            files[-1].write_text(text)
        out = folder / "first-use-12.json"
        done = subprocess.run([TESTS / "debian/first_use.py", *files, "--release", "12", "--json", out], capture_output=True, text=True, check=False)
        return done.returncode, done.stdout, json.loads(out.read_text())["commands"]

    installed = "setup: 9 packages, 1 MB to fetch, 2 MB on disk; fetched in 30 s, installed in 20 s\n"
    status, said, rows = judge(installed + "took 100 s, exit status 0\n", "setup: all 9 packages are installed\ntook 61 s, exit status 0\n")
    check("downloads are apart", status == 0 and rows[0]["seconds_without_download"] == 70 and rows[0]["install_s"] == 20, rows)
    check("the packages stand beside", "1 min 10 s" in said and "9 packages, 1 MB to fetch" in said, said)
    check("nothing to install is no time", rows[1]["seconds_without_download"] == 61 and rows[1]["download_s"] == 0, rows)
    status, _, rows = judge(installed + "took 100 s, exit status 0\n", "took 5 s, exit status 1\n")
    check("a command that failed is no success", status == 1 and rows[1]["exit_status"] == 1, rows)


def main():
    tiers(sys.argv[1])
    for judge in (slowest, first_use):
        with tempfile.TemporaryDirectory() as folder:
            judge(pathlib.Path(folder))


if __name__ == "__main__":
    main()
