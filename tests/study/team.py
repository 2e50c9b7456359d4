"""A study of rig-lab under mpirun, held against the same without."""
import os
import pathlib
import subprocess
import sys
import tempfile


def check(what, good, detail=""):
    print(("ok      " if good else "FAILED  ") + what, detail if not good else "", flush=True)
    if not good:
        sys.exit(1)


def mpirun(program, processes, *arguments):
    """`program` is mpirun."""
    more = ["--oversubscribe"] + (["--allow-run-as-root"] if os.geteuid() == 0 else [])
    # Where a sandbox has no network, shared memory will do.
    return subprocess.run([program, *more, "--mca", "btl", "self,vader", "-n", str(processes), *arguments],
                          capture_output=True, text=True, timeout=240)


def same_bytes(lab, program, study, mistake, says):
    """`study`: the verb and its options; `mistake`: options that it refuses; `says`: what it says then."""
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        alone = subprocess.run([lab, *study, "--out", str(scratch / "one")], capture_output=True, text=True, timeout=240)
        for name, processes, more in (("two", 2, []), ("three", 3, ["--threads", "2"])):
            both = mpirun(program, processes, lab, *study, *more, "--out", str(scratch / name))
            check(f"{name} processes end as one", both.returncode == alone.returncode, f"{both.returncode} {both.stdout} {both.stderr}")
            for file in ("stops.csv", "results.json"):
                check(f"{name} processes, {file}: the same bytes",
                      (scratch / name / file).read_bytes() == (scratch / "one" / file).read_bytes())
            check("one process speaks", both.stdout.count("Written to") == 1, both.stdout)
        bad = mpirun(program, 2, lab, *study, *mistake, "--out", str(scratch / "bad"))
        check("a mistake ends all of them", bad.returncode != 0 and says in bad.stderr, bad.stderr)
