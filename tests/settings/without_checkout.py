#!/usr/bin/python3
"""Where the working directory has no `config`, every verb looks in the installation's. [STUDY-185]

usage: without_checkout.py RIG_LAB INSTALLED_CONFIG
"""
import os
import re
import subprocess
import sys
import tempfile

LAB, INSTALLED = sys.argv[1:]


def check(what, good, detail=""):
    print(("ok      " if good else "FAILED  ") + what, detail if not good else "")
    if not good:
        sys.exit(1)


def verbs_of(text):
    return re.findall(r"^  ([a-z]+) ", text.partition("Subcommands:")[2], re.M)


with tempfile.TemporaryDirectory() as elsewhere:
    def help_of(*words):
        return subprocess.run([LAB, *words, "--help"], cwd=elsewhere, check=True, capture_output=True, encoding="utf-8").stdout

    verbs = [(verb,) for verb in verbs_of(help_of())]
    verbs = [full for verb in verbs for full in [verb, *((*verb, sub) for sub in verbs_of(help_of(*verb)))]]
    configured = 0
    for verb in verbs:
        # "=default" of CLI11 2.3, " [default]" of 2.4
        defaults = re.findall(r"^  --\S+ [A-Z]\S*?(?:=| \[)((?:/|config)[^\s\]]*)\]? *$", help_of(*verb), re.M)
        check(f"rig-lab {' '.join(verb)}: {defaults}", all(d == INSTALLED or d.startswith(INSTALLED + "/") for d in defaults))
        configured += bool(defaults)
    check(f"{configured} verbs read a configuration", configured >= 15)

    # Commands of a report are given no --config where that is their own default: they must look where it does.
    for words in (["surfaces"], ["report"]) if not os.path.isdir(INSTALLED) else ():
        child = subprocess.run([LAB, *words, "--out", "out"], cwd=elsewhere, capture_output=True, text=True)
        check(f"rig-lab {words[0]} reads {INSTALLED}", child.returncode == 2 and INSTALLED + "/" in child.stderr, child.stderr)
