"""Runs broken into lines: words of several fonts and formulas on one baseline."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, replace

from playground.course.window.markdown_runs import Run, Runs

_WHOLE = 28
"""Letters of code in a text that are not parted."""
_WORDS = re.compile(r"[ \n]+|[^ \n]+")  # a no-break space does not part words


@dataclass(frozen=True)
class Extent:
    """How much room something takes, in the window's units."""

    width: float
    ascent: float  # above the baseline
    descent: float  # below it


@dataclass(frozen=True)
class Placed:
    """A run on a line."""

    run: Run
    x: float
    extent: Extent


@dataclass(frozen=True)
class Line:
    """A line of runs."""

    runs: tuple[Placed, ...]
    ascent: float
    descent: float

    @property
    def width(self) -> float:
        """The right end of the last run."""
        return max((p.x + p.extent.width for p in self.runs), default=0.0)


Ruler = Callable[[Run], Extent]


def broken(runs: Runs, width: float, ruler: Ruler) -> tuple[Line, ...]:
    """Break runs into lines of at most a width; what is wider by itself is broken inside."""
    line: list[Placed] = []
    lines: list[Line] = []
    x = 0.0

    def end() -> None:
        nonlocal line, x
        while line and line[-1].run.text == " ":
            line.pop()
        lines.append(_joined(line, ruler))
        line, x = [], 0.0

    for cluster in _clusters(runs):
        if cluster[0].breaks:
            end()
            continue
        extents = [ruler(run) for run in cluster]
        wide = sum(extent.width for extent in extents)
        blank = cluster[0].text == " " and not cluster[0].formula
        if blank and not line:
            continue
        if line and not blank and x + wide > width:
            end()
        for run, extent in zip(cluster, extents, strict=True):
            for piece, size in _fitting(run, extent, width, ruler) if wide > width else ((run, extent),):
                if line and wide > width and x + size.width > width:
                    end()
                line.append(Placed(piece, x, size))
                x += size.width
    if line:
        end()
    return tuple(lines)


def _clusters(runs: Runs) -> list[list[Run]]:
    """Return what may not be separated: words with all that touches them, and the blanks between."""
    clusters: list[list[Run]] = []
    glued = False
    for run in runs:
        if run.breaks:
            clusters.append([run])
            glued = False
            continue
        whole = run.formula or (run.code and not run.alone and len(run.text) <= _WHOLE)
        pieces = [run.text] if whole else _WORDS.findall(run.text)
        for piece in pieces:
            if not whole and not piece.strip(" \n"):
                clusters.append([replace(run, text=" ")])
                glued = False
            elif glued:
                clusters[-1].append(replace(run, text=piece))
            else:
                clusters.append([replace(run, text=piece)])
                glued = True
    return clusters


def _fitting(run: Run, extent: Extent, width: float, ruler: Ruler) -> list[tuple[Run, Extent]]:
    """Return a run in pieces that are no wider than a line."""
    if run.formula or extent.width <= width or len(run.text) < 2:
        return [(run, extent)]
    most = max(int(len(run.text) * width / extent.width), 1)
    pieces = [replace(run, text=run.text[at : at + most]) for at in range(0, len(run.text), most)]
    return [(piece, ruler(piece)) for piece in pieces]


def _joined(line: list[Placed], ruler: Ruler) -> Line:
    """Return a line, neighbours in one style as one run."""
    keys_by_action: list[Placed] = []
    for positioned in line:
        last = keys_by_action[-1] if keys_by_action else None
        if (
            last is not None
            and not positioned.run.formula
            and replace(last.run, text="") == replace(positioned.run, text="")
        ):
            width = last.extent.width + positioned.extent.width
            run = replace(last.run, text=last.run.text + positioned.run.text)
            keys_by_action[-1] = Placed(run, last.x, replace(last.extent, width=width))
        else:
            keys_by_action.append(positioned)
    plain = ruler(Run(""))
    ascent = max([plain.ascent, *(p.extent.ascent for p in keys_by_action)])
    descent = max([plain.descent, *(p.extent.descent for p in keys_by_action)])
    return Line(tuple(keys_by_action), ascent, descent)
