#!/usr/bin/python3
"""antiskid-controller as a process on a real CAN interface: start, rights, stop, log; with controller_bus_test.py faults of the bus and of the rig.

    ./rig vcan -- tests/vcan/controller_test.py PATH/TO/antiskid-controller [TEST ...]
"""

import contextlib
import os
import signal
import sys
import tempfile
import time
import unittest

import controller_bench
from controller_bench import SAFE_COMMANDS, OnTheBus, sh
from controller_bus_test import BusTest  # noqa: F401 run by main, too


class ControllerTest(OnTheBus):
    def refused(self, status, *texts, arguments):
        controller = self.start(*arguments)
        self.assertEqual(controller.wait(), status, controller.log())
        for text in texts:
            self.assertIn(text, controller.log())

    def test_absent_interface(self):
        """[RT-080]"""
        self.refused(1, "nosuch0", arguments=["--can", "nosuch0"])

    def test_interface_that_is_down(self):
        """[RT-080]"""
        self.interface("vcan7")
        sh("ip link set vcan7 down")
        self.refused(1, "vcan7", "ip link set vcan7", arguments=["--can", "vcan7"])

    def test_interface_that_is_no_can(self):
        """[RT-080]"""
        self.refused(1, "'lo'", arguments=["--can", "lo"])

    def test_bad_configuration(self):
        """[RT-080]"""
        with tempfile.NamedTemporaryFile("w", suffix=".toml") as file, open("config/controller.toml", encoding="utf-8") as good:
            file.write(good.read().replace("period_ms = 1.0", "period_ms = 17.0"))
            file.flush()
            self.refused(2, f"{file.name}:", "period_ms", arguments=["--can", "vcan0", "--controller", file.name])

    def test_report_that_cannot_be_written(self):
        """[RT-073]"""
        controller = self.start("--can", "vcan0", report="/proc/report.json")
        self.assertTrue(controller.says("on vcan0"))
        self.assertEqual(controller.end(), 1)
        self.assertIn("/proc/report.json", controller.log())

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
        """[RT-032]"""
        self.stops_safely(signal.SIGINT)

    def test_sigterm_while_braking(self):
        """[RT-032]"""
        self.stops_safely(signal.SIGTERM)

    def test_sighup_while_braking(self):
        """[RT-032]"""
        self.stops_safely(signal.SIGHUP)

    def test_sigint_by_the_timer_with_nobody_there(self):
        """[RT-032]"""
        bus = self.bus()
        controller = self.start("--can", "vcan0")
        frames = [bus.receive() for _ in range(50)]
        self.assertNotIn(None, frames)
        self.assertEqual(controller.end(), 0, controller.log())
        self.assert_safe_is_last(frames + self.rest(bus))

    def test_log_reader_that_goes_away(self):
        """[RT-070]"""
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
        """[RT-070]"""
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


if __name__ == "__main__":
    controller_bench.BINARY = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
