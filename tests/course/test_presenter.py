"""A presentation without a window: Next and Back, what covers the screen, numbers, the clock."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from playground.course.talk import presenter as module
from playground.course.talk.beats import Beat
from playground.course.talk.presenter import TYPED, Presenter


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
