"""Faults and circles, sums of many marks: against sums in NumPy, mark by mark."""

import math
from functools import partial

import numpy as np
import pytest

from playground.engine.engine import Engine

from ..sketch_texts import passes
from ..truth.noise import pcg3d, salt
from .conftest import BOTH_TEXTS

LINE, DOME = "generation/fault_formation/line.glsl", "generation/circles/dome.glsl"
FAULTS, CIRCLES = "generation/fault_formation", "generation/circles"
START = passes(start="generation/layered_noise")


@pytest.fixture
def faults_of(single):
    return partial(single, FAULTS)


@pytest.fixture
def circles_of(single):
    return partial(single, CIRCLES)


# ── faults ───────────────────────────────────────────────────────────────────


def drawn(faults, seed):
    """Return the points of each line, 0..4095, and a number 0..1 for its height."""
    index, key = np.arange(faults), seed + salt(FAULTS)
    first, second = (np.stack(pcg3d(index, k, key), axis=1).astype(np.int64) for k in (0, 1))
    return first[:, :2] >> 20, second[:, :2] >> 20, (first[:, 2] >> 8) / 2.0**24


def unit_of(faults, amount):
    """Return the power of two that heights are multiples of: 2^23 of it exceed all faults."""
    return 2.0 ** (math.floor(math.log2(faults * amount)) + 1 - 23)


def standing(texels):
    """Return where the texels of a row stand, to the nearest of 32768 parts of it."""
    most = max(texels - 1, 1)
    return np.array([(2 * x * 32768 + most) // (2 * most) for x in range(texels)])


def sides(first, second, size):
    """Return whether each texel is to the left of a line, from the exact sign of a float64 cross product.

    The points stand in the middles of a 4096th of the terrain, texels where they stand, rounded to
    a 32768th. A texel on the line counts as if it stood a hair further north, or east.
    """
    shares = [standing(n) / 32768.0 for n in size]
    p, q = ((np.asarray(point, np.float64) + 0.5) / 4096.0 for point in (first, second))
    along = q - p
    if not along.any():
        along = np.array([1.0, 0.0])
    cross = along[0] * (shares[1][:, None] - p[1]) - along[1] * (shares[0][None, :] - p[0])
    on_the_line = along[0] > 0 or (along[0] == 0 and along[1] < 0)
    return np.where(cross == 0, on_the_line, cross > 0)


def steps_of(size, seed, heights, rows=slice(None)):
    """Return what each fault adds."""
    first, second, _ = drawn(len(heights), seed)
    ups = (sides(p, q, size)[rows] for p, q in zip(first, second, strict=True))
    return [np.where(up, height, -height) for up, height in zip(ups, heights, strict=True)]


@pytest.fixture
def heights_of(any_engine):
    """Give the height of each fault; one test holds them against the rule, the others take them so."""

    def make(sketch, faults, amount=0.05):
        lines = any_engine.read(sketch, "terrain.lines")[0].astype(np.float64)
        assert (lines == np.rint(lines)).all() and (lines[:, 3] >= 1).all()
        return lines[:faults, 3] * unit_of(faults, amount)

    return make


@BOTH_TEXTS
@pytest.mark.parametrize(
    "size", [(33, 33), (64, 65), (130, 100), (40, 23), (2, 2), (1, 9), (300, 2)], ids=str
)  # one tile to 4 x 3
@pytest.mark.parametrize("faults", [1, 97, 200])
def test_it_is_the_sum_of_its_faults(engine, faults_of, heights_of, size, faults):
    """Exactly: by the plain kernel, by tiles, and by the compute variant."""
    sketch = faults_of(size, iterations=faults, seed=3)
    truth = np.sum(steps_of(size, 3, heights_of(sketch, faults)), axis=0)
    np.testing.assert_array_equal(engine.read(sketch, "terrain.sum"), truth)
    np.testing.assert_array_equal(engine.read(sketch.plainly(), "terrain.sum"), truth)


@pytest.mark.slow
@BOTH_TEXTS
def test_it_is_the_sum_of_its_faults_at_513(engine, faults_of, heights_of):
    sketch = faults_of((513, 513), iterations=1000, seed=9)
    rows = np.array([0, 1, 100, 256, 511, 512])
    truth = np.sum(steps_of((513, 513), 9, heights_of(sketch, 1000), rows), axis=0)
    np.testing.assert_array_equal(engine.read(sketch, "terrain.sum")[rows], truth)


@pytest.mark.parametrize("size", [(2112, 2), (2113, 2), (5000, 3)], ids=str)
def test_rows_longer_than_the_shared_memory(any_engine, faults_of, size):
    sketch = faults_of(size, seed=4)
    quick = any_engine.read(sketch, "terrain.sum")
    np.testing.assert_array_equal(quick, any_engine.read(sketch.plainly(), "terrain.sum"))


@pytest.mark.parametrize("fall", ["linear", "ratio"])
@pytest.mark.parametrize("last", [0.01, 0.5, 1.0])
@pytest.mark.parametrize("variation", [0.0, 0.5, 1.0])
def test_heights_fall(any_engine, faults_of, fall, last, variation):
    faults, amount = 60, 0.3
    sketch = faults_of(iterations=faults, seed=5, fall=fall, last=last, variation=variation, amount=amount)
    result = any_engine.read(sketch, "terrain.lines")[0, :, 3] * unit_of(faults, amount)
    falling = np.interp(np.arange(faults), [0, faults], [1, last])
    if fall == "ratio":
        falling = np.exp(np.interp(np.arange(faults), [0, faults], [0, np.log(last)]))
    truth = amount * falling * (1 - variation * drawn(faults, 5)[2])
    np.testing.assert_allclose(result, truth, atol=2 * unit_of(faults, amount))


@pytest.mark.parametrize("size", [(2, 2), (3, 2), (33, 33), (17, 64)], ids=str)
def test_one_fault_gives_two_heights(engine, faults_of, size):
    """As far above 0 as below it, whatever the line: on the smallest terrain, too, it parts the corners."""
    for seed in range(6):
        sketch = faults_of(size, iterations=1, seed=seed, radius=0)
        raw = np.unique(engine.read(sketch, "terrain.sum"))
        assert len(raw) == 2 and raw[0] == -raw[1] and raw[1] > 0
        np.testing.assert_array_equal(np.unique(engine.read(sketch, "terrain")), [0, 1])


def test_a_line_parts_the_corners_even_through_one_point_twice(on_gpu):
    rng = np.random.default_rng(1)
    first = rng.integers(0, 4096, (4000, 2)).astype(np.int32)
    second = np.where(rng.random((4000, 1)) < 0.5, first, rng.integers(0, 4096, (4000, 2))).astype(np.int32)
    ends = np.array([[0, 0], [4095, 4095], [0, 4095], [4095, 0], [0, 0]], np.int32)
    first, second = np.concatenate([first, ends[:-1]]), np.concatenate([second, ends[1:]])
    assert (first == second).all(axis=1).sum() > 1000
    corners = [
        on_gpu(LINE, f"int(is_raised(fault_line(p, q), {corner} * PLACES))", p=first, q=second)
        for corner in ("ivec2(0, 0)", "ivec2(1, 0)", "ivec2(0, 1)", "ivec2(1, 1)")
    ]
    assert set(np.sum(corners, axis=0)) <= {1, 2, 3}


def test_values_are_cross_products_and_turned_lines_opposite(on_gpu):
    """Everywhere, and on the line itself, where half of these places are put."""
    rng = np.random.default_rng(2)
    first, second = (rng.integers(0, 4096, (20000, 2)).astype(np.int32) for _ in range(2))
    position = rng.integers(0, 32769, (20000, 2)).astype(np.int32)
    position[::2] = (first * 8 + 4)[::2]
    position[::4] = (second * 8 + 4)[::4]
    names = {"p": first, "q": second, "place": position}
    ask = "int(is_raised(fault_line({}), place))"
    left, other = on_gpu(LINE, ask.format("p, q"), **names), on_gpu(LINE, ask.format("q, p"), **names)
    np.testing.assert_array_equal(left + other, 1)
    value = on_gpu(LINE, "fault_value(fault_line(p, q), place)", **names)
    (ax, ay), (bx, by) = (second - first).astype(np.int64).T, (position - first * 8 - 4).astype(np.int64).T
    np.testing.assert_array_equal(value, ax * by - ay * bx)
    assert (value[::2] == 0).all() and (value[1::2] != 0).mean() > 0.99


@pytest.mark.parametrize("side", [2, 3, 33, 100, 1025, 4096, 4097, 16384])
def test_texels_stand_where_they_stand(on_gpu, side):
    texel = np.unique(np.linspace(0, side - 1, 3000).astype(np.int32))
    result = on_gpu(LINE, "place_of_texel(texel, side)", texel=texel, side=side)
    np.testing.assert_allclose(result, texel * (32768 / (side - 1)), atol=0.5)
    assert result[0] == 0 and result[-1] == 32768


def test_the_lowest_bit(on_gpu):
    bits = np.concatenate([np.arange(1, 5000), 2 ** np.arange(32), 3 << np.arange(31), [2**32 - 1]])
    result = on_gpu("maths/bits.glsl", "lowest_bit(n)", n=bits.astype(np.uint32))
    np.testing.assert_array_equal(result, [(int(n) & -int(n)).bit_length() - 1 for n in bits])


@BOTH_TEXTS
def test_turns_are_faults(engine, faults_of, heights_of):
    """However they are grouped: one by one, many in one run, from a stop in the middle of a block."""
    sketch = faults_of((100, 70), iterations=120, seed=6)
    steps = steps_of((100, 70), 6, heights_of(sketch, 120))
    truth = [np.zeros((70, 100)), *np.cumsum(steps, axis=0)]
    for turn, result in engine.steps(sketch, "terrain"):
        np.testing.assert_array_equal(result, truth[turn])
    for turn in (1, 50, 96, 97, 119, 120):
        with Engine(engine.ctx, driver=engine.driver) as fresh:
            result = fresh.read(sketch, "terrain.sum", steps={"terrain.sum": turn})
        np.testing.assert_array_equal(result, truth[turn])


@BOTH_TEXTS
def test_initial_terrain_is_added_to_faults_at_any_grouping(engine, faults_of):
    values = {"iterations": 50, "seed": 6}
    sketch = faults_of(before=START, inputs={"sum.initial": "start"}, **values)
    start = engine.read(sketch, "start").astype(np.float64)
    faults = engine.read(faults_of(**values), "terrain.sum").astype(np.float64)
    whole = engine.read(sketch, "terrain.sum").copy()
    np.testing.assert_allclose(whole, start + faults, atol=unit_of(50, 0.05))
    *_, (_, by_steps) = engine.steps(sketch, "terrain.sum")
    np.testing.assert_array_equal(by_steps, whole)


def test_the_filter_makes_walls_slopes(engine, faults_of):
    steps = {}
    for radius in (0, 3, 8):
        terrain = engine.read(faults_of(65, iterations=1, radius=radius), "terrain")
        steps[radius] = max(np.abs(np.diff(terrain, axis=a)).max() for a in (0, 1))
    # A mean over 2 radius + 1 texels spreads a wall over as many, along the axis that meets it best.
    assert steps[0] == 1 and 1 / 7 <= steps[3] <= 0.2 and 1 / 17 <= steps[8] <= 0.09


# ── circles ──────────────────────────────────────────────────────────────────

DEFAULTS = {"iterations": 200, "seed": 7, "smallest": 0.02, "largest": 0.2, "rise": 0.1}
SHAPES = [
    ((33, 33), (1000.0, 1000.0)),
    ((130, 100), (1300.0, 1000.0)),
    ((40, 23), (300.0, 900.0)),
    ((100, 9), (2000.0, 100.0)),
    ((2, 2), (10.0, 10.0)),
    ((1, 7), (10.0, 10.0)),
]


def discs(extent, **values):
    """Return x, y, radius in metres and height of each disc."""
    v = DEFAULTS | values
    x, y, third = (n >> 8 for n in pcg3d(np.arange(v["iterations"]), 0, v["seed"] + salt(CIRCLES)))
    low, high = sorted((v["smallest"], v["largest"]))
    share = np.interp(third / 2.0**24, [0, 1], [low, high])
    heights = v["rise"] * (np.ones(len(share)) if v.get("rises") == "alike" else share / high)
    return x / 2.0**24 * extent[0], y / 2.0**24 * extent[1], share * min(extent), heights


def far_from(disc, size, extent):
    """Return how far each texel is from a disc's middle, in its radii."""
    x, y = (np.linspace(0, e, n) if n > 1 else np.zeros(1) for n, e in zip(size, extent, strict=True))
    return np.hypot(x[None, :] - disc[0], y[:, None] - disc[1]) / max(disc[2], 1e-9)


def dome(far, sphere=False):
    """Return a dome's height: the squared cosine of half the angle, or by the angle from the top."""
    inside = np.minimum(far, 1)
    return np.sin(np.arccos(inside)) if sphere else np.cos(inside * np.pi / 2) ** 2


def summed(size, extent, sphere=False, rows=slice(None), **values):
    every = zip(*discs(extent, **values), strict=True)
    return sum(disc[3] * dome(far_from(disc, size, extent)[rows], sphere) for disc in every)


@BOTH_TEXTS
@pytest.mark.parametrize(("size", "extent"), SHAPES, ids=str)
@pytest.mark.parametrize(
    "values", [{}, {"iterations": 97, "rises": "alike"}, {"smallest": 0.4, "largest": 0.1}]
)
def test_it_is_the_sum_of_its_domes(engine, circles_of, size, extent, values):
    result = engine.read(circles_of(size, extent, **values), "terrain.raw")
    truth = summed(size, extent, **values)
    # Places are counted in the shorter side: on a long terrain they are large numbers, and rounded.
    long = max(extent) / min(extent)
    np.testing.assert_allclose(result, truth, atol=2e-6 * long * max(1, truth.max()))


@BOTH_TEXTS
def test_half_spheres(engine, circles_of):
    size, extent = (130, 100), (1300.0, 1000.0)
    result = engine.read(circles_of(size, extent, dome="half a sphere"), "terrain.raw")
    # At its rim a half sphere is upright: there a rounded place has a height of its own.
    truth = summed(size, extent, sphere=True)
    near = np.min([abs(far_from(d, size, extent) - 1) for d in zip(*discs(extent), strict=True)], axis=0)
    np.testing.assert_allclose(result, truth, atol=2e-4)
    assert (near > 1e-2).any()
    np.testing.assert_allclose(result[near > 1e-2], truth[near > 1e-2], atol=1e-5)


@BOTH_TEXTS
def test_it_is_the_sum_of_its_domes_at_513(engine, circles_of):
    values = {"iterations": 1000, "smallest": 0.0, "largest": 0.05}
    rows = [0, 77, 256, 512]
    result = engine.read(circles_of((513, 513), **values), "terrain.raw")[rows]
    np.testing.assert_allclose(result, summed((513, 513), (1000, 1000), rows=rows, **values), atol=2e-6)


@pytest.mark.parametrize("dome", ["half a cosine", "half a sphere"])
def test_outside_every_disc_the_terrain_keeps_its_height(engine, circles_of, dome):
    """To the last bit; inside any, it is higher."""
    values = {"iterations": 30, "seed": 5, "smallest": 0.05, "largest": 0.1}
    size, extent = (100, 70), (1000.0, 700.0)
    sketch = circles_of(size, extent, START, {"initial": "start"}, dome=dome, **values)
    start, terrain = engine.read(sketch, "start"), engine.read(sketch, "terrain.raw")
    far = np.min([far_from(d, size, extent) for d in zip(*discs(extent, **values), strict=True)], axis=0)
    outside, inside = far > 1 + 1e-5, far < 0.98
    assert outside.sum() > 1000 and inside.sum() > 1000
    np.testing.assert_array_equal(terrain[outside], start[outside])
    assert (terrain[inside] > start[inside]).all()


@pytest.mark.parametrize("extent", [(1000.0, 1000.0), (4000.0, 1000.0), (1000.0, 2500.0)], ids=str)
def test_discs_are_round_in_metres(engine, circles_of, extent):
    size, values = (401, 301), {"iterations": 1, "smallest": 0.2, "largest": 0.2}
    for seed in range(40):
        (x,), (y,), (radius,), _ = discs(extent, seed=seed, **values)
        if radius < x < extent[0] - radius and radius < y < extent[1] - radius:
            break
    terrain = engine.read(circles_of(size, extent, seed=seed, **values), "terrain.raw")
    wide, high = (np.flatnonzero((terrain > 0).any(axis=a)) for a in (0, 1))
    step = np.array(extent) / (np.array(size) - 1)
    np.testing.assert_allclose(np.ptp(wide) * step[0], 2 * radius, atol=2.1 * step[0])
    np.testing.assert_allclose(np.ptp(high) * step[1], 2 * radius, atol=2.1 * step[1])


def test_domes(on_gpu):
    far = np.linspace(0, 1.2, 400)
    offset = np.stack([far * 0.3 * np.cos(far * 9), far * 0.3 * np.sin(far * 9)], axis=1)
    share = on_gpu(DOME, "disc_share(offset, 0.3)", offset=offset)
    np.testing.assert_allclose(share, np.minimum(far**2, 1), atol=1e-6)
    for sphere in (False, True):
        result = on_gpu(DOME, f"dome_of_share(share, {str(sphere).lower()})", share=share)
        np.testing.assert_allclose(result, dome(np.sqrt(share.astype(np.float64)), sphere), atol=1e-6)


@BOTH_TEXTS
def test_turns_are_discs(engine, circles_of):
    """However they are grouped: one by one, or many in one run; a stop in a block is the sum so far."""
    values = {"seed": 6, "rises": "alike"}
    sketch = circles_of((70, 50), iterations=120, **values)
    turns = dict(engine.steps(sketch, "terrain"))
    assert len(turns) == 121 and not turns[0].any()
    for turn in (1, 24, 50, 96, 97, 119, 120):
        with Engine(engine.ctx, driver=engine.driver) as fresh:
            result = fresh.read(sketch, "terrain.raw", steps={"terrain.raw": turn})
        np.testing.assert_array_equal(result, turns[turn])
        fewer = engine.read(circles_of((70, 50), iterations=turn, **values), "terrain.raw")
        np.testing.assert_array_equal(result, fewer)
