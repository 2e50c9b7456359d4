#!/usr/bin/python3
"""rig-lab endurance as its users meet it: results, exit status, Ctrl-C and SIGKILL, resumption; the brake that it keeps.
[STUDY-073] [RIG-300]

usage: verb.py RIG_LAB
"""
import json
import pathlib
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

LAB = sys.argv[1]


def start(out, maneuvers, *more):
    return subprocess.Popen([LAB, "endurance", "--out", str(out), "--maneuvers", str(maneuvers), *more],
                            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def run(out, maneuvers, *more):
    child = start(out, maneuvers, *more)
    stdout, stderr = child.communicate(timeout=300)
    return child.returncode, stdout, stderr


def rows(out, what="number"):
    # Not read-only: after SIGKILL a journal may lie there, and reading begins with rolling it back.
    with sqlite3.connect(f"file:{out}/campaign.sqlite?mode=rw", uri=True, timeout=30) as db:
        return [r[0] for r in db.execute(f"select {what} from maneuvers where state = 'finished' order by number")]


def interrupt(out, maneuvers, number, at_least, *more):
    """Sends a signal once so many maneuvers are in the ledger; the exit status."""
    child = start(out, maneuvers, *more)
    deadline = time.monotonic() + 120
    while child.poll() is None and time.monotonic() < deadline:
        if (out / "campaign.sqlite").exists():
            try:
                if len(rows(out)) >= at_least:
                    break
            except sqlite3.OperationalError:
                pass  # no table yet
        time.sleep(0.01)
    child.send_signal(number)
    stdout, stderr = child.communicate(timeout=60)
    return child.returncode, stdout + stderr


def check(what, good, detail=""):
    print(("ok      " if good else "FAILED  ") + what, detail if not good else "")
    if not good:
        sys.exit(1)


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    out = scratch / "three"
    status, text, progress = run(out, 3)
    check("three maneuvers succeed", status == 0, text + progress)
    check("the table is on the screen", "Table III" in text and "630.37" in text, text)
    check("progress is plain lines where there is no terminal", "3 of 3 maneuvers" in progress and "\033" not in progress
          and "\r" not in progress, progress)
    table = json.loads((out / "table.json").read_text())
    check("table.json says what was run", table["maneuvers"] == 3 and table["seed"] == 1
          and table["quantities"]["speed_mps"]["printed_mean"] == 54.86, str(table))
    check("three rows", rows(out) == [1, 2, 3], str(rows(out)))
    status, text, _ = run(out, 3, "--seed", "2")
    check("another seed is refused", status == 2, text)

    out = scratch / "stopped"
    status, text = interrupt(out, 5000, signal.SIGINT, 3)
    check("Ctrl-C ends with 130", status == 130, f"{status} {text}")
    done = rows(out)
    check("the ledger has what was finished", done == list(range(1, len(done) + 1)) and len(done) >= 3, str(done))

    for at_least in (len(done) + 2, len(done) + 5, len(done) + 9):
        status, text = interrupt(out, 5000, signal.SIGKILL, at_least)
        check("killed", status == -signal.SIGKILL, f"{status} {text}")
    planned = len(rows(out)) + 4
    status, text, stderr = run(out, planned)
    check("the campaign goes on after SIGKILL, to its end", status == 0, text + stderr)
    check("nothing lost, nothing counted twice", rows(out) == list(range(1, planned + 1)), str(rows(out)))
    energies = rows(out, "cumulative_energy_J")
    each = rows(out, "energy_brake_J")
    check("the brake's energy counts on", all(abs(b - a - e) < 1.0 for a, b, e in zip(energies, energies[1:], each[1:])),
          str(energies))

    brake = scratch / "brake.json"
    keeps = ("--brake", "100", "--brake-state", str(brake))
    out = scratch / "kept"
    for at_least in (2, 4, 6):
        status, text = interrupt(out, 5000, signal.SIGKILL, at_least, *keeps)
        check("killed while it keeps its brake", status == -signal.SIGKILL, f"{status} {text}")
    planned = len(rows(out)) + 1
    status, text, stderr = run(out, planned, *keeps)
    check("a campaign that keeps its brake goes on after SIGKILL", status == 0, text + stderr)
    kept = json.loads(brake.read_text())
    check("the kept brake has every maneuver and the ledger's energy", kept["maneuvers"] == planned
          and kept["cumulative_energy_J"] == rows(out, "cumulative_energy_J")[-1] > 100e6, str(kept))
    brake.write_text(brake.read_text().replace('"maneuvers": ', '"maneuvers": 1'))
    status, _, stderr = run(out, planned + 1, *keeps)
    check("a damaged brake is refused by name", status == 2 and str(brake) in stderr and "check_sum" in stderr, stderr)
    status, _, stderr = run(scratch / "far", 1, "--brake", "700", "--component", "mixture")
    check("beyond the data the brake is said to be so", "beyond the wear model's data" in stderr, stderr)

    status, _, stderr = run(scratch / "x", 0)
    check("no maneuvers is a mistake", status == 2 and "--maneuvers" in stderr, stderr)
    status, _, stderr = run(scratch / "x", 1, "--scenario", "nothing.toml")
    check("an absent scenario is named", status == 2 and "nothing.toml" in stderr, stderr)
    status, text, _ = run(scratch / "heavy", 2, "--scenario", "config/scenarios/heavy.toml")
    check("another scenario runs, without Table III", status == 0 and "Table III" not in text, text)
