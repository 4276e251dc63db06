"""Compare a run with earlier ones: which figures are slower, by more than runs differ anyway.

Times of two runs are of two days, and perhaps of two machines. A figure with peers is compared by its
ratio to the first of them, which was measured in the same minute; one without by its time.
"""

from __future__ import annotations

import statistics
from collections.abc import Sequence
from dataclasses import dataclass

from playground.verify.bench.results import Figure, Results

MIN_RATIO = 1.1  # times as slow, or as fast, from which on a change is one


@dataclass(frozen=True)
class Change:
    """A figure, and how many times as long it takes as before."""

    figure: Figure
    before: Figure
    times: float  # as long as before
    by_peer: str  # whose ratio was compared; "" where the times were
    clear: bool  # whether the samples of the two do not overlap, from quartile to quartile

    @property
    def word(self) -> str:
        """Return "slower", "faster" or "alike"."""
        if not self.clear or 1 / MIN_RATIO < self.times < MIN_RATIO:
            return "alike"
        return "slower" if self.times > 1 else "faster"


def changes(now: Results, before: Results, clock: str = "wall") -> list[Change]:
    """Return the change of each figure that both runs have."""
    figures = before.by_key()
    return [
        change
        for figure in now.figures
        if (old := figures.get(figure.key)) is not None and (change := _change(figure, old, clock))
    ]


def _change(now: Figure, before: Figure, clock: str) -> Change | None:
    form = next((form for form in now.ours if form in before.ours), None)
    if form is None:
        return None
    peer = next((peer for peer in now.theirs if peer in before.theirs), "")
    new, old = (_scaled(figure, form, peer, clock) for figure in (now, before))
    middle = statistics.median(new), statistics.median(old)
    times = middle[0] / max(middle[1], 1e-12)
    spread = [_quartiles(samples) for samples in (new, old)]
    clear = spread[0][0] > spread[1][1] or spread[1][0] > spread[0][1]
    return Change(now, before, times, peer, clear)


def _scaled(figure: Figure, form: str, peer: str, clock: str) -> list[float]:
    """Return the samples of a form over the median of a peer, if there is one."""
    own = figure.ours[form].of(clock) or figure.ours[form].wall
    over = figure.theirs[peer].median(clock) if peer else 1.0
    return [sample / max(over, 1e-9) for sample in own]


def _quartiles(samples: Sequence[float]) -> tuple[float, float]:
    if len(samples) < 3:
        return min(samples), max(samples)
    low, _, high = statistics.quantiles(samples, n=4, method="inclusive")
    return low, high
