#!/usr/bin/python3
"""The documentation page of a register map, on standard output.

usage: register_page.py config/registers.toml > docs/user/registers.md
"""
import sys
import tomllib

WIDTH = {"u16": 1, "i16": 1, "u32": 2, "float32": 2}


def number(value):
    return f"{value:.15g}"


def rows(tables, codes):
    yield "| address | old number | name | type | one count is | unit | range | meaning |"
    yield "|---|---|---|---|---|---|---|---|"
    for name, field in sorted(tables.items(), key=lambda item: item[1]["address"]):
        first = field["address"]
        last = first + WIDTH[field["type"]] - 1
        scale, offset = field.get("scale", 1), field.get("offset", 0)
        count = "" if (scale, offset) == (1, 0) else number(scale) + (f", from {number(offset)} on" if offset else "")
        low, high = (number(end) for end in field["range"])
        yield (f"| {first}{f'-{last}' if last > first else ''} | {codes}{first + 1:05d} | `{name}` | {field['type']} | {count} "
               f"| {field.get('unit', '')} | {low} to {high} | {field['comment']} |")


def page(m):
    order = "high word first (ABCD)" if m["word_order"] == "big" else "low word first (CDAB)"
    yield f"""# Registers of the rig's PLC

This is the Modbus register map between the bridge and the PLC: version {m["map_version"]}, unit {m["unit_id"]}. It is generated from
`config/registers.toml` by `rig_bridge/rig/register_page.py`, and a test compares the two. For another PLC, write your own map in that form.

Measured values are in input registers, commands in holding registers. Addresses are those of the protocol and count from 0; the old number counts
from 1 and begins with the kind of register. Values of two registers have the {order}; float32 is IEEE 754.
value = raw x one count, in the unit given. A writer limits a value to its range; a reader rejects a value outside it.

## Measured values: input registers (function code 4)
"""
    yield from rows(m["input"], "3")
    yield """
Bits of `interlocks` (1: good):

| bit | interlock |
|---|---|"""
    for name, bit in sorted(m["interlocks"].items(), key=lambda item: item[1]):
        yield f"| {bit} | {name} |"
    yield """
## Commands: holding registers (function codes 3, 6, 16, 22, 23)
"""
    yield from rows(m["holding"], "4")
    yield f"""
To command, write the registers in any number of requests, and `commit` last, with a number that is neither 0 nor the previous one. Only then does the
command take effect, all of it at once. The PLC shows the number in `applied_commit` or `rejected_commit`. Only `bridge_watchdog` needs no
commit: when it has not changed for {m["watchdog"]["bridge_timeout_ms"]} ms, the PLC trips. When `plc_watchdog` has not changed for
{m["watchdog"]["plc_timeout_ms"]} ms, the bridge aborts.

## Faults of the virtual PLC: holding registers

A real PLC has none of these registers. They take effect at once, without commit.
"""
    yield from rows(m["virtual"], "4")
    link, serial = m["link"], m["serial"]
    yield f"""
## Link

The bridge polls every {link["poll_ms"]} ms, waits {link["connect_timeout_ms"]} ms for a connection and {link["response_timeout_ms"]} ms for an
answer. After a timeout, an exception or an answer to another request it closes the link and opens it again after {link["backoff_min_ms"]} ms, twice
that, and so on up to {link["backoff_max_ms"]} ms. RTU: {serial["baud"]} baud, 8 data bits, parity {serial["parity"]}, {serial["stop_bits"]} stop bit{"s" if serial["stop_bits"] > 1 else ""}. After
an error the line must first be quiet for {link["response_timeout_ms"]} ms.

When they are asked for, readings of the load cells are {link.get("load_cells_late_ms", 0)} ms old in the mean (`load_cells_late_ms`, 0 to 50; 0 if
the key is missing): half a scan of the PLC and the delay of the cells' filter. The bridge tells it on the bus, see [recording](recording.md#figures).

## By hand

With `virtual-rig serve` on port 1502, or any PLC with this map (`mbpoll -0` counts from 0, `-1` asks once):
"""
    speed, sledge = m["input"]["flywheel_speed"], m["holding"]["sledge_advance"]
    kind = {"float32": ":float", "u32": ":int"}.get(speed["type"], "")
    swap = " -B" if kind and m["word_order"] == "big" else ""
    yield f"""    mbpoll -m tcp -p 1502 -a {m["unit_id"]} -0 -1 -t 3{kind}{swap} -r {speed["address"]} 127.0.0.1                # flywheel_speed
    mbpoll -m tcp -p 1502 -a {m["unit_id"]} -0 -t 4 -r {sledge["address"]} 127.0.0.1 1                       # sledge_advance: to the rim, once committed
    mbpoll -m tcp -p 1502 -a {m["unit_id"]} -0 -t 4 -r {m["holding"]["commit"]["address"]} 127.0.0.1 1                      # commit 1
    mbpoll -m tcp -p 1502 -a {m["unit_id"]} -0 -t 4 -r {m["virtual"]["open_interlocks"]["address"]} 127.0.0.1 {1 << m["interlocks"]["guard_closed"]}                     # the guard opens"""


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    with open(sys.argv[1], "rb") as file:
        print("\n".join(page(tomllib.load(file))))
