#!/usr/bin/python3
"""[BRG-360] [BRG-370] Logs that python-can and can-utils wrote say what the candump log of the same frames says.

Usage: foreign_logs.py RIG_LAB RIG_REPLAY, from the project root.
"""
import csv
import gzip
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import can

LAB, REPLAY = sys.argv[1:3]
EXAMPLE = pathlib.Path("config/import_bus_example.toml").read_text()
KINDS = ("asc", "blf", "trc")


def run(*command, status=0, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, **more)
    assert done.returncode == status, f"{command}: status {done.returncode}\n{done.stdout}{done.stderr}"
    return done.stdout + done.stderr


def figures(folder):
    summary = json.loads((folder / "summary.json").read_text())
    return {key: value for key, value in summary.items() if key not in ("started", "campaign")}


def frames_of(candump):
    """Microseconds since the first, identifier and data."""
    lines = [line.split() for line in candump.read_text().splitlines()]
    times = [int(line[0].strip("()").replace(".", "")) for line in lines]
    return [(time - times[0], line[2]) for time, line in zip(times, lines)]


class Logs:
    def __init__(self, directory):
        self.directory = directory
        self.folders = 0

    def write(self, name, text):
        (self.directory / name).write_text(text)
        return self.directory / name

    def written_by_python_can(self, candump, name):
        """candump's frames as each of KINDS."""
        paths = [self.directory / f"{name}.{kind}" for kind in KINDS]
        writers = [can.Logger(path) for path in paths]
        for message in can.CanutilsLogReader(candump):
            message.channel = 0
            for writer in writers:
                writer(message)
        for writer in writers:
            writer.stop()
        return paths

    def imported(self, log, map_file, *more, status=0, **environment):
        self.folders += 1
        out = self.directory / f"import{self.folders}"
        said = run(REPLAY, "import", log, "--map", map_file, "--out", out, *more, status=status, env={**os.environ, **environment})
        return out / "0001", said

    def exported(self, log, name, *more):
        option = {".csv": "--csv", ".mat": "--mat", ".log": "--candump"}[pathlib.Path(name).suffix]
        run(REPLAY, "export", log, option, self.directory / name, *more)
        return self.directory / name


def map_text(dbc, binding):
    config = pathlib.Path("config").resolve()
    text = EXAMPLE.replace('"foreign.dbc"', f'"{config / dbc}"').replace('"foreign_binding.toml"', f'"{config / binding}"')
    return text.replace("after_s = 0.5", "after_s = 0.1")


def same_import(logs, candump, written, map_file):
    """Of every log the maneuver of the candump log; returns that."""
    reference, said = logs.imported(candump, map_file)
    assert "warning" not in said, said
    for log in written:
        folder, said = logs.imported(log, map_file)
        assert "warning" not in said, said
        assert (folder / "bus.log").read_bytes() == (reference / "bus.log").read_bytes(), f"{log}: other frames"
        assert figures(folder) == figures(reference), f"{log}: other figures"
    return reference


def close(folder, recorded, tolerances):
    new, old = figures(folder), figures(recorded)
    for key, tolerance in tolerances.items():
        assert abs(new[key] / old[key] - 1) < tolerance, f"{key}: {new[key]}, recorded {old[key]}"


def damaged(logs, written, map_file):
    asc, blf, trc = written
    for log, cut, words in (
        (asc, 0.7, "ends within a line"), (trc, 0.7, "ends within a line"), (blf, 0.7, "truncated"), (blf, 0.5, "shorter than its head says"),
    ):
        data = log.read_bytes()
        length = int(len(data) * cut)
        if log == blf and cut == 0.5:
            length = data.index(b"LOBJ", length)  # between two containers
        broken = logs.directory / f"cut{log.suffix}"
        broken.write_bytes(data[:length])
        said = run(REPLAY, "export", broken, "--candump", logs.directory / "cut.log")
        assert f"{broken}:" in said and "cut off or damaged after frame" in said, said
        assert words in said or "unpack" in said, said
        assert (logs.directory / "cut.log").stat().st_size > 0
    _, said = logs.imported(logs.directory / "cut.asc", map_file)
    assert "recording_broken: 0001 while braking" in said and "copy it from its recorder again" in said, said
    packed = logs.directory / "packed.asc.gz"
    packed.write_bytes(gzip.compress(asc.read_bytes())[:-1000])
    assert "end-of-stream marker" in run(REPLAY, "export", packed, "--candump", logs.directory / "packed.log")


def unreadable(logs, written, map_file):
    asc, blf, trc = written
    text = asc.read_text()
    for log, words in (
        (logs.write("relative.asc", text.replace("timestamps absolute", "timestamps relative")), "save it with absolute times"),
        (logs.write("other.trc", trc.read_text().replace("FILEVERSION=2.1", "FILEVERSION=3.0")), "TRC 1.0, 1.1 or 2.1"),
        (logs.write("garbage.blf", "LOGG and no more"), "no frame can be read"),
        (logs.write("night.mf4", "MDF     4.10    "), "export('asc', '"),
    ):
        for verb in ("import", "controller"):
            said = logs.imported(log, map_file, status=1)[1] if verb == "import" else run(REPLAY, verb, log, status=1)
            assert f"{log}: " in said and words in said, said
    assert "single_time_base" in logs.imported(logs.directory / "night.mf4", "config/import_example.toml", status=1)[1]
    logs.write("can.py", "raise ImportError('not here')")
    said = logs.imported(blf, map_file, status=1, PYTHONPATH=str(logs.directory))[1]
    assert f"{blf}: " in said and "apt install python3-can" in said, said


def exports(logs, candump, written, recorded):
    table = logs.exported(candump, "a.csv")
    assert logs.exported(written[1], "b.csv").read_bytes() == table.read_bytes()
    rows = list(csv.reader(table.open()))
    assert rows[0][:4] == ["time_s", "speed_mps", "wheel_rim_speed_mps", "wheel_speed_radps"], rows[0]
    times = [float(row[0]) for row in rows[1:]]
    assert times[0] == 0 and all(a < b for a, b in zip(times, times[1:])) and {len(row) for row in rows} == {len(rows[0])}
    parquet, own = logs.directory / "a.parquet", logs.directory / "own.csv"
    for options, source in (((), table), (("--csv", own), own)):
        said = run(REPLAY, "export", candump, "--parquet", parquet, *options, status=2)
        assert f"{parquet}: Parquet is not written" in said and f"pandas.read_csv('{source}').to_parquet('{parquet}')" in said, said
        assert not parquet.exists() and not own.exists()
    maneuvers = EXAMPLE[EXAMPLE.index("[maneuvers]"):].replace("after_s = 0.5", "after_s = 0.1")
    signals = {"wheel_speed": ("wheel_speed_radps", "rad/s"), "flywheel_speed": ("speed_mps", "m/s"), "pressure": ("pressure_Pa", "Pa"),
               "vertical_load": ("vertical_load_N", "N"), "longitudinal_force": ("longitudinal_force_N", "N"),
               "brake_torque": ("brake_torque_Nm", "Nm"), "brake_temperature": ("brake_temperature_C", "degC")}
    columns = "".join(f'{key} = {{ column = "{name}", unit = "{unit}" }}\n' for key, (name, unit) in signals.items())
    for file, form in ((table, 'format = "csv"\nheader_row = 1\nfirst_data_row = 2\n'), (logs.exported(written[1], "a.mat"), 'format = "mat"\n')):
        head = f'scenario = "endurance"\n[file]\n{form}[time]\ncolumn = "time_s"\nunit = "s"\n[signals]\n{columns}'
        folder, _ = logs.imported(file, logs.write("back.toml", head + maneuvers))
        close(folder, recorded, {"energy_brake_J": 1e-3, "mean_friction": 1e-3, "mean_load_N": 1e-3, "duration_s": 0.02})
    for log in written:
        assert frames_of(logs.exported(log, "frames.log")) == frames_of(candump), f"{log}: other frames"
    assert "expected --csv, --mat or --candump" in run(REPLAY, "export", candump, status=2)


def foreign_kinds(logs):
    """What is no data frame of a rig is given as such, and counted."""
    odd = [can.Message(timestamp=1.0, arbitration_id=0x110, data=[1, 2], is_extended_id=False),
           can.Message(timestamp=2.0, arbitration_id=0x18FF0000, data=[3]),
           can.Message(timestamp=3.0, arbitration_id=0x111, is_remote_frame=True, dlc=4, is_extended_id=False),
           can.Message(timestamp=4.0, is_error_frame=True),
           can.Message(timestamp=5.0, arbitration_id=0x112, data=bytes(12), is_fd=True, is_extended_id=False),
           can.Message(timestamp=6.0, arbitration_id=0x113, data=[], is_extended_id=False)]
    for kind in ("asc", "blf"):
        log = logs.directory / f"odd.{kind}"
        with can.Logger(log) as writer:
            for message in odd:
                message.channel = 0  # ASCWriter writes error frames on no other
                writer(message)
        said = run(REPLAY, "export", log, "--candump", logs.directory / "odd.log")
        lines = [line.split() for line in (logs.directory / "odd.log").read_text().splitlines()]
        assert [line[1] for line in lines] == ["can1"] * 5, lines
        wanted = ["110#0102", "18FF0000#03", "111#R4", "20000080#0000000000000000", "113#"]
        assert [line[2] for line in lines] == wanted, lines
        assert "fd_frame 1" in said and "error_frame 1" in said, said


def main():
    with tempfile.TemporaryDirectory() as directory:
        logs = Logs(pathlib.Path(directory))
        recorded = logs.directory / "recorded"
        # From 32 m/s: every frame is read many times.
        endurance = pathlib.Path("config/scenarios/endurance.toml").read_text()
        controller = pathlib.Path("config/controller_endurance.toml").resolve()
        slow = endurance.replace('"controller_endurance.toml"', f'"{controller}"').replace("[law]", "speed_mps = 32.0\n\n[law]")
        run(LAB, "maneuver", logs.write("slow.toml", slow), "--out", recorded)
        session = recorded / "bus.log"
        whole = logs.directory / "whole.blf"
        with can.Logger(whole) as writer:
            for message in can.CanutilsLogReader(session):
                message.channel = 1
                writer(message)
        assert "exactly the recorded ones" in run(REPLAY, "controller", whole, "--controller", "config/controller_endurance.toml")
        # Without most of the spin-up.
        candump = logs.write("bus.log", "".join(session.read_text().splitlines(keepends=True)[74_000:]))
        written = logs.written_by_python_can(candump, "ours")
        by_can_utils = logs.directory / "can_utils.asc"
        run("log2asc", "-I", candump, "-O", by_can_utils, "vcan0")
        ours = logs.write("ours.toml", map_text("antiskid.dbc", "antiskid_binding.toml"))
        folder = same_import(logs, candump, [*written, by_can_utils], ours)
        close(folder, recorded, {"energy_brake_J": 1e-3, "kinetic_energy_J": 1e-3, "mean_friction": 1e-3, "mean_torque_Nm": 5e-3, "duration_s": 0.02})
        exports(logs, candump, written, recorded)
        damaged(logs, written, ours)
        unreadable(logs, written, ours)
        foreign_kinds(logs)
        # The same landing on the bus of another system: its layout has speeds in rpm, bars, amperes and no load cells.
        theirs = logs.imported(candump, ours, "--dbc", "config/foreign.dbc", "--binding", "config/foreign_binding.toml")[0] / "bus.log"
        map_file = logs.write("theirs.toml", map_text("foreign.dbc", "foreign_binding.toml"))
        folder = same_import(logs, theirs, logs.written_by_python_can(theirs, "theirs"), map_file)
        close(folder, recorded, {"brake_on_mps": 1e-3, "kinetic_energy_J": 1e-3, "mean_pressure_Pa": 5e-3, "length_m": 5e-3})


main()
