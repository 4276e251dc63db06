"""Terrains made by halving, against squares and triangles divided one by one in float64."""

from itertools import pairwise

import numpy as np
import pytest

from ..sketch_texts import passes, use, view
from ..truth.noise import FINEST_SIDE, python_random, salt
from .conftest import BOTH_TEXTS

DIAMOND, MIDPOINT = "generation/diamond_square", "generation/midpoint_displacement"
TRIANGLES, SEGMENT = "generation/triangle_subdivision", "generation/midpoint_displacement/segment"
CORNERS = (0.1, 0.7, 0.4, 0.9)  # south-west, south-east, north-west, north-east


def numbers(size, technique, seed, positive=False):
    """Return the random number of each point."""
    y, x = np.mgrid[0:size, 0:size] * (FINEST_SIDE // (size - 1))
    drawn = python_random(x, y, seed + salt(technique))
    return drawn if positive else 2 * drawn - 1


def by_the_thesis(size, smoothing, corners, number):
    """Return the terrain as section 4.3.1's loops make it, points[i][j] with i up and j along.

    ``number[i, j]`` is the random number; the spacing is taken over the side.
    """
    side = size - 1
    points = [[0.0] * size for _ in range(size)]
    points[0][0], points[0][side], points[side][0], points[side][side] = corners
    spacing = side

    def mean(i, j, neighbours):
        kept = [points[a][b] for a, b in neighbours if 0 <= a < size and 0 <= b < size]
        return sum(kept) / len(kept) + number[i, j] * spacing / side * smoothing

    while spacing > 1:
        h = spacing // 2
        for i in range(h, size, spacing):
            for j in range(h, size, spacing):
                points[i][j] = mean(i, j, [(i - h, j - h), (i - h, j + h), (i + h, j - h), (i + h, j + h)])
        for i in range(0, size, h):
            for j in range(h if (i // h) % 2 == 0 else 0, size, spacing):
                points[i][j] = mean(i, j, [(i - h, j), (i + h, j), (i, j - h), (i, j + h)])
        spacing = h
    return np.array(points)


def by_slices(size, smoothing, corners, numbers):
    """Return the same, level by level with whole arrays: quick enough for 1025²."""
    terrain = np.full((size, size), np.nan)
    terrain[0, 0], terrain[0, -1], terrain[-1, 0], terrain[-1, -1] = corners
    spacing = size - 1
    while spacing > 1:
        h = spacing // 2
        share = spacing / (size - 1) * smoothing
        existing = terrain[::spacing, ::spacing]
        terrain[h::spacing, h::spacing] = (
            existing[:-1, :-1] + existing[:-1, 1:] + existing[1:, :-1] + existing[1:, 1:]
        ) / 4
        terrain[h::spacing, h::spacing] += numbers[h::spacing, h::spacing] * share
        rim = np.pad(terrain[::h, ::h], 1, constant_values=np.nan)
        around = np.stack([rim[:-2, 1:-1], rim[2:, 1:-1], rim[1:-1, :-2], rim[1:-1, 2:]])
        mean = np.nansum(around, axis=0) / np.maximum((~np.isnan(around)).sum(axis=0), 1)
        odd = np.add.outer(np.arange(mean.shape[0]), np.arange(mean.shape[1])) % 2 == 1
        terrain[::h, ::h] = np.where(odd, mean + numbers[::h, ::h] * share, terrain[::h, ::h])
        spacing = h
    return terrain


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
            terrain[position] = mean + number[position] * most
        for dx in (0, h):
            for dy in (0, h):
                divide(x + dx, y + dy, h, most * roughness)

    divide(0, 0, size - 1, 1.0)
    return terrain


def by_triangles(size, r, corners, number):
    """Return the terrain of two triangles, each divided in four until its edges are one texel long.

    ``corners`` are given, or None: drawn like every other number. ``number[y, x]`` is the
    random number in [-1, 1) of a place; an edge of length k displaces its middle by k^r of it.
    """
    side = size - 1
    places = [(0, 0), (side, 0), (0, side), (side, side)]
    heights = dict(zip(places, corners or [number[y, x] for x, y in places], strict=True))

    def middle(a, b):
        position = ((a[0] + b[0]) // 2, (a[1] + b[1]) // 2)
        if position not in heights:
            k = np.hypot(a[0] - b[0], a[1] - b[1]) / side
            heights[position] = (heights[a] + heights[b]) / 2 + number[position[::-1]] * k**r
        return position

    south_west, south_east, north_west, north_east = places
    triangles = [(south_west, south_east, north_east), (south_west, north_west, north_east)]
    while max(abs(triangles[0][0][0] - p[0]) for p in triangles[0]) > 1:
        divided = []
        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            divided += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = divided
    terrain = np.full((size, size), np.nan)
    for (x, y), height in heights.items():
        terrain[y, x] = height
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
            grown += [(middle, (h + g) / 2 + number[middle] * most), (to, g)]
        points = grown
        most *= roughness
    return np.interp(np.arange(length), [x for x, _ in points], [h for _, h in points])


def test_the_two_truths_are_one():
    drawn = np.random.default_rng(0).random((65, 65))
    loops = by_the_thesis(65, 0.3, CORNERS, drawn)
    np.testing.assert_allclose(by_slices(65, 0.3, CORNERS, drawn), loops, atol=1e-14)


@BOTH_TEXTS
@pytest.mark.parametrize("size", [2, 3, 5, 9, 17, 33, 65, 129])
@pytest.mark.parametrize("random", ["centred", "positive"])
def test_diamond_square_is_the_thesis_loops(engine, single, size, random):
    sketch = single(DIAMOND, size, smoothing=0.5, seed=11, corners=CORNERS, random=random)
    truth = by_the_thesis(size, 0.5, CORNERS, numbers(size, DIAMOND, 11, random == "positive"))
    np.testing.assert_allclose(engine.read(sketch, "terrain"), truth, atol=2e-6)


@pytest.mark.slow
def test_diamond_square_is_the_thesis_terrain_at_1025(any_engine, single):
    sketch = single(DIAMOND, 1025, smoothing=0.9, seed=3, corners=CORNERS)
    truth = by_slices(1025, 0.9, CORNERS, numbers(1025, DIAMOND, 3))
    np.testing.assert_allclose(any_engine.read(sketch, "terrain"), truth, atol=3e-6)


@pytest.mark.parametrize("size", [2, 3, 5, 9, 17, 65])
@pytest.mark.parametrize("rough", [0, 1])
def test_squares_and_triangles_are_divided_in_four(engine, single, size, rough):
    for use_, name, value, truth in (
        (MIDPOINT, "roughness", (0.5, 0.7)[rough], by_squares),
        (TRIANGLES, "r", (1.0, 1.5)[rough], lambda n, r, drawn: by_triangles(n, r, None, drawn)),
    ):
        result = engine.read(single(use_, size, seed=11, **{name: value}), "terrain.raw")
        expected = truth(size, value, numbers(size, use_, 11))
        np.testing.assert_allclose(result, expected, atol=2e-6, err_msg=use_)


@pytest.mark.parametrize("r", [0.0, 0.35, 3.0])
def test_any_exponent_and_given_corners(engine, single, r):
    corners = (0.1, -0.7, 0.4, 0.9)
    sketch = single(TRIANGLES, r=r, seed=4, corners_are="given", corners=corners)
    truth = by_triangles(33, r, corners, numbers(33, TRIANGLES, 4))
    np.testing.assert_allclose(engine.read(sketch, "terrain.raw"), truth, atol=3e-6)


@pytest.mark.parametrize("technique", [MIDPOINT, TRIANGLES])
def test_each_iteration_halves_the_edges(engine, single, technique):
    """Squares begin as 0, and their corners stay so; triangles draw their corners in a step of their own."""
    drawn = numbers(17, technique, 5)
    squares = technique == MIDPOINT
    truth = by_squares(17, 0.5, drawn) if squares else by_triangles(17, 1.0, None, drawn)
    for turn, values in engine.steps(single(technique, 17, seed=5), "terrain.raw"):
        existing = np.zeros((17, 17), bool)
        if squares or turn:
            step = 16 >> (turn if squares else turn - 1)
            existing[::step, ::step] = True
        assert not values[~existing].any()
        np.testing.assert_allclose(values[existing], truth[existing], atol=2e-6)
        assert (values != 0).sum() == existing.sum() - 4 * squares


@pytest.mark.parametrize(("length", "rows"), [(2, 1), (2, 4), (3, 3), (33, 7), (257, 9)])
@pytest.mark.parametrize("roughness", [0.5, 0.8])
def test_each_row_is_the_line_after_so_many_steps(engine, single, length, rows, roughness):
    lines = engine.read(single(SEGMENT, (length, rows), roughness=roughness, seed=6), "terrain")
    drawn = numbers(length, SEGMENT, 6)[0]
    truth = [by_a_growing_list(length, k, roughness, drawn) for k in range(rows)]
    np.testing.assert_allclose(lines, truth, atol=2e-6)


# ── diamond-square's compute variant: the bits of its passes ─────────────────


@pytest.fixture
def fast(both_texts):
    return both_texts[1]


@pytest.mark.parametrize("size", [2, 3, 5, 9, 17, 33, 65, 129, 257, 513])
@pytest.mark.parametrize("normalise", ["none", "max", "minmax"])
@pytest.mark.parametrize("random", ["centred", "positive"])
def test_the_variant_gives_the_bits_of_the_passes(both_texts, single, size, normalise, random):
    """Sizes of even and odd levels, of one group and of many."""
    slow, fast = both_texts
    values = {"smoothing": 0.63, "corners": CORNERS, "seed": 5, "random": random, "normalise": normalise}
    sketch = single(DIAMOND, size, **values)
    np.testing.assert_array_equal(fast.read(sketch, "terrain"), slow.read(sketch, "terrain"))
    assert fast.record.ran == ["terrain"] and "terrain.raw" in slow.record.ran


# At 65 texels and seeds 172 and 291, at 129 and seed 61, the lowest or the highest stands in the
# two western columns, which no eight columns hold; at 129 and seed 289 what lies past the
# eastern border would be the highest.
@pytest.mark.parametrize("size", [65, 129, 257])
@pytest.mark.parametrize("smoothing", [1.0, 0.05, 0.0])
def test_no_height_is_missed_in_the_search_for_the_range(fast, single, size, smoothing):
    """Rows that cannot hold the lowest or the highest are skipped; those that can must not be."""
    for seed in (*range(8), 61, 172, 289, 291):
        values = {"smoothing": smoothing, "corners": CORNERS, "seed": seed}
        raw = fast.read(single(DIAMOND, size, **values), "terrain")
        share = (raw - raw.min()) / (raw.max() - raw.min())
        for normalise, expected in (("minmax", share), ("max", raw / raw.max())):
            result = fast.read(single(DIAMOND, size, normalise=normalise, **values), "terrain")
            np.testing.assert_array_equal(result, expected)


def test_terrain_below_0_is_not_turned_over(both_texts, single):
    """By "max", a terrain whose heights are all below 0 stays as it is; a level one is level."""
    slow, fast = both_texts
    for seed in range(4):
        values = {"smoothing": 0.01, "normalise": "max", "corners": (0.0,) * 4, "seed": seed}
        result, expected = (e.read(single(DIAMOND, 65, **values), "terrain") for e in (fast, slow))
        np.testing.assert_array_equal(result, expected)
    for size in (33, 129):
        for normalise, height in (("none", np.float32(0.4)), ("max", 1.0), ("minmax", 0.0)):
            sketch = single(DIAMOND, size, smoothing=0.0, corners=(0.4,) * 4, normalise=normalise)
            np.testing.assert_array_equal(fast.read(sketch, "terrain"), height)


def test_an_iteration_on_the_way_is_the_kernel_s(fast, single):
    sketch = single(DIAMOND, 65)
    fast.read(sketch, "terrain", steps={"terrain.raw": 3})
    assert "terrain.raw" in fast.record.ran
    fast.read(sketch, "terrain")
    assert fast.record.ran in ([], ["terrain"])


def test_keys_are_in_the_order_of_heights(on_gpu):
    heights = np.array([-3e38, -1.0, -1e-30, -0.0, 0.0, 1e-38, 0.5, 0.50000006, 1.0, 3e38], np.float32)
    file = "terrain/order.glsl"
    keys = on_gpu(file, "key_of_height(h)", h=heights)
    assert (np.diff(keys.astype(np.int64)) > 0).all() and keys.min() > 0 and (~keys).min() > 0
    np.testing.assert_array_equal(on_gpu(file, "height_of_key(key_of_height(h))", h=heights), heights)


# ── figures 1.8 to 1.11: the points of a small terrain ───────────────────────

FIGURES = {1: 4, 2: 5, 3: 9, 4: 13, 5: 25}  # points that are set after each turn
PHASES = {
    1: {(0, 0), (4, 0), (0, 4), (4, 4)},
    2: {(2, 2)},
    3: {(2, 0), (0, 2), (4, 2), (2, 4)},
    4: {(1, 1), (3, 1), (1, 3), (3, 3)},
    5: {(x, y) for x in range(5) for y in range(5) if (x + y) % 2 == 1},
}
KNOWN = "generation/diamond_square/known"


def places_of(mask):
    return {(int(x), int(y)) for y, x in np.argwhere(mask)}


def test_the_iterations_are_the_figures(engine, single):
    """Four corners, one centre, four edges, four centres, twelve edges."""
    truth = by_the_thesis(5, 0.5, CORNERS, numbers(5, DIAMOND, 2))
    sketch = single(DIAMOND, 5, corners=CORNERS, smoothing=0.5, seed=2)
    states = [values.copy() for _, values in engine.steps(sketch, "terrain.raw")]
    assert len(states) == 6 and not states[0].any()
    for turn, count in FIGURES.items():
        existing = states[turn] != 0
        assert existing.sum() == count
        np.testing.assert_allclose(states[turn][existing], truth[existing], atol=1e-6)
        assert places_of(existing & (states[turn - 1] == 0)) == PHASES[turn]


def test_the_mask_shows_the_iteration_that_sets_a_point(engine, single):
    for turn, phase in engine.steps(single(KNOWN, 5), "terrain"):
        assert (phase > 0).sum() == FIGURES.get(turn, 0)
        for number in range(1, turn + 1):
            assert places_of(phase == number) == PHASES[number]


@pytest.mark.parametrize("size", [2, 3, 33])
def test_the_mask_marks_what_the_terrain_knows(engine, single, size):
    terrain = single(DIAMOND, size, corners=(1.0, 1.0, 1.0, 1.0), smoothing=0.1)
    masks = [phase.copy() for _, phase in engine.steps(single(KNOWN, size), "terrain")]
    for turn, values in engine.steps(terrain, "terrain.raw"):
        np.testing.assert_array_equal(masks[turn] > 0, values != 0)
    assert masks[-1].min() > 0


PICTURE = passes(
    height=use(DIAMOND, smoothing=0.0, corners=(0.2, 0.2, 0.8, 0.8)), phase=KNOWN
) + view(
    "view/lattice", inputs={"height": "height", "phase": "phase"},
    first="#102030", second="#ff0000", third="#0000ff", fourth="#00ff00", fifth="#ff8000",
)  # fmt: skip
RINGS = {1: (16, 32, 48), 2: (255, 0, 0), 3: (0, 0, 255), 4: (0, 255, 0), 5: (255, 128, 0)}


@pytest.mark.parametrize("turn", range(6))
@pytest.mark.parametrize("shape", [(250, 250), (400, 250)])
def test_a_point_is_a_disc_with_the_ring_of_its_phase(engine, make_sketch, turn, shape):
    """The lattice stands in the middle, 50 pixels from point to point, north on top."""
    sketch = make_sketch(PICTURE, size=5)
    picture = engine.render(sketch, size=shape, steps={"height.raw": turn, "phase": turn}).array.astype(int)
    heights = by_the_thesis(5, 0.0, (0.2, 0.2, 0.8, 0.8), np.zeros((5, 5)))
    for phase, places in PHASES.items():
        for x, y in places:
            row, column = 124 - 50 * (y - 2), shape[0] // 2 + 50 * (x - 2)
            middle, ring = picture[row, column, :3], picture[row, column + 12, :3]
            if phase <= turn:
                np.testing.assert_allclose(middle, 255 * heights[y, x], atol=1)
                np.testing.assert_allclose(ring, RINGS[phase], atol=1)
            else:
                np.testing.assert_allclose(middle, 255)
                assert ring.min() == ring.max() > 200, "only a line of the lattice, or none"


def test_between_the_points_is_paper_and_a_thin_line(engine, make_sketch):
    picture = engine.render(make_sketch(PICTURE, size=5), size=(250, 250)).array.astype(int)
    assert (picture[150, 150, :3] == 255).all(), "between four points"
    lines = picture[150, :, 0]
    assert 5 <= (lines < 250).sum() <= 10, "one line or two dim ones for each column of points"


def test_phases_beyond_the_fifth_go_on_with_the_last_two_colours(engine, make_sketch):
    picture = engine.render(make_sketch(PICTURE, size=9), size=(450, 450)).array.astype(int)
    for (x, y), phase in {(1, 1): 4, (3, 5): 4, (1, 0): 5, (4, 3): 5}.items():
        row, column = 224 - 50 * (y - 4), 225 + 50 * (x - 4)
        np.testing.assert_allclose(picture[row, column + 12, :3], RINGS[phase], atol=1)
