#!/usr/bin/python3
"""Checks before the wheel turns, by the real programs against `virtual-rig serve`. Runs inside `./rig vcan`.

usage: preflight.py BUILD_DIR TEST
"""
import fcntl
import json
import os
import pathlib
import pty
import re
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import threading
import time
import tomllib
import tty

from pymodbus.client import ModbusTcpClient

BUILD = pathlib.Path(sys.argv[1]).resolve()
RIG = str(BUILD / "bin/virtual-rig")
BRIDGE = str(BUILD / "bin/rig-bridge")
NOT_TESTED = 77  # ctest says "Skipped" then
CONTROLLER = str(BUILD / "bin/antiskid-controller")


def check(truth, what):
    if not truth:
        raise SystemExit(f"FAILED: {what}")


class Rig:
    """virtual-rig serve."""

    def __init__(self, folder, clock="timer"):
        self.port_file = folder / "port"
        self.process = subprocess.Popen(
            [RIG, "serve", "--can", "vcan0", "--scenario", "config/scenarios/heavy.toml", "--clock", clock, "--answer-timeout", "1000",
             "--modbus", "127.0.0.1:0", "--port-file", str(self.port_file)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        deadline = time.monotonic() + 60.0
        while not self.port_file.exists():
            check(self.process.poll() is None and time.monotonic() < deadline, "nothing is served")
            time.sleep(0.02)
        self.port = int(self.port_file.read_text().split("\n")[0])

    def commanded(self):
        """Every holding register."""
        with open("config/registers.toml", "rb") as file:
            table = tomllib.load(file)
        client = ModbusTcpClient("127.0.0.1", port=self.port, timeout=5)
        check(client.connect(), "no Modbus connection")
        count = table["holding"]["commit"]["address"] + 1
        words = client.read_holding_registers(0, count=count, slave=table["unit_id"]).registers
        client.close()
        return words

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout=20)


def report_of(command):
    """Exit status and the report, its checks by name."""
    done = subprocess.run([*command, "--json", "-"], capture_output=True, text=True, timeout=120)
    check(done.returncode in (0, 1), f"{command}: status {done.returncode}: {done.stderr}")
    report = json.loads(done.stdout)
    check(report["passed"] == (done.returncode == 0), "exit status and JSON disagree")
    check(report["passed"] == all(c["verdict"] != "fail" for c in report["checks"]), "`passed` and the checks disagree")
    return report, {c["name"]: c for c in report["checks"]}


def verdicts(checks, expected):
    for name, verdict in expected.items():
        check(checks[name]["verdict"] == verdict, f"{name}: expected {verdict}, got {checks[name]}")


def in_time(command, expected):
    """The guest may hold everybody up for longer than a peer may be silent or a valve may take: a few times, not for ever."""
    for _ in range(5):
        _, checks = report_of(command)
        if all(checks[name]["verdict"] == verdict for name, verdict in expected.items()):
            break
    verdicts(checks, expected)
    return checks


def controller(folder):
    """[RT-130]"""
    command = [CONTROLLER, "--can", "vcan0", "--check", "--timing-s", "1"]
    _, checks = report_of(command)
    verdicts(checks, {"CAN interface": "pass", "CAN bit rate": "skipped", "CAN socket": "pass", "wheel frames": "fail",
                      "pressure at rest": "skipped", "maneuver frames": "warn", "only controller": "pass", "valve step": "skipped"})

    rig = Rig(folder)
    ear = subprocess.Popen(["candump", "-T", "3000", "vcan0,100:7FF"], stdout=subprocess.PIPE, text=True)
    _, checks = report_of(command)
    check(ear.communicate()[0] == "", "a check without --valve-step has sent a valve command")
    verdicts(checks, {"wheel at rest": "pass", "flywheel at rest": "pass", "pressure at rest": "pass", "emergency stop": "pass"})
    check(checks["wheel frames"]["figures"]["accepted"] > 0 and checks["wheel frames"]["figures"]["rejected"] == 0, checks["wheel frames"])

    # Its times are those of tests/controller/valve_step_test.cpp, a guest that is held up does not keep them: a valve of 2 Hz may take 0.6 s.
    patient = folder / "patient.toml"
    text = pathlib.Path("config/controller.toml").read_text()
    for key, value in {"natural_frequency_Hz": "2.0", "sensor_max_age_ms": "500.0"}.items():
        text, count = re.subn(rf"(?m)^{key} = [\d.]+", f"{key} = {value}", text)
        check(count == 1, f"{key} in controller.toml")
    patient.write_text(text)
    checks = in_time([*command, "--controller", str(patient), "--valve-step"], {"valve step": "pass"})
    check(0.75 < checks["valve step"]["figures"]["pressure_MPa"] < 1.25, checks["valve step"])
    rig.end()

    for status, arguments in {1: ["--can", "nosuch0", "--check", "--timing-s", "1"], 2: ["--can", "vcan0", "--valve-step"]}.items():
        done = subprocess.run([CONTROLLER, *arguments], capture_output=True, text=True, timeout=120)
        check(done.returncode == status, f"{arguments}: status {done.returncode}")


def bridge(folder):
    """[BRG-150]"""
    command = [BRIDGE, "preflight", "config/scenarios/heavy.toml", "--can", "vcan0", "--out", str(folder / "campaign")]
    rig = Rig(folder, clock="sync")  # a busy machine that does not read in time loses no frame
    reached = [*command, "--plc", f"127.0.0.1:{rig.port}"]
    in_time(reached, {"PLC link": "pass", "PLC register map": "pass", "interlock guard_closed": "pass", "rig at rest": "pass",
                      "wheel frames": "pass", "status frames": "fail", "controller state": "skipped", "ledger": "pass"})
    check(not any(rig.commanded()), "a preflight has written registers")
    check(not (folder / "campaign").exists(), "a preflight has made a folder")

    controller_process = subprocess.Popen([CONTROLLER, "--can", "vcan0", "--clock", "sync", "--sync-timeout", "3000"], stdout=subprocess.DEVNULL,
                                          stderr=subprocess.DEVNULL)
    in_time(reached, {"status frames": "pass", "controller state": "pass", "only bridge": "pass", "PLC heartbeat": "pass"})
    controller_process.send_signal(signal.SIGTERM)
    controller_process.wait(timeout=20)
    rig.end()
    _, checks = report_of(reached)
    verdicts(checks, {"PLC link": "fail", "PLC register map": "skipped", "wheel frames": "fail"})


class SerialChip:
    """A CAN controller of the kernel's slcan driver, and its far end in our hands: it shows what a real chip does to the interface."""

    N_SLCAN = 17

    def __init__(self):
        self.master, self.slave = pty.openpty()
        tty.setraw(self.slave)
        fcntl.ioctl(self.slave, termios.TIOCSETD, struct.pack("i", self.N_SLCAN))
        self.said = b""
        threading.Thread(target=self.read, daemon=True).start()  # the driver waits until its words have been read

    def read(self):
        while True:
            self.said += os.read(self.master, 4096)

    def says(self, text):
        os.write(self.master, text)
        time.sleep(0.2)


def chip(_folder):
    """[RT-130]"""
    of_guest = "/run/uml/modprobe"
    subprocess.run([of_guest if os.path.exists(of_guest) else "modprobe", "slcan"], stderr=subprocess.DEVNULL, check=False)
    try:
        far_end = SerialChip()
    except OSError as refusal:
        print(f"skipped: this kernel has no slcan ({refusal})")  # the guest of `./rig vcan` has it
        sys.exit(NOT_TESTED)
    interfaces = json.loads(subprocess.run(["ip", "-json", "link", "show", "type", "can"], capture_output=True, text=True, check=True).stdout)
    name = interfaces[-1]["ifname"]
    command = [CONTROLLER, "--can", name, "--check", "--timing-s", "1"]

    def checks_after(*actions):
        for action in actions:
            subprocess.run(f"ip link set {name} {action}", shell=True, check=True)
        return report_of(command)[1]

    verdicts(checks_after("type can bitrate 500000"), {"CAN interface": "fail", "CAN bit rate": "fail", "CAN state": "fail",
                                                       "CAN transmit queue": "pass", "CAN restart": "fail", "CAN mode": "pass"})
    checks = checks_after("type can bitrate 1000000", "txqueuelen 2", "up")
    verdicts(checks, {"CAN interface": "pass", "CAN bit rate": "pass", "CAN state": "pass", "CAN transmit queue": "fail", "CAN socket": "pass"})
    check(b"S8\r" in far_end.said and b"O\r" in far_end.said, far_end.said)
    # The chip reports: error-passive; receive errors 7, transmit errors 128.
    far_end.says(b"sp007128\r")
    checks = checks_after()
    verdicts(checks, {"CAN state": "fail"})
    check("error-passive" in checks["CAN state"]["measured"], checks["CAN state"])


with tempfile.TemporaryDirectory() as name:
    globals()[sys.argv[2]](pathlib.Path(name))
print("ok")
