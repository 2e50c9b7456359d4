#!/usr/bin/python3
"""[BRG-220] A bridge killed with SIGKILL at random moments never leaves a corrupt ledger, loses no finished maneuver and counts none twice.

Usage: ledger_killed.py LEDGER_WRITER. The ledger is judged by Python's own SQLite, not by our code.
"""
import json
import os
import random
import select
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

KILLS = 80
PLANNED = 100


def judge(path, finished):
    """Everything that was said to be finished is, once; returns the rows by state."""
    if not os.path.exists(path) or os.path.getsize(path) == 0:
        assert not finished, "the ledger is gone"
        return {}
    with sqlite3.connect(path) as ledger:
        (verdict,) = ledger.execute("PRAGMA integrity_check").fetchone()
        assert verdict == "ok", verdict
        if not ledger.execute("SELECT count(*) FROM sqlite_schema").fetchone()[0]:
            assert not finished, "the tables are gone"
            return {}
        numbers = [n for (n,) in ledger.execute("SELECT number FROM maneuvers WHERE state = 'finished'")]
        assert len(numbers) == len(set(numbers)), "counted twice"
        assert finished <= set(numbers), f"lost: {finished - set(numbers)}"
        assert set(numbers) == set(range(1, len(numbers) + 1)), "a number was left out"
        states = dict(ledger.execute("SELECT state, count(*) FROM maneuvers GROUP BY state"))
        assert states.get("running", 0) <= 1
    ledger.close()
    return states


def main():
    writer = sys.argv[1]
    seed = int(os.environ.get("SEED", "227"))
    chance = random.Random(seed)
    finished = set()
    said = {"adopted": 0, "unfinished": 0}
    moments = {"between": 0, "running": 0}
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "campaign.sqlite")

        def take(line):
            word, _, number = line.partition(" ")
            if word == "finished":
                finished.add(int(number))
            elif word in said:
                said[word] += 1
                if word == "adopted":
                    finished.add(int(number))

        for kill in range(KILLS):
            with subprocess.Popen([writer, path, "1000000"], stdout=subprocess.PIPE) as process:
                # A few die while they open the ledger, most while maneuvers begin and end.
                if chance.random() < 0.8:
                    select.select([process.stdout], [], [], 60)
                time.sleep(chance.uniform(0.0, 0.05))
                assert process.poll() is None, "the writer ended by itself"
                process.send_signal(signal.SIGKILL)
                for line in process.stdout.read().decode().splitlines():
                    take(line)
                process.wait()
            states = judge(path, finished)
            moments["running" if states.get("running") else "between"] += 1
        assert moments["running"] and moments["between"], f"all died at the same point: {moments}"

        planned = len(finished) + PLANNED
        last = subprocess.run([writer, path, str(planned)], capture_output=True, text=True, check=True, timeout=300)
        for line in last.stdout.splitlines():
            take(line)
        assert last.stdout.endswith("complete\n")
        states = judge(path, finished)
        assert states["finished"] == planned, states
        assert "running" not in states, states
        with sqlite3.connect(path) as ledger:
            for number, folder_name, energy in ledger.execute(
                "SELECT number, folder, energy_brake_J FROM maneuvers WHERE state = 'finished'"
            ):
                with open(os.path.join(folder, folder_name, "summary.json"), encoding="utf-8") as file:
                    summary = json.load(file)
                assert (summary["number"], summary["energy_brake_J"]) == (number, energy), folder_name
            (total,) = ledger.execute("SELECT max(cumulative_energy_J) FROM maneuvers").fetchone()
        assert total == 1000.0 * planned * (planned + 1) / 2, "energy was lost or counted twice"
    print(f"{KILLS} kills ({moments['running']} while a maneuver ran), {planned} maneuvers finished once each, "
          f"{said['adopted']} adopted, {said['unfinished']} marked unfinished")


if __name__ == "__main__":
    main()
