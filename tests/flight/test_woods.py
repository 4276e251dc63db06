"""Trees of a flight: where they stand, whatever part is asked, and that none pops."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import moderngl
import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.textures import read_picture
from playground.errors import SketchError
from playground.flight import programs
from playground.flight.flight import Flight
from playground.flight.layout import plot_of
from playground.flight.parts import Parts, Planter, cells_of

from ..loading import load

WOODS = """
[[pass]]
name = "density"
use = "trees/density"
set = {{ maximum = {most}, steep = [4.0, 5.0] }}
[view]"""
CELL = 9.0
JITTER = 0.8  # of a cell, where its tree may stand


def wooded(terrain_of, most: float = 0.6, daylight: bool = True):
    path = Path(terrain_of(daylight=daylight).file)
    text = path.read_text("utf-8").replace("\n[view]", WOODS.format(most=most))
    path.write_text(text.replace('use = "view/terrain"', 'use = "view/terrain"\nset = { sky = "daylight" }'))
    return load(path)


def random_of(cell: tuple[int, int], salt: int) -> tuple[float, float, float]:
    """Return the three numbers of a cell, by Python's whole numbers (noise/hash)."""
    x, y, z = ((n * 1664525 + 1013904223) % 2**32 for n in (cell[0] % 2**32, cell[1] % 2**32, salt % 2**32))
    for last in (False, True):
        x = (x + y * z) % 2**32
        y = (y + z * x) % 2**32
        z = (z + x * y) % 2**32
        if not last:
            x, y, z = (n ^ n >> 16 for n in (x, y, z))
    return (x >> 8) / 2**24, (y >> 8) / 2**24, (z >> 8) / 2**24


@pytest.fixture
def planted(small_engine, terrain_of) -> Iterator:
    sketch = wooded(terrain_of)
    plot = plot_of(sketch, small_engine)
    parts, planter = Parts(small_engine, plot, 1.5), Planter(small_engine.ctx, plot)

    def plant(part):
        slot = parts.make(part)
        return planter.plant(part, slot.heights, slot.woods).trees

    yield plot, plant
    planter.release()
    parts.release()


@pytest.mark.slow
def test_trees_follow_world_cells_and_match_at_part_borders(planted):
    """Each tree of two parts against the twin: none is missing, none is twice, wherever the border is."""
    plot, plant = planted
    cells, side = cells_of(plot)
    assert cells * side == pytest.approx(plot.width) and abs(side / CELL - 1) < 0.1
    for part in ((-1, 2), (0, 2)):
        grove = plant(part)
        expected = []
        for y in range(cells):
            for x in range(cells):
                here = (part[0] * cells + x, part[1] * cells + y)
                east, north, chance = random_of(here, 5 + 0xC07A7689)
                if chance < 0.5:
                    expected.append((x + 0.5 + JITTER * (east - 0.5), y + 0.5 + JITTER * (north - 0.5)))
        have = grove[:, :2] / side
        cell_of = {tuple(np.floor(position).astype(int)): position for position in have}
        assert len(cell_of) == len(have), "no cell has two"
        truth = {tuple(np.floor(position).astype(int)): position for position in expected}
        # Of the density of 0.6 a little is lost where it is uneven: what is below a half is there for sure.
        for cell, position in truth.items():
            if cell in cell_of:
                np.testing.assert_allclose(cell_of[cell], position, atol=2e-3)
        high = grove[:, 5].min()
        assert high > 0.5 and set(truth) <= set(cell_of)
        share, many = len(have) / cells**2, cells**2
        assert abs(share - grove[:, 5].mean()) < 4 * np.sqrt(0.24 / many)


@pytest.mark.slow
def test_a_part_that_is_made_again_has_the_same_trees(planted):
    _, plant = planted
    np.testing.assert_array_equal(plant((3, -2)), plant((3, -2)))


def test_no_density_means_no_trees_and_unlit_trees_are_refused(small_engine, terrain_of):
    assert plot_of(terrain_of(daylight=True), small_engine).trees is None
    with pytest.raises(SketchError, match="'density' has trees, which are lit by a pass 'daylight'"):
        plot_of(wooded(terrain_of, daylight=False), small_engine)


# ── nothing pops ─────────────────────────────────────────────────────────────

FINE = (256, 144)  # [pixels] drawn, of which 4 x 4 are a pixel that is looked at
ACROSS = 4
STEP = 2.0  # [m] a frame: 120 m/s


def looked_at(flight: Flight) -> NDArray[np.float32]:
    fine = read_picture(flight.draw(FINE))[..., :3].astype(np.float32)
    height, width = FINE[1] // ACROSS, FINE[0] // ACROSS
    return fine.reshape(height, ACROSS, width, ACROSS, 3).mean(axis=(1, 3))


def pops(engine: Engine, frames: int) -> tuple[list[float], float, float]:
    """Return per frame the most that levels of detail alone change in a pixel, the contrast, and the bound.

    Each picture is drawn twice by one camera: with the trees that this eye has, and with those of the
    eye of the frame before. A tree's height in fine pixels where the first are left out, times how
    fast it fades, is how far its outline moves: two parts of the distance, over a fade of a fifth.
    """
    with Flight(engine, load("flight").with_values({"daylight.hour": 12}), samples=1, radius=2.0) as flight:
        woods = flight.scene.woods
        assert woods is not None
        start, ahead = np.array([-0.5, -3.5]) * flight.plot.width, np.array([np.sin(0.3), np.cos(0.3)])
        flight.parts.look(*start, 0.3)
        way = [start + ahead * STEP * frame for frame in range(frames + 1)]
        up = max(flight.floor(*position) for position in way[::10]) + 60.0
        contrast, most = 0.0, []
        for frame in range(1, frames + 1):
            east, north = way[frame]
            flight.craft = replace(flight.craft, east=east, north=north, up=up, heading=0.3)
            flight.parts.look(east, north, 0.3)
            flight.make_all()
            now = looked_at(flight)
            woods.level_from = (*way[frame - 1], up)
            most.append(float(np.abs(now - looked_at(flight)).max()))
            woods.level_from = None
            if frame % 100 == 1:
                drawn, woods.draw = woods.draw, lambda values: None  # type: ignore[method-assign]
                contrast = max(contrast, float(np.abs(now - looked_at(flight)).max()))
                woods.draw = drawn  # type: ignore[method-assign]
        pixel = np.radians(58.0) / FINE[1]
        assert flight.plot.trees is not None
        whole = flight.plot.trees["tallest"] / (12.0 * pixel)  # 12 pixels tall
        shift = 12.0 * 2.0 * (STEP / whole) / 0.2
    assert shift < 1.0, "an outline moves by less than a fine pixel, so that it takes one of each it crosses"
    return most, contrast, contrast * np.sqrt(2) * ACROSS / ACROSS**2


@pytest.mark.slow
def test_no_tree_pops_along_a_flight_of_240_frames(ctx: moderngl.Context) -> None:
    """A crown that pops is a whole pixel; an outline that fades crosses it, √2 times its side at most."""
    with Engine(ctx, cache_bytes=128 * 2**20) as engine:
        most, contrast, bound = pops(engine, 240)
    assert contrast > 60.0, "there are trees"
    assert max(most) <= bound


@pytest.mark.slow
def test_without_the_fade_trees_would_pop(ctx: moderngl.Context, monkeypatch: pytest.MonkeyPatch) -> None:
    read = programs.read_shader
    monkeypatch.setattr(programs, "read_shader", lambda name: read(name).replace("* small *", "*"))
    with Engine(ctx, cache_bytes=128 * 2**20) as engine:
        most, _, bound = pops(engine, 120)
    assert max(most) > bound
