#!/usr/bin/python3
"""rig-lab sweep and trade as their users meet them: files, exit status, Ctrl-C, SIGKILL. [STUDY-148]

usage: verb.py RIG_LAB
"""
import csv
import json
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

LAB = sys.argv[1]
SMALL = ["--references", "0.2,0.24", "--landings", "4", "--no-pictures"]


def run(*arguments):
    done = subprocess.run([LAB, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    return done.returncode, done.stdout, done.stderr


def check(what, good, detail=""):
    print(("ok      " if good else "FAILED  ") + what, detail if not good else "", flush=True)
    if not good:
        sys.exit(1)


def same(a, b):
    return all((a / name).read_bytes() == (b / name).read_bytes() for name in ("stops.csv", "results.json"))


def interrupt(out, number, at_least):
    """Sends a signal once so many stops are in the part file; the exit status."""
    child = subprocess.Popen([LAB, "sweep", "--landings", "100", "--threads", "2", "--no-pictures", "--out", str(out)],
                             stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    part = out / "stops.part"
    deadline = time.monotonic() + 120
    while child.poll() is None and time.monotonic() < deadline:
        if part.exists() and len(part.read_bytes().splitlines()) >= at_least + 2:
            break
        time.sleep(0.01)
    child.send_signal(number)
    text = "".join(child.communicate(timeout=60))
    return child.returncode, text


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    one = scratch / "one"
    status, text, progress = run("sweep", *SMALL, "--threads", 1, "--out", one)
    check("a small sweep succeeds or says what does not hold", status == (1 if "FAILED" in text else 0), text + progress)
    check("progress is plain lines where there is no terminal", "12 of 12 maneuvers" in progress and "\r" not in progress, progress)
    lines = (one / "stops.csv").read_text().splitlines()
    rows = list(csv.DictReader(lines[1:]))
    check("stops.csv has every stop", [int(r["stop"]) for r in rows] == list(range(12)))
    results = json.loads((one / "results.json").read_text())
    means = [sum(float(r["j_mu"]) for r in rows[i * 4:i * 4 + 4]) / 4 for i in range(3)]
    check("results.json has the means of stops.csv",
          all(abs(a - b) < 1e-12 for a, b in zip(means, [r["j_mu"] for r in results["references"]] + [results["threshold"]["j_mu"]])))
    check("and says what was run", results["seed"] == 1 and len(results["config_hash"]) == 32 and results["stops"] == 12)
    check("the exit status is that of the checks", (status == 0) == results["passed"])
    check("nothing is left over", sorted(p.name for p in one.iterdir()) == ["results.json", "stops.csv"])

    three = scratch / "three"
    run("sweep", *SMALL, "--threads", 3, "--out", three)
    check("three threads, the same bytes", same(one, three))

    stopped = scratch / "stopped"
    status, text = interrupt(stopped, signal.SIGINT, 3)
    check("Ctrl-C ends with 130 and says how to go on", status == 130 and "the same command goes on" in text, f"{status} {text}")
    before = (stopped / "stops.part").read_bytes()
    check("whole lines are left", before.endswith(b"\n"))
    status, text = interrupt(stopped, signal.SIGKILL, len(before.splitlines()) + 2)
    check("killed", status == -signal.SIGKILL, f"{status} {text}")
    after = (stopped / "stops.part").read_bytes()
    check("it went on, and lost nothing", after.startswith(before) and len(after) > len(before))
    numbers = [line.split(b",")[0] for line in after.splitlines()[2:] if line.count(b",") == 25]
    check("no stop ran twice", len(set(numbers)) == len(numbers))
    status, text, err = run("sweep", "--seed", 2, "--no-pictures", "--out", stopped)
    check("another seed does not go on from it", status == 2 and "seed 1 instead of 2" in err, err)

    for arguments, says in ((["--references", "0.5:0.1:0.01"], "--references"), (["--references", "abc"], "--references"),
                            (["--references", "0.2,0.7"], "--references"),
                            (["--landings", "0"], "--landings"), (["--config", "/nowhere"], "/nowhere")):
        status, text, err = run("sweep", *arguments, "--out", scratch / "bad")
        check(f"{' '.join(arguments)} is refused", status == 2 and says in err + text, f"{status} {err}")
    check("and leaves nothing", not (scratch / "bad").exists())

    trade = scratch / "trade"
    status, text, err = run("trade", one, "--brake-price", 1, "--tyre-price", 3, "--out", trade)
    answer = json.loads((trade / "results.json").read_text())
    check("a dear tyre asks for the least slip", status == 0 and answer["best"]["slip_reference"] == 0.2, text + err)
    check("there is a picture", (trade / "trade.png").read_bytes().startswith(b"\x89PNG"))
    status, text, err = run("trade", one, "--brake-life", 900, "--tyre-life", 100, "--min-j-mu", 0.999, "--out", trade)
    check("a floor that cannot be met ends with 1 and what can be had", status == 1 and "at most" in text, f"{status} {text} {err}")
    for arguments, says in ((["--brake-price", 1], "--tyre-price"), ([], "--brake-price"),
                            (["--brake-life", 0, "--tyre-life", 1], "above 0"),
                            (["--brake-price", -1, "--tyre-price", 1], "not negative")):
        status, text, err = run("trade", one, *arguments, "--out", trade)
        check(f"trade {' '.join(map(str, arguments))} is refused", status == 2 and says in err, f"{status} {err}")
    status, text, err = run("trade", scratch / "nothing", "--brake-price", 1, "--tyre-price", 1)
    check("a sweep that is not there is refused, with what makes it", status == 2 and "`rig-lab sweep` makes it" in err, err)
