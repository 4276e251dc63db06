"""Keyframes, angles that follow and accepted sizes in the page give what Python's give."""

from __future__ import annotations

import itertools
import random
from typing import Any

import pytest

from playground.publish.web.formulas import accepted_runs
from playground.shader import expressions
from playground.sketch.follows import Rule, follow
from playground.sketch.keyframes import EASES, Track

from .node import Node

TRACKS = """async (tracks, times, load) => {
    const { valueAt } = await load("values.js");
    return tracks.map((track) => times.map((time) => valueAt(track, time)));
}"""


def times(chance: random.Random) -> list[float]:
    gaps = [chance.choice([0.25, 1.0, chance.uniform(0.01, 9.0)]) for _ in range(chance.randint(1, 6))]
    return list(itertools.accumulate(gaps, initial=chance.uniform(-2.0, 2.0)))


def track(chance: random.Random) -> Track:
    at = times(chance)
    kind = chance.choice(["number", "vector", "angle", "direction", "whole", "menu", "flag", "colour"])
    make: dict[str, Any] = {
        "number": lambda: chance.choice([0.0, 1.0, chance.uniform(-5.0, 5.0)]),
        "vector": lambda: tuple(chance.uniform(-1e3, 1e3) for _ in range(3)),
        "angle": lambda: chance.choice([0.0, 180.0, 360.0, -180.0, chance.uniform(-720.0, 720.0)]),
        "direction": lambda: (chance.choice([0.0, 170.0, 350.0, 190.0]), chance.uniform(-90.0, 90.0)),
        "whole": lambda: chance.randint(-9, 9),
        "menu": lambda: chance.randrange(4),
        "flag": lambda: chance.random() < 0.5,
        "colour": lambda: tuple(chance.random() for _ in range(4)),
    }
    holds = kind in ("whole", "menu", "flag")
    eases = tuple(chance.choice(["smooth", "smooth", *EASES]) for _ in at)
    angles = (0,) if kind in ("angle", "direction") else ()
    return Track(tuple(at), tuple(make[kind]() for _ in at), eases, holds, angles)


def as_data(item: Track) -> dict[str, Any]:
    return {name: getattr(item, name) for name in ("times", "values", "eases", "holds", "angles")}


@pytest.mark.slow
def test_tracks_of_every_kind_give_the_same_to_the_last_bit(node: Node):
    chance = random.Random(3)
    tracks = [track(chance) for _ in range(400)]
    moments = [chance.uniform(-3.0, 20.0) for _ in range(60)] + [0.0, 0.25, 1.0, 1.25, 2.0]
    moments += [moment for item in tracks[:20] for moment in item.times]
    answers = node.run(TRACKS, [as_data(item) for item in tracks], moments)
    between = 0
    for item, answer in zip(tracks, answers, strict=True):
        for moment, value in zip(moments, answer, strict=True):
            expected = item.at(moment)
            assert value == (list(expected) if isinstance(expected, tuple) else expected), (item, moment)
            between += expected not in item.values
    assert between > 5000, "most moments are before the first keyframe or after the last"


def test_what_follows_a_direction_does_so_until_it_is_set(node: Node):
    script = """async (rules, values, load) => {
        (await load("values.js")).follow(rules, values);
        return values;
    }"""
    rules = [
        Rule(("a.turn", "b.turn"), -360.0, "a.sun", "", 0),
        Rule(("c.turn",), -360.0, "c.sun", "c.form", 1),
        Rule(("d.turn",), 0.0, "a.sun", "", 0),
    ]
    for form, turn in itertools.product((0, 1), (-360.0, 12.0)):
        values: dict[str, Any] = {
            "a.turn": turn,
            "b.turn": -360.0,
            "a.sun": (135.0, 25.0),
            "c.turn": turn,
            "c.sun": (90.0, 1.0),
            "c.form": form,
            "d.turn": 1.0,
        }
        result = node.run(script, [{n: getattr(r, n) for n in Rule.__slots__} for r in rules], values)
        follow(rules, values)
        assert result == {k: list(v) if isinstance(v, tuple) else v for k, v in values.items()}


@pytest.mark.parametrize(
    "accepts",
    [
        "2**n + 1",
        "2**n, 2**m",
        "2**n + 1, m + 1",
        "2**(n + 1) or 2**n + 1, 2**(m + 1) or 2**m + 1",
        "n up to 4097",
        "2**(n - 1) up to 1000",
        "3 * n + 2 up to 50, 7",
    ],
)
def test_the_sizes_that_a_kernel_takes_are_the_same(node: Node, accepts: str):
    chance = random.Random(accepts)
    sides = [1, 2, 3, 16_384, *(2**k + d for k in range(1, 14) for d in (-1, 0, 1))]
    sizes = [(chance.choice(sides), chance.choice(sides)) for _ in range(150)]
    sizes += [(side, side) for side in sides]
    accepted = accepted_runs(accepts)
    result = node.each("plan.js", "nearestAccepted", [(accepted, size) for size in sizes])
    for size, near in zip(sizes, result, strict=True):
        assert (near == [list(size)]) == expressions.is_accepted(accepts, size)
        assert near == [list(item) for item in expressions.nearest_accepted(accepts, size)]
