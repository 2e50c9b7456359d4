#!/usr/bin/python3
"""Maneuvers back to back by three programs over vcan0 for a while of real time: does memory, descriptors, latency or the landing itself creep, is a
maneuver lost? Runs inside `./rig vcan`; `./rig check soak` starts it.

usage: soak.py BUILD_DIR [--out DIR] [--minutes M] [--clock sync|timer]
Leaves soak.csv (a row a minute, or a sixth of the time where that is shorter), result.json, soak.png and the campaign in DIR, which must not be
there yet; without it, nothing. Exit status 0: nothing creeps; 1: something does, or a program failed.
"""
import argparse
import json
import os
import pathlib
import signal
import socket
import statistics
import struct
import subprocess
import sys
import tempfile
import threading
import time

from bus_ear import SYNC, VALVE
from three_programs import Rig, changed, check, in_guest_memory, ledger_copy, quick_rig, words, write_table

PROGRAMS = ("controller", "virtual-rig", "bridge")
# What a host does that keeps a program waiting for longer than its peers do; the maneuver is run again.
LATENESS = {"bus_lost", "bus_unread", "controller_silent", "sensors_lost", "plc_silent", "plc_tripped", "controller_fault"}
LISTEN_S = 5.0          # of each row's time: a listener of ours costs the guest a tenth of its processor
RSS_GROWTH_KIB = 256    # from the first third to the last: allocators keep what they once had, and give nothing back
FEWEST = 3              # maneuvers, however long they take
COMPARABLE = 30         # maneuvers whose thirds can be compared
COLUMNS = ("minute", *(f"{name}_rss_KiB" for name in PROGRAMS), *(f"{name}_fds" for name in PROGRAMS), "finished", "aborted", "unfinished",
           "latency_p50_us", "latency_p99_us", "latency_max_us")
FINISHED = COLUMNS.index("finished")


def resident_KiB(pid):
    status = pathlib.Path(f"/proc/{pid}/status").read_text()
    return int(status.split("VmRSS:")[1].split()[0])


def descriptors(pid):
    return len(os.listdir(f"/proc/{pid}/fd"))


def latencies_us(clock, seconds, period_us=1000.0):
    """From SYNC to the valve command; by the timer: how far a command is from one period after the last. Kernel time stamps."""
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as ear:
        ear.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, b"".join(struct.pack("=II", each, 0x7FF) for each in (SYNC, VALVE)))
        ear.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 22)
        ear.setsockopt(socket.SOL_SOCKET, 35, 1)  # SO_TIMESTAMPNS
        ear.settimeout(10.0)
        ear.bind(("vcan0",))
        found, since_us, deadline = [], None, time.monotonic() + seconds
        while time.monotonic() < deadline:
            data, ancillary, _, _ = ear.recvmsg(16, 64)
            sec, nsec = struct.unpack("=qq", ancillary[0][2][:16])
            now_us = sec * 1e6 + nsec * 1e-3
            is_command = struct.unpack_from("=I", data)[0] & 0x7FF == VALVE
            if is_command and since_us is not None:
                found.append(now_us - since_us if clock == "sync" else abs(now_us - since_us - period_us))
            since_us = now_us if is_command == (clock == "timer") else None
    return sorted(found)


class DescriptorPeaks:
    """The most descriptors that each program has open at once, row by row: a recording opens some for as long as a maneuver lasts."""

    def __init__(self, processes):
        self._processes, self._most, self._over = processes, dict.fromkeys(processes, 0), threading.Event()

    def __enter__(self):
        self._thread = threading.Thread(target=self._watch)
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._over.set()
        self._thread.join()

    def _watch(self):
        while not self._over.wait(0.2) and all(each.poll() is None for each in self._processes.values()):
            for name, process in self._processes.items():
                self._most[name] = max(self._most[name], descriptors(process.pid))

    def take(self):
        most, self._most = self._most, dict.fromkeys(self._processes, 0)
        return most.values()


def quantile(ordered, share):
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)]


def count(rows, state):
    return sum(row["state"] == state for row in rows)


def thirds(values):
    """The first and the last third."""
    third = max(len(values) // 3, 1)
    return values[:third], values[-third:]


def watch(rig, bridge, options):
    """A row each time."""
    processes = dict(zip(PROGRAMS, (rig.controller, rig.virtual_rig, bridge)))
    every_s = min(60.0, options.minutes * 60.0 / 6)
    began, rows = time.monotonic(), []
    planned = round(options.minutes * 60.0 / every_s)
    with DescriptorPeaks(processes) as peaks:
        while len(rows) < planned or (rows[-1][FINISHED] < FEWEST and len(rows) < 10 * planned):
            time.sleep(max(0.0, began + (len(rows) + 1) * every_s - LISTEN_S - time.monotonic()))
            for name, process in processes.items():
                check(process.poll() is None, f"{name} ended: {process.returncode}\n{words(bridge)}")
            latency = latencies_us(options.clock, LISTEN_S)
            check(len(latency) > 100, f"{len(latency)} valve commands in {LISTEN_S} s")
            ledger = ledger_copy(options.out / "campaign")
            rows.append([round((time.monotonic() - began) / 60.0, 2), *(resident_KiB(each.pid) for each in processes.values()),
                         *peaks.take(), count(ledger, "finished"), count(ledger, "aborted"),
                         count(ledger, "unfinished"), *(round(quantile(latency, share), 1) for share in (0.5, 0.99, 1.0))])
            print("  ".join(f"{name} {value}" for name, value in zip(COLUMNS, rows[-1])), flush=True)
    return rows


def judge(rows, ledger):
    """What creeps or is lost, one line each."""
    wrong = []
    used = [row for row in rows if row[FINISHED] > 0] or rows  # the first maneuver takes memory that the others use again
    for column, name in enumerate(COLUMNS):
        first, last = (max(part) for part in thirds([row[column] for row in used]))
        if name.endswith("_rss_KiB") and last > first + RSS_GROWTH_KIB or name.endswith("_fds") and last > first:
            wrong.append(f"{name}: {first} in the first third, {last} in the last")
    finished = [row for row in ledger if row["state"] == "finished"]
    if [row["number"] for row in finished] != list(range(1, len(finished) + 1)):
        wrong.append("a maneuver was lost, or finished twice")
    aborted = {row["outcome"] for row in ledger if row["state"] == "aborted"}
    if not aborted <= LATENESS | {"requested"}:
        wrong.append(f"aborted: {sorted(aborted)}")
    if count(ledger, "unfinished") or count(ledger, "running"):
        wrong.append("an attempt was left")
    lengths = [row["length_m"] for row in finished]
    if len(lengths) < FEWEST:
        wrong.append(f"{len(lengths)} maneuvers finished")
    if len(lengths) >= COMPARABLE:
        first, last = thirds(lengths)
        error = (statistics.variance(first) / len(first) + statistics.variance(last) / len(last)) ** 0.5
        if abs(statistics.mean(last) - statistics.mean(first)) > 4.0 * error:
            wrong.append(f"mean length {statistics.mean(first):.3f} m in the first third, {statistics.mean(last):.3f} m in the last")
    return wrong, lengths


def soak(options):
    scenario, config = quick_rig(options.out)
    brake = config / "landing_gear.toml"
    brake.write_text(changed(brake.read_text(), energy_scale="1.0e6"))  # a brake that wears would stop later and later, as it should
    rig = Rig(options.build, options.out, scenario, config, clock=options.clock, answer_timeout_ms=3000)
    bridge = rig.bridge("campaign", options.out / "campaign", "--maneuvers", "1000000", "--retry", "1000",
                        priority=50 if options.clock == "timer" else 0)
    rows = watch(rig, bridge, options)
    bridge.send_signal(signal.SIGINT)
    status = bridge.wait(timeout=120)
    check(status == 130, f"rig-bridge: exit status {status}\n{words(bridge)}")
    rig.end()
    check(rig.controller.returncode == 0 and rig.virtual_rig.returncode == 0, "controller or virtual rig did not end well")
    ledger = ledger_copy(options.out / "campaign")
    wrong, lengths = judge(rows, ledger)
    dropped = sum(json.loads((options.out / "campaign" / row["folder"] / "summary.json").read_text())["frames_dropped"]
                  for row in ledger if row["state"] == "finished")
    if dropped:
        wrong.append(f"{dropped} frames were not recorded")
    result = {"minutes": rows[-1][0], "clock": options.clock, "finished": len(lengths), "wrong": wrong,
              "aborted": [row["outcome"] for row in ledger if row["state"] == "aborted"]}
    if len(lengths) >= FEWEST:
        first, last = thirds(lengths)
        result |= {"first_third_mean_length_m": statistics.mean(first), "last_third_mean_length_m": statistics.mean(last),
                   "deviation_m": statistics.stdev(lengths)}
    write_table(options.out / "soak.csv", COLUMNS, rows)
    subprocess.run([options.build / "tests/vcan/soak_picture", options.out / "soak.csv", options.out / "soak.png"], check=True)
    (options.out / "result.json").write_text(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))
    check(not wrong, "; ".join(wrong))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--out", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--clock", choices=("sync", "timer"), default="sync")
    options = parser.parse_args()
    if options.out:
        options.out.mkdir(parents=True)
        soak(options)
    else:
        with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
            options.out = pathlib.Path(name)
            soak(options)


if __name__ == "__main__":
    """[BRG-616]"""
    sys.exit(main())
