#!/usr/bin/python3
"""[STUDY-820] Ledgers read from Python are what the bridge says of them.

Usage: campaigns.py DIRECTORY_OF_THE_MODULE RIG_LAB RIG_BRIDGE, from the project root.
"""
import csv
import json
import math
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, sys.argv[1])
import numpy  # noqa: E402

import antiskid  # noqa: E402

LAB, BRIDGE = sys.argv[2:4]


def said(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def refused(kind, words, call):
    try:
        call()
    except kind as error:
        assert words in str(error), error
    else:
        raise AssertionError(f"not refused: {words}")


def same(value, stated):
    if isinstance(stated, list):
        return value in (" ".join(stated), "; ".join(stated))
    if stated is None:
        return math.isnan(value)
    return value == stated


def rows(folder):
    """As `rig-bridge status` has them, to the last bit, and as amended and noted."""
    ledger = antiskid.Ledger(folder)
    assert ledger.campaign == "endurance" and ledger.file == pathlib.Path(folder) / "campaign.sqlite"
    before = ledger.rows()
    said(BRIDGE, "ledger", "amend", folder, "--maneuver", "2", "--energy-MJ", "0.5", "--who", "A", "--why", "encoder")
    said(BRIDGE, "ledger", "note", folder, "--maneuver", "3", "--tyre", "T9", "--notes", "käfig", "--who", "A")
    table = ledger.rows()
    stated = json.loads(said(BRIDGE, "status", folder, "--json", "-"))[0]["maneuvers"]
    compared = set(table) & set(stated[0])
    assert len(compared) > 25, compared
    for name in compared:
        assert len(table[name]) == len(stated)
        for value, row in zip(table[name], stated):
            assert same(value, row[name]), f"{name}: {value!r} instead of {row[name]!r}"
    assert table["tyre_serial"].tolist()[1:4] == ["", "T9", ""] and table["notes"][2] == "käfig"
    assert table["counted_J"][1] == 0.5e6 and numpy.allclose(table["cumulative_energy_J"][1:], numpy.cumsum(table["counted_J"])[1:])
    assert (before["cumulative_energy_J"][1:] != table["cumulative_energy_J"][1:]).all()
    assert table["number"].dtype.kind == "i" and table["standstill"].dtype == bool and table["disc_energy_J"][-1] == table["cumulative_energy_J"][-1]


def data_frame(folder):
    import pandas

    ledger = antiskid.Ledger(folder, "endurance")
    frame = ledger.data_frame()
    assert frame.equals(pandas.DataFrame(ledger.rows())) and frame[frame.state == "finished"].mean_friction.mean() == ledger.rows()["mean_friction"].mean()
    sys.modules["pandas"] = None  # as where it is not installed
    refused(ImportError, "python3-pandas", ledger.data_frame)
    sys.modules["pandas"] = pandas


def wear_points(folder):
    energy_J, friction = antiskid.Ledger(folder).wear()
    table = list(csv.DictReader(said(LAB, "wear", "table", folder, "--csv", "-").splitlines()))
    assert energy_J.tolist() == [float(row["cumulative_energy_J"]) for row in table]
    assert friction.tolist() == [float(row["mean_friction"]) for row in table]


def unfinished(folder):
    """A bridge that died: figures that nobody knows are nan."""
    import sqlite3

    with sqlite3.connect(f"{folder}/campaign.sqlite") as ledger:
        ledger.execute("UPDATE maneuvers SET state = 'unfinished', cumulative_energy_J = NULL WHERE number = 12")
    ledger.close()
    table = antiskid.Ledger(folder).rows()
    assert table["state"][-1] == "unfinished" and math.isnan(table["mean_friction"][-1]) and math.isnan(table["counted_J"][-1])
    assert not table["standstill"][-1] and len(antiskid.Ledger(folder).wear()[0]) == 11


def what_is_wrong(folder):
    refused(RuntimeError, "none.sqlite", lambda: antiskid.Ledger(f"{folder}/none.sqlite"))
    refused(RuntimeError, "it has endurance", lambda: antiskid.Ledger(folder, "other").rows())


with tempfile.TemporaryDirectory() as directory:
    said(LAB, "endurance", "--maneuvers", "12", "--out", directory)
    rows(directory)
    data_frame(directory)
    wear_points(directory)
    what_is_wrong(directory)
    unfinished(directory)
