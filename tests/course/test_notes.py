"""The page of a presentation's notes: who may ask, what it is told, what it does."""

from __future__ import annotations

import http.client
import json
import threading
import time
from collections.abc import Iterator, Mapping
from typing import Any

import pytest

from playground import local_server
from playground.course.talk.notes import MAX_REQUEST_BYTES, Notes
from playground.errors import ParameterError

from ..crowds import crowd, wait_until_open


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

    def ask(
        self, path: str, method: str = "GET", body: bytes = b"", token: str = "", **headers: str
    ) -> tuple[int, Any]:
        connection = http.client.HTTPConnection("127.0.0.1", self.notes.port, timeout=20)
        address = f"/{token or self.notes.token}/{path}"
        connection.request(method, address, body or None, headers)
        answer = connection.getresponse()
        text = answer.read()
        kind = answer.headers["Content-Type"]
        connection.close()
        return answer.status, json.loads(text) if "json" in kind else text.decode()

    def close(self) -> None:
        self.open = False
        self.thread.join()
        self.notes.close()


@pytest.fixture
def window() -> Iterator[Window]:
    made = Window()
    yield made
    made.close()


def test_a_silent_crowd_is_bounded_and_closed(window: Window, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local_server, "MAX_SILENCE", 0.5)
    kept = http.client.HTTPConnection("127.0.0.1", window.notes.port, timeout=20)
    kept.request("GET", f"/{window.notes.token}/state")
    kept.getresponse().read()
    with crowd(window.notes.port) as strangers:
        assert window.ask("state")[0] == 200
        assert 0 < wait_until_open(strangers, local_server.MAX_UNAUTHENTICATED) <= 16
        assert wait_until_open(strangers, 0) == 0
    kept.request("GET", f"/{window.notes.token}/state")  # the same connection: it has shown the token
    assert kept.getresponse().status == 200
    kept.close()


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
    assert window.ask("do", "POST", b'{"stay": 1}') == (400, {"error": "go where?"})
    assert window.ask("do", "POST", b"[1]")[0] == 400
    assert window.ask("do", "POST", b"not JSON")[0] == 400
    assert window.ask("do", "POST", b" " * (MAX_REQUEST_BYTES + 1))[0] == 400
    assert window.ask("../../etc/passwd")[0] == 404
    assert window.ask("notes.html")[0] == 404
    assert window.asked == []


@pytest.mark.parametrize(
    "change",
    [
        {"token": "x" * 32},
        {"Host": "evil.example"},
        {"Host": "127.0.0.1:1"},
        {"Origin": "http://evil.example"},
        {"Origin": "null"},
    ],
)
def test_nobody_else_reads_or_drives(window: Window, change: dict[str, str]) -> None:
    for path, method, body in (("state", "GET", b""), ("do", "POST", b'{"go": "next"}'), ("", "GET", b"")):
        status, answer = window.ask(path, method, body, **change)
        assert status == 403 and "error" in answer
    assert window.asked == []


def test_it_is_at_this_machine_alone(window: Window) -> None:
    assert window.notes.url.startswith(f"http://127.0.0.1:{window.notes.port}/{window.notes.token}")
    assert window.notes._server.server_address[0] == "127.0.0.1"
