"""Interpolate the camera and the values of a sketch with keyframes: a pure function of the time.

Each thing that keyframes set, a parameter or one number of the camera, has a track of its
own: the keyframes that name it. Before its first and after its last it stays. What goes on
from a keyframe to the next of the track is that keyframe's ``ease``: linear, smooth or hold.

Smooth is a cubic whose slopes at the keyframes keep it monotone between any two, so that
nothing leaves the range of the values given; where a track changes direction, begins, ends or meets
another ease its slope is 0. Azimuths go the short way round, colours in linear light (as
they are stored), whole numbers, checkboxes, menus and files hold.

Source: Fritsch and Butland 1984, "A Method for Constructing Local Monotone Piecewise Cubic
Interpolants" (SIAM J. Sci. Stat. Comput. 5(2)): the slope between two secants of one sign is
their weighted harmonic mean, else 0.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from playground.memo import GRAPHS
from playground.shader.kernel import Graph
from playground.shader.parameter import Parameter, is_whole
from playground.shader.widgets import Value
from playground.sketch.assign import resolve

EASES = ("smooth", "linear", "hold")
"""How values go from a keyframe to the next; the first where it does not say."""

_CIRCLE = 360.0


@dataclass(frozen=True)
class Keyframe:
    """What the camera and some parameters are at a time, and how they go on from there."""

    time: float  # [s]
    camera: tuple[tuple[str, float | tuple[float, ...]], ...] = ()  # fields of ``Camera`` → value
    values: tuple[tuple[str, Value], ...] = ()  # parameter path → value
    ease: str = "smooth"  # smooth | linear | hold: to the next keyframe that says the same thing
    line: int = 0


@dataclass(frozen=True, slots=True)
class Track:
    """What keyframes say of one thing, by time."""

    times: tuple[float, ...]  # [s] increasing
    values: tuple[Value, ...]
    eases: tuple[str, ...]  # from each on
    holds: bool = False  # with any ease
    angles: tuple[int, ...] = ()  # which of its numbers are azimuths

    def at(self, time: float) -> Value:
        """Return the value at a time in seconds."""
        index = bisect_right(self.times, time) - 1
        if index < 0:
            return self.values[0]
        here = self.values[index]
        last = index == len(self.times) - 1
        if last or self.holds or self.eases[index] == "hold" or time == self.times[index]:
            return here
        many = tuple(_numbers(value) for value in self.values)
        values_now = []
        for which in range(len(many[0])):
            column = [numbers[which] for numbers in many]
            if which in self.angles:
                values_now.append(self._between(_unwound(column), index, time) % _CIRCLE)
            else:
                values_now.append(self._between(column, index, time))
        return tuple(values_now) if isinstance(here, tuple) else values_now[0]

    def _between(self, column: Sequence[float], index: int, time: float) -> float:
        start, end = self.times[index], self.times[index + 1]
        share = (time - start) / (end - start)
        low, high = column[index], column[index + 1]
        if self.eases[index] == "linear":
            return low + share * (high - low)
        there = (end - start) * self._slope(column, index + 1)
        here = (end - start) * self._slope(column, index)
        # Hermite's cubic, from the two values and the two slopes.
        rest = 1.0 - share
        value = (
            low
            + share * share * (3.0 - 2.0 * share) * (high - low)
            + share * rest * (rest * here - share * there)
        )
        return min(max(value, min(low, high)), max(low, high))  # what is rounded may not leave either

    def _slope(self, column: Sequence[float], index: int) -> float:
        """Return how fast a smooth track passes a keyframe; 0 where it does not pass smoothly."""
        if index in (0, len(column) - 1) or self.eases[index - 1 : index + 1] != ("smooth", "smooth"):
            return 0.0
        before, after = (self.times[k + 1] - self.times[k] for k in (index - 1, index))
        coming = (column[index] - column[index - 1]) / before
        going = (column[index + 1] - column[index]) / after
        if coming * going <= 0.0:
            return 0.0
        share = (before + 2.0 * after) / (3.0 * (before + after))
        return coming * going / (share * going + (1.0 - share) * coming)


def at(
    keyframes: tuple[Keyframe, ...], graph: Graph, time: float
) -> tuple[dict[str, Any], tuple[tuple[str, Value], ...]]:
    """Return what keyframes say of the camera's fields and of a graph's parameters at a time in seconds."""
    cameras, tracks = tracks_of(graph, keyframes)
    camera = {name: track.at(time) for name, track in cameras.items()}
    return camera, tuple((path, track.at(time)) for path, track in tracks.items())


@GRAPHS.cached(identities=1)
def tracks_of(graph: Graph, keyframes: tuple[Keyframe, ...]) -> tuple[dict[str, Track], dict[str, Track]]:
    """Return the tracks of the camera's fields, by name, and of the parameters, by path."""
    names = dict.fromkeys(name for keyframe in keyframes for name, _ in keyframe.camera)
    cameras = {
        name: _track(keyframes, "camera", name, angles=(0,) if name == "azimuth" else ()) for name in names
    }
    tracks = {}
    for path in dict.fromkeys(path for keyframe in keyframes for path, _ in keyframe.values):
        parameter = resolve(graph, path)[0].parameter
        how = {"holds": _holds(parameter), "angles": _angles(parameter)}
        tracks[path] = _track(keyframes, "values", path, **how)
    return cameras, tracks


def _track(keyframes: Sequence[Keyframe], part: str, name: str, **how: Any) -> Track:
    """Return the track of a camera field or a parameter: the keyframes that name it."""
    keyframes_with_values = [(keyframe, dict(getattr(keyframe, part))) for keyframe in keyframes]
    keyframes_with_values = [
        (keyframe, values) for keyframe, values in keyframes_with_values if name in values
    ]
    return Track(
        tuple(keyframe.time for keyframe, _ in keyframes_with_values),
        tuple(values[name] for _, values in keyframes_with_values),
        tuple(keyframe.ease for keyframe, _ in keyframes_with_values),
        **how,
    )


def _holds(parameter: Parameter) -> bool:
    widget = parameter.widget.kind
    return is_whole(parameter.type) or parameter.type in ("bool", "sampler2D") or widget in ("menu", "file")


def _angles(parameter: Parameter) -> tuple[int, ...]:
    """Return which numbers are azimuths; an angle is one where its range has 360 degrees."""
    widget = parameter.widget
    low, high = widget.low, widget.high
    whole = low is None or high is None or (low <= 0.0 and high >= _CIRCLE)
    return (0,) if widget.kind == "direction" or (widget.kind == "angle" and whole) else ()


def _numbers(value: Value) -> tuple[float, ...]:
    return tuple(map(float, value)) if isinstance(value, tuple) else (float(value),)


def _unwound(column: Sequence[float]) -> list[float]:
    """Return azimuths moved by 360 degrees, so that each is within 180 of the one before."""
    angles = [column[0]]
    for value in column[1:]:
        angles.append(value - _CIRCLE * round((value - angles[-1]) / _CIRCLE))
    return angles
