"""The page of a presentation's notes: who may ask, what it is told, what it does."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from playground.course.talk.notes import MAX_REQUEST_BYTES, Notes
from playground.errors import ParameterError

from ..guards import ask, assert_guarded


class Window:
    """A window that does what is asked, in a thread of its own."""

    def __init__(self) -> None:
        self.asked: list[dict[str, Any]] = []
        self.notes = Notes(self.act)
        self.open = True
        self.thread = threading.Thread(target=self.run)
        self.thread.start()

    def act(self, wishes: Mapping[str, Any]) -> None:
        if "go" not in wishes:
            raise ParameterError("go where?")
        self.asked.append(dict(wishes))
        self.notes.tell({"at": len(self.asked)})

    def run(self) -> None:
        while self.open:
            self.notes.take()
            time.sleep(0.005)

    def ask(self, path: str, method: str = "GET", body: bytes = b"") -> tuple[int, Any]:
        status, text, headers = ask(self.notes.server, method, path, body or None)
        return status, json.loads(text) if "json" in headers["Content-Type"] else text

    def close(self) -> None:
        self.open = False
        self.thread.join()
        self.notes.close()


@pytest.fixture
def window() -> Iterator[Window]:
    made = Window()
    yield made
    made.close()


def test_the_page_drives_the_window_and_hears_of_it(window: Window) -> None:
    window.notes.tell({"at": 0})
    status, page = window.ask("")
    assert status == 200 and 'src="notes.js"' in page
    assert "EventSource" not in page and window.ask("notes.js")[0] == window.ask("notes.css")[0] == 200
    first = window.ask("state")[1]
    assert first["state"] == {"at": 0}
    waiting: list[Any] = []
    late = threading.Thread(target=lambda: waiting.append(window.ask(f"state?since={first['number']}")))
    late.start()
    assert window.ask("do", "POST", b'{"go": "next"}') == (200, {})
    late.join(20)
    assert waiting[0][1]["state"] == {"at": 1} and window.asked == [{"go": "next"}]


def test_a_mistake_is_answered_with_a_sentence(window: Window) -> None:
    assert window.ask("do", "POST", b'{"stay": 1}') == (400, "go where?\n")
    assert window.ask("do", "POST", b"[1]")[0] == 400
    assert window.ask("do", "POST", b"not JSON")[0] == 400
    assert window.ask("do", "POST", b" " * (MAX_REQUEST_BYTES + 1))[0] == 413
    assert window.ask("../../etc/passwd")[0] == 404
    assert window.ask("notes.html")[0] == 404
    assert window.asked == []


def test_nobody_else_reads_or_drives(window: Window) -> None:
    assert_guarded(window.notes.server)
    assert window.asked == []


def test_it_is_at_this_machine_alone(window: Window) -> None:
    assert window.notes.url.startswith(
        f"http://127.0.0.1:{window.notes.server.guard.port}/{window.notes.server.guard.token}"
    )
    assert window.notes.server.server_address[0] == "127.0.0.1"
