#!/usr/bin/python3
"""`virtual-rig serve` by real clients: CAN over vcan0, Modbus by pymodbus and mbpoll. Runs inside `./rig vcan`.

usage: serve_test.py BUILD_DIR TEST
"""
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
import tomllib

from pymodbus.client import ModbusTcpClient

BUILD = pathlib.Path(sys.argv[1]).resolve()
RIG = str(BUILD / "bin/virtual-rig")
CONTROLLER = str(BUILD / "bin/antiskid-controller")
MAP = tomllib.loads(pathlib.Path("config/registers.toml").read_text())


def check(truth, what):
    if not truth:
        raise SystemExit(f"FAILED: {what}")


def eventually(ask, what, seconds=60.0):
    deadline = time.monotonic() + seconds
    while not ask():
        check(time.monotonic() < deadline, what)
        time.sleep(0.02)


class Served:
    """The program, and a bridge of few words: registers in SI, a watchdog that moves."""

    def __init__(self, folder, *more, scenario="endurance", clock="timer"):
        self.said = folder / "serve.log"
        port_file = folder / "port"
        self.process = subprocess.Popen(
            [RIG, "serve", "--can", "vcan0", "--scenario", f"config/scenarios/{scenario}.toml", "--clock", clock, "--port-file",
             str(port_file), *more], stdout=open(self.said, "w"), stderr=subprocess.STDOUT)
        eventually(lambda: port_file.exists() or self.process.poll() is not None, "nothing is served")
        check(self.process.poll() is None, "virtual-rig ended at start: " + self.said.read_text())
        port, self.pty = port_file.read_text().split("\n")[:2]
        self.lock = threading.Lock()
        self.alive = True
        self.number = 0
        self.port = int(port)
        if self.port:
            self.client = ModbusTcpClient("127.0.0.1", port=self.port, timeout=5)
            check(self.client.connect(), "no Modbus connection")
            threading.Thread(target=self.keep_alive, daemon=True).start()

    def keep_alive(self):
        count = 0
        while self.process.poll() is None:
            if self.alive:
                count = (count + 1) % 65536
                with self.lock:
                    self.client.write_register(MAP["holding"]["bridge_watchdog"]["address"], count, slave=MAP["unit_id"])
            time.sleep(0.05)

    def read(self, name):
        field = MAP["input"][name]
        width = 2 if field["type"] == "float32" else 1
        with self.lock:
            words = self.client.read_input_registers(field["address"], count=width, slave=MAP["unit_id"]).registers
        if width == 2:
            return struct.unpack(">f", struct.pack(">HH", *words))[0]
        raw = words[0] - 65536 if field["type"] == "i16" and words[0] > 32767 else words[0]
        return raw * field.get("scale", 1.0)

    def write(self, kind, name, value):
        field = MAP[kind][name]
        words = [round(value / field.get("scale", 1.0))]
        if field["type"] == "float32":
            words = list(struct.unpack(">HH", struct.pack(">f", value)))
        with self.lock:
            check(not self.client.write_registers(field["address"], words, slave=MAP["unit_id"]).isError(), f"{name} is not taken")

    def commit(self, **values):
        """Returns whether it was taken over."""
        for name in ("drive_enable", "sledge_advance", "load_enable", "reset", "flywheel_speed", "load_base", "load_lift"):
            self.write("holding", name, values.get(name, 0))
        self.number += 1
        self.write("holding", "commit", self.number)
        eventually(lambda: self.number in (self.read("applied_commit"), self.read("rejected_commit")), "a commit without answer")
        return self.read("applied_commit") == self.number

    def has_said(self, what):
        return what in self.said.read_text()

    def end(self, number=signal.SIGTERM):
        self.alive = False
        with self.lock:
            pass  # the last write has its answer
        self.process.send_signal(number)
        return self.process.wait(timeout=20)


def start_controller(folder, clock):
    config = ["--controller", "config/controller_endurance.toml"]
    log = folder / "controller.log"
    process = subprocess.Popen([CONTROLLER, "--can", "vcan0", "--clock", clock, *config], stdout=open(log, "w"),
                               stderr=subprocess.STDOUT)
    eventually(lambda: " on vcan0" in log.read_text() or process.poll() is not None, "antiskid-controller does not start")
    check(process.poll() is None, log.read_text())
    return process


def shell(command):
    subprocess.run(command.split(), check=True)


def frames_of(identifier, seconds=1.0):
    """Data of the frames with this identifier that come within the time."""
    said = subprocess.run(["candump", "-T", str(int(seconds * 1000)), "-n", "2000", f"vcan0,{identifier}:7FF"], capture_output=True,
                          text=True, check=False).stdout
    return [line.split("]")[1].split() for line in said.splitlines() if "]" in line]


def registers(folder):
    """[RIG-280] Drive, sledge and load by registers alone; what is refused; trips and reset."""
    # A guest may be held up for longer than the 0.5 s of the map; the timeout itself is tested in tests/plc.
    patient = folder / "registers.toml"
    patient.write_text(pathlib.Path("config/registers.toml").read_text().replace("bridge_timeout_ms = 500 ", "bridge_timeout_ms = 10000 "))
    check("bridge_timeout_ms = 10000 " in patient.read_text(), "bridge_timeout_ms in registers.toml")
    rig = Served(folder, "--registers", str(patient))
    check(rig.read("map_version") == MAP["map_version"], "map version")
    check(not rig.commit(drive_enable=1, flywheel_speed=80.0), "a speed beyond the drive's greatest was taken")
    eventually(lambda: rig.has_said("PLC refused commit 1: out of range"), "the refusal is not reported")
    check(rig.commit(drive_enable=1, flywheel_speed=5.0), "the drive is refused")
    eventually(lambda: abs(rig.read("flywheel_speed") - 5.0) < 0.05, "the set-point is not reached")
    counts = {tuple(frame[:4]) for frame in frames_of("111", 0.5)}
    check(len(counts) > 5, "the flywheel turns and its encoder frames do not count")
    check(rig.commit(sledge_advance=1, load_enable=1, load_base=10000), "touchdown is refused")
    eventually(lambda: rig.read("wheel_on_rim") == 1, "the wheel does not reach the rim")
    eventually(lambda: abs(rig.read("vertical_load") - 10000) < 200, "the load does not come")
    check(abs(rig.read("sledge_position") - 0.25) < 1e-3, "sledge position")
    rig.write("virtual", "open_interlocks", 1 << MAP["interlocks"]["guard_closed"])
    eventually(lambda: rig.read("plc_state") == 1, "an open guard does not trip")
    eventually(lambda: rig.read("sledge_position") == 0.0, "the sledge does not go back")
    eventually(lambda: rig.has_said("PLC tripped: guard open"), "the trip is not reported")
    check(not rig.commit(reset=1), "reset with an open guard was taken")
    rig.write("virtual", "open_interlocks", 0)
    check(rig.commit(reset=1), "the reset is refused")
    check(rig.read("plc_state") == 0, "the reset does not reset")
    check(rig.commit(drive_enable=1, flywheel_speed=5.0), "the drive is refused after the reset")
    rig.alive = False
    eventually(lambda: rig.has_said("the bridge's watchdog stood still"), "a silent bridge does not trip")
    check(rig.end() == 0, "SIGTERM is no clean end")
    check(rig.has_said("1 touchdowns"), "no summary at the end: " + rig.said.read_text())


def controller(folder):
    """[RIG-270] The real controller in lockstep: heard, killed, heard again; the rig goes on."""
    rig = Served(folder, clock="sync")
    first = start_controller(folder, "sync")
    eventually(lambda: rig.has_said("antiskid-controller is heard"), "the controller is not heard")
    check(rig.read("plc_state") == 0, "tripped")
    first.kill()
    first.wait()
    eventually(lambda: rig.has_said("antiskid-controller is silent"), "the controller's death is not noticed")
    before = rig.read("plc_watchdog")
    eventually(lambda: (rig.read("plc_watchdog") - before) % 65536 > 20, "the rig does not go on without a controller")
    second = start_controller(folder, "sync")
    eventually(lambda: rig.said.read_text().count("antiskid-controller is heard") == 2, "the second controller is not heard")
    second.terminate()
    second.wait()
    check(rig.end(signal.SIGINT) == 130, "SIGINT is not 130")


def interface(folder):
    """[RIG-270] vcan0 goes down and up, then vanishes and comes back; Modbus goes on."""
    rig = Served(folder)
    for down, up in (("ip link set vcan0 down", "ip link set vcan0 up"), ("ip link del vcan0", "ip link add vcan0 type vcan")):
        times = rig.said.read_text().count("vcan0 is up again")
        shell(down)
        eventually(lambda: rig.said.read_text().count("vcan0 is down") == times + 1, f"{down} is not noticed")
        before = rig.read("plc_watchdog")
        eventually(lambda: (rig.read("plc_watchdog") - before) % 65536 > 20, f"the rig does not go on after {down}")
        shell(up)
        shell("ip link set vcan0 up")
        eventually(lambda: rig.said.read_text().count("vcan0 is up again") == times + 1,
                   f"{up} is not noticed: " + rig.said.read_text())
        eventually(lambda: len(frames_of("110", 0.5)) > 20, f"nothing is sent after {up}")
    check(rig.end() == 0, "SIGTERM is no clean end")


def rtu(folder):
    """[RIG-280] RTU on a pseudo-terminal, by mbpoll."""
    rig = Served(folder, "--modbus-rtu", "pty")
    check(rig.port == 0 and rig.pty, "RTU alone, yet there is a TCP port")
    address = MAP["input"]["map_version"]["address"]
    said = subprocess.run(["mbpoll", "-m", "rtu", "-b", "115200", "-P", "none", "-a", "1", "-t", "3", "-0", "-r", str(address), "-1",
                           "-o", "5", rig.pty], capture_output=True, text=True, timeout=60)
    check(said.returncode == 0 and f"[{address}]: \t{MAP['map_version']}" in said.stdout, said.stdout + said.stderr)
    check(rig.end() == 0, "SIGTERM is no clean end")


TESTS = {"registers": registers, "controller": controller, "interface": interface, "rtu": rtu}

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as name:
        try:
            TESTS[sys.argv[2]](pathlib.Path(name))
        finally:
            for log in sorted(pathlib.Path(name).glob("*.log")):
                print(f"--- {log.name}\n{log.read_text()[-3000:]}")
    print("passed")
