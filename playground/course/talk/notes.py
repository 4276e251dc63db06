"""Serve the teacher's notes of a presentation on 127.0.0.1: a page for another screen of this machine.

    GET  /TOKEN/          the page
    GET  /TOKEN/state     what is on, its notes, what comes next, the clock; ?since=N waits for news
    POST /TOKEN/do        {"go": "next"}, "back", "first", "last" or a number from 1;
                          {"cover": "black"}; {"clock": "pause"} or "reset"

Python's own server does: one reader asks now and then. Nothing here touches the session: what is asked
is done between two frames (see ``calls``), and what is told was made by the window.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from http.server import BaseHTTPRequestHandler
from importlib.resources import files
from typing import Any
from urllib.parse import parse_qs, urlsplit

from playground.course.talk.beat import Beat
from playground.course.talk.presenter import Presenter
from playground.errors import DataError, ParameterError, PlaygroundError
from playground.json_text import read_json
from playground.local_server import LocalServer
from playground.remote.access import new_token, refusal
from playground.remote.calls import Busy, Calls

MAX_REQUEST_BYTES = 2**12
"""[bytes] of what a page may send."""
WAITS = 10.0
"""[s] that a request for news waits."""
_MAX_WAITING = 16  # requests at a time
_PATIENCE = 5.0  # [s] for the window to do what is asked

_FILES = {
    "": ("notes.html", "text/html"),
    "notes.css": ("notes.css", "text/css"),
    "notes.js": ("notes.js", "text/javascript"),
}
_HEADERS = {
    "Cache-Control": "no-store",
    "Content-Security-Policy": "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; "
    "base-uri 'none'; form-action 'none'; frame-ancestors 'none'",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
}

Act = Callable[[Mapping[str, Any]], None]
"""Does what a page asks for; raises ``PlaygroundError`` in a sentence."""


class Notes:
    """The page of one presentation; ``act`` is called by ``take``, in the thread that draws."""

    def __init__(self, act: Act, wake: Callable[[], None] = lambda: None, port: int = 0) -> None:
        """Listen on 127.0.0.1, on a free port where it is 0; raise ``DataError`` where that fails."""
        self.token = new_token()
        self.calls = Calls(wake)
        self.act = act
        self._news = threading.Condition()
        self._text, self._count, self._closed = b"{}", 0, False
        try:
            self._server = _Server(("127.0.0.1", port), self)
        except OSError as error:
            raise DataError(f"notes cannot be served: {error.strerror or error}") from None
        self.port: int = self._server.server_address[1]
        self._thread = threading.Thread(target=self._server.serve_forever, args=(0.1,), daemon=True)
        self._thread.start()

    @property
    def url(self) -> str:
        """The address of the page, with the token."""
        return f"http://127.0.0.1:{self.port}/{self.token}/"

    @property
    def waits(self) -> bool:
        """Whether something is asked that is not done."""
        return len(self.calls) > 0

    def take(self) -> None:
        """Do what was asked since the last frame."""
        self.calls.run()

    def tell(self, state: Mapping[str, Any]) -> None:
        """Say what is on; those who wait for news get it where it is another."""
        text = json.dumps(state).encode()
        with self._news:
            if text != self._text:
                self._text, self._count = text, self._count + 1
                self._news.notify_all()

    def state(self, since: int) -> bytes:
        """Return what is on as JSON, with its number; wait a while for one after ``since``."""
        with self._news:
            self._news.wait_for(lambda: self._count != since or self._closed, WAITS)
            return b'{"number": %d, "state": %s}' % (self._count, self._text)

    def close(self) -> None:
        """Close the port, and refuse what waits."""
        self.calls.close()
        with self._news:
            self._closed = True
            self._news.notify_all()
        self._server.shutdown()
        self._server.server_close()
        self._thread.join(5)


class _Server(LocalServer):
    def __init__(self, address: tuple[str, int], notes: Notes) -> None:
        self.notes = notes
        self.room = threading.Semaphore(_MAX_WAITING)
        super().__init__(address, _Handler)

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing: who asked is gone."""


class _Handler(BaseHTTPRequestHandler):
    server: _Server
    timeout = 30
    protocol_version = "HTTP/1.1"

    def do_GET(self) -> None:
        self._answer(self._get)

    def do_POST(self) -> None:
        self._answer(self._post)

    def log_message(self, format: str, *args: Any) -> None:
        """Write nothing to the terminal."""

    def version_string(self) -> str:
        return "playground"

    def _answer(self, make: Callable[[str], tuple[int, str, bytes]]) -> None:
        """Refuse who may not ask; else answer with what ``make`` returns: status, type and text."""
        notes = self.server.notes
        _, token, *rest = (*urlsplit(self.path).path.split("/", 2), "")
        host, origin = self.headers.get("Host"), self.headers.get("Origin")
        why = refusal(host, origin, token, token_expected=notes.token, port=notes.port)
        if why:
            self._send(403, "application/json", _error(why))
            return
        self.server.authenticate(self.connection)
        if not self.server.room.acquire(blocking=False):
            self._send(503, "application/json", _error("too many requests at a time"))
        else:
            try:
                response = make(rest[0])
            except (PlaygroundError, ValueError) as error:
                response = (503 if isinstance(error, Busy) else 400), "application/json", _error(str(error))
            except TimeoutError:
                response = 504, "application/json", _error(f"the window has not answered for {_PATIENCE:g} s")
            finally:
                self.server.room.release()
            self._send(*response)

    def _get(self, name: str) -> tuple[int, str, bytes]:
        if name == "state":
            since = parse_qs(urlsplit(self.path).query).get("since", ["-1"])[0]
            return 200, "application/json", self.server.notes.state(int(since) if since.isdecimal() else -1)
        if name not in _FILES:
            return 404, "application/json", _error("there is no such page")
        file, kind = _FILES[name]
        return 200, kind, files("playground.course.talk").joinpath(file).read_bytes()

    def _post(self, name: str) -> tuple[int, str, bytes]:
        length = self.headers.get("Content-Length", "")
        if name != "do" or not length.isdecimal() or int(length) > MAX_REQUEST_BYTES:
            self.close_connection = True  # what it sends is not read
            return 400, "application/json", _error(f"expected at most {MAX_REQUEST_BYTES} bytes for do")
        wishes = read_json(self.rfile.read(int(length)))
        if not isinstance(wishes, dict):
            raise ValueError('expected a JSON object, as {"go": "next"}')
        notes = self.server.notes
        notes.calls.ask(lambda: notes.act(wishes)).result(_PATIENCE)
        return 200, "application/json", b"{}"

    def _send(self, status: int, kind: str, text: bytes) -> None:
        self.send_response(status)
        self.send_header("Content-Type", f"{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(text)))
        for name, value in _HEADERS.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(text)


def _error(sentence: str) -> bytes:
    return json.dumps({"error": sentence}).encode()


EXPECTED = 'expected {"go": "next"}, {"cover": "black"} or {"clock": "pause"}'


class NotesLink:
    """The page of one window, once it is opened; ``filled`` puts numbers into a beat's texts."""

    def __init__(
        self, presenter: Presenter, filled: Callable[[Beat], Beat], wake: Callable[[], None]
    ) -> None:
        self.notes: Notes | None = None
        self._presenter = presenter
        self._filled = filled
        self._wake = wake
        self._told: object = None

    @property
    def url(self) -> str:
        """The page's address; "" while there is none."""
        return self.notes.url if self.notes is not None else ""

    @property
    def waits(self) -> bool:
        """Whether the page asks for something."""
        return self.notes is not None and self.notes.waits

    def open(self) -> str:
        """Serve the page; return why that cannot be done, or ""."""
        try:
            self.notes = self.notes or Notes(self._act, self._wake)
        except DataError as error:
            return str(error)
        return ""

    def take(self) -> None:
        """Do what the page asked for."""
        if self.notes is not None:
            self.notes.take()

    def tell(self, language: str) -> None:
        """Tell the page what is on, where that is new."""
        presenter = self._presenter
        if self.notes is None or presenter.lesson is None or not presenter.beats:
            return
        clock, beat = presenter.clock, self._filled(presenter.beat)
        coming = self._filled(presenter.following) if presenter.following is not None else None
        key = presenter.on, presenter.at, beat, presenter.blank, clock.running, clock.started_at
        if key != self._told:
            from playground.course.talk.told import notes_message

            self._told = key
            self.notes.tell(notes_message(presenter, beat, coming, language))

    def close(self) -> None:
        """Close the page's port."""
        if self.notes is not None:
            self.notes.close()
            self.notes = None

    def _act(self, wishes: Mapping[str, Any]) -> None:
        """Do what the page asks for; raise ``ParameterError`` for what nobody knows."""
        presenter = self._presenter
        if not presenter.on:
            raise ParameterError("the presentation is over")
        go, cover, clock = (wishes.get(key) for key in ("go", "cover", "clock"))
        steps = {"next": presenter.next, "back": presenter.back}
        ends = {"first": 0, "last": len(presenter.beats) - 1}
        if isinstance(go, str) and go in steps:
            steps[go]()
        elif isinstance(go, str) and go in ends:
            presenter.go(ends[go])
        elif type(go) is int:
            presenter.go(go - 1)
        elif cover in ("black", "white"):
            presenter.cover(str(cover))
        elif clock == "pause":
            presenter.clock.toggle()
        elif clock == "reset":
            presenter.clock.reset()
        else:
            raise ParameterError(EXPECTED)
