#!/usr/bin/python3
"""Three programs on one rig: antiskid-controller, virtual-rig serve and rig-bridge, over real CAN and real Modbus TCP, in paced lockstep
(--clock sync), so that a slow host stretches time. Runs inside `./rig vcan`.

usage: bridge.py BUILD_DIR TEST
"""
import json
import pathlib
import random
import re
import signal
import subprocess
import sys
import tempfile
import time

from three_programs import PATIENT, Bus, Rig, check, configuration, eventually, in_guest_memory, ledger_copy, patient_rig, quick_rig, words

BUILD = pathlib.Path(sys.argv[1]).resolve()
LAB = BUILD / "bin/rig-lab"


def finished(process, seconds=300):
    status = process.wait(timeout=seconds)
    check(status == 0, f"rig-bridge: {status}\n{words(process)}")


def landing(folder):
    """[BRG-440] A landing by three programs ends, and its figures are those of the same maneuver in process."""
    scenario = pathlib.Path("config/scenarios/light.toml")
    rig = patient_rig(BUILD, folder, scenario, configuration(folder, PATIENT))
    bus = Bus()
    run = rig.bridge("maneuver", folder / "one")
    finished(run)
    rig.end()
    print(words(run))
    summary = json.loads((folder / "one/summary.json").read_text())
    check(summary["outcome"] == "finished" and summary["standstill"], summary)
    check(summary["frames_dropped"] == 0 and summary["faults"] == [], summary)
    lab = folder / "lab.json"
    subprocess.run([LAB, "stop", "--maneuver", "light", "--carrier", "flywheel", "--json", lab], check=True, stdout=subprocess.DEVNULL)
    other = json.loads(lab.read_text())
    ours = summary
    # The stop in process begins with a brake-on at the printed speed; ours comes within the sequencer's tolerance below it, a hundredth later.
    for name, a, b, share in (("stop distance", ours["length_m"], other["stop_distance_m"], 0.02),
                              ("brake energy", ours["energy_brake_J"], other["energy_brake_J"], 0.02),
                              ("tyre energy", ours["energy_tyre_J"], other["energy_tyre_J"], 0.05),
                              ("J_mu", ours["j_mu"], other["j_mu"], 0.02)):
        print(f"{name}: {a:.5g} by three programs, {b:.5g} in process")
        check(abs(a - b) <= share * abs(b), f"{name}: {a} by three programs, {b} in process")
    lines = (folder / "one/bus.log").read_text().splitlines()
    check(len(lines) == summary["frames"], "summary and bus.log disagree about the frames")
    commands = [line.split("#")[1] for line in lines if " 100#" in line]
    check(commands[-1][4:8] == "0000", "last valve command is not the safe current")
    rows = (folder / "one/modbus.csv").read_text().splitlines()
    check(rows[0].startswith("time_s,") and len(rows) > 100, "modbus.csv")
    check({"spin_up", "touchdown", "settling", "braking", "standstill", "retract"} <= set(bus.since), f"phases on the bus: {bus.since}")


def done(rows):
    return [row for row in rows if row["state"] == "finished"]


def campaign_killed(folder):
    """[BRG-410] SIGKILL at 50 random moments: the ledger is never corrupt, no finished maneuver lost or counted twice, unfinished ones marked,
    the rig left safe; the same command goes on."""
    draw = random.Random(20261121)
    scenario, config = quick_rig(folder)
    rig = patient_rig(BUILD, folder, scenario, config)
    bus = Bus()
    out = folder / "campaign"
    kills, planned, before = 0, 2, []
    while kills < 50:
        run = rig.bridge("campaign", out, "--maneuvers", str(planned))
        # Half of them in quick succession, before a maneuver moves; the others all along one.
        delay = draw.uniform(0.0, 0.5) if draw.random() < 0.55 else draw.uniform(0.3, 7.0)
        try:
            check(run.wait(timeout=delay) == 0, f"rig-bridge ended by itself: {words(run)}")
            planned += 1
            continue
        except subprocess.TimeoutExpired:
            pass
        run.kill()
        run.wait()
        kills += 1
        if not (out / "campaign.sqlite").exists():
            check(not before, "the ledger is gone")
            continue
        rows = ledger_copy(out)
        check(done(rows)[:len(before)] == before, "a finished maneuver was lost or changed")
        numbers = [row["number"] for row in done(rows)]
        check(numbers == list(range(1, len(numbers) + 1)), f"finished: {numbers}")
        check(sum(row["state"] == "running" for row in rows) <= 1, "two maneuvers run")
        before = done(rows)
        if kills % 10 == 0:
            # Where programs start slowly, none of them may have come as far as the PLC.
            eventually(lambda: (rig.plc.read("plc_state") == 1 or not rig.plc.bridge_seen()) and rig.plc.sledge_back(), "the PLC has not made the rig safe")
            eventually(lambda: bus.valve_raw == 0 and bus.pressure_Pa < 0.5e6, "the brake is not released")
    planned = len(before) + 2
    finished(rig.bridge("campaign", out, "--maneuvers", str(planned)))
    rig.end()
    rows = ledger_copy(out)
    check(done(rows)[:len(before)] == before, "a finished maneuver was lost or changed at the end")
    check([row["number"] for row in done(rows)] == list(range(1, planned + 1)), "not every maneuver once")
    check({row["state"] for row in rows} <= {"finished", "unfinished", "aborted"}, "one still runs")
    unfinished = [row for row in rows if row["state"] == "unfinished"]
    check(unfinished, "50 kills left no maneuver unfinished: they hit nothing")
    energy = 0.0
    for row in done(rows):
        summary = json.loads((out / row["folder"] / "summary.json").read_text())
        check(summary["number"] == row["number"] and summary["outcome"] == "finished", summary)
        check(summary["length_m"] == row["length_m"], "ledger and summary.json differ")
        check(row["cumulative_energy_J"] >= energy + row["energy_brake_J"] * 0.999, "energy was lost")
        energy = row["cumulative_energy_J"]
    status = json.loads(subprocess.run([BUILD / "bin/rig-bridge", "status", out, "--json", "-"], check=True, capture_output=True).stdout)
    check(status[0]["finished"] == planned and status[0]["unfinished"] == len(unfinished), status[0])
    print(f"{kills} kills, {planned} maneuvers finished once each, {len(unfinished)} unfinished and marked, "
          f"{sum(row['state'] == 'aborted' for row in rows)} aborted")


def campaign_ends(folder):
    """[BRG-410] A campaign stops on a fault, on its wear limit and on a full disk, says why, and goes on by the same command."""
    scenario, config = quick_rig(folder)
    rig = Rig(BUILD, folder, scenario, config)
    bus = Bus()
    out = folder / "campaign"

    def stops(expected, *more, during=lambda: None, place=out):
        run = rig.bridge("campaign", place, "--maneuvers", "3", *more)
        during()
        status = run.wait(timeout=300)
        check(status == expected, f"exit status {status}\n{words(run)}")
        return words(run)

    # The PLC dies, then the controller.
    def kill(process):
        check(bus.await_phase(("braking",)), "no braking")
        process.kill()
        process.wait()

    said = stops(1, during=lambda: kill(rig.virtual_rig))
    check("maneuver 1 was aborted: plc_silent" in said or "maneuver 1 was aborted: sensors_lost" in said, said)
    rig.start()
    said = stops(1, during=lambda: kill(rig.controller))
    check("maneuver 1 was aborted: controller_silent" in said, said)
    # Ctrl-C: the safe end first.
    rig.start()
    run = rig.bridge("campaign", out, "--maneuvers", "3")
    check(bus.await_phase(("settling",)), "no settling")
    run.send_signal(signal.SIGINT)
    check(run.wait(timeout=300) == 130, f"Ctrl-C: {run.returncode} {words(run)}")
    check("maneuver 1 was aborted: requested" in words(run), words(run))
    check(bus.valve_raw == 0 and rig.plc.sledge_back(), "the safe end was not awaited")
    # A fault once, with a retry: goes on by itself. Then worn out.
    def drive_fault():
        check(bus.await_phase(("braking",)), "no braking")
        rig.plc.fault("open_interlocks", rig.plc.interlock("drive_healthy"))
        check(bus.await_phase(("aborting", "aborted")), "no abort")
        rig.plc.fault("open_interlocks", 0)

    said = stops(0, "--retry", "1", "--min-friction", "0.5", during=drive_fault)
    check("maneuver 1 was aborted: drive_fault; retry 1 of 1" in said, said)
    check(re.search(r"maneuver 1: mean friction 0\.\d+ is below the wear limit 0\.5", said), said)
    said = stops(0, "--min-friction", "0.5")
    check("below the wear limit" in said, "a worn brake was used again: " + said)
    # The disk fills up: what was being recorded does not count, and the ledger is whole.
    small = folder / "small"
    small.mkdir()
    subprocess.run(["mount", "-t", "tmpfs", "-o", "size=60m", "tmpfs", small], check=True)

    def fill():
        check(bus.await_phase(("settling",)), "no settling")
        subprocess.run(["dd", "if=/dev/zero", f"of={small / 'other'}", "bs=64k"], stderr=subprocess.DEVNULL, check=False)

    try:
        said = stops(1, during=fill, place=small)
        check("No space left on device" in said, said)
        (small / "other").unlink()
        rows = ledger_copy(small)
        check(not done(rows), "a maneuver without a whole record counts")
        stops(0, place=small)
        check(len(done(ledger_copy(small))) == 3, "the campaign did not go on")
    finally:
        subprocess.run(["umount", "-l", small], check=True)
    # Another scenario is another campaign, another seed is refused.
    run = rig.bridge("campaign", out, "--maneuvers", "3", "--seed", "9")
    check(run.wait(timeout=300) == 2 and "seed" in words(run), f"{run.returncode} {words(run)}")
    rig.end()
    rows = ledger_copy(out)
    check([row["outcome"] for row in rows if row["state"] == "aborted"][1:] == ["controller_silent", "requested", "drive_fault"], rows)


def realtime(folder):
    """[BRG-440] 1 kHz by the clock, three programs on one virtual processor. How punctual this machine is decides whether the maneuver
    finishes or is aborted; both must be told truly, the valve safe at the end."""
    scenario, config = quick_rig(folder)
    rig = Rig(BUILD, folder, scenario, config, clock="timer")
    bus = Bus()
    run = rig.bridge("maneuver", folder / "one", priority=50)
    status = run.wait(timeout=300)
    time.sleep(0.5)
    rig.end()
    print(words(run))
    print((folder / "controller.log").read_text()[-3000:])
    check((folder / "one/summary.json").exists(), "no summary")
    summary = json.loads((folder / "one/summary.json").read_text())
    check((summary["outcome"] == "finished") == (status == 0), f"exit status {status}, outcome {summary['outcome']}")
    if status != 0:
        check(status == 1 and f"aborted: {summary['outcome']}" in words(run), words(run))
        check(summary["outcome"] in ("controller_fault", "controller_silent", "sensors_lost", "plc_silent", "plc_tripped", "phase_timeout"), summary)
        lateness = {"overrun", "wheel_lost", "flywheel_lost", "pressure_lost", "maneuver_lost", "heartbeat_lost", "pressure_off_command",
                    "emergency_stop", "wheel_corrupt", "flywheel_corrupt", "pressure_corrupt", "maneuver_corrupt"}
        check(set(summary["faults"]) <= lateness, f"faults that lateness does not explain: {summary['faults']}")
    report = json.loads((folder / "controller.json").read_text())
    check(report["durations"]["latency"]["count"] > 1000, "no latency histogram")
    check(bus.valve_raw == 0, "last valve command is not the safe current")


TESTS = {f.__name__: f for f in (landing, campaign_killed, campaign_ends, realtime)}

if __name__ == "__main__":
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        TESTS[sys.argv[2]](pathlib.Path(name))
    print(f"{sys.argv[2]}: passed")
