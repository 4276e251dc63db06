"""Time runs alternately, so that a load on the machine falls on all of them alike.

Every sample has two numbers: milliseconds on the clock, and of all processors together, which a load
of others does not lengthen.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field

Run = Callable[[], object]


@dataclass
class Samples:
    """What several runs of the same took, in milliseconds: on the clock, and of processors."""

    wall: list[float] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)

    def of(self, clock: str) -> list[float]:
        """Return the samples of a clock, "wall" or "processor"."""
        return self.processor if clock == "processor" else self.wall

    def median(self, clock: str = "wall") -> float:
        """Return the median."""
        return statistics.median(self.of(clock))

    def quartiles(self, clock: str = "wall") -> tuple[float, float]:
        """Return the first and the third quartile; of fewer than three samples, the least and the most."""
        times = sorted(self.of(clock))
        if len(times) < 3:
            return times[0], times[-1]
        low, _, high = statistics.quantiles(times, n=4, method="inclusive")
        return low, high


def alternate(
    runs: Mapping[str, Run], rounds: int, *, once: Collection[str] = (), unmeasured: int = 1
) -> dict[str, Samples]:
    """Return the samples of each run, by name: one of each in turn, ``rounds`` times.

    The first ``unmeasured`` rounds compile and fill caches, and do not count. Those in ``once`` take too
    long to run more than once.
    """
    samples = {name: Samples() for name in runs}
    for number in range(-unmeasured, rounds):
        for name, run in runs.items():
            if name in once and number != 0:
                continue
            wall, processor = timed(run)
            if number >= 0:
                samples[name].wall.append(wall)
                samples[name].processor.append(processor)
    return samples


def beyond(whole: Samples, part: Samples) -> Samples:
    """Return what each run took beyond that of a part of it in the same round."""
    return Samples(
        [whole_time - other for whole_time, other in zip(whole.wall, part.wall, strict=True)],
        [whole_time - other for whole_time, other in zip(whole.processor, part.processor, strict=True)],
    )


def timed(run: Run) -> tuple[float, float]:
    """Return the milliseconds that a run takes, on the clock and of this process's processors."""
    start, busy = time.perf_counter(), time.process_time()
    run()
    return (time.perf_counter() - start) * 1e3, (time.process_time() - busy) * 1e3
