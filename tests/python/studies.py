#!/usr/bin/python3
"""[STUDY-840] Open loop and studies from Python are the verbs'.

Usage: studies.py DIRECTORY_OF_THE_MODULE RIG_LAB, from the project root.
"""
import csv
import json
import pathlib
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, sys.argv[1])
import numpy  # noqa: E402

import antiskid  # noqa: E402
from refused import refused  # noqa: E402

LAB = sys.argv[2]


def by_verb(*options):
    # Status 1: done, and what the paper says does not hold of so few stops.
    done = subprocess.run([LAB, *options], capture_output=True, text=True)
    assert done.returncode in (0, 1), done.stderr
    return done.stdout


def table_of(text):
    return list(csv.DictReader(line for line in text.splitlines() if not line.startswith("#")))


def same_table(columns, rows):
    assert list(columns) == list(rows[0])
    for name, column in columns.items():
        assert len(column) == len(rows)
        for value, row in zip(column, rows):
            stated = row[name]
            assert value == stated if column.dtype == object else value == int(stated) if column.dtype.kind in "iu" else \
                value == float(stated or "nan") or (numpy.isnan(value) and not stated), f"{name}: {value!r} instead of {stated!r}"


def driven(folder):
    profile = pathlib.Path(folder) / "profile.csv"
    for quantity, values in (("pressure_Pa", [0.0, 4e6, 4e6]), ("current_mA", [0.0, 12.0, 9.5])):
        profile.write_text(f"time_s,{quantity}\n" + "".join(f"{t},{value}\n" for t, value in zip((0.0, 0.5, 2.0), values)))
        rows = table_of(by_verb("drive", "--maneuver", "light", "--surface", "wet_asphalt", "--mu-b", "0.2", "--input", profile, "--csv", "-"))
        motion = antiskid.drive([0.0, 0.5, 2.0], **{quantity: values}, maneuver="light", surface="wet_asphalt", mean_friction=0.2)
        assert list(motion) == list(rows[0]) and len(rows) == 2001
        for name, column in motion.items():
            digits = ".6f" if name == "time_s" else ".9g"
            assert [f"{value:{digits}}" for value in column] == [row[name] for row in rows], name
    refused(ValueError, "one of pressure_Pa and current_mA", lambda: antiskid.drive([0.0, 1.0]))
    refused(RuntimeError, "must increase", lambda: antiskid.drive([0.0, 0.0], pressure_Pa=[0.0, 0.0]))
    refused(RuntimeError, "from 0 to", lambda: antiskid.drive([0.0, 1.0], pressure_Pa=[0.0, float("nan")]))
    refused(RuntimeError, "2 times and 1 values", lambda: antiskid.drive([0.0, 1.0], pressure_Pa=[0.0]))


def swept(folder):
    native = by_verb("sweep", "--references", "0.12,0.24", "--landings", "4", "--seed", "3", "--no-pictures", "--out", folder, "--json", "-")
    results, stops = antiskid.sweep([0.12, 0.24], landings=4, seed=3, threads=2)
    assert results == json.loads(native)
    same_table(stops, table_of((pathlib.Path(folder) / "stops.csv").read_text()))
    assert len(stops["stop"]) == 12
    refused(ValueError, "increasing, from 0.01 to 0.5", lambda: antiskid.sweep([0.24, 0.12]))
    refused(ValueError, "landings", lambda: antiskid.sweep([0.24], landings=0))


def drawn(folder):
    options = ("--families", "ring,patches", "--laws", "slip,told_peak", "--draws", "3", "--seed", "8")
    native = by_verb("robust", *options, "--no-pictures", "--out", folder, "--json", "-")
    results, stops = antiskid.robust(families=["ring", "patches"], laws=["slip", "told_peak"], draws=3, seed=8)
    assert results == json.loads(native)
    same_table(stops, table_of((pathlib.Path(folder) / "stops.csv").read_text()))
    refused(ValueError, "draws", lambda: antiskid.robust(draws=0))


def linear(folder):
    options = ("--speeds", "2", "--slip", "0.2", "--constant-slip", "--mu-b", "0.2")
    native = by_verb("margins", *options, "--out", folder, "--json", "-")
    results = antiskid.margins(speeds=2, slip=0.2, constant_slip=True, mean_friction=0.2)
    assert results == json.loads(native) and len(results["cells"]) == 64
    assert antiskid.margins(speeds=2)["cells"] != results["cells"]
    refused(ValueError, "speeds: expected 2 to 200", lambda: antiskid.margins(speeds=1))
    refused(ValueError, "slip: expected 0.01 to 0.5", lambda: antiskid.margins(slip=0.6))
    refused(RuntimeError, "none.toml", lambda: antiskid.margins(controller="none.toml"))


def interrupted():
    """Ctrl-C ends studies that would go on for an hour."""
    signal.signal(signal.SIGALRM, signal.default_int_handler)
    for study in (lambda: antiskid.sweep(landings=10_000), lambda: antiskid.robust(draws=100_000), lambda: antiskid.margins(speeds=200)):
        signal.setitimer(signal.ITIMER_REAL, 0.5)
        try:
            study()
        except KeyboardInterrupt:
            continue
        raise AssertionError("it was not interrupted")


with tempfile.TemporaryDirectory() as directory:
    driven(directory)
    swept(directory)
    drawn(directory)
    linear(directory)
    interrupted()
