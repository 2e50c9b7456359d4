"""1000 frames to another process and back over vcan0; the other process adds one to each byte."""

import os
import sys

import can


def bus():
    return can.Bus("vcan0", bustype="socketcan")


here = bus()
there = bus()
if os.fork() == 0:
    for _ in range(1000):
        frame = there.recv(10.0)
        there.send(can.Message(arbitration_id=0x124, is_extended_id=False, data=[(b + 1) % 256 for b in frame.data]))
    os._exit(0)

there.shutdown()
for i in range(1000):
    sent = [i % 256, i // 256, 255, 0]
    here.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=sent))
    back = here.recv(10.0)
    if back is None or back.arbitration_id != 0x124 or list(back.data) != [(b + 1) % 256 for b in sent]:
        sys.exit(f"ping {i}: sent {sent}, got {back}")
here.shutdown()
sys.exit(os.waitstatus_to_exitcode(os.wait()[1]))
