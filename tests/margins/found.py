#!/usr/bin/python3
"""The shipped gains keep what config/margins.toml asks of stops; a search writes what it finds, and only that. [STUDY-561]

usage: found.py RIG_LAB
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib

LAB = sys.argv[1]


def tune(*arguments):
    done = subprocess.run([LAB, "tune", "--loop", "law", *map(str, arguments)], capture_output=True, text=True, timeout=500)
    print(done.stdout, done.stderr)
    return done


def changed(text, key, value):
    lines = [f"{key} = {value}" if line.startswith(f"{key} = ") else line for line in text.splitlines()]
    assert "\n".join(lines) + "\n" != text, key
    return "\n".join(lines) + "\n"


with tempfile.TemporaryDirectory() as scratch:
    scratch = pathlib.Path(scratch)
    done = tune("--check", "--out", scratch)
    shipped = json.loads((scratch / "results.json").read_text())["shipped"]
    assert done.returncode == 0 and "show what stops must show" in done.stdout, done.returncode
    # docs/engineering/margins.md: 4 of 256 cells, and 5 more of the law by itself, past the peak at low speed.
    assert shipped["margins"]["unstable"] <= 9 and shipped["closed_loop"]["faults"] is False
    assert set(shipped["closed_loop"]["drawn_j_mu"]) == {"ring", "relaxation", "parameters", "patches"}

    # Gains that lose the wheel, and a floor that no gains reach, are told.
    config = scratch / "config"
    shutil.copytree("config", config)
    margins = (config / "margins.toml").read_text()
    (config / "margins.toml").write_text(changed(changed(margins, "draws", 1), "least_gain", 1.0))
    controller = (config / "controller.toml").read_text()
    (config / "controller.toml").write_text(changed(controller, "k_d", "15.0"))
    done = tune("--check", "--config", config, "--out", scratch)
    assert done.returncode == 1 and "do not show" in done.stdout, done.returncode
    (config / "controller.toml").write_text(controller)
    done = tune("--check", "--config", config, "--floor", "0.999", "--out", scratch)
    assert done.returncode == 1 and "do not show what stops must show" in done.stdout, done.returncode

    # Four gains are no search; they show that it ends, takes the best, and writes it.
    other = scratch / "other.toml"
    other.write_text(controller)
    done = tune("--population", 4, "--generations", 0, "--config", config, "--write", other, "--out", scratch)
    results = json.loads((scratch / "results.json").read_text())
    assert done.returncode == 0 and results["evaluations"] >= 4
    assert results["tuned"]["margins"]["score"] >= results["shipped"]["margins"]["score"]
    found = tomllib.loads((scratch / "slip.toml").read_text())["slip"]
    was, now = tomllib.loads(controller), tomllib.loads(other.read_text())
    assert found == {key: results["tuned"][key] for key in found}
    assert now["slip"] == was["slip"] | found
    assert now | {"slip": was["slip"]} == was
    assert [a for a in other.read_text().splitlines() if a.startswith("#")] == [a for a in controller.splitlines() if a.startswith("#")]
