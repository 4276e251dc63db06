"""Fault formation against sums in NumPy, fault by fault, with the exact sign of each cross product."""

import math

import numpy as np
import pytest

from playground.engine.engine import Engine

from .drawing import salt

LINE = "generation/fault_formation/line.glsl"
SIZES = [(33, 33), (64, 65), (130, 100), (40, 23), (2, 2), (1, 9), (300, 2)]  # one tile to 4 x 3


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(33, 33), before="", inputs="", **values):
        text = "".join(f"{k} = {v!r}\n" for k, v in values.items())
        use = '[[pass]]\nname = "terrain"\nuse = "generation/fault_formation"\n'
        return make_sketch(f"{before}{use}{inputs}[pass.set]\n{text}", size=list(size))

    return make


@pytest.fixture
def drawn(on_gpu):
    """Give ``drawn(faults, seed)``: the points of each line, 0..4095, and a number 0..1 for its height."""

    def make(faults, seed):
        index, key = np.arange(faults, dtype=np.uint32), np.uint32(seed + salt("generation/fault_formation"))
        item, two = (on_gpu("noise/hash.glsl", f"hash3(uvec3(i, {k}u, s))", i=index, s=key) for k in (0, 1))
        return item[:, :2] >> 20, two[:, :2] >> 20, (item[:, 2] >> 8) / 2.0**24

    return make


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


def summed(size, points, heights):
    terrain = np.zeros(size[::-1])
    for first, second, height in zip(*points[:2], heights, strict=True):
        terrain += np.where(sides(first, second, size), height, -height)
    return terrain


@pytest.fixture
def heights_of(any_engine):
    """Give the height of each fault; one test holds them against the rule, the others take them so."""

    def make(sketch, faults, amount=0.05):
        lines = any_engine.read(sketch, "terrain.lines")[0].astype(np.float64)
        assert (lines == np.rint(lines)).all() and (lines[:, 3] >= 1).all()
        return lines[:faults, 3] * unit_of(faults, amount)

    return make


@pytest.mark.parametrize("size", SIZES, ids=str)
@pytest.mark.parametrize("faults", [1, 97, 200])
def test_it_is_the_sum_of_its_faults(engine, sketch_of, drawn, heights_of, size, faults):
    """Exactly: by the plain kernel, by tiles, and by the compute variant."""
    sketch = sketch_of(size, iterations=faults, seed=3)
    truth = summed(size, drawn(faults, 3), heights_of(sketch, faults))
    np.testing.assert_array_equal(engine.read(sketch, "terrain.sum"), truth)
    np.testing.assert_array_equal(engine.read(sketch.plainly(), "terrain.sum"), truth)


@pytest.mark.slow
def test_it_is_the_sum_of_its_faults_at_513(engine, sketch_of, drawn, heights_of):
    sketch = sketch_of((513, 513), iterations=1000, seed=9)
    result = engine.read(sketch, "terrain.sum")
    rows = np.array([0, 1, 100, 256, 511, 512])
    heights, points = heights_of(sketch, 1000), drawn(1000, 9)
    truth = np.zeros((len(rows), 513))
    for first, second, height in zip(*points[:2], heights, strict=True):
        truth += np.where(sides(first, second, (513, 513))[rows], height, -height)
    np.testing.assert_array_equal(result[rows], truth)


@pytest.mark.parametrize("size", [(2112, 2), (2113, 2), (5000, 3)], ids=str)
def test_rows_longer_than_the_shared_memory(ctx, sketch_of, size):
    sketch = sketch_of(size, seed=4)
    with Engine(ctx) as engine:
        quick = engine.read(sketch, "terrain.sum")
        np.testing.assert_array_equal(quick, engine.read(sketch.plainly(), "terrain.sum"))


@pytest.mark.parametrize("fall", ["linear", "ratio"])
@pytest.mark.parametrize("last", [0.01, 0.5, 1.0])
@pytest.mark.parametrize("variation", [0.0, 0.5, 1.0])
def test_heights_fall(any_engine, sketch_of, drawn, fall, last, variation):
    faults, amount = 60, 0.3
    sketch = sketch_of(iterations=faults, seed=5, fall=fall, last=last, variation=variation, amount=amount)
    unit = any_engine.read(sketch, "terrain.lines")[0, :, 3] * unit_of(faults, amount)
    points = [0, faults]
    falling = np.interp(np.arange(faults), points, [1, last])
    if fall == "ratio":
        falling = np.exp(np.interp(np.arange(faults), points, [0, np.log(last)]))
    truth = amount * falling * (1 - variation * drawn(faults, 5)[2])
    np.testing.assert_allclose(unit, truth, atol=2 * unit_of(faults, amount))
    if variation == 0.0:
        assert unit[0] == pytest.approx(amount, rel=1e-5) and (np.diff(unit) <= 0).all()


@pytest.mark.parametrize("size", [(2, 2), (3, 2), (33, 33), (17, 64)], ids=str)
def test_one_fault_gives_two_heights(engine, sketch_of, size):
    """As far above 0 as below it, whatever the line: on the smallest terrain, too, it parts the corners."""
    for seed in range(6):
        sketch = sketch_of(size, iterations=1, seed=seed, radius=0)
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


def test_the_same_line_the_other_way_round_raises_the_other_side(on_gpu):
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
    assert (value[::2] == 0).all() and (value[1::2] != 0).mean() > 0.99


def test_values_are_cross_products(on_gpu):
    rng = np.random.default_rng(3)
    first, second = (rng.integers(0, 4096, (5000, 2)) for _ in range(2))
    position = rng.integers(0, 32769, (5000, 2))
    names = {"p": first, "q": second, "place": position}
    whole = {name: values.astype(np.int32) for name, values in names.items()}
    result = on_gpu(LINE, "fault_value(fault_line(p, q), place)", **whole)
    (ax, ay), (bx, by) = (second - first).T, (position - first * 8 - 4).T
    np.testing.assert_array_equal(result, ax * by - ay * bx)


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


def test_turns_are_faults(engine, sketch_of, drawn, heights_of):
    """However they are grouped: one by one, many in one run, from a stop in the middle of a block."""
    sketch = sketch_of((100, 70), iterations=120, seed=6)
    points, heights = drawn(120, 6), heights_of(sketch, 120)
    truth = np.zeros((70, 100))
    for turn, result in engine.steps(sketch, "terrain"):
        if turn > 0:
            up = sides(points[0][turn - 1], points[1][turn - 1], (100, 70))
            truth += np.where(up, heights[turn - 1], -heights[turn - 1])
        np.testing.assert_array_equal(result, truth)
    for turn in (1, 50, 96, 97, 119, 120):
        with Engine(engine.ctx, driver=engine.driver) as fresh:
            result = fresh.read(sketch, "terrain.sum", steps={"terrain.sum": turn})
        up = np.array([sides(points[0][i], points[1][i], (100, 70)) for i in range(turn)])
        expected = (np.where(up, 1, -1) * heights[:turn, None, None]).sum(axis=0)
        np.testing.assert_array_equal(result, expected)


def test_initial_terrain_is_added_to_faults_at_any_grouping(engine, sketch_of):
    before = '[[pass]]\nname = "start"\nuse = "generation/layered_noise"\n'
    values = {"size": (33, 33), "iterations": 50, "seed": 6}
    sketch = sketch_of(before=before, inputs='inputs = { "sum.initial" = "start" }\n', **values)
    start = engine.read(sketch, "start").astype(np.float64)
    faults = engine.read(sketch_of(**values), "terrain.sum").astype(np.float64)
    whole = engine.read(sketch, "terrain.sum").copy()
    np.testing.assert_allclose(whole, start + faults, atol=unit_of(50, 0.05))
    *_, (_, by_steps) = engine.steps(sketch, "terrain.sum")
    np.testing.assert_array_equal(by_steps, whole)


def test_another_size_is_the_same_terrain(any_engine, sketch_of):
    """Lines do not depend on the terrain's texels: the coarse one is every fourth texel of the fine one."""
    coarse, fine = (any_engine.read(sketch_of((n, n)), "terrain.sum") for n in (65, 257))
    np.testing.assert_array_equal(fine[::4, ::4], coarse)


def test_no_faults_are_flat_terrain(engine, sketch_of):
    for normalise in ("none", "max", "minmax"):
        sketch = sketch_of(iterations=0, normalise=normalise)
        np.testing.assert_array_equal(engine.read(sketch, "terrain"), 0)


def test_the_filter_makes_walls_slopes(engine, sketch_of):
    steps = {}
    for radius in (0, 3, 8):
        sketch = sketch_of((65, 65), iterations=1, radius=radius)
        terrain = engine.read(sketch, "terrain")
        steps[radius] = max(np.abs(np.diff(terrain, axis=a)).max() for a in (0, 1))
    # A mean over 2 radius + 1 texels spreads a wall over as many, along the axis that meets it best.
    assert steps[0] == 1 and 1 / 7 <= steps[3] <= 0.2 and 1 / 17 <= steps[8] <= 0.09


def test_normalise_and_seeds(engine, sketch_of):
    raw = engine.read(sketch_of(radius=0), "terrain.sum").astype(np.float64)
    terrains = {
        n: engine.read(sketch_of(radius=0, normalise=n), "terrain") for n in ("none", "max", "minmax")
    }
    np.testing.assert_array_equal(terrains["none"], raw)
    np.testing.assert_allclose(terrains["max"], raw / raw.max(), atol=1e-6)
    np.testing.assert_allclose(terrains["minmax"], (raw - raw.min()) / np.ptp(raw), atol=1e-6)
    first, other, again = (engine.read(sketch_of(seed=s), "terrain") for s in (1, 2, 1))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.1
