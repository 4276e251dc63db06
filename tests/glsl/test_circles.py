"""Circles against sums of domes in NumPy, disc by disc, in metres."""

import numpy as np
import pytest

from playground.engine.engine import Engine

from .drawing import salt

DEFAULTS = {"iterations": 200, "seed": 7, "smallest": 0.02, "largest": 0.2, "rise": 0.1}
DOME = "generation/circles/dome.glsl"
SHAPES = [
    ((33, 33), (1000.0, 1000.0)),
    ((130, 100), (1300.0, 1000.0)),
    ((40, 23), (300.0, 900.0)),
    ((100, 9), (2000.0, 100.0)),
    ((2, 2), (10.0, 10.0)),
    ((1, 7), (10.0, 10.0)),
]


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(33, 33), extent=(1000.0, 1000.0), before="", inputs="", **values):
        value = "".join(f"{k} = {v!r}\n" for k, v in values.items())
        use = '[[pass]]\nname = "terrain"\nuse = "generation/circles"\n'
        text = f"{before}{use}{inputs}[pass.set]\n{value}"
        return make_sketch(text, size=list(size), extent=list(extent))

    return make


@pytest.fixture
def discs(on_gpu):
    """Give ``discs(extent, **values)``: x, y, radius in metres and height of each disc."""

    def make(extent, **values):
        v = DEFAULTS | values
        index = np.arange(v["iterations"], dtype=np.uint32)
        bits = on_gpu(
            "noise/hash.glsl",
            "hash3(uvec3(i, 0u, s))",
            i=index,
            s=np.uint32(v["seed"] + salt("generation/circles")),
        )
        numbers = (bits >> 8) / 2.0**24
        low, high = sorted((v["smallest"], v["largest"]))
        share = np.interp(numbers[:, 2], [0, 1], [low, high])
        heights = v["rise"] * (np.ones(len(share)) if v.get("rises") == "alike" else share / high)
        return [*(numbers[:, :2] * extent).T, share * min(extent), heights]

    return make


def far_from(disc, size, extent):
    """Return how far each texel is from a disc's middle, in its radii."""
    x, y = (np.linspace(0, e, n) if n > 1 else np.zeros(1) for n, e in zip(size, extent, strict=True))
    return np.hypot(x[None, :] - disc[0], y[:, None] - disc[1]) / disc[2]


def dome(far, sphere=False):
    """Return a dome's height: the squared cosine of half the angle, or by the angle from the top."""
    inside = np.minimum(far, 1)
    return np.sin(np.arccos(inside)) if sphere else np.cos(inside * np.pi / 2) ** 2


def summed(size, extent, drawn, sphere=False):
    terrain = np.zeros(size[::-1])
    for disc in zip(*drawn, strict=True):
        terrain += disc[3] * dome(far_from(disc, size, extent), sphere)
    return terrain


@pytest.mark.parametrize(("size", "extent"), SHAPES, ids=str)
@pytest.mark.parametrize(
    "values", [{}, {"iterations": 97, "rises": "alike"}, {"smallest": 0.4, "largest": 0.1}]
)
def test_it_is_the_sum_of_its_domes(engine, sketch_of, discs, size, extent, values):
    result = engine.read(sketch_of(size, extent, **values), "terrain.raw")
    truth = summed(size, extent, discs(extent, **values))
    # Places are counted in the shorter side: on a long terrain they are large numbers, and rounded.
    long = max(extent) / min(extent)
    np.testing.assert_allclose(result, truth, atol=2e-6 * long * max(1, truth.max()))


def test_half_spheres(engine, sketch_of, discs):
    size, extent = (130, 100), (1300.0, 1000.0)
    result = engine.read(sketch_of(size, extent, dome="half a sphere"), "terrain.raw")
    # At its rim a half sphere is upright: there a rounded place has a height of its own.
    truth = summed(size, extent, discs(extent), sphere=True)
    near = np.min([abs(far_from(d, size, extent) - 1) for d in zip(*discs(extent), strict=True)], axis=0)
    np.testing.assert_allclose(result, truth, atol=2e-4)
    assert (near > 1e-2).any()
    np.testing.assert_allclose(result[near > 1e-2], truth[near > 1e-2], atol=1e-5)


def test_it_is_the_sum_of_its_domes_at_513(engine, sketch_of, discs):
    values = {"iterations": 1000, "smallest": 0.0, "largest": 0.05}
    result = engine.read(sketch_of((513, 513), **values), "terrain.raw")
    rows = [0, 77, 256, 512]
    truth = np.zeros((4, 513))
    x, y = np.linspace(0, 1000, 513), np.linspace(0, 1000, 513)[rows]
    for cx, cy, radius, height in zip(*discs((1000, 1000), **values), strict=True):
        truth += height * dome(np.hypot(x[None] - cx, y[:, None] - cy) / max(radius, 1e-9))
    np.testing.assert_allclose(result[rows], truth, atol=2e-6)


@pytest.mark.parametrize("dome", ["half a cosine", "half a sphere"])
def test_outside_every_disc_the_terrain_keeps_its_height(engine, sketch_of, discs, dome):
    """To the last bit; inside any, it is higher."""
    before = '[[pass]]\nname = "start"\nuse = "generation/layered_noise"\n'
    values = {"iterations": 30, "seed": 5, "smallest": 0.05, "largest": 0.1}
    size, extent = (100, 70), (1000.0, 700.0)
    sketch = sketch_of(size, extent, before, 'inputs = { initial = "start" }\n', dome=dome, **values)
    start, terrain = engine.read(sketch, "start"), engine.read(sketch, "terrain.raw")
    far = np.min([far_from(d, size, extent) for d in zip(*discs(extent, **values), strict=True)], axis=0)
    outside, inside = far > 1 + 1e-5, far < 0.98
    assert outside.sum() > 1000 and inside.sum() > 1000
    np.testing.assert_array_equal(terrain[outside], start[outside])
    assert (terrain[inside] > start[inside]).all()
    alone = engine.read(sketch_of(size, extent, dome=dome, **values), "terrain.raw")
    assert not alone[outside].any()


@pytest.mark.parametrize("extent", [(1000.0, 1000.0), (4000.0, 1000.0), (1000.0, 2500.0)], ids=str)
def test_discs_are_round_in_metres(engine, sketch_of, discs, extent):
    size = (401, 301)
    for seed in range(40):
        (x,), (y,), (radius,), _ = discs(extent, iterations=1, seed=seed, smallest=0.2, largest=0.2)
        if radius < x < extent[0] - radius and radius < y < extent[1] - radius:
            break
    sketch = sketch_of(size, extent, iterations=1, seed=seed, smallest=0.2, largest=0.2)
    terrain = engine.read(sketch, "terrain.raw")
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
        assert result[0] == pytest.approx(1, abs=1e-6) and abs(result[-1]) < 1e-6


def test_turns_are_discs(engine, sketch_of):
    """However they are grouped: one by one, or many in one run; a stop in a block is the sum so far."""
    values = {"seed": 6, "rises": "alike"}
    sketch = sketch_of((70, 50), iterations=120, **values)
    turns = dict(engine.steps(sketch, "terrain"))
    assert len(turns) == 121 and not turns[0].any()
    for turn in (1, 24, 50, 96, 97, 119, 120):
        with Engine(engine.ctx, driver=engine.driver) as fresh:
            result = fresh.read(sketch, "terrain.raw", steps={"terrain.raw": turn})
        np.testing.assert_array_equal(result, turns[turn])
        fewer = engine.read(sketch_of((70, 50), iterations=turn, **values), "terrain.raw")
        np.testing.assert_array_equal(result, fewer)


def test_nothing_to_add_is_flat_terrain(engine, sketch_of):
    for values in ({"iterations": 0}, {"smallest": 0.0, "largest": 0.0}):
        for normalise in ("none", "max", "minmax"):
            terrain = engine.read(sketch_of(normalise=normalise, **values), "terrain")
            np.testing.assert_array_equal(terrain, 0)


def test_discs_as_wide_as_the_terrain(engine, sketch_of):
    terrain = engine.read(sketch_of(iterations=1000, smallest=1.0, largest=1.0), "terrain.raw")
    assert np.isfinite(terrain).all() and terrain.min() > 0


def test_normalise_and_seeds(engine, sketch_of):
    raw = engine.read(sketch_of(), "terrain.raw").astype(np.float64)
    terrains = {n: engine.read(sketch_of(normalise=n), "terrain") for n in ("none", "max", "minmax")}
    np.testing.assert_array_equal(terrains["none"], raw)
    np.testing.assert_allclose(terrains["max"], raw / raw.max(), atol=1e-6)
    np.testing.assert_allclose(terrains["minmax"], (raw - raw.min()) / np.ptp(raw), atol=1e-6)
    first, other, again = (engine.read(sketch_of(seed=s), "terrain") for s in (1, 2, 1))
    np.testing.assert_array_equal(first, again)
    assert np.abs(first - other).max() > 0.1


def test_both_drivers_agree_to_the_last_bit(ctx, sketch_of):
    sketch = sketch_of((130, 70), (1300.0, 700.0), dome="half a sphere")
    with Engine(ctx, driver="fragment") as first, Engine(ctx, driver="compute") as other:
        np.testing.assert_array_equal(first.read(sketch, "terrain.raw"), other.read(sketch, "terrain.raw"))
