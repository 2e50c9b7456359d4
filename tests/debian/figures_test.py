#!/usr/bin/python3
"""figures.py accepts a run in which every test passed or says why it was skipped, and refuses any other. [DOOR-060]"""
import json
import pathlib
import subprocess
import sys
import tempfile

FIGURES = pathlib.Path(__file__).with_name("figures.py")
PASSED = '<testcase name="{}" status="run"><system-out>fine</system-out></testcase>'
FAILED = '<testcase name="{}" status="fail"><failure message=""/><system-out>not fine</system-out></testcase>'
SKIPPED = '<testcase name="{}" status="notrun"><skipped message="SKIP_RETURN_CODE=77"/><system-out>{}</system-out></testcase>'
NOT_FOUND = '<testcase name="{}" status="notrun"><failure message="Unable to find executable"/><system-out/></testcase>'


class Runs:
    """The runs of one folder out/debian."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)

    def run(self, compiler, *cases, stop="a frame", tree="1", release="13"):
        """(exit status, what it said, figures)."""
        bus_log = self.folder / f"stop-{compiler}/bus.log"
        bus_log.parent.mkdir(exist_ok=True)
        bus_log.write_text(stop)
        junit = self.folder / "junit.xml"
        junit.write_text(f"<testsuite>{''.join(cases)}</testsuite>")
        figures = self.folder / f"{release}-{compiler}.json"
        done = subprocess.run([FIGURES, junit, "--release", release, "--compiler", compiler, "--version", f"{compiler} 1.2", "--tree", tree,
                               "--stop", bus_log.parent, "--built-s", "60", "--tested-s", "30", "--json", figures],
                              capture_output=True, text=True, check=False)
        return done.returncode, done.stdout + done.stderr, json.loads(figures.read_text())


def check(what, holds, evidence):
    if not holds:
        sys.exit(f"FAILED  {what}: {evidence}")
    print(f"ok      {what}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(folder)
        good = (PASSED.format("one"), PASSED.format("two"), SKIPPED.format("format", "tool 3\nskipped: tool is too new"))
        status, said, figures = runs.run("g++", *good)
        check("all passed", status == 0 and "2 of 2 tests passed, 1 skipped" in said, said)
        check("the reason is shown and kept", "format skipped: tool is too new" in said and
              figures["skipped"] == {"format": "tool is too new"}, said)
        check("passed are counted", figures["passed"] == 2 and figures["failed"] == [], figures)

        for what, case, text in (("a failed test", FAILED.format("bad"), "failed: bad"),
                                 ("a program that is not there", NOT_FOUND.format("lost"), "failed: lost"),
                                 ("a silent skip", SKIPPED.format("mute", "nothing to say"), "skipped without a reason: mute")):
            status, said, _ = runs.run("g++", *good, case)
            check(what, status == 1 and text in said, said)
        status, said, _ = runs.run("g++", SKIPPED.format("format", "skipped: why not"))
        check("nothing passed", status == 1 and "no test passed" in said, said)

        runs.run("g++", *good)
        status, said, _ = runs.run("clang++", *good)
        check("the same bytes", status == 0, said)
        status, said, _ = runs.run("clang++", *good, stop="another frame")
        check("other bytes", status == 1 and "other bytes than in" in said and "13-g++.json" in said, said)
        status, said, _ = runs.run("clang++", *good, stop="another frame", tree="2")
        check("other bytes of another tree", status == 0, said)
        status, said, _ = runs.run("clang++", *good, stop="another frame", release="12")
        check("other bytes of another release", status == 0, said)


if __name__ == "__main__":
    main()
