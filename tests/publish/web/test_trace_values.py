"""Pages join what a traced shader records as Python does: the same calls, iterations and values."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

import pytest

from playground.engine.trace.listing import text_of
from playground.engine.trace.model import LEAF_TYPES, LENGTH, MARK, MATRICES, Event, Leaf, Place, rebuild

from .node import Node

STRUCTS = {
    "Inner": (("level", "float"), ("at", "ivec2")),
    "Outer": (("inner", "Inner"), ("rows", "vec2[]"), ("is_on", "bool")),
}
TYPES = [*LEAF_TYPES, "mat2", "mat3x2", "mat4", "float[3]", "ivec2[]", "Inner", "Outer", "Inner[2]"]


def leaves_of(number: int, kind: str, chance: random.Random) -> list[Leaf]:
    """Return the leaves of a random value of a type."""

    def leaf(code: int, *bits: int) -> Leaf:
        drawn = [
            chance.choice((0, 1, 0x3F800000, 0x7FC00000, 0xFF800000, chance.getrandbits(32))) for _ in "xyzw"
        ]
        return Leaf(number, code, tuple([*bits, *drawn][:4]))  # type: ignore[arg-type]

    if not kind:
        return [leaf(MARK)]
    if "[" in kind:
        length = chance.randrange(1, 20)
        recorded = min(length, 16)
        parts = [part for _ in range(recorded) for part in leaves_of(number, kind.partition("[")[0], chance)]
        return [leaf(LENGTH, length, recorded), *parts]
    if kind in MATRICES:
        columns, rows = MATRICES[kind]
        return [leaf(LEAF_TYPES.index(f"vec{rows}")) for _ in range(columns)]
    if kind in STRUCTS:
        return [part for _, member in STRUCTS[kind] for part in leaves_of(number, member, chance)]
    return [leaf(LEAF_TYPES.index(kind))]


def run_of(chance: random.Random) -> tuple[list[Place], list[Leaf]]:
    """Return the places of a random text, and what a random run of it records."""
    places: list[Place] = []
    for number in range(14):
        kind = chance.choice(
            ["enter", "argument", "set", "iteration", "condition", "return", "leave", "discard"]
        )
        has_value = kind in ("argument", "set", "return") or (kind == "iteration" and chance.random() < 0.7)
        typed = "bool" if kind == "condition" else chance.choice(TYPES) if has_value else ""
        iterations = [n for n, place in enumerate(places) if place.kind == "iteration"]
        inside = chance.choice(iterations) if iterations and chance.random() < 0.6 else None
        loops = () if inside is None else (*places[inside].loops, inside)
        line = number + 1
        places.append(Place(kind, f"n{number}", f"f{number % 3}", typed, "/a", line, 1, line + 3, 2, loops))
    numbers = [chance.randrange(14) for _ in range(60)]
    leaves = [leaf for number in numbers for leaf in leaves_of(number, places[number].type, chance)]
    return places, leaves[: chance.randrange(20, len(leaves))]


def plain(value: Any, kind: str) -> Any:
    """Return a value of a trace as the runtime has it; numbers that are not finite as texts."""
    if isinstance(value, list):
        return [plain(part, kind.partition("[")[0]) for part in value]
    if isinstance(value, dict):
        return [[name, plain(value[name], member), member] for name, member in STRUCTS[kind]]
    if isinstance(value, tuple):
        return [plain(part, "") for part in value]
    return number(value)


def number(value: Any) -> Any:
    """Return a number as one that JSON does not change and that equals itself."""
    if isinstance(value, bool) or value is None:
        return value
    return float(value) if math.isfinite(value) else str(float(value))


def same(value: Any) -> Any:
    """Return a value of the runtime without the words that say what it is."""
    if isinstance(value, dict):
        if "members" in value:
            return [[name, same(part), member] for name, part, member in value["members"]]
        return [same(part) for part in value["elements"]]
    if isinstance(value, list):
        return [same(part) for part in value]
    return number(value)


def facts(event: Event) -> list[Any]:
    value = plain(event.value, event.type)
    return [event.place, value, event.call, list(event.iterations), list(event.around)]


@pytest.mark.parametrize("seed", range(6))
def test_random_runs_are_joined_alike(node: Node, seed: int) -> None:
    chance = random.Random(seed)
    places, leaves = run_of(chance)
    rows = [{**asdict(place), "file": place.path, "endLine": place.end_line} for place in places]
    answer = node.run(
        "async (values, load) => (await load('trace_values.js')).rebuild(...values)",
        [rows, STRUCTS, [leaf._asdict() for leaf in leaves]],
    )
    calls, events = rebuild(places, STRUCTS, leaves)
    assert len(events) > 10
    texts = node.each(
        "trace_view.js", "textOf", [(e["value"], places[e["at"]].type) for e in answer["events"]]
    )
    assert texts == [text_of(event.value) for event in events]
    ours = [[e["at"], same(e["value"]), e["call"], e["iterations"], e["around"]] for e in answer["events"]]
    assert ours == [facts(event) for event in events]
    heads = [(call.function, call.line, call.end_line, call.depth, len(call.events)) for call in calls]
    theirs: Sequence[Any] = answer["calls"]
    assert [(c["function"], c["line"], c["endLine"], c["depth"], len(c["events"])) for c in theirs] == heads
