"""The sketch's own time: it plays, pauses, loops, and never jumps when a file is saved.

Also where it runs: how long its bar is, its keyframes' marks, one frame on or back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from playground.sketch.model import FPS, Sketch

MIN_LOOP = 0.05
"""[s] that a loop lasts at least."""


@dataclass
class Clock:
    """Time as the sketch sees it; its owner advances it."""

    time: float = 0.0  # [s] 0 or more
    playing: bool = True
    speed: float = 1.0  # seconds of the sketch in a second of real time
    loop: tuple[float, float] | None = None  # [s] the times between which it repeats; the second is later

    def advance(self, seconds: float) -> None:
        """Advance by seconds of real time, unless it is paused."""
        if not self.playing:
            return
        before, self.time = self.time, self.time + seconds * self.speed
        if self.loop is not None and before <= self.loop[1] < self.time:
            start, end = self.loop
            self.time = start + (self.time - end) % (end - start)

    def set_loop(self, start: float, end: float) -> None:
        """Repeat between two times [s], in whichever order; no loop where they are the same."""
        low, high = sorted((max(start, 0.0), max(end, 0.0)))
        self.loop = (low, high) if high - low >= MIN_LOOP else None

    def toggle(self) -> None:
        """Play if it is paused, pause if it plays."""
        self.playing = not self.playing

    def restore(self, other: Clock) -> None:
        """Go on as another clock is."""
        self.time, self.playing, self.speed, self.loop = other.time, other.playing, other.speed, other.loop

    def rewind(self) -> None:
        """Go back to 0, without a loop: it is another sketch's."""
        self.time, self.loop = 0.0, None


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
