"""Measure the processor time of a process: what its machine does besides does not count.

On a machine with ten things to do, a draw of a second takes five. Linux counts, for each thread, the time
that it ran and the time that it was ready to run and did not (``/proc/PID/task/*/schedstat``: nanoseconds
run, nanoseconds waited, times). Other systems do not, so there all time that passes counts.
"""

from __future__ import annotations

import sys
from pathlib import Path

_SLOWEST = 8.0  # times longer that something may take on a busy machine

Times = dict[str, tuple[int, int]]
"""Nanoseconds that each thread of a process has run, and has waited for a processor, since it began."""


def times_of(pid: int) -> Times:
    """Return the times of each thread so far; nothing where the system does not count."""
    found: Times = {}
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
    except OSError:
        return found
    for task in tasks:
        try:
            ran, waited, *_ = map(int, (task / "schedstat").read_text("ascii").split())
        except (OSError, ValueError):
            continue  # it has ended meanwhile, or this system does not count
        found[task.name] = ran, waited
    return found


def worked(passed: float, before: Times, now: Times) -> float:
    """Return the seconds of those that passed in which a process worked.

    Of threads that work side by side, as a renderer's, the busiest one's time counts. Where no thread ran
    or waited for a processor, a graphics card or a disk may have worked for it, so that counts, too. So does
    a share of all that passed: what never ends must be stopped on the busiest machine.
    """
    none = (0, 0)
    spent = [[a - b for a, b in zip(now[one], before.get(one, none), strict=True)] for one in now]
    busiest = max((ran for ran, _ in spent), default=0) * 1e-9
    idle = passed - sum(ran + waited for ran, waited in spent) * 1e-9
    return min(max(busiest + max(idle, 0.0), passed / _SLOWEST), passed)


def longest(work: float) -> float:
    """Return the seconds that may pass, at the most, while a process works for so many."""
    return work * _SLOWEST if sys.platform == "linux" else work
