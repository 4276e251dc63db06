"""The sketch's own time: it plays, pauses, and never jumps when a file is saved."""

from __future__ import annotations

from dataclasses import dataclass

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
