"""A lesson as beats: nothing is lost, nothing comes too early, nothing is too long for the last row."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import pytest

from playground.course.document import plain
from playground.course.library import LANGUAGES, labels
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
from playground.course.scenes import Sketches, excerpt
from playground.course.talk.beats import (
    BOARD_WORDS,
    BOTH,
    CODE_LINES,
    LETTERS,
    MAX_WORDS,
    MIN_SECONDS,
    Beat,
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
from playground.engine.engine import Engine

pytestmark = pytest.mark.slow


@cache
def presented(language: str) -> list[tuple[Lesson, tuple[Beat, ...]]]:
    sketches = Sketches()
    lessons = [read_lesson(summary.name, language, sketches) for summary in summaries()]
    return [(lesson, beats_of(lesson)) for lesson in lessons]


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


def test_the_beats_of_a_small_lesson(lesson: Lesson) -> None:
    beats = beats_of(lesson)
    kinds = [beat.kind for beat in beats]
    assert kinds[:4] == ["title", "text", "figure", "text"]
    assert [k for k, before in zip(kinds, [None, *kinds], strict=False) if k != before][3:10] == [
        "text", "step", "sweep", "compare", "code", "broken", "hint",
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


def test_words_are_counted_as_they_are_read() -> None:
    assert words("It is **two** or three.") == 5
    assert words("A [mean of four](term:mean) of $a + b + c$ texels") == 9
    assert words("`height.seed` is 3") == 3
    assert words("— … |---|") == 0


def test_beat_text_ends_at_sentence_within_word_limit() -> None:
    text = "One two three. Four five six. Seven eight."
    assert shown_of(text, 6) == "One two three. Four five six."
    assert shown_of(text, 2) == "One two three.", "one sentence at least"


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


def test_both_languages_have_every_label() -> None:
    for part in ("talk", "talk_keys"):
        assert len({frozenset(labels(part, language)) for language in LANGUAGES}) == 1
