"""What ``playground bench`` measures: the rows of the TOML files in ``rows/``, one a suite, and of rooms.

A row has a ``name``, a message in ``what``, and how it is measured in ``measure``: see ``measures``, and
``MEASURES`` and ``ROWS`` of the modules ``measures`` of rooms. ``goal`` is what it should reach; ``peers``
are what it is compared with. Its other keys are its measure's.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from functools import cache
from pathlib import Path
from typing import Any

from playground.errors import ParameterError, nearest
from playground.rooms import modules

FOLDER = Path(__file__).resolve().parent / "rows"
_BESIDE = "beside"  # a peer of a frame, drawn by its measure
_OWN = {"name", "what", "measure", "goal", "peers", "sized"}


@dataclass(frozen=True)
class Goal:
    """What a row should reach: at most so many milliseconds, or at least so many times a peer's speed."""

    most: float = 0.0  # of the row's unit; 0: none
    times: float = 0.0  # as fast as the peer; 0: none
    than: str = ""  # the peer, by the beginning of its name
    at: int = 1025  # texels a side for which it holds, of a row that has sizes

    def __str__(self) -> str:
        if self.times:
            return f"≥ {self.times:g} ×"
        return f"≤ {self.most:g}" if self.most else ""


@dataclass(frozen=True)
class Row:
    """One row of a suite."""

    suite: str
    name: str
    what: str
    measure: str
    goal: Goal = Goal()
    peers: tuple[Mapping[str, Any], ...] = ()
    sized: bool = True  # whether it is measured at the sizes that are asked for
    options: Mapping[str, Any] = field(default_factory=dict)  # its measure's own

    def alone(self) -> Row:
        """Return the row without what it is compared with."""
        options = {key: value for key, value in self.options.items() if key != _BESIDE}
        return replace(self, peers=(), options=options)


@cache
def suites() -> dict[str, tuple[Row, ...]]:
    """Return the rows of every suite, by the suite's name; a room's is named after it."""
    files = {path.stem: path for path in sorted(FOLDER.glob("*.toml"))}
    files |= {module.__name__.split(".")[1]: module.ROWS for module in modules("measures")}
    return {suite: tuple(_rows(suite, path)) for suite, path in files.items()}


def _rows(suite: str, path: Path) -> list[Row]:
    with path.open("rb") as file:
        read = tomllib.load(file)
    rows = [{**read.get("shared", {}), **each} for each in read["row"]]
    return [
        Row(
            suite,
            each["name"],
            each["what"],
            each["measure"],
            Goal(**each.get("goal", {})),
            tuple(each.get("peers", ())),
            each.get("sized", True),
            {key: value for key, value in each.items() if key not in _OWN},
        )
        for each in rows
    ]


def chosen(names: Sequence[str]) -> list[Row]:
    """Return the rows of suites and rows by name, which may have * and ?; all, of no name.

    Raises ``ParameterError`` with the nearest name for one that is of nothing.
    """
    every = [row for rows in suites().values() for row in rows]
    if not names:
        return every
    for name in names:
        if not any(_named(row, name) for row in every):
            known_names = [*suites(), *(row.name for row in every)]
            raise ParameterError(f"no suite or row '{name}'{nearest(name, known_names)}")
    return [row for row in every if any(_named(row, name) for name in names)]


def _named(row: Row, name: str) -> bool:
    return name == row.suite or fnmatchcase(row.name, name)
