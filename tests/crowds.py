"""A crowd of connections to a local port that never show its token."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

FIRST_BYTES = (
    b"",
    b"GET / HTTP/1.1\r\nHost: 127.0.0.1\r\n",
    b"GET /x/events HTTP/1.1\r\nHost: 127.0.0.1\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n",
    b"POST /x/do HTTP/1.1\r\nContent-Length: 1000\r\n",
)


@contextmanager
def crowd(port: int, count: int = 100) -> Iterator[list[socket.socket]]:
    """Open connections that send nothing, or a request that never ends."""
    with ExitStack() as stack:
        made = []
        for number in range(count):
            made.append(stack.enter_context(socket.create_connection(("127.0.0.1", port), timeout=10)))
            made[-1].sendall(FIRST_BYTES[number % len(FIRST_BYTES)])
        yield made


def open_ones(connections: list[socket.socket]) -> int:
    """Count the connections that the server has not closed."""
    count = 0
    for connection in connections:
        connection.setblocking(False)
        try:
            while connection.recv(4096):
                pass
        except BlockingIOError:
            count += 1
        except OSError:
            pass
    return count


def wait_until_open(connections: list[socket.socket], most: int, seconds: float = 10.0) -> int:
    """Wait until no more than so many are open; return how many are."""
    end = time.monotonic() + seconds
    while (count := open_ones(connections)) > most and time.monotonic() < end:
        time.sleep(0.02)
    return count
