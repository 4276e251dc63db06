"""Prove that a task can be done, and that only doing it earns its points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from playground.course.figure_renders import draw
from playground.course.model import Challenge, Check, Exercise
from playground.course.tasks.judge import Wanted, answers, compare, judge, small
from playground.course.tasks.score import score
from playground.course.tasks.sentences import sentence_of, sentences
from playground.course.tasks.work import answer, scene_of, starter, wanted_scene
from playground.engine.engine import Engine


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
