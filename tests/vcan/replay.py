#!/usr/bin/python3
"""Playback by the real programs over a real CAN interface. Runs inside `./rig vcan`.

usage: replay.py BUILD_DIR TEST
"""
import gzip
import json
import pathlib
import signal
import subprocess
import sys
import tempfile

BUILD = pathlib.Path(sys.argv[1]).resolve()
REPLAY = str(BUILD / "bin/rig-replay")
LAB = str(BUILD / "bin/rig-lab")

import landing  # noqa: E402  (reads the build directory from sys.argv)
from landing import Recorder, check, end, read_log, start_controller, started  # noqa: E402


def replay(*options, status=0, program=REPLAY):
    run = subprocess.run([program, *options], text=True, capture_output=True, timeout=120)
    check(run.returncode == status, f"{program} {' '.join(options)}: {run.returncode} {run.stdout} {run.stderr}")
    return run


def recorded(folder, play):
    """What candump hears of `play`, and the log it wrote."""
    folder.mkdir()
    recorder = Recorder(folder)
    play()
    frames = recorder.frames()
    (log,) = folder.glob("candump-*.log")
    return frames, log


def made_log(folder):
    """The first two seconds of a landing: touchdown and brake-on, 1 kHz."""
    log = folder / "made.log"
    subprocess.run([LAB, "stop", "--maneuver", "light", "--surface", "wet_asphalt", "--bus-log", str(log)], check=True,
                   stdout=subprocess.DEVNULL)
    lines = log.read_text().splitlines(True)
    log.write_text("".join(line for line in lines if line < "(0000000002."))
    return log


def play(folder):
    """[BRG-330] What we play candump records, frame by frame in order; canplayer plays our logs, we play candump's, plain and gzip."""
    log = made_log(folder)
    frames = read_log(log)
    check(len(frames) > 9000, "no log")
    ours, heard = recorded(folder / "ours", lambda: replay("bus", str(log), "--can", "vcan0"))
    check(ours == frames, "candump did not record what was played")
    packed = folder / "heard.log.gz"
    packed.write_bytes(gzip.compress(heard.read_bytes()))
    again, _ = recorded(folder / "again", lambda: replay("bus", str(packed), "--can", "vcan0", "--speed", "2"))
    check(again == frames, "candump's own log, gzip, is not what was played")
    theirs, _ = recorded(folder / "theirs", lambda: subprocess.run(["canplayer", "-I", str(log), "vcan0=vcan0"], check=True))
    check(theirs == frames, "canplayer does not play our log")


def choice(folder):
    """[BRG-330] Filter, loops, other interface in the log, 29-bit and remote frames; error and FD frames stay behind."""
    log = folder / "mixed.log"
    log.write_text("(1.000000) can7 111#01\n(1.001000) can8 111#02\n(1.002000) can7 18FF0011#0102\n(1.003000) can7 222#R\n"
                   "(1.004000) can7 20000040#0000000000000000\n(1.005000) can7 123##1AA\nnonsense\n(1.006000) can7 333#\n")
    report = folder / "report.json"
    frames, _ = recorded(folder / "all", lambda: replay("bus", str(log), "--can", "vcan0", "--loop", "2", "--json", str(report)))
    once = [("111", "01"), ("18FF0011", "0102"), ("222", "R"), ("333", "")]
    check(frames == once * 2, f"recorded {frames}")
    figures = json.loads(report.read_text())
    check((figures["frames_sent"], figures["error_frames"], figures["loops"]) == (8, 2, 2), str(figures))
    frames, _ = recorded(folder / "some", lambda: replay("bus", str(log), "--can", "vcan0", "--id", "330:7F0", "--interface", "can7"))
    check(frames == [("333", "")], f"recorded {frames}")


def ends(folder):
    """[BRG-330] Exit statuses: no interface, interface down, no log, wrong rule, Ctrl-C."""
    log = folder / "long.log"
    log.write_text("(1.000000) can0 111#01\n(1000.000000) can0 111#02\n")
    check("vcan7" in replay("bus", str(log), "--can", "vcan7", status=1).stderr, "the absent interface is not named")
    check("nowhere" in replay("bus", "nowhere.log", "--can", "vcan0", status=2).stderr, "the absent log is not named")
    check("100:7F0" in replay("bus", str(log), "--can", "vcan0", "--id", "12", status=2).stderr, "the wrong rule is not explained")
    replay("bus", str(log), "--can", "vcan0", "--speed", "-1", status=2)
    for number, status in ((signal.SIGINT, 130), (signal.SIGTERM, 1)):
        playing = started([REPLAY, "bus", str(log), "--can", "vcan0"], 0x111, 1)
        check(end(playing, number) == status, f"{number.name}: {playing.returncode}")
    subprocess.run(["ip", "link", "set", "vcan0", "down"], check=True)
    check("ip link set vcan0 up" in replay("bus", str(log), "--can", "vcan0", status=1).stderr, "the interface that is down is not named")
    subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)


def controller(folder):
    """[BRG-310] A landing recorded from the bus, controller and rig separate processes in lockstep: no command frame differs on replay."""
    recorder = Recorder(folder)
    process = start_controller(folder)
    run = landing.rig(folder, "--maneuver", "light", "--surface", "dry_asphalt")
    check(run.returncode == 0, f"virtual-rig: {run.returncode} {run.stderr}")
    check(end(process) == 0, "antiskid-controller failed")
    recorder.frames()
    (log,) = folder.glob("candump-*.log")
    report = json.loads(replay("controller", str(log), "--json", "-").stdout)
    valve = report["messages"]["valve"]
    check(report["clock"] == "sync" and valve["compared"] > 5000, str(report))
    check(valve["different"] == 0 and valve["only_recorded"] == 0, str(report))
    print(f"{valve['different']} of {valve['compared']} differ, {report['times_real_time']:.0f} times real time")
    plant = json.loads(replay("plant", str(log), "--maneuver", "light", "--json", "-", program=LAB).stdout)
    check(plant["clock"] == "sync" and plant["all"]["speed_mps"]["count"] > 300, str(plant))


TESTS = {f.__name__: f for f in (play, choice, ends, controller)}

if __name__ == "__main__":
    with tempfile.TemporaryDirectory(dir="/dev/shm") as name:
        TESTS[sys.argv[2]](pathlib.Path(name))
    print(f"{sys.argv[2]}: passed")
