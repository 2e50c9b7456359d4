#!/usr/bin/python3
"""rig-lab robust: its files, its exit status, and what bad input gets. [STUDY-604] [STUDY-615] [STUDY-616]

usage: verb.py RIG_LAB
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile

LAB = sys.argv[1]


def run(*arguments):
    done = subprocess.run([LAB, "robust", *map(str, arguments)], capture_output=True, text=True, timeout=250)
    return done.returncode, done.stdout, done.stderr


with tempfile.TemporaryDirectory() as scratch:
    out = pathlib.Path(scratch, "out")
    status, text, err = run("--families", "paper,relaxation", "--laws", "slip,threshold", "--draws", 2, "--seed", 5, "--out", out)
    rows = list(csv.DictReader((out / "stops.csv").open()))
    results = json.loads((out / "results.json").read_text())
    assert len(rows) == 8 and {r["law"] for r in rows} == {"slip", "threshold"}, rows
    assert results["seed"] == 5 and [(f["family"], f["law"]) for f in results["families"]] == [
        (family, law) for family in ("paper", "relaxation") for law in ("slip", "threshold")], results
    for summary in results["families"]:
        own = [float(r["j_mu"]) for r in rows if r["family"] == summary["family"] and r["law"] == summary["law"]]
        assert abs(sum(own) / len(own) - summary["mean_j_mu"]) < 1e-6 and abs(min(own) - summary["worst_j_mu"]) < 1e-6
    tripped = any(r["law"] == "slip" and r["faults"] != "0" for r in rows)
    assert status == (1 if tripped else 0), (status, rows)
    assert "| paper | slip | 2 |" in text and str(out) in text, text
    assert (out / "robust.png").read_bytes().startswith(b"\x89PNG") and "robust.png" in text, text
    for summary in results["families"]:
        worst = min((r for r in rows if (r["family"], r["law"]) == (summary["family"], summary["law"])), key=lambda r: float(r["j_mu"]))
        assert (summary["worst_draw"], summary["worst_is"]) == (int(worst["draw"]), worst["what"]), (summary, worst)
        assert f"{summary['family']}, {summary['law']}: worst: draw {worst['draw']} ({worst['what']})" in text, text

    again = pathlib.Path(scratch, "again")
    status, text, err = run("--families", "paper,relaxation", "--laws", "slip,threshold", "--draws", 2, "--seed", 5, "--threads", 1,
                            "--no-pictures", "--out", again)
    for file in ("stops.csv", "results.json"):
        assert (again / file).read_bytes() == (out / file).read_bytes(), "threads change the bytes of " + file
    assert sorted(p.name for p in again.iterdir()) == ["results.json", "stops.csv"] and "robust.png" not in text, text

    nowhere = pathlib.Path(scratch, "nowhere")
    for arguments, says in ((("--families", "rings"), "rings"), (("--laws", "bang"), "bang"), (("--draws", 0), "--draws"),
                            (("--ranges", "/nowhere.toml"), "/nowhere.toml"), (("--config", "/nowhere"), "/nowhere")):
        status, text, err = run(*arguments, "--out", nowhere)
        assert status == 2 and says in err and not nowhere.exists(), (arguments, status, text, err)
print("ok")
