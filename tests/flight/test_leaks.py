"""A flight gives all of it back: textures, programs, meshes and surfaces."""

from __future__ import annotations

import pytest

from playground.engine.engine import Engine
from playground.flight.craft import Controls
from playground.flight.flight import Flight
from playground.flight.record import Moment


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
