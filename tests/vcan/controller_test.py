#!/usr/bin/python3
"""antiskid-controller as a process on a real CAN interface: start, stop, faults of the bus and of the rig.

    ./rig vcan -- tests/vcan/controller_test.py PATH/TO/antiskid-controller [TEST ...]
"""

import contextlib
import fcntl
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time
import unittest

import controller_rig as rig_side
from controller_rig import SAFE_MA, SYNC, VALVE, WHEEL, Bus, Rig, crc_is_right, current_mA

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


class ControllerTest(unittest.TestCase):
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

    # Start

    def refused(self, status, *texts, arguments):
        controller = self.start(*arguments)
        self.assertEqual(controller.wait(), status, controller.log())
        for text in texts:
            self.assertIn(text, controller.log())

    def test_absent_interface(self):
        """[RT-100]"""
        self.refused(1, "nosuch0", arguments=["--can", "nosuch0"])

    def test_interface_that_is_down(self):
        """[RT-100]"""
        self.interface("vcan7")
        sh("ip link set vcan7 down")
        self.refused(1, "vcan7", "ip link set vcan7", arguments=["--can", "vcan7"])

    def test_interface_that_is_no_can(self):
        """[RT-100]"""
        self.refused(1, "'lo'", arguments=["--can", "lo"])

    def test_bad_configuration(self):
        """[RT-101]"""
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file, open("config/controller.toml", encoding="utf-8") as good:
            file.write(good.read().replace("period_ms = 1.0", "period_ms = 17.0"))
            file.flush()
            self.refused(2, f"{file.name}:", "period_ms", arguments=["--can", "vcan0", "--controller", file.name])

    def test_report_that_cannot_be_written(self):
        """[RT-102]"""
        controller = self.start("--can", "vcan0", report="/proc/none/report.json")
        self.assertTrue(controller.says("on vcan0"))
        self.assertEqual(controller.end(), 1)
        self.assertIn("/proc/none", controller.log())

    def test_missing_rights_are_named_with_their_cure(self):
        """[RT-103]"""
        without = ["setpriv", "--bounding-set=-sys_nice,-ipc_lock,-sys_resource", "prlimit", "--memlock=65536:65536", "--rtprio=0:0"]
        controller = self.start("--can", "vcan0", prefix=without)
        self.assertTrue(controller.says("no SCHED_FIFO priority 80"), controller.log())
        self.assertTrue(controller.says("memory not locked"), controller.log())
        self.assertIn("setcap", controller.log())
        self.assertEqual(controller.end(), 0, controller.log())

    def test_granted_rights_are_used(self):
        """[RT-103]"""
        controller = self.start("--can", "vcan0", "--cpu", "0", "--priority", "42")
        self.assertTrue(controller.says("state self_test"), controller.log())
        self.assertNotIn("warning", controller.log().replace("no step", ""))
        tasks = f"/proc/{controller.process.pid}/task"
        priorities = []
        for task in os.listdir(tasks):
            with open(f"{tasks}/{task}/stat", encoding="utf-8") as stat:
                fields = stat.read().rsplit(")", 1)[1].split()
            priorities.append((int(fields[37]), int(fields[38])))  # rt_priority, policy
        self.assertIn((42, os.SCHED_FIFO), priorities)
        with open(f"/proc/{controller.process.pid}/status", encoding="utf-8") as status:
            locked = next(line for line in status if line.startswith("VmLck"))
        self.assertGreater(int(locked.split()[1]), 1000)
        self.assertEqual(controller.end(), 0)

    # Stop

    def stops_safely(self, number):
        controller, rig = self.lockstep()
        rig.brake()
        self.assertEqual(controller.end(number), 0, controller.log())
        frames = self.rest(rig.bus)
        self.assertEqual(len(frames), SAFE_COMMANDS)
        self.assert_safe_is_last(frames)
        report = controller.report()
        self.assertEqual(report["steps"], rig.steps)
        self.assertEqual(report["faults"], [])
        self.assertEqual(report["last_state"], "braking")
        self.assertEqual(report["safe_commands_sent"], SAFE_COMMANDS)
        self.assertEqual(report["messages"]["wheel"]["accepted"], rig.steps)
        self.assertEqual(report["messages"]["sync"]["accepted"], rig.steps)

    def test_sigint_while_braking(self):
        """[RT-104]"""
        self.stops_safely(signal.SIGINT)

    def test_sigterm_while_braking(self):
        """[RT-104]"""
        self.stops_safely(signal.SIGTERM)

    def test_sighup_while_braking(self):
        """[RT-104]"""
        self.stops_safely(signal.SIGHUP)

    def test_sigint_by_the_timer_with_nobody_there(self):
        """[RT-104]"""
        bus = self.bus()
        controller = self.start("--can", "vcan0")
        frames = [bus.receive() for _ in range(50)]
        self.assertNotIn(None, frames)
        self.assertEqual(controller.end(), 0, controller.log())
        self.assert_safe_is_last(frames + self.rest(bus))

    def test_log_reader_that_goes_away(self):
        """[RT-105]"""
        controller, rig, reading, writing = self.lockstep_with_piped_log()
        os.close(writing)
        rig.brake()
        os.close(reading)
        for _ in range(1500):  # time for a summary that nobody can take
            rig.step()
        self.assertTrue(controller.running())
        self.assertEqual(controller.end(), 0)
        self.assert_safe_is_last(self.rest(rig.bus))

    def test_log_that_nobody_reads(self):
        """[RT-105]"""
        controller, rig, reading, writing = self.lockstep_with_piped_log()
        rig.brake()
        os.set_blocking(writing, False)
        with contextlib.suppress(BlockingIOError):
            while os.write(writing, b".") == 1:
                pass
        os.set_blocking(writing, True)
        time.sleep(1.5)  # the next summary holds up the thread that logs
        self.assertTrue(controller.running())
        controller.process.send_signal(signal.SIGINT)
        self.assert_safe_is_last(self.rest(rig.bus))
        self.assertTrue(controller.running())  # still held up, but the valve is safe
        os.close(writing)
        while os.read(reading, 4096):
            pass
        self.assertEqual(controller.wait(), 0)
        os.close(reading)

    # The rig

    def test_rig_that_falls_silent(self):
        """[RT-106]"""
        controller, rig = self.lockstep("--sync-timeout", "200")
        rig.brake()
        frames = []
        while not frames or frames[-1][0] != VALVE or current_mA(frames[-1][1]) > SAFE_MA + 1e-3:
            frame = rig.bus.receive()
            self.assertIsNotNone(frame, controller.log())
            frames.append(frame)
            rig.hear(*frame)
        self.assertTrue(controller.says("no SYNC on vcan0"))
        for fault in ("wheel_lost", "flywheel_lost", "pressure_lost"):
            self.assertTrue(controller.says(f"fault {fault}"), controller.log())
        while rig.state != rig_side.SAFE:
            rig.hear(*rig.bus.receive())
        # Sensors may be 20 ms old before they are missed.
        commands = sum(can_id == VALVE for can_id, _ in frames)
        self.assertLessEqual(commands, CONFIG_MAX_AGE_PERIODS + 5)
        self.assertEqual(controller.end(), 0)
        self.assert_safe_is_last(self.rest(rig.bus))
        report = controller.report()
        self.assertGreater(report["unsynchronised_steps"], 0)
        self.assertIn("wheel_lost", [fault["name"] for fault in report["faults"]])

    def test_rig_that_never_comes(self):
        """[RT-106]"""
        controller, rig = self.lockstep()
        self.assertTrue(controller.says("nothing has come on vcan0 yet"))
        self.assertIsNone(rig.bus.receive(0.5))
        self.assertEqual(controller.end(), 0)
        self.assertEqual(len(self.rest(rig.bus)), SAFE_COMMANDS)

    def test_damaged_frames_are_counted_and_not_used(self):
        """[RT-107]"""

        def damage(rig):
            good = rig.protected(WHEEL, bytes(6))
            rig.counters[WHEEL] = (rig.counters[WHEEL] - 1) % 15  # never sent: the sequence goes on
            # As many as good ones: more would be a fault (CTL-232).
            rig.bus.send(WHEEL, good[:5] if rig.steps % 2 else bytes([good[0] ^ 0x40]) + good[1:])
            rig.bus.send(WHEEL | socket.CAN_EFF_FLAG, good)
            rig.bus.send(WHEEL | socket.CAN_RTR_FLAG, good)

        _, quiet_rig = undisturbed = self.lockstep()
        quiet_rig.brake()
        self.assertEqual(undisturbed[0].end(), 0)
        controller, rig = self.lockstep()
        rig.brake(damage)
        self.assertEqual(rig.answers, quiet_rig.answers)
        self.assertEqual(controller.end(), 0)
        report = controller.report()
        self.assertEqual(report["messages"]["wheel"]["accepted"], rig.steps)
        self.assertEqual(report["messages"]["wheel"]["wrong_crc"], (rig.steps + 1) // 2)
        self.assertEqual(report["messages"]["wheel"]["wrong_length"], rig.steps // 2)
        self.assertGreaterEqual(report["link"]["malformed"], rig.steps)
        self.assertEqual(report["faults"], [])

    def test_sensor_that_is_damaged_for_good(self):
        """[RT-107]"""
        controller, rig = self.lockstep()
        rig.brake()
        whole = rig.bus.send
        rig.bus.send = lambda can_id, data: whole(can_id, bytes([data[0] ^ 1]) + data[1:] if can_id == WHEEL else data)
        for _ in range(60):
            rig.step()
        self.assertEqual(rig.state, rig_side.SAFE)
        self.assertAlmostEqual(rig.current_mA, SAFE_MA, places=3)
        self.assertTrue(controller.says("fault wheel_corrupt"), controller.log())
        self.assertEqual(controller.end(), 0)

    def test_same_run_same_bytes(self):
        """[RT-108]"""
        runs = []
        for _ in range(2):
            controller, rig = self.lockstep()
            rig.brake()
            self.assertEqual(controller.end(), 0)
            runs.append(rig.answers)
        self.assertEqual(*runs)
        self.assertEqual(sum(can_id == VALVE for can_id, _ in runs[0]), rig.steps)

    # The bus

    def test_flood_of_foreign_frames(self):
        """[RT-109]"""
        controller, rig = self.lockstep()
        rig.brake()
        self.assertEqual(controller.end(), 0)
        quiet = rig.answers

        floods = [
            subprocess.Popen(["cangen", "vcan0", "-g", "0", "-i", "-I", "555", "-L", "8"]),
            subprocess.Popen(["cangen", "vcan0", "-g", "0", "-i", "-e"]),
        ]
        for flood in floods:
            self.addCleanup(flood.kill)
        controller, rig = self.lockstep()
        rig.brake()
        for flood in floods:
            self.assertIsNone(flood.poll())
            flood.kill()
            flood.wait()
        self.assertEqual(controller.end(), 0, controller.log())
        self.assertEqual(rig.answers, quiet)
        report = controller.report()
        self.assertEqual(report["faults"], [])
        self.assertEqual(report["link"]["receive_dropped"], 0)

    def braking_on(self, name):
        self.interface(name)
        controller, rig = self.lockstep("--sync-timeout", "100", interface=name)
        rig.brake()
        return controller, rig

    def test_interface_that_goes_down_and_up(self):
        """[RT-110]"""
        controller, rig = self.braking_on("vcan3")
        sh("ip link set vcan3 down")
        self.assertTrue(controller.says("vcan3 is down or gone"), controller.log())
        self.assertTrue(controller.says("fault bus_off"), controller.log())
        sh("ip link set vcan3 up")
        self.assertTrue(controller.says("vcan3 is up again"), controller.log())
        bus = self.bus("vcan3")
        while (frame := bus.receive())[0] != VALVE:
            pass
        self.assertAlmostEqual(current_mA(frame[1]), SAFE_MA, places=3)
        self.assertEqual(controller.end(), 0, controller.log())
        self.assert_safe_is_last(self.rest(bus))
        self.assertGreaterEqual(controller.report()["link"]["outages"], 1)

    def test_interface_that_vanishes_and_comes_back(self):
        """[RT-110]"""
        controller, rig = self.braking_on("vcan4")
        sh("ip link del vcan4")
        self.assertTrue(controller.says("vcan4 is down or gone"), controller.log())
        self.assertTrue(controller.says("cannot reopen the bus yet"), controller.log())
        self.assertTrue(controller.says("fault bus_off"), controller.log())
        self.assertTrue(controller.running())
        self.interface("vcan4")
        self.assertTrue(controller.says("vcan4 is up again"), controller.log())
        bus = self.bus("vcan4")
        while (frame := bus.receive())[0] != VALVE:
            pass
        self.assertAlmostEqual(current_mA(frame[1]), SAFE_MA, places=3)
        self.assertEqual(controller.end(), 0, controller.log())
        self.assert_safe_is_last(self.rest(bus))

    def test_interface_that_vanishes_by_the_timer(self):
        """[RT-110]"""
        self.interface("vcan5")
        controller = self.start("--can", "vcan5")
        self.assertTrue(controller.says("state self_test"), controller.log())
        sh("ip link del vcan5")
        self.assertTrue(controller.says("vcan5 is down or gone"), controller.log())
        self.interface("vcan5")
        self.assertTrue(controller.says("vcan5 is up again"), controller.log())
        self.assertIsNotNone(self.bus("vcan5").receive())
        self.assertEqual(controller.end(), 0, controller.log())

    def test_interface_that_is_gone_at_the_end(self):
        """[RT-111]"""
        controller, _ = self.braking_on("vcan6")
        sh("ip link del vcan6")
        self.assertTrue(controller.says("vcan6 is down or gone"), controller.log())
        self.assertEqual(controller.end(), 1)
        self.assertIn("safe current was delivered 0 of 3 times", controller.log())
        self.assertEqual(controller.report()["safe_commands_sent"], 0)


CONFIG_MAX_AGE_PERIODS = round(rig_side.CONFIG["monitor"]["sensor_max_age_ms"] / rig_side.CONFIG["period_ms"])

if __name__ == "__main__":
    BINARY = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
