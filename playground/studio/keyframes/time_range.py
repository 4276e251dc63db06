"""Where a sketch's time runs: how long its bar is, its keyframes' marks, one frame on or back."""

from __future__ import annotations

import math

from playground.sketch.model import FPS, Sketch
from playground.studio.clock import Clock

DEFAULT_DURATION = 10.0
"""[s] that the bar of a sketch without keyframes shows at least, and that its loop is long."""
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 10.0)
_EPSILON = 1e-6


def span_of(sketch: Sketch, clock: Clock) -> float:
    """Return the last time [s] on the bar, which begins at 0."""
    last = sketch.duration or DEFAULT_DURATION
    if clock.loop is not None:
        last = max(last, clock.loop[1])
    return last if clock.time <= last else math.ceil(clock.time / DEFAULT_DURATION) * DEFAULT_DURATION


def marks_of(sketch: Sketch) -> tuple[float, ...]:
    """Return the times [s] of the keyframes, in order, each once."""
    return tuple(dict.fromkeys(keyframe.time for keyframe in sketch.keyframes))


def stepped(time: float, frames: int) -> float:
    """Return the time [s] of a picture of a film before or after, whole pictures from 0 counted."""
    now = time * FPS
    whole = math.floor(now + _EPSILON) if frames > 0 else math.ceil(now - _EPSILON)
    return max(whole + frames, 0) / FPS


def toggle_loop(sketch: Sketch, clock: Clock) -> None:
    """Switch the loop on or off: over the keyframes' span, or over the whole bar without any."""
    if clock.loop is not None:
        clock.loop = None
    else:
        marks = marks_of(sketch)
        clock.set_loop(*((marks[0], marks[-1]) if len(marks) > 1 else (0.0, span_of(sketch, clock))))
