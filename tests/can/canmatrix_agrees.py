#!/usr/bin/python3
"""[CAN-030] Frames that our encoder made, decoded by python3-canmatrix from the same DBC, hold the values that went in.

Usage: canmatrix_agrees.py FRAME_VECTORS, from the project root. Units, CRC and roll-over are worked out here, not taken from our code.
"""
import json
import logging
import math
import subprocess
import sys
import tomllib
from collections import Counter

logging.disable(logging.ERROR)  # canmatrix names the file formats that it was built without

import canmatrix.formats  # noqa: E402

# One of it in the controller's unit.
UNITS = {
    "": 1, "1": 1, "%": 0.01, "rpm": 2 * math.pi / 60, "m/s": 1, "km/h": 1 / 3.6, "m/s2": 1, "Pa": 1, "bar": 1e5,
    "mA": 1, "A": 1e3, "N": 1, "Nm": 1, "us": 1e3, "ms": 1e6, "degC": 1,
}
ROLLS_OVER = {"edge_count", "edge_time", "number"}
CYCLIC_FROM_ZERO = 15


def crc8_j1850(data):
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = ((crc << 1) ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0xFF


class Layout:
    def __init__(self, name):
        self.dbc = canmatrix.formats.loadp_flat(f"config/{name}.dbc")
        with open(f"config/{name}_binding.toml", "rb") as file:
            self.binding = tomllib.load(file)
        self.counters = {}

    def check(self, role, identifier, data, sent, read):
        table = self.binding[role]
        frame = self.dbc.frame_by_id(canmatrix.ArbitrationId(identifier))
        assert frame.name == table["message"], f"{identifier:#x} is {frame.name}"
        assert frame.size == len(data), f"{frame.name}: {len(data)} bytes"
        if "period_ms" in table:
            assert frame.cycle_time == table["period_ms"], f"{frame.name}: cycle time {frame.cycle_time}"
        decoded = frame.decode(data)
        self.check_protection(frame, table, data, decoded)
        for key, value in sent.items():
            bound = table["bits"][key] if role == "faults" else table[key]
            name, unit = (bound, "") if isinstance(bound, str) else (bound["signal"], bound["unit"])
            signal = frame.signal_by_name(name)
            assert UNITS[signal.unit or ""] == UNITS[unit], f"{frame.name}.{name}: unit {signal.unit}"
            step = float(signal.factor) * UNITS[unit]
            got = float(decoded[name].phys_value) * UNITS[unit]
            if key in ROLLS_OVER:
                span = step * 2 ** signal.size
                assert 0 <= (value - got) % span < step, f"{frame.name}.{name}: {value} became {got}"
                if key in read:
                    assert abs((read[key] - got + span / 2) % span - span / 2) < 0.5, f"{frame.name}.{name}: read {read[key]}"
                continue
            limited = min(max(value, float(signal.min) * UNITS[unit]), float(signal.max) * UNITS[unit])
            assert abs(got - limited) <= 0.5001 * step + 1e-6 * abs(got), f"{frame.name}.{name}: {value} became {got}"
            if key in read:
                assert abs(read[key] - got) <= 1e-6 * max(abs(got), step), f"{frame.name}.{name}: {got} was read as {read[key]}"

    def check_protection(self, frame, table, data, decoded):
        if table["protection"] == "none":
            return
        counter = int(decoded[table["counter"]].raw_value)
        modulo = CYCLIC_FROM_ZERO if table["protection"] == "counter_crc" else 2 ** frame.signal_by_name(table["counter"]).size
        assert counter == self.counters.get(frame.name, 0), f"{frame.name}: counter {counter}"
        self.counters[frame.name] = (counter + 1) % modulo
        if table["protection"] != "counter_crc":
            return
        crc = int(decoded[table["crc"]].raw_value)
        place = frame.signal_by_name(table["crc"]).get_startbit(bit_numbering=1) // 8
        wanted = crc8_j1850(table["data_id"].to_bytes(2, "little") + data[:place] + data[place + 1:])
        assert crc == wanted, f"{frame.name}: CRC {crc:#x}, expected {wanted:#x}"


def main():
    lines = subprocess.run([sys.argv[1]], check=True, capture_output=True, text=True).stdout.splitlines()
    layouts = {name: Layout(name) for name in ("antiskid", "foreign")}
    seen = Counter()
    for line in lines:
        vector = json.loads(line)
        layouts[vector["layout"]].check(vector["role"], vector["id"], bytes.fromhex(vector["data"]), vector["sent"], vector["read"])
        seen[vector["layout"], vector["role"]] += 1
    for name, layout in layouts.items():
        bound = {(name, role) for role in layout.binding}
        assert bound <= set(seen), f"never seen: {bound - set(seen)}"
    print(f"{sum(seen.values())} frames of {len(seen)} messages agree")


if __name__ == "__main__":
    main()
