#!/usr/bin/python3
"""A sample of the fault campaign over a real bus: landings by three programs in paced lockstep while netem loses, repeats, reorders, delays and
corrupts what is sent on vcan0, every frame alike. Outcomes by the criteria of docs/engineering/fault_campaign.md, in periods of the rig. Runs inside
`./rig vcan`, in its guest: only there can vcan be loaded anew with echo=1, without which netem has no effect.

usage: disturbed_bus.py BUILD_DIR [--kind NAME]... [--csv FILE]
Exit status 0: nothing UNSAFE; 1: something is, or a run has no outcome; 77: this kernel is not ours to load modules into.
"""
import argparse
import json
import math
import os
import pathlib
import subprocess
import struct
import sys
import tempfile
import tomllib

from bus_ear import (FAULTS, FLYWHEEL, LOCKED, MANEUVER, MARK, PRESSURE, SAFE, STATE, STATUS, SYNC, VALVE, WHEEL, Ear, current_mA,
                     pressure_Pa)
from controller_rig import crc_is_right
from three_programs import PHASES, Rig, changed, check, in_guest_memory, quick_rig, words, write_table

NOT_TESTED = 77
# Shares are of frames, each drawn by itself. A delay longer than a period stretches time in lockstep; what it brings is frames that are overtaken.
KINDS = {
    "none": "",
    "drop_0.1_percent": "loss 0.1%",
    "drop_1_percent": "loss 1%",
    "drop_5_percent": "loss 5%",
    "duplicate_1_percent": "duplicate 1%",
    "duplicate_20_percent": "duplicate 20%",
    "corrupt_0.1_percent": "corrupt 0.1%",
    "corrupt_1_percent": "corrupt 1%",
    "corrupt_5_percent": "corrupt 5%",
    "reorder_1_percent": "delay 1ms reorder 99%",
    "reorder_10_percent": "delay 1ms reorder 90%",
    "delay_2_ms": "delay 2ms",
    "delay_0_to_4_ms": "delay 2ms 2ms",
    "all_at_once": "delay 1ms 1ms loss 0.5% duplicate 0.5% corrupt 0.5%",
}
COLUMNS = ("disturbance", "outcome", "hazard", "controller_faults", "bridge_outcome", "exit_status", "length_m", "recorded_length_m", "share", "frames",
           "wrong_crc", "late_safe_periods", "lock_periods")
HANDLED, DEGRADED, SLACK_M = 1.15, 1.5, 1.0
SAFE_PERIODS, LOCK_PERIODS, UNASKED_PERIODS, UNASKED_PA, LOCK_PA, LOCK_MPS = 21, 250, 250, 1e6, 0.5e6, 6.0
TEETH = 60
MOST_LOST = 8  # SYNCs in a row, at 5 %
SPEED_MPS = 25.0
TOUCHED_DOWN = PHASES[PHASES.index("settling"):]


def sh(command):
    return subprocess.run(command, shell=True, capture_output=True, text=True)


def echoing_bus():
    modprobe = "/run/uml/modprobe"  # of a guest of `./rig vcan`
    if not os.path.exists(modprobe):
        print("not tested: this kernel is the host's, and its vcan is not ours to load anew")
        sys.exit(NOT_TESTED)
    done = sh(f"ip link del vcan0 && rmmod vcan && {modprobe} vcan echo=1 && {modprobe} sch_netem &&"
              " ip link add dev vcan0 type vcan && ip link set vcan0 txqueuelen 1000 up")
    check(done.returncode == 0, done.stderr)


def disturb(kind):
    sh("tc qdisc del dev vcan0 root")
    if KINDS[kind]:
        done = sh(f"tc qdisc add dev vcan0 root netem limit 1000 {KINDS[kind]}")
        check(done.returncode == 0, done.stderr)


with open("config/controller.toml", "rb") as file:
    RIM_M = tomllib.load(file)["flywheel"]["radius_m"]


def signed(difference):
    """Of two 16-bit counters; a frame that was overtaken goes back."""
    return (difference + 0x8000 & 0xFFFF) - 0x8000


class Judge:
    """The criteria of docs/engineering/fault_campaign.md on what came through: frames with the right CRC, one period a SYNC."""

    def __init__(self):
        self.wrong_crc = self.late = self.worst_late = self.locked = self.worst_lock = self.unasked = 0
        self.since_edge, self.wheel_edges, self.rim_edges, self.rim_mps = 0, None, [], 0.0
        self.pressure_Pa, self.demand_Pa, self.current_mA, self.state = 0.0, 0.0, 0.0, None
        self.sync, self.hazard, self.named, self.protected, self.over = None, "none", 0, False, False
        self.braking, self.braked_edges = False, 0

    def see(self, identifier, data):
        if identifier == SYNC:
            number = struct.unpack_from("<H", data)[0]
            passed = 1 if self.sync is None else (number - self.sync) & 0xFFFF
            if passed != 0:  # no repetition
                self.period(passed if passed <= MOST_LOST else 1)  # SYNC has no CRC: another gap is a corrupted number
            self.sync = number
        elif not crc_is_right(identifier, data):
            self.wrong_crc += 1
        elif identifier == WHEEL:
            edges = struct.unpack_from("<H", data, 2)[0]
            if edges != self.wheel_edges:
                self.wheel_edges, self.since_edge = edges, 0
        elif identifier == FLYWHEEL:
            edges = struct.unpack_from("<H", data, 2)[0]
            if self.rim_edges and self.braking:
                self.braked_edges += signed(edges - self.rim_edges[-1][1])
            self.rim_edges = [*self.rim_edges[-49:], (self.sync or 0, edges)]
        elif identifier == PRESSURE:
            self.pressure_Pa = pressure_Pa(data)
        elif identifier == MANEUVER:
            self.demand_Pa = struct.unpack_from("<H", data, 2)[0] * 500.0 if data[1] & 0x80 else 0.0
            self.braking |= self.demand_Pa > 0.0
        elif identifier == VALVE:
            self.current_mA = current_mA(data)
        elif identifier == STATUS:
            self.state = data[1] >> 4
            self.protected |= self.state == LOCKED
        elif identifier == FAULTS and not self.over:
            self.named |= int.from_bytes(data[2:6], "little")
        elif identifier == STATE:
            self.over |= PHASES[data[1] >> 4] in ("finished", "aborted")  # then the bridge goes, which is a fault of its own

    def period(self, passed):
        self.since_edge += passed
        given_up = self.state == SAFE and self.current_mA == 0.0
        self.late = self.late + passed if self.state == SAFE and self.current_mA > 0.0 else 0
        self.worst_late = max(self.worst_late, self.late)
        if self.late > SAFE_PERIODS:
            self.raise_hazard("late_safe")
        asked_Pa = self.demand_Pa + UNASKED_PA
        self.unasked = self.unasked + passed if not given_up and self.pressure_Pa > asked_Pa else 0
        if self.unasked > UNASKED_PERIODS:
            self.raise_hazard("unasked_pressure")
        locked = not given_up and self.since_edge > 30 and self.rim_speed() > LOCK_MPS and self.pressure_Pa > LOCK_PA
        self.locked = self.locked + passed if locked else 0
        self.worst_lock = max(self.worst_lock, self.locked)
        if self.locked > LOCK_PERIODS:
            self.raise_hazard("locked_wheel")

    def length_m(self):
        """From brake-on, by the rim's edges: the CRC stands for them, and none for the SYNC number that summary.json counts time by."""
        return self.braked_edges / TEETH * 2.0 * math.pi * RIM_M

    def rim_speed(self):
        (sync, edges), (sync_now, edges_now) = self.rim_edges[0], self.rim_edges[-1]
        periods, turned = signed(sync_now - sync), signed(edges_now - edges)
        return 0.0 if periods <= 0 else turned / TEETH * 2.0 * math.pi * RIM_M / (periods * 1e-3)

    def raise_hazard(self, name):
        if self.hazard == "none":
            self.hazard = name


def outcome(judge, summary, sound_m):
    """(outcome, hazard)"""
    named = judge.named != 0 or summary["outcome"] != "finished"
    within = lambda share: summary["standstill"] and judge.length_m() <= share * sound_m + SLACK_M
    if judge.hazard != "none":
        return "UNSAFE", judge.hazard
    if named:
        return "safe", "none"
    if within(HANDLED):
        return "handled", "none"
    if within(DEGRADED) and judge.protected:
        return "degraded", "none"
    return "UNSAFE", "silent_loss"


def run(rig, ear, phases, folder, kind, number, sound_m):
    disturb("none")
    rig.virtual_rig.terminate()  # a flywheel at rest, a brake that is new
    rig.virtual_rig.wait()
    rig.plc.client.close()
    ear.begin_anew()
    phases.begin_anew()
    rig.start()
    out = folder / f"run{number}"
    bridge = rig.bridge("maneuver", out, "--no-cool-down")
    check(phases.until(lambda: phases.phase in TOUCHED_DOWN or bridge.poll() is not None, 120.0), f"{kind}: no touchdown\n{words(bridge)}")
    check(bridge.poll() is None, f"{kind}: no touchdown\n{words(bridge)}")
    disturb(kind)
    status = bridge.wait(timeout=200)
    disturb("none")
    check(status in (0, 1), f"{kind}: exit status {status}\n{words(bridge)}")
    judge = Judge()
    ear.mark()
    check(ear.until(lambda: ear.marks > 0), f"{kind}: the ear does not hear its own mark")
    frames = [each for each in ear.frames if each[0] != MARK]
    settling = [i for i, (identifier, data) in enumerate(frames) if identifier == STATE and PHASES[data[1] >> 4] == "settling"]
    check(settling, f"{kind}: no touchdown\n{words(bridge)}")
    begun = settling[0]
    for each in frames[begun:]:
        judge.see(*each)
    summary = json.loads((out / "summary.json").read_text())
    check((summary["outcome"] == "finished") == (status == 0), f"{kind}: exit status {status}, outcome {summary['outcome']}")
    if status != 0:
        print("\n".join(line for line in words(bridge).splitlines() if "abort" in line.lower()), flush=True)
    length_m = judge.length_m()
    sound_m = sound_m or length_m
    result, hazard = outcome(judge, summary, sound_m)
    return sound_m, [kind, result, hazard, " ".join(summary["faults"]) or "-", summary["outcome"], status, f"{length_m:.2f}",
                     f"{summary['length_m']:.2f}", f"{length_m / sound_m:.3f}", len(frames) - begun, judge.wrong_crc, judge.worst_late,
                     judge.worst_lock]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--kind", action="append", choices=list(KINDS))
    parser.add_argument("--csv", type=pathlib.Path)
    options = parser.parse_args()
    echoing_bus()
    rows, sound_m = [], None
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        folder = pathlib.Path(name)
        scenario, config = quick_rig(folder)
        scenario.write_text(changed(scenario.read_text(), speed_mps=SPEED_MPS))
        rig = Rig(options.build, folder, scenario, config)
        ear = Ear(SYNC, VALVE, WHEEL, FLYWHEEL, PRESSURE, MANEUVER, STATUS, FAULTS, STATE)
        phases = Ear(SYNC, STATE)  # few frames: on a slow machine the other ear hears what was seconds ago
        kinds = ["none", *(options.kind or list(KINDS)[1:])]
        for number, kind in enumerate(kinds, 1):
            sound_m, row = run(rig, ear, phases, folder, kind, number, sound_m)
            rows.append(row)
            print(f"{number:2}/{len(kinds)}  " + "  ".join(str(each) for each in row), flush=True)
        rig.end()
    check(rows[0][1] == "handled", f"the undisturbed landing is {rows[0]}")
    if options.csv:
        write_table(options.csv, COLUMNS, rows)
    unsafe = [row[0] for row in rows if row[1] == "UNSAFE"]
    check(not unsafe, f"UNSAFE: {unsafe}")
    print(f"{len(rows)} landings passed")


if __name__ == "__main__":
    """[BRG-450]"""
    sys.exit(main())
