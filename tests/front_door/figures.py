#!/usr/bin/python3
"""Pages show what the programs print: each block of a page that names a command of rig-lab holds its lines, as they are now. [DOOR-075]

    <!-- rig-lab compare: ^\\| -->      the command; which of its lines, by a regular expression
    | surface | ...
    <!-- end -->

usage: figures.py PROJECT RIG_LAB [--write]    --write puts the lines of now into the pages
"""
import argparse
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"^<!-- rig-lab (.+?): (.+) -->\n(.*?)^<!-- end -->$", re.M | re.S)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("project", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("rig_lab", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    said, stale, blocks = {}, [], 0

    def lines_now(command, wanted):
        if command not in said:
            with tempfile.TemporaryDirectory() as folder:
                words = [options.rig_lab, *shlex.split(command), "--config", options.project / "config"]
                said[command] = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=True).stdout.splitlines()
        lines = [line for line in said[command] if re.search(wanted, line)]
        # A table as it is, anything else as a block of code.
        return "".join(line + "\n" if line.startswith("|") else f"    {line}".rstrip() + "\n" for line in lines)

    for page in sorted([*options.project.glob("*.md"), *options.project.glob("docs/**/*.md")]):
        def judge(block):
            nonlocal blocks
            blocks += 1
            command, wanted, shown = block.groups()
            now = lines_now(command, wanted)
            now = now if now.startswith("|") else f"\n{now}\n"
            if now != shown:
                stale.append(f"{page.relative_to(options.project)}: rig-lab {command} says otherwise now")
            return f"<!-- rig-lab {command}: {wanted} -->\n{now}<!-- end -->"

        text = page.read_text()
        now = BLOCK.sub(judge, text)
        if options.write and now != text:
            page.write_text(now)
    print(*stale, f"{blocks} blocks, {len(stale)} {'written' if options.write else 'stale'}", sep="\n")
    return 0 if blocks and (options.write or not stale) else 1


if __name__ == "__main__":
    sys.exit(main())
