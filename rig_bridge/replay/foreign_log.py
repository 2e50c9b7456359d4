"""The frames of a CAN tool's log as lines of candump, by the readers of python3-can.

    python3 foreign_log.py asc|blf|trc < LOG

LOG may be compressed by gzip. Exit status: 0 read to its end; 3 cannot be read; 4 cut off or damaged: the frames before that were given.
Standard error then has the reason and what mends it; after 0, what was left out.
"""
import gzip
import io
import logging
import os
import resource
import signal
import sys

signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # whoever started this may have enough
signal.signal(signal.SIGINT, signal.SIG_IGN)  # and is told of Ctrl-C itself
resource.setrlimit(resource.RLIMIT_AS, (1 << 30, 1 << 30))  # whatever a damaged log claims to hold
UNREADABLE, DAMAGED = 3, 4


def end(status, reason):
    sys.stdout.flush()
    print(reason, file=sys.stderr)
    sys.stderr.flush()
    os._exit(status)  # without the destructors of readers that are in the middle of a file


try:
    from can.io import ASCReader, BLFReader, TRCReader
except ImportError as missing:
    end(UNREADABLE, f"logs of Vector and PEAK are read by python-can: apt install python3-can ({missing})")
logging.disable()


class Lines:
    """The lines of a text log, for a reader that takes a file; keeps what tells whether the log is whole."""

    read = write = None  # a reader asks whether they are there

    def __init__(self, text):
        self.text = text
        self.last = "\n"
        self.in_block = False

    def __iter__(self):
        return self

    def __next__(self):
        line = self.last = next(self.text)
        if line[:1] in "BbEe":
            word = line[:17].lower()
            self.in_block = not word.startswith("end") if "triggerblock" in word.replace(" ", "") else self.in_block
        return line

    def close(self):
        self.text.close()

    def damage(self):
        if not self.last.endswith("\n"):
            return "it ends within a line"
        return "it has no End TriggerBlock" if self.in_block else None


class Trc(TRCReader):
    """Lines that are no data frame, a remote frame for one, are counted; TRCReader gives up at the first."""

    left_out = 0

    def _parse_line(self, line):
        try:
            return super()._parse_line(line)
        except ValueError:
            self.left_out += 1
            return None


def line_of(message, first_channel):
    channel = message.channel
    name = f"can{channel + first_channel}" if isinstance(channel, int) else "can"
    us = round(message.timestamp * 1e6)
    head = f"({us // 1000000:010d}.{us % 1000000:06d}) {name} "
    if message.is_error_frame:
        return head + "20000080#0000000000000000\n"
    identifier = f"{message.arbitration_id:08X}" if message.is_extended_id else f"{message.arbitration_id:03X}"
    if message.is_remote_frame:
        return f"{head}{identifier}#R{message.dlc or ''}\n"
    return f"{head}{identifier}#{'#0' if message.is_fd else ''}{message.data.hex().upper()}\n"


def opened(kind):
    """Reader; the lines that it reads where the log is text; bytes that are missing."""
    file = sys.stdin.buffer
    packed = file.peek(2)[:2] == b"\x1f\x8b"
    if packed:
        file = gzip.open(file)
    if kind == "blf":
        reader = BLFReader(file)
        return reader, None, 0 if packed else reader.file_size - os.fstat(0).st_size
    lines = Lines(io.TextIOWrapper(file, encoding="latin-1"))
    return (ASCReader if kind == "asc" else Trc)(lines), lines, 0


def main(kind):
    given = 0
    out = []
    first_channel = 0 if kind == "trc" else 1  # as the file counts: ASCReader and BLFReader take one off

    def give():
        nonlocal given
        sys.stdout.write("".join(out))
        given += len(out)
        out.clear()

    def damaged(why):
        give()
        if given == 0:
            end(UNREADABLE, f"no frame can be read, which it should have as {kind.upper()} ({why}); copy it from its recorder again")
        end(DAMAGED, f"cut off or damaged after frame {given} ({why}); copy it from its recorder again")

    try:
        reader, lines, missing = opened(kind)
        for message in reader:
            out.append(line_of(message, first_channel))
            if len(out) < 1000:
                continue
            if getattr(reader, "timestamps_format", None) == "relative":
                break
            give()
    except Exception as error:  # whatever the readers trip over
        damaged(f"{type(error).__name__}: {error}")
    if getattr(reader, "timestamps_format", None) == "relative":
        end(UNREADABLE, "its times are relative to the event before: save it with absolute times")
    why = lines.damage() if lines else "the file is shorter than its head says" if missing > 0 else None
    if why:
        damaged(why)
    give()
    left_out = getattr(reader, "left_out", 0)
    if left_out and not given:
        end(UNREADABLE, "no line is a frame of TRC 1.0, 1.1 or 2.1: save it as one of them")
    if left_out:
        end(0, f"{left_out} lines that are no data frame are left out")


main(sys.argv[1])
