"""Triangle subdivision against triangles divided one by one in float64, with the same random numbers."""

import numpy as np
import pytest

from playground.errors import SketchError

from .drawing import FINEST_SIDE, salt

CORNERS = (0.1, -0.7, 0.4, 0.9)  # south-west, south-east, north-west, north-east


def by_triangles(size, r, corners, number):
    """Return the terrain of two triangles, each divided in four until its edges are one texel long.

    ``corners`` are given, or None: drawn like every other number. ``number(x, y)`` is the
    random number in [-1, 1) of a place; an edge of length k displaces its middle by k^r of it.
    """
    side = size - 1
    places = [(0, 0), (side, 0), (0, side), (side, side)]
    heights = dict(zip(places, corners or [number(*p) for p in places], strict=True))

    def middle(a, b):
        position = ((a[0] + b[0]) // 2, (a[1] + b[1]) // 2)
        if position not in heights:
            k = np.hypot(a[0] - b[0], a[1] - b[1]) / side
            heights[position] = (heights[a] + heights[b]) / 2 + number(*position) * k**r
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


def sketch_of(make_sketch, size, use="generation/triangle_subdivision", **values):
    text = "".join(f"{k} = {v!r}\n".replace("(", "[").replace(")", "]") for k, v in values.items())
    return make_sketch(f'[[pass]]\nname = "terrain"\nuse = "{use}"\n[pass.set]\n{text}', size=size)


@pytest.fixture
def number(python_random):
    def of(seed, size):
        apart, drawn = FINEST_SIDE // (size - 1), seed + salt("generation/triangle_subdivision")
        return lambda x, y: 2.0 * float(python_random(x * apart, y * apart, drawn)) - 1.0

    return of


@pytest.mark.parametrize("size", [2, 3, 5, 9, 17, 65])
@pytest.mark.parametrize("r", [1.0, 1.5])
def test_it_is_triangles_divided_in_four(engine, make_sketch, number, size, r):
    sketch = sketch_of(make_sketch, size, r=r, seed=11)
    truth = by_triangles(size, r, None, number(11, size))
    np.testing.assert_allclose(engine.read(sketch, "terrain.raw"), truth, atol=2e-6)


@pytest.mark.parametrize("r", [0.0, 0.35, 3.0])
def test_any_exponent_and_given_corners(engine, make_sketch, number, r):
    sketch = sketch_of(make_sketch, 33, r=r, seed=4, corners_are="given", corners=CORNERS)
    truth = by_triangles(33, r, CORNERS, number(4, 33))
    np.testing.assert_allclose(engine.read(sketch, "terrain.raw"), truth, atol=3e-6)


@pytest.mark.parametrize("size", [2, 5, 129, 1025])
def test_both_drivers_give_the_same_bits(same_by_both_drivers, make_sketch, size):
    sketch = sketch_of(make_sketch, size, r=1.5, seed=2)
    same_by_both_drivers(lambda engine: engine.read(sketch, "terrain.raw"))


def test_each_iteration_halves_the_edges(engine, make_sketch, number):
    sketch = sketch_of(make_sketch, 17, seed=5)
    truth = by_triangles(17, 1.0, None, number(5, 17))
    for turn, values in engine.steps(sketch, "terrain.raw"):
        existing = np.zeros((17, 17), bool)
        if turn:
            step = 16 >> (turn - 1)
            existing[::step, ::step] = True
        assert (values != 0).sum() == existing.sum() == ((2 ** (turn - 1) + 1) ** 2 if turn else 0)
        np.testing.assert_allclose(values[existing], truth[existing], atol=2e-6)


def test_corners_are_as_given_or_drawn_from_the_seed(engine, make_sketch, number):
    def corners(**values):
        terrain = engine.read(sketch_of(make_sketch, 33, **values), "terrain.raw")
        return [terrain[0, 0], terrain[0, -1], terrain[-1, 0], terrain[-1, -1]]

    np.testing.assert_array_equal(corners(corners_are="given", corners=CORNERS), np.float32(CORNERS))
    drawn = [number(3, 33)(x, y) for x, y in ((0, 0), (32, 0), (0, 32), (32, 32))]
    np.testing.assert_array_equal(corners(seed=3), np.float32(drawn))


def crease(terrain):
    """How much the terrain bends across its main diagonal, over how much across those beside it."""
    bend = np.abs(terrain[2:, :-2] - 2.0 * terrain[1:-1, 1:-1] + terrain[:-2, 2:])
    near = [np.diagonal(bend, k).mean() for k in range(-40, 41) if k]
    return np.diagonal(bend).mean() / np.mean(near)


def test_the_main_diagonal_is_a_crease_as_the_thesis_says(any_engine, make_sketch):
    """Its vertices know the diagonal's two ends only; diamond-square's know what is on both sides.

    At r = 1.5 the crease grows with the root of the size, beside the bends of texels that are ever nearer.
    """
    triangles, squares = [], []
    for seed in range(8):
        smooth = sketch_of(make_sketch, 513, r=1.5, seed=seed)
        triangles.append(crease(any_engine.read(smooth, "terrain").astype(float)))
        other = sketch_of(make_sketch, 513, "generation/diamond_square", smoothing=0.5, seed=seed)
        squares.append(crease(any_engine.read(other, "terrain").astype(float)))
    assert min(triangles) >= 3.0
    assert max(squares) <= 1.5


def test_a_larger_r_is_smoother(any_engine, make_sketch):
    rough = [
        np.abs(np.diff(any_engine.read(sketch_of(make_sketch, 129, r=r), "terrain"))).mean()
        for r in (0.5, 1.0, 1.5)
    ]
    assert rough[0] > 2 * rough[1] and rough[1] > 1.4 * rough[2]


def test_a_terrain_is_alike_at_every_size(any_engine, make_sketch):
    """Lengths are in sides, so the heights spread as much at 65 as at 513."""
    spread = [
        np.mean([any_engine.read(sketch_of(make_sketch, n, seed=s), "terrain.raw").std() for s in range(12)])
        for n in (65, 513)
    ]
    assert 0.7 < spread[0] / spread[1] < 1.4


@pytest.mark.parametrize("size", [2, 3, 65])
def test_it_is_normalised_by_default(engine, make_sketch, size):
    terrain = engine.read(sketch_of(make_sketch, size), "terrain")
    assert terrain.min() == 0 and terrain.max() == 1
    plain = sketch_of(make_sketch, size, normalise="none")
    np.testing.assert_array_equal(engine.read(plain, "terrain"), engine.read(plain, "terrain.raw"))


def test_seeds_are_terrains(engine, make_sketch):
    terrains = [engine.read(sketch_of(make_sketch, 65, seed=s), "terrain") for s in (1, 2, 1)]
    np.testing.assert_array_equal(terrains[0], terrains[2])
    assert np.abs(terrains[0] - terrains[1]).max() > 0.01


def test_a_size_it_cannot_halve_is_refused_with_the_nearest(any_engine, make_sketch):
    with pytest.raises(SketchError, match="65 x 65 or 129 x 129"):
        any_engine.read(sketch_of(make_sketch, 100), "terrain")
