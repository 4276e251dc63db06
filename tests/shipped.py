"""The shipped sketches as parameters of tests: a few of every kind are for every day, the others are slow."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator
from typing import Any

import pytest

from playground.paths import SKETCHES
from playground.rooms import ROOMS
from playground.sketch.find import shipped_sketches

FEW_SKETCHES = (
    "contours_map",  # a map
    "delaunay",  # a mesh of its own
    "diamond_square",  # sizes that fit a rule, steps
    "geomipmap",  # levels of detail
    "jacksboro",  # a land that was measured
    "life",  # feedback
    "splat",  # images
    "sun_flight",  # keyframes
    *(() if "dialects" not in ROOMS else ("flood", "from_elsewhere")),  # passes of other tools, a state
)
GIVEN = ("set", "inputs", "params", "presets")  # tables whose keys are names, not words of the format


def words_of(table: Any) -> Iterator[str]:
    """Yield the words of the format that a sketch's file uses, and the families of its techniques."""
    if isinstance(table, list):
        for entry in table:
            yield from words_of(entry)
    elif isinstance(table, dict):
        for key, value in table.items():
            yield key
            if key == "use" and isinstance(value, str):
                yield value.split("/")[0]  # the family of the technique
            if key not in GIVEN:
                yield from words_of(value)


def of_each_kind() -> tuple[str, ...]:
    """Return the few, and others, the fewest found greedily, until every such word is used."""
    words = {
        name: set(words_of(tomllib.loads((SKETCHES / f"{name}.toml").read_text(encoding="utf-8"))))
        for name in shipped_sketches()
    }
    chosen = dict.fromkeys(FEW_SKETCHES)
    missing = set().union(*words.values()).difference(*(words[name] for name in FEW_SKETCHES))
    while missing:
        most = max(words, key=lambda name: len(words[name] & missing))
        chosen[most] = None
        missing -= words[most]
    return tuple(sorted(chosen))


def slow_but(names: Iterable[str]) -> list[Any]:
    """Return parameters for tests, slow ones but for the few."""
    return [
        pytest.param(name, id=name, marks=() if name in FEW_SKETCHES else pytest.mark.slow) for name in names
    ]


SHIPPED = slow_but(shipped_sketches())
EACH_KIND = slow_but(of_each_kind())  # for what is no test of the library, but of the format
