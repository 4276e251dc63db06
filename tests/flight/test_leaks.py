"""A flight gives all of it back: textures, programs, meshes and surfaces."""

from __future__ import annotations

import gc

import pytest

from playground.engine.engine import Engine
from playground.errors import SketchError
from playground.flight.craft import Controls
from playground.flight.flight import Flight
from playground.flight.layout import plot_of
from playground.flight.record import Moment
from playground.flight.scene import Scene
from playground.sketch.load import load


@pytest.mark.slow
@pytest.mark.parametrize("samples", [1, 4])
def test_after_a_flight_nothing_of_it_is_left(ctx, terrain_of, alive, samples):
    with Engine(ctx, cache_bytes=2**20) as engine:
        engine.texture(terrain_of(daylight=True), "light")
        with Flight(engine, terrain_of(daylight=True), radius=1.5, samples=samples) as flight:
            before = dict(alive)
            for number in range(40):
                flight.step(
                    Moment(Controls(100, 0, 40, 0), hour=8.0 + number / 4 if number % 9 == 0 else None)
                )
                if number % 10 == 0:
                    flight.draw((64 + number, 36))
            flight.parts.tend_for(0.0)  # a part is half made
            assert sum(alive.values()) > sum(before.values())
    assert {kind: number for kind, number in alive.items() if number} == {}


@pytest.mark.parametrize("name", ["_take_daylight", "Scene"])
def test_a_flight_that_cannot_begin_leaves_nothing(ctx, terrain_of, alive, monkeypatch, name):
    def refuse(*_: object) -> None:
        raise SketchError("no flight")

    monkeypatch.setattr(f"playground.flight.flight.{name}", refuse)
    with Engine(ctx, cache_bytes=2**20) as engine, pytest.raises(SketchError, match="no flight"):
        Flight(engine, terrain_of(daylight=True), radius=1.5, samples=1)
    assert {kind: number for kind, number in alive.items() if number} == {}


def test_a_scene_whose_trees_fail_leaves_nothing(ctx, alive, monkeypatch):
    def refuse(*_: object) -> None:
        raise SketchError("no trees")

    monkeypatch.setattr("playground.flight.scene.Woods", refuse)
    with Engine(ctx, cache_bytes=2**20) as engine:
        plot = plot_of(load("flight"), engine)
        with pytest.raises(SketchError, match="no trees"):
            Scene(engine, plot, 1)
    gc.collect()  # an engine that was dropped would be reported
    assert {kind: number for kind, number in alive.items() if number} == {}
