"""Processor time: how long a worker process has worked on each activity, whatever else its machine does.

On a machine with ten things to do, a draw of a second takes five. Linux counts, for each thread, the time
that it ran and the time that it was ready to run and did not (``/proc/PID/task/*/schedstat``: nanoseconds
run, nanoseconds waited, times). Other systems do not, so there all time that passes counts.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from pathlib import Path

_MAX_SLOWDOWN = 8.0  # times longer that something may take on a busy machine
_SHORT = 0.05  # [s] an activity so short is measured by the clock: to read the times takes a millisecond
_FRESH = 0.25  # [s] for which times that were read may be taken for those at an activity's beginning

Times = dict[str, tuple[int, int]]
"""Nanoseconds that each thread of a process has run, and has waited for a processor, since it began."""


def times_of(pid: int) -> Times:
    """Return the times of each thread so far; nothing where the system does not count."""
    times: Times = {}
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
    except OSError:
        return times
    for task in tasks:
        try:
            ran, waited, *_ = map(int, (task / "schedstat").read_text("ascii").split())
        except (OSError, ValueError):
            continue  # it has ended meanwhile, or this system does not count
        times[task.name] = ran, waited
    return times


def worked(passed: float, before: Times, now: Times) -> float:
    """Return the seconds of those that passed in which a process worked.

    Of threads that work side by side, as a renderer's, the busiest one's time counts. Where no thread ran
    or waited for a processor, a graphics card or a disk may have worked for it, so that counts, too. So does
    a fraction of all that passed: what never ends must be stopped on the busiest machine.
    """
    none = (0, 0)
    spent = [[a - b for a, b in zip(now[name], before.get(name, none), strict=True)] for name in now]
    busiest = max((ran for ran, _ in spent), default=0) * 1e-9
    idle = passed - sum(ran + waited for ran, waited in spent) * 1e-9
    return min(max(busiest + max(idle, 0.0), passed / _MAX_SLOWDOWN), passed)


def max_wall_seconds(work: float) -> float:
    """Return the seconds that may pass, at the most, while a process works for so many."""
    return work * _MAX_SLOWDOWN if sys.platform == "linux" else work


@dataclass(frozen=True, slots=True)
class _Current:
    """The activity at work."""

    activity: Hashable
    began: float  # as time.monotonic
    times: Times  # when it began, or shortly before
    earlier: float  # [s] that it took in its steps before
    before: float  # [s] of all that was done before this step


class ActivityClock:
    """Measures each activity of a process, in all its steps; one thread sets it, others may read it.

    A process reports what it is about to do; what it did before has ended then. A reader reads ``_current``
    once, which holds all that it needs and is replaced whole.
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

    def begin(self, activity: Hashable) -> None:
        """Begin an activity, or continue it; the one before has ended."""
        before = 0.0
        if self._current is not None:
            passed = self._passed(self._current)
            before = self._current.before + passed
            self._spent[self._current.activity] = self._current.earlier + passed
        now = time.monotonic()
        if now - self._read_at > _FRESH:
            self._times, self._read_at = self._times_now(), now
        self._current = _Current(activity, now, self._times, self._spent.get(activity, 0.0), before)

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
