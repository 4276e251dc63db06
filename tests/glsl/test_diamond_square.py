"""Diamond-square against the thesis's own loops in float64, with the same random numbers."""

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.errors import SketchError

from .drawing import FINEST_SIDE, salt

CORNERS = (0.1, 0.7, 0.4, 0.9)  # south-west, south-east, north-west, north-east


def by_the_thesis(size, smoothing, corners, number):
    """Return the terrain as section 4.3.1's loops make it, points[i][j] with i up and j along.

    ``number(i, j)`` is the random number; the spacing is taken over the side.
    """
    side = size - 1
    points = [[0.0] * size for _ in range(size)]
    points[0][0], points[0][side], points[side][0], points[side][side] = corners
    spacing = side

    def mean(i, j, neighbours):
        kept = [points[a][b] for a, b in neighbours if 0 <= a < size and 0 <= b < size]
        return sum(kept) / len(kept) + number(i, j) * spacing / side * smoothing

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


def sketch_of(make_sketch, size, **values):
    text = "".join(f"{k} = {v!r}\n".replace("(", "[").replace(")", "]") for k, v in values.items())
    return make_sketch(
        f'[[pass]]\nname = "terrain"\nuse = "generation/diamond_square"\n[pass.set]\n{text}', size=size
    )


@pytest.fixture
def numbers(python_random):
    def make(size, seed, positive=False):
        y, x = np.mgrid[0:size, 0:size] * (FINEST_SIDE // (size - 1))
        drawn = python_random(x, y, seed + salt("generation/diamond_square"))
        return drawn if positive else 2 * drawn - 1

    return make


def test_the_two_truths_are_one():
    drawn = np.random.default_rng(0).random((65, 65))
    loops = by_the_thesis(65, 0.3, CORNERS, lambda i, j: drawn[i, j])
    np.testing.assert_allclose(by_slices(65, 0.3, CORNERS, drawn), loops, atol=1e-14)


@pytest.mark.parametrize("size", [2, 3, 5, 9, 17, 33, 65, 129])
@pytest.mark.parametrize("random", ["centred", "positive"])
def test_it_is_the_thesis_loops(engine, make_sketch, numbers, size, random):
    sketch = sketch_of(make_sketch, size, smoothing=0.5, seed=11, corners=CORNERS, random=random)
    drawn = numbers(size, 11, random == "positive")
    truth = by_the_thesis(size, 0.5, CORNERS, lambda i, j: drawn[i, j])
    np.testing.assert_allclose(engine.read(sketch, "terrain"), truth, atol=2e-6)


@pytest.mark.slow
def test_it_is_the_thesis_terrain_at_1025(any_engine, make_sketch, numbers):
    sketch = sketch_of(make_sketch, 1025, smoothing=0.9, seed=3, corners=CORNERS)
    truth = by_slices(1025, 0.9, CORNERS, numbers(1025, 3))
    np.testing.assert_allclose(any_engine.read(sketch, "terrain"), truth, atol=3e-6)


FIGURES = {1: 4, 2: 5, 3: 9, 4: 13, 5: 25}  # points that are set after each turn, in figures 1.8 to 1.11
PHASES = {
    1: {(0, 0), (4, 0), (0, 4), (4, 4)},
    2: {(2, 2)},
    3: {(2, 0), (0, 2), (4, 2), (2, 4)},
    4: {(1, 1), (3, 1), (1, 3), (3, 3)},
    5: {(x, y) for x in range(5) for y in range(5) if (x + y) % 2 == 1},
}


def test_the_iterations_are_the_figures(engine, make_sketch, numbers):
    """Figures 1.8 to 1.11: four corners, one centre, four edges, four centres, twelve edges."""
    sketch = sketch_of(make_sketch, 5, corners=CORNERS, smoothing=0.5, seed=2)
    drawn = numbers(5, 2)
    truth = by_the_thesis(5, 0.5, CORNERS, lambda i, j: drawn[i, j])
    states = [values.copy() for _, values in engine.steps(sketch, "terrain.raw")]
    assert len(states) == 6 and not states[0].any()
    for turn, count in FIGURES.items():
        existing = states[turn] != 0
        assert existing.sum() == count
        np.testing.assert_allclose(states[turn][existing], truth[existing], atol=1e-6)
        places = {(int(x), int(y)) for y, x in np.argwhere(existing & (states[turn - 1] == 0))}
        assert places == PHASES[turn]


def known_of(make_sketch, size):
    return make_sketch('[[pass]]\nname = "known"\nuse = "generation/diamond_square/known"\n', size=size)


def test_the_mask_shows_the_iteration_that_sets_a_point(engine, make_sketch):
    sketch = known_of(make_sketch, 5)
    for turn, phase in engine.steps(sketch, "known"):
        assert (phase > 0).sum() == FIGURES.get(turn, 0)
        for number in range(1, turn + 1):
            places = {(int(x), int(y)) for y, x in np.argwhere(phase == number)}
            assert places == PHASES[number]


@pytest.mark.parametrize("size", [2, 3, 33])
def test_the_mask_marks_what_the_terrain_knows(engine, make_sketch, size):
    terrain = sketch_of(make_sketch, size, corners=(1.0, 1.0, 1.0, 1.0), smoothing=0.1)
    phases = engine.steps(known_of(make_sketch, size), "known")
    masks = [phase.copy() for _, phase in phases]
    for turn, values in engine.steps(terrain, "terrain.raw"):
        np.testing.assert_array_equal(masks[turn] > 0, values != 0)
    assert masks[-1].min() > 0


@pytest.mark.parametrize("size", [2, 3, 17, 129, 1025])
@pytest.mark.parametrize("random", ["centred", "positive"])
def test_both_drivers_give_the_same_bits(ctx, make_sketch, size, random):
    """By fragment, by compute in place, and by the fast variant where there is compute."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    sketch = sketch_of(make_sketch, size, smoothing=0.63, corners=CORNERS, seed=5, random=random)
    with Engine(ctx, driver="fragment") as engine:
        fragment = engine.read(sketch, "terrain")
    with Engine(ctx) as engine:
        np.testing.assert_array_equal(engine.read(sketch, "terrain.raw"), fragment)
        np.testing.assert_array_equal(engine.read(sketch, "terrain"), fragment)


@pytest.mark.parametrize("size", [3, 65, 129, 257])
@pytest.mark.parametrize("normalise", ["max", "minmax"])
def test_both_drivers_normalise_to_the_same_bits(ctx, make_sketch, size, normalise):
    """Whichever way the range is found: terrains whose ends lie on a border, on a corner, anywhere."""
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver="fragment") as slow, Engine(ctx) as fast:
        for seed, smoothing in ((1, 0.63), (2, 1.0), (3, 0.1), (4, 0.63), (5, 0.63), (6, 0.0)):
            values = {"smoothing": smoothing, "corners": CORNERS, "normalise": normalise, "seed": seed}
            sketch = sketch_of(make_sketch, size, **values)
            np.testing.assert_array_equal(slow.read(sketch, "terrain"), fast.read(sketch, "terrain"))


@pytest.mark.parametrize(("height", "left"), [(0.4, 0.4), (0.0, 0.0), (1.0, 1.0)])
def test_level_terrain_has_no_range_to_stretch(engine, make_sketch, height, left):
    for size in (5, 65):
        values = {"smoothing": 0.0, "corners": (height,) * 4}
        level = engine.read(sketch_of(make_sketch, size, normalise="minmax", **values), "terrain")
        np.testing.assert_array_equal(level, 0)
        level = engine.read(sketch_of(make_sketch, size, normalise="max", **values), "terrain")
        np.testing.assert_array_equal(level, 1.0 if height else 0.0)
        level = engine.read(sketch_of(make_sketch, size, **values), "terrain")
        np.testing.assert_array_equal(level, np.float32(left))


def test_corners_keep_their_heights(engine, make_sketch):
    terrain = engine.read(sketch_of(make_sketch, 33, corners=CORNERS, smoothing=1.0), "terrain")
    np.testing.assert_array_equal(
        [terrain[0, 0], terrain[0, -1], terrain[-1, 0], terrain[-1, -1]], np.float32(CORNERS)
    )


def test_without_roughness_the_corners_alone_shape_the_terrain(engine, make_sketch):
    level = engine.read(sketch_of(make_sketch, 33, smoothing=0.0, corners=(0.25,) * 4), "terrain")
    np.testing.assert_array_equal(level, np.float32(0.25))
    tilted = engine.read(sketch_of(make_sketch, 33, smoothing=0.0, corners=CORNERS), "terrain")
    assert tilted.min() == np.float32(0.1) and tilted.max() == np.float32(0.9)


def test_positive_random_numbers_lift_terrain_centred_do_not(any_engine, make_sketch):
    means = {}
    for random in ("centred", "positive"):
        terrains = [
            any_engine.read(
                sketch_of(make_sketch, 129, smoothing=0.5, seed=s, random=random), "terrain"
            ).mean()
            for s in range(12)
        ]
        means[random] = np.mean(terrains) - 0.5
    assert abs(means["centred"]) < 0.08 and means["positive"] > 0.3


@pytest.mark.parametrize("mode", ["none", "max", "minmax"])
def test_normalise(engine, make_sketch, numbers, mode):
    sketch = sketch_of(make_sketch, 65, smoothing=0.8, seed=5, corners=CORNERS, normalise=mode)
    terrain = by_slices(65, 0.8, CORNERS, numbers(65, 5))
    truth = {
        "none": terrain,
        "max": terrain / terrain.max(),
        "minmax": np.interp(terrain, [terrain.min(), terrain.max()], [0, 1]),
    }
    np.testing.assert_allclose(engine.read(sketch, "terrain"), truth[mode], atol=3e-6)


def test_by_default_nothing_is_normalised(engine, make_sketch):
    sketch = sketch_of(make_sketch, 65, smoothing=0.8)
    np.testing.assert_array_equal(engine.read(sketch, "terrain"), engine.read(sketch, "terrain.raw"))


def test_seeds_are_terrains(engine, make_sketch):
    terrains = [engine.read(sketch_of(make_sketch, 65, seed=s), "terrain") for s in (1, 2, 1)]
    np.testing.assert_array_equal(terrains[0], terrains[2])
    assert np.abs(terrains[0] - terrains[1]).max() > 0.01


def test_a_size_it_cannot_halve_is_refused_with_the_nearest(any_engine, make_sketch):
    with pytest.raises(SketchError, match="65 x 65 or 129 x 129"):
        any_engine.read(sketch_of(make_sketch, 100), "terrain")


# ── the picture of a small terrain's points ─────────────────────────────────────

PICTURE = """
[[pass]]
name = "height"
use = "generation/diamond_square"
set = { smoothing = 0.0, corners = [0.2, 0.2, 0.8, 0.8] }
[[pass]]
name = "phase"
use = "generation/diamond_square/known"
[view]
use = "view/lattice"
inputs = { height = "height", phase = "phase" }
set = { first = "#102030", second = "#ff0000", third = "#0000ff", fourth = "#00ff00", fifth = "#ff8000" }
"""
RINGS = {1: (16, 32, 48), 2: (255, 0, 0), 3: (0, 0, 255), 4: (0, 255, 0), 5: (255, 128, 0)}


@pytest.mark.parametrize("turn", range(6))
@pytest.mark.parametrize("shape", [(250, 250), (400, 250)])
def test_a_point_is_a_disc_with_the_ring_of_its_phase(engine, make_sketch, turn, shape):
    """The lattice stands in the middle, 50 pixels from point to point, north on top."""
    sketch = make_sketch(PICTURE, size=5)
    picture = engine.render(sketch, size=shape, steps={"height.raw": turn, "phase": turn}).array.astype(int)
    heights = by_the_thesis(5, 0.0, (0.2, 0.2, 0.8, 0.8), lambda i, j: 0.0)
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
