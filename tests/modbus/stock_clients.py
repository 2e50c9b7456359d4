#!/usr/bin/python3
"""Stock Modbus software against ours: mbpoll and pymodbus as clients, TCP and RTU; a pymodbus server for our client.

Register contents are coded here from config/registers.toml alone, with struct.

usage: stock_clients.py MODBUS_BENCH      from the project root
"""
import json
import logging
import re
import socket
import struct
import subprocess
import sys
import threading
import time
import tomllib

from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.datastore import ModbusSequentialDataBlock, ModbusServerContext, ModbusSlaveContext
from pymodbus.server import StartTcpServer

logging.getLogger("pymodbus").setLevel(logging.CRITICAL)

MAP = tomllib.load(open("config/registers.toml", "rb"))
FORMAT = {"u16": ">H", "i16": ">h", "u32": ">I", "float32": ">f"}
WIDTH = {"u16": 1, "i16": 1, "u32": 2, "float32": 2}

# Values that their registers hold exactly, or to half a count.
MEASURED = {
    "plc_state": 1, "rejected_commit": 513, "interlocks": 0b1010, "wheel_on_rim": 1, "brake_temperature": -12.3,
    "hydraulic_pressure": 20.99e6, "sledge_position": 0.2468, "flywheel_speed": 61.0625, "loading_force": 43609.5,
    "vertical_load": 43500.25, "longitudinal_force": -12345.75, "brake_torque": 7654.5,
}
COMMANDED = {
    "drive_enable": 1, "sledge_advance": 1, "load_enable": 0, "reset": 1, "flywheel_speed": 55.125,
    "load_base": 23541.25, "load_lift": 3.625,
}


def to_words(field, value):
    raw = (value - field.get("offset", 0)) / field.get("scale", 1)
    if field["type"] != "float32":
        raw = round(raw)
    data = struct.pack(FORMAT[field["type"]], raw)
    words = [int.from_bytes(data[i:i + 2], "big") for i in range(0, len(data), 2)]
    return words if MAP["word_order"] == "big" else words[::-1]


def from_words(field, words):
    if MAP["word_order"] == "little":
        words = words[::-1]
    data = b"".join(word.to_bytes(2, "big") for word in words)
    return struct.unpack(FORMAT[field["type"]], data)[0] * field.get("scale", 1) + field.get("offset", 0)


def equal(what, got, expected, tolerance=0.0):
    if abs(got - expected) > tolerance:
        sys.exit(f"{what}: {got}, expected {expected}")


class Bench:
    """Our server in its own process."""

    def __init__(self, program):
        self.process = subprocess.Popen([program, "serve"], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        hello = json.loads(self.process.stdout.readline())
        self.port, self.rtu = hello["port"], hello["rtu"]

    def say(self, line):
        self.process.stdin.write(line + "\n")
        self.process.stdin.flush()

    def orders(self):
        self.say("orders")
        return json.loads(self.process.stdout.readline())

    def orders_with(self, commit):
        end = time.monotonic() + 60
        while time.monotonic() < end:
            orders = self.orders()
            if orders["commit"] == commit:
                return orders
            time.sleep(0.01)
        sys.exit(f"commit {commit} never reached the PLC: {orders}")

    def close(self):
        self.process.stdin.close()
        if self.process.wait(60) != 0:
            sys.exit("the server ended with an error")


class PyModbus:
    def __init__(self, client):
        self.client = client
        if not client.connect():
            sys.exit("pymodbus: no connection")

    def read(self, kind, field):
        ask = self.client.read_input_registers if kind == "input" else self.client.read_holding_registers
        answer = ask(field["address"], count=WIDTH[field["type"]], slave=MAP["unit_id"])
        if answer.isError():
            sys.exit(f"pymodbus: {answer}")
        return from_words(field, answer.registers)

    def write(self, field, value):
        answer = self.client.write_registers(field["address"], to_words(field, value), slave=MAP["unit_id"])
        if answer.isError():
            sys.exit(f"pymodbus: {answer}")

    def close(self):
        self.client.close()


class MbPoll:
    """One process a request, as a technician types it."""

    def __init__(self, bench, mode):
        serial = MAP["serial"]
        self.where = ["-m", "tcp", "-p", str(bench.port), "127.0.0.1"] if mode == "tcp" else [
            "-m", "rtu", "-b", str(serial["baud"]), "-P", serial["parity"], bench.rtu]

    def run(self, kind, field, value=None):
        form = {"float32": ":float", "u32": ":int", "u16": "", "i16": ""}[field["type"]]
        order = ["-B"] if form and MAP["word_order"] == "big" else []
        command = ["mbpoll", "-o", "10", "-0", "-1", "-a", str(MAP["unit_id"]), "-t", ("3" if kind == "input" else "4") + form,
                   "-r", str(field["address"]), *order, *self.where]
        if value is not None:
            command += ["--", str(value)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}\n{done.stdout}{done.stderr}")
        return done.stdout

    def read(self, kind, field):
        out = self.run(kind, field)
        shown = re.search(rf"^\[{field['address']}\]:\s+(\S+)", out, re.M)
        if not shown:
            sys.exit(f"mbpoll shows no value:\n{out}")
        raw = float(shown[1])
        if field["type"] == "i16" and raw > 32767:
            raw -= 65536
        return raw * field.get("scale", 1) + field.get("offset", 0)

    def write(self, field, value):
        raw = (value - field.get("offset", 0)) / field.get("scale", 1)
        self.run("holding", field, raw if field["type"] == "float32" else round(raw))

    def close(self):
        pass


def check_client(bench, what, client, commit):
    for name, value in MEASURED.items():
        field = MAP["input"][name]
        # mbpoll prints six digits.
        tolerance = max(0.51 * field.get("scale", 0), 1e-5 * abs(value) if "mbpoll" in what else 0)
        equal(f"{what}: {name}", client.read("input", field), value, tolerance)
    equal(f"{what}: map_version", client.read("input", MAP["input"]["map_version"]), MAP["map_version"])

    before = bench.orders()
    wanted = {name: value + commit if name == "load_base" else value for name, value in COMMANDED.items()}
    for name, value in wanted.items():
        client.write(MAP["holding"][name], value)
    for name in wanted:
        equal(f"{what}: {name} before its commit", bench.orders()[name], before[name])
    client.write(MAP["holding"]["commit"], commit)
    after = bench.orders_with(commit)
    for name, value in wanted.items():
        equal(f"{what}: {name}", after[name], value)
        equal(f"{what}: {name} read back", client.read("holding", MAP["holding"][name]), value, 1e-5 * value)
    client.write(MAP["virtual"]["open_interlocks"], 1 << MAP["interlocks"]["guard_closed"])
    while bench.orders()["open_interlocks"] != 0b10:
        time.sleep(0.01)
    client.write(MAP["virtual"]["open_interlocks"], 0)
    client.close()
    print(f"{what}: {len(MEASURED) + 1} measured and {len(wanted)} commanded quantities agree")


def stock_clients(program):
    """[BRG-050]"""
    bench = Bench(program)
    for name, value in MEASURED.items():
        bench.say(f"{name} {value!r}")
    bench.orders()  # after a scan that has them all
    serial = MAP["serial"]
    check_client(bench, "pymodbus, TCP", PyModbus(ModbusTcpClient("127.0.0.1", port=bench.port)), 1)
    check_client(bench, "mbpoll, TCP", MbPoll(bench, "tcp"), 2)
    check_client(bench, "pymodbus, RTU", PyModbus(ModbusSerialClient(
        bench.rtu, baudrate=serial["baud"], parity=serial["parity"][0].upper(), stopbits=serial["stop_bits"])), 3)
    check_client(bench, "mbpoll, RTU", MbPoll(bench, "rtu"), 4)
    bench.close()


def stock_server(program):
    """[BRG-050]"""
    inputs, holdings = [0] * 64, [0] * 64
    for name, value in {**MEASURED, "map_version": MAP["map_version"], "rejected_commit": 0}.items():
        field = MAP["input"][name]
        inputs[field["address"]:field["address"] + WIDTH[field["type"]]] = to_words(field, value)
    store = ModbusSlaveContext(ir=ModbusSequentialDataBlock(1, inputs), hr=ModbusSequentialDataBlock(1, holdings))  # it adds 1
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    threading.Thread(target=lambda: StartTcpServer(context=ModbusServerContext(slaves=store, single=True), address=("127.0.0.1", port)),
                     daemon=True).start()
    deadline = time.monotonic() + 60.0
    while True:
        try:
            socket.create_connection(("127.0.0.1", port), timeout=1.0).close()
            break
        except OSError:
            if time.monotonic() > deadline:
                sys.exit("pymodbus server does not start")
            time.sleep(0.05)

    def plc():
        count = 0
        while True:
            count = (count + 1) % 65536
            store.setValues(4, MAP["input"]["plc_watchdog"]["address"], [count])
            store.setValues(4, MAP["input"]["applied_commit"]["address"],
                            store.getValues(3, MAP["holding"]["commit"]["address"], 1))
            time.sleep(0.01)

    threading.Thread(target=plc, daemon=True).start()
    asked = subprocess.run([program, "ask", f"127.0.0.1:{port}", *(f"{k}={v}" for k, v in COMMANDED.items())],
                           capture_output=True, text=True, timeout=120, check=False)
    if asked.returncode != 0:
        sys.exit(f"our client failed: {asked.stdout}{asked.stderr}")
    seen = json.loads(asked.stdout)
    if not seen["good"] or seen["error"]:
        sys.exit(f"our client complains: {seen}")
    for name, value in {**MEASURED, "rejected_commit": 0}.items():
        equal(f"pymodbus server: {name}", seen[name], value, 0.51 * MAP["input"][name].get("scale", 0))
    for name, value in COMMANDED.items():
        field = MAP["holding"][name]
        got = from_words(field, store.getValues(3, field["address"], WIDTH[field["type"]]))
        equal(f"pymodbus server: {name}", got, value)
    print(f"pymodbus server: {len(MEASURED)} measured and {len(COMMANDED)} commanded quantities agree")


if __name__ == "__main__":
    if len(sys.argv) != 2 or sys.argv[1].startswith("-"):
        sys.exit(__doc__)
    stock_clients(sys.argv[1])
    stock_server(sys.argv[1])
