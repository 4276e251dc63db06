"""The sketch's own time: it runs, rests, and never jumps when a file is saved."""

from __future__ import annotations

from dataclasses import dataclass

from playground.sketch.model import Graph, Sketch, Technique, kernels_of
from playground.sketch.reserved_names import PLAIN_UNIFORMS

_MOVING = frozenset(n for meaning in ("time", "frame", "delta", "date") for n in PLAIN_UNIFORMS[meaning])

LEAST_LOOP = 0.05
"""[s] that a loop lasts at least."""


@dataclass
class Clock:
    """Time as the sketch sees it; whoever holds it says how much of it has passed."""

    time: float = 0.0  # [s] 0 or more
    playing: bool = True
    speed: float = 1.0  # seconds of the sketch in a second of the wall
    loop: tuple[float, float] | None = (
        None  # [s] the times between which it goes round; the second is the later
    )

    def advance(self, seconds: float) -> None:
        """Let so many seconds of the wall pass."""
        if not self.playing:
            return
        before, self.time = self.time, self.time + seconds * self.speed
        if self.loop is not None and before <= self.loop[1] < self.time:
            start, end = self.loop
            self.time = start + (self.time - end) % (end - start)

    def go_round(self, start: float, end: float) -> None:
        """Go round between two times [s], in whichever order; at one time there is nothing to go round."""
        low, high = sorted((max(start, 0.0), max(end, 0.0)))
        self.loop = (low, high) if high - low >= LEAST_LOOP else None

    def toggle(self) -> None:
        """Play if it rests, rest if it plays."""
        self.playing = not self.playing

    def rewind(self) -> None:
        """Go back to 0, and round no loop: it is another sketch's."""
        self.time, self.loop = 0.0, None


def is_animated(sketch: Sketch) -> bool:
    """Say whether the picture may differ from moment to moment."""
    if sketch.keyframes:
        return True
    for _, kernel in kernels_of(sketch.graph):
        named = _MOVING if kernel.kind.startswith("plain") else {"time"}
        if any(kernel.reads(name) for name in named):
            return True
        if "time" in kernel.repeat:
            return True
    return _repeats_by_time(sketch.graph)


def reads_mouse(sketch: Sketch) -> bool:
    """Say whether a plain shader in it asks where the mouse is."""
    plain = (kernel for _, kernel in kernels_of(sketch.graph) if kernel.kind.startswith("plain"))
    return any(kernel.reads(name) for kernel in plain for name in PLAIN_UNIFORMS["mouse"])


def _repeats_by_time(technique: Technique) -> bool:
    if not isinstance(technique, Graph):
        return False
    return any("time" in spec.repeat or _repeats_by_time(spec.technique) for spec in technique.passes)
