"""The beats of one block: a series is a beat a step, a question three, a bug three."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace

from playground.course.excerpt import excerpt
from playground.course.language import labels
from playground.course.model import (
    Block,
    Break,
    Challenge,
    Code,
    Compare,
    Exercise,
    Figure,
    Lesson,
    Markdown,
    Measure,
    Prose,
    Question,
    Slider,
    Steps,
)
from playground.course.scenes import comparable
from playground.course.talk.beat import BOTH, Beat, Listing, Still
from playground.course.talk.spoken import shown_of, words

CODE_LINES = 20
"""Lines of a shader that are shown at a time."""
BOARD_WORDS = 70
"""Words that are shown at a time over the whole picture: a list, choices and their answer."""

_ROWS = 9  # of a table


def beats_of_block(block: Block, formula: Markdown, lesson: Lesson) -> Iterator[Beat]:
    """Yield the beats of a block, each with a picture only where it brings one."""
    say = labels("talk", lesson.language)
    if isinstance(block, Prose):
        yield from _prose(block, formula)
    elif isinstance(block, Figure):
        still = Still(block.name) if block.scene else None
        yield _told("figure", block.caption, aside=block.alt, still=still, sliders=block.sliders)
    elif isinstance(block, Steps):
        yield from _steps(block, say["step"])
    elif isinstance(block, Slider):
        yield _told(
            "sweep", block.caption, aside=block.alt, still=Still(block.name), sliders=(block.parameter,)
        )
    elif isinstance(block, Compare):
        yield from _variants(block)
    elif isinstance(block, Code):
        yield from _code(block, say["part"])
    elif isinstance(block, Break):
        yield from _bug(block, lesson)
    elif isinstance(block, Question):
        yield from _question(block, lesson)
    elif isinstance(block, Exercise):
        aside = "\n\n".join(filter(None, [block.hint, f"**{say['solution']}.** {block.solution}"]))
        label = say["exercise"].format(lesson.number_of(block))
        still = Still(block.name, started=True) if block.begin is not None else None
        sliders = () if block.file else block.sliders
        yield _told("exercise", block.ask, label=label, aside=aside, still=still, sliders=sliders)
        if block.scene is not None and block not in lesson.sections[-1].blocks:  # the text goes on from it
            yield _told("solution", block.solution, label=say["solution"], still=Still(block.name))
    elif isinstance(block, Measure):
        if block.sentence:
            yield _told("text", block.sentence, label=say["measured"])
    elif isinstance(block, Challenge):
        yield _told("challenge", block.ask, label=say["challenge"], still=Still(block.name))


def _told(kind: str, text: Markdown, **more: object) -> Beat:
    """Return a beat that tells one text: its first sentences are shown, all of it is in the notes."""
    return Beat(kind, 0, "", shown=shown_of(text), notes=text, **more)  # type: ignore[arg-type]


def _prose(block: Prose, formula: Markdown) -> Iterator[Beat]:
    text = block.markdown
    if block.kind == "code":
        lines = [line for line in text.strip().split("\n") if not line.startswith("```")]
        for shared in _shared(lines):
            yield Beat("code", 0, "", code=Listing("\n".join(shared)))
    elif block.kind == "list":
        for part in _listed(text):
            yield Beat("board", 0, "", board=part, notes=part)
    elif block.kind == "table":
        head, rule, *rows = text.strip().split("\n")
        for at in range(0, len(rows), _ROWS):
            part = "\n".join([head, rule, *rows[at : at + _ROWS]])
            yield Beat("board", 0, "", board=part, notes=part)
    elif block.kind == "formula":
        yield Beat("text", 0, "", formula=text, notes=text)
    elif formula:
        yield replace(_told("text", text), formula=formula, notes=f"{text}\n\n{formula}")
    elif block.kind != "rule":
        yield _told("text", text.lstrip("> ") if block.kind == "quote" else text)


def _listed(text: Markdown) -> Iterator[Markdown]:
    """Yield the items of a list, as many at a time as a board has room for."""
    items: list[str] = []
    for line in text.strip().split("\n"):
        if items and line.startswith((" ", "\t")):
            items[-1] += f"\n{line}"
        else:
            items.append(line)
    part: list[str] = []
    for item in items:
        if part and words("\n".join([*part, item])) > BOARD_WORDS:
            yield "\n".join(part)
            part = []
        part.append(item)
    yield "\n".join(part)


def _steps(block: Steps, label: str) -> Iterator[Beat]:
    last = block.iterations[-1] if block.iterations else len(block.scenes)
    for index in range(len(block.scenes)):
        own = block.captions[index] if block.captions else ""
        whole = " ".join(filter(None, [own, block.caption if index == 0 else ""]))  # told once
        at = block.iterations[index] if block.iterations else index + 1
        yield Beat(
            "step",
            0,
            "",
            label.format(at, last),
            shown_of(own or block.caption),
            notes=whole,
            aside=block.alt if index == 0 else "",
            still=Still(block.name, index),
        )


def _variants(block: Compare) -> Iterator[Beat]:
    if len(block.scenes) == 2 and comparable(*block.scenes):
        still = Still(block.name, BOTH)
        yield _told("compare", block.caption, names=block.labels, aside=block.alt, still=still)
        return
    for index, name in enumerate(block.labels):
        aside = block.alt if index == 0 else ""
        still = Still(block.name, index)
        beat = _told("compare", block.caption, label=name, names=(name,), aside=aside, still=still)
        yield beat if index == 0 else replace(beat, notes=name)


def _code(block: Code, label: str) -> Iterator[Beat]:
    excerpt_text = excerpt(block.file, block.anchor)
    parts = _shared(excerpt_text.text.split("\n"))
    line = excerpt_text.line
    for number, part in enumerate(parts):
        name = excerpt_text.file
        if len(parts) > 1:
            name += f", {label.format(number + 1, len(parts))}"
        code = Listing("\n".join(part), excerpt_text.file, line)
        beat = _told("code", block.caption, label=name, code=code)
        line += len(part)
        yield beat if number == 0 else replace(beat, notes="")


def _shared(lines: list[str]) -> list[list[str]]:
    """Return lines of code in parts of about one length, each no longer than a board."""
    each = math.ceil(len(lines) / math.ceil(len(lines) / CODE_LINES))
    return [lines[at : at + each] for at in range(0, len(lines), each)]


def _bug(block: Break, lesson: Lesson) -> Iterator[Beat]:
    say = labels("talk", lesson.language)
    wrong, whole = Still(block.name, 1, broken=True), Still(block.name)
    later = f"**{say['hint']}.** {block.hint}\n\n**{say['fix']}.** {block.fix}"
    yield _told("broken", block.ask, label=say["broken"], aside=later, still=wrong)
    yield _told("hint", block.hint, label=say["hint"], aside=f"**{say['fix']}.** {block.fix}", still=wrong)
    yield _told("fix", block.fix, label=say["fix"], aside=block.caption, still=whole)


def _question(block: Question, lesson: Lesson) -> Iterator[Beat]:
    say = labels("talk", lesson.language)
    later = f"**{say['answer']}.** {block.answer}"
    yield _told("question", block.ask, label=say["question"], aside=later)
    if block.choices:
        lines = "\n".join(f"- {choice}" for choice in block.choices)
        choosing = Beat("choices", 0, "", say["choices"], board=block.ask, choices=block.choices)
        yield replace(choosing, shown="", notes=lines, aside=later)
        right = Beat("answer", 0, "", say["answer"], shown_of(block.answer), board=block.ask)
        yield replace(right, choices=block.choices, right=block.right, notes=block.answer)
    else:
        yield _told("answer", block.answer, label=say["answer"])
