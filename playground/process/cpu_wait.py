"""Measure how long a process has waited for a processor that others had.

A limit of time is meant for what a process does, not for what its machine does besides: on a
machine with ten things to do, a draw of a second takes five. Linux counts, for each thread,
the time that it was ready to run and did not (``/proc/PID/task/*/schedstat``: nanoseconds run,
nanoseconds waited, times). Other systems do not, so there all time that passes counts.
"""

from __future__ import annotations

import sys
from pathlib import Path

_SLOWEST = 8.0  # times longer that something may take on a busy machine

Waits = dict[str, int]
"""Nanoseconds that each thread of a process has waited for a processor since it began."""


def waits_of(pid: int) -> Waits:
    """Return how long each thread of a process has waited so far; nothing where the system does not count."""
    found: Waits = {}
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
    except OSError:
        return found
    for task in tasks:
        try:
            found[task.name] = int((task / "schedstat").read_text("ascii").split()[1])
        except (OSError, IndexError, ValueError):
            continue  # it has ended meanwhile, or this system does not count
    return found


def waited_since(before: Waits, now: Waits) -> float:
    """Return the seconds that the thread which has waited longest has done so since ``before``.

    Of threads that work side by side, as a renderer's, the slowest says when all are done.
    """
    return max((wait - before.get(thread, 0) for thread, wait in now.items()), default=0) * 1e-9


def worked(passed: float, before: Waits, now: Waits) -> float:
    """Return the seconds of those that passed in which a process did not wait for a processor.

    A share of them counts however long it waited: its own threads wait for each other too, and
    what never ends must be stopped on the busiest machine.
    """
    return max(passed - waited_since(before, now), passed / _SLOWEST)


def longest(work: float) -> float:
    """Return the seconds that may pass, at the most, while a process works for so many."""
    return work * _SLOWEST if sys.platform == "linux" else work
