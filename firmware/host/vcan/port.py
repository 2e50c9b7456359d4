#!/usr/bin/python3
"""Makes a TCP port inside reachable outside. Nobody can call a guest or a namespace, but they can call out: `run` listens for callers at
127.0.0.1:PORT, and for connections from inside, of which one always waits for the next caller. One byte tells it that he is there.

    port.py PORT OUTSIDE      the inside part; OUTSIDE is where the outside part listens for it: ADDRESS:PORT, or the path of a socket
"""
import asyncio
import sys

CALLER = b"\n"


async def copy(reader, writer):
    try:
        while data := await reader.read(65536):
            writer.write(data)
            await writer.drain()
        writer.write_eof()  # the other direction may have more
    except OSError:
        writer.close()  # the other end hung up


async def join(one, other):
    await asyncio.gather(copy(one[0], other[1]), copy(other[0], one[1]))
    for _, writer in (one, other):
        writer.close()


class Outside:
    """Listens at once, so that an address that is taken is an OSError here; `run` then serves."""

    def __init__(self, port, socket_path=None):
        self.loop = asyncio.new_event_loop()
        self.waiting = asyncio.Queue()
        self.callers = self.loop.run_until_complete(asyncio.start_server(self.called, "127.0.0.1", port))
        inside = asyncio.start_unix_server(self.entered, socket_path) if socket_path else asyncio.start_server(self.entered, "127.0.0.1", 0)
        self.inside = self.loop.run_until_complete(inside)
        self.address = socket_path or f"10.0.2.2:{self.inside.sockets[0].getsockname()[1]}"  # the guest's name for this machine

    async def entered(self, reader, writer):
        await self.waiting.put((reader, writer))

    async def called(self, reader, writer):
        way_in = await self.waiting.get()
        way_in[1].write(CALLER)
        await join((reader, writer), way_in)

    def run(self):
        self.loop.run_forever()


async def inside(port, outside):
    host, _, number = outside.rpartition(":")
    calls = set()

    async def answer(way_out):
        try:
            program = await asyncio.open_connection("127.0.0.1", port)
        except OSError:
            way_out[1].close()  # the program does not listen yet, or no more
            return
        await join(program, way_out)

    while True:
        way_out = await (asyncio.open_connection(host, int(number)) if host else asyncio.open_unix_connection(outside))
        if await way_out[0].read(1) != CALLER:
            return
        call = asyncio.create_task(answer(way_out))
        calls.add(call)
        call.add_done_callback(calls.discard)


if __name__ == "__main__":
    asyncio.run(inside(int(sys.argv[1]), sys.argv[2]))
