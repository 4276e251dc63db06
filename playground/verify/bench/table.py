"""Figures as cells of a table, in the terminal and on the page."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import zip_longest

from playground.verify.bench.results import Figure
from playground.verify.bench.timing import Samples

HEADINGS = (
    "row",
    "texels",
    "ours",
    "median (quartiles)",
    "peer",
    "median (quartiles)",
    "times as fast",
    "goal",
)


def rows_of(figure: Figure, clock: str) -> Iterator[tuple[str, ...]]:
    """Yield the table's rows of a figure: its forms of ours, and next to them its peers."""
    first = next(iter(figure.ours))
    met = {True: f"{figure.goal} met", False: f"{figure.goal} missed", None: ""}[figure.met]
    for number, (own, peer) in enumerate(zip_longest(figure.ours, figure.theirs, fillvalue="")):
        ours = amount_of(figure.unit, figure.ours[own], clock) if own else ""
        theirs = amount_of(figure.unit, figure.theirs[peer], clock) if peer else ""
        ratio = f"{figure.ratio(first, peer, clock):.2f}" if peer else ""
        goal = "" if number else met
        yield figure.name, str(figure.size or ""), own, ours, peer, theirs, ratio, goal


def amount_of(unit: str, samples: Samples, clock: str) -> str:
    """Return a median with its quartiles and its unit, as "7.2 ms (7.0–7.5)"."""
    own = clock if samples.of(clock) else "wall"
    median, (low, high) = samples.median(own), samples.quartiles(own)
    if not unit:
        return f"{median:.0f}"
    return f"{_number(median)} {unit} ({_number(low)}–{_number(high)})"


def _number(value: float) -> str:
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"
