"""Serve the page of results on this machine, with buttons that accept pictures and undo that.

Anyone who can send a request to the port could change references, and any page open in the
same browser can send one. So:

* it listens on 127.0.0.1 alone;
* the address holds a random token, which every request has to have, in its path; one that
  changes something has it in a header too, which no foreign page can set;
* the ``Host`` has to be 127.0.0.1 or localhost, with the port: a foreign name that was made
  to lead here (DNS rebinding) is turned away, and so is a foreign ``Origin``;
* only the few paths below are known, and no part of one becomes the name of a file: a
  picture is looked up among those that the records name;
* all this is looked at before a request's body is read, and that is bounded;
* the page's policy lets nothing run, and nothing be fetched, but its own.

A request names the result it means by its stamp. Where the tests have run again since, or a
reference has changed, it is refused in words; all changes are made one after the other.
"""

from __future__ import annotations

import hmac
import json
import secrets
import sys
import threading
from collections.abc import Callable
from dataclasses import dataclass, replace
from http.server import BaseHTTPRequestHandler
from pathlib import Path
from typing import Any
from urllib.parse import unquote

from playground.errors import DataError, PlaygroundError
from playground.json_text import read_json
from playground.local_server import LocalServer
from playground.shots.page.document import policy_of
from playground.shots.review_session import ReviewSession

MAX_REQUEST_BYTES = 2**20
"""[bytes] What a request may hold: the names of thousands of shots."""

_HTML, _JSON, _PNG, _TEXT = (
    "text/html; charset=utf-8",
    "application/json",
    "image/png",
    "text/plain; charset=utf-8",
)


@dataclass(frozen=True)
class Answer:
    """What a request is answered with."""

    status: int
    kind: str  # MIME type
    body: bytes
    last: bool = False  # whether the review ends with it


class Review:
    """The server of one review, until `end` is called or the page says so."""

    def __init__(self, folder: Path, port: int = 0) -> None:
        """Listen on 127.0.0.1; raise ``DataError`` for a folder without results, or a port that is taken."""
        self.session = ReviewSession(folder)
        self.token = secrets.token_urlsafe(24)
        review = self

        class Handler(_Handler):
            """Answers for this review."""

            served = review

        try:
            self._server = _Server(("127.0.0.1", port), Handler)
        except OSError as error:
            raise DataError(f"cannot listen on port {port}: {error.strerror}; try --port 0") from error
        self.port: int = self._server.server_address[1]

    @property
    def url(self) -> str:
        """The page's address, with the token."""
        return f"http://127.0.0.1:{self.port}/{self.token}/"

    def serve(self) -> None:
        """Answer requests until `end`."""
        self._server.serve_forever(poll_interval=0.1)

    def end(self) -> None:
        """Stop `serve`, once what is under way is answered."""
        threading.Thread(target=self._server.shutdown, daemon=True).start()

    def summary(self) -> list[str]:
        """Return what was accepted and not undone."""
        done = self.session.changes.values()
        written = [line for change in done if change.written for line in change.sentences]
        return written or ["nothing was accepted"]

    def __enter__(self) -> Review:
        return self

    def __exit__(self, *_: object) -> None:
        self._server.server_close()

    def get(self, path: str) -> Answer:
        """Answer a request for one of the known paths below the token."""
        if path == "":
            text = self.session.page()
            return Answer(200, _HTML, text.encode())
        if path == "state":
            return _json(self.session.state())
        if path.startswith("picture/"):
            data = self.session.picture(unquote(path.removeprefix("picture/")))
            if data is not None:
                return Answer(200, _PNG, data)
        return _refusal(404, "there is no such page")

    def post(self, path: str, body: bytes) -> Answer:
        """Answer a request that changes something."""
        if path == "done":
            return replace(_json({}), last=True)
        if path != "act":
            return _refusal(404, "there is no such page")
        try:
            request: Any = read_json(body)
            action = request["action"]
            shots = [(str(shot["name"]), str(shot["stamp"])) for shot in request["shots"]]
            if action not in ("accept", "also", "undo"):
                raise ValueError
        except (ValueError, TypeError, KeyError):
            return _refusal(400, "expected an action and its shots, as JSON")
        return _json(self.session.act(action, shots))


class _Server(LocalServer):
    def handle_error(self, request: Any, client_address: Any) -> None:
        """Ignore a connection that broke: a browser's page was closed."""
        if not isinstance(sys.exc_info()[1], ConnectionError | TimeoutError):
            super().handle_error(request, client_address)


class _Handler(BaseHTTPRequestHandler):
    """Sees that a request may be answered at all, and writes the answer."""

    served: Review
    server: _Server
    server_version = "playground"
    sys_version = ""
    protocol_version = "HTTP/1.1"
    timeout = 30  # [s] that a connection may keep silent

    def do_GET(self) -> None:
        """Answer the page, its state, a picture."""
        self._answer(self._refused() or self._tried(lambda path: self.served.get(path)))

    def do_POST(self) -> None:
        """Answer a request that changes something."""
        if refused := self._refused() or self._too_long() or self._foreign():
            self.close_connection = True  # its body is not read
            self._answer(refused)
            return
        length = int(self.headers["Content-Length"])
        body = self.rfile.read(length)
        if len(body) < length:  # the client has gone
            self.close_connection = True
            return
        self._answer(self._tried(lambda path: self.served.post(path, body)))

    def _refused(self) -> Answer | None:
        """Refuse a request with a foreign host, or without the token."""
        host = self.headers.get("Host", "").lower()
        if host not in self._hosts():
            return _refusal(403, "this page is only for its own machine, by the address that was printed")
        token = self.path.split("/")[1] if self.path.startswith("/") else ""
        if not self._is_token(token):
            return _refusal(403, "the address lacks its token; use the one that was printed")
        self.server.authenticate(self.connection)
        return None

    def _foreign(self) -> Answer | None:
        """Refuse a request to change something that no page of this server sent."""
        origin = self.headers.get("Origin")
        if origin is not None and origin not in {f"http://{host}" for host in self._hosts()}:
            return _refusal(403, "another page sent this")
        if not self._is_token(self.headers.get("X-Shots-Token", "")):
            return _refusal(403, "the request lacks its token")
        return None

    def _too_long(self) -> Answer | None:
        """Refuse a request whose body has no length, or is larger than any that the page sends."""
        length = self.headers.get("Content-Length", "")
        if len(length) > 9 or not length.isdecimal() or int(length) > MAX_REQUEST_BYTES:
            return _refusal(413, "expected a request of at most 1 MiB, with its length")
        return None

    def _hosts(self) -> set[str]:
        names = ("127.0.0.1", "localhost")
        port = self.served.port
        return {f"{name}:{port}" for name in names} | (set(names) if port == 80 else set())

    def _is_token(self, text: str) -> bool:
        return hmac.compare_digest(text.encode("utf-8", "replace"), self.served.token.encode())

    def _tried(self, answer: Callable[[str], Answer]) -> Answer:
        path = self.path.partition("?")[0].split("/", 2)
        try:
            return answer(path[2]) if len(path) == 3 else _refusal(404, "there is no such page")
        except PlaygroundError as error:
            return _refusal(500, str(error))

    def _answer(self, answer: Answer) -> None:
        self.send_response(answer.status)
        html = answer.kind == _HTML
        allowed = policy_of(self.served.session.setting) if html else "default-src 'none'"
        for name, value in {
            "Content-Type": answer.kind,
            "Content-Length": str(len(answer.body)),
            "Content-Security-Policy": f"{allowed}; frame-ancestors 'none'",
            "Cache-Control": "no-store",
            "Cross-Origin-Opener-Policy": "same-origin",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
            "X-Frame-Options": "DENY",
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
                self.served.end()

    def log_message(self, format: str, *args: object) -> None:
        """Log no request: the token would be in it."""


def _json(value: object) -> Answer:
    return Answer(200, _JSON, json.dumps(value).encode())


def _refusal(status: int, text: str) -> Answer:
    return Answer(status, _TEXT, f"{text}\n".encode())
