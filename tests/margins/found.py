#!/usr/bin/python3
"""The gains that the search of config/margins.toml ends with (docs/margins.md) keep what it asks, and no single step is better. [STUDY-563]

usage: found.py RIG_LAB
"""
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile

FOUND = {"k_p_per_s": "88.4", "k_i_per_s2": "165.0", "k_d": "8.38", "k_dd_s": "0.009", "road_torque_share": "0.991",
         "low_speed_mps": "24.4", "low_speed_floor_mps": "7.94", "low_speed_slip": "0.118"}


def with_gains(text, gains):
    table, changed, lines = "", [], text.splitlines(keepends=True)
    for i, line in enumerate(lines):
        table = line.strip() if line.startswith("[") else table
        key, _, value = line.rstrip("\n").partition(" = ")
        if table == "[slip]" and key in gains:
            lines[i] = line.replace(value, gains[key])
            changed.append(key)
    assert sorted(changed) == sorted(gains), changed
    return "".join(lines)


with tempfile.TemporaryDirectory() as scratch:
    config = pathlib.Path(scratch, "config")
    shutil.copytree("config", config)
    shipped = (config / "controller.toml").read_text()
    found = with_gains(shipped, FOUND)
    (config / "controller.toml").write_text(found)
    # --write has to bring back every gain of a file that has others, and nothing else.
    other = pathlib.Path(scratch, "controller.toml")
    other.write_text(shipped)
    done = subprocess.run([sys.argv[1], "tune", "--loop", "law", "--check", "--config", config, "--write", other, "--out", scratch],
                          capture_output=True, text=True, timeout=500)
    print(done.stdout, done.stderr)
    results = json.loads(pathlib.Path(scratch, "results.json").read_text())
    assert done.returncode == 0 and "stay" in done.stdout, done.returncode
    assert results["tuned"] == results["shipped"] and results["shipped"]["margins"]["unstable"] == 0
    assert other.read_text() == found
