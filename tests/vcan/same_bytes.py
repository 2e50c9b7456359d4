#!/usr/bin/python3
"""[BRG-465] Three programs in lockstep, twice, with a shipped scenario and shipped configuration, from a flywheel at rest: the same seed gives the
same samples, frames and figures. Runs inside `./rig vcan`.

usage: same_bytes.py BUILD_DIR
"""
import json
import pathlib
import sys
import tempfile

from three_programs import PHASES, Rig, check, in_guest_memory, words

BUILD = pathlib.Path(sys.argv[1]).resolve()
SCENARIO, CONFIG = pathlib.Path("config/scenarios/rejected_takeoff.toml"), pathlib.Path("config")  # the shortest of them


def landed(folder, number):
    """Frames and samples without their labels of real time, and the figures."""
    place = folder / f"run{number}"
    place.mkdir()
    rig = Rig(BUILD, place, SCENARIO, CONFIG, sync_timeout_ms=20000, answer_timeout_ms=10000, together=True)
    run = rig.bridge("maneuver", place / "one")
    status = run.wait(timeout=250)
    rig.end()
    check(status == 0, f"rig-bridge: {status}\n{words(run)}")
    out = place / "one"
    frames = [line.split(" ", 1)[1] for line in (out / "bus.log").read_text().splitlines()]
    samples = [line.split(",", 1)[1] for line in (out / "modbus.csv").read_text().splitlines()]
    summary = json.loads((out / "summary.json").read_text())
    del summary["started"]
    return frames, samples, summary


def first_difference(one, other):
    for line, (a, b) in enumerate(zip(one, other)):
        if a != b:
            return f"line {line}: {a!r} and {b!r}; before: {one[max(0, line - 6):line]}"
    return f"{len(one)} and {len(other)} lines"


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        (frames_1, samples_1, figures_1), (frames_2, samples_2, figures_2) = (landed(pathlib.Path(name), n) for n in (1, 2))
    print(f"{len(frames_1)} frames, {len(samples_1)} samples, {figures_1['length_m']!r} m and {figures_2['length_m']!r} m")
    phases = {PHASES[int(frame.split("#")[1][2], 16)] for frame in frames_1 if " 191#" in frame}
    check(phases.issuperset(PHASES[PHASES.index("spin_up"):PHASES.index("retract") + 1]), f"recorded were {phases}")
    check(samples_1 == samples_2, "samples differ: " + first_difference(samples_1, samples_2))
    check(frames_1 == frames_2, "frames differ: " + first_difference(frames_1, frames_2))
    check(figures_1 == figures_2, f"figures differ:\n{figures_1}\n{figures_2}")
    print("same_bytes: passed")
