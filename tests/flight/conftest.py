"""What the tests of a flight share: a small terrain without end, and a context with an engine."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import moderngl
import pytest

from playground.engine.engine import Engine
from playground.sketch.model import Sketch

from ..loading import load
from ..sketch_texts import passes

TERRAIN = (
    """format = 1
title = "A small terrain without end"
size = {size}
extent = {extent}
relief = 900.0
base_elevation = -150.0
"""
    + passes(
        height=("generation/endless", 'set = {{ apron = {apron}, hills = 64, "detail.octaves" = 3 }}'),
        colour=("texturing/endless_ground", "set = {{ apron = {apron}, patches = 16 }}"),
        light=(
            "lighting/soft_cone",
            "set = {{ gain = 1.0, ambient = 0.3, sun = {{ azimuth = 135, elevation = 35 }} }}",
        ),
    )
    + '[view]\nuse = "view/terrain"\nsamples = 1\n'
)
DAYLIGHT = """[[pass]]
name = "daylight"
use = "lighting/daylight"
set = { hour = 9.0 }
"""


@pytest.fixture
def small_engine(ctx: moderngl.Context) -> Iterator[Engine]:
    with Engine(ctx, cache_bytes=4 * 2**20) as made:
        yield made


@pytest.fixture
def terrain_of(tmp_path: Path) -> Callable[..., Sketch]:
    """Give ``land_of(intervals, apron, spacing)``: a sketch whose parts are that small."""

    def make(
        intervals: int = 16, apron: int = 8, spacing: float = 60.0, daylight: bool = False, **values: object
    ) -> Sketch:
        side = intervals + 2 * apron + 1
        text = TERRAIN.format(size=side, extent=spacing * (side - 1), apron=apron)
        if daylight:
            text = text.replace('[[pass]]\nname = "light"', f'{DAYLIGHT}[[pass]]\nname = "light"')
        path = tmp_path / f"small_{intervals}_{apron}_{daylight}.toml"
        path.write_text(text, encoding="utf-8")
        return load(path).with_values(values)

    return make
