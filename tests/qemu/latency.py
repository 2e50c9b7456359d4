#!/usr/bin/python3
"""How late the controller is on PREEMPT_RT, in virtual time: what else runs on the host does not show, so that a figure that gets worse is the
program's (or the kernel's) doing. Each alone, and beside programs that keep processor, memory and files busy. Runs inside
`tests/qemu/run`, as root.

usage: latency.py BUILD_DIR
Compared with latency.toml beside it. Exit status 1: a figure is above its limit.
"""
import argparse
import json
import os
import pathlib
import re
import signal
import socket
import struct
import subprocess
import sys
import time
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "vcan"))
from controller_rig import SYNC, VALVE, Bus, Rig  # noqa: E402

LOADS = ("while :; do :; done", "while :; do dd if=/dev/zero of=/dev/shm/load bs=1M count=16 2>/dev/null; done",
         "while :; do find /usr/lib/python3 -name '*.none' >/dev/null; done")
STEPS = 500


def check(truth, what):
    if not truth:
        raise SystemExit(f"FAILED: {what}")


def quantiles(values):
    ordered = sorted(values)
    return {name: round(ordered[min(int(share * len(ordered)), len(ordered) - 1)], 1) for name, share in (("p50", 0.5), ("p99", 0.99), ("max", 1.0))}


def cyclictest():
    """A thread that sleeps for 1 ms: what this kernel gives to anybody."""
    said = subprocess.run(["cyclictest", "-m", "-p", "80", "-i", "1000", "-l", "3000", "-q", "-h", "20000"], capture_output=True, text=True,
                          check=True).stdout
    values = []
    for us, count in re.findall(r"^(\d{6})\s+(\d+)", said, re.M):
        values += [float(us)] * int(count)
    check(len(values) > 2000, f"cyclictest: {said[-500:]}")
    return quantiles(values)


def wake_up(build):
    """The controller's own pacer, by its check before the wheel turns."""
    said = subprocess.run([build / "bin/antiskid-controller", "--can", "can0", "--check", "--timing-s", "3", "--json", "-"],
                          stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    (timing,) = (each for each in json.loads(said)["checks"] if each["name"] == "loop latency")
    return {name: round(timing["figures"][f"{name}_us"], 1) for name in ("p50", "p99", "max")}


class TimedBus(Bus):
    """Knows when it sent each SYNC: the stamp of its own frame's echo waits until the controller has done with the processor."""

    def __init__(self, interface):
        super().__init__(interface)
        self.sync_sent_us = []

    def send(self, can_id, data):
        if can_id == SYNC:
            self.sync_sent_us.append(time.time_ns() * 1e-3)
        super().send(can_id, data)


def answer(build):
    """From the sending of SYNC at the far adapter to the valve command there, by the kernel's time stamp."""
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as ear:
        ear.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, struct.pack("=II", VALVE, 0x7FF))
        ear.setsockopt(socket.SOL_SOCKET, 33, 1 << 23)  # SO_RCVBUFFORCE
        ear.setsockopt(socket.SOL_SOCKET, 35, 1)        # SO_TIMESTAMPNS
        ear.bind(("can1",))
        controller = subprocess.Popen([build / "bin/antiskid-controller", "--can", "can0", "--clock", "sync"],
                                      stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        while b"on can0" not in (said := controller.stderr.readline()):
            check(said, "the controller did not start")
        # Loads do not hold the sender up; below the kernel's interrupt threads, which bring the frames.
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(40))
        rig = Rig(TimedBus("can1"))
        while rig.steps < STEPS:
            rig.step()
        answered_us = []
        for _ in range(STEPS):
            _, ancillary, _, _ = ear.recvmsg(16, 64)
            sec, nsec = struct.unpack("=qq", ancillary[0][2][:16])
            answered_us.append(sec * 1e6 + nsec * 1e-3)
        os.sched_setscheduler(0, os.SCHED_OTHER, os.sched_param(0))
        controller.send_signal(signal.SIGTERM)
        controller.communicate(timeout=60)
        check(controller.returncode == 0, "the controller failed")
        both = list(zip(rig.bus.sync_sent_us, answered_us))
        return quantiles([after - before for before, after in both[1:]])  # the first waits for pages of the sender's own code


def under(load, measure):
    """The same beside programs that keep the processor busy; those are killed by their group."""
    busy = [subprocess.Popen(["bash", "-c", each], start_new_session=True) for each in load]
    try:
        return measure()
    finally:
        for each in busy:
            os.killpg(each.pid, signal.SIGKILL)
            each.wait()


def main():
    """[RT-172]"""
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    build = parser.parse_args().build
    limits = tomllib.loads((HERE / "latency.toml").read_text())
    above = []
    print(f"{'us':12} {'beside':8} {'p50':>8} {'p99':>8} {'max':>8}   limits")
    for load_name, load in (("nothing", ()), ("load", LOADS)):
        for name, measure in (("cyclictest", cyclictest), ("wake_up", lambda: wake_up(build)), ("answer", lambda: answer(build))):
            measured, limit = under(load, measure), limits[load_name][name]
            print(f"{name:12} {load_name:8} " + " ".join(f"{measured[each]:8.1f}" for each in ("p50", "p99", "max")) + f"   {limit}", flush=True)
            above += [f"{name} beside {load_name}, {each}: {measured[each]} us, limit {limit[each]}" for each in limit if measured[each] > limit[each]]
    check(not above, "; ".join(above))
    print("latency: passed")


if __name__ == "__main__":
    main()
