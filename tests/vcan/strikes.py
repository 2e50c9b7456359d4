"""A campaign by three programs and what may befall it, with a service manager that starts again what has died, and a person who does what only a
person may do. Used by unattended.py and recovery_table.py."""
import pathlib
import re
import signal
import socket
import struct
import subprocess
import threading
import time

from three_programs import PHASES, STATE, Bus, check, eventually, ledger_copy, words

SENSORS = (0x110, 0x111, 0x112)  # wheel, flywheel, pressure
UNKNOWN = ("energy_unbalanced", "ends_in_")  # warnings
ALONE, PERSON, ENDS = "recovers alone", "waits for a person", "ends"


def replay_sensors(_, frames=300):
    """What the sensors have just sent, once more."""
    with socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW) as ear:
        ear.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, b"".join(struct.pack("=II", each, 0x7FF) for each in SENSORS))
        ear.bind(("vcan0",))
        ear.settimeout(5.0)
        heard = [ear.recv(16) for _ in range(frames)]
        time.sleep(0.3)
        for frame in heard:
            ear.send(frame)
            time.sleep(0.0005)


class NumberedBus(Bus):
    """The maneuver's number, too."""

    def __init__(self):
        self.number, self.number_phase = 0, None
        super().__init__()
        threading.Thread(target=self.listen_to_numbers, daemon=True).start()

    def listen_to_numbers(self):
        ear = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        ear.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, struct.pack("=II", STATE, 0x7FF))
        ear.bind(("vcan0",))
        while True:
            try:
                data = ear.recv(16)[8:]
            except OSError:  # the interface is down
                time.sleep(0.01)
                continue
            with self.changed:
                self.number, self.number_phase = struct.unpack_from("<H", data, 2)[0], PHASES[data[1] >> 4]
                self.changed.notify_all()

    def at(self, number, phase):
        return self.number == number and self.number_phase == phase


class Bench:
    def __init__(self, rig, out, *more):
        self.rig, self.out, self.more = rig, out, more
        self.bus = NumberedBus()
        self.run, self.statuses = None, []
        self.lives = []  # of the virtual rig: (rows of the ledger when it ended, whether it told its energy)
        self.bridge()

    def bridge(self):
        if self.run is not None:
            self.statuses.append(self.run.wait(timeout=60))
        self.run = self.rig.bridge("campaign", self.out, *self.more)

    def rows(self):
        return ledger_copy(self.out) if (self.out / "campaign.sqlite").exists() else []

    def rig_ended(self, told):
        self.lives.append((len(self.rows()), told))
        self.rig.plc.client.close()

    def kill_rig(self):
        self.rig.virtual_rig.kill()
        self.rig.virtual_rig.wait()
        self.rig_ended(told=False)

    def end_rig(self):
        self.rig.virtual_rig.terminate()
        self.rig.virtual_rig.wait(timeout=60)
        self.rig_ended(told=True)

    def tool(self, verb):
        subprocess.run([self.rig.build / "bin/rig-bridge", verb, self.out], check=True, stdout=subprocess.DEVNULL)

    def renew_rig(self, seconds=120.0):
        """Between two maneuvers, so that what the plant's brake took until now is told before the rig is killed. False: the bridge ended."""
        held = words(self.run).count("held by ")
        self.tool("pause")
        eventually(lambda: words(self.run).count("held by ") > held or self.run.poll() is not None, "the campaign does not hold", seconds)
        if self.run.poll() is None:
            self.end_rig()
            self.rig.start()
        self.tool("resume")
        return self.run.poll() is None

    def ended(self):
        return self.run.poll() is not None

    def told_J(self):
        """By each virtual rig that could say it, in order."""
        return [1e6 * float(mj) for mj in re.findall(r"([0-9.]+) MJ taken by the brake", (self.rig.folder / "virtual-rig.log").read_text())]

    def until(self, condition, seconds=120.0):
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline:
            with self.bus.changed:
                if self.bus.changed.wait_for(condition, 0.2):
                    return True
            if self.ended():
                return False
        return False


def kill_bridge(bench):
    bench.run.kill()
    bench.run.wait()


def kill_controller(bench):
    bench.rig.controller.kill()
    bench.rig.controller.wait()
    bench.until(lambda: bench.bus.phase in ("aborting", "aborted"), 30.0)
    bench.rig.start()


def kill_rig(bench):
    bench.kill_rig()
    bench.rig.start()


def kill_all(bench):
    """What a power cut does to programs; what it does to files is power_cut.py's."""
    bench.run.kill()
    bench.rig.controller.kill()
    bench.kill_rig()
    bench.run.wait()
    bench.rig.controller.wait()
    bench.rig.start()


def stop(which, seconds):
    def act(bench):
        process = which(bench)
        process.send_signal(signal.SIGSTOP)
        time.sleep(seconds)
        process.send_signal(signal.SIGCONT)
    return act


def interlock(name):
    def act(bench):
        bench.rig.plc.fault("open_interlocks", bench.rig.plc.interlock(name))
        bench.until(lambda: bench.bus.phase in ("aborting", "aborted"), 30.0)
        bench.rig.plc.fault("open_interlocks", 0)
    return act


def silent_plc(bench):
    bench.rig.plc.fault("hang_s", 6.0)
    time.sleep(6.0)


def clock(step_s):
    def act(_):
        time.clock_settime(time.CLOCK_REALTIME, time.clock_gettime(time.CLOCK_REALTIME) + step_s)
    return act


def cut_bus(bench):
    subprocess.run(["ip", "link", "set", "vcan0", "down"], check=True)
    time.sleep(1.0)
    subprocess.run(["ip", "link", "set", "vcan0", "up"], check=True)


def interrupt(bench):
    bench.run.send_signal(signal.SIGINT)
    bench.run.wait(timeout=60)


class Strike:
    def __init__(self, name, act, expected, kills_rig=False):
        self.name, self.act, self.expected, self.kills_rig = name, act, expected, kills_rig


STRIKES = (
    Strike("bridge killed", kill_bridge, ENDS),
    Strike("bridge stopped for 3 s", stop(lambda bench: bench.run, 3.0), ALONE),
    Strike("controller killed", kill_controller, ALONE),
    Strike("controller stopped for 5 s", stop(lambda bench: bench.rig.controller, 5.0), ALONE),
    Strike("emergency stop", interlock("emergency_stop_clear"), PERSON),
    Strike("silent PLC for 6 s", silent_plc, ALONE),
    Strike("clock forward by an hour", clock(3600.0), ALONE),
    Strike("clock back by an hour", clock(-3600.0), ALONE),
    Strike("sensor frames replayed", replay_sensors, ALONE),
    Strike("bus cut for 1 s", cut_bus, ALONE),
    Strike("rig killed", kill_rig, ALONE, kills_rig=True),
    Strike("all three killed", kill_all, ENDS, kills_rig=True),
)
MORE_STRIKES = (
    Strike("guard opened", interlock("guard_closed"), PERSON),
    Strike("hydraulics lost", interlock("hydraulics_ready"), ALONE),
    Strike("drive fault", interlock("drive_healthy"), ALONE),
    Strike("rig stopped for 5 s", stop(lambda bench: bench.rig.virtual_rig, 5.0), ALONE),
    Strike("Ctrl-C", interrupt, PERSON),
)


def judge_numbers(rows, planned):
    """Each maneuver finished once, and nothing is left."""
    finished = [row["number"] for row in rows if row["state"] == "finished"]
    check(sorted(finished) == list(range(1, planned + 1)), f"lost or doubled: {finished}")
    check(all(row["state"] in ("finished", "aborted", "unfinished") for row in rows), "an attempt was left")


def counted_J(rows):
    """What each attempt added to the cumulative energy."""
    added, before = [], 0.0
    for row in rows:
        now = row["cumulative_energy_J"] if row["cumulative_energy_J"] is not None else before
        added.append(now - before)
        before = now
    return added


def max_unknown_J(row, took_J):
    """That the brake may have taken besides, as the record itself says."""
    if most := re.search(r"up to ([-+.0-9e]+) MJ that are in no record", row["warnings"]):
        return 1e6 * float(most[1])
    return max(row["kinetic_energy_J"] - took_J, 0.0) if "energy_unbalanced" in row["warnings"] else 0.0


def energies(bench, rows):
    """(ledger, plant, unknown) of the attempts of all virtual rigs that told what their brakes took, and (ledger, number) of the others' attempts.
    Unknown: the most that attempts took of which the record itself says that their energy is not known, so that a person has to amend it."""
    counted, told, begin = counted_J(rows), iter(bench.told_J()), 0
    ledger_J = plant_J = unknown_J = 0.0
    untold = []
    for end, says in bench.lives:
        if says:
            ledger_J += sum(counted[begin:end])
            plant_J += next(told)
            unknown_J += sum(max_unknown_J(row, took_J) for row, took_J in zip(rows[begin:end], counted[begin:end]))
        else:
            untold.extend(zip(counted[begin:end], (row["number"] for row in rows[begin:end])))
        begin = end
    return ledger_J, plant_J, unknown_J, untold


def replayed_right(bench, config):
    done = subprocess.run([bench.rig.build / "bin/rig-replay", "campaign", bench.out, "--config", config], capture_output=True,
                          text=True, check=False)
    check(done.returncode == 0, f"rig-replay campaign: {done.returncode}\n{done.stdout[-3000:]}{done.stderr}")


def sound_ratio(rig, folder, maneuvers):
    """Ledger over plant of undisturbed maneuvers: load cells come late through the PLC, which costs short stops some percent. A new rig then."""
    out = pathlib.Path(folder) / "sound"
    bench = Bench(rig, out, "--maneuvers", str(maneuvers))
    check(bench.run.wait(timeout=300 + 60 * maneuvers) == 0, f"an undisturbed campaign does not finish: {words(bench.run)}")
    bench.end_rig()
    rows = bench.rows()
    ratio = counted_J(rows), bench.told_J()
    (rig.folder / "virtual-rig.log").unlink()
    rig.start()
    return sum(ratio[0]) / sum(ratio[1]), sum(ratio[0]) / maneuvers
