#!/usr/bin/python3
"""How long a newcomer waits, from what `./rig check debian --first-use` kept of each command: a table on standard output, the same as JSON.

usage: first_use.py OUTPUT... --release N --json FILE      exit status 1 if a command failed
"""
import argparse
import os
import pathlib
import platform
import re
import sys

from figures import write


def reading(path):
    text = path.read_text(errors="replace")
    took, status = map(int, re.search(r"^took (\d+) s, exit status (\d+)$", text, re.M).groups())
    installed = re.search(r"^setup: (.*); fetched in (\d+) s, installed in (\d+) s$", text, re.M)
    fetched = int(installed[2]) if installed else 0
    return {"command": f"./rig {path.suffixes[-2][1:]}", "exit_status": status, "seconds_without_download": took - fetched,
            "download_s": fetched, "install_s": int(installed[3]) if installed else 0, "packages": installed[1] if installed else "none"}


def processor():
    return re.search(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)[1]


def main():
    options = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    options.add_argument("outputs", nargs="+", type=pathlib.Path)
    options.add_argument("--release", required=True)
    options.add_argument("--json", required=True, type=pathlib.Path)
    given = options.parse_args()
    machine = {"processor": processor(), "cores": len(os.sched_getaffinity(0)), "kernel": platform.release(),
               "load_average": os.getloadavg()}
    rows = [reading(path) for path in given.outputs]
    write(given.json, {"release": given.release, "machine": machine, "commands": rows})
    print(f"\nDebian {given.release}, {machine['cores']} cores of {machine['processor']}, kernel {machine['kernel']}")
    for row in rows:
        seconds = row["seconds_without_download"]
        print(f"  {row['command']:12} {seconds // 60} min {seconds % 60:02} s, {row['install_s']} s of them for packages; besides, {row['download_s']} s of "
              f"downloads ({row['packages']}); exit status {row['exit_status']}")
    return any(row["exit_status"] for row in rows)


if __name__ == "__main__":
    sys.exit(main())
