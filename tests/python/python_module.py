#!/usr/bin/python3
"""[STUDY-800] [STUDY-810] The Python module gives what the programs give, and closes the loop with a controller written in Python.

Usage: python_module.py DIRECTORY_OF_THE_MODULE RIG_LAB, from the project root.
"""
import ast
import contextlib
import io
import json
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import warnings

sys.path.insert(0, sys.argv[1])
import numpy  # noqa: E402

import antiskid  # noqa: E402

LAB = sys.argv[2]


def by_program(*options):
    return json.loads(subprocess.run([LAB, "stop", *options, "--json", "-"], check=True, capture_output=True, text=True).stdout)


def same_as_the_program():
    assert antiskid.stop() == by_program()
    options = ("--maneuver", "light", "--surface", "wet_asphalt", "--law", "threshold", "--seed", "5", "--mu-b", "0.3")
    assert antiskid.stop(maneuver="light", surface="wet_asphalt", law="threshold", seed=5, mean_friction=0.3) == by_program(*options)


def recorded():
    scenario = antiskid.Scenario(surface="snow")
    figures, columns = scenario.recorded_stop()
    assert figures == scenario.stop()
    assert {len(column) for column in columns.values()} == {len(columns["time_s"])} and columns["time_s"].dtype == float
    assert numpy.allclose(numpy.diff(columns["time_s"]), 1e-3)
    assert abs(columns["energy_brake_J"][-1] / figures["energy_brake_J"] - 1) < 1e-3


def closed_in_python(scenario):
    rig, controller = scenario.rig(), scenario.controller()
    while not rig.done:
        rig.apply(controller.step(rig.sensors(), rig.now_s))
    return rig.figures()


def batches():
    scenario = antiskid.Scenario(maneuver="light", surface="wet_asphalt")
    slip = numpy.array([0.1, 0.24, 0.4])
    table = scenario.stops(slip)
    assert (table["slip_reference"] == slip).all() and (table["standstill"] == 1).all()
    for threads in (1, 2):
        again = scenario.stops(slip, seed=[1, 1, 1], threads=threads)
        assert all(numpy.array_equal(table[name], again[name], equal_nan=True) for name in table)
    assert scenario.stops([0.24], seed=[2])["stop_distance_m"] != table["stop_distance_m"][1]
    figures = closed_in_python(scenario)
    for name in table:
        if name not in ("tracked_share", "slip_reference"):
            assert figures[name] == table[name][1], f"{name}: {figures[name]} in Python, {table[name][1]} natively"
    assert figures["faults"] == []


def own_sensors():
    """The controller with sensors made in Python: the same stop; and with a gauge that reads what no brake has."""
    scenario = antiskid.Scenario(maneuver="light", surface="wet_asphalt")
    names = [name for name in vars(antiskid.Sensors) if not name.startswith("_")]
    rig, controller = scenario.rig(), scenario.controller()
    assert controller.step(antiskid.Sensors(), rig.now_s).current_mA == controller.step(antiskid.Sensors(), rig.now_s).current_mA
    assert antiskid.Sensors().wheel_received_s != antiskid.Sensors().wheel_received_s  # nan: never
    controller = scenario.controller()
    while not rig.done:
        heard, made = rig.sensors(), antiskid.Sensors()
        for name in names:
            setattr(made, name, getattr(heard, name))
        rig.apply(controller.step(made, rig.now_s))
    assert rig.figures() == closed_in_python(scenario)
    rig, controller = scenario.rig(), scenario.controller()
    while not rig.done:
        sensors = rig.sensors()
        if rig.braking:
            sensors.pressure_Pa = 1e9
        rig.apply(controller.step(sensors, rig.now_s))
    assert any("pressure" in fault for fault in rig.figures()["faults"]), rig.figures()["faults"]


def page():
    """The law of the page, which anybody may begin with."""
    text = pathlib.Path("docs/user/python.md").read_text()
    blocks = re.findall(r"(?:^    .*\n|^\n(?=    ))+", text, re.M)
    laws = [re.sub("^    ", "", block, flags=re.M) for block in blocks if "rig.advance" in block]
    assert len(laws) == 1 and len(laws[0].strip().splitlines()) <= 20
    found, said = {}, io.StringIO()
    with contextlib.redirect_stdout(said):
        exec(laws[0], found)
    figures = found["rig"].figures()
    assert figures["standstill"] and figures["longest_lock_s"] == 0 and figures["j_mu"] > 0.85, figures
    assert f"{figures['stop_distance_m']:.1f} m" in said.getvalue()
    try:
        found["rig"].advance(0.0)
    except RuntimeError as error:
        assert "over" in str(error)
    else:
        raise AssertionError("a maneuver that is over went on")


def logs():
    with tempfile.TemporaryDirectory() as folder:
        subprocess.run([LAB, "stop", "--bus-log", f"{folder}/bus.log"], check=True, capture_output=True)
        columns = antiskid.read_log(f"{folder}/bus.log")
        assert len(columns["time_s"]) > 5000 and {len(column) for column in columns.values()} == {len(columns["time_s"])}
        _, truth = antiskid.Scenario().recorded_stop()
        braking = columns["speed_mps"] > 20
        recorded = numpy.interp(columns["time_s"][braking], truth["time_s"] - 1e-3, truth["speed_mps"])
        assert numpy.abs(columns["speed_mps"][braking] - recorded)[500:].max() < 0.1
        with open(f"{folder}/bus.log", "a") as log:
            log.write("nonsense")
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            antiskid.read_log(f"{folder}/bus.log")
        assert any("malformed_line" in str(warning.message) for warning in said)
        try:
            antiskid.read_log(f"{folder}/none.log")
        except RuntimeError as error:
            assert f"{folder}/none.log" in str(error)
        else:
            raise AssertionError("a log that is not there was read")


def refused(kind, words, **keywords):
    try:
        antiskid.Scenario(**keywords)
    except kind as error:
        assert words in str(error), error
    else:
        raise AssertionError(f"{keywords} was taken")


def others_run():
    """Another thread runs while stops do."""
    scenario, counted, over = antiskid.Scenario(), [0], threading.Event()

    def count():
        while not over.wait(1e-3):
            counted[0] += 1

    thread = threading.Thread(target=count)
    thread.start()
    scenario.stops([0.24] * 50)
    during = counted[0]
    over.set()
    thread.join()
    assert during > 2, during


def stub():
    """It has the names that there are."""
    tree = ast.parse((pathlib.Path(antiskid.__file__).parent / "__init__.pyi").read_text())
    typed = {node.name: node for node in tree.body if isinstance(node, (ast.ClassDef, ast.FunctionDef))}
    assert set(antiskid.__all__) == set(typed) - {"Keywords"}
    for name, node in typed.items():
        if not isinstance(node, ast.ClassDef) or name == "Keywords":
            continue
        described = {item.name for item in node.body if isinstance(item, ast.FunctionDef)} | {
            item.target.id for item in node.body if isinstance(item, ast.AnnAssign)}
        there = {item for item in vars(getattr(antiskid, name)) if not item.startswith("_")}
        assert described - {"__init__"} == there, f"{name}: {described ^ there}"
    keywords = {item.target.id for item in typed["Keywords"].body if isinstance(item, ast.AnnAssign)}
    refused(TypeError, ", ".join(re.findall(r"\w+", "maneuver surface runway")), speed=3)
    try:
        antiskid.Scenario(speed=3)
    except TypeError as error:
        assert keywords == set(str(error).split("there are: ")[1].split(", "))


same_as_the_program()
recorded()
batches()
own_sensors()
logs()
page()
refused(ValueError, "out of range 0 to 0.5", slip=0.7)
refused(ValueError, "none of slip", law="magic")
refused(RuntimeError, "dry_asphalt", surface="dri_asphalt")
others_run()
stub()
