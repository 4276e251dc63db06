"""Midpoint displacement against squares and segments divided one by one in float64, with the same numbers."""

from itertools import pairwise

import numpy as np
import pytest

from playground.errors import SketchError

from .drawing import FINEST_SIDE, salt


def by_squares(size, roughness, number):
    """Return the terrain of one square of height 0, divided in four until its sides are one texel long."""
    terrain = np.zeros((size, size))

    def divide(x, y, side, most):
        if side < 2:
            return
        h = side // 2
        corners = [(y, x), (y, x + side), (y + side, x), (y + side, x + side)]
        south_west, south_east, north_west, north_east = (terrain[c] for c in corners)
        for position, mean in (
            ((y, x + h), (south_west + south_east) / 2),
            ((y + side, x + h), (north_west + north_east) / 2),
            ((y + h, x), (south_west + north_west) / 2),
            ((y + h, x + side), (south_east + north_east) / 2),
            ((y + h, x + h), (south_west + south_east + north_west + north_east) / 4),
        ):
            terrain[position] = mean + number(position[1], position[0]) * most
        for dx in (0, h):
            for dy in (0, h):
                divide(x + dx, y + dy, h, most * roughness)

    divide(0, 0, size - 1, 1.0)
    return terrain


def by_a_growing_list(length, steps, roughness, number):
    """Return the line after so many steps: a list that a midpoint is put into between each two points."""
    points = [(0, 0.0), (length - 1, 0.0)]
    most = 1.0
    for _ in range(steps):
        if points[1][0] - points[0][0] < 2:
            break
        grown = points[:1]
        for (x, h), (to, g) in pairwise(points):
            middle = (x + to) // 2
            grown += [(middle, (h + g) / 2 + number(middle, 0) * most), (to, g)]
        points = grown
        most *= roughness
    return np.interp(np.arange(length), [x for x, _ in points], [h for _, h in points])


def sketch_of(make_sketch, size, use="generation/midpoint_displacement", **values):
    text = "".join(f"{k} = {v!r}\n" for k, v in values.items())
    return make_sketch(f'[[pass]]\nname = "terrain"\nuse = "{use}"\n[pass.set]\n{text}', size=size)


def segment_of(make_sketch, length, rows, **values):
    return sketch_of(make_sketch, [length, rows], "generation/midpoint_displacement/segment", **values)


@pytest.fixture
def number(python_random):
    def of(seed, length, name=""):
        apart = FINEST_SIDE // (length - 1)
        drawn = seed + salt("generation/midpoint_displacement" + name)
        return lambda x, y: 2.0 * float(python_random(x * apart, y * apart, drawn)) - 1.0

    return of


@pytest.mark.parametrize("size", [2, 3, 5, 9, 17, 65])
@pytest.mark.parametrize("roughness", [0.5, 0.7])
def test_it_is_squares_divided_in_four(engine, make_sketch, number, size, roughness):
    sketch = sketch_of(make_sketch, size, roughness=roughness, seed=11)
    truth = by_squares(size, roughness, number(11, size))
    np.testing.assert_allclose(engine.read(sketch, "terrain.raw"), truth, atol=2e-6)


@pytest.mark.parametrize("size", [2, 5, 129, 1025])
def test_both_drivers_give_the_same_bits(same_by_both_drivers, make_sketch, size):
    sketch = sketch_of(make_sketch, size, roughness=0.6, seed=2)
    same_by_both_drivers(lambda engine: engine.read(sketch, "terrain.raw"))


def test_each_iteration_divides_every_square(engine, make_sketch, number):
    sketch = sketch_of(make_sketch, 17, seed=5)
    truth = by_squares(17, 0.5, number(5, 17))
    for turn, values in engine.steps(sketch, "terrain.raw"):
        step = 16 >> turn
        existing = np.zeros((17, 17), bool)
        existing[::step, ::step] = True
        assert not values[~existing].any()
        np.testing.assert_allclose(values[existing], truth[existing], atol=2e-6)
        assert (values != 0).sum() == existing.sum() - 4, "the terrain begins as 0, and its corners stay so"


def test_roughness_is_what_is_left_of_the_numbers_each_turn(engine, make_sketch):
    """Without it the first turn alone displaces; with all of it, the last as much as the first."""
    once = engine.read(sketch_of(make_sketch, 33, roughness=0.0, seed=3), "terrain.raw").astype(float)
    for block in (once[:17, :17], once[:17, 16:], once[16:, :17], once[16:, 16:]):
        bend = block[2:, 1:-1] - 2 * block[1:-1, 1:-1] + block[:-2, 1:-1]
        np.testing.assert_allclose(bend, 0, atol=1e-6, err_msg="a quarter is ruled by straight lines")
    steps = [
        np.abs(np.diff(engine.read(sketch_of(make_sketch, 129, roughness=q), "terrain.raw"))).mean()
        for q in (0.3, 0.5, 0.7, 1.0)
    ]
    assert all(b > 1.5 * a for a, b in pairwise(steps))


@pytest.mark.parametrize("size", [3, 65])
def test_it_is_normalised_by_default(engine, make_sketch, size):
    terrain = engine.read(sketch_of(make_sketch, size), "terrain")
    assert terrain.min() == 0 and terrain.max() == 1
    plain = sketch_of(make_sketch, size, normalise="none")
    np.testing.assert_array_equal(engine.read(plain, "terrain"), engine.read(plain, "terrain.raw"))


def test_the_smallest_terrain_has_no_middle_and_is_flat(engine, make_sketch):
    for normalise in ("none", "max", "minmax"):
        terrain = engine.read(sketch_of(make_sketch, 2, normalise=normalise), "terrain")
        np.testing.assert_array_equal(terrain, 0)


def test_seeds_are_terrains(engine, make_sketch):
    terrains = [engine.read(sketch_of(make_sketch, 65, seed=s), "terrain") for s in (1, 2, 1)]
    np.testing.assert_array_equal(terrains[0], terrains[2])
    assert np.abs(terrains[0] - terrains[1]).max() > 0.01


def test_a_size_it_cannot_halve_is_refused_with_the_nearest(any_engine, make_sketch):
    with pytest.raises(SketchError, match="65 x 65 or 129 x 129"):
        any_engine.read(sketch_of(make_sketch, 100), "terrain")


# ── the segment ──────────────────────────────────────────────────────────────


@pytest.mark.parametrize(("length", "rows"), [(2, 1), (2, 4), (3, 3), (33, 7), (257, 9)])
@pytest.mark.parametrize("roughness", [0.5, 0.8])
def test_each_row_is_the_line_after_so_many_steps(engine, make_sketch, number, length, rows, roughness):
    lines = engine.read(segment_of(make_sketch, length, rows, roughness=roughness, seed=6), "terrain")
    truth = [by_a_growing_list(length, k, roughness, number(6, length, "/segment")) for k in range(rows)]
    np.testing.assert_allclose(lines, truth, atol=2e-6)


def test_both_drivers_draw_the_same_line(same_by_both_drivers, make_sketch):
    sketch = segment_of(make_sketch, 513, 11, seed=9)
    same_by_both_drivers(lambda engine: engine.read(sketch, "terrain"))


def test_a_step_keeps_the_points_that_were_there(engine, make_sketch):
    lines = engine.read(segment_of(make_sketch, 65, 9, seed=2), "terrain")
    assert not lines[0].any()
    for k in range(1, 9):
        kept = max(64 >> (k - 1), 1)
        np.testing.assert_array_equal(lines[k, ::kept], lines[k - 1, ::kept])
    np.testing.assert_array_equal(lines[6], lines[8], "after six steps every texel is a point")
