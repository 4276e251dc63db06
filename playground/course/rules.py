"""Check the rules of every lesson, so that all of them can be read the same way, and what they claim."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from latex2mathml.converter import convert

from playground.course import model
from playground.course.document import formulas, images, links
from playground.course.glossary import terms
from playground.course.library import lesson_files
from playground.course.measures import Number, measured, named_in
from playground.course.model import Challenge, Check, Exercise
from playground.course.scenes import broken, draw, excerpt
from playground.course.tasks import (
    Wanted,
    answer,
    answers,
    asks_number,
    compare,
    judge,
    scene_of,
    score,
    sentence_of,
    sentences,
    small,
    starter,
    tasks_of,
    wanted_scene,
)
from playground.course.traces import numbers_in, trace_of, traced
from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import PlaygroundError, nearest
from playground.sketch.find import shipped_sketches


def wrong_task(engine: Engine, task: Exercise | Challenge) -> Iterator[str]:
    """Yield a sentence for all that is wrong with a task; raise as ``Engine.render`` does.

    The model answer has all points, the starter passes no check, and a work that gives at hidden values
    what is asked for at the shown ones passes no hidden check.
    """
    if isinstance(task, Challenge):
        yield from _challenge(engine, task)
        return
    if not task.checks:
        return
    expected = answers(engine, task)
    good, bad = (judge(engine, task, work, expected) for work in (answer(task), starter(task)))
    if not good.passed:
        failures = [sentence_of(result, "en") for result in good.results if not result.passed]
        yield f"exercise '{task.name}': the model answer fails: {' '.join(failures or sentences(good, 'en'))}"
    for number, (check, expected_result) in enumerate(zip(task.checks, expected, strict=True), start=1):
        which = f"exercise '{task.name}': check {number}"
        if bad.results and bad.results[number - 1].passed:
            yield f"{which}: the starter passes it already"
        if expected_result.texture is not None and not np.isfinite(expected_result.texture).all():
            yield f"{which}: the model answer's '{check.of}' has values that are not finite"
        if check.hidden and check.measure is None and _is_frozen(engine, task, check, expected_result):
            yield f"{which}: at its values all is as at those that are shown; give others in at"


def _is_frozen(engine: Engine, task: Exercise, check: Check, expected: Wanted) -> bool:
    """Whether a work that takes no notice of the values of a check would pass it."""
    shown = Exercise(task.line, task.text, task.name, scene=task.scene, checks=(Check(of=check.of),))
    return compare(check, answers(engine, shown)[0], expected).passed


def _challenge(engine: Engine, task: Challenge) -> Iterator[str]:
    scenes = wanted_scene(task), scene_of(task, starter(task)), scene_of(task, answer(task))
    target, begin, done = (draw(engine, small(scene)).array for scene in scenes)
    if score(target, begin, begin) >= task.goal:
        yield f"challenge '{task.name}': the picture to begin from is the one to match"
    if (points := score(target, begin, done)) < task.goal:
        yield f"challenge '{task.name}': its own values score {points:.0f}, below its goal {task.goal}"


MAX_WORDS = 60
"""Words that may come before the first picture, so that it is on the first screen."""

MAX_MINUTES = 12
"""Minutes that reading a lesson may take, by ``read.times_of``; its exercises are counted apart."""

EXERCISES = 3
"""Exercises that a lesson has at least."""

VISIBLE_MEAN, VISIBLE_SHARE, VISIBLE_LEVELS = 2.0, 0.02, 16
"""A bug is visible if pictures differ by so many levels in the mean, or such a share of pixels by so many."""


def broken_rules(lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    """Yield (line, sentence) of every rule that a lesson's text breaks; nothing is drawn."""
    yield from _time(lesson)
    yield from _first_screen(lesson)
    yield from _kinds(lesson)
    yield from _sections(lesson)
    yield from _references(lesson)
    for block in lesson.blocks:
        alt, caption = getattr(block, "alt", ""), getattr(block, "caption", "")
        if alt and alt == caption:
            yield block.line, f"'{getattr(block, 'name', '')}': alt repeats the caption"
        try:
            if isinstance(block, model.Code | model.Trace):
                excerpt(block.file, block.anchor)
            elif asks_number(block):
                trace_of(lesson, block)
            elif isinstance(block, model.Break):
                broken(block)
        except PlaygroundError as error:
            yield block.line, error.diagnostics[0].message


def wrong_pictures(engine: Engine, lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    """Yield (line, sentence) of what only drawing shows: bugs not seen, numbers not as claimed, bad tasks."""
    yield from _wrong_traces(engine, lesson)
    for block in lesson.blocks:
        try:
            if isinstance(block, model.Break) and block.scene:
                if not visible(draw(engine, block.scene), draw(engine, broken(block))):
                    yield block.line, f"break '{block.name}': the bug hardly changes the picture"
            elif isinstance(block, model.Exercise | model.Challenge):
                yield from ((block.line, sentence) for sentence in wrong_task(engine, block))
            elif isinstance(block, model.Measure):
                value = measured(engine, block).value
                if block.between and not block.between[0] <= value <= block.between[1]:
                    low, high = block.between
                    yield block.line, f"measure '{block.name}': {value:g} is not between {low:g} and {high:g}"
        except PlaygroundError as error:
            yield block.line, error.diagnostics[0].message


def _wrong_traces(engine: Engine, lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    """Yield (line, sentence) of traces that cannot be made, and of values that they do not have."""
    numbers: dict[str, Number] = {}
    for block in lesson.blocks:
        if not isinstance(block, model.Trace):
            continue
        try:
            lines = traced(engine, lesson, block)
        except PlaygroundError as error:
            yield block.line, error.diagnostics[0].message
            continue
        numbers |= numbers_in(lines)
        for question in lesson.questions_of(block.name):
            try:
                lines.answer(question)
            except PlaygroundError as error:
                yield question.line, error.diagnostics[0].message
    traces = {name.partition(":")[0] for name in numbers}
    for block in lesson.blocks:
        for name in (name for text in model.texts_of(block) for name in named_in(text)):
            if name.partition(":")[0] in traces and ":" in name and name not in numbers:
                yield block.line, f"{{{{{name}}}}}: the trace has no such number{nearest(name, numbers)}"


def visible(frame: Frame, other: Frame) -> bool:
    """Whether two pictures of one size differ visibly."""
    difference = np.abs(frame.array.astype(np.int16) - other.array).max(axis=-1)
    share = float((difference > VISIBLE_LEVELS).mean())
    return float(difference.mean()) >= VISIBLE_MEAN or share >= VISIBLE_SHARE


def _time(lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    if lesson.minutes > MAX_MINUTES:
        message = f"reading takes {lesson.minutes} minutes; at most {MAX_MINUTES} are allowed"
        yield 1, f"{message}: trim the lesson, or make it two"


def _first_screen(lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    words = 0
    for block in lesson.blocks:
        if isinstance(block, model.Figure):
            if words > MAX_WORDS:
                yield block.line, f"{words} words before the first figure; at most {MAX_WORDS} are allowed"
            return
        words += len(block.text.split()) if isinstance(block, model.Prose) else 0
        if isinstance(block, model.Named):
            yield block.line, "the first block of a lesson is a figure"
            return
    yield 1, "a lesson has a figure"


def _kinds(lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    target: tuple[tuple[str, tuple[type[model.Block], ...]], ...] = (
        ("a step or a slider", (model.Steps, model.Slider)),
        ("a compare or a question", (model.Compare, model.Question)),
        ("a code or a trace", (model.Code, model.Trace)),
        ("a measure", (model.Measure,)),
    )
    tasks = tasks_of(lesson)
    if not tasks and not any(isinstance(block, model.Break) for block in lesson.blocks):
        yield 1, "a lesson has a break block, or an exercise that checks itself"
    for what, kinds in target:
        if not any(isinstance(block, kinds) for block in lesson.blocks):
            yield 1, f"a lesson has {what} block"
    count = sum(isinstance(block, model.Exercise) for block in lesson.blocks)
    if count < EXERCISES:
        yield 1, f"{count} exercises; a lesson has {EXERCISES}"
    if not lesson.thesis or not lesson.papers:
        yield 1, "a lesson names sections of the thesis, and papers"


def _sections(lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    sections = lesson.sections[1:]
    if not sections:
        yield 1, "a lesson has sections, each begun by ##"
        return
    for section in sections[:-1]:
        named = [block for block in section.blocks if isinstance(block, model.Named)]
        if all(isinstance(block, model.Measure) for block in named):
            line = section.blocks[0].line if section.blocks else 1
            yield line, f"section '{section.title}' shows nothing: no picture, code or question"
    if not any(isinstance(block, model.Exercise) for block in sections[-1].blocks):
        yield 1, "the last section of a lesson holds the exercises"


def _references(lesson: model.Lesson) -> Iterator[tuple[int, str]]:
    named = {measure.name for measure in lesson.measures}
    named |= {block.name for block in lesson.blocks if asks_number(block)}
    traces = {block.name for block in lesson.blocks if isinstance(block, model.Trace)}
    targets = {"lesson": lesson_files(), "sketch": shipped_sketches(), "term": list(terms())}
    linked: set[str] = set()
    texts = [(1, lesson.title), (1, lesson.goal)]
    texts += [(block.line, text) for block in lesson.blocks for text in model.texts_of(block)]
    for line, text in texts:
        for latex in formulas(text):
            yield from ((line, message) for message in _formula(latex))
        for name in named_in(text):
            trace, colon, _ = name.partition(":")
            if colon and trace not in traces:
                yield line, f"{{{{{name}}}}}: there is no trace '{trace}'{nearest(trace, traces)}"
            elif not colon and name not in named:
                yield line, f"{{{{{name}}}}}: there is no measure of that name{nearest(name, named)}"
        for address in images(text):
            yield line, f"an image of '{address}': pictures are blocks of their own"
        for address in links(text):
            kind, _, what = address.partition(":")
            if kind in targets and what not in targets[kind]:
                yield line, f"a link to {kind} '{what}', which does not exist{nearest(what, targets[kind])}"
            elif kind == "thesis" and not all(part.isdigit() for part in what.split(".")):
                yield line, f"a link to section '{what}' of the thesis, which is no number"
            elif kind == "term" and address in linked:
                yield line, f"a second link to term '{what}': only its first appearance has one"
            elif kind not in (*targets, "thesis", "https"):
                yield line, f"a link to '{address}': expected {':, '.join(targets)}:, thesis: or https:"
            linked.add(address)


def _formula(latex: str) -> Iterator[str]:
    try:
        is_convertible = "\\" not in convert(latex)  # a command that it does not know stays as it is
    except Exception as error:  # its errors have no class in common
        message = str(error) or type(error).__name__.removesuffix("Error")
        yield f"formula ${latex}$ cannot be read: {message}"
        return
    if not is_convertible:
        yield f"formula ${latex}$ holds a command that cannot be shown"
