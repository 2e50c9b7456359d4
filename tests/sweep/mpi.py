#!/usr/bin/python3
"""rig-lab sweep under mpirun: two processes give the bytes of one. [STUDY-145]

usage: mpi.py RIG_LAB MPIRUN
"""
import os
import pathlib
import subprocess
import sys
import tempfile

LAB, MPIRUN = sys.argv[1:3]
SMALL = ["sweep", "--references", "0.2,0.24", "--landings", "4", "--no-pictures"]


def mpirun(processes, *arguments):
    more = ["--oversubscribe"] + (["--allow-run-as-root"] if os.geteuid() == 0 else [])
    # Where a sandbox has no network, shared memory will do.
    return subprocess.run([MPIRUN, *more, "--mca", "btl", "self,vader", "-n", str(processes), LAB, *arguments],
                          capture_output=True, text=True, timeout=240)


def check(what, good, detail=""):
    print(("ok      " if good else "FAILED  ") + what, detail if not good else "", flush=True)
    if not good:
        sys.exit(1)


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    alone = subprocess.run([LAB, *SMALL, "--out", str(scratch / "one")], capture_output=True, text=True, timeout=240)
    for name, processes, more in (("two", 2, []), ("three", 3, ["--threads", "2"])):
        both = mpirun(processes, *SMALL, *more, "--out", str(scratch / name))
        check(f"{name} processes end as one", both.returncode == alone.returncode, f"{both.returncode} {both.stdout} {both.stderr}")
        for file in ("stops.csv", "results.json"):
            check(f"{name} processes, {file}: the same bytes",
                  (scratch / name / file).read_bytes() == (scratch / "one" / file).read_bytes())
        check("one process speaks", both.stdout.count("Written to") == 1, both.stdout)
    bad = mpirun(2, *SMALL, "--references", "7", "--out", str(scratch / "bad"))
    check("a mistake ends all of them", bad.returncode != 0 and "--references" in bad.stderr, bad.stderr)
