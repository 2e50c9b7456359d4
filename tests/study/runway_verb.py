#!/usr/bin/python3
"""--runway on the command lines of rig-lab and virtual-rig, and in a scenario. [STUDY-602]

usage: runway_verb.py RIG_LAB VIRTUAL_RIG
"""
import json
import pathlib
import subprocess
import sys
import tempfile

LAB, RIG = sys.argv[1:]
WET = "config/runways/wet_smooth.toml"


def run(*command):
    done = subprocess.run([str(c) for c in command], capture_output=True, text=True, timeout=100)
    return done.returncode, done.stdout, done.stderr


status, text, err = run(LAB, "stop", "--runway", WET, "--json", "-")
report = json.loads(text)
assert status == 0 and report["surface"] == "wet_smooth" and report["stop_distance_m"] > 500.0, (status, report, err)

status, text, err = run(LAB, "compare", "--runway", WET, "--runway", "config/runways/wet_grooved.toml", "--json", "-")
rows = json.loads(text)
assert status == 0 and len(rows) == 2 * 4 * 2 and {r["surface"] for r in rows} == {"wet_smooth", "wet_grooved"}, (status, err)

with tempfile.TemporaryDirectory() as scratch:
    profile = pathlib.Path(scratch, "pressure.csv")
    profile.write_text("time_s,pressure_Pa\n0,0\n1,2e6\n2,2e6\n")
    moved = {road: run(LAB, "drive", *road, "--input", profile, "--csv", "-")
             for road in (("--runway", WET), ("--surface", "wet_asphalt"))}
    assert all(status == 0 for status, _, _ in moved.values()), moved
    assert len({text.splitlines()[-1] for _, text, _ in moved.values()}) == 2

    # A picture leaves no table: that is --trajectory's.
    alone = pathlib.Path(scratch, "picture")
    alone.mkdir()
    status, text, err = run(LAB, "stop", "--runway", WET, "--picture", alone / "stop.png")
    left = sorted(f.name for f in alone.iterdir())
    assert status == 0 and left == ["stop.charts.json", "stop.png", "stop.svg"], (status, err, left)

    bad = pathlib.Path(scratch, "bad.toml")
    bad.write_text("[[patch]]\nfrom_m = 0\nsurface = \"grass\"\n")
    for program in ((LAB, "stop"), (RIG, "--can", "nowhere0")):
        for arguments, says in ((("--runway", WET, "--surface", "ice"), "--surface"), (("--runway", bad), f"{bad}:3"),
                                (("--runway", "/nowhere.toml"), "/nowhere.toml")):
            status, text, err = run(*program, *arguments)
            assert status == 2 and says in err, (program, arguments, status, err)

    heavy = pathlib.Path("config/scenarios/heavy.toml").read_text()
    scenario = pathlib.Path(scratch, "heavy.toml")
    for change, says in (('runway = "runways/nowhere.toml"', "nowhere.toml"),
                         ('surface = "ice"\nrunway = "runways/wet_smooth.toml"', "heavy.toml:11: maneuver.runway")):
        scenario.write_text(heavy.replace('surface = "dry_asphalt"', change))
        status, text, err = run(RIG, "serve", "--can", "nowhere0", "--scenario", scenario)
        assert status == 2 and says in err, (change, status, err)
print("ok")
