#!/usr/bin/python3
"""[BRG-220] A power cut in the middle of a campaign: the guest that runs it, on a file system of its own, is killed whole; a second one mounts
what is left. Finished maneuvers are in a sound ledger, the running one's log is there but for its last two seconds, and the same command goes on.

usage: power_cut.py BUILD_DIR ext2|ext4 [--cuts N] [--seed S]         on the machine itself: it starts the guests
"""
import argparse
import json
import os
import pathlib
import random
import re
import select
import signal
import sqlite3
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve()
ROOT = HERE.parents[2]
MOUNT = pathlib.Path("/run/cut")
RUNS = MOUNT / "two/levels/brake7"  # directories that the bridge makes
LOST_S = 2.0
SAID_EVERY_S = 0.05


def mount(kind):
    MOUNT.mkdir(parents=True, exist_ok=True)
    subprocess.run(["mount", "-t", kind, "/dev/ubda", MOUNT], check=True)


def rig_of(build, folder):
    from three_programs import patient_rig, quick_rig
    scenario, config = quick_rig(folder)
    return patient_rig(build, folder, scenario, config)


def inside_until_cut(build, kind):
    """Says what happens until it is killed; each line is a promise that what it tells is on the disk."""
    from three_programs import Bus, in_guest_memory
    mount(kind)
    with tempfile.TemporaryDirectory(**in_guest_memory()) as folder:
        rig = rig_of(build, pathlib.Path(folder))
        bus = Bus()
        run = rig.bridge("campaign", RUNS, "--maneuvers", "50")
        said = 0
        while run.poll() is None:
            words = run.log.read_text()
            for number in re.findall(r"maneuver (\d+) finished", words)[said:]:
                said += 1
                print("finished", number, flush=True)
            print("now", time.time(), bus.phase, flush=True)
            time.sleep(SAID_EVERY_S)
        raise SystemExit(f"rig-bridge ended by itself: {run.log.read_text()}")


def inside_after(build, kind):
    """What is left, as one JSON object; and whether the campaign goes on."""
    from three_programs import in_guest_memory
    if kind == "ext2":  # as a machine that comes up does; ext4 has its journal
        status = subprocess.run(["e2fsck", "-fy", "/dev/ubda"], stdout=subprocess.DEVNULL, check=False).returncode
        if status & ~3:
            raise SystemExit(f"e2fsck could not mend the file system: {status}")
    mount(kind)
    left = {"ledger": (RUNS / "campaign.sqlite").exists(), "logs": {}}
    if left["ledger"]:
        database = sqlite3.connect(RUNS / "campaign.sqlite")
        left["integrity"] = database.execute("PRAGMA integrity_check").fetchone()[0]
        left["rows"] = database.execute("SELECT number, state, folder FROM maneuvers ORDER BY id").fetchall()
        database.close()
        for _, _, folder in left["rows"]:
            log = RUNS / folder / "bus.log"
            text = log.read_bytes() if log.exists() else b""
            whole = text[:text.rfind(b"\n") + 1].splitlines()
            left["logs"][folder] = {"there": log.exists(), "lines": len(whole), "torn": len(text) - sum(len(line) + 1 for line in whole),
                                    "last": float(whole[-1].split(b")")[0][1:]) if whole else 0.0,
                                    "summary": (RUNS / folder / "summary.json").exists()}
    planned = sum(state == "finished" for _, state, _ in left.get("rows", [])) + 1
    with tempfile.TemporaryDirectory(**in_guest_memory()) as folder:
        rig = rig_of(build, pathlib.Path(folder))
        run = rig.bridge("campaign", RUNS, "--maneuvers", str(planned))
        left["resumed"] = run.wait(timeout=200)
        left["words"] = run.log.read_text()
        rig.end()
    left["status"] = json.loads(subprocess.run([build / "bin/rig-bridge", "status", RUNS, "--json", "-"], check=True,
                                               capture_output=True).stdout)
    subprocess.run(["umount", MOUNT], check=True)
    print("LEFT", json.dumps(left), flush=True)


def guest(image, build, what, kind):
    return [ROOT / "rig", "vcan", "--timeout", "280", "--disk", image, "--", "/usr/bin/python3", HERE, build, kind, "--inside", what]


def cut(image, build, kind, delay_s):
    """Runs the campaign and kills the guest `delay_s` after the second maneuver's brake-on; what it had said by then."""
    said = {"finished": [], "now": 0.0, "phase": ""}
    process = subprocess.Popen(guest(image, build, "until_cut", kind), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, bufsize=1)
    deadline = time.monotonic() + 200
    brake_on = None
    trouble = []
    while time.monotonic() < deadline:
        if brake_on is not None and time.monotonic() >= brake_on + delay_s:
            break
        if not select.select([process.stdout], [], [], 0.02)[0]:
            continue
        words = process.stdout.readline().split()
        if not words:
            raise SystemExit(f"FAILED: the guest ended by itself: {trouble}")
        if words[0] == "finished":
            said["finished"].append(int(words[1]))
        elif words[0] == "now":
            said["now"], said["phase"] = float(words[1]), words[2]
            if brake_on is None and said["finished"] and words[2] == "braking":
                brake_on = time.monotonic()
        else:
            trouble.append(" ".join(words))
    # The guard of `rig vcan` kills the guest's process group when its starter dies.
    process.send_signal(signal.SIGKILL)
    for line in process.stdout:
        words = line.split()
        if words and words[0] == "now":
            said["now"] = float(words[1])
    process.wait()
    if brake_on is None:
        raise SystemExit(f"FAILED: no braking after a finished maneuver: {said} {trouble}")
    return said


def judge(said, left):
    def check(truth, what):
        if not truth:
            raise SystemExit(f"FAILED: {what}\nsaid before the cut: {said}\nleft: {json.dumps(left, indent=1)}")

    check(left["ledger"], "the ledger is gone")
    check(left["integrity"] == "ok", "the ledger is corrupt")
    finished = [number for number, state, _ in left["rows"] if state == "finished"]
    check(finished[:len(said["finished"])] == said["finished"], "a finished maneuver was lost")
    running = [folder for _, state, folder in left["rows"] if state == "running"]
    check(len(running) == 1, "the maneuver that ran is not in the ledger")
    log = left["logs"][running[0]]
    lost_s = said["now"] - log["last"]
    check(log["there"] and log["lines"] > 1000, "the running maneuver's log is gone")
    check(lost_s < LOST_S, f"the log lacks its last {lost_s:.2f} s")
    for _, state, folder in left["rows"]:
        check(state != "finished" or (left["logs"][folder]["summary"] and left["logs"][folder]["torn"] == 0), f"{folder} is not whole")
    check(left["resumed"] == 0, "the same command does not go on")
    rows = left["status"][0]["maneuvers"]
    unfinished = [row for row in rows if row["state"] == "unfinished"]
    check(len(unfinished) == 1 and left["status"][0]["finished"] == len(finished) + 1, "not settled")
    check(unfinished[0]["energy_brake_J"] > 1e3 and not any("unbalanced" in one for one in unfinished[0]["warnings"]),
          "what was braked before the cut does not count")
    check((log["torn"] > 0) == any("unfinished_line" in one for one in unfinished[0]["warnings"]), "a torn last line is not named")
    sums = sum(row["energy_brake_J"] for row in rows)
    check(abs(left["status"][0]["cumulative_energy_J"] - sums) < 1e-6 * sums, "energy was lost or counted twice")
    return lost_s, log["torn"], unfinished[0]["energy_brake_J"]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=pathlib.Path)
    parser.add_argument("kind", choices=("ext2", "ext4"))
    parser.add_argument("--inside", choices=("until_cut", "after"))
    parser.add_argument("--cuts", type=int, default=1)
    parser.add_argument("--seed", type=int, default=263)
    o = parser.parse_args()
    build = o.build.resolve()
    if o.inside == "until_cut":
        return inside_until_cut(build, o.kind)
    if o.inside == "after":
        return inside_after(build, o.kind)
    draw = random.Random(o.seed)
    for number in range(o.cuts):
        with tempfile.TemporaryDirectory() as folder:
            image = os.path.join(folder, "disk")
            with open(image, "wb") as out:
                out.truncate(64 << 20)
            subprocess.run(["/sbin/mke2fs", "-q", "-t", o.kind, "-F", image], check=True)
            said = cut(image, build, o.kind, draw.uniform(0.2, 1.5))
            after = subprocess.run(guest(image, build, "after", o.kind), capture_output=True, text=True, check=False)
            lines = [line for line in after.stdout.splitlines() if line.startswith("LEFT ")]
            if not lines:
                raise SystemExit(f"FAILED: nothing to be read after the cut: {after.returncode}\n{after.stdout}{after.stderr}")
            lost_s, torn, energy_J = judge(said, json.loads(lines[0][5:]))
            check = subprocess.run(["/sbin/e2fsck", "-fn", image], capture_output=True, text=True, check=False)
            if check.returncode != 0:
                raise SystemExit(f"FAILED: e2fsck: {check.returncode}\n{check.stdout}")
            print(f"{o.kind}, cut {number + 1}: {len(said['finished'])} finished maneuvers there, the running one's log lacks {lost_s:.2f} s, "
                  f"{torn} bytes of a torn line, {energy_J * 1e-3:.1f} kJ of it counted; goes on")
    return 0


if __name__ == "__main__":
    sys.exit(main())
