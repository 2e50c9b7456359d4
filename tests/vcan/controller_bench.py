"""antiskid-controller as a process on a real CAN interface, and what the tests of it share."""

import fcntl
import json
import os
import signal
import subprocess
import tempfile
import time
import unittest

from controller_rig import SAFE_MA, VALVE, Bus, Rig, crc_is_right, current_mA

BINARY = ""
SAFE_COMMANDS = 3


def sh(command):
    subprocess.run(command, shell=True, check=True)


def eventually(condition, seconds=30.0):
    """A bound on hanging, not a measurement."""
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.01)
    return True


class Controller:
    """The process; its messages are kept in a file."""

    def __init__(self, *arguments, prefix=(), stderr=None, report=None):
        self.directory = tempfile.TemporaryDirectory()
        self.report_path = report or os.path.join(self.directory.name, "report.json")
        self.log_path = os.path.join(self.directory.name, "log")
        with open(self.log_path, "wb") as log:
            self.process = subprocess.Popen(
                [*prefix, BINARY, "--json", self.report_path, *arguments],
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=log if stderr is None else stderr,
            )

    def log(self):
        with open(self.log_path, encoding="utf-8") as log:
            return log.read()

    def says(self, text):
        return eventually(lambda: text in self.log())

    def running(self):
        return self.process.poll() is None

    def end(self, number=signal.SIGINT):
        self.process.send_signal(number)
        return self.wait()

    def wait(self):
        return self.process.wait(30.0)

    def report(self):
        with open(self.report_path, encoding="utf-8") as file:
            return json.load(file)

    def close(self):
        if self.running():
            self.process.kill()
            self.process.wait()
        self.directory.cleanup()


class OnTheBus(unittest.TestCase):
    def start(self, *arguments, **options):
        controller = Controller(*arguments, **options)
        self.addCleanup(controller.close)
        return controller

    def bus(self, interface="vcan0"):
        bus = Bus(interface)
        self.addCleanup(bus.close)
        return bus

    def lockstep(self, *arguments, interface="vcan0"):
        """A controller that waits for SYNC, and a rig to send it."""
        controller = self.start("--can", interface, "--clock", "sync", *arguments)
        rig = Rig(self.bus(interface))
        self.assertTrue(controller.says(f"on {interface}"), controller.log())
        return controller, rig

    def lockstep_with_piped_log(self):
        """The same; also both ends of the pipe that the messages go to."""
        reading, writing = os.pipe()
        fcntl.fcntl(writing, fcntl.F_SETPIPE_SZ, 4096)
        controller = self.start("--can", "vcan0", "--clock", "sync", stderr=writing)
        rig = Rig(self.bus())
        said = b""
        while b"on vcan0" not in said:
            said += os.read(reading, 4096)
        return controller, rig, reading, writing

    def interface(self, name):
        sh(f"ip link add dev {name} type vcan && ip link set {name} up")
        self.addCleanup(subprocess.run, ["ip", "link", "del", name], stderr=subprocess.DEVNULL)

    def rest(self, bus):
        """All that is still to be heard."""
        frames = []
        while frame := bus.receive(0.5):
            frames.append(frame)
        return frames

    def assert_safe_is_last(self, frames):
        tail = frames[-SAFE_COMMANDS:]
        self.assertEqual([can_id for can_id, _ in tail], [VALVE] * SAFE_COMMANDS)
        counters = [data[1] & 0x0F for _, data in tail]
        for (can_id, data), counter in zip(tail, counters):
            self.assertTrue(crc_is_right(can_id, data))
            self.assertAlmostEqual(current_mA(data), SAFE_MA, places=3)
            self.assertEqual(counter, (counters[0] + tail.index((can_id, data))) % 15)
