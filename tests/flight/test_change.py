"""A flight goes on over an edited sketch from where it is, once that is ready, and stays where it cannot."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.flight.craft import CLEARANCE
from playground.flight.flight import Flight
from playground.sketch.model import Sketch

from ..loading import load

SIZE = (48, 27)
SKETCH = """format = 1
size = 17
extent = 1600.0
relief = 500.0
[[pass]]
name = "height"
use = "./terrain"
[view]
use = "view/terrain"
"""
TERRAIN = """// terrain.glsl -- a plain
#pragma kernel(output = "height:r32f")
uniform ivec2 part = ivec2(0); //! parts("east", "north") Which
uniform float level = 0.25; //! slider(0, 4) How high
float kernel(ivec2 texel) { return level + 0.0 * float(part.x); }
"""


def sketch_of(folder: Path, terrain: str = TERRAIN) -> Sketch:
    (folder / "terrain.glsl").write_text(terrain, encoding="utf-8")
    (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return load(folder)


def test_edited_flight_continues_in_place_once_near_parts_ready(any_engine: Engine, tmp_path: Path) -> None:
    with Flight(any_engine, sketch_of(tmp_path), radius=1.5, samples=1) as flight:
        flight.make_all()
        for _ in range(30):
            flight.step()
        flight.make_all()
        craft, before = flight.craft, flight.picture(SIZE).array
        flight.change(sketch_of(tmp_path, TERRAIN.replace("0.25", "0.5")))
        assert flight.changing
        np.testing.assert_array_equal(flight.picture(SIZE).array, before, "it stays until all is ready")
        calls = 0
        while not flight.tend_change(0.0):
            calls += 1
        assert calls > 1 and not flight.changing and flight.parts.missing == 0
        assert (flight.craft.east, flight.craft.north, flight.craft.heading) == (
            craft.east,
            craft.north,
            craft.heading,
        )
        assert flight.parts.ground_at(craft.east, craft.north) == pytest.approx(0.5 * 500.0)
        assert (flight.picture(SIZE).array != before).any()


def test_new_ground_lifts_the_craft_over_it(any_engine: Engine, tmp_path: Path) -> None:
    with Flight(any_engine, sketch_of(tmp_path), radius=1.5, samples=1) as flight:
        flight.make_all()
        up = flight.craft.up
        flight.change(sketch_of(tmp_path, TERRAIN.replace("0.25", "3.0")))
        while not flight.tend_change(1.0):
            pass
        assert flight.craft.up == pytest.approx(1500.0 + CLEARANCE) and flight.craft.up > up


@pytest.mark.parametrize(
    "terrain",
    [
        TERRAIN.replace("uniform ivec2 part", "uniform ivec2 apart").replace("part.x", "apart.x"),
        TERRAIN.replace("return level", "return levl"),
    ],
    ids=["it cannot be cut into parts", "it does not compile"],
)
def test_what_cannot_be_flown_over_leaves_the_flight_as_it_is(
    any_engine: Engine, tmp_path: Path, terrain: str
) -> None:
    with Flight(any_engine, sketch_of(tmp_path), radius=1.5, samples=1) as flight:
        flight.make_all()
        before = flight.picture(SIZE).array
        with pytest.raises(PlaygroundError):
            flight.change(sketch_of(tmp_path, terrain))
            while not flight.tend_change(1.0):
                pass
        assert not flight.changing
        np.testing.assert_array_equal(flight.picture(SIZE).array, before)
        flight.step()


@pytest.mark.slow
def test_the_time_of_day_stays_unless_the_sketch_says_another(any_engine: Engine, tmp_path: Path) -> None:
    daylight = '[[pass]]\nname = "daylight"\nuse = "lighting/daylight"\nset = { hour = HOUR }\n[view]'

    def at(hour: str) -> Sketch:
        sketch_of(tmp_path)
        text = SKETCH.replace("[view]", daylight.replace("HOUR", hour))
        (tmp_path / "sketch.toml").write_text(text, encoding="utf-8")
        return load(tmp_path)

    def changed(flight: Flight, sketch: Sketch) -> float:
        flight.change(sketch)
        while not flight.tend_change(1.0):
            pass
        return flight.hour

    with Flight(any_engine, at("10.0"), radius=1.5, samples=1) as flight:
        flight.set_hour(17.0)
        flight.make_all()
        assert changed(flight, at("10.0").with_values({"height.level": 0.3})) == 17.0
        assert changed(flight, at("12.0")) == 12.0


@pytest.mark.slow
def test_nothing_is_left_on_the_graphics_card(ctx: Any, alive: Any, tmp_path: Path) -> None:
    sketches = [sketch_of(tmp_path, TERRAIN.replace("0.25", number)) for number in ("0.25", "0.5")]
    held = []
    with Engine(ctx) as engine, Flight(engine, sketches[0], radius=1.5, samples=1) as flight:
        flight.make_all()
        for count in range(4):
            flight.change(sketches[1 - count % 2])
            flight.tend_change(0.0)
            flight.change(sketches[1 - count % 2])  # saved again before the first was ready
            while not flight.tend_change(1.0):
                pass
            held.append((flight.parts.bytes, len(flight.parts)))
        flight.change(sketches[0])
        flight.tend_change(0.0)  # it is half made
    assert len(set(held)) == 1
    assert {kind: number for kind, number in alive.items() if number} == {}
