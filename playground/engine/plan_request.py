"""What a plan is made for besides a graph and its values, and checks of a caller's arguments."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from numbers import Integral, Real

from playground.engine.source_kinds import Terrain
from playground.errors import ParameterError

DEFAULT_SIZE = (513, 513)  # texels of a terrain whose size nothing says
DEFAULT_EXTENT = 10_240.0  # [m] from west to east
DEFAULT_RELIEF = 1_800.0  # [m]


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """What a plan is made for, besides a graph, its values, the camera and the time."""

    frame_size: tuple[int, int]
    stopped: tuple[tuple[str, int], ...]  # repeats that are stopped early: steps to run, by path
    fills: bool
    compute: bool
    varies: bool  # keyframes set parameters, and so perhaps counts of steps
    terrain: Terrain  # what the sketch says of it

    def steps_of(self, path: str, whole: int) -> int:
        """Return how many of a repeat's iterations run."""
        return min(dict(self.stopped).get(path, whole), whole)


def checked_pixels(size: object, largest: int) -> tuple[int, int]:
    """Return width and height of a picture; raise ``ParameterError`` unless 1..``largest`` a side."""
    found = tuple(size) if isinstance(size, Iterable) and not isinstance(size, str) else ()
    if len(found) != 2 or not all([isinstance(n, Integral) and not isinstance(n, bool) for n in found]):
        raise ParameterError(f"size {size!r}: expected two whole numbers, width and height in pixels")
    width, height = int(found[0]), int(found[1])
    if not (1 <= width <= largest and 1 <= height <= largest):
        raise ParameterError(f"a picture of {width} x {height} pixels; 1 to {largest} a side were expected")
    return width, height


def checked_seconds(time: object) -> float:
    """Return a finite number of seconds, or raise ``ParameterError``."""
    if not isinstance(time, Real) or isinstance(time, bool) or not math.isfinite(time):
        raise ParameterError(f"time {time!r}: expected a number of seconds")
    return float(time)


def checked_steps(path: str, count: object) -> int:
    """Return after how many steps a repeat stops, or raise ``ParameterError``."""
    if not isinstance(count, Integral) or isinstance(count, bool) or count < 0:
        raise ParameterError(f"steps: '{path}' stops after {count!r} steps; expected a whole number from 0")
    return int(count)
