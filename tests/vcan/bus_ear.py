"""What the bus says, in its order: for tests that judge by counting periods instead of by a clock. Written against config/antiskid.dbc."""
import os
import socket
import struct
import threading

from three_programs import PHASES, PRESSURE_GONE_PA, check

SYNC, VALVE, WHEEL, FLYWHEEL, PRESSURE, MANEUVER, STATUS, FAULTS, STATE = 0x080, 0x100, 0x110, 0x111, 0x112, 0x120, 0x180, 0x181, 0x191
LENGTHS = {SYNC: 2, VALVE: 4, WHEEL: 8, FLYWHEEL: 8, PRESSURE: 4, MANEUVER: 8, STATUS: 8, FAULTS: 6, STATE: 6}
MARK = 0x7DE  # ours, between the frames of the programs: what comes after it came after what was done then
NOW, ANEW = b"\1", b"\2"  # what a mark says
SELF_TEST, STANDBY, ARMED, BRAKING, LOCKED, DROP_OUT, SAFE = 0, 1, 2, 4, 5, 6, 7


class Ear(threading.Thread):
    """The frames of these identifiers, and what the last of them said."""

    def __init__(self, *identifiers, prompt=False):
        """prompt: runs before the programs that it listens to. Whoever acts on what was heard must hear it now, or is hundreds of periods late on a
        busy machine; but what the ear takes of the one processor the bridge does not have."""
        super().__init__(daemon=True)
        self.prompt = prompt
        self.socket = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        wanted = (*identifiers, MARK)
        self.socket.setsockopt(socket.SOL_CAN_RAW, socket.CAN_RAW_FILTER, b"".join(struct.pack("=II", each, 0x7FF) for each in wanted))
        self.socket.setsockopt(socket.SOL_SOCKET, 33, 1 << 25)  # SO_RCVBUFFORCE: seconds of a bus that nobody reads
        self.socket.bind(("vcan0",))
        self.mouth = socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
        self.mouth.bind(("vcan0",))
        self.news = threading.Condition()
        self.forget()
        self.start()

    def forget(self):
        with self.news:
            self.frames = []
            self.phase, self.state, self.pressure_Pa, self.current_mA, self.faults = None, None, 0.0, 0.0, 0
            self.syncs, self.marks, self.first_pressure = 0, 0, None

    def run(self):
        if self.prompt:
            os.sched_setscheduler(0, os.SCHED_FIFO | os.SCHED_RESET_ON_FORK, os.sched_param(1))
        while True:
            identifier, length, data = struct.unpack("=IB3x8s", self.socket.recv(16))
            identifier, data = identifier & 0x7FF, data[:length]
            with self.news:
                if (identifier, data) == (MARK, ANEW):
                    self.forget()
                    self.begun = True
                    self.news.notify_all()
                    continue
                if length != LENGTHS.get(identifier, length):  # corrupted
                    continue
                self.frames.append((identifier, data))
                before = self.said()
                self.hear(identifier, data)
                # Not at each frame: whoever waits would take the processor from the reading, which then is seconds behind.
                if self.said() != before:
                    self.news.notify_all()

    def said(self):
        return self.phase, self.state, self.faults, self.first_pressure, self.marks, self.syncs // 10

    def hear(self, identifier, data):
        if identifier == SYNC:
            self.syncs += 1
        elif identifier == MARK:
            self.marks += 1
        elif identifier == VALVE:
            self.current_mA = current_mA(data)
        elif identifier == PRESSURE:
            self.pressure_Pa = pressure_Pa(data)
            if self.first_pressure is None and self.phase == "braking" and self.pressure_Pa > PRESSURE_GONE_PA:
                self.first_pressure = self.syncs
        elif identifier == STATUS:
            self.state = data[1] >> 4
        elif identifier == FAULTS:
            self.faults = int.from_bytes(data[2:6], "little")
        elif identifier == STATE and data[1] >> 4 < len(PHASES):  # else corrupted
            self.phase = PHASES[data[1] >> 4]

    def until(self, condition, seconds=180.0):
        """A bound on hanging, no measurement: on a slow machine the ear needs half a minute for what a landing has left in its socket."""
        with self.news:
            return self.news.wait_for(condition, seconds)

    def mark(self, what=NOW):
        self.mouth.send(struct.pack("=IB3x8s", MARK, 1, what))

    def begin_anew(self):
        """Forgets what was sent until now, also what still waits in the socket: on a busy machine hundreds of periods."""
        self.begun = False
        self.mark(ANEW)
        check(self.until(lambda: self.begun), "the ear does not hear its own mark")


def current_mA(data):
    return struct.unpack_from("<H", data, 2)[0] * 0.001


def pressure_Pa(data):
    return struct.unpack_from("<H", data, 2)[0] * 500.0


def after_mark(frames):
    return frames[max(i for i, (identifier, _) in enumerate(frames) if identifier == MARK) + 1:]


def whole(frames):
    """No SYNC is missing: nothing was lost on the way to the judge."""
    numbers = [struct.unpack_from("<H", data)[0] for identifier, data in frames if identifier == SYNC]
    return all((b - a) & 0xFFFF == 1 for a, b in zip(numbers, numbers[1:]))
