#!/usr/bin/python3
"""rig-lab robust: its files, its exit status, its grids, and what bad input gets. [STUDY-602]
[STUDY-602]

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

    grids = pathlib.Path(scratch, "grids")
    status, text, err = run("--families", "changes,brake_on", "--laws", "slip,told_peak", "--draws", 1, "--no-pictures", "--out", grids)
    results = json.loads((grids / "results.json").read_text())
    rows = list(csv.DictReader((grids / "stops.csv").open()))
    changes, brake_on = results["changes"], results["brake_on"]
    assert len(rows) == 2 * (252 + 98) == len(changes["changes"]) + len(brake_on["stops"]), (len(rows), err)
    assert [(s["law"], s["speed_mps"]) for s in brake_on["summaries"]] == [
        (law, v) for law in ("slip", "told_peak") for v in (12.0, 16.667, 20.0, 25.0, 30.0, 40.0, 61.0)], brake_on["summaries"]
    for row, stop in zip([r for r in rows if r["family"] == "brake_on"], brake_on["stops"]):
        assert abs(float(row["j_mu"]) - stop["j_mu"]) < 1e-6 and abs(float(row["valve_travel_mAps"]) - stop["valve_travel_mAps"]) < 0.06
        assert 0.5 < stop["held_j_mu"] <= 1.0 and stop["travel_ratio"] > 0.0, stop
    for law in ("slip", "told_peak"):
        whole = next(s for s in changes["summaries"] if (s["law"], s["of"]) == (law, "all"))
        own = [c for c in changes["changes"] if c["law"] == law]
        assert whole["changes"] == 252 and whole["measured"] == sum(c["measured"] for c in own), whole
        in_time = sum(c["measured"] and c["regained_s"] is not None and c["regained_s"] <= 0.4 for c in own)
        assert whole["within_0.4_s"] == in_time, whole
        assert f"| {law} | all | {whole['measured']} of 252 |" in text and f"| {law} | 61.0 | " in text, text
    for summary in results["families"]:
        told = summary["distance_over_told_peak"]
        assert told["mean"] == 1.0 if summary["law"] == "told_peak" else told["mean"] > 0.9, summary

    nowhere = pathlib.Path(scratch, "nowhere")
    for arguments, says in ((("--families", "rings"), "rings"), (("--laws", "bang"), "bang"), (("--laws", "slip,soonest"), "soonest"), (("--draws", 0), "--draws"),
                            (("--ranges", "/nowhere.toml"), "/nowhere.toml"), (("--config", "/nowhere"), "/nowhere")):
        status, text, err = run(*arguments, "--out", nowhere)
        assert status == 2 and says in err and not nowhere.exists(), (arguments, status, text, err)

    # A mistake in a file, found after another file was read: named, and nothing else comes of it.
    bad = pathlib.Path(scratch, "controller.toml")
    bad.write_text(pathlib.Path("config/controller.toml").read_text().replace("k_p_per_s = ", 'k_p_per_s = "fast" #', 1))
    status, text, err = run("--draws", 1, "--controller", bad, "--out", pathlib.Path(scratch, "nothing"))
    assert status == 2 and f"{bad}:" in err and "k_p_per_s" in err and not pathlib.Path(scratch, "nothing").exists(), (status, err)
print("ok")
