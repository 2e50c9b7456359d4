#!/usr/bin/python3
"""rig-lab margins and tune: what bad input gets, and that a study leaves its files. [STUDY-123]

usage: verb.py RIG_LAB
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

LAB = sys.argv[1]
CONFIG = pathlib.Path("config")


def check(what, good, detail=""):
    print(("ok      " if good else "FAILED  ") + what, detail if not good else "", flush=True)
    if not good:
        sys.exit(1)


def run(*arguments):
    done = subprocess.run([LAB, *map(str, arguments)], capture_output=True, text=True, timeout=300)
    return done.returncode, done.stdout, done.stderr


def line_of(text, key):
    return next(i for i, line in enumerate(text.splitlines(), 1) if line.startswith(key))


def refused(what, says, *arguments):
    """Each verb, with exit status 2, `says` on stderr and nothing else."""
    status, text, err = run(*arguments)
    check(f"{what} is refused", status == 2 and not text and all(s in err for s in says), f"{status} {text} {err}")


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    out = scratch / "out"
    good = (CONFIG / "margins.toml").read_text()
    config = scratch / "config"
    shutil.copytree(CONFIG, config)
    file = config / "margins.toml"

    def changed(before, after):
        assert before in good
        return good.replace(before, after)

    bad_files = [
        ("an unknown key", changed("gain_margin_dB", "gain_margin_db"), "gain_margin_db", ["gain_margin_dB"]),
        ("a value out of range", changed("phase_margin_deg = 30.0", "phase_margin_deg = 130.0"), "phase_margin_deg", ["130", "0 to 90"]),
        ("a value that is no number", changed("k_d = ", "k_d = nan #"), "k_d", []),
        ("a value of another type", changed("schedule = 1.15", 'schedule = "1.15"'), "schedule", []),
        ("a PID that holds nothing", "\n".join("k_p_per_s = 0.0" if line.startswith("k_p_per_s = 7") else "k_i_per_s2 = 0.0"
                                               if line.startswith("k_i_per_s2 = 5") else line for line in good.splitlines()) + "\n", "k_p_per_s", []),
        ("a gain whose start is not between its ends", changed("k_d = [1.0, 4.0,", "k_d = [1.0, 0.5,"), "k_d = [", []),
        ("a gain that is not searched", changed("[law.gains]\n", "[law.gains]\nwheel_bandwidth_radps = [1.0, 2.0, 3.0]\n"), "wheel_bandwidth_radps", ["unknown"]),
        ("a search that is none", changed("population = 16", "population = 3"), "population", ["4 to 1000"]),
        ("a file that is no TOML", changed("[requirement]", "[requirement"), "[requirement", []),
    ]
    for verb in ("margins", "tune"):
        for what, text, key, says in bad_files:
            file.write_text(text)
            refused(f"{verb}: {what}", [f"{file}:{line_of(text, key)}", *says], verb, "--config", config, "--out", out)
        file.write_text(changed("schedule = 1.15\n", ""))
        refused(f"{verb}: a missing key", [str(file), "schedule"], verb, "--config", config, "--out", out)
        file.unlink()
        refused(f"{verb}: a missing file", [str(file), "No such file"], verb, "--config", config, "--out", out)
        refused(f"{verb}: a missing directory", ["/nowhere"], verb, "--config", "/nowhere", "--out", out)
        file.write_text(good)
        refused(f"{verb}: an option nobody knows", ["--margin"], verb, "--margin", 6, "--out", out)
        for option, value in (("--slip", "0.7"), ("--slip", "nan"), ("--slip", "much"), ("--speeds", 1), ("--speeds", "2.5")):
            refused(f"{verb}: {option} {value}", [option], verb, option, value, "--out", out)
        check(f"{verb} left nothing", not out.exists())
        (scratch / "file").write_text("")
        refused(f"{verb}: a directory that cannot be made", [str(scratch / "file")], verb, "--out", scratch / "file" / "out")
    for option, value in (("--loop", "fuzzy"), ("--population", 3), ("--generations", -1), ("--floor", 1.5), ("--floor", "nan"), ("--seed", "x")):
        refused(f"tune: {option} {value}", [option], "tune", option, value, "--out", out)
    for option, value in (("--picture-speed", 4), ("--picture-speed", "nan"), ("--controller", "/nowhere.toml")):
        refused(f"margins: {option} {value}", ["/nowhere.toml" if option == "--controller" else option], "margins", option, value, "--out", out)
    maneuvers = config / "maneuvers.toml"
    shipped = maneuvers.read_text()
    maneuvers.write_text(shipped.replace("speed_mps = 49.0", "speed_mps = 30.0"))
    refused("margins: a picture at a speed that a maneuver never has", ["--picture-speed", "5 to 30"], "margins", "--config", config,
            "--picture-speed", 40, "--out", out)
    maneuvers.write_text(shipped)
    refused("tune: --check of the PID", ["--loop law"], "tune", "--check", "--out", out)
    refused("tune: --check and --write", ["--write"], "tune", "--loop", "law", "--check", "--write", CONFIG / "controller.toml", "--out", out)
    refused("tune: --write of the PID", ["--loop law"], "tune", "--write", CONFIG / "controller.toml", "--out", out)
    for says, *bad in (("--tyre", "--tyre", "solid"), ("--frequency", "--frequency", 80), ("--length", "--tyre", "ring", "--length", 0.2),
                       ("--damping", "--tyre", "relaxation", "--damping", 0.1), ("--frequency", "--tyre", "ring", "--frequency", "80,4"),
                       ("--belt-share", "--tyre", "ring", "--belt-share", "nan"), ("--floor", "--tyre", "relaxation", "--floor", 0)):
        refused(f"margins: {' '.join(map(str, bad))}", [says], "margins", *bad, "--out", out)
    refused("margins: --mu-b nan", ["--mu-b", "nan"], "margins", "--mu-b", "nan", "--out", out)
    check("and all that left nothing", not out.exists())

    status, text, err = run("tune", "--population", 4, "--generations", 0, "--speeds", 2, "--out", out)
    results = json.loads((out / "results.json").read_text())
    check("a short search succeeds and says how far it is", status == 0 and "4 of 4 gains judged" in err, f"{status} {err}")
    check("and says what it took and what it found",
          results["evaluations"] == 4 and results["seed"] == 1 and results["tuned"]["margins"]["score"] >= results["shipped"]["margins"]["score"])
    infeasible = {(row["surface"], row["maneuver"]) for row in results["infeasible_at_constant_slip"]}
    creeping = {row["surface"]: row for row in results["creeping"] if row["maneuver"] == "heavy"}
    check("so are those that the law cannot meet, worst on the surface that peaks last",
          min(creeping, key=lambda name: creeping[name]["upward_margin_dB"]) == "dry_cobblestone" and "snow" not in creeping
          and "| dry_cobblestone | heavy |" in text.split("Where the shipped law cannot have")[1], str(creeping))
    check("the cells that no controller can meet are listed on screen and in the file", len(infeasible) == 11
          and all(f"| {surface} | {maneuver} |" in text for surface, maneuver in infeasible), text)

    def margins_of(*arguments):
        status, text, err = run("margins", "--speeds", 2, "--out", out, *arguments)
        check(f"margins {' '.join(map(str, arguments))}", status == 0, err)
        return json.loads((out / "results.json").read_text()), text

    own = CONFIG / "landing_gear.toml"
    (config / own.name).write_text(own.read_text() + '[tyre]\nmodel = "ring"\nbelt_share = 0.45\nfrequency_Hz = 50.0\ndamping = 0.03\n')
    file.write_text(good)
    ring, text = margins_of("--tyre", "ring", "--frequency", 50, "--damping", 0.03, "--belt-share", 0.45)
    check("the ring's swing is told", "ring 50 Hz, damping 0.03, belt 0.45" in text and "swings up by itself" in text
          and all(cell["wheel_swing_radps"] > 0 for cell in ring["cells"]), text)
    of_file, _ = margins_of("--config", config)
    check("the rig file's tyre is the same", of_file["cells"] == ring["cells"] and of_file["tyre"] == ring["tyre"])
    static, _ = margins_of()
    check("without one the tyre is the paper's", static["tyre"] == "static" and static["cells"] != ring["cells"]
          and all(cell["wheel_swing_radps"] is None for cell in static["cells"]))
    check("and so it is on request", margins_of("--config", config, "--tyre", "static")[0]["cells"] == static["cells"])
    table, text = margins_of("--tyre", "ring", "--frequency", "50,120", "--damping", 0.03, "--belt-share", 0.45)
    stable = sum(cell["law"]["full"]["stable"] for cell in ring["cells"])
    swings = sum(cell["wheel_swing_growth_per_s"] > 0 for cell in ring["cells"])
    check("lists make a table by tyre", [row["tyre"].split(",")[0] for row in table["tyres"]] == ["ring 50 Hz", "ring 120 Hz"]
          and text.count("| ring ") == 2 and (table["tyres"][0]["stable"], table["tyres"][0]["wheel_swings_up"]) == (stable, swings), text)
    check("a stiffer carcass swings up in fewer cells", table["tyres"][1]["wheel_swings_up"] < swings, text)
    relaxed, _ = margins_of("--tyre", "relaxation", "--length", 0.3)
    check("a relaxation length changes margins, too", relaxed["cells"] != static["cells"])
