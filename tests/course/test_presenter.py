"""A presentation without a window: Next and Back, what covers the screen, numbers, the page of notes."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator, Mapping
from types import SimpleNamespace
from typing import Any

import pytest

from playground.course.talk import presenter as module
from playground.course.talk.beats import Beat
from playground.course.talk.notes import MAX_REQUEST_BYTES, Notes
from playground.course.talk.presenter import TYPED, Presenter
from playground.course.talk.stage import Presenting, Stage
from playground.course.window.figure_view import FigureView
from playground.errors import ParameterError

from ..guards import ask, assert_guarded


class Talk(Presenter):
    """A presentation of six beats on three pages, at a moment that the test sets."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self.pictures: list[int] = []
        self.ends: list[Beat] = []
        super().__init__(lambda beat: self.pictures.append(self.at), self.ends.append, lambda: self.seconds)


@pytest.fixture
def talk(monkeypatch: pytest.MonkeyPatch) -> Talk:
    beats = tuple(Beat("text", n // 2, "", sliders=("a.b", "a.c") if n == 1 else ()) for n in range(6))
    monkeypatch.setattr(module, "beats_of", lambda lesson: beats)
    made = Talk()
    lesson: Any = SimpleNamespace(name="a lesson")
    made.begin(lesson, page=1)
    return made


def test_it_begins_at_the_page_that_is_open_and_walks_its_beats(talk: Talk) -> None:
    assert (talk.at, talk.pictures) == (2, [2])
    talk.next()
    talk.back()
    talk.back()
    assert talk.pictures == [2, 3, 2, 1]
    talk.go(99)
    talk.next()
    assert talk.at == 5 and talk.following is None and talk.pictures[-1] == 5
    talk.go(0)
    talk.back()
    assert talk.at == 0 and talk.pictures == [2, 3, 2, 1, 5, 0], "at an end nothing is shown again"


def test_a_blank_screen_comes_back_before_the_next_beat(talk: Talk) -> None:
    talk.cover("black")
    talk.next()
    assert (talk.blank, talk.at) == ("", 2)
    talk.cover("black")
    talk.cover("white")
    assert talk.blank == "white"
    talk.cover("white")
    assert talk.blank == ""


@pytest.mark.parametrize("colour", ["black", "white"])
def test_escape_dismisses_overlays_one_by_one_then_leaves(talk: Talk, colour: str) -> None:
    talk.helps = True
    talk.type("4")
    talk.cover(colour)
    talk.escape()
    assert talk.on and (talk.blank, talk.helps, talk.typed) == ("", True, "4")
    talk.escape()
    assert talk.on and (talk.helps, talk.typed) == (False, "4")
    talk.escape()
    assert talk.on and talk.typed == ""
    talk.escape()
    assert not talk.on and [beat.page for beat in talk.ends] == [1]
    talk.escape()
    assert len(talk.ends) == 1, "it is left once"


def test_a_number_goes_to_its_beat_and_a_digit_chooses_a_slider(talk: Talk) -> None:
    talk.go(1)
    talk.type("2")
    assert talk.slider == 1
    assert talk.enter() == "" and talk.at == 1, "the second beat is on already"
    talk.type("6")
    assert talk.slider == 1, "there is no sixth slider"
    assert talk.enter() == "" and (talk.at, talk.slider) == (5, -1)
    talk.type("7")
    assert talk.enter() == "no_beat" and talk.at == 5
    assert talk.enter() == "" and talk.at == 5, "nothing was typed"
    talk.type("1")
    talk.seconds += TYPED + 1
    talk.type("2")
    assert talk.typed == "2", "a digit of long ago is forgotten"
    talk.seconds += TYPED + 1
    talk.forget_typed()
    assert talk.typed == ""


def test_the_clock_leaves_pauses_out(talk: Talk) -> None:
    talk.seconds = 10.0
    talk.clock.toggle()
    talk.seconds = 25.0
    assert talk.clock.elapsed == 10.0
    talk.clock.toggle()
    talk.seconds = 30.0
    assert talk.clock.elapsed == 15.0
    talk.clock.reset()
    talk.seconds = 31.0
    assert talk.clock.elapsed == 1.0


def test_strokes_belong_to_their_beat(talk: Talk) -> None:
    talk.toggle_laser()
    talk.toggle_pen()
    assert talk.pen and not talk.laser
    talk.press((0.1, 0.2))
    talk.draw((0.3, 0.2))
    talk.draw((0.3, 0.2))
    talk.next()
    talk.press((0.5, 0.5))
    assert talk.strokes == {2: [[(0.1, 0.2), (0.3, 0.2)]], 3: [[(0.5, 0.5)]]}
    talk.erase()
    assert list(talk.strokes) == [2]


# ── the page of notes ─────────────────────────────────────────────────────────


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


AREA = 0.0, 0.0, 320.0, 180.0


def test_beat_loads_sketch_after_text_and_skipped_beats_none(
    harness, monkeypatch: pytest.MonkeyPatch
) -> None:
    stage = Stage(harness.bench, harness.reader, lambda: None)
    assert harness.reader.open("halving", page=0, show=False)
    stage.begin(Presenting(notes=False))
    shown: list[str] = []
    monkeypatch.setattr(FigureView, "show", lambda view, scene, key, texts=None: shown.append(key[0]))

    def frame() -> bool:
        """Run a frame of the window; return whether it draws words alone."""
        turned = []
        harness.run_frames(1, around=lambda draw: turned.append((stage.act(AREA), stage.turned())[1]))
        return turned[0]

    frames = frame(), frame()
    assert frames == (True, False) and len(shown) == 1
    shown.clear()
    pictures = [
        n for n, beat in enumerate(stage.presenter.beats) if beat.kind in ("figure", "compare", "answer")
    ]
    stage.presenter.go(pictures[-2])
    stage.presenter.go(len(stage.presenter.beats) - 1)
    assert shown == [] and stage.patience == 0.0
    assert frame() and shown == [], "words"
    assert not frame() and shown == [stage.presenter.beat.still.block], "the picture, of the last beat alone"
    assert stage.patience > 0.0
