"""What a run of ``playground bench`` found: figures with every sample, as JSON.

The file has all that was measured, so that another run can be compared with it: see ``against``.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from playground.errors import DataError
from playground.files import read_regular, write_file
from playground.json_text import read_json
from playground.paths import shown
from playground.verify.bench.rows import Goal
from playground.verify.bench.timing import Samples

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
