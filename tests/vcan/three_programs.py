"""The three programs on one rig for the tests beside it: antiskid-controller, virtual-rig serve, rig-bridge; over vcan0 and Modbus TCP."""
import csv
import os
import pathlib
import re
import shutil
import signal
import socket
import sqlite3
import struct
import subprocess
import tempfile
import threading
import time
import tomllib

from pymodbus.client import ModbusTcpClient

PHASES = ("idle", "spin_up", "touchdown", "settling", "braking", "standstill", "retract", "cool_down", "finished", "aborting", "aborted")
VALVE, PRESSURE, STATE = 0x100, 0x112, 0x191
PRESSURE_GONE_PA = 0.5e6


def check(truth, what):
    if not truth:
        raise SystemExit(f"FAILED: {what}")


def eventually(ask, what, seconds=180.0, every=0.02):
    deadline = time.monotonic() + seconds
    while not ask():
        check(time.monotonic() < deadline, what)
        time.sleep(every)


def changed(text, **numbers):
    """TOML with other numbers; each key must be there."""
    for key, value in numbers.items():
        text, count = re.subn(rf"(?m)^{key} = [-+.0-9e]+", f"{key} = {value}", text)
        check(count > 0, f"no {key} to change")
    return text


PATIENT = {
    "bridge.toml": dict(sensors_ms=3000, controller_ms=3000, recorder_ms=3000, registers_ms=3000, commit_ms=5000),
    "registers.toml": dict(plc_timeout_ms=3000, response_timeout_ms=2000, bridge_timeout_ms=2000, user_timeout_ms=1000),
}


def configuration(folder, edits):
    """A copy of the configuration with other numbers."""
    config = folder / "config"
    shutil.copytree("config", config, ignore=shutil.ignore_patterns("vcan", "reader"))
    for name, numbers in edits.items():
        path = config / name
        path.write_text(changed(path.read_text(), **numbers))
    return config


def quick_rig(folder, patient=True):
    """A configuration whose maneuvers take four seconds: strong drive, quick sledge, 12 m/s; patient with a host that stands still for a
    while. Returns the scenario and its directory."""
    edits = {
        "rig_machinery.toml": dict(torque_Nm="120.0e3", power_W="10.0e6", response_s=0.05, speed_mps=0.5, heat_capacity_JpK="20.0e6"),
        "controller.toml": dict(spin_up_mps=6.0, touchdown_timeout_s=0.3),
        "sequencer.toml": dict(settle_s=0.4, settle_hold_s=0.1, coasting_mps=0.004, idle_s=20.0, abort_s=4.0),
    }
    config = configuration(folder, edits | (PATIENT if patient else {}))
    scenario = config / "scenarios" / "quick.toml"
    heavy = (config / "scenarios" / "heavy.toml").read_text().split("[acceptance]")[0]
    scenario.write_text(changed(heavy.replace('name = "heavy"', 'name = "heavy"\nspeed_mps = 0'), speed_mps=12.0) +
                        "[acceptance]\nbrake_on_mps = [11.95, 12.05]\n")
    return scenario, config


class Bus:
    """Phase, valve current and pressure from the bus, by a socket of its own, with the wall-clock instants of their changes."""

    def __init__(self):
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        wanted = b"".join(struct.pack("=II", identifier, 0x7FF) for identifier in (VALVE, PRESSURE, STATE))
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, wanted)
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 23)
        self.socket.bind(("vcan0",))
        self.phase, self.valve_raw, self.pressure_Pa = "idle", 0, 0.0
        self.since = {}  # phase -> instant
        self.safe_since = self.released_since = time.monotonic()
        self.changed = threading.Condition()
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        while True:
            try:
                frame = self.socket.recv(16)
            except OSError:  # the interface is down
                time.sleep(0.01)
                continue
            identifier = struct.unpack_from("=I", frame)[0] & 0x7FF
            data = frame[8:]
            if identifier == STATE:
                phase = PHASES[data[1] >> 4]
                with self.changed:
                    if phase != self.phase:
                        self.phase, self.since[phase] = phase, time.monotonic()
                        self.changed.notify_all()
            elif identifier == VALVE:
                raw = struct.unpack_from("<H", data, 2)[0]
                if raw == 0 and self.valve_raw != 0:
                    self.safe_since = time.monotonic()
                self.valve_raw = raw
            else:
                pressure = struct.unpack_from("<H", data, 2)[0] * 500.0
                if pressure < PRESSURE_GONE_PA <= self.pressure_Pa:
                    self.released_since = time.monotonic()
                self.pressure_Pa = pressure

    def await_phase(self, phases, seconds=180.0):
        with self.changed:
            return self.changed.wait_for(lambda: self.phase in phases, seconds)


class Plc:
    """The PLC's registers by pymodbus, beside the bridge."""

    def __init__(self, port, config):
        self.map = tomllib.loads((config / "registers.toml").read_text())
        self.client = ModbusTcpClient("127.0.0.1", port=port, timeout=8)
        check(self.client.connect(), "no Modbus connection")

    def read(self, name):
        field = self.map["input"][name]
        count = 2 if field["type"] == "float32" else 1
        raw, *low = self.client.read_input_registers(field["address"], count=count, slave=self.map["unit_id"]).registers
        if low:
            return struct.unpack(">f", struct.pack(">HH", raw, *low))[0]
        return (raw - 65536 if field["type"] == "i16" and raw > 32767 else raw) * field.get("scale", 1.0)

    def bridge_seen(self):
        """Whether a bridge has moved its watchdog since the rig was started."""
        return self.client.read_holding_registers(self.map["holding"]["bridge_watchdog"]["address"], count=1, slave=self.map["unit_id"]).registers[0] != 0

    def await_bridge(self):
        """Until the PLC has scanned a watchdog of the bridge's that moved."""
        eventually(self.bridge_seen, "the bridge does not move its watchdog")
        before = self.read("plc_watchdog")
        eventually(lambda: (self.read("plc_watchdog") - before) % 65536 >= 2, "the PLC does not scan")

    def fault(self, name, value):
        field = self.map["virtual"][name]
        raw = round(value / field.get("scale", 1.0))
        check(not self.client.write_register(field["address"], raw, slave=self.map["unit_id"]).isError(), f"{name} is not taken")

    def interlock(self, name):
        return 1 << self.map["interlocks"][name]

    def sledge_back(self):
        return self.read("sledge_position") < 0.01 and self.read("wheel_on_rim") == 0


class Rig:
    """Controller and virtual rig, started again when they have died; bridges on demand."""

    def __init__(self, build, folder, scenario, config, clock="sync", sync_timeout_ms=3000, answer_timeout_ms=1000, together=False):
        """clock: of all three. In lockstep ("sync") a slow machine stretches the rig's time, and who does not answer in time is silent."""
        self.build, self.folder, self.scenario, self.config = build, folder, scenario, config
        self.clock, self.sync_timeout_ms, self.answer_timeout_ms = clock, sync_timeout_ms, answer_timeout_ms
        self.together = ["--start-together"] if together else []
        self.controller = self.virtual_rig = self.plc = None
        self.runs = 0
        self.start()

    def start(self):
        if self.virtual_rig is None or self.virtual_rig.poll() is not None:
            self.start_virtual_rig()
        if self.controller is None or self.controller.poll() is not None:
            name = "controller_endurance.toml" if "endurance" in self.scenario.name else "controller.toml"
            self.controller = subprocess.Popen(
                [self.build / "bin/antiskid-controller", "--can", "vcan0", "--clock", self.clock, "--controller", self.config / name,
                 "--sync-timeout", str(self.sync_timeout_ms), "--json", self.folder / "controller.json"],
                stdout=open(self.folder / "controller.log", "a"), stderr=subprocess.STDOUT)

    def start_virtual_rig(self):
        port_file = self.folder / "port"
        port_file.unlink(missing_ok=True)
        self.virtual_rig = subprocess.Popen(
            [self.build / "bin/virtual-rig", "serve", "--can", "vcan0", "--scenario", self.scenario, "--config", self.config, "--clock",
             self.clock, "--answer-timeout", str(self.answer_timeout_ms), "--modbus", "127.0.0.1:1502", "--port-file", port_file, *self.together],
            stdout=open(self.folder / "virtual-rig.log", "a"), stderr=subprocess.STDOUT)
        eventually(lambda: port_file.exists() or self.virtual_rig.poll() is not None, "nothing is served")
        check(self.virtual_rig.poll() is None, "virtual-rig ended: " + (self.folder / "virtual-rig.log").read_text())
        self.plc = Plc(1502, self.config)

    def command(self, verb, out, *more):
        if verb in ("maneuver", "campaign"):
            # The rim coasts for minutes.
            more = ("--leave-turning", "--clock", self.clock, "--answer-timeout", str(self.answer_timeout_ms), *more)
        return [self.build / "bin/rig-bridge", verb, self.scenario, "--can", "vcan0", "--plc", "127.0.0.1:1502", "--config",
                self.config, "--out", out, *more]

    def bridge(self, verb, out, *more, priority=0):
        """Started; its words are in .log of the result."""
        return self.start_bridge(self.command(verb, out, "--priority", str(priority), *more))

    def start_bridge(self, command):
        self.runs += 1
        log = self.folder / f"bridge{self.runs}.log"
        process = subprocess.Popen(command, stdout=open(log, "w"), stderr=subprocess.STDOUT)
        process.log = log
        return process

    def await_words(self, process, wanted):
        """All that a bridge has said, once it has said this."""
        eventually(lambda: wanted in words(process) or process.poll() is not None, f"never said: {wanted}")
        return words(process)

    def end(self):
        for process in (self.virtual_rig, self.controller):
            if process.poll() is None:
                process.send_signal(signal.SIGCONT)
                process.terminate()
                process.wait(timeout=30)


def patient_rig(build, folder, scenario, config):
    """Three programs that wait for each other: a machine that is slow, or stands still for a while, stretches the rig's time."""
    return Rig(build, folder, scenario, config, sync_timeout_ms=20000, answer_timeout_ms=3000)


def words(process):
    return process.log.read_text()


def in_guest_memory():
    """A directory in memory; the guest has 384 MiB in all."""
    return dict(dir="/dev/shm") if os.path.isdir("/dev/shm") else {}


def ledger_copy(out):
    """The ledger as a reader would find it after the machine came up again: looked at in a copy, a hot journal with it. A bridge that was killed
    before its tables were written leaves an empty one."""
    with tempfile.TemporaryDirectory(**in_guest_memory()) as place:
        for file in out.glob("campaign.sqlite*"):
            shutil.copy(file, place)
        database = sqlite3.connect(pathlib.Path(place) / "campaign.sqlite")
        check(database.execute("PRAGMA integrity_check").fetchall() == [("ok",)], "the ledger is corrupt")
        if not database.execute("SELECT * FROM sqlite_master").fetchall():
            return []
        rows = database.execute("SELECT * FROM maneuvers ORDER BY id").fetchall()
        names = [column[0] for column in database.execute("SELECT * FROM maneuvers LIMIT 0").description]
        database.close()
    return [dict(zip(names, row)) for row in rows]


def write_table(path, columns, rows):
    """CSV, whole or not there."""
    part = path.with_suffix(".part")
    with open(part, "w", newline="", encoding="utf-8") as out:
        csv.writer(out).writerows([columns, *rows])
        out.flush()
        os.fsync(out.fileno())
    part.rename(path)
