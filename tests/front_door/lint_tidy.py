#!/usr/bin/python3
"""clang-tidy over the project's own files in a build's compile_commands.json, on all cores.

A file that was clean is not checked again until something changes that the result depends on: the text of the file or of
anything it includes, how it is compiled, the checks in force for it, or clang-tidy itself. The evidence is an empty file of that hash in
the user's cache directory; it does not depend on where the project lies, so that another clone finds it too.

    lint_tidy.py BUILD_DIR
"""

import concurrent.futures
import functools
import hashlib
import json
import os
import pathlib
import shlex
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]


@functools.cache
def digest(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def included_files(entry):
    """The source and everything it includes, system headers too, as the compiler sees it."""
    words = shlex.split(entry["command"])
    if os.path.basename(words[0]) == "ccache":
        words = words[1:]
    target = words.index("-o")
    rule = subprocess.run([*words[:target], *words[target + 2:], "-M"], cwd=entry["directory"],
                          capture_output=True, text=True, check=True).stdout
    return sorted({os.path.realpath(os.path.join(entry["directory"], word))
                   for word in rule.split(":", 1)[1].replace("\\\n", " ").split()})


def key(entry, tool):
    checks = subprocess.run(["clang-tidy", "--dump-config", entry["file"], "--"],
                            capture_output=True, text=True, check=True).stdout
    parts = [tool, entry["command"], entry["file"], checks]
    parts += [f"{path} {digest(path)}" for path in included_files(entry)]
    return hashlib.sha256("\n".join(parts).replace(str(ROOT), ".").encode()).hexdigest()


def check(entry, build, evidence, tool):
    """Returns (source, what clang-tidy complained about or None, whether it was known to be clean)."""
    name = os.path.relpath(entry["file"], ROOT)
    try:
        known = evidence / key(entry, tool)
    except subprocess.CalledProcessError as failure:
        return name, failure.stderr, False
    if known.exists():
        return name, None, True
    run = subprocess.run(["clang-tidy", "--quiet", "-p", build, entry["file"]], capture_output=True, text=True)
    if run.returncode != 0:
        return name, run.stdout + run.stderr, False
    known.touch()
    return name, None, False


def main():
    build = pathlib.Path(sys.argv[1]).resolve()
    cache = os.environ.get("XDG_CACHE_HOME") or pathlib.Path.home() / ".cache"
    evidence = pathlib.Path(cache) / "antiskid/clang-tidy"
    evidence.mkdir(parents=True, exist_ok=True)
    entries = [entry for entry in json.loads((build / "compile_commands.json").read_text())
               if pathlib.Path(entry["file"]).is_relative_to(ROOT) and build not in pathlib.Path(entry["file"]).parents]
    if not entries:
        sys.exit(f"{build}/compile_commands.json names no file of {ROOT}")
    tool = subprocess.run(["clang-tidy", "--version"], capture_output=True, text=True, check=True).stdout
    complaints = known = 0
    with concurrent.futures.ThreadPoolExecutor(len(os.sched_getaffinity(0))) as pool:
        jobs = [pool.submit(check, entry, build, evidence, tool) for entry in entries]
        for job in concurrent.futures.as_completed(jobs):
            name, complaint, was_known = job.result()
            known += was_known
            if complaint is not None:
                complaints += 1
                print(f"{name}:\n{complaint}", flush=True)
    print(f"{len(entries)} files: {known} unchanged since they were clean, {complaints} with complaints")
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
