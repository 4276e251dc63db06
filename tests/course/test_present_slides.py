"""What is written of a beat: large enough for the last row, and inside of its room, in every lesson."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from playground.course.library import LANGUAGES
from playground.course.read import read_lesson, summaries
from playground.course.scenes import Sketches
from playground.course.talk.beats import Beat, Listing, beats_of
from playground.course.talk.presenter import Row
from playground.course.talk.slide import (
    MIN_LETTER_HEIGHT,
    Face,
    Sizes,
    board_of,
    board_text,
    body_of,
    body_room,
    code_size,
    gauges_of,
    strip_of,
)
from playground.sketch.assign import resolve
from playground.sketch.load import load

FULL_HD = Sizes(1920, 1080)


@cache
def beats(language: str) -> list[tuple[str, Beat]]:
    sketches = Sketches()
    lessons = [read_lesson(summary.name, language, sketches) for summary in summaries()]
    return [(lesson.name, beat) for lesson in lessons for beat in beats_of(lesson)]


@pytest.mark.slow  # some thousand texts are laid out
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_beat_of_every_lesson_fits_in_large_letters(language: str) -> None:
    wide, high = body_room(FULL_HD)
    for name, beat in beats(language):
        where = f"{name}: {beat.kind}: {beat.shown or beat.board}"
        body = body_of(beat, FULL_HD)
        if body is not None:
            assert body.size >= MIN_LETTER_HEIGHT and body.height <= high and body.width <= wide + 1, where
        if beat.code is not None:
            assert code_size(beat.code, FULL_HD) >= MIN_LETTER_HEIGHT, where
        elif beat.has_board:
            board = board_text(beat, FULL_HD)
            assert board.size >= MIN_LETTER_HEIGHT and board.height <= FULL_HD.picture[1], where
            assert board.width <= FULL_HD.width, where


@pytest.mark.parametrize("size", [(1920, 1080), (1280, 720), (1024, 768), (3840, 2160)])
def test_letters_grow_with_the_screen(size: tuple[int, int]) -> None:
    sizes = Sizes(*size)
    beat = Beat("text", 0, "A heading", "Hint", "Some words that are read.")
    body = body_of(beat, sizes)
    assert body is not None and body.size >= MIN_LETTER_HEIGHT * min(size[0] / 1920, size[1] / 1080)
    strip = strip_of(beat, (3, 12), sizes)
    assert strip.size == (size[0], sizes.strip)
    assert sizes.strip + sizes.picture[1] == size[1]
    bright = np.asarray(strip.convert("L")) > 160
    assert bright.any(axis=0)[: size[0] // 2].any(), "its words"
    assert bright[:, int(size[0] * 0.9) :].any(), "which beat it is"


def test_code_of_a_hundred_columns_is_whole_at_its_full_width() -> None:
    line = "vec3 " + "a" * 94 + ";"
    code = Listing("\n".join([line] * 20), "x.glsl", 101)
    beat = Beat("code", 0, "", code=code)
    size = code_size(code, FULL_HD)
    assert size >= MIN_LETTER_HEIGHT
    image = board_of(beat, FULL_HD)
    assert image is not None
    ink = np.asarray(image.convert("L")) > 70
    columns, rows = np.flatnonzero(ink.any(axis=0)), np.flatnonzero(ink.any(axis=1))
    assert columns[0] > 20 and columns[-1] < 1900 and rows[0] > 5 and rows[-1] < FULL_HD.picture[1] - 5
    assert columns[-1] - columns[0] > 99 * Face("code", size).width("m") * 0.95


def test_the_right_choice_is_marked_in_the_answer_only() -> None:
    asks = Beat("choices", 0, "", board="Which?", choices=("One", "Two"))
    answers = replace(asks, right=1)
    before, after = board_of(asks, FULL_HD), board_of(answers, FULL_HD)
    assert before is not None and after is not None
    assert np.asarray(after.convert("L"), int).sum() != np.asarray(before.convert("L"), int).sum()
    first = replace(asks, right=0)
    other = board_of(first, FULL_HD)
    assert other is not None and other.tobytes() != after.tobytes()


def test_a_gauge_shows_where_its_value_is() -> None:
    parameter = resolve(load("diamond_square_steps").graph, "height.smoothing")[0].parameter

    def right_end(share: float) -> int:
        image = gauges_of([Row("a.height", "Height", parameter, share)], 0, FULL_HD)
        assert image is not None
        bar = np.asarray(image.convert("L"), int)[image.height // 2, :280]  # without the name
        return int(np.flatnonzero(bar > 150)[-1])

    ends = [right_end(share) for share in (0.0, 0.5, 1.0)]
    assert ends[1] - ends[0] == pytest.approx(ends[2] - ends[1], abs=3) and ends[2] - ends[0] > 100


def test_letters_that_the_font_lacks_come_from_another() -> None:
    pieces = list(Face("text", 40.0).pieces("a→b"))
    assert [text for _, text in pieces] == ["a", "→", "b"]
    assert pieces[0][0] is not pieces[1][0]
