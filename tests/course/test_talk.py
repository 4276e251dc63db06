"""A lesson as beats, slides and a film: nothing is lost, nothing comes too early, all of it can be read."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from functools import cache
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from playground.cli import main
from playground.course.document import plain
from playground.course.library import LANGUAGES
from playground.course.model import (
    Break,
    Challenge,
    Code,
    Compare,
    Exercise,
    Figure,
    Lesson,
    Prose,
    Question,
    Slider,
    Steps,
)
from playground.course.read import read_lesson, summaries
from playground.course.scenes import BOTH, Sketches, excerpt
from playground.course.talk.beats import (
    BOARD_WORDS,
    CODE_LINES,
    LETTERS,
    MAX_WORDS,
    MIN_SECONDS,
    Beat,
    Listing,
    Still,
    beats_of,
    cues_of,
    first_of_page,
    plain_formula,
    scene_of,
    seconds_of,
    sentences,
    shown_of,
    srt,
    words,
)
from playground.course.talk.film import FPS, film_of, write_presentation
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
from playground.engine.engine import Engine
from playground.sketch.assign import resolve
from playground.sketch.load import load

from .lesson_desk import shelved


@cache
def presented(language: str) -> list[tuple[Lesson, tuple[Beat, ...]]]:
    sketches = Sketches()
    lessons = [read_lesson(summary.name, language, sketches) for summary in summaries()]
    return [(lesson, beats_of(lesson)) for lesson in lessons]


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_lesson_is_told_whole_and_in_its_order(language: str) -> None:
    for lesson, beats in presented(language):
        assert beats[0].kind == "title"
        assert [beat.page for beat in beats] == sorted(beat.page for beat in beats), lesson.name
        assert {beat.page for beat in beats} == {
            page for page, section in enumerate(lesson.sections) if page == 0 or _tells(section.blocks)
        }, lesson.name
        text = "\n".join(beat.notes for beat in beats)
        at = 0
        for block in lesson.blocks:
            if isinstance(block, Prose) and block.kind in ("paragraph", "formula"):
                result = text.find(block.markdown, at)
                assert result >= 0, f"{lesson.name}: {block.markdown}"
                at = result
        shown = [(beat.still.block, beat.still.index, beat.still.broken) for beat in beats if beat.still]
        for block in lesson.blocks:
            for picture in _pictures(block):
                assert picture in shown, f"{lesson.name}: {picture}"


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_no_beat_has_more_to_read_than_a_class_can(language: str) -> None:
    for lesson, beats in presented(language):
        for beat in beats:
            where = f"{lesson.name}: {beat}"
            text = beat.shown.split("\n\n")[0]
            assert words(text) <= MAX_WORDS or len(sentences(text)) == 1, where
            assert beat.code is None or beat.code.text.count("\n") < CODE_LINES, where
            items = beat.board.count("\n") + 1 if beat.board.lstrip()[:1] in "-*|" else 1
            assert words(beat.board) <= BOARD_WORDS or items == 1, where
            assert beat.shown or beat.has_board, where


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_answers_and_fixes_come_after_what_asks_for_them(language: str) -> None:
    for lesson, beats in presented(language):
        for block in lesson.blocks:
            if isinstance(block, Question):
                early, late = block.ask, block.answer
            elif isinstance(block, Break):
                early, late = block.hint, block.fix
            elif isinstance(block, Exercise) and any(beat.notes == block.solution for beat in beats):
                early, late = block.ask, block.solution
                until = next(beat for beat in beats if beat.notes == early)
                ahead = beats[: beats.index(until) + 1]
                stills = [beat.still for beat in ahead if beat.still is not None]
                assert all(still.block != block.name or still.started for still in stills), block.name
            else:
                continue
            first = next(n for n, beat in enumerate(beats) if early in (beat.notes, beat.board))
            last = next(n for n, beat in enumerate(beats) if late == beat.notes)
            assert first < last
            for beat in beats[:last]:
                assert late not in beat.notes + beat.shown + beat.board, block.name
                assert beat.right < 0 or beat.board != early, block.name
        for block in lesson.blocks:
            if isinstance(block, Code):
                parts = [beat.code.text for beat in beats if beat.code and beat.code.file == block.file]
                assert excerpt(block.file, block.anchor).text in "\n".join(parts), block.name


@pytest.mark.slow
@pytest.mark.parametrize("language", LANGUAGES)
def test_an_exercise_shows_its_own_picture_or_no_other_task_s(language: str) -> None:
    for lesson, beats in presented(language):
        tasks = [block for block in lesson.blocks if isinstance(block, Exercise | Challenge)]
        for task in tasks:
            (asked,) = (b for b in beats if b.kind in ("exercise", "challenge") and b.notes == task.ask)
            still = asked.still
            if isinstance(task, Exercise) and task.begin is None:
                others = {other.name for other in tasks} - {task.name}
                assert still is None or still.block not in others or not still.started, task.name
            else:
                assert still == Still(task.name, started=isinstance(task, Exercise)), task.name
                assert asked.sliders == (() if task.file or isinstance(task, Challenge) else task.sliders)


@pytest.mark.slow
def test_an_exercise_shows_what_a_student_begins_from(any_engine: Engine) -> None:
    lesson = read_lesson("first_height")
    for started, height in ((True, 0.0), (False, 0.5)):  # empty.glsl returns 0, the solution 0.5
        scene = scene_of(lesson, Still("constant", started=started))
        assert scene is not None
        heights = any_engine.read(scene.sketch.with_values({"size": 17}), "height")
        assert heights.min() == heights.max() == height


def _tells(blocks: tuple[object, ...]) -> bool:
    silent = [not getattr(b, "sentence", True) for b in blocks]
    return not all(
        quiet or (isinstance(b, Prose) and b.kind == "heading")
        for b, quiet in zip(blocks, silent, strict=True)
    )


def _pictures(block: object) -> list[tuple[str, int, bool]]:
    if isinstance(block, Figure):
        return [(block.name, 0, False)]
    if isinstance(block, Steps):
        return [(block.name, n, False) for n in range(len(block.scenes))]
    if isinstance(block, Slider):
        return [(block.name, 0, False)]
    if isinstance(block, Break):
        return [(block.name, 1, True), (block.name, 0, False)]
    return []


@pytest.mark.slow
def test_the_beats_of_a_small_lesson(lesson: Lesson) -> None:
    beats = beats_of(lesson)
    kinds = [beat.kind for beat in beats]
    assert kinds[:4] == ["title", "text", "figure", "text"]
    assert [k for k, before in zip(kinds, [None, *kinds], strict=False) if k != before][3:13] == [
        "text", "step", "sweep", "compare", "code", "board", "question", "answer", "broken", "hint",
    ]  # fmt: skip
    title, text = beats[0], beats[1]
    assert title.still == text.still and title.still is not None and title.still.block == "land", "ahead"
    assert beats[3].still is not None and beats[3].still.block == "turns", (
        "a page begins with its own picture"
    )
    two = next(beat for beat in beats if beat.kind == "compare")
    assert two.still is not None and two.still.index == BOTH and two.names == ("even", "uneven")
    assert next(beat for beat in beats if beat.kind == "sweep").sliders == ("height.smoothing",)
    assert first_of_page(beats, 1) == 3 and first_of_page(beats, 99) == len(beats) - 1
    named = {block.name for block in lesson.blocks if isinstance(block, Compare | Slider | Steps)}
    assert named <= {beat.still.block for beat in beats if beat.still}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("One. Two is here! And three?", 3),
        ("It is 1.5 m high. So be it.", 2),
        ("See `a. B` and $x. Y$ there. Then [a. B](term:x).", 2),
        ("Il dit « Oui. Non. » et part. Puis il revient.", 2),
        ("The side is **a. B** long.", 1),
        ("C’est vrai\u00a0! Élevez-le.", 2),
    ],
)
def test_sentences_end_where_a_reader_pauses(text: str, count: int) -> None:
    result = sentences(text)
    assert len(result) == count
    assert " ".join(result) == text


@pytest.mark.slow
def test_words_are_counted_as_they_are_read() -> None:
    assert words("It is **two** or three.") == 5
    assert words("A [mean of four](term:mean) of $a + b + c$ texels") == 9
    assert words("`height.seed` is 3") == 3
    assert words("— … |---|") == 0


@pytest.mark.slow
def test_beat_text_ends_at_sentence_within_word_limit() -> None:
    text = "One two three. Four five six. Seven eight."
    assert shown_of(text, 6) == "One two three. Four five six."
    assert shown_of(text, 2) == "One two three.", "one sentence at least"


@pytest.mark.slow
def test_subtitles_say_the_notes_over_the_whole_beat() -> None:
    text = (
        "A [texel](term:texel) has $\\frac{a}{b}$ of it. " + "Here the words go on and on, " * 12 + "and end."
    )
    beat = Beat("text", 0, "", shown="A", notes=text)
    seconds = seconds_of(beat)
    assert seconds == pytest.approx(words(text) * 60 / 200)
    cues = cues_of(beat, 7.0, seconds)
    assert cues[0].begin == 7.0 and cues[-1].end == pytest.approx(7.0 + seconds)
    assert all(first.end == other.begin for first, other in pairwise(cues))
    lines = [line for cue in cues for line in cue.text.split("\n")]
    assert max(map(len, lines)) <= LETTERS and all(cue.text.count("\n") < 2 for cue in cues)
    assert " ".join(lines) == plain(text, plain_formula)
    assert lines[0].startswith("A texel has a/b of it.")
    assert srt(cues).startswith("1\n00:00:07,000 --> 00:00:")
    assert seconds_of(Beat("text", 0, "", shown="Short.")) == MIN_SECONDS


# ── slides ────────────────────────────────────────────────────────────────────


FULL_HD = Sizes(1920, 1080)


@cache
def all_beats(language: str) -> list[tuple[str, Beat]]:
    sketches = Sketches()
    lessons = [read_lesson(summary.name, language, sketches) for summary in summaries()]
    return [(lesson.name, beat) for lesson in lessons for beat in beats_of(lesson)]


@pytest.mark.slow  # some thousand texts are laid out
@pytest.mark.parametrize("language", LANGUAGES)
def test_every_beat_of_every_lesson_fits_in_large_letters(language: str) -> None:
    wide, high = body_room(FULL_HD)
    for name, beat in all_beats(language):
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


# ── film ──────────────────────────────────────────────────────────────────────


SIZE = 192, 108


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shelved(monkeypatch, tmp_path)
    return tmp_path


@pytest.mark.slow
def test_a_lesson_is_filmed_with_its_notes_as_subtitles(folder: Path, any_engine: Engine) -> None:
    av = pytest.importorskip("av")
    film = film_of(read_lesson("halving", "fr"), folder / "talk.mp4", SIZE)
    video, subtitles = write_presentation(any_engine, film)
    with av.open(str(video)) as container:
        stream = container.streams.video[0]
        pictures = [frame.to_ndarray(format="rgb24") for frame in container.decode(stream)]
        assert stream.average_rate == FPS
    assert len(pictures) == sum(film.counts)
    starts = np.cumsum([0, *film.counts])
    for beat, count in zip(film.beats, film.counts, strict=True):
        assert count >= round(seconds_of(beat) * FPS) and count >= 3 * FPS
    edge = film.sizes.picture[1]

    def change(one: int, other: int, *, strip: bool) -> float:
        pair = [
            pictures[n].astype(int)[edge + 4 :] if strip else pictures[n].astype(int)[:edge]
            for n in (one, other)
        ]
        return float(np.abs(pair[0] - pair[1]).mean())

    sweep = next(n for n, beat in enumerate(film.beats) if beat.kind == "sweep")
    first, last = starts[sweep], starts[sweep + 1] - 1
    assert change(first, last, strip=False) > 2, "the value moves"
    assert change(first, last, strip=True) < 1, "its strip stays"
    assert change(last, starts[sweep + 1], strip=True) > 1, "another beat says something else"
    bug = next(n for n, beat in enumerate(film.beats) if beat.kind == "fix")
    assert change(starts[bug] - 1, starts[bug], strip=False) > 1, "the fixed picture is another"
    text = subtitles.read_text("utf-8")
    assert subtitles.name == "talk.srt" and "Une moyenne divise par leur nombre." in text
    assert "{{" not in text and text.index("Quatre coins") < text.index("Rugosité.")
    end = text.rstrip().rsplit("-->", 1)[1].split()[0]
    hours, minutes, seconds = end.replace(",", ".").split(":")
    assert int(hours) * 3600 + int(minutes) * 60 + float(seconds) == pytest.approx(film.seconds, abs=0.002)
    assert Fraction(len(pictures)) / FPS == Fraction(film.seconds).limit_denominator(100)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("halvin",), "no lesson 'halvin'; did you mean 'halving'?"),
        (("halving", "--from", "99"), "--from 99: lesson halving has beats 1 to "),
        (("halving", "--lang", "frr"), "--lang frr: no such language; did you mean 'fr'?"),
        (("halving", "--video", "talk.mov"), "a video is written to a name ending in .mp4"),
        (("halving", "--video", "talk.mp4", "--size", "161x90"), "both must be even"),
    ],
)
def test_a_mistake_is_a_sentence(
    folder: Path, capsys: pytest.CaptureFixture[str], arguments: tuple[str, ...], words: str
) -> None:
    assert main(["lesson", "present", *arguments]) == 2
    error = capsys.readouterr().err
    assert words in error and "Traceback" not in error
