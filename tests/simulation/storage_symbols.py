#!/usr/bin/python3
"""[BRG-701] Nothing in rig_bridge/record opens, writes, renames or asks for a file by itself: what the library leaves to others names no such call.

usage: storage_symbols.py NM LIBRARY
"""
import re
import subprocess
import sys

CALLS = ("open|open64|openat|openat64|creat|fopen|fopen64|freopen|write|pwrite|pwrite64|writev|fwrite|fputs|rename|renameat|unlink|unlinkat|remove|"
         "mkdir|rmdir|fsync|fdatasync|sync|ftruncate|ftruncate64|truncate|flock|mkstemp|mkstemp64|link|symlink")
LIBRARY = r"std::(__cxx11::)?basic_[io]?f(stream|ilebuf)|std::filesystem::(__cxx11::)?(?!path|filesystem_error|absolute)\w+\("
forbidden = re.compile(rf"^({CALLS})$|{LIBRARY}")

listed = subprocess.run([sys.argv[1], "--demangle", "--undefined-only", sys.argv[2]], check=True, capture_output=True, text=True).stdout
symbols = {line.strip().split(" ", 1)[1].split("@")[0] for line in listed.splitlines() if line.strip().startswith("U ")}
wrong = sorted(symbol for symbol in symbols if forbidden.search(symbol))
if not any("sqlite3_open_v2" in symbol for symbol in symbols):
    wrong.append("no symbols: is this the library?")
print("\n".join(wrong) or f"{len(symbols)} symbols, none of them a file's")
sys.exit(bool(wrong))
