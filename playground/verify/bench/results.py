"""What a run of ``playground bench`` found: as JSON, as a table, next to earlier runs.

Times of two runs are of two days, and perhaps of two machines. A figure with peers is compared by its
ratio to the first of them, which was measured in the same minute; one without by its time.
"""

from __future__ import annotations

import json
import statistics
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import zip_longest
from pathlib import Path
from typing import Any

from playground.errors import DataError
from playground.files import read_regular, write_file
from playground.json_text import read_json
from playground.paths import shown
from playground.verify.bench.context import Samples, quartiles
from playground.verify.bench.rows import Goal

# ── figures, and their file ──────────────────────────────────────────────────


FORMAT = 1
KIND = "playground bench"


@dataclass
class Figure:
    """One row as it was measured, at one size."""

    suite: str
    name: str
    what: str
    size: int  # texels a side; 0 where there is none
    unit: str  # "ms", "MiB", "" for a count
    goal: Goal
    ours: dict[str, Samples]  # by form; of some other unit, in ``wall`` alone
    theirs: dict[str, Samples] = field(default_factory=dict)  # by peer
    alone: frozenset[str] = frozenset()  # peers that use one processor

    @property
    def key(self) -> str:
        """Return what tells it from every other figure."""
        return f"{self.suite}/{self.name}/{self.size}"

    def ratio(self, form: str, peer: str, clock: str = "wall") -> float:
        """Return how many times as fast as a peer one of ours is."""
        return self.theirs[peer].median(clock) / max(self.ours[form].median(clock), 1e-9)

    @property
    def met(self) -> bool | None:
        """Whether its goal is reached by its first form; None where none holds here, or no such peer is."""
        form = next(iter(self.ours))
        if self.size not in (0, self.goal.at):
            return None
        if self.goal.times:
            peers = [peer for peer in self.theirs if peer.startswith(self.goal.than)]
            return self.ratio(form, peers[0]) >= self.goal.times if peers else None
        return self.ours[form].median() <= self.goal.most if self.goal.most else None


@dataclass
class Results:
    """One run: when, on what, and what was found."""

    date: str  # ISO 8601, with the zone
    version: str
    machine: dict[str, Any]
    rounds: int
    figures: list[Figure] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)  # what was left out, and why

    def by_key(self) -> dict[str, Figure]:
        """Return the figures by their keys."""
        return {figure.key: figure for figure in self.figures}


def as_json(results: Results) -> dict[str, Any]:
    """Return all of a run as what JSON can hold."""
    record = {"kind": KIND, "format": FORMAT, **asdict(results)}
    for figure in record["figures"]:
        figure["alone"] = sorted(figure["alone"])
    return record


def write(results: Results, path: Path) -> None:
    """Write results as JSON."""
    write_file(path, json.dumps(as_json(results), indent=1, ensure_ascii=False) + "\n")


def read(path: Path) -> Results:
    """Read what ``write`` wrote; raise ``DataError`` for any other file."""
    try:
        document = read_json(read_regular(path).decode())
    except FileNotFoundError:
        raise DataError("no such file; expected results of playground bench", file=shown(path)) from None
    except (ValueError, OSError) as error:
        raise DataError(f"cannot be read as JSON: {error}", file=shown(path)) from None
    if not isinstance(document, dict) or document.get("kind") != KIND:
        raise DataError("this JSON is no result of playground bench", file=shown(path))
    if document.get("format") != FORMAT:
        message = f"results of format {document.get('format')}; this version reads format {FORMAT}"
        raise DataError(message, file=shown(path))
    try:
        figures = [_figure(each) for each in document["figures"]]
        kept = {key: document[key] for key in ("date", "version", "machine", "rounds", "notes")}
        return Results(**kept, figures=figures)
    except (KeyError, TypeError) as error:
        raise DataError(f"damaged results: {error}", file=shown(path)) from None


def _figure(each: Mapping[str, Any]) -> Figure:
    own = dict(each)
    own["goal"] = Goal(**own["goal"])
    own["alone"] = frozenset(own["alone"])
    for side in ("ours", "theirs"):
        own[side] = {name: Samples(**samples) for name, samples in own[side].items()}
    return Figure(**own)


# ── next to an earlier run ───────────────────────────────────────────────────


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
    spread = [quartiles(samples) for samples in (new, old)]
    clear = spread[0][0] > spread[1][1] or spread[1][0] > spread[0][1]
    return Change(now, before, times, peer, clear)


def _scaled(figure: Figure, form: str, peer: str, clock: str) -> list[float]:
    """Return the samples of a form over the median of a peer, if there is one."""
    own = figure.ours[form].of(clock) or figure.ours[form].wall
    over = figure.theirs[peer].median(clock) if peer else 1.0
    return [sample / max(over, 1e-9) for sample in own]


# ── growth with size ─────────────────────────────────────────────────────────


def growth(results: Results, sizes: Sequence[int], clock: str = "wall") -> list[tuple[str, float]]:
    """Return the cost of a texel at the largest size over that at the smallest, of each row that has both."""
    low, high = min(sizes), max(sizes)
    if low == high:
        return []
    cost = {
        (figure.name, figure.size): next(iter(figure.ours.values())).median(clock)
        for figure in results.figures
        if figure.unit == "ms"
    }
    names = dict.fromkeys(name for name, _ in cost)
    both = [name for name in names if (name, low) in cost and (name, high) in cost]
    return [(name, cost[name, high] / cost[name, low] * (low / high) ** 2) for name in both]


# ── cells of a table ─────────────────────────────────────────────────────────


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
