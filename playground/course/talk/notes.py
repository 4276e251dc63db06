"""Serve the teacher's notes of a presentation on 127.0.0.1: a page for another screen of this machine.

    GET  /TOKEN/          the page
    GET  /TOKEN/state     what is on, its notes, what comes next, the clock; ?since=N waits for news
    POST /TOKEN/do        {"go": "next"}, "back", "first", "last" or a number from 1;
                          {"cover": "black"}; {"clock": "pause"} or "reset"

Python's own server does: one reader asks now and then. Nothing here touches the session: what is asked is
done between two frames (see ``Calls``), and what the page receives was made by the window.
"""

from __future__ import annotations

import json
import threading
from collections.abc import Callable, Mapping
from functools import partial
from importlib.resources import files
from typing import Any

from playground.course.library import labels
from playground.course.talk.beats import Beat
from playground.course.talk.presenter import Presenter
from playground.errors import DataError
from playground.json_text import read_json
from playground.local_server import CSS, HTML, JSON, SCRIPT, Answer, LocalServer, Request, as_json, refused
from playground.studio.remote.controls import Busy, Calls

_LABELS = ("notes", "following", "over", "pause", "go_on", "reset", "back", "next", "black", "lost")


def notes_message(presenter: Presenter, beat: Beat, following: Beat | None, language: str) -> dict[str, Any]:
    """Return what is on, with the beat's and the next one's texts; numbers are in them already."""
    from playground.course.typeset import label_text

    clock, say = presenter.clock, labels("talk", language)
    return {
        "on": presenter.on,
        "language": language,
        "labels": {key: say[key] for key in _LABELS},
        "lesson": presenter.lesson.title if presenter.lesson else "",
        "at": presenter.at + 1,
        "count": len(presenter.beats),
        "heading": label_text(beat.heading),
        "label": beat.label,
        "notes": html_of(beat),
        "aside": _html(beat.aside),
        "coming": _coming(following),
        "blank": presenter.blank,
        "elapsed": round(clock.elapsed, 1),
        "running": clock.running,
    }


def html_of(beat: Beat) -> str:
    """Return all that is notified of a beat, and what stands over its picture, as HTML."""
    parts = []
    if beat.choices and beat.board:
        parts.append(_html(beat.board))
    parts.append(_html(beat.notes or beat.shown))
    if beat.code is not None:
        from playground.course.book.html import code_block

        parts.append(str(code_block(beat.code.text, beat.code.file or "code")))
    return "".join(parts)


def _coming(beat: Beat | None) -> str:
    if beat is None:
        return ""
    label = f"**{beat.label}.** " if beat.label else ""
    file = beat.code.file if beat.code is not None else ""
    return _html(f"{label}{beat.shown or beat.board or file}")


def _html(words: str) -> str:
    from playground.course.book.html import prose

    return str(prose(words, lambda to: {"class": "term"})) if words else ""


MAX_REQUEST_BYTES = 2**12
"""[bytes] of what a page may send."""
WAITS = 10.0
"""[s] that a request for news waits."""
_PATIENCE = 5.0  # [s] for the window to do what is asked
_FILES = {"": ("notes.html", HTML), "notes.css": ("notes.css", CSS), "notes.js": ("notes.js", SCRIPT)}
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; base-uri 'none'; "
    "form-action 'none'"
)

Act = Callable[[Mapping[str, Any]], None]
"""Does what a page asks for; raises ``ParameterError`` in a sentence."""


class Notes:
    """The page of one presentation; ``act`` is called by ``take``, in the thread that draws."""

    def __init__(self, act: Act, wake: Callable[[], None] = lambda: None, port: int = 0) -> None:
        """Listen on 127.0.0.1, on a free port where it is 0; raise ``DataError`` where that fails."""
        self.calls = Calls(wake)
        self.act = act
        self._news = threading.Condition()
        self._text, self._count, self._closed = b"{}", 0, False
        routes = {f"GET {name}": partial(_file, *file) for name, file in _FILES.items()}
        try:
            self.server = LocalServer(
                {**routes, "GET state": self._state, "POST do": self._do}, port, max_bytes=MAX_REQUEST_BYTES
            )
        except OSError as error:
            raise DataError(f"notes cannot be served: {error.strerror or error}") from None
        self._thread = threading.Thread(target=self.server.serve, daemon=True)
        self._thread.start()

    @property
    def url(self) -> str:
        """The address of the page, with the token."""
        return self.server.guard.url

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

    def close(self) -> None:
        """Close the port, and refuse what waits."""
        self.calls.close()
        with self._news:
            self._closed = True
            self._news.notify_all()
        self.server.shutdown()
        self.server.server_close()
        self._thread.join(5)

    def _state(self, request: Request) -> Answer:
        """Answer with what is on and its number; wait a while for one after ``since``."""
        text = request.query.get("since", "")
        since = int(text) if text.isdecimal() else -1
        with self._news:
            self._news.wait_for(lambda: self._count != since or self._closed, WAITS)
            return Answer(200, JSON, b'{"number": %d, "state": %s}' % (self._count, self._text))

    def _do(self, request: Request) -> Answer:
        wishes = read_json(request.body)
        if not isinstance(wishes, dict):
            raise ValueError('expected a JSON object, as {"go": "next"}')
        try:
            self.calls.ask(lambda: self.act(wishes)).result(_PATIENCE)
        except Busy as error:
            return refused(503, str(error))
        except TimeoutError:
            raise TimeoutError(f"the window has not answered for {_PATIENCE:g} s") from None
        return as_json({})


def _file(name: str, kind: str, request: Request) -> Answer:
    return Answer(200, kind, files("playground.course.talk").joinpath(name).read_bytes(), _POLICY)
