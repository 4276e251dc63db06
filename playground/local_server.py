"""Bound the connections to a port of this machine that have not shown its token.

Any process of the machine may connect and say nothing. Such a connection is closed after a while, or
when too many came after it, and it never takes the place of one whose request had the token.
"""

from __future__ import annotations

import os
import socket
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from http.server import ThreadingHTTPServer
from typing import Any, Generic, TypeVar

MAX_UNAUTHENTICATED = 16
"""Connections at a time without the token."""
MAX_SILENCE = 5.0
"""[s] for a connection to show the token."""
BACKLOG = 128
"""Connections that may wait to be accepted; with few, a crowd delays the owner's by seconds."""

Connection = TypeVar("Connection")


class Unauthenticated(Generic[Connection]):
    """Connections without the token, the oldest first; ``close`` ends one. Any thread may call."""

    def __init__(self, close: Callable[[Connection], None]) -> None:
        self._close = close
        self._since: dict[Connection, float] = {}
        self._lock = threading.Lock()

    def add(self, connection: Connection) -> None:
        """Count a new connection, and close the oldest where there are too many."""
        with self._lock:
            self._since[connection] = time.monotonic()
        self._close_oldest(lambda _: len(self._since) > MAX_UNAUTHENTICATED)

    def discard(self, connection: Connection) -> None:
        """Count a connection no more: it has shown the token, or is closed."""
        with self._lock:
            self._since.pop(connection, None)

    def expire(self) -> None:
        """Close what has been silent for too long."""
        end = time.monotonic() - MAX_SILENCE
        self._close_oldest(lambda since: since <= end)

    def _close_oldest(self, is_due: Callable[[float], bool]) -> None:
        due: list[Connection] = []
        with self._lock:
            while self._since:
                oldest = next(iter(self._since))
                if not is_due(self._since[oldest]):
                    break
                due.append(oldest)
                del self._since[oldest]
        for connection in due:
            self._close(connection)


class LocalServer(ThreadingHTTPServer):
    """Python's HTTP server, a thread a connection; a handler calls ``authenticate`` once it saw the token."""

    daemon_threads = True
    request_queue_size = BACKLOG
    # On Windows this would let another program take the port that is listened on.
    allow_reuse_address = os.name == "posix"

    def __init__(self, address: tuple[str, int], handler: Any) -> None:
        self._unauthenticated = Unauthenticated(_shut_down)
        super().__init__(address, handler)

    def authenticate(self, connection: socket.socket) -> None:
        """Let a connection stay that has shown the token."""
        self._unauthenticated.discard(connection)

    def process_request(self, request: Any, client_address: Any) -> None:
        """Answer a new connection in a thread."""
        self._unauthenticated.add(request)
        super().process_request(request, client_address)

    def shutdown_request(self, request: Any) -> None:
        """Close a connection whose thread is done."""
        self._unauthenticated.discard(request)
        super().shutdown_request(request)

    def service_actions(self) -> None:
        """Close silent connections, in each turn of ``serve_forever``."""
        self._unauthenticated.expire()


def _shut_down(connection: socket.socket) -> None:
    """End a connection that its thread reads from, and closes then."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
