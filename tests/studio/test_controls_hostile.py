"""Whatever a remote asks ends well or in a message: wrong types, names and nestings, by chance."""

from __future__ import annotations

import random
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.studio.remote.controls import Behind, Controls
from playground.studio.remote.osc import Addresses

from .remote_desk import Harness, write_sketch

PATHS = [
    "height.level",
    "height.sun",
    "height.kind",
    "height.rocks",
    "height.tint",
    "height.grass",
    "height.fire",
]
PATHS += [
    "relief",
    "extent",
    "height",
    "",
    ".",
    "height.",
    "..",
    "height.level.x",
    "no.such",
    "view.lowest",
    "x" * 999,
]


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine) -> Iterator[Harness]:
    made = Harness(any_engine, write_sketch(tmp_path / "hills"))
    yield made
    made.close()


def anything(chance: random.Random, depth: int = 0) -> Any:
    """Return a value as JSON may hold one."""
    simple = [
        None,
        True,
        False,
        0,
        1,
        -1,
        10**30,
        0.5,
        1e308,
        float("inf"),
        "",
        "0.5",
        "flat",
        "#12",
        "1,2",
        "\0",
        "😀",
    ]
    if depth > 2 or chance.random() < 0.6:
        return chance.choice(simple)
    if chance.random() < 0.5:
        return [anything(chance, depth + 1) for _ in range(chance.randrange(5))]
    return {chance.choice([*PATHS, "azimuth", "elevation"]): anything(chance, depth + 1) for _ in range(3)}


@pytest.mark.always
@pytest.mark.parametrize("seed", range(4))
def test_what_is_asked_by_chance_ends_in_a_sentence_at_worst(harness: Harness, seed: int):
    chance, controls = random.Random(seed), Controls(harness.bench)
    addresses = Addresses(controls)
    refused = 0
    for _ in range(400):
        name = chance.choice([*controls.names, "set", "set", "st"])
        value = anything(chance)
        if name == "set" and chance.random() < 0.8:
            value = {chance.choice(PATHS): anything(chance) for _ in range(chance.randrange(3))}
        try:
            controls.do({name: value})
        except PlaygroundError as error:
            refused += 1
            assert "\n" not in str(error) and len(str(error)) < 2000
        arguments = [anything(chance) for _ in range(chance.randrange(4))]
        words = chance.choice([*PATHS, "playground.time", "playground.preset", "playground.x"])
        addresses.receive("/" + words.replace(".", "/"), arguments)
    controls.reset("height.grass")  # it may name a file that is not there, as in the panel
    harness.frame()
    assert refused > 50 and harness.session.error is None and controls.parameters()


@pytest.mark.parametrize(
    ("source", "what"),
    [("", "computes frame 5 of 36,001"), ("height", "makes height, 5 of 36,001")],
)
def test_a_picture_that_is_not_there_yet_is_said_once(harness: Harness, source: str, what: str):
    harness.frame()
    harness.session.catch_up.behind, harness.session.catch_up.source = (5, 36_001), source
    with pytest.raises(Behind) as met:
        Controls(harness.bench).picture()
    assert str(met.value) == f"there is no picture yet: the window {what}"
