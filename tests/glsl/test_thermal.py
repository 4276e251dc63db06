"""Thermal erosion: a step against float64, volume, angle of repose, symmetry, sizes, hostile input."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes
from .test_hydraulic import hills, written

RELIEF = 1200.0
NEIGHBOURS = ((0, 1), (1, 0), (1, 1), (1, -1))


@pytest.fixture
def fallen(make_sketch, tmp_path):
    """Give ``fallen(heights, extent=…, maps={input: array}, **parameters)``: "worn" is the technique."""
    numbers = iter(range(1000))

    def source(heights):
        file = f"map_{next(numbers)}.npy"
        np.save(tmp_path / file, heights.astype(np.float32))
        return "generation/heightmap", f'set = {{ elevation = "{file}", first_row = "south" }}'

    def make(heights, extent=5000.0, relief=RELIEF, maps=None, **values):
        text = ", ".join(f"{name} = {written(value)}" for name, value in values.items())
        maps = maps or {}
        wires = "".join(f', {name} = "map_{name}"' for name in maps)
        return make_sketch(
            passes(
                land=source(heights),
                **{f"map_{name}": source(value) for name, value in maps.items()},
                worn=(
                    "erosion/thermal",
                    f"set = {{ {text} }}",
                    f'inputs = {{ height = "land"{wires} }}',
                ),
            ),
            size=[heights.shape[1], heights.shape[0]],
            extent=extent if isinstance(extent, float) else list(extent),
            relief=relief,
        )

    return make


def pairs(shape, dy, dx):
    """Return slices of all texels and of their neighbours so many rows and columns on."""
    ny, nx = shape
    low = np.s_[: ny - dy, (1 if dx < 0 else 0) : (nx - 1 if dx > 0 else nx)]
    high = np.s_[dy:, (1 if dx > 0 else 0) : (nx - 1 if dx < 0 else nx)]
    return low, high


def areas(shape):
    """Return the area of each node of a mesh, in texels: half on an edge, a quarter in a corner."""
    y, x = (np.where(np.isin(np.arange(n), (0, n - 1)), 0.5, 1.0) for n in shape)
    return y[:, None] * x


def stepped(z, spacing, tangent, share):
    """Return the heights [m] a step later: what goes from each neighbour to the other, as volume."""
    moved = np.zeros_like(z)
    rows, columns = (np.where(np.isin(np.arange(n), (0, n - 1)), 0.5, 1.0) for n in z.shape)
    rows, columns = np.broadcast_to(rows[:, None], z.shape), np.broadcast_to(columns, z.shape)
    for dy, dx in NEIGHBOURS:
        low, high = pairs(z.shape, dy, dx)
        rise = z[high] - z[low]
        most = (tangent[low] + tangent[high]) / 2 * np.hypot(dx * spacing[0], dy * spacing[1])
        over = np.sign(rise) * np.maximum(np.abs(rise) - most, 0) / 8
        volume = over * np.minimum(share[low], share[high])
        volume = volume * np.minimum(rows[low], rows[high]) * np.minimum(columns[low], columns[high])
        moved[low] += volume
        moved[high] -= volume
    return z + moved / areas(z.shape)


def steepest(heights, spacing):
    """Return the steepest slope between any two neighbours, and that of the upper percent."""
    result = [
        np.abs(heights[low] - heights[high]).ravel() / np.hypot(dx * spacing[0], dy * spacing[1])
        for dy, dx in NEIGHBOURS
        for low, high in [pairs(heights.shape, dy, dx)]
    ]
    slopes = np.concatenate(result)
    return slopes.max(), np.percentile(slopes, 99)


def volume(heights):
    return (heights.astype(np.float64) * areas(heights.shape)).sum()


@pytest.mark.parametrize("wired", [False, True], ids=["plain", "maps"])
def test_a_step_is_that_of_the_equations(engine, fallen, wired):
    size, extent = (40, 28), (5000.0, 2100.0)
    heights = hills(size)
    shape = heights.shape
    maps = {"repose": hills(size, 5), "hardness": hills(size, 6)} if wired else {}
    sketch = fallen(heights, extent, maps=maps, steps=40, repose=30.0, coarse=False)
    spacing = extent[0] / 39, extent[1] / 27
    factor = maps.get("repose", np.ones(shape)).astype(np.float64)
    tangent = np.tan(np.radians(np.clip(30 * factor, 1, 89)))
    share = 1 / np.maximum(maps.get("hardness", np.ones(shape)), 1.0)
    expected = heights.astype(np.float64) * RELIEF
    for steps in range(41):
        if steps in (0, 1, 2, 40):
            relief = RELIEF * engine.read(sketch, "worn", steps={"worn.level.slide": steps})
            # A step is a mean of neighbours, so that roundings of 2**-24 only add up.
            np.testing.assert_allclose(relief, expected, atol=16 * (steps + 1) * 2**-24 * RELIEF)
        expected = stepped(expected, spacing, tangent, share)
    assert np.abs(expected - RELIEF * heights).max() > 20, "it falls"


def test_the_volume_stays_for_a_thousand_steps(engine, fallen):
    heights = hills((65, 65), 2)
    plain = fallen(heights, steps=1000, coarse=False, repose=15.0)
    assert volume(engine.read(plain, "worn")) == pytest.approx(volume(heights), rel=1e-6)
    assert np.abs(engine.read(plain, "worn") - heights).max() > 0.05


def test_the_volume_stays_from_coarse_to_fine(engine, fallen):
    heights = hills((257, 129), 2)
    sketch = fallen(heights, repose=25.0)
    result = engine.read(sketch, "worn")
    assert volume(result) == pytest.approx(volume(heights), rel=1e-6)
    change = RELIEF * (result.astype(np.float64) - heights)
    wear, deposit = (engine.read(sketch, f"worn:{name}") for name in ("wear", "deposit"))
    np.testing.assert_allclose(deposit - wear, change, atol=4 * 2**-24 * RELIEF)
    assert wear.min() == deposit.min() == (wear * deposit).max() == 0 and wear.max() > 20


@pytest.mark.parametrize("repose", [20.0, 35.0, 60.0])
def test_a_tower_falls_into_a_cone_of_its_angle_of_repose(engine, fallen, repose):
    """Of 24 texels the slowest wave loses 3/8 (pi / 24)^2 a step: e^-12 of it is left after 2000."""
    heights = np.zeros((25, 25))
    heights[8:17, 8:17] = 1
    sketch = fallen(heights, 240.0, 300.0, steps=2000, repose=repose, coarse=False)
    result = 300.0 * engine.read(sketch, "worn").astype(np.float64)
    tangent = np.tan(np.radians(repose))
    assert steepest(result, (10, 10))[0] == pytest.approx(tangent, rel=1e-4)
    assert result.min() >= 0 and result.argmax() == 25 * 12 + 12
    # Below what is left of its top, a line straight down lies at the angle.
    flank = result[12, 16:][result[12, 16:] > 15]
    assert len(flank) > 2
    np.testing.assert_allclose(-np.diff(flank), 10 * tangent, rtol=0.02)


@pytest.mark.parametrize("way", ["quarter", "half", "mirrored", "transposed"])
def test_thermal_erosion_commutes_with_rotation_and_mirroring(engine, fallen, way):
    turned = {
        "quarter": np.rot90,
        "half": lambda a: np.rot90(a, 2),
        "mirrored": np.fliplr,
        "transposed": lambda a: a.swapaxes(0, 1),
    }[way]
    heights = hills((65, 65), 4)
    plain = engine.read(fallen(heights, steps=100), "worn")
    result = engine.read(fallen(turned(heights), steps=100), "worn")
    np.testing.assert_array_equal(result, turned(plain))


def test_what_is_not_too_steep_stays_to_the_last_bit(engine, fallen):
    heights = hills((129, 129), 1)
    gentle = np.degrees(np.arctan(steepest(RELIEF * heights.astype(float), (5000 / 128,) * 2)[0])) + 1
    sketch = fallen(heights, repose=float(gentle))
    np.testing.assert_array_equal(engine.read(sketch, "worn"), heights)


@pytest.mark.slow
def test_terrains_of_several_sizes_fall_alike(engine, make_sketch):
    """From coarse to fine the long ways are gone on the same grids, whatever the size.

    What may differ is what a finer grid adds: a relative 2 % of what fell. The same steps leave
    slopes of which 99 % are within 2 degrees of the angle of repose, at each size.
    """
    land = ("generation/gradient_noise", "set = { frequency = 3, octaves = 4, seed = 5 }")
    worn = ("erosion/thermal", 'inputs = { height = "raw" }')
    fell = {}
    for size in (129, 257, 513):
        sketch = make_sketch(passes(raw=land, worn=worn), size=size, extent=10240.0, relief=1800.0)
        result, raw = (engine.read(sketch, name).astype(np.float64) for name in ("worn", "raw"))
        per = (size - 1) // 128
        fell[size] = (result - raw)[::per, ::per]
        assert steepest(1800 * result, (10240 / (size - 1),) * 2)[1] < np.tan(np.radians(37))
        assert steepest(1800 * raw, (10240 / (size - 1),) * 2)[1] > np.tan(np.radians(48))
    scale = np.sqrt((fell[513] ** 2).mean())
    for size in (129, 257):
        assert np.sqrt(((fell[size] - fell[513]) ** 2).mean()) < 0.02 * scale


def test_a_hostile_terrain_stays_finite(engine, fallen):
    for size, extent in (((2, 2), 1.0), ((3, 70), (1.0, 9000.0)), ((66, 65), 1.0)):
        heights = hills(size, 3)
        for repose in (1.0, 89.0):
            sketch = fallen(heights, extent, 20_000.0, repose=repose, steps=200)
            result = engine.read(sketch, "worn")
            assert np.isfinite(result).all() and result.min() >= -1e-6 and result.max() <= 1 + 1e-6
