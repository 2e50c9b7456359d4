#!/usr/bin/python3
"""[STUDY-820] [STUDY-830] [STUDY-860] Campaigns run, ledgers read, wear learnt, simulated and regulated from Python are what the programs say.

Usage: campaigns.py DIRECTORY_OF_THE_MODULE RIG_LAB RIG_BRIDGE, from the project root.
"""
import csv
import json
import math
import pathlib
import signal
import subprocess
import sys
import tempfile

sys.path.insert(0, sys.argv[1])
import numpy  # noqa: E402

import antiskid  # noqa: E402
from refused import refused  # noqa: E402

LAB, BRIDGE = sys.argv[2:4]


def said(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


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
    said(BRIDGE, "ledger", "note", folder, "--maneuver", "3", "--tyre", "T9", "--notes", "käfig", "--lining-worn", "0.31", "--who", "A")
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
    assert frame.equals(pandas.DataFrame(ledger.rows()))
    assert frame[frame.state == "finished"].mean_friction.tolist() == ledger.rows()["mean_friction"].tolist()
    sys.modules["pandas"] = None  # as where it is not installed
    refused(ImportError, "python3-pandas", ledger.data_frame)
    sys.modules["pandas"] = pandas


def wear_points(folder):
    energy_J, friction = antiskid.Ledger(folder).wear()
    table = list(csv.DictReader(said(LAB, "wear", "table", folder, "--csv", "-").splitlines()))
    assert energy_J.tolist() == [float(row["cumulative_energy_J"]) for row in table]
    assert friction.tolist() == [float(row["mean_friction"]) for row in table]
    assert [column.tolist() for column in antiskid.Ledger(folder).lining()] == [[energy_J[2]], [0.31]]


def learnt(folder):
    """Model and forecast as the verbs have them."""
    source = f"{folder}/begin.csv"
    whole = pathlib.Path("config/wear/endurance_campaign.csv").read_text().splitlines(keepends=True)
    pathlib.Path(source).write_text("".join(whole[:90]))
    table = list(csv.DictReader(line for line in said(LAB, "wear", "table", source, "--csv", "-").splitlines() if not line.startswith("#")))
    energy_J, friction = (numpy.array([float(row[name]) for row in table]) for name in ("cumulative_energy_J", "mean_friction"))
    sizes = ("--components", "4", "--starts", "3", "--seed", "5")
    native = json.loads(said(LAB, "wear", "fit", source, *sizes, "--origin", "made up", "--no-pictures", "--out", folder, "--json", "-"))
    model = antiskid.fit_wear(energy_J, friction, components=4, starts=3, seed=5, source=source, origin="made up")
    assert model == native
    written = pathlib.Path(folder) / "mine.json"
    written.write_text(json.dumps(model))
    fleet = "config/wear/population.json"
    for population, limit, options, keywords in (
        (written, 0.2, ("--energy", "1.5", "--seed", "3", "--last", "30"), {"energy_MJ": 1.5, "seed": 3, "last": 30}),
        (fleet, None, ("--mix", "light=0.5,heavy=0.5", "--method", "filter"), {"mix": "light=0.5,heavy=0.5", "method": "filter"}),
        (fleet, 0.25, ("--draws", "500"), {"draws": 500}),
    ):
        options += ("--reserve",) if limit is None else ("--limit", str(limit))
        native = json.loads(said(LAB, "wear", "forecast", source, "--model", population, *options, "--no-pictures", "--out", folder, "--json", "-"))
        answer = antiskid.landings_left(energy_J, friction, population, limit=limit, **keywords)
        provenance = answer.pop("provenance")
        assert answer == native, f"{answer} instead of {native}"
        assert provenance.startswith("made up") and provenance.endswith(("1 life", "lives")), provenance
    refused(ValueError, "2 energies and 1 frictions", lambda: antiskid.fit_wear([1e6, 2e6], [0.3]))
    refused(ValueError, "begin with 'measured'", lambda: antiskid.fit_wear(energy_J, friction, origin="rig 7"))
    refused(RuntimeError, "must increase", lambda: antiskid.fit_wear([2e6, 1e6], [0.3, 0.29]))
    refused(ValueError, "none of shipped", lambda: antiskid.landings_left(energy_J, friction, fleet, limit=0.2, method="best"))
    refused(RuntimeError, "none.json", lambda: antiskid.landings_left(energy_J, friction, "none.json", limit=0.2))


def by_readings(folder):
    """Readings of the lining count as in the verb."""
    lives = pathlib.Path(folder, "lives")
    lives.mkdir()
    draw = numpy.random.default_rng(8)
    for life_J in (50e6, 54e6, 58e6, 62e6, 66e6, 70e6, 60e6):
        energy_J = numpy.arange(1e6, life_J, 1e6)
        friction = 0.33 - 0.14 * energy_J / life_J + 0.004 * draw.normal(size=energy_J.size)
        rows = [[f"{e}", f"{mu}", f"{e / life_J}" if number % 15 == 14 else ""] for number, (e, mu) in enumerate(zip(energy_J, friction))]
        text = "cumulative_energy_J,mean_friction,lining_worn\n" + "".join(",".join(row) + "\n" for row in rows)
        (lives / f"{life_J / 1e6:.0f}.csv").write_text(text)
    begun = pathlib.Path(folder, "begun.csv")
    begun.write_text("".join((lives / "60.csv").read_text().splitlines(keepends=True)[:36]))
    (lives / "60.csv").unlink()
    said(LAB, "wear", "population", lives, "--limit", "0.2", "--origin", "made up", "--out", lives)
    population = lives / "population.json"
    native = json.loads(said(LAB, "wear", "forecast", begun, "--model", population, "--limit", "0.2", "--no-pictures", "--out", folder, "--json", "-"))
    assert native["lining_readings"] == 2, native
    table = list(csv.DictReader(begun.read_text().splitlines()))
    points = [[float(row[name]) for row in table] for name in ("cumulative_energy_J", "mean_friction")]
    read = [row for row in table if row["lining_worn"]]
    lining = [[float(row[name]) for row in read] for name in ("cumulative_energy_J", "lining_worn")]
    answer = antiskid.landings_left(*points, population, limit=0.2, lining=lining)
    del answer["provenance"]
    assert answer == native, f"{answer} instead of {native}"
    assert antiskid.landings_left(*points, population, limit=0.2)["landings_left"] != native["landings_left"]
    refused(ValueError, "lining: 2 energies and 1 worn", lambda: antiskid.landings_left(*points, population, limit=0.2, lining=(lining[0], [0.2])))
    refused(RuntimeError, "worn share", lambda: antiskid.landings_left(*points, population, limit=0.2, lining=(lining[0], [0.2, 31.0])))


def ran(folder):
    """A campaign is the verb's, maneuver by maneuver, and goes on where it was."""
    mine, own = f"{folder}/mine", antiskid.endurance(f"{folder}/own", maneuvers=12)
    stated = json.loads(pathlib.Path(folder, "table.json").read_text())
    assert own == stated, f"{own} instead of {stated}"
    whole = [column.tolist() for column in antiskid.Ledger(f"{folder}/own").wear()]
    assert whole[1] == antiskid.Ledger(folder).wear()[1].tolist()  # whose energies were amended
    first = antiskid.endurance(mine, maneuvers=3)
    assert first["maneuvers"] == 3 and antiskid.endurance(mine, maneuvers=4)["maneuvers"] == 4
    assert [column.tolist()[:3] for column in antiskid.Ledger(mine).wear()] == [column[:3] for column in whole]
    assert antiskid.endurance(f"{folder}/other", maneuvers=3, seed=2)["quantities"] != first["quantities"]
    refused(ValueError, "maneuvers: expected 1", lambda: antiskid.endurance(mine, maneuvers=0))
    refused(ValueError, "seed: expected less", lambda: antiskid.endurance(mine, seed=2**63))
    refused(RuntimeError, "seed", lambda: antiskid.endurance(mine, maneuvers=5, seed=2))
    refused(RuntimeError, "none.toml", lambda: antiskid.endurance(f"{folder}/new", scenario="none.toml"))


def simulated(folder):
    """Fig. 9 is the verb's."""
    model = json.loads(pathlib.Path(folder, "mine.json").read_text())
    said(LAB, "wear", "simulate", folder, "--model", f"{folder}/mine.json", "--seed", "4", "--out", f"{folder}/simulated")
    rows = csv.DictReader(line for line in pathlib.Path(folder, "simulated/simulated.csv").read_text().splitlines() if not line.startswith("#"))
    stated = [(float(row["cumulative_energy_J"]), float(row["mean_friction"])) for row in rows]
    ledger = antiskid.Ledger(folder)
    assert list(zip(*(column.tolist() for column in ledger.simulated_wear(model, seed=4)))) == stated
    assert ledger.simulated_wear(model, seed=5)[1].tolist() != [friction for _, friction in stated]
    refused(RuntimeError, "format", lambda: ledger.simulated_wear({}))


def regulated():
    """Towards what is left, a step at a time, within the floor's range; without measurements back to the default."""
    def regulator(tyre_life_J):
        return antiskid.Regulator(5e6, 1e6, landings=100, brake_life_J=3.8e8, brake_taken_J=0.0, tyre_life_J=tyre_life_J)

    for tyre_life_J, way in ((2e8, 1), (0.5e8, -1)):
        shares = regulator(tyre_life_J)
        low, high = shares.range
        assert abs(shares.required_share - tyre_life_J / (tyre_life_J + 3.8e8)) < 1e-12 and shares.reference == 0.24
        references = [shares.reference]
        for _ in range(5):
            assert shares.after(kinetic_J=5e6, brake_J=3.8e6, tyre_J=1.2e6, j_mu=0.95) == "measured"
            references.append(shares.reference)
        steps = way * numpy.diff(references)
        assert (steps >= 0).all() and 0 < steps.max() <= 0.02 + 1e-12 and low <= shares.reference <= high
        assert shares.landings == 5 and abs(shares.brake_left_J - 3.61e8) < 1 and abs(shares.tyre_left_J - (tyre_life_J - 6e6)) < 1
        moved = shares.reference
        assert shares.after(kinetic_J=5e6, brake_J=math.nan, tyre_J=1e6) == "missing" and shares.reference == moved
        for _ in range(9):
            shares.after(kinetic_J=5e6, brake_J=math.nan, tyre_J=1e6)
        assert shares.reference == 0.24
    assert shares.after(kinetic_J=5e6, brake_J=5e6, tyre_J=5e6) == "energy_mismatch"
    refused(ValueError, "", lambda: antiskid.Regulator(-1.0, 0.0))
    refused(RuntimeError, "regulation.toml", lambda: antiskid.Regulator(5e6, 1e6, config="tests"))


def interrupted(folder):
    """Ctrl-C ends what would go on for hours; of a campaign its maneuvers so far are left."""
    signal.signal(signal.SIGALRM, signal.default_int_handler)
    friction = 0.3 + 0.01 * numpy.random.default_rng(1).normal(size=2000)
    for endless in (lambda: antiskid.fit_wear(1e6 * numpy.arange(1, 2001), friction, starts=100_000),
                    lambda: antiskid.endurance(f"{folder}/endless", maneuvers=1_000_000)):
        signal.setitimer(signal.ITIMER_REAL, 0.5)
        try:
            endless()
        except KeyboardInterrupt:
            continue
        raise AssertionError("it was not interrupted")
    done = antiskid.Ledger(f"{folder}/endless").rows()
    assert len(done["number"]) > 0 and set(done["state"]) == {"finished"}
    assert antiskid.endurance(f"{folder}/endless", maneuvers=len(done["number"]) + 1)["maneuvers"] == len(done["number"]) + 1


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
    by_readings(directory)
    wear_points(directory)
    what_is_wrong(directory)
    learnt(directory)
    ran(directory)
    simulated(directory)
    regulated()
    interrupted(directory)
    unfinished(directory)
