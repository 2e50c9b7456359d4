#!/usr/bin/python3
"""[BRG-616] A campaign over the real bus that something befalls in every tenth maneuver, and that ends by itself with a right ledger: each maneuver
finished once, every figure made again from the logs, the energy that of the plant's brake within 1 % (2 % of few maneuvers) of an undisturbed campaign's, but for attempts
of which the ledger says that their energy is not known. A service manager starts again what was killed, and a person who comes to an emergency stop
gives the command again. Inside `./rig vcan`; `./rig check soak --unattended`.

usage: unattended.py BUILD_DIR [--out DIR] [--maneuvers N] [--every K] [--seed S] [--part I --parts N]
Of N parts each has other strikes. Leaves result.json, strikes.csv and the campaign in DIR, which must not be there yet; without it, nothing.
"""
import argparse
import json
import pathlib
import random
import sys
import tempfile

from strikes import STRIKES, Bench, energies, judge_numbers, replayed_right, sound_ratio
from three_programs import check, in_guest_memory, patient_rig, quick_rig, words, write_table

PHASES = ("spin_up", "settling", "braking", "retract")
SOUND = 5            # undisturbed maneuvers to compare with
ENERGY_SHARE = 0.01
# Load cells come late through the PLC: on a busy host the energy of one short stop scatters by more than 1 %, that of six against five
# undisturbed ones by 0.7 %. An attempt that is lost or counts twice is 8 % of six.
FEW, ENERGY_SHARE_OF_FEW = 100, 0.02
RETRIES = 5          # a busy host aborts some by itself


def schedule(options):
    """Every strike as often as every other, in drawn order; phases drawn, braking half of the time."""
    draw = random.Random(options.seed)
    numbers = range(options.every, options.maneuvers + 1, options.every)
    bag = []
    while len(bag) < len(numbers):
        some = list(STRIKES[options.part::options.parts])
        draw.shuffle(some)
        bag += some
    return [(number, strike, draw.choice(PHASES + ("braking", "braking"))) for number, strike in zip(numbers, bag)]


class Campaign:
    def __init__(self, rig, options):
        self.options, self.struck = options, []
        self.bench = Bench(rig, options.out / "campaign", "--maneuvers", str(options.maneuvers), "--retry", str(RETRIES))

    def go_on(self):
        """As service manager and person: the same command again. True: the campaign is over."""
        if not self.bench.ended():
            return False
        if self.bench.run.returncode == 0:
            return True
        check(len(self.bench.statuses) < 2 * len(STRIKES) + self.options.maneuvers, "the campaign does not get on")
        self.bench.bridge()
        return False

    def reach(self, number, phase):
        """The number in whose phase it is; the next one where a busy host was past it. None: the campaign ended before."""
        bench = self.bench
        while True:
            bench.until(lambda: bench.bus.at(number, phase) or bench.bus.number > number)
            if bench.bus.at(number, phase):
                return number
            if self.go_on():
                return None
            if bench.bus.number > number:
                number = bench.bus.number + 1

    def strike(self, number, strike, phase):
        bench = self.bench
        if strike.kills_rig:
            if bench.bus.number < number - 1 and self.reach(number - 1, "braking") is None:
                return
            while not bench.renew_rig():
                if self.go_on():
                    return
            number = 1 + sum(row["state"] == "finished" for row in bench.rows())
        number = self.reach(number, phase)
        if number is None:
            return
        rows = len(bench.rows())
        strike.act(bench)
        self.struck.append([number, strike.name, phase, rows])
        print(f"{number}: {strike.name} in {phase}", flush=True)

    def run(self):
        for number, strike, phase in schedule(self.options):
            self.strike(number, strike, phase)
        while not self.go_on():
            self.bench.until(lambda: False, 5.0)
        print(words(self.bench.run)[-600:])


def unattended(options):
    scenario, config = quick_rig(options.out)
    rig = patient_rig(options.build, options.out, scenario, config)
    ratio, sound_J = sound_ratio(rig, options.out, SOUND)
    campaign = Campaign(rig, options)
    campaign.run()
    bench = campaign.bench
    bench.end_rig()
    rig.end()
    rows = bench.rows()
    judge_numbers(rows, options.maneuvers)
    ledger_J, plant_J, unknown_J, untold = energies(bench, rows)
    off = ledger_J / plant_J / ratio - 1.0
    result = {"maneuvers": options.maneuvers, "seed": options.seed, "struck": len(campaign.struck), "attempts": len(rows),
              "aborted": sorted(row["outcome"] for row in rows if row["state"] == "aborted"),
              "unfinished": sum(row["state"] == "unfinished" for row in rows), "bridge_starts": len(bench.statuses) + 1,
              "bridge_statuses": bench.statuses, "warnings": [row["warnings"] for row in rows if row["warnings"]],
              "ledger_MJ": ledger_J * 1e-6, "plant_MJ": plant_J * 1e-6, "undisturbed_ledger_over_plant": ratio, "energy_off": off,
              "at_most_unknown_MJ": unknown_J * 1e-6,
              "attempts_of_killed_rigs": len(untold), "max_of_them_over_undisturbed": max((each / sound_J for each, _ in untold), default=0.0)}
    write_table(options.out / "strikes.csv", ("maneuver", "strike", "phase", "rows_before"), campaign.struck)
    (options.out / "result.json").write_text(json.dumps(result, indent=2) + "\n")
    print(json.dumps(result, indent=2))
    check(len(campaign.struck) >= options.maneuvers // options.every - 1, "too few strikes met their phase")
    share = ENERGY_SHARE if options.maneuvers >= FEW else ENERGY_SHARE_OF_FEW
    check(-share - unknown_J / plant_J <= off <= share, f"energy off by {100 * off:.2f} %, of which {unknown_J * 1e-6:.3f} MJ are named")
    check(all(each <= 1.02 * sound_J for each, _ in untold), f"a killed rig's attempt counts too much: {untold}")
    replayed_right(bench, config)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--out", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--maneuvers", type=int, default=200)
    parser.add_argument("--every", type=int, default=10)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--part", type=int, default=0)
    parser.add_argument("--parts", type=int, default=1)
    options = parser.parse_args()
    if options.out:
        options.out.mkdir(parents=True)
        unattended(options)
    else:
        with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
            options.out = pathlib.Path(name)
            unattended(options)
    print("unattended: passed")


if __name__ == "__main__":
    sys.exit(main())
