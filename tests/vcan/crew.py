#!/usr/bin/python3
"""What a crew does with a campaign that runs: looks on from another terminal, holds it between maneuvers, is told of an abort, says whose parts
they are. Three programs in paced lockstep, inside `./rig vcan`.

usage: crew.py BUILD_DIR operator|watch|panel
"""
import csv
import json
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time
import urllib.error
import urllib.request

from three_programs import Bus, check, eventually, in_guest_memory, ledger_copy, patient_rig, quick_rig, words

BUILD = pathlib.Path(sys.argv[1]).resolve()
BRIDGE = BUILD / "bin/rig-bridge"
REPLAY = BUILD / "bin/rig-replay"
OPERATOR, NOTES = 'Zoë "Z" Rossi', "new, from batch 4; =1+1"


def tool(*arguments, status=0):
    done = subprocess.run([str(each) for each in arguments], capture_output=True, text=True, check=False)
    check(done.returncode == status, f"{arguments[1:3]}: exit status {done.returncode}, expected {status}\n{done.stdout}{done.stderr}")
    return done.stdout + done.stderr


def watched(out, config, *more, status=0):
    return tool(BRIDGE, "watch", out, "--can", "vcan0", "--config", config, "--once", *more, status=status)


def seen(out, config, status=0):
    return json.loads(watched(out, config, "--json", "-", status=status))


def patiently(look):
    """What a look at the bus says once it is as it should be: where time is stretched, one may be too short to hear everybody."""
    said, wrong = [], []

    def right():
        try:
            said.append(look())
        except SystemExit as problem:
            wrong.append(problem)
        return said

    try:
        eventually(right, "")
    except SystemExit:
        raise wrong[-1] from None
    return said[-1]


def state(out):
    return json.loads(tool(BRIDGE, "status", out, "--json", "-"))[0]


def drive_enable(rig):
    return rig.plc.client.read_holding_registers(rig.plc.map["holding"]["drive_enable"]["address"], count=1, slave=rig.plc.map["unit_id"]).registers[0]


def the_rig(folder):
    scenario, config = quick_rig(folder)
    return patient_rig(BUILD, folder, scenario, config)


def aborted_once(rig, bus, run):
    """Opens an interlock in the next braking."""
    check(bus.await_phase(("braking",), 120), f"no braking: {words(run)}")
    rig.plc.fault("open_interlocks", rig.plc.interlock("drive_healthy"))
    check(bus.await_phase(("aborting", "aborted")), f"no abort: {words(run)}")
    rig.plc.fault("open_interlocks", 0)


def operator(folder):
    """[BRG-270] [BRG-471] Held between maneuvers, over the death of the bridge, with the drive off; told of an abort; serial
    numbers in every record, and of another disc only when somebody says that he means it."""
    rig, bus, out = the_rig(folder), Bus(), folder / "campaign"
    hook, told = folder / "hook.sh", folder / "told"
    hook.write_text(f'#!/bin/sh\nenv | grep "^RIG_" > {told}\n')
    hook.chmod(0o755)
    more = ("--maneuvers", "3", "--retry", "2", "--on-abort", hook, "--operator", OPERATOR, "--notes", NOTES)
    tool(BRIDGE, "pause", out, status=2)
    run = rig.bridge("campaign", out, "--disc", "D7", *more)
    check(bus.await_phase(("braking",), 120), f"no braking: {words(run)}")
    tool(BRIDGE, "pause", out, "--who", "A. Rossi", "--why", "tyre change")
    rig.await_words(run, "held by A. Rossi since ")
    for _ in range(10):
        check(drive_enable(rig) == 0 and [row["state"] for row in ledger_copy(out)] == ["finished"], "it goes on though it is held")
        time.sleep(0.1)
    check("A. Rossi" in patiently(lambda: seen(out, rig.config))["hold"] and state(out)["hold"]["why"] == "tyre change", "the hold is not shown")
    run.kill()
    run.wait()
    run = rig.bridge("campaign", out, *more)
    rig.await_words(run, "held by A. Rossi since ")
    time.sleep(0.5)
    check(len(ledger_copy(out)) == 1, "a campaign that was started again forgot that it is held")
    tool(BRIDGE, "resume", out)
    aborted_once(rig, bus, run)
    code = run.wait(timeout=300)
    check(code == 0 and "goes on after the hold" in words(run), f"{code} {words(run)}")
    news = dict(line.split("=", 1) for line in told.read_text().splitlines())
    check(news["RIG_CAUSE"] == "drive_fault" and news["RIG_MANEUVER"] == "2" and news["RIG_CAMPAIGN"] == "quick" and
          "clear the fault there" in news["RIG_NEXT_STEP"] and "retry 1 of 2" in news["RIG_OUTCOME"] and
          pathlib.Path(news["RIG_FOLDER"]) == (out / "quick/0002").resolve(), news)

    more = ("--maneuvers", "4", "--operator", OPERATOR)
    refused = rig.bridge("campaign", out, "--disc", "D8", *more)
    check(refused.wait(timeout=60) == 2 and "disc was D7, is D8" in words(refused), words(refused))
    run = rig.bridge("campaign", out, "--disc", "D8", "--go-on-changed", *more)
    check(run.wait(timeout=300) == 0, words(run))
    rig.end()
    tool(BRIDGE, "ledger", "note", out, "--maneuver", "4", "--tyre", "T9", "--notes", "tread cut", "--lining-worn", "0.31",
         "--who", "A. Rossi")
    rows = state(out)["maneuvers"]
    check([row["disc_serial"] for row in rows] == ["D7", "D7", "D7", "D7", "D8"], rows)
    check(all(row["operator"] == OPERATOR for row in rows), rows)
    check(rows[-1]["tyre_serial"] == "T9" and rows[-1]["notes"] == f"{NOTES}; tread cut" and rows[-1]["noted"][0]["who"] == "A. Rossi", rows[-1])
    summary = json.loads((out / "quick/0004/summary.json").read_text())
    check(summary["disc_serial"] == "D8" and summary["tyre_serial"] == "" and summary["notes"] == NOTES, summary)
    tool(REPLAY, "campaign", out, "--config", rig.config, "--csv", folder / "table.csv", "--rebuild", out / "rebuilt.sqlite")
    with open(folder / "table.csv", newline="", encoding="utf-8") as file:
        table = list(csv.DictReader(file))
    check([row["disc_serial"] for row in table] == ["D7"] * 4 + ["D8"] and table[-1]["notes"] == f"{NOTES}; tread cut", table)
    check([row["lining_worn"] for row in table] == [""] * 4 + ["0.31"] and {row["tread_worn"] for row in table} == {""}, table)
    d8_J = float(table[-1]["cumulative_energy_J"]) - float(table[-2]["cumulative_energy_J"])
    check(abs(float(table[-1]["disc_energy_J"]) - d8_J) < 1.0 and table[-2]["disc_energy_J"] == table[-2]["cumulative_energy_J"], table)


def watch(folder):
    """[BRG-420] From another terminal: what runs, in the middle of it; 80 columns; and that the bridge has died."""
    rig, bus, out = the_rig(folder), Bus(), folder / "campaign"
    run = rig.bridge("campaign", out, "--maneuvers", "50")  # more than it gets through while it is looked at, however slow the machine
    check(bus.await_phase(("braking",), 120), f"no braking: {words(run)}")

    def at_work():
        now = seen(out, rig.config)
        check(now["bridge"] == "at work" and now["number"] >= 1 and now["planned"] == 50 and now["phase"] and now["controller"] != "silent" and
              now["bus_up"], now)

    patiently(at_work)
    rig.await_words(run, "maneuver 1 finished")
    log = folder / "watch.log"
    with open(log, "w", encoding="utf-8") as file:
        watch_run = subprocess.Popen([BRIDGE, "watch", out, "--can", "vcan0", "--config", rig.config, "--json", "-"], stdout=file, stderr=subprocess.STDOUT)
    eventually(lambda: '"bridge":"at work"' in log.read_text(), "watch does not say that the bridge is at work")

    def screen():
        text = watched(out, rig.config)
        check(all(len(line) <= 80 for line in text.splitlines()) and re.search(r"^last: .*finished", text, re.MULTILINE) and "road: " in text, text)
        return text

    print(patiently(screen))
    check(bus.await_phase(("braking",), 120), f"no second braking: {words(run)}")
    run.kill()
    run.wait()
    rows = ledger_copy(out)
    last = len(rows)
    check([row["state"] for row in rows[:-1]] == ["finished"] * (last - 1) and rows[-1]["state"] != "finished", rows)
    eventually(lambda: f"DEAD: maneuver {last} was left" in log.read_text(), f"watch does not say that the bridge died: {log.read_text()}")
    dead = seen(out, rig.config, status=1)
    check(f"maneuver {last} was left" in dead["bridge"] and dead["outcomes"][-1] == f"{last - 1:04} finished", dead)
    check(watch_run.poll() is None, "watch ended with the bridge")
    run = rig.bridge("campaign", out, "--maneuvers", str(last))
    lines = len(log.read_text().splitlines())
    check(run.wait(timeout=300) == 0, words(run))
    eventually(lambda: "nobody runs this campaign" in log.read_text().splitlines()[-1], "watch does not see the end")
    later = [json.loads(line) for line in log.read_text().splitlines()[lines:]]
    check(any(line["bridge"] == "at work" and line["number"] == last for line in later), later)
    check(max(line["rim_mps"] or 0.0 for line in later) > 10.0 and max(line["current_mA"] or 0.0 for line in later) > 0.0, later)
    watch_run.terminate()
    check(watch_run.wait(timeout=10) == 0, "watch does not end when it is asked to")
    rig.end()
    # Nobody else is on the bus any more: what is heard now would be its own.
    before = {file: file.read_bytes() for file in out.glob("campaign.sqlite*")}
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as ear:
        ear.bind(("vcan0",))
        ear.settimeout(0.5)
        seen(out, rig.config, status=1)
        try:
            check(False, f"watch sends {ear.recv(16)}")
        except TimeoutError:
            pass
    check({file: file.read_bytes() for file in out.glob("campaign.sqlite*")} == before, "watch writes to the ledger")


def panel(folder):
    """[BRG-520] [BRG-522] The page's own way in: twenty look on, one of them reads nothing; a campaign that waits is started, held, let go on and aborted with the token that the
    bridge printed, without which all of it is refused; the campaign goes on by the same command."""
    rig, bus, out = the_rig(folder), Bus(), folder / "campaign"
    run = rig.bridge("campaign", out, "--maneuvers", "3", "--held", "--panel", "127.0.0.1:0")
    port, token = re.search(r"127.0.0.1:(\d+)/#token=(\w+)", rig.await_words(run, "#token=")).groups()
    viewers = [socket.create_connection(("127.0.0.1", int(port)), timeout=60) for _ in range(20)]
    for viewer in viewers:
        viewer.sendall(f"GET /events HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())

    def ask(name, key="0" * 32):
        request = urllib.request.Request(f"http://127.0.0.1:{port}/api/{name}", b"why=tyre+change", {"X-Panel-Token": key})
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return answer.status, json.load(answer)
        except urllib.error.HTTPError as refused:
            return refused.code, json.load(refused)

    def read(name):
        with urllib.request.urlopen(f"http://127.0.0.1:{port}/api/{name}", timeout=60) as answer:
            return json.load(answer)

    def heard(viewer, wanted):
        text, end = b"", time.monotonic() + 60
        while wanted not in text and time.monotonic() < end:
            text += viewer.recv(65536)
        check(wanted in text, f"a viewer never had {wanted}: {text[-500:]}")

    rig.await_words(run, "waits to be started")
    heard(viewers[0], b'"campaign":"waits"')
    check(ask("resume")[0] == 401, "started without the token")
    for _ in range(10):
        check(drive_enable(rig) == 0 and not ledger_copy(out), "it begins though it is held")
        time.sleep(0.1)
    check(ask("resume", token)[0] == 200, "not started")
    check(bus.await_phase(("braking",), 120), f"no braking: {words(run)}")
    heard(viewers[0], b'"campaign":"runs"')
    for viewer in viewers[:19]:
        heard(viewer, b'"phase":"braking, ')
    check([ask(name)[0] for name in ("hold", "resume", "abort")] == [401] * 3, "changed without the token")
    status, answer = ask("hold", token)
    check(status == 200 and "tyre change" in answer["said"], answer)
    rig.await_words(run, "held by panel since ")
    heard(viewers[0], b'"campaign":"held"')
    heard(viewers[0], b'"note":"held by panel')
    check([row["state"] for row in ledger_copy(out)] == ["finished"], "it goes on though it is held")
    check([one["state"] for one in read("runs")["runs"]] == ["finished"], "the finished maneuver is not among the recorded ones")
    recorded = read("run?campaign=quick&number=1&attempt=1")
    check(len(recorded["columns"]["t"]) > 100 and recorded["asked"]["law on the bus"] == "wheel_slip", recorded["asked"])
    check(ask("resume", token)[0] == 200, "not let go on")
    check(bus.await_phase(("braking",), 120), f"no second braking: {words(run)}")
    check([one["state"] for one in read("runs")["runs"]] == ["finished", "running"], "the ledger is not read while a maneuver runs")
    check(ask("abort", token)[0] == 200, "not aborted")
    status, answer = ask("abort", token)
    check(status == 400 and "ends already" in answer["error"], answer)
    check(run.wait(timeout=120) == 130, words(run))
    check(bus.valve_raw == 0, "the valve is not at its safe current")
    check([row["state"] for row in ledger_copy(out)] == ["finished", "aborted"], ledger_copy(out))
    check("held" in words(run) and "ABORT" in words(run), words(run))
    run = rig.bridge("campaign", out, "--maneuvers", "3")
    check(run.wait(timeout=300) == 0, words(run))
    rig.end()


if __name__ == "__main__":
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        {"operator": operator, "watch": watch, "panel": panel}[sys.argv[2]](pathlib.Path(name))
    print(f"{sys.argv[2]}: passed")
