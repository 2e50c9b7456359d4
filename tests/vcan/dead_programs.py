#!/usr/bin/python3
"""Each of the three programs killed (SIGKILL) and stopped (SIGSTOP, later SIGCONT) in each phase of a maneuver, as real processes in paced
lockstep; docs/engineering/fault_campaign.md states what must come out. Times are counted in periods on the bus, never by a clock. Runs inside `./rig vcan`.

usage: dead_programs.py BUILD_DIR [--sample SEED] [--program NAME] [--csv FILE]
--sample: one phase drawn for each program and signal, instead of all of them. Exit status 1: a criterion was not met.
"""
import argparse
import json
import os
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time
import tomllib

from bus_ear import (ARMED, BRAKING, DROP_OUT, FAULTS, MARK, PRESSURE, SAFE, STANDBY, STATE, STATUS, SYNC, VALVE, Ear, after_mark, current_mA,
                     pressure_Pa, whole)
from three_programs import PRESSURE_GONE_PA, Rig, check, eventually, in_guest_memory, ledger_copy, quick_rig, words, write_table

SENSORS_LOST = 1 << 0 | 1 << 5 | 1 << 10
MANEUVER_LOST = 1 << 17
TRACKING_PERIODS = 200  # after the first pressure
AFTER_PERIODS = 300     # how long a program that came back is watched
PROGRAMS = ("controller", "virtual-rig", "bridge")
COLUMNS = ("program", "signal", "phase", "current_mA", "periods", "limit", "outcome", "ledger", "exit_status", "frames", "dropped")

with open("config/controller.toml", "rb") as file:
    MONITOR = tomllib.load(file)["monitor"]
ON_ITS_WAY = 1  # a frame of the dead may have been sent, and not yet been used, when the signal came
SENSOR_PERIODS = round(MONITOR["sensor_max_age_ms"]) + 1 + ON_ITS_WAY
MANEUVER_PERIODS = round(MONITOR["maneuver_max_age_ms"]) + 1 + ON_ITS_WAY
# The driver's own 20 (ServeNode::kDriverWatchdog), then eq. (6) from full pressure to none: tau, and five times 1/(xi omega_n).
PRESSURE_PERIODS = 80


# What is waited for before the signal comes; each is over only later in the maneuver.
REACHED = {
    "standby": lambda ear: ear.phase is not None and ear.state == STANDBY,
    "spin_up": lambda ear: ear.phase == "spin_up" and ear.state == ARMED,
    "landing": lambda ear: ear.phase == "settling",
    "build_up": lambda ear: ear.first_pressure is not None,
    "tracking": lambda ear: ear.first_pressure is not None and ear.syncs >= ear.first_pressure + TRACKING_PERIODS,
    "drop_out": lambda ear: ear.phase == "braking" and ear.state == DROP_OUT,
    "end": lambda ear: ear.phase == "retract",
}
STILL = {"build_up": BRAKING, "tracking": BRAKING, "drop_out": DROP_OUT}  # the state that says that it is still that phase


def periods_until(frames, clock, identifier, is_safe):
    """How many frames `clock` came before the first `identifier` that is safe and stays so; 0: none was unsafe. None: it never came."""
    ticks, last_unsafe, safe_at = 0, None, 0
    for each, data in frames:
        if each == identifier:
            if not is_safe(data):
                last_unsafe, safe_at = ticks, None
            elif safe_at is None:
                safe_at = ticks
        if each == clock:
            ticks += 1
    return 0 if last_unsafe is None else safe_at


def without_current(data):
    return current_mA(data) == 0.0


def released(data):
    return pressure_Pa(data) < PRESSURE_GONE_PA


def log_lines(folder):
    """The whole lines of bus.log; only the last may be cut, and only where nobody ended it."""
    text = (folder / "bus.log").read_text()
    lines = text.split("\n")
    for number, line in enumerate(lines[:-1], 1):
        check(re.fullmatch(r"\(\d+\.\d{6}\) \w+ [0-9A-F]{3,8}#(R\d?|([0-9A-F]{2})*)", line), f"{folder}/bus.log:{number}: {line!r} is no frame")
    return lines[:-1], lines[-1]


class Case:
    def __init__(self, program, number, phase):
        self.program, self.number, self.phase = program, number, phase
        self.name = f"{program} {number.name} in {phase}"


class Bench:
    """One rig, one campaign: each case is an attempt at its next maneuver, and the start of each proves that the one before can be come back from."""

    def __init__(self, build, folder):
        self.scenario, config = quick_rig(folder, patient=False)
        self.rig = Rig(build, folder, self.scenario, config)
        self.config, self.build = config, build
        self.out = folder / "campaign"
        self.ear = Ear(SYNC, VALVE, PRESSURE, STATUS, FAULTS, STATE, prompt=True)
        self.left_running = False  # by the case before
        self.last_words = ""

    def process(self, case, bridge):
        return {"controller": self.rig.controller, "virtual-rig": self.rig.virtual_rig, "bridge": bridge}[case.program]

    def start(self):
        # With a rig at rest: one that coasts after an abort takes its time, and has no spin-up.
        self.rig.virtual_rig.terminate()
        self.rig.virtual_rig.wait()
        self.rig.plc.client.close()
        self.ear.begin_anew()  # nobody who knows the phase is left
        self.rig.start()
        finished = sum(row["state"] == "finished" for row in ledger_copy(self.out)) if self.out.exists() else 0
        return self.rig.bridge("campaign", self.out, "--maneuvers", str(finished + 1))

    def strike(self, case):
        """The bridge, after the signal came in that phase; None: the host stood still, and the phase was over before it came or never came."""
        bridge = self.start()
        self.ear.until(lambda: REACHED[case.phase](self.ear) or bridge.poll() is not None, 120.0)
        if (case.program, case.phase) == ("bridge", "standby"):  # a PLC that has not seen it does not miss it: RIG-214
            self.rig.plc.await_bridge()
        target = self.process(case, bridge)
        with self.ear.news:
            reached = REACHED[case.phase](self.ear) and self.ear.state == STILL.get(case.phase, self.ear.state)
            if reached:
                self.current_mA = self.ear.current_mA
                self.ear.mark()
                target.send_signal(case.number)
        if reached:
            return bridge
        bridge.kill()
        bridge.wait()
        self.left_running = bridge.returncode == -signal.SIGKILL
        self.last_words = words(bridge)
        return None

    def come_back(self, case, bridge):
        """SIGCONT, or death. Nothing that comes back may open the valve; a rig that was stopped still has the pressure of then."""
        target = self.process(case, bridge)
        if case.number == signal.SIGKILL:
            target.wait()
            return
        self.ear.mark()
        target.send_signal(signal.SIGCONT)
        began = self.ear.syncs
        check(self.ear.until(lambda: self.ear.syncs >= began + AFTER_PERIODS), f"{case.name}: time stands still after SIGCONT")
        time.sleep(0.05)
        periods = periods_until(after_mark(list(self.ear.frames)), SYNC, PRESSURE, released)
        limit = PRESSURE_PERIODS if case.program == "virtual-rig" else 0
        check(periods is not None and periods <= limit, f"{case.name}: pressure until {periods} periods after SIGCONT, stated are {limit}")

    def safe_after(self, case, bridge):
        """Waits for what makes it safe, and returns (periods, limit)."""
        ear = self.ear
        if case.program == "bridge":
            check(ear.until(lambda: ear.faults & MANEUVER_LOST and ear.state == SAFE), f"{case.name}: maneuver_lost is not named: {ear.faults:x}")
            eventually(lambda: self.rig.plc.read("plc_state") == 1 and self.rig.plc.sledge_back(), f"{case.name}: the PLC does not trip")
            clock, identifier, is_safe, limit = SYNC, VALVE, without_current, MANEUVER_PERIODS
        else:
            bridge.wait(timeout=60)
            if case.program == "controller":
                clock, identifier, is_safe, limit = SYNC, PRESSURE, released, PRESSURE_PERIODS
            else:
                check(ear.until(lambda: ear.faults & SENSORS_LOST == SENSORS_LOST and ear.state == SAFE),
                      f"{case.name}: lost sensors are not named: {ear.faults:x}")
                # Without SYNC the controller's own commands count its periods.
                clock, identifier, is_safe, limit = VALVE, VALVE, without_current, SENSOR_PERIODS
        frames = list(ear.frames)
        check(whole(frames), f"{case.name}: frames were lost on the way to the judge")
        periods = periods_until(after_mark(frames), clock, identifier, is_safe)
        check(periods is not None, f"{case.name}: never safe")
        check(periods <= limit, f"{case.name}: safe after {periods} periods, stated are {limit}")
        return periods, limit

    def recorded(self, case, row):
        """(frames, dropped): the recording is whole, or, of a bridge that was killed, readable to its last whole line."""
        folder = self.out / row["folder"]
        if case.program == "bridge" and case.number == signal.SIGKILL and case.phase == "standby" and not folder.exists():
            return 0, "-"  # killed between the row and the recording
        lines, rest = log_lines(folder)
        if case.program == "bridge" and case.number == signal.SIGKILL:
            check(not (folder / "summary.json").exists(), f"{case.name}: a summary of what never ended")
            return len(lines), "-"
        check(rest == "", f"{case.name}: bus.log ends with {rest!r}")
        summary = json.loads((folder / "summary.json").read_text())
        check(summary["frames"] == len(lines), f"{case.name}: {len(lines)} lines, summary.json says {summary['frames']}")
        check(summary["outcome"] == row["outcome"], f"{case.name}: {summary['outcome']} in summary.json, {row['outcome']} in the ledger")
        check(summary["frames_dropped"] == 0 or case.program == "bridge", f"{case.name}: {summary['frames_dropped']} frames dropped")
        return len(lines), summary["frames_dropped"]

    def run(self, case):
        bridge = self.strike(case)
        if bridge is None:
            return None
        periods, limit = self.safe_after(case, bridge)
        self.come_back(case, bridge)
        status = bridge.wait(timeout=120)
        killed = case.program == "bridge" and case.number == signal.SIGKILL
        # A bridge that is stopped before anything moves resets the PLC that tripped on it, and goes on.
        goes_on = case.program == "bridge" and not killed and case.phase == "standby"
        expected = -signal.SIGKILL if killed else 0 if goes_on else 1
        check(status == expected, f"{case.name}: exit status {status}, expected {expected}\n{words(bridge)}")
        rows = ledger_copy(self.out)
        if self.left_running:
            check(rows[-2]["state"] == "unfinished", f"{case.name}: the attempt before is {rows[-2]['state']}, its bridge was killed")
        self.left_running = killed
        row = rows[-1]
        outcomes = {"controller": ("controller_silent",), "virtual-rig": ("plc_silent", "sensors_lost"),
                    "bridge": (None, "") if killed else ("finished",) if goes_on else ("plc_silent", "plc_tripped", "controller_fault")}[case.program]
        check(row["outcome"] in outcomes, f"{case.name}: outcome {row['outcome']}, expected {outcomes}\n{words(bridge)}")
        check(row["state"] == ("running" if killed else "finished" if goes_on else "aborted"), f"{case.name}: ledger says {row['state']}")
        frames, dropped = self.recorded(case, row)
        return [case.program, case.number.name, case.phase, f"{self.current_mA:.1f}", periods, limit, row["outcome"] or "-", row["state"], status,
                frames, dropped]

    def end(self):
        """After all of that the maneuver finishes, and every figure is made again from the logs with the same bits."""
        bridge = self.start()
        check(bridge.wait(timeout=300) == 0, f"no maneuver finishes any more\n{words(bridge)}")
        check(ledger_copy(self.out)[-1]["state"] == "finished", "the last attempt is not in the ledger as finished")
        self.rig.end()
        check(self.rig.controller.returncode == 0 and self.rig.virtual_rig.returncode == 0, "controller or virtual rig did not end well")
        replay = subprocess.run([self.build / "bin/rig-replay", "campaign", self.out, "--config", self.config],
                                capture_output=True, text=True)
        check(replay.returncode == 0, f"rig-replay campaign: {replay.returncode}\n{replay.stdout}{replay.stderr}")


def cases(sample):
    every = [Case(program, number, phase) for program in PROGRAMS for number in (signal.SIGKILL, signal.SIGSTOP)
             for phase in REACHED]
    if sample is None:
        return every
    draw = random.Random(sample)
    phases = draw.sample(list(REACHED), 6)
    return [case for case, phase in zip(every[::len(REACHED)], phases) for case in [Case(case.program, case.number, phase)]]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--sample", type=int)
    parser.add_argument("--program", choices=PROGRAMS)
    parser.add_argument("--csv", type=pathlib.Path)
    options = parser.parse_args()
    # Between the mark and the signal nobody else runs.
    os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(1))
    rows = []
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        bench = Bench(options.build, pathlib.Path(name))
        todo = [case for case in cases(options.sample) if options.program in (None, case.program)]
        for number, case in enumerate(todo, 1):
            row = None
            for _ in range(4):
                row = row or bench.run(case)
            check(row, f"{case.name}: the phase was not met four times\n{bench.last_words}")
            rows.append(row)
            print(f"{number:2}/{len(todo)}  " + "  ".join(str(each) for each in row), flush=True)
        bench.end()
    if options.csv:
        write_table(options.csv, COLUMNS, rows)
    print(f"{len(rows)} cases passed")


if __name__ == "__main__":
    """[BRG-450]"""
    sys.exit(main())
