#!/usr/bin/python3
"""Every verb of every program: help, what a misspelt verb, option or choice and a missing file get, and options that mean the same everywhere.

usage: command_lines.py PROGRAM...

[STUDY-650] [RT-080] [BRG-430]
"""
import pathlib
import re
import subprocess
import sys
import tempfile

TYPES = {"--config": "DIRECTORY", "--out": "DIRECTORY", "--controller": "FILE", "--json": "FILE", "--picture": "FILE", "--csv": "FILE", "--dbc": "FILE"}
# What the help says of an option wherever it stands.
MEANINGS = {"--config": "configuration files", "--json": "- for standard output instead of the table", "--picture": r"\(PNG\)",
            "--out": r"=out/|\(default: out/|REQUIRED"}
CLOCKS = {"sensors", "timer", "sync", "auto"}
# Nothing is written there, or nothing without it.
OUT_WITHOUT_DEFAULT = {"virtual-rig", "rig-bridge preflight"}
# Verbs that print no figures, or CSV alone.
WITHOUT_JSON = {"rig-bridge maneuver", "rig-bridge campaign", "rig-bridge pause", "rig-bridge resume", "rig-bridge ledger amend", "rig-bridge ledger note",
                "virtual-rig serve", "rig-lab drive", "rig-lab panel", "cortex-m-prepare"}
COMPLETION = pathlib.Path(__file__).resolve().parents[2] / "firmware/host/package/completion.bash"
wrong = []
runs = 0


def expect(good, what):
    if not good:
        wrong.append(what)


def run(words):
    global runs
    runs += 1
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=60)


def misspelt(word):
    """Two neighbours of it swapped."""
    i = next(i for i in range(len(word) - 2, 2, -1) if word[i] != word[i + 1])
    return word[:i] + word[i + 1] + word[i] + word[i + 2:]


def refused(words, texts):
    done = run(words)
    shown = " ".join([pathlib.Path(words[0]).name, *words[1:]])
    expect(done.returncode == 2, f"{shown}: status {done.returncode}")
    for text in texts:
        expect(text in done.stderr, f"{shown}: '{text}' is not in: {done.stderr}")
    expect(done.stdout == "", f"{shown}: standard output has: {done.stdout}")


def completed(words):
    """What completion offers for the next word."""
    script = 'source "$0"; COMP_WORDS=("$@" ""); COMP_CWORD=$#; _antiskid "$1"; printf "%s\\n" "${COMPREPLY[@]}"'
    return run(["bash", "-c", script, str(COMPLETION), *words]).stdout.split()


def look(words):
    name = " ".join([pathlib.Path(words[0]).name, *words[1:]])
    shown = run([*words, "--help"])
    expect(shown.returncode == 0, f"{name} --help: status {shown.returncode}")
    text = shown.stdout
    strange = re.findall(r".*[^\n -~].*", text)
    expect(not strange, f"{name} --help has control bytes: {strange[:3]}")
    head, _, subcommands = text.partition("\nSubcommands:\n")
    verbs = re.findall(r"^  ([a-z]+) ", subcommands.split("\n\n")[0], re.M)
    options = dict(re.findall(r"^  (?:-\w,)?(--[a-z][a-zA-Z-]*)((?: [^ ].*)?)$", head, re.M))
    for option, kind in TYPES.items():
        if option in options:
            expect(options[option].startswith(f" {kind}"), f"{name}: {option} takes{options[option]}, expected {kind}")
    said = dict(re.findall(r"^  (?:-\w,)?(--[a-z][a-zA-Z-]*)(.*(?:\n {10,}.*)*)", head, re.M))
    for option, meaning in MEANINGS.items():
        if option in said and not (option == "--out" and name in OUT_WITHOUT_DEFAULT):
            expect(re.search(meaning, said[option]), f"{name} {option} means something else: {said[option]}")
    if "--clock" in options:
        choices = set(re.search(r"\{(.+?)\}", options["--clock"]).group(1).split(","))
        expect(choices <= CLOCKS and {"timer", "sync"} <= choices, f"{name}: --clock takes {sorted(choices)}")
    refused([*words, misspelt("--version") if "--version" in options else "--hlep"], ["; did you mean '--"])
    for option, kind in options.items():
        if len(option) > 6:
            refused([*words, misspelt(option)], [f"there is no option '{misspelt(option)}'"])
        if choices := re.match(r" \{(.+?)\}", kind):
            refused([*words, option, "nonsense"], [option, "'nonsense'", choices.group(1)])
            expect(completed([*words, option]) == choices.group(1).split(","), f"{name} {option}: completion offers {completed([*words, option])}")
        elif re.match(r" (FILE|DIRECTORY|PATH)\b", kind) and option != "--out":
            refused([*words, option, "nowhere/missing"], [option, "nowhere/missing"])
    positional = re.search(r"^Positionals:\n  (\w+) (FILE|DIRECTORY|PATH)", head, re.M)
    if positional:
        refused([*words, "nowhere/missing"], [positional.group(1), "nowhere/missing"])
    if verbs and name != "virtual-rig":
        expect(completed(words) == verbs, f"{name}: completion offers {completed(words)}")
    for verb in verbs:
        refused([*words, misspelt(verb)] if len(verb) > 4 else [*words, "no-such-verb"],
                [f"there is no '{misspelt(verb)}'; did you mean '{verb}'?"] if len(verb) > 4 else ["no-such-verb"])
        look([*words, verb])
    if (not verbs or name == "virtual-rig") and name not in WITHOUT_JSON:
        expect("--json" in options, f"{name} has no --json")


with tempfile.TemporaryDirectory() as folder:
    for program in sys.argv[1:]:
        look([str(pathlib.Path(program).resolve())])
    expect(not list(pathlib.Path(folder).iterdir()), f"left behind: {[p.name for p in pathlib.Path(folder).iterdir()]}")
print("\n".join(wrong) or f"{runs} command lines as they should be")
sys.exit(bool(wrong))
