#!/usr/bin/python3
"""Rooms know each other one way, firmware <- rig_bridge <- plant_sim, by what they include and what they are linked with; config holds data alone. [DOOR-074]

usage: arrows.py [PROJECT]
"""
import pathlib
import posixpath
import re
import sys

ROOMS = ("firmware", "rig_bridge", "plant_sim")
DATA = {".toml", ".dbc", ".csv", ".json"}
INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.M)
TARGET = re.compile(r"\badd_(?:library|executable|custom_target)\(\s*([\w-]+)")
WORD = re.compile(r"[\w./-]+")


def rank(path):
    room = path.split("/")[0]
    return ROOMS.index(room) if room in ROOMS else None


def above(path, name, room):
    """Whether the file must not know that path: of a room above its own, or outside of the product. Benchmarks compare with what tests have."""
    return path.split("/")[0] in {*ROOMS[room + 1:], "config", "tests"} - ({"tests"} if "/bench/" in name else set())


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    files = {str(path.relative_to(root)): path for room in (*ROOMS, "config") for path in sorted((root / room).rglob("*")) if path.is_file()}
    wrong = [f"{name}: config holds data alone" for name, path in files.items()
             if name.startswith("config/") and (path.suffix not in DATA or path.stat().st_mode & 0o111)]

    lists = {name: re.sub(r"#.*", "", path.read_text()) for name, path in files.items()
             if path.name == "CMakeLists.txt" or path.suffix == ".cmake"}
    home = {target: name for name, text in lists.items() for target in TARGET.findall(text)}
    includes = 0
    for name, path in files.items():
        room = rank(name)
        if room is None:
            continue
        if path.suffix in {".cpp", ".hpp", ".c", ".h"}:
            found = [posixpath.normpath(posixpath.join(posixpath.dirname(name), i)) if i.startswith(".") else i
                     for i in INCLUDE.findall(path.read_text())]
            includes += len(found)
            wrong += [f"{name}: includes {i}" for i in found if above(i, name, room)]
        for word in sorted(set(WORD.findall(lists.get(name, "")))):
            where = home.get(word, word.removeprefix("/"))
            if not where.startswith("config") and above(where, name, room):
                wrong.append(f"{name}: names {word}" + (f" of {where}" if where != word else ""))
    if not includes or not home:
        wrong.append("no includes or no targets found: is this the project?")
    print(*wrong, f"{includes} includes, {len(home)} targets, {len(wrong)} wrong", sep="\n")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
