"""Serve pages on this machine: who may ask, how much and for how long, and what is answered where.

Any page open in a browser of this machine can send requests to a port of it, and a name that leads
elsewhere first and here later (DNS rebinding) passes for its own origin. So a server listens on 127.0.0.1
alone, every address holds a random token, and ``Host`` and ``Origin`` are looked at all the same (``Guard``).
All of that is checked before a request's body is read, and that is bounded.

Any process of the machine may connect and say nothing. Such a connection is closed after a while, or
when too many came after it, and it never takes the place of one whose request had the token
(``Unauthenticated``).

``LocalServer`` is Python's own server with both; the pages are a table of routes. The remote, which needs
WebSockets, has them in a server of its own.
"""

from __future__ import annotations

import hmac
import json
import os
import re
import secrets
import socket
import sys
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any, Generic, TypeVar
from urllib.parse import parse_qsl, urlsplit

from playground.errors import ParameterError, PlaygroundError

MAX_UNAUTHENTICATED = 16
"""Connections at a time without the token."""
MAX_SILENCE = 5.0
"""[s] for a connection to show the token."""
MAX_IDLE = 30.0
"""[s] that a connection which has shown the token may be silent."""
MAX_REQUESTS = 16
"""Requests that are answered at a time."""
BACKLOG = 128
"""Connections that may wait to be accepted; with few, a crowd delays the owner's by seconds."""
HEADERS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
"""Headers of every answer: the address is a secret, and no other page may show or read what is there."""

HTML, CSS, SCRIPT, TEXT = (f"text/{kind}; charset=utf-8" for kind in ("html", "css", "javascript", "plain"))
JSON, PNG = "application/json", "image/png"
_NAMES = ("127.0.0.1", "localhost")
_TOKEN = re.compile(r"[A-Za-z0-9_-]{16,128}")

Connection = TypeVar("Connection")


def new_token() -> str:
    """Return a random token."""
    return secrets.token_urlsafe(24)


def check_token(token: str) -> str:
    """Return a token of the user's own; raise ``ParameterError`` for one that is too short, or no word."""
    if not _TOKEN.fullmatch(token):
        raise ParameterError(
            "the remote's token has 16 to 128 letters, digits, - and _"
            f" (found {len(token)} characters); without one, a random one is made"
        )
    return token


@dataclass(frozen=True)
class Guard:
    """Decides who may ask: by the token in the address, this machine's ``Host`` and no foreign ``Origin``."""

    port: int
    token: str

    @property
    def url(self) -> str:
        """The address of the first page, with the token."""
        return f"http://127.0.0.1:{self.port}/{self.token}/"

    def refusal(self, host: str | None, origin: str | None, path: str) -> str:
        """Return why a request for a path is refused, in a message; "" for one that is not.

        ``host`` and ``origin`` are its headers.
        """
        hosts = {f"{name}:{self.port}" for name in _NAMES} | (set(_NAMES) if self.port == 80 else set())
        if (host or "").lower() not in hosts:
            return (
                "the request's Host is another: this page is only for its own machine, by the address that "
                "was printed"
            )
        if origin not in {None, *(f"http://{name}" for name in hosts)}:
            return "a page of another origin may not use this one"
        if not self.is_token(path.removeprefix("/").partition("/")[0]):
            return "the address lacks its token; use the one that was printed"
        return ""

    def is_token(self, text: str) -> bool:
        """Return whether a text is the token, in a time that says nothing about it."""
        return hmac.compare_digest(text.encode("utf-8", "surrogatepass"), self.token.encode())


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


@dataclass(frozen=True)
class Request:
    """What is asked, by who may ask."""

    path: str  # below the route: what follows "picture/"; "" where a route is one page
    query: Mapping[str, str]
    body: bytes = b""


@dataclass(frozen=True)
class Answer:
    """What a request is answered with."""

    status: int
    kind: str  # MIME type
    body: bytes
    policy: str = "default-src 'none'"  # Content-Security-Policy; no page may frame it in any case
    last: bool = False  # whether the server ends with it


Routes = Mapping[str, Callable[[Request], Answer]]
"""What answers, by method and path below the token: "GET state", "GET picture/" with all below it."""


def as_json(value: object, *, last: bool = False) -> Answer:
    """Return an answer with a value as JSON."""
    return Answer(200, JSON, json.dumps(value).encode(), last=last)


def refused(status: int, text: str) -> Answer:
    """Return an answer that says why there is no other."""
    return Answer(status, TEXT, f"{text}\n".encode())


class LocalServer(ThreadingHTTPServer):
    """Python's HTTP server on 127.0.0.1, a thread a connection, which answers by a table of routes.

    A route raises ``ParameterError`` or ``ValueError`` for what is asked wrongly (400), ``TimeoutError``
    where it takes too long (504), any other ``PlaygroundError`` for what else goes wrong (500). With a
    ``proof``, the name of a header, whatever changes something has to have the token there as well, which
    no foreign page can set. A request has at most ``max_bytes``. Raises ``OSError`` for a port that is taken.
    """

    daemon_threads = True
    request_queue_size = BACKLOG
    # On Windows this would let another program take the port that is listened on.
    allow_reuse_address = os.name == "posix"

    def __init__(self, routes: Routes, port: int = 0, *, max_bytes: int, proof: str = "") -> None:
        self.routes, self.max_bytes, self.proof = routes, max_bytes, proof
        self.room = threading.Semaphore(MAX_REQUESTS)
        self._unauthenticated = Unauthenticated(_shut_down)
        super().__init__(("127.0.0.1", port), _Handler)
        self.guard = Guard(self.server_address[1], new_token())

    def serve(self) -> None:
        """Answer requests until ``end``."""
        self.serve_forever(poll_interval=0.1)

    def end(self) -> None:
        """Stop ``serve``, once what is under way is answered."""
        threading.Thread(target=self.shutdown, daemon=True).start()

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
        """Close silent connections, in each turn of ``serve``."""
        self._unauthenticated.expire()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore a connection that broke: a browser's page was closed."""
        if not isinstance(sys.exc_info()[1], ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Sees that a request may be answered at all, and writes the answer."""

    server: LocalServer
    protocol_version = "HTTP/1.1"
    timeout = MAX_IDLE

    def do_GET(self) -> None:
        """Answer what changes nothing."""
        self._send(self._refusal() or self._answer(b""))

    def do_POST(self) -> None:
        """Answer what changes something."""
        if refusal := self._refusal() or self._too_long() or self._unproved():
            self.close_connection = True  # its body is not read
            self._send(refusal)
            return
        length = int(self.headers["Content-Length"])
        body = self.rfile.read(length)
        if len(body) < length:  # the client has gone
            self.close_connection = True
            return
        self._send(self._answer(body))

    def version_string(self) -> str:
        return "playground"

    def log_message(self, format: str, *args: object) -> None:
        """Log no request: the token would be in it."""

    def _refusal(self) -> Answer | None:
        """Refuse who may not ask."""
        host, origin = self.headers.get("Host"), self.headers.get("Origin")
        if why := self.server.guard.refusal(host, origin, self.path):
            return refused(403, why)
        self.server.authenticate(self.connection)
        return None

    def _unproved(self) -> Answer | None:
        """Refuse to change something for who does not give the token in a header."""
        proof = self.server.proof
        if proof and not self.server.guard.is_token(self.headers.get(proof, "")):
            return refused(403, "the request lacks its token")
        return None

    def _too_long(self) -> Answer | None:
        """Refuse a request whose body has no length, or is larger than any that the page sends."""
        length, most = self.headers.get("Content-Length", ""), self.server.max_bytes
        if len(length) > 9 or not length.isdecimal() or int(length) > most:
            return refused(413, f"expected a request of at most {most} bytes, with its length")
        return None

    def _answer(self, body: bytes) -> Answer:
        url = urlsplit(self.path)
        _, _, path = url.path.removeprefix("/").partition("/")
        folder, slash, rest = path.partition("/")
        route = self.server.routes.get(f"{self.command} {folder}{slash}")
        if route is None or "/" not in url.path[1:]:
            return refused(404, "there is no such page")
        if not self.server.room.acquire(blocking=False):
            return refused(503, "too many requests at a time")
        try:
            return route(Request(rest, dict(parse_qsl(url.query)), body))
        except TimeoutError as error:
            return refused(504, str(error))
        except (ParameterError, ValueError) as error:
            return refused(400, str(error))
        except PlaygroundError as error:
            return refused(500, str(error))
        finally:
            self.server.room.release()

    def _send(self, answer: Answer) -> None:
        self.send_response(answer.status)
        for name, value in {
            "Content-Type": answer.kind,
            "Content-Length": str(len(answer.body)),
            "Content-Security-Policy": f"{answer.policy}; frame-ancestors 'none'",
            **HEADERS,
        }.items():
            self.send_header(name, value)
        if self.close_connection or answer.last:
            self.send_header("Connection", "close")
        try:
            self.end_headers()
            self.wfile.write(answer.body)
            self.wfile.flush()
        finally:  # also where the client has gone
            if answer.last:
                self.server.end()


def _shut_down(connection: socket.socket) -> None:
    """End a connection that its thread reads from, and closes then."""
    with suppress(OSError):
        connection.shutdown(socket.SHUT_RDWR)
