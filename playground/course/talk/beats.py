"""A lesson as beats: what is on the screen between one press of Next and the following one.

A paragraph is one beat, and shows its first sentences; all of it is in the notes. A series is a beat
a step, a question three, a bug three; an exercise in the middle of the text two, since it goes on from
the solution, and one at the end one. Until a page's first picture is reached, that picture is
already shown, unless it answers something; where a page has none, the one before stays. The picture of
an exercise or a challenge is shown with it alone.
"""

from __future__ import annotations

from dataclasses import replace

from playground.course.language import labels
from playground.course.model import (
    Block,
    Lesson,
    Markdown,
    Prose,
    Slider,
)
from playground.course.talk.beat import Beat, Still
from playground.course.talk.block_beats import beats_of_block

_TASKS = ("exercise", "challenge")


def beats_of(lesson: Lesson) -> tuple[Beat, ...]:
    """Return the beats of a lesson, in its order; raise ``SketchError`` where code that it quotes is gone."""
    beats: list[Beat] = []
    shown: Still | None = None
    sliders: tuple[str, ...] = ()
    for page, section in enumerate(lesson.sections):
        mine: list[Beat] = []
        blocks = [b for b in section.blocks if not (isinstance(b, Prose) and b.kind == "heading")]
        if page == 0:
            mine.append(_title(lesson))
        at = 0
        while at < len(blocks):
            taken = _joined(blocks, at)
            for beat in beats_of_block(blocks[at], taken[0], lesson):
                mine.append(replace(beat, page=page, heading=section.title or lesson.title))
            at += taken[1]
        coming = next((beat for beat in mine if beat.still is not None), None)
        if coming is not None and coming.kind not in ("broken", "solution", *_TASKS):
            shown, sliders = coming.still, coming.sliders
        for beat in mine:
            own = beat.still is not None and beat.kind in _TASKS
            if beat.still is not None and not own:
                shown, sliders = beat.still, beat.sliders
            if beat.kind == "text" and beat.shown[:1].islower() and beats and beats[-1].formula:
                both = "\n\n".join(filter(None, [beats[-1].formula, beat.formula]))
                beat = replace(beat, formula=both)  # it goes on from that one
            if beat.kind == "code" and not beat.shown and beats[-1].page == page:
                beat = replace(beat, shown=beats[-1].shown)  # "This is the kernel:" stays
            beats.append(beat if own else replace(beat, still=shown, sliders=sliders))
            if beat.kind == "sweep" and shown is not None:
                shown = _at_end(lesson, shown)
    first = next((beat for beat in beats if beat.still is not None), None)
    if first is not None:  # the title of a lesson whose first page has no picture
        empty = {"still": first.still, "sliders": first.sliders}
        beats = [beat if beat.still is not None else replace(beat, **empty) for beat in beats]  # type: ignore[arg-type]
    return tuple(beats)


def _at_end(lesson: Lesson, still: Still) -> Still:
    """Return the picture that a sweep ends with."""
    block = lesson.named[still.block]
    return replace(still, index=len(block.scenes) - 1) if isinstance(block, Slider) else still


def first_of_page(beats: tuple[Beat, ...], page: int) -> int:
    """Return the index of a page's first beat, or of the last beat before the page where it has none."""
    return next((n for n, beat in enumerate(beats) if beat.page >= page), max(len(beats) - 1, 0))


def _title(lesson: Lesson) -> Beat:
    """Return the beat that a lesson begins with."""
    return Beat(
        "title", 0, lesson.title, labels("talk", lesson.language)["lesson"], lesson.goal, notes=lesson.goal
    )


def _joined(blocks: list[Block], at: int) -> tuple[Markdown, int]:
    """Return the formula that follows a paragraph, and how many blocks are taken together."""
    first, second = blocks[at], blocks[at + 1] if at + 1 < len(blocks) else None
    follows = isinstance(second, Prose) and second.kind == "formula"
    if follows and isinstance(first, Prose) and first.kind == "paragraph":
        return second.markdown, 2  # type: ignore[union-attr]
    return "", 1
