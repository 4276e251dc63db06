"""Match a challenge's picture: draw what a student has, and score it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from playground.course.figure_renders import draw
from playground.course.model import Challenge, Scene
from playground.course.tasks.judge import SIDE, small
from playground.course.tasks.score import score
from playground.course.tasks.verdict import Picture
from playground.course.tasks.work import Work, scene_of, starter, wanted_scene
from playground.engine.engine import Engine
from playground.errors import Diagnostic, PlaygroundError


@dataclass(frozen=True, eq=False)
class Match:
    """How near a work is to the picture of a challenge."""

    score: float  # 0..100
    goal: int
    target: Picture | None  # None where its process ended
    mine: Picture | None = None
    diagnostics: tuple[Diagnostic, ...] = ()  # why nothing could be drawn

    @property
    def solved(self) -> bool:
        """Whether it is near enough."""
        return self.score >= self.goal


@dataclass(frozen=True, eq=False)
class Ends:
    """The two pictures that a score lies between."""

    target: Picture
    begin: Picture


def ends_of(engine: Engine, task: Challenge, side: int = SIDE) -> Ends:
    """Draw the picture to match and the one to begin from; ``side`` is the longer one, in pixels."""
    scenes = wanted_scene(task), scene_of(task, starter(task))
    return Ends(*(_drawn(engine, scene, side) for scene in scenes))


def match(engine: Engine, task: Challenge, work: Work, ends: Ends | None = None, side: int = SIDE) -> Match:
    """Return how near a work is; a mistake in it is an answer too, with no score.

    ``ends``, from ``ends_of`` with the same ``side``, saves drawing them again. Raises ``PlaygroundError``
    only where it is not the student's doing.
    """
    ends = ends_of(engine, task, side) if ends is None else ends
    try:
        mine = _drawn(engine, scene_of(task, work), side)
    except PlaygroundError as error:
        return Match(0.0, task.goal, ends.target, diagnostics=error.diagnostics)
    return Match(score(ends.target, ends.begin, mine), task.goal, ends.target, mine)


def _drawn(engine: Engine, scene: Scene, side: int) -> Picture:
    return np.ascontiguousarray(draw(engine, small(scene, side)).array[..., :3])
