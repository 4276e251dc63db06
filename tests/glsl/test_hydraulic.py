"""Hydraulic erosion: a step against float64, what is conserved, symmetry, waves, hostile parameters."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.stats import gamma

from ..sketch_texts import passes
from ..truth.pipes import Pipes

RELIEF = 1200.0
ULP = 2**-23
"""The distance from 1 to the next float32."""


def hills(size, seed=0):
    """Return heights 0..1 with slopes of all kinds, (ny, nx)."""
    random = np.random.default_rng(seed)
    ny, nx = size[1], size[0]
    total = np.zeros((ny, nx))
    y, x = np.mgrid[0 : 1 : ny * 1j, 0 : 1 : nx * 1j]
    for octave in range(5):
        for _ in range(3):
            way = random.normal(size=2) * 2.0**octave * 3
            total += np.sin(x * way[0] + y * way[1] + random.uniform(0, 7)) / 2.0**octave
    return ((total - total.min()) / np.ptp(total)).astype(np.float32)


@pytest.fixture
def eroded(make_sketch, tmp_path):
    """Give ``eroded(heights, extent=…, inputs=…, **parameters)``: its pass "worn" is the technique."""
    numbers = iter(range(1000))

    def make(heights, extent=5000.0, relief=RELIEF, extra="", inputs="", files=None, **values):
        file = f"land_{next(numbers)}.npy"
        np.save(tmp_path / file, heights)
        text = ", ".join(f"{name} = {written(value)}" for name, value in values.items())
        return make_sketch(
            passes(
                height=(
                    "generation/heightmap",
                    f'set = {{ elevation = "{file}", first_row = "south" }}',
                ),
            )
            + extra
            + passes(
                worn=("erosion/hydraulic", f"set = {{ {text} }}", inputs and f"inputs = {{ {inputs} }}")
            ),
            size=[heights.shape[1], heights.shape[0]],
            extent=extent if isinstance(extent, float) else list(extent),
            relief=relief,
            **(files or {}),
        )

    return make


def written(value):
    return f'"{value}"' if isinstance(value, str) else str(value).lower()


def state(engine, sketch, steps):
    """Return bed, water, load, mean flow and the flux after so many steps, in float64."""
    result = [
        engine.read(sketch, f"worn.water:{name}", steps={"worn.water": steps}).astype(np.float64)
        for name in ("state", "flux")
    ]
    return (*np.moveaxis(result[0], -1, 0), np.moveaxis(result[1], -1, 0))


def test_a_step_is_that_of_the_equations(engine, eroded):
    for size, extent, closed in (((40, 28), (5000.0, 2100.0), False), ((33, 33), 5000.0, True)):
        values = {"rain": 0.08, "capacity": 6.0, "evaporation": 0.03, "repose": 30.0}
        sketch = eroded(hills(size), extent, edges="closed" if closed else "open", **values)
        spacing = sketch.terrain.extent[0] / (size[0] - 1), sketch.terrain.extent[1] / (size[1] - 1)
        for steps in (1, 6, 60):
            pipes = Pipes(*state(engine, sketch, steps), spacing=spacing, closed=closed, **values)
            before = replace(pipes)
            pipes.step()
            bed, water, load, mean_flow, flux = state(engine, sketch, steps + 1)
            # Heights up to 1200 m are rounded at each of a dozen operations; of their differences a
            # quarter drives the pipes, and what they carry is a thing of a few metres.
            fine = 12 * ULP * RELIEF
            np.testing.assert_allclose(flux, pipes.flux, atol=fine)
            np.testing.assert_allclose(water, pipes.water, atol=8 * fine)
            np.testing.assert_allclose(mean_flow, pipes.mean_flow, atol=8 * fine)
            # The load follows the capacity, which multiplies the flow.
            np.testing.assert_allclose(load, pipes.load, atol=6 * 8 * fine)
            np.testing.assert_allclose(bed, pipes.bed, atol=6 * 8 * fine)
        assert np.abs(bed - before.bed).max() > 0.01 and water.max() > 1


@pytest.mark.parametrize("rain", [0.003, 0.01])
def test_closed_edges_conserve_rock_and_water_over_1000_steps(engine, eroded, rain):
    heights = hills((65, 65), 3)
    sketch = eroded(heights, edges="closed", evaporation=0.0, rain=rain, hours=5000, capacity=8.0)
    bed, water, load, _, _ = state(engine, sketch, 1000)
    rock = RELIEF * heights.astype(np.float64)
    assert abs((bed + load).sum() / rock.sum() - 1) < 1e-6
    # The first step has rain already, and each adds the same, in whole 65536ths of a metre.
    supply = engine.read(sketch, "worn.start:site")[..., 0].astype(np.float64)
    assert supply[0, 0] == pytest.approx(4 * rain, abs=2**-17)
    assert abs(water.sum() / (1001 * supply.sum()) - 1) < 1e-6
    assert np.abs(bed - rock).mean() > 1 and load.max() > 0.1, "it is worn"


@pytest.mark.slow
def test_what_leaves_through_open_edges_is_accounted_for(engine, eroded):
    heights = hills((33, 29), 1)
    sketch = eroded(heights, (4000.0, 3500.0), evaporation=0.0, hours=5000, capacity=8.0)
    supply = engine.read(sketch, "worn.start:site")[..., 0].astype(np.float64)
    left = np.zeros(2)
    edge = np.s_[:, 0], np.s_[:, -1], np.s_[0], np.s_[-1]
    bed, water, load, _, _ = state(engine, sketch, 0)
    rock, rain = bed.sum(), supply.sum()
    for steps in range(1, 201):
        share = load / np.maximum(water, 1e-9)
        bed, water, load, _, flux = state(engine, sketch, steps)
        for k, at in enumerate(edge):
            left += flux[k][at].sum(), (flux[k] * share)[at].sum()
        rain += supply.sum()
    assert abs(water.sum() + left[0] - rain) < 1e-6 * rain
    assert abs((bed + load).sum() + left[1] - rock) < 1e-6 * rock
    assert left[0] > 0.5 * rain and left[1] > 1e-4 * rock, "most of the rain leaves, and rock with it"


def test_water_that_dries_is_a_share_of_it_an_hour(engine, eroded):
    sketch = eroded(hills((33, 33)), edges="closed", evaporation=0.05, rain=0.004, hours=5000)
    supply = engine.read(sketch, "worn.start:site")[..., 0].astype(np.float64).sum()
    kept = 1 / (1 + 0.05 * 8)
    for steps in (1, 5, 100):
        water = state(engine, sketch, steps)[1].sum()
        expected = supply * (1 - kept ** (steps + 1)) / (1 - kept)
        assert water == pytest.approx(expected, rel=1e-5)


def test_flat_ground_stays_flat_under_rain(engine, eroded):
    sketch = eroded(np.zeros((33, 33), np.float32), edges="closed", hours=400)
    np.testing.assert_array_equal(engine.read(sketch, "worn"), 0)
    assert np.ptp(engine.read(sketch, "worn:water")) == 0


def test_a_checkerboard_in_a_lake_decays(engine, eroded):
    """Pipes one way and the other, by hand: in 8 steps of friction 0.84 less than half of it is left."""
    y, x = np.mgrid[:33, :33]
    sign = (-1.0) ** (x + y)
    still = {"rain": 0.2, "evaporation": 0.0, "capacity": 0.1, "repose": 80.0, "creep": 0.0}
    sketch = eroded((sign > 0).astype(np.float32), relief=1.2, edges="closed", hours=400, **still)
    swings = []
    for steps in (4, 12, 20, 50):
        bed, water, *_ = state(engine, sketch, steps)
        level = bed + water
        swings.append(np.abs(((level - level.mean()) * sign).mean()))
    # The first rain, 1.6 m a step, leaves the tops dry for a step, 0.6 m above the mean.
    assert swings[0] < 0.6 and swings[1] < swings[0] / 2 and swings[2] < swings[1] / 2, swings
    assert swings[3] < 1e-3


@pytest.mark.slow
def test_a_worn_terrain_has_no_checkerboard(engine, eroded):
    """Spectra of terrains fall with the wave number: waves of the grid's size carry no more than longer ones.

    A checkerboard is at the corner of the spectrum, in the main lobe of the window: 2 bins, 3 with an odd
    side. Waves twice as long bound its power: the mean of n powers of random phases is less than
    gamma(0.999, n) / n times theirs. Of the lobe's bins n is half, for conjugates, and less by 1.5 each way,
    the window's noise bandwidth (Harris 1978, "On the Use of Windows", table 1).
    """
    sketch = eroded(hills((129, 129), 2), 5120.0, 900.0, hours=600)
    bed, water, *_ = state(engine, sketch, 300)
    window = np.hanning(129)[:, None] * np.hanning(129)
    x, y = np.meshgrid(*(np.abs(np.fft.fftfreq(129)),) * 2)
    lobe = np.minimum(x, y) > 0.5 - 3 / 129
    modes = lobe.sum() / 2 / 1.5**2
    most = gamma.isf(1e-3, modes) / modes

    def stands_out(field):
        power = np.abs(np.fft.fft2((field - field.mean()) * window)) ** 2
        wave = np.hypot(x, y)
        longer, twice = (power[(wave > low) & (wave <= low + 0.1)].mean() for low in (0.2, 0.3))
        assert twice < longer
        return power[lobe].mean() > most * twice

    assert not stands_out(bed) and not stands_out(bed + water)
    assert stands_out(bed + 0.3 * (-1.0) ** np.add.outer(np.arange(129), np.arange(129)))


def test_outputs_say_what_was_done(engine, eroded):
    heights = hills((65, 65), 2)
    sketch = eroded(heights, hours=1600)
    read = {
        name: engine.read(sketch, f"worn:{name}").astype(np.float64)
        for name in ("height", "water", "wear", "deposit", "flow", "wetness")
    }
    change = RELIEF * (read["height"] - heights)
    np.testing.assert_allclose(read["deposit"] - read["wear"], change, atol=4 * ULP * RELIEF)
    assert (read["wear"] * read["deposit"] == 0).all() and min(a.min() for a in list(read.values())[1:]) >= 0
    bed, water, load, mean_flow, _ = state(engine, sketch, 400)
    np.testing.assert_allclose(read["height"], (bed + load) / RELIEF, rtol=4 * ULP)
    np.testing.assert_array_equal(read["water"], water)
    spacing, hours = 5000 / 64, 4
    np.testing.assert_allclose(read["flow"], mean_flow * spacing / hours, rtol=1e-6)
    np.testing.assert_allclose(read["wetness"], 1 - 2 ** (-read["flow"] / 20), atol=1e-5)


@pytest.mark.parametrize("aslant", [False, True])
def test_one_texel_stream_flows_alike_diagonally_and_along_axis(engine, eroded, aslant):
    """It rains on a groove only: through each texel of it, round corners or not, goes what fell above it."""
    y, x = np.mgrid[:41, :41]
    groove = (y == x) | (y == x + 1) if aslant else y == 20
    above = x + y if aslant else x
    heights = np.where(groove, 0.5 - 0.005 * above, 1.0).astype(np.float32)
    here = "texel.y == texel.x || texel.y == texel.x + 1" if aslant else "texel.y == 20"
    text = f'#pragma kernel(output = "r:r32f")\nfloat kernel(ivec2 texel) {{ return {here} ? 1.0 : 0.0; }}\n'
    still = {"evaporation": 0.0, "capacity": 0.1, "wear": 0.0, "creep": 0.0, "repose": 89.0}
    extra = '[[pass]]\nname = "map"\nuse = "./groove"\n'
    sketch = eroded(
        heights,
        rain=0.005,
        extra=extra,
        inputs='rain = "map"',
        hours=3000,
        edges="open",
        files={"groove": text},
        **still,
    )
    flow = engine.read(sketch, "worn:flow")[groove]
    fell = 0.005 * 125 * (above[groove] + 0.5)  # a texel's own rain flows from its middle
    order = np.argsort(fell)[8:32]
    np.testing.assert_allclose(flow[order], fell[order], rtol=0.01)


@pytest.mark.parametrize("spacing", [(20.0, 20.0), (20.0, 10.0), (10.0, 20.0)])
@pytest.mark.parametrize("downhill", [(1.0, 1.0), (2.0, 1.0), (1.0, 2.0)])
def test_a_sheet_of_rain_brings_what_fell_above_it_aslant_too(engine, eroded, spacing, downhill):
    """Down a plane, the discharge of a metre of width is rain times the length of the way from the edge."""
    y, x = np.mgrid[:65, :65] * 1.0
    way = np.array(downhill) / np.hypot(*downhill)
    fallen = x * spacing[0] * way[0] + y * spacing[1] * way[1]
    slope = (1 - fallen / fallen.max()).astype(np.float32)
    extent = 64 * spacing[0], 64 * spacing[1]
    still = {"evaporation": 0.0, "capacity": 0.1, "wear": 0.0, "creep": 0.0, "repose": 89.0}
    sketch = eroded(slope, extent, rain=0.005, hours=1000, **still)
    flow = engine.read(sketch, "worn:flow")
    # By the western edge every way begins there, by the southern one there; by the diagonal, where ways
    # of both kinds meet, the pipes mix them. A texel's rain flows from its middle; but along the edge what
    # comes has all the rain of the texel before: up to half a texel's too much. Where edges are open, of
    # 2 cm of water a part leaves uphill, against a fall of 3.7 m or more: less than 1 %.
    by_west, by_south = np.s_[50:60, 3:9], np.s_[3:9, 50:60]
    for here, texels, metres in (
        (by_west, x, spacing[0] / way[0]),
        (by_south, y, spacing[1] / way[1]),
    ):
        each = 0.005 * metres
        fell = each * (texels[here] + 0.5)
        assert (flow[here] > 0.99 * fell).all()
        assert (flow[here] < 1.01 * fell + each / 2).all()


def test_hard_rock_wears_less_and_rain_falls_where_the_map_says(engine, eroded):
    text = """#pragma kernel(output = "factor:r32f")
float kernel(ivec2 texel) {{ return 2 * texel.x < size.x ? {west} : {east}; }}
"""
    slope = np.repeat(np.linspace(1, 0, 65, dtype=np.float32)[:, None], 65, 1)
    extra = '[[pass]]\nname = "map"\nuse = "./east_and_west"\n'
    from_file = {"east_and_west": text.format(west="8.0", east="1.0")}
    for wired in ("hardness", "rain"):
        sketch = eroded(slope, extra=extra, inputs=f'{wired} = "map"', hours=200, files=from_file)
        wear = engine.read(sketch, "worn:wear")
        # Near the top, where the water has not yet all that it can carry.
        west, east = wear[:4, :28].mean(), wear[:4, 36:].mean()
        assert west < 0.5 * east if wired == "hardness" else west > 2 * east


def test_a_spring_gives_as_much_as_it_says(engine, eroded):
    flat = np.full((65, 65), 0.5, np.float32)
    sketch = eroded(flat, rain=0.0, spring=2.0, spring_at=[0.3, 0.6], spring_width=1500.0, edges="closed")
    supply = engine.read(sketch, "worn.start:site")[..., 0].astype(np.float64)
    area = (5000 / 64) ** 2
    # The sum over texels of a bump ten wide is its integral but for the error of a smooth function's sum.
    assert supply.sum() * area / 4 == pytest.approx(2e6, rel=0.01)
    y, x = np.unravel_index(supply.argmax(), supply.shape)
    assert (x, y) == (round(0.3 * 64), round(0.6 * 64))


def test_the_rain_can_be_watched(engine, eroded):
    heights = hills((65, 65))
    watched = eroded(heights, hours=200, watched=True, pace=8)
    done = eroded(heights, hours=200)
    for frame in (0, 3, 24, 60):
        hours = min(200, 8 * (frame + 1))
        expected = engine.read(done.with_values({"worn.hours": hours}), "worn")
        np.testing.assert_array_equal(engine.read(watched, "worn", time=frame / 60), expected)


HOSTILE = {
    "much of all": (
        {"rain": 1.0, "wear": 2.0},
        {"capacity": 100.0, "settling": 2.0, "repose": 89.0, "friction": 0.0, "creep": 100.0},
    ),
    "dry": ({"rain": 0.0}, {"evaporation": 1.0, "repose": 1.0, "edges": "closed"}),
    "a torrent": (
        {"rain": 0.0, "spring": 100.0, "spring_width": 1.0},
        {"capacity": 100.0, "evaporation": 1.0, "edges": "closed"},
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("values", HOSTILE.values(), ids=HOSTILE)
def test_ten_thousand_steps_with_hostile_parameters_stay_finite(engine, make_sketch, tmp_path, values):
    heights = hills((33, 33), 7)
    heights[12, 12], heights[3, 3] = 1, 0
    np.save(tmp_path / "land.npy", heights)
    start, step = (", ".join(f"{k} = {written(v)}" for k, v in value.items()) for value in values)
    sketch = make_sketch(
        passes(
            height=("generation/heightmap", 'set = { elevation = "land.npy", first_row = "south" }'),
            start=("erosion/hydraulic/start", f"set = {{ {start} }}"),
            water=(
                "erosion/hydraulic/step",
                f"set = {{ {step} }}",
                'inputs = { state = "start:state", flux = "start:flux", site = "start:site" }',
                'repeat = 10000\nfeedback = { state = "state", flux = "flux" }',
            ),
        ),
        size=33,
        extent=30.0,
        relief=20_000.0,
    )
    result, flux = (engine.read(sketch, f"water:{name}") for name in ("state", "flux"))
    assert np.isfinite(result).all() and np.isfinite(flux).all()
    assert (result[..., 1] >= 0).all() and (flux >= 0).all()


@pytest.mark.slow
def test_terrains_of_several_sizes_are_worn_alike(engine, make_sketch):
    """Everything is of first order in the texel, so half the texel may differ by half as much.

    Compared is what two texels of the coarsest grid can show, relative to what was worn there:
    a sixth may differ between 129 and 513 texels a side, half of that between 257 and 513.
    """
    land = ("generation/gradient_noise", "set = { frequency = 3, octaves = 4, seed = 5 }")
    worn = ("erosion/hydraulic", "set = { hours = 150 }", 'inputs = { height = "raw" }')
    changes = {}
    for size in (129, 257, 513):
        sketch = make_sketch(passes(raw=land, worn=worn), size=size, extent=10240.0, relief=1800.0)
        change = engine.read(sketch, "worn").astype(np.float64) - engine.read(sketch, "raw")
        per = (size - 1) // 128
        changes[size] = gaussian_filter(change, 2 * per, mode="nearest")[::per, ::per]
    finest = changes[513]
    scale = np.sqrt((finest**2).mean())
    assert scale * 1800 > 10, "it is worn"
    for size, bound in ((129, 1 / 6), (257, 1 / 12)):
        assert np.sqrt(((changes[size] - finest) ** 2).mean()) < bound * scale, size
