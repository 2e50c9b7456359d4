#!/usr/bin/python3
"""rig-lab regulate as its users meet it: results, exit status, threads, refusals. [STUDY-167] [STUDY-171]

usage: verb.py RIG_LAB
"""
import csv
import json
import pathlib
import signal
import subprocess
import sys
import tempfile

LAB = sys.argv[1]


def run(*arguments):
    child = subprocess.run([LAB, "regulate", *map(str, arguments)], capture_output=True, text=True, timeout=500)
    return child.returncode, child.stdout, child.stderr


def check(what, good, detail=""):
    print(("ok      " if good else "FAILED  ") + what, detail if not good else "")
    if not good:
        sys.exit(1)


def status_after(number, *arguments):
    """Of a run that gets a signal as soon as it says how far it is."""
    child = subprocess.Popen([LAB, "regulate", *map(str, arguments)], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    child.stderr.readline()
    child.send_signal(number)
    child.communicate(timeout=100)
    return child.returncode


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    short = ["--lives", 2, "--landings", 4, "--no-floor-check"]
    # Four landings of a plan for 256 use hardly anything: said, and exit status 0, since nothing was feasible.
    status, text, progress = run(*short, "--out", scratch / "one", "--threads", 1)
    check("exit status", status == 0, text + progress)
    check("what cannot be is said", "not feasible at landing 4" in text and "whatever the reference" in text, text)
    check("how far it is", "of 64 maneuvers" in progress, progress)
    status, _, _ = run(*short, "--out", scratch / "two", "--threads", 2)
    for name in ("results.json", "landings.csv"):
        check(f"{name}: the same bytes with two threads",
              (scratch / "one" / name).read_bytes() == (scratch / "two" / name).read_bytes())
    check("a picture", (scratch / "one/regulate.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n")
    results = json.loads((scratch / "one/results.json").read_text())
    check("what the results are of", all(results[key] for key in ("config_hash", "version", "seed")), results)
    names = [p["name"] for p in results["policies"]]
    check("all policies", {"one reference for all", "told the surface", "fixed 0.24", "the bound's own"} <= set(names), names)
    rows = list(csv.DictReader((scratch / "one/landings.csv").open()))
    regulated = [r for r in rows if r["policy"] == "one reference for all" and r["life"] == "1"]
    check("it begins with the default and moves by the step",
          regulated[0]["slip_reference"] == "0.240000" and regulated[1]["slip_reference"] == "0.260000", regulated[:2])
    last = regulated[3]
    life = results["policies"][0]["lives"][0]
    check("table and results agree",
          abs(float(last["brake_J"]) / life["brake_budget_J"] - life["brake_used_at_plan"]) < 1e-6, (last, life))

    # A visit that costs nothing need not be shared.
    check("at the shipped prices sharing pays", "DOES NOT PAY" not in text.upper(), text)
    file = (pathlib.Path("config/regulation.toml").read_text()
            .replace("visit = 800.0", "visit = 0.0").replace('"regulation_floor.toml"', '"floor.toml"'))
    (scratch / "free.toml").write_text(file)
    (scratch / "floor.toml").write_text(pathlib.Path("config/regulation_floor.toml").read_text())
    _, free, _ = run("--lives", 2, "--by-table", "--regulation", scratch / "free.toml", "--out", scratch / "free")
    check("where it does not pay, that is said by policy", 'DOES NOT PAY' in free and "one reference for all" in free, free)
    by_table = json.loads((scratch / "free/results.json").read_text())
    check("no policy is below the bound", all(p["cost_above_bound"] > -0.01 for p in by_table["policies"]), by_table["policies"])

    check("Ctrl-C ends with 130", status_after(signal.SIGINT, "--no-floor-check", "--out", scratch / "stopped") == 130)
    check("another signal with 1", status_after(signal.SIGTERM, "--characterise", scratch / "floor_new.toml") == 1)
    check("and without a file", not (scratch / "floor_new.toml").exists())

    status, _, error = run("--missing", 2)
    check("a share above 1 is refused", status == 2 and "--missing" in error, error)
    status, _, error = run("--surfaces", "ice,grass")
    check("a surface that nobody knows is refused by name", status == 2 and "grass" in error, error)
    status, text, _ = run(*short, "--surfaces", "dry_asphalt", "--out", scratch / "few")
    few = json.loads((scratch / "few/results.json").read_text())
    check("fewer surfaces allow more", few["range"]["highest"] > results["range"]["highest"] + 0.01, few["range"])
    status, _, error = run("--regulation", scratch / "nowhere.toml")
    check("a plan that is not there is refused by name", status == 2 and "nowhere.toml" in error, error)

    # A fleet.
    few = ["fleet", "--aircraft", 2, "--fleets", 2, "--seed", 7]
    status, text, progress = run(*few, "--out", scratch / "fleet", "--threads", 1)
    check("a fleet", status == 0 and "of 15 fleets" in progress, text + progress)
    check("each idea is judged", text.count(" +- ") >= 15 and "Moving wear so that visits do not collide" in text, text)
    run(*few, "--out", scratch / "fleet_two", "--threads", 2)
    for name in ("fleet.json", "visits.csv"):
        check(f"{name}: the same bytes with two threads",
              (scratch / "fleet" / name).read_bytes() == (scratch / "fleet_two" / name).read_bytes())
    check("a picture of visits", (scratch / "fleet/fleet.png").read_bytes()[:8] == b"\x89PNG\r\n\x1a\n")
    fleet = json.loads((scratch / "fleet/fleet.json").read_text())
    parts = ("brake", "tyre", "visit", "ground", "distance")
    check("costs add up", all(abs(p["cost_per_landing"] - sum(p[part] for part in parts)) < 1e-9 for p in fleet["policies"]), fleet["policies"])
    visits = list(csv.DictReader((scratch / "fleet/visits.csv").open()))
    check("six fleets of two aircraft under every policy", {v["policy"] for v in visits} == {p["name"] for p in fleet["policies"]}
          and {(v["fleet"], v["aircraft"]) for v in visits} == {(str(f), str(a)) for f in range(1, 7) for a in (1, 2)})
    status, _, error = run("fleet", "--bays", 0)
    check("a shop without a bay is refused", status == 2 and "--bays" in error, error)
    check("Ctrl-C ends a fleet with 130", status_after(signal.SIGINT, "fleet", "--out", scratch / "stopped") == 130)
