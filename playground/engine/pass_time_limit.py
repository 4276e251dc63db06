"""Measure how long each pass of a request has taken, in all its iterations: a limit is meant for one pass.

A process tells what it is about to do; what it did before has ended then. What it waited for a
processor does not count, but for a share (see ``waiting``).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass

from playground.process.cpu_wait import Waits, worked

_SHORT = 0.05  # [s] a pass so short has its waits counted in: to read them takes a millisecond
_FRESH = 0.25  # [s] for which waits that were read may stand for those at a pass's beginning


@dataclass(frozen=True, slots=True)
class _Now:
    """What is being done."""

    what: Hashable
    began: float  # as time.monotonic
    waits: Waits  # when it began, or shortly before
    earlier: float  # [s] that it took in its iterations before


class PassClock:
    """Measures what a process does; one thread tells it, others may ask."""

    def __init__(self, waits: Callable[[], Waits]) -> None:
        self._waits_now = waits
        self._waits: Waits = {}
        self._read_at = -_FRESH
        self._spent: dict[Hashable, float] = {}
        self._now: _Now | None = None

    def clear(self) -> None:
        """Forget all; something new is asked for."""
        self._spent, self._now, self._read_at = {}, None, -_FRESH

    def begin(self, what: Hashable) -> None:
        """Begin with something, or go on with it; what was done before has ended."""
        if self._now is not None:
            self._spent[self._now.what] = self.seconds
        now = time.monotonic()
        if now - self._read_at > _FRESH:
            self._waits, self._read_at = self._waits_now(), now
        self._now = _Now(what, now, self._waits, self._spent.get(what, 0.0))

    @property
    def seconds(self) -> float:
        """How long what is being done has taken so far, in all its iterations; 0 before it begins."""
        now = self._now
        if now is None:
            return 0.0
        passed = time.monotonic() - now.began
        return now.earlier + (passed if passed < _SHORT else worked(passed, now.waits, self._waits_now()))
