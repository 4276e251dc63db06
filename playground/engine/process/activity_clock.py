"""Measure how long each activity of a worker has taken, in all its steps: a limit is meant for one of them.

A process reports what it is about to do; what it did before has ended then. Processor time counts, and of
what it waited for a processor a share (see ``cpu_wait``).
"""

from __future__ import annotations

import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass

from playground.engine.process.cpu_wait import Times, worked

_SHORT = 0.05  # [s] an activity so short is measured by the clock: to read the times takes a millisecond
_FRESH = 0.25  # [s] for which times that were read may be taken for those at an activity's beginning


@dataclass(frozen=True, slots=True)
class _Current:
    """What is being done."""

    what: Hashable
    began: float  # as time.monotonic
    times: Times  # when it began, or shortly before
    earlier: float  # [s] that it took in its steps before
    before: float  # [s] of all that was done before this step


class ActivityClock:
    """Measures what a process does; one thread sets it, others may read it.

    A reader reads ``_current`` once, which holds all that it needs and is replaced whole.
    """

    def __init__(self, times: Callable[[], Times]) -> None:
        self._times_now = times
        self._times: Times = {}
        self._read_at = -_FRESH
        self._spent: dict[Hashable, float] = {}  # [s] of each activity, the current one left out
        self._current: _Current | None = None

    def clear(self) -> None:
        """Forget all: nothing is being done."""
        self._spent, self._current = {}, None

    def begin(self, what: Hashable) -> None:
        """Begin an activity, or continue it; the one before has ended."""
        before = 0.0
        if self._current is not None:
            passed = self._passed(self._current)
            before = self._current.before + passed
            self._spent[self._current.what] = self._current.earlier + passed
        now = time.monotonic()
        if now - self._read_at > _FRESH:
            self._times, self._read_at = self._times_now(), now
        self._current = _Current(what, now, self._times, self._spent.get(what, 0.0), before)

    def _passed(self, current: _Current) -> float:
        """Return how long the step at work has taken so far [s]."""
        passed = time.monotonic() - current.began
        return worked(passed, current.times, self._times_now()) if passed >= _SHORT else passed

    @property
    def seconds(self) -> float:
        """How long the current activity has taken so far, in all its steps [s]; 0 while there is none."""
        current = self._current
        return 0.0 if current is None else current.earlier + self._passed(current)

    @property
    def total(self) -> float:
        """How long all activities together have taken [s]."""
        current = self._current
        return 0.0 if current is None else current.before + self._passed(current)
