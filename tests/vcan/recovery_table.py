#!/usr/bin/python3
"""[BRG-616] After a disturbance in each phase of a shipped scenario: does the campaign recover alone, wait for a person, or end? Each case is one
maneuver of a campaign over vcan and Modbus. Nothing is lost or counted twice; an energy that differs by more than 1 % from that of an undisturbed
campaign is named. Inside `./rig vcan`; `./rig check soak --recovery` starts it.

usage: recovery_table.py BUILD_DIR [--phase P]... [--strike NAME]... [--scenario FILE] [--out CSV] [--docs]
--docs writes docs/generated/recovery.md from the CSV. Cases that are in the CSV already are not run again.
"""
import argparse
import csv
import pathlib
import sys
import tempfile

from strikes import ALONE, ENDS, MORE_STRIKES, PERSON, STRIKES, UNKNOWN, Bench, counted_J, energies, judge_numbers, replayed_right
from three_programs import PATIENT, Rig, check, configuration, in_guest_memory, words, write_table

PHASES = ("spin_up", "settling", "braking", "retract")
COLUMNS = ("what", "phase", "then", "attempts", "outcomes", "ledger_MJ", "plant_MJ", "energy_off", "warnings")
ENERGY_SHARE = 0.01


def became(status):
    """What the bridge that ran then did about it."""
    if status < 0:
        return ENDS
    return ALONE if status == 0 else PERSON


def case(options, strike, phase, ratio):
    """The row; none where a busy host was past the phase before it came."""
    with tempfile.TemporaryDirectory(**in_guest_memory()) as name:
        folder = pathlib.Path(name)
        config = configuration(folder, PATIENT)
        rig = Rig(options.build, folder, options.scenario, config)
        bench = Bench(rig, folder / "campaign", "--maneuvers", "1", "--retry", "2")
        met = strike is None or bench.until(lambda: bench.bus.at(1, phase), 300.0)
        if met and strike is not None:
            strike.act(bench)
        status = bench.run.wait(timeout=600)
        then = became(status)
        while met and bench.run.returncode != 0:
            check(len(bench.statuses) < 4, f"it does not go on: {words(bench.run)}")
            bench.bridge()
            bench.run.wait(timeout=600)
        bench.end_rig()
        rig.end()
        rows = bench.rows()
        if not met:
            return None
        judge_numbers(rows, 1)
        replayed_right(bench, config)
        ledger_J, plant_J, _, _ = energies(bench, rows)
        if strike is None:
            print(f"undisturbed: ledger over plant {ledger_J / plant_J:.4f}", flush=True)
            return ledger_J / plant_J
        energy_off = ledger_J / plant_J / ratio - 1.0
        outcomes = " ".join(row["outcome"] or row["state"] for row in rows)
        row = [strike.name, phase, then, len(rows), outcomes, f"{ledger_J * 1e-6:.4f}", f"{plant_J * 1e-6:.3f}", f"{energy_off:.4f}",
               "; ".join(one["warnings"] for one in rows if one["warnings"])]
        print("  ".join(str(each) for each in row), flush=True)
        if then != strike.expected:
            print(f"expected: {strike.expected}\n{words(bench.run)[-3000:]}", flush=True)
        # What a killed rig's brake took it cannot tell: only the next one's is compared, and the attempt's is no more than a stop's.
        check(not strike.kills_rig or sum(counted_J(rows)) < 2.02 * ledger_J, f"a killed rig's attempt counts too much: {counted_J(rows)}")
        return row


def off(row):
    return abs(float(row[COLUMNS.index("energy_off")]))


def named(row):
    """Too little, and the ledger says that it may be."""
    return float(row[COLUMNS.index("energy_off")]) < 0.0 and any(each in row[COLUMNS.index("warnings")] for each in UNKNOWN)


def docs(rows):
    by = {(row[0], row[1]): row for row in rows}
    alone = [float(row[7]) for row in rows if row[3] == "1"]
    names = [strike.name for strike in STRIKES + MORE_STRIKES]
    within = sum(off(row) <= ENERGY_SHARE for row in rows)
    text = f"""# Recovery

How a campaign with `--retry` continues after a disturbance in each phase of a maneuver. This page was made by `./rig check soak --recovery`
(`tests/vcan/recovery_table.py`). It runs controller, virtual rig and bridge as real programs over vcan and Modbus TCP, in paced lockstep, with a
shipped scenario. A dead controller or rig is started again, as a service manager would do.

- *{ALONE}*: the same bridge finishes the maneuver; it retries an aborted attempt.
- *{PERSON}*: the bridge ends with a named cause and exit status 1. When a person gives the same command again, it finishes the maneuver.
- *{ENDS}*: the bridge is killed. When it is started again with the same command, it finishes the maneuver.

{len(rows)} of {len(names) * len(PHASES)} cases were run. In each of them the maneuver finished once, and every figure computed again from its logs
was the same bit for bit. Energies are compared by the ratio of the ledger's energy to that of the plant's brake: in {within} cases it was within 1 %
of the ratio of an undisturbed campaign; the other cells give the difference. A killed rig cannot report its energy, so only the energy after it is
compared. [recovery.csv](recovery.csv) has the figures. Cases in that file are not run again, so not all are of the newest build. On a busy machine an
attempt is sometimes aborted without a disturbance; the cell gives that cause as well.

Torque and load reach the record through PLC and bridge. If they are missing during braking (silent PLC, stopped bridge, cut bus), the brake's energy
is computed from the speeds, and the warning `energy_by_speeds` gives its amount ([recording](../user/recording.md)).

After the bridge has died, the brake's energy is what flywheel and wheel lose until the next bridge starts, if that starts at once and the rig coasts.
The warning `ends_in_braking` or `ends_in_settling` gives this energy, and the largest amount that may be missing besides until a person amends the
ledger. The other differences are scatter: a reading of a load cell is as old as a Modbus request takes, which is a noticeable share of a short stop
and varies on a busy machine. Cases with a single attempt differ by {min(alone, default=0.0) * 100:+.1f} to {max(alone, default=0.0) * 100:+.1f} %.

The timeouts of `config/bridge.toml` are ten times the shipped ones here, because the machine is slow.

| what | {" | ".join(PHASES)} |
|---|{"---|" * len(PHASES)}
"""
    for name in names:
        cells = [cell(by.get((name, phase))) for phase in PHASES]
        text += f"| {name} | {' | '.join(cells)} |\n"
    pathlib.Path("docs/generated/recovery.md").write_text(text)


def cell(row):
    if row is None:
        return "not run"
    named = " ".join(dict.fromkeys(each.split(":")[0] for each in row[8].split("; "))) if row[8] else "unnamed"
    return f"{row[2]}: {row[4]}" + (f"; energy {100 * float(row[7]):+.1f} %, {named}" if off(row) > ENERGY_SHARE else "")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--phase", action="append", choices=PHASES)
    parser.add_argument("--strike", action="append")
    parser.add_argument("--scenario", type=pathlib.Path, default=pathlib.Path("config/scenarios/rejected_takeoff.toml"))
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("docs/generated/recovery.csv"))
    parser.add_argument("--docs", action="store_true")
    options = parser.parse_args()
    rows = []
    if options.out.exists():
        with open(options.out, newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))[1:]
    there = {(row[0], row[1]) for row in rows}
    todo = [(strike, phase) for phase in options.phase or PHASES for strike in STRIKES + MORE_STRIKES
            if (options.strike is None or strike.name in options.strike) and (strike.name, phase) not in there]
    ratio = case(options, None, None, None) if todo else None  # load cells come late through the PLC
    for strike, phase in todo:
        row = None
        for _ in range(3):
            row = row or case(options, strike, phase, ratio)
        check(row, f"{strike.name}: {phase} was not met three times")
        rows.append(row)
        write_table(options.out, COLUMNS, rows)
    if options.docs:
        docs(rows)
    expected = {strike.name: strike.expected for strike in STRIKES + MORE_STRIKES}
    others = [f"{row[0]} in {row[1]} {row[2]}" for row in rows if row[2] != expected[row[0]]]
    check(not others, "not as expected: " + "; ".join(others))
    wrong = [f"{row[0]} in {row[1]}: {100 * float(row[7]):+.2f} %" for row in rows if off(row) > ENERGY_SHARE and not named(row)]
    check(not wrong, "energy is off: " + "; ".join(wrong))
    print(f"{len(rows)} cases passed")


if __name__ == "__main__":
    sys.exit(main())
