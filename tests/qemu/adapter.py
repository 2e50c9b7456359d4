#!/usr/bin/python3
"""A CAN adapter that is pulled out of a running controller and plugged in again: the kernel's own sja1000 and kvaser_pci drivers on emulated
hardware. Runs inside `tests/qemu/run`, as root.

usage: adapter.py BUILD_DIR
"""
import json
import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "vcan"))
from controller_rig import SAFE_MA, VALVE, Bus, Rig, crc_is_right, current_mA  # noqa: E402


def check(truth, what):
    if not truth:
        raise SystemExit(f"FAILED: {what}")


def main():
    """[RT-040]"""
    build = pathlib.Path(sys.argv[1]).resolve()
    place = pathlib.Path(tempfile.mkdtemp())
    log, report = place / "log", place / "report.json"
    with open(log, "wb") as out:
        controller = subprocess.Popen([build / "bin/antiskid-controller", "--can", "can0", "--clock", "sync", "--sync-timeout", "200",
                                       "--json", report], stdout=out, stderr=out)

    def says(text):
        deadline = time.monotonic() + 60.0
        while text not in log.read_text():
            check(controller.poll() is None, f"the controller ended: {log.read_text()}")
            check(time.monotonic() < deadline, f"no '{text}' in: {log.read_text()}")
            time.sleep(0.02)

    says("on can0")
    rig = Rig(Bus("can1"))
    rig.brake()
    print(f"braking with {rig.current_mA:.1f} mA over {pathlib.Path('/sys/class/net/can0/device/driver').resolve().name}", flush=True)
    adapter = pathlib.Path("/sys/class/net/can0/device").resolve()
    (adapter / "remove").write_text("1")
    check(not os.path.exists("/sys/class/net/can0"), "the adapter is still there")
    says("can0 is down or gone")
    says("fault bus_off")
    check(controller.poll() is None, "the controller ended")
    # What comes out of the bus before the adapter is back cannot be a command.
    while rig.bus.receive(0.1):
        pass
    pathlib.Path("/sys/bus/pci/rescan").write_text("1")
    check(os.path.exists("/sys/class/net/can0"), "the adapter did not come back")
    subprocess.run(["ip", "link", "set", "can0", "type", "can", "bitrate", "1000000"], check=True)
    subprocess.run(["ip", "link", "set", "can0", "up"], check=True)
    says("can0 is up again")
    frames = []
    while sum(each[0] == VALVE for each in frames) < 50:
        frame = rig.bus.receive()
        check(frame, f"no command after the adapter came back: {log.read_text()}")
        frames.append(frame)
    commands = [data for can_id, data in frames if can_id == VALVE]
    check(all(crc_is_right(VALVE, data) and abs(current_mA(data) - SAFE_MA) < 1e-3 for data in commands), "a command that is not the safe current")
    controller.send_signal(signal.SIGTERM)
    check(controller.wait(60) == 0, f"exit status {controller.returncode}: {log.read_text()}")
    told = json.loads(report.read_text())
    check(told["link"]["outages"] >= 1 and "bus_off" in [fault["name"] for fault in told["faults"]], told)
    print(log.read_text())
    print("unplugged while braking, named, back with the safe current: passed")


if __name__ == "__main__":
    main()
