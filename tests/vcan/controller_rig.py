"""A small rig for the tests of antiskid-controller: enough of a landing to have the valve open, over raw CAN sockets.

Written against config/antiskid.dbc, and sharing no code with the programs. Lockstep: sensors, SYNC, then the answer.
"""

import math
import socket
import struct
import tomllib

EMERGENCY_STOP, SYNC, VALVE, WHEEL, FLYWHEEL, PRESSURE, MANEUVER = 0x010, 0x080, 0x100, 0x110, 0x111, 0x112, 0x120
STATUS, FAULTS, RIG_HEARTBEAT, CONTROLLER_HEARTBEAT = 0x180, 0x181, 0x700, 0x701
FROM_CONTROLLER = (VALVE, STATUS, FAULTS, CONTROLLER_HEARTBEAT)
OPEN_LOOP = 2
BRAKING, SAFE = 4, 7

with open("config/controller.toml", "rb") as file:
    CONFIG = tomllib.load(file)
SAFE_MA = CONFIG["valve"]["safe_current_mA"]


def static_pressure_Pa(current):
    points = list(zip(CONFIG["valve"]["current_mA"], CONFIG["valve"]["pressure_Pa"]))
    for (i0, p0), (i1, p1) in zip(points, points[1:]):
        if current <= i1:
            return p0 + (p1 - p0) * max(current - i0, 0.0) / (i1 - i0)
    return points[-1][1]


def crc8(data):
    """CRC-8/SAE-J1850."""
    crc = 0xFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1 ^ 0x1D if crc & 0x80 else crc << 1) & 0xFF
    return crc ^ 0xFF


assert crc8(b"123456789") == 0x4B


def crc_is_right(can_id, data):
    return data[0] == crc8(struct.pack("<H", can_id) + data[1:])


def pack(can_id, data):
    return struct.pack("<IB3x8s", can_id, len(data), data)


def unpack(frame):
    can_id, length, data = struct.unpack("<IB3x8s", frame)
    return can_id, data[:length]


def current_mA(data):
    return struct.unpack_from("<H", data, 2)[0] * 0.001


class Bus:
    """A raw socket that hears the controller only."""

    def __init__(self, interface="vcan0"):
        self.socket = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        # Room for seconds of 1 kHz while a test sleeps; the default is full after a few hundred frames.
        self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 16 << 20)
        exact = socket.CAN_EFF_FLAG | socket.CAN_RTR_FLAG | socket.CAN_SFF_MASK
        filters = b"".join(struct.pack("=II", can_id, exact) for can_id in FROM_CONTROLLER)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, filters)
        self.socket.bind((interface,))

    def send(self, can_id, data):
        self.socket.send(pack(can_id, data))

    def receive(self, timeout_s=20.0):
        """(id, data), or None when nothing came for so long."""
        self.socket.settimeout(timeout_s)
        try:
            return unpack(self.socket.recv(16))
        except TimeoutError:
            return None

    def close(self):
        self.socket.close()


class Rig:
    """In the air with the wheel at rest, armed at 0.2 s, on the ground at 0.25 s, open loop braking from 0.6 s on."""

    PERIOD_S = 1e-3

    def __init__(self, bus, braking_mA=12.0):
        self.bus = bus
        self.braking_mA = braking_mA
        self.steps = 0
        self.speed_mps = 60.0
        self.pressure_Pa = 0.0
        self.angles = {WHEEL: 0.0, FLYWHEEL: 0.0}
        self.edges = {WHEEL: (0, 0), FLYWHEEL: (0, 0)}
        self.counters = {}
        self.answers = []
        self.current_mA = 0.0
        self.state = 0
        self.faults = 0

    def protected(self, can_id, body, counter_byte=0):
        """`body` follows the counter byte, whose upper half belongs to the message."""
        counter = self.counters.get(can_id, 0)
        self.counters[can_id] = (counter + 1) % 15
        data = bytes([counter_byte | counter]) + body
        return bytes([crc8(struct.pack("<H", can_id) + data)]) + data

    def sensors(self):
        for can_id in (WHEEL, FLYWHEEL):
            count, time_100ns = self.edges[can_id]
            yield can_id, self.protected(can_id, struct.pack("<HI", count & 0xFFFF, time_100ns & 0xFFFFFFFF))
        yield PRESSURE, self.protected(PRESSURE, struct.pack("<H", round(self.pressure_Pa / 500)))
        if self.steps % 20 == 0:
            t = self.steps * self.PERIOD_S
            arm, on_wheels, demand = t >= 0.2, t >= 0.25, 10e6 if t >= 0.6 else 0.0
            word = round(demand / 500) | round(self.braking_mA / 0.05) << 36 | on_wheels << 46
            yield MANEUVER, self.protected(MANEUVER, word.to_bytes(6, "little"), OPEN_LOOP << 4 | arm << 7)
        if self.steps % 100 == 0:
            yield RIG_HEARTBEAT, self.protected(RIG_HEARTBEAT, b"")

    def send_sample(self):
        for can_id, data in self.sensors():
            self.bus.send(can_id, data)

    def step(self, disturb=None):
        """One period in lockstep; `disturb` is called between sensors and SYNC. Returns the frames of the answer."""
        self.send_sample()
        if disturb:
            disturb(self)
        self.bus.send(SYNC, struct.pack("<H", self.steps & 0xFFFF))
        answer = []
        while not answer or answer[-1][0] != VALVE:
            frame = self.bus.receive()
            if frame is None:
                raise TimeoutError(f"no answer to SYNC {self.steps}")
            answer.append(frame)
            self.hear(*frame)
        self.answers += answer
        self.advance()
        return answer

    def hear(self, can_id, data):
        assert crc_is_right(can_id, data), f"{can_id:03X} {data.hex()}"
        if can_id == VALVE:
            self.current_mA = current_mA(data)
        elif can_id == STATUS:
            self.state = data[1] >> 4
        elif can_id == FAULTS:
            self.faults = int.from_bytes(data[2:6], "little")

    def advance(self):
        self.steps += 1
        t = self.steps * self.PERIOD_S
        self.pressure_Pa += (static_pressure_Pa(self.current_mA) - self.pressure_Pa) * self.PERIOD_S / 0.015
        self.speed_mps = max(0.0, self.speed_mps - self.PERIOD_S * self.pressure_Pa * 0.6e-6)
        spin_up = min(max((t - 0.25) / 0.2, 0.0), 1.0)
        self.turn(WHEEL, spin_up * self.speed_mps * (1.0 - self.pressure_Pa / 80e6) / CONFIG["wheel"]["nominal_radius_m"], t)
        self.turn(FLYWHEEL, self.speed_mps / CONFIG["flywheel"]["radius_m"], t)

    def turn(self, can_id, speed_radps, t):
        tooth = 2.0 * math.pi / 60.0
        self.angles[can_id] += speed_radps * self.PERIOD_S
        edges = int(self.angles[can_id] / tooth)
        if edges != self.edges[can_id][0]:
            edge_s = t - (self.angles[can_id] - edges * tooth) / speed_radps
            self.edges[can_id] = (edges, round(edge_s * 1e7))

    def brake(self, disturb=None):
        """Runs until the valve has been open for a while."""
        while self.steps < 900:
            self.step(disturb)
        assert self.state == BRAKING and abs(self.current_mA - self.braking_mA) < 0.1, (
            f"not braking: state {self.state}, {self.current_mA} mA, faults {self.faults:x}"
        )

