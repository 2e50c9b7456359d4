#!/usr/bin/python3
"""Mutation tests of firmware/control and firmware/can: does some unit test notice when the code is wrong?

Every comparison, arithmetic and boolean operator, constant, condition, assignment and return of both rooms is made wrong, one at a
time, and the unit tests that reach it are run, the quickest first. A mutant that no test notices is a survivor. All mutants are compiled
in at once (sites.py); the tests are those that judge coverage, too.

  ./rig check mutate                              all of them; goes on where an earlier run on the same files was stopped
  ./rig check mutate --file slip_law              those of files whose path contains this
  ./rig check mutate --sample 80 --seed 3         a drawn sample
  ./rig check mutate --mutant 'firmware/can/e2e.cpp:40:29:== becomes !='
                                            one again, with what the tests say to it
  ./rig check mutate --again                      after a test was added: only those that survived
  ./rig check mutate --listed                     only those of both lists: are they still right?
  ./rig check mutate --list                       the mutants, without a run

tests/mutation/equivalent.txt lists mutants that nobody could notice, each with the reason, open.txt survivors that wait for a test.
Leaves out/mutation/mutants.json, table.txt and survivors.txt (lines for those lists).
Exit status 0 if every mutant is noticed or listed; 1 if one is not, a line of a list names no mutant, or an equivalent one
is noticed; 2 for a wrong command line.
"""
import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import threading
import time

sys.dont_write_bytecode = True  # beside the sources

import build

ROOT = build.ROOT
HERE = ROOT / "tests/mutation"
OUT = ROOT / "out/mutation"
QUICK_S = 0.6
LEAST_CPU_S = 5
PATIENCE = 10  # processor time that a mutant may take, in that of the true program
LEAST_WALL_S = 600  # a machine may be busy with other things


def fail(message, status=1):
    print(f"mutate: {message}", file=sys.stderr)
    sys.exit(status)


def run(program, cases, mutant, cpu_s, met=None, output=subprocess.DEVNULL):
    """Exit status and processor time; a mutant has `cpu_s`, and a wall time that only one that sleeps can need."""
    environment = dict(os.environ, MUTANT=str(mutant))
    if met:
        environment["MUTANTS_MET"] = str(met)
    command = ["prlimit", f"--cpu={cpu_s}:{cpu_s + 1}", f"--as={4 << 30}", str(program), "--durations", "yes"]
    command += (["--abort"] if mutant else []) + (["-f", str(cases)] if cases else [])
    process = subprocess.Popen(command, cwd=ROOT, env=environment, stdout=output, stderr=subprocess.STDOUT)
    alarm = threading.Timer(LEAST_WALL_S + PATIENCE * cpu_s, process.kill)
    alarm.start()
    _, status, used = os.wait4(process.pid, 0)
    alarm.cancel()
    process.returncode = os.waitstatus_to_exitcode(status)
    return process.returncode, used.ru_utime


class Step:
    """Some test cases of one program: what is run at a time."""

    def __init__(self, program, cases, seconds, met):
        self.program, self.cases, self.seconds, self.met = program, cases, seconds, met


def steps_of(program):
    """The program in pieces: its quick cases, then each slow one by itself; with what each piece reaches."""
    output = build.WORK / f"{program.name}.out"
    with output.open("w") as file:
        status, _ = run(program, None, 0, 600, output=file)
    if status != 0:
        fail(f"{program.name} fails without any mutant:\n{output.read_text()[-2000:]}")
    spent = {}
    for seconds, name in re.findall(r"^\s*([\d.]+) s: (.+)$", output.read_text(), re.M):
        spent[name] = spent.get(name, 0.0) + float(seconds)
    # Sections are timed under their own names; a case is known by its name in the list of cases.
    names = subprocess.run([str(program), "--list-test-names-only"], cwd=ROOT, capture_output=True, text=True, check=False).stdout.splitlines()
    names = [n.strip() for n in names if n.strip()]
    quick = [n for n in names if spent.get(n, 0.0) <= 0.2]
    groups = ([quick] if quick else []) + [[n] for n in names if spent.get(n, 0.0) > 0.2]
    steps = []
    for i, group in enumerate(groups):
        cases = build.WORK / f"{program.name}.{i}.txt"
        cases.write_text("".join(n.replace("\\", "\\\\").replace(",", "\\,").replace("[", "\\[") + "\n" for n in group))
        met = build.WORK / f"{program.name}.{i}.met"
        met.unlink(missing_ok=True)
        status, seconds = run(program, cases, 0, 600, met)
        if status != 0:
            fail(f"{program.name}: its cases do not run apart: {group}")
        steps.append(Step(program, cases, seconds, met.read_bytes()))
    return steps


def verdict(mutant, steps, output=subprocess.DEVNULL):
    """Name of the test program that noticed, "" when none did."""
    for step in steps:
        if step.met[mutant.number]:
            status, _ = run(step.program, step.cases, mutant.number, LEAST_CPU_S + int(PATIENCE * step.seconds), output=output)
            if status != 0:
                return step.program.name
    return ""


def read_list(name, mutants):
    """Mutant's key -> reason; and what is wrong with the list."""
    listed, wrong, keys = {}, [], {m.key() for m in mutants}
    for number, line in enumerate((HERE / name).read_text().splitlines(), 1):
        if not line.strip() or line.startswith("#"):
            continue
        key, _, reason = line.rpartition(" | ")
        if len(key.split(" | ")) < 3 or not reason.strip():
            wrong.append(f"tests/mutation/{name}:{number}: expected FILE | LINE | CHANGE | REASON")
        elif key not in keys:
            wrong.append(f"tests/mutation/{name}:{number}: there is no such mutant; take the line out or copy it anew from survivors.txt")
        elif key in listed:
            wrong.append(f"tests/mutation/{name}:{number}: is there twice")
        listed[key] = reason.strip()
    return listed, wrong


class Journal:
    """What was found on these files, one line each, so that a run that was stopped goes on."""

    def __init__(self, sources, again):
        self.files = hashlib.sha256(b"".join(p.read_bytes() for p in sources)).hexdigest()[:16]
        self.path = build.WORK / "verdicts.jsonl"
        lines = [json.loads(x) for x in self.path.read_text().splitlines()] if self.path.exists() else []
        # A test that was added takes nothing back that others notice.
        self.found = {x["mutant"]: x["by"] for x in lines if x["files"] == self.files or (again and x["by"])}

    def add(self, mutant, by):
        """`by`: the program that noticed, "" for nobody, None for none of the quick tests."""
        self.found[mutant.key()] = by
        with self.path.open("a") as file:
            file.write(json.dumps({"files": self.files, "mutant": mutant.key(), "by": by}) + "\n")


def bar(name, done, total, survived, began):
    left = (time.monotonic() - began) / done * (total - done) if done else 0
    filled = 30 * done // total
    print(f"\r{name} [{'#' * filled}{'.' * (30 - filled)}] {done}/{total} mutants, {survived} survived, {left / 60:.0f} min left ", end="",
          file=sys.stderr, flush=True)


def round_of(name, todo, steps, jobs, done_with):
    """Runs `steps` on each mutant; calls done_with(mutant, noticed by) as each is done."""
    began, survived, shows = time.monotonic(), 0, sys.stderr.isatty()
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        waiting = {pool.submit(verdict, m, steps): m for m in todo}
        for done, future in enumerate(concurrent.futures.as_completed(waiting), 1):
            by = future.result()
            survived += not by
            done_with(waiting[future], by)
            if shows or done % 200 == 0 or done == len(todo):
                bar(name, done, len(todo), survived, began)
                if not shows or done == len(todo):
                    print(file=sys.stderr)


# [DOOR-040]
def judge(chosen, steps, journal, jobs):
    """The quick steps on every mutant, then the slow ones on those that are left."""
    quick, slow = ([s for s in steps if (s.seconds <= QUICK_S) == q] for q in (True, False))
    round_of("quick tests", [m for m in chosen if m.key() not in journal.found], quick, jobs, lambda m, by: journal.add(m, by or None))
    round_of("slow tests", [m for m in chosen if journal.found[m.key()] is None], slow, jobs, journal.add)


def table(rows):
    """rows: file -> [mutants, noticed, equivalent, open, survived]"""
    lines = [f"{'file':42} {'mutants':>8} {'noticed':>8} {'equivalent':>10} {'open':>5} {'survived':>8}"]
    total = [sum(column) for column in zip(*rows.values())]
    for name, row in [*sorted(rows.items()), ("together", total)]:
        lines.append(f"{name:42} {row[0]:8} {row[1]:8} {row[2]:10} {row[3]:5} {row[4]:8}")
    return "\n".join(lines) + "\n"


def options_of(arguments):
    parser = argparse.ArgumentParser(prog="./rig check mutate", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sample", type=int, metavar="N", help="this many, drawn at random")
    parser.add_argument("--seed", type=int, default=1, help="of the draw (default 1)")
    parser.add_argument("--file", default="", metavar="PART", help="only files whose path contains this")
    parser.add_argument("--listed", action="store_true", help="only those of equivalent.txt and open.txt")
    parser.add_argument("--mutant", metavar="ID", help="only this one, with the output of the tests")
    parser.add_argument("--known", action="store_true", help="also those of known.txt, which have to be noticed, or to survive if they are equivalent")
    parser.add_argument("--again", action="store_true", help="leave out what was noticed before, even if tests have changed since")
    parser.add_argument("--fresh", action="store_true", help="forget earlier runs")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), metavar="N", help="at a time (default: one a core)")
    parser.add_argument("--list", action="store_true", help="only list the mutants")
    options = parser.parse_args(arguments)
    if options.jobs < 1 or (options.sample is not None and options.sample < 1):
        fail("--jobs and --sample take a number above 0; see ./rig check mutate --help", 2)
    return options


def main():
    options = options_of(sys.argv[1:])
    mutants, sources = build.rewrite()
    if options.list:
        for m in mutants:
            print(f"{m.identity()}    {m.source}")
        return 0
    equivalent, wrong = read_list("equivalent.txt", mutants)
    waiting, wrong_too = read_list("open.txt", mutants)
    known, wrong_known = read_list("known.txt", mutants)
    wrong += wrong_too + wrong_known + [f"both equivalent and open: {key}" for key in equivalent.keys() & waiting.keys()]
    chosen = [m for m in mutants if options.file in m.file and (not options.mutant or m.identity() == options.mutant)
              and (not options.listed or m.key() in waiting or m.key() in equivalent)]
    if not chosen:
        fail(f"there is no mutant {options.mutant}" if options.mutant else f"no file of {' or '.join(build.ROOMS)} has '{options.file}' in its path", 2)

    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        steps = sorted((s for group in pool.map(steps_of, build.programs(options.jobs)) for s in group), key=lambda s: s.seconds)
    reached = {m.number for m in mutants if any(s.met[m.number] for s in steps)}
    at_compile_time = [m for m in chosen if m.number not in reached]
    chosen = [m for m in chosen if m.number in reached]
    if options.mutant:
        by = verdict(chosen[0], steps, None) if chosen else "the compiler alone computes it: nobody"
        print(f"{options.mutant}: {by or 'nobody'} notices")
        return 0 if by else 1
    if options.sample:
        # Drawn one by one: another line of code somewhere changes the sample by as much as it adds.
        chosen = sorted(chosen, key=lambda m: hashlib.sha256(f"{options.seed} {m.key()}".encode()).digest())[:options.sample]
    if options.known:
        chosen += [m for m in mutants if m.key() in known and m not in chosen]

    journal = Journal([*sources, *build.test_sources()], options.again)
    if options.fresh:
        journal.found.clear()
    judge(chosen, steps, journal, options.jobs)

    rows, survivors = {}, []
    for m in chosen:
        row, by = rows.setdefault(m.file, [0] * 5), journal.found[m.key()]
        place = 1 if by else 2 if m.key() in equivalent else 3 if m.key() in waiting else 4
        row[0] += 1
        row[place] += 1
        if by and m.key() in equivalent:
            wrong.append(f"{by} notices what is listed as equivalent: {m.key()}")
        if by and m.key() in waiting:
            print(f"{by} notices what open.txt has; its line can go: {m.key()}")
        if m.key() in known and not by and m.key() not in equivalent:
            wrong.append(f"nobody notices what known.txt has: {m.key()}")
        if place == 4:
            survivors.append(m)
            print(f"survived: {m.identity()}    {m.source}")
    OUT.mkdir(parents=True, exist_ok=True)
    (OUT / "survivors.txt").write_text("".join(f"{m.key()} | \n" for m in survivors))
    (OUT / "table.txt").write_text(table(rows))
    (OUT / "mutants.json").write_text(json.dumps(
        [{"id": m.identity(), "line": m.source, "noticed_by": journal.found[m.key()], "equivalent": equivalent.get(m.key()),
          "open": waiting.get(m.key())} for m in chosen], indent=1) + "\n")
    print(table(rows), end="")
    print(f"{len(at_compile_time)} more are computed by the compiler and cannot be switched at run time")
    for problem in wrong:
        print(f"mutate: {problem}")
    return 1 if survivors or wrong else 0


if __name__ == "__main__":
    sys.exit(main())
