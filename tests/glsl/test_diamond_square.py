"""Diamond-square against the thesis's own loops in float64, with the same random numbers."""

from itertools import pairwise

import numpy as np
import pytest

from playground.errors import SketchError

CORNERS = (0.1, 0.7, 0.4, 0.9)  # south-west, south-east, north-west, north-east


def by_the_thesis(size, smoothing, corners, number):
    """Return the land as section 4.3.1's loops make it, points[i][j] with i up and j along.

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
    land = np.full((size, size), np.nan)
    land[0, 0], land[0, -1], land[-1, 0], land[-1, -1] = corners
    spacing = size - 1
    while spacing > 1:
        h = spacing // 2
        share = spacing / (size - 1) * smoothing
        known = land[::spacing, ::spacing]
        land[h::spacing, h::spacing] = (known[:-1, :-1] + known[:-1, 1:] + known[1:, :-1] + known[1:, 1:]) / 4
        land[h::spacing, h::spacing] += numbers[h::spacing, h::spacing] * share
        rim = np.pad(land[::h, ::h], 1, constant_values=np.nan)
        around = np.stack([rim[:-2, 1:-1], rim[2:, 1:-1], rim[1:-1, :-2], rim[1:-1, 2:]])
        mean = np.nansum(around, axis=0) / np.maximum((~np.isnan(around)).sum(axis=0), 1)
        odd = np.add.outer(np.arange(mean.shape[0]), np.arange(mean.shape[1])) % 2 == 1
        land[::h, ::h] = np.where(odd, mean + numbers[::h, ::h] * share, land[::h, ::h])
        spacing = h
    return land


def sketch_of(make_sketch, size, **values):
    given = "".join(f"{k} = {v!r}\n".replace("(", "[").replace(")", "]") for k, v in values.items())
    return make_sketch(
        f'[[pass]]\nname = "land"\nuse = "generation/diamond_square"\n[pass.set]\n{given}', size=size
    )


@pytest.fixture
def numbers(python_random):
    def make(size, seed, positive=False):
        y, x = np.mgrid[0:size, 0:size]
        drawn = python_random(x, y, seed)
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
    np.testing.assert_allclose(engine.read(sketch, "land"), truth, atol=2e-6)


def test_it_is_the_thesis_land_at_1025(any_engine, make_sketch, numbers):
    sketch = sketch_of(make_sketch, 1025, smoothing=0.9, seed=3, corners=CORNERS)
    truth = by_slices(1025, 0.9, CORNERS, numbers(1025, 3))
    np.testing.assert_allclose(any_engine.read(sketch, "land"), truth, atol=3e-6)


def test_the_turns_are_the_figures(engine, make_sketch):
    """Figures 1.8 to 1.11: four corners, one centre, four edges, four centres, twelve edges."""
    sketch = sketch_of(make_sketch, 5, corners=(1.0, 1.0, 1.0, 1.0))
    known = [values != 0 for _, values in engine.steps(sketch, "land.raw")]
    assert [k.sum() for k in known] == [0, 4, 5, 9, 13, 25]
    places = [{(int(x), int(y)) for y, x in np.argwhere(k & ~b)} for b, k in pairwise(known)]
    assert places[0] == {(0, 0), (4, 0), (0, 4), (4, 4)}
    assert places[1] == {(2, 2)}
    assert places[2] == {(2, 0), (0, 2), (4, 2), (2, 4)}
    assert places[3] == {(1, 1), (3, 1), (1, 3), (3, 3)}
    assert places[4] == {(x, y) for x in range(5) for y in range(5) if (x + y) % 2 == 1}


def test_corners_keep_their_heights(engine, make_sketch):
    land = engine.read(sketch_of(make_sketch, 33, corners=CORNERS, smoothing=1.0), "land")
    np.testing.assert_array_equal([land[0, 0], land[0, -1], land[-1, 0], land[-1, -1]], np.float32(CORNERS))


def test_without_roughness_the_corners_alone_shape_the_land(engine, make_sketch):
    level = engine.read(sketch_of(make_sketch, 33, smoothing=0.0, corners=(0.25,) * 4), "land")
    np.testing.assert_array_equal(level, np.float32(0.25))
    tilted = engine.read(sketch_of(make_sketch, 33, smoothing=0.0, corners=CORNERS), "land")
    assert tilted.min() == np.float32(0.1) and tilted.max() == np.float32(0.9)


def test_positive_numbers_lift_the_land_and_centred_ones_do_not(any_engine, make_sketch):
    means = {}
    for random in ("centred", "positive"):
        lands = [
            any_engine.read(sketch_of(make_sketch, 129, smoothing=0.5, seed=s, random=random), "land").mean()
            for s in range(12)
        ]
        means[random] = np.mean(lands) - 0.5
    assert abs(means["centred"]) < 0.08 and means["positive"] > 0.3


@pytest.mark.parametrize("mode", ["none", "max", "minmax"])
def test_normalise(engine, make_sketch, numbers, mode):
    sketch = sketch_of(make_sketch, 65, smoothing=0.8, seed=5, corners=CORNERS, normalise=mode)
    land = by_slices(65, 0.8, CORNERS, numbers(65, 5))
    truth = {
        "none": land,
        "max": land / land.max(),
        "minmax": np.interp(land, [land.min(), land.max()], [0, 1]),
    }
    np.testing.assert_allclose(engine.read(sketch, "land"), truth[mode], atol=3e-6)


def test_by_default_nothing_is_normalised(engine, make_sketch):
    sketch = sketch_of(make_sketch, 65, smoothing=0.8)
    np.testing.assert_array_equal(engine.read(sketch, "land"), engine.read(sketch, "land.raw"))


def test_seeds_are_lands(engine, make_sketch):
    lands = [engine.read(sketch_of(make_sketch, 65, seed=s), "land") for s in (1, 2, 1)]
    np.testing.assert_array_equal(lands[0], lands[2])
    assert np.abs(lands[0] - lands[1]).max() > 0.01


def test_a_size_it_cannot_halve_is_refused_with_the_nearest(any_engine, make_sketch):
    with pytest.raises(SketchError, match="65 x 65 or 129 x 129"):
        any_engine.read(sketch_of(make_sketch, 100), "land")
