"""antiskid-controller on a real CAN interface: faults of the rig and of the bus. Run by controller_test.py."""

import socket
import subprocess

import controller_rig as rig_side
from controller_bench import SAFE_COMMANDS, OnTheBus, sh
from controller_rig import SAFE_MA, VALVE, WHEEL, current_mA

CONFIG_MAX_AGE_PERIODS = round(rig_side.CONFIG["monitor"]["sensor_max_age_ms"] / rig_side.CONFIG["period_ms"])


class BusTest(OnTheBus):
    def test_rig_that_falls_silent(self):
        """[RT-034]"""
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
        """[RT-034]"""
        controller, rig = self.lockstep()
        self.assertTrue(controller.says("nothing has come on vcan0 yet"))
        self.assertIsNone(rig.bus.receive(0.5))
        self.assertEqual(controller.end(), 0)
        self.assertEqual(len(self.rest(rig.bus)), SAFE_COMMANDS)

    def test_damaged_frames_are_counted_and_not_used(self):
        """[RT-034]"""

        def damage(rig):
            good = rig.protected(WHEEL, bytes(6))
            rig.counters[WHEEL] = (rig.counters[WHEEL] - 1) % 15  # never sent: the sequence goes on
            # As many as good ones: more would be a fault (CTL-081).
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
        """[RT-034]"""
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
        """[RT-030]"""
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
        """[RT-034]"""
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
        """[RT-040]"""
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
        """[RT-040]"""
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
        """[RT-040]"""
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
        """[RT-032]"""
        controller, _ = self.braking_on("vcan6")
        sh("ip link del vcan6")
        self.assertTrue(controller.says("vcan6 is down or gone"), controller.log())
        self.assertEqual(controller.end(), 1)
        self.assertIn("safe current was delivered 0 of 3 times", controller.log())
        self.assertEqual(controller.report()["safe_commands_sent"], 0)
