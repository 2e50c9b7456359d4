#!/usr/bin/python3
"""What happens to a maneuver when an interlock opens or a program dies, in each phase: three real programs in paced lockstep. Asserts outcomes and
that the valve ends at its safe current; times are measured and never asserted. Runs inside `./rig vcan`.

usage: peers.py BUILD_DIR PHASE [--write]    one of spin_up, settling, braking, retract
--write keeps the rows in docs/generated/peers and makes docs/generated/peers.md from all of them.
"""
import csv
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from three_programs import Bus, Rig, check, eventually, in_guest_memory, quick_rig, words

BUILD = pathlib.Path(sys.argv[1]).resolve()
FOLDER = pathlib.Path("docs/generated/peers")
PHASES = ("spin_up", "settling", "braking", "retract")
INTERLOCKS = {"emergency_stop_clear": "emergency_stop", "guard_closed": "guard_open", "hydraulics_ready": "hydraulics_lost",
              "drive_healthy": "drive_fault"}


class Case:
    def __init__(self, cause, act, undo, outcomes, note):
        self.cause, self.act, self.undo, self.outcomes, self.note = cause, act, undo, outcomes, note


def link(state):
    subprocess.run(["ip", "link", "set", "vcan0", state], check=True)


def cases(rig):
    """Cause, how it comes, how it goes, the outcomes that are right, who makes the rig safe."""
    nothing = lambda: None
    for name, outcome in INTERLOCKS.items():
        yield Case(f"interlock {name} opens", lambda name=name: rig.plc.fault("open_interlocks", rig.plc.interlock(name)),
                   lambda: rig.plc.fault("open_interlocks", 0), {outcome}, "bridge: emergency stop; PLC trips")
    yield Case("controller SIGSTOP", lambda: rig.controller.send_signal(signal.SIGSTOP), lambda: rig.controller.send_signal(signal.SIGCONT),
               {"controller_silent"}, "valve driver: no command for 20 ms; bridge aborts")
    yield Case("controller SIGKILL", lambda: (rig.controller.kill(), rig.controller.wait()), nothing, {"controller_silent"},
               "valve driver: no command for 20 ms; bridge aborts")
    yield Case("virtual-rig SIGSTOP", lambda: rig.virtual_rig.send_signal(signal.SIGSTOP),
               lambda: rig.virtual_rig.send_signal(signal.SIGCONT), {"plc_silent", "sensors_lost"}, "controller: no SYNC; bridge aborts")
    yield Case("virtual-rig SIGKILL", lambda: (rig.virtual_rig.kill(), rig.virtual_rig.wait()), nothing, {"plc_silent", "sensors_lost"},
               "controller: no SYNC; bridge aborts")
    yield Case("bridge SIGSTOP", None, None, {"plc_silent", "plc_tripped"}, "controller: no maneuver command; PLC: watchdog")
    yield Case("bridge SIGKILL", None, None, {"-"}, "controller: no maneuver command; PLC: watchdog")
    yield Case("interface down", lambda: link("down"), lambda: link("up"), {"bus_lost"}, "valve driver: no command for 20 ms; bridge aborts")
    yield Case("Modbus server hangs", lambda: (rig.plc.fault("hang_s", 6.0)), nothing, {"plc_silent"},
               "bridge: emergency stop; PLC: watchdog")


def controller_says(rig):
    return (rig.folder / "controller.log").read_text()


def outcome(said):
    marks = [line.rsplit("aborted: ", 1)[1].split(";")[0].strip() for line in said.splitlines() if "aborted: " in line]
    return marks[-1] if marks else "finished" if "finished" in said else "-"


def restarted(rig):
    rig.plc.client.close()
    rig.start()
    if rig.virtual_rig.poll() is None:
        eventually(rig.plc.client.connect, "no Modbus connection")


def run(rig, bus, folder, phase, case, number):
    """The row of one case, or None when the maneuver was over before the cause came: a host that stood still."""
    if phase == "spin_up":  # a flywheel at rest: nothing else would stop it for minutes
        rig.virtual_rig.terminate()
        rig.virtual_rig.wait()
    rig.start()
    out = folder / f"run{number}"
    bus.phase = "idle"  # a bridge that was killed never said that it ended
    bridge = rig.bridge("maneuver", out)
    deadline = time.monotonic() + 300
    while not bus.await_phase((phase,), 0.2):
        check(time.monotonic() < deadline, f"no {phase}: {words(bridge)}")
        if bridge.poll() is not None:
            return None
    time.sleep(0.05)
    if phase == "braking":  # with the brake well on
        time.sleep(0.25)
        eventually(lambda: (bus.pressure_Pa > 3e6 and bus.valve_raw > 0) or bus.phase != phase, "no pressure")
    if bus.phase != phase:
        bridge.kill()
        bridge.wait()
        return None
    said = len(controller_says(rig))
    bus.safe_since = bus.released_since = began = time.monotonic()
    if case.act:
        case.act()
    else:
        bridge.send_signal(getattr(signal, case.cause.split()[1]))
    brake = "-"
    rig_is_there = not case.cause.startswith("virtual-rig")
    if rig_is_there and case.cause != "interface down":
        eventually(lambda: bus.pressure_Pa < 0.5e6, f"{case.cause}: the brake is not released: {bus.pressure_Pa}")
    if not case.cause.startswith("controller") and case.cause != "interface down":
        eventually(lambda: bus.valve_raw == 0, f"{case.cause}: last valve command is not the safe current")
    if phase == "braking" and case.cause != "interface down":
        brake = f"{1e3 * (max(bus.safe_since, began) - began if not case.cause.startswith('controller') else bus.released_since - began):.0f}"
    safe = "-"
    if rig_is_there and case.cause not in ("interface down", "Modbus server hangs"):
        eventually(rig.plc.sledge_back, f"{case.cause}: the sledge does not go back")
        safe = f"{time.monotonic() - began:.1f}"
    # The cause stays until the bridge has seen it; where the bridge is the cause, or cannot be heard, for a while.
    if case.cause.startswith("bridge"):
        eventually(lambda: rig.plc.read("plc_state") == 1, f"{case.cause}: the PLC does not trip")
    elif case.cause == "interface down":
        eventually(lambda: "ABORT" in words(bridge), f"{case.cause}: no abort: {words(bridge)}")
    else:
        eventually(lambda: bus.phase in ("aborting", "aborted") or bridge.poll() is not None, f"{case.cause}: no abort: {words(bridge)}")
    if case.undo:
        case.undo()
    if case.cause == "bridge SIGSTOP":
        bridge.send_signal(signal.SIGCONT)
    bridge.wait(timeout=120)
    if case.cause == "interface down":
        eventually(lambda: bus.valve_raw == 0 and bus.pressure_Pa < 0.5e6, "the valve is not safe after the interface came back")
    if rig_is_there:
        eventually(rig.plc.sledge_back, f"{case.cause}: the sledge does not go back")
        if safe == "-":
            safe = f"{time.monotonic() - began:.1f}"
    name = outcome(words(bridge)) if case.cause != "bridge SIGKILL" else "-"
    if case.note.startswith("bridge: emergency stop"):  # [CTL-076]
        check("are not listed" not in controller_says(rig)[said:], f"{case.cause}: the controller changes again and again:\n{controller_says(rig)[said:]}")
    # Not by any of the causes. A bridge that was stopped may judge what its other thread heard before, if that has no turn first.
    if name == "bus_unread" or (case.cause == "bridge SIGSTOP" and name == "controller_silent"):
        print(f"{case.cause} in {phase}: this machine left the bridge without a turn; once more", flush=True)
        return restarted(rig)
    check(name in case.outcomes, f"{case.cause} in {phase}: {name}, expected {case.outcomes}\n{words(bridge)}")
    check(bridge.returncode == (-signal.SIGKILL if case.cause == "bridge SIGKILL" else 1), f"exit status {bridge.returncode}")
    restarted(rig)
    return [case.cause, phase, name, brake, safe, case.note]


def peers(folder, phase):
    """[BRG-450] Each interlock and each dead peer ends in its own name and in a safe rig."""
    scenario, config = quick_rig(folder, patient=False)
    rig = Rig(BUILD, folder, scenario, config)
    bus = Bus()
    rows = []
    for case in cases(rig):
        row, tries = None, 0
        while row is None:
            tries += 1
            check(tries <= 4, f"{case.cause} in {phase}: four maneuvers ended before it came")
            row = run(rig, bus, folder, phase, case, f"{len(rows)}.{tries}")
        rows.append(row)
        print("  ".join(row), flush=True)
    rig.end()
    return rows


def write(rows, phase):
    FOLDER.mkdir(exist_ok=True)
    with open(FOLDER / f"{phase}.csv", "w", newline="") as file:
        csv.writer(file).writerows(rows)
    FOLDER.with_suffix(".md").write_text(page())


def page():
    """From the rows of all phases that were kept."""
    text = """# Open interlocks and dead programs

What happens to a maneuver, in each of its phases, when an interlock opens, a program is stopped or killed, the CAN interface goes down, or the Modbus
server hangs. `tests/vcan/peers.py --write` made this page (ctest `vcan.peers_PHASE`, BRG-450). It runs controller, virtual rig and bridge as real
programs over vcan and Modbus TCP, and asserts the outcome, the safe valve current and the retracted sledge.

The times are wall-clock times of one run in paced lockstep on a busy machine, whose guest has one processor for all programs. They are not limits.
The limits, in rig time, are those of the controller ([faults](../user/faults.md)), of `config/bridge.toml` and of the watchdogs in
`config/registers.toml`.

- *valve*: time from the cause to the safe current; for a dead controller, to the brake without pressure. Without a figure the brake was not applied,
  or the interface was down.
- *sledge*: time from the cause until the sledge was retracted. Where the Modbus server hangs or the interface is down, it is read only after the
  maneuver has ended. A dead virtual rig cannot tell.

"""
    text += "| cause | phase | outcome | valve, ms | sledge, s | what makes the rig safe |\n|---|---|---|---|---|---|\n"
    for name in PHASES:
        path = FOLDER / f"{name}.csv"
        if path.exists():
            with open(path, newline="") as file:
                text += "".join("| " + " | ".join(row) + " |\n" for row in csv.reader(file))
    return text + """
A killed bridge reports no outcome. When `rig-bridge campaign` is started again, it finds the maneuver unfinished and repeats it
(`vcan.bridge_campaign_killed`). [Recovery](recovery.md) shows how a campaign with `--retry` continues after each of these causes.
"""


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        result = peers(pathlib.Path(name), sys.argv[2])
    if "--write" in sys.argv:
        write(result, sys.argv[2])
    print(f"{sys.argv[2]}: passed")
