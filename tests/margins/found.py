#!/usr/bin/python3
"""The shipped gains are where the search of config/margins.toml ends (docs/margins.md): they keep what it asks, and no single step is better. [STUDY-563]

usage: found.py RIG_LAB
"""
import json
import pathlib
import subprocess
import sys
import tempfile

OTHERS = {"k_p_per_s": "100.0", "k_i_per_s2": "200.0", "k_d": "5.0", "k_dd_s": "0.008", "road_torque_share": "0.99",
          "low_speed_mps": "20.0", "low_speed_floor_mps": "5.0", "low_speed_slip": "0.1"}


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
    shipped = pathlib.Path("config/controller.toml").read_text()
    # --write has to bring back every gain of a file that has others, and nothing else.
    other = pathlib.Path(scratch, "controller.toml")
    other.write_text(with_gains(shipped, OTHERS))
    done = subprocess.run([sys.argv[1], "tune", "--loop", "law", "--check", "--write", other, "--out", scratch],
                          capture_output=True, text=True, timeout=500)
    print(done.stdout, done.stderr)
    results = json.loads(pathlib.Path(scratch, "results.json").read_text())
    assert done.returncode == 0 and "stay" in done.stdout, done.returncode
    assert results["tuned"] == results["shipped"] and results["shipped"]["margins"]["unstable"] == 0
    assert other.read_text() == shipped
