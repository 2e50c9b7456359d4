#!/usr/bin/python3
"""Whose rig: a second bridge, and a second controller, on a rig that is at work. Real programs over vcan and Modbus TCP, in paced lockstep; runs
inside `./rig vcan`.

usage: whose_rig.py BUILD_DIR
"""
import json
import pathlib
import socket
import struct
import subprocess
import sys
import tempfile
import time

from controller_rig import MANEUVER, crc8, pack
from three_programs import Bus, check, eventually, in_guest_memory, patient_rig, quick_rig, words

BUILD = pathlib.Path(sys.argv[1]).resolve()


def other_interface(rig, out, *place):
    command = rig.command("maneuver", out, "--priority", "0")
    for option, value in place:
        command[command.index(option) + 1] = value
    return command


def refused(process, *wanted):
    check(process.wait(timeout=60) == 1, f"status {process.returncode}: {words(process)}")
    for text in wanted:
        check(text in words(process), f"never said: {text}\n{words(process)}")


def preflight(rig, folder, *before):
    command = rig.command("preflight", folder / "looked", "--json", "-")
    done = subprocess.run([*before, *command], capture_output=True, text=True, timeout=120)
    return {check_["name"]: check_ for check_ in json.loads(done.stdout)["checks"]}


def second_bridge(rig, bus, folder):
    """[BRG-460] It is refused whatever it has in common with the first, and the first one finishes."""
    subprocess.run("ip link add dev vcan1 type vcan && ip link set vcan1 up", shell=True, check=True)
    first = rig.bridge("campaign", folder / "first", "--maneuvers", "2")
    check(bus.await_phase(("braking",)), f"no braking: {words(first)}")
    hold = [rig.build / "bin/rig-bridge", "pause", folder / "first", "--why", "the others are refused first"]
    subprocess.run(hold, check=True, stdout=subprocess.DEVNULL)
    holder = f"is held by rig-bridge campaign, process {first.pid}, since 2"
    for number, (what, place) in enumerate((
            ("CAN interface vcan0", []),
            ("CAN interface vcan0", [("--plc", "127.0.0.1:1503")]),
            ("Modbus TCP 127.0.0.1:1502, unit 1", [("--can", "vcan1")]))):
        out = folder / f"second{number}"
        check(first.poll() is None, f"the first has ended: {words(first)}")
        refused(rig.start_bridge(other_interface(rig, out, *place)), f"{what} {holder}", f"records in {folder / 'first'}", "Next: ")
        check(not out.exists(), "the refused one has made a folder")
    free = preflight(rig, folder)["rig free"]
    check(free["verdict"] == "fail" and holder in free["measured"], f"{free}\n{words(first)}")
    # The same names in another network namespace are another rig.
    apart = ["unshare", "--net", "sh", "-c", 'ip link add dev vcan0 type vcan && ip link set vcan0 up && exec "$@"', "apart"]
    check(preflight(rig, folder, *apart)["rig free"]["verdict"] == "pass", "another namespace is held, too")
    subprocess.run([rig.build / "bin/rig-bridge", "resume", folder / "first"], check=True, stdout=subprocess.DEVNULL)
    check(first.wait(timeout=120) == 0, f"the first was disturbed: {words(first)}")
    for number in (1, 2):
        outcome = json.loads((folder / f"first/quick/000{number}/summary.json").read_text())["outcome"]
        check(outcome == "finished", f"maneuver {number} of the first: {outcome}")


def killed(rig, bus, folder):
    """[BRG-460] SIGKILL leaves nothing behind: the next one has the rig at once."""
    first = rig.bridge("maneuver", folder / "killed")
    check(bus.await_phase(("braking",)), f"no braking: {words(first)}")
    first.kill()
    first.wait()
    again = rig.bridge("maneuver", folder / "again")
    check(again.wait(timeout=120) == 0, words(again))


def await_two(second):
    """Until each SYNC has two valve commands: a program takes seconds to start where the machine is slow."""
    def both_answer():
        heard = subprocess.run(["candump", "-n", "100", "-T", "5000", "vcan0,080:7FF,100:7FF"], stdout=subprocess.PIPE, check=True, text=True)
        identifiers = [line.split()[1] for line in heard.stdout.splitlines()]
        return identifiers.count("100") > 1.8 * identifiers.count("080") > 0

    eventually(lambda: both_answer() or second.poll() is not None, "the controllers are not heard")
    check(second.poll() is None, "the second controller has ended")


def start_controller():
    return subprocess.Popen([BUILD / "bin/antiskid-controller", "--can", "vcan0", "--clock", "sync"], stdout=subprocess.DEVNULL,
                            stderr=subprocess.DEVNULL)


def second_controller(rig, bus, folder):
    """[BRG-460] Two controllers: refused at the start, by what shows that there are two, before anything is commanded."""
    second = start_controller()
    try:
        await_two(second)
        commit = rig.plc.map["holding"]["commit"]["address"]
        before = rig.plc.client.read_holding_registers(commit, count=1, slave=1).registers
        refused(rig.bridge("maneuver", folder / "two"), "not started", "only controller: ", " of 0x1", "Next: end one")
        check(rig.plc.client.read_holding_registers(commit, count=1, slave=1).registers == before, "the refused one has written to the PLC")
        look = preflight(rig, folder)["only controller"]
        check(look["verdict"] == "fail", look)
        watched = [rig.build / "bin/rig-bridge", "watch", folder / "first", "--can", "vcan0", "--config", rig.config, "--once", "--json", "-"]
        seen = json.loads(subprocess.run(watched, capture_output=True, text=True, timeout=60).stdout)
        check(seen["senders"].startswith("two controllers talk on the bus: "), seen)
    finally:
        second.terminate()
        second.wait(timeout=20)
    # One that comes while the first brakes ends it, wherever the two's counters stand.
    for attempt in range(3):
        run = rig.bridge("maneuver", folder / f"later_{attempt}")
        check(bus.await_phase(("braking",)), f"no braking: {words(run)}")
        second = start_controller()
        check(run.wait(timeout=120) == 1, words(run))
        second.terminate()
        second.wait(timeout=20)
        named_two(run, folder / f"later_{attempt}", "two controllers talk on the bus: ")
    alone = rig.bridge("maneuver", folder / "alone")
    check(alone.wait(timeout=120) == 0, words(alone))


def named_two(run, out, what):
    outcome = json.loads((out / "summary.json").read_text())["outcome"]
    print(next(line for line in words(run).splitlines() if "was aborted: " in line), flush=True)
    check(outcome == "two_senders" and what in words(run) and "Next: find the second one" in words(run), f"{outcome}\n{words(run)}")


def heard_bridge(rig, bus, folder):
    """[BRG-460] A bridge that no lock of this computer knows of: commands that disarm, by hand, with good counters and check values."""
    run = rig.bridge("maneuver", folder / "heard")
    check(bus.await_phase(("spin_up",)), f"no spin-up: {words(run)}")
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as mouth:
        mouth.bind(("vcan0",))
        for number in range(2000):
            if run.poll() is not None:
                break
            body = bytes([number % 15]) + bytes(6)
            mouth.send(pack(MANEUVER, bytes([crc8(struct.pack("<H", MANEUVER) + body)]) + body))
            time.sleep(0.02)
    check(run.wait(timeout=60) == 1, words(run))
    named_two(run, folder / "heard", "two bridges command on the bus: two senders of 0x120, at counters ")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        place = pathlib.Path(name)
        scenario, config = quick_rig(place)
        programs = patient_rig(BUILD, place, scenario, config)
        ear = Bus()
        for test in (second_bridge, killed, second_controller, heard_bridge):
            test(programs, ear, place)
            print(f"{test.__name__}: passed", flush=True)
        programs.end()
