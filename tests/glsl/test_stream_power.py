"""Rivers against uplift: the slope-area law, drainage like a real terrain's, the same terrain at any size."""

import shutil

import numpy as np
import pytest

from playground.paths import SKETCHES

from ..sketch_texts import passes
from ..truth.drainage import counted, edge_of, ends_of, exponent_of, flooded

EXTENT, RELIEF = 20480.0, 1200.0
PASSES = passes(
    noise=("generation/gradient_noise", "set = { frequency = 16, octaves = 8, seed = 5 }"),
    low=("./low", 'inputs = { height = "noise" }'),
    rivers=("erosion/stream_power", 'inputs = { height = "low" }'),
)
LOW = """
#pragma kernel(output = "height:r32f")
uniform sampler2D height;  //! input
uniform int turn = 0;      //! slider(0, 1) Half a turn
uniform float dome = 0.0;  //! slider(0, 9) A hill in the middle
float kernel(ivec2 texel) {
    vec2 share = vec2(texel) / vec2(size - 1) - 0.5;
    ivec2 from = turn == 1 ? size - 1 - texel : texel;
    return 0.1 * texelFetch(height, from, 0).r + dome * (0.5 - dot(share, share));
}
"""
TWO = """
#pragma kernel(output = "two:r32f")
float kernel(ivec2 texel) { return 2.0; }
"""
ONE_LEVEL = {"coarsest": 4096}
BARE = {**ONE_LEVEL, "creep": 0.0, "steepest": 89.0, "head": 0.0, "randomness": 0.0}


@pytest.fixture
def worn(ctx, kept, make_sketch):
    """Give ``worn(size, **parameters)``: metres, ways, areas [m2], and the metres before."""

    def wear(size, body=PASSES, extent=EXTENT, turn=0, dome=0.0, **values):
        sketch = make_sketch(body, size=size, extent=extent, relief=RELIEF, low=LOW, two=TWO)
        chosen = {f"rivers.{k}": v for k, v in {"keep": 1.0, **values}.items()}
        sketch = sketch.with_values({"low.turn": turn, "low.dome": dome, **chosen})
        names = ("rivers:height", "rivers:receiver", "rivers:area", "low")
        height, receiver, area, low = (kept.read(sketch, name).copy() for name in names)
        return RELIEF * height.astype(float), receiver.astype(int), area, RELIEF * low.astype(float)

    return wear


def slopes_of(height, receiver, spacing):
    """Return the slope along each texel's way, NaN at outlets."""
    rows, columns = np.divmod(receiver, height.shape[1])
    y, x = np.indices(height.shape)
    length = spacing * np.hypot(rows - y, columns - x)
    drop = height - height.ravel()[receiver]
    return np.where(length > 0, drop / np.maximum(length, 1e-9), np.nan)


@pytest.mark.slow
@pytest.mark.parametrize("power", [0.4, 0.5])
def test_slopes_of_a_steady_state_follow_the_law(worn, power):
    """U = K A^m S, so S A^m K / U is 1 and log S falls with log A by m: both within 1 %."""
    wear = 5.0 if power == 0.5 else 20.0
    height, receiver, area, _ = worn(49, **BARE, age=100.0, steps=80, area_power=power, erodibility=wear)
    slope = slopes_of(height, receiver, EXTENT / 48)
    inner = ~edge_of(height.shape)
    assert (slope[inner] > 0).all()
    ratio = slope[inner] * 1e-6 * wear * area[inner].astype(float) ** power / 5e-4
    assert np.median(ratio) == pytest.approx(1.0, abs=0.01)
    exponent = np.polyfit(np.log(area[inner]), np.log(slope[inner]), 1)[0]
    assert exponent == pytest.approx(-power, rel=0.01)


HALF_DRY = """
#pragma kernel(output = "rain:r32f")
float kernel(ivec2 texel) { return 2 * texel.x < size.x ? 0.125 : 1.5; }
"""


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*accumulation.comp is left out:playground.errors.PlainFormWarning")
def test_rain_makes_a_steady_state_of_discharges(engine, make_sketch):
    """S = (U / K) Q^-m where Q is the rain above; where it is even, that is another K: within 1 % both."""
    values = {**BARE, "age": 100.0, "steps": 80, "keep": 1.0}

    def steady(rain="", text=HALF_DRY, **more):
        wet = f'[[pass]]\nname = "wet"\nuse = "./wet"\nsize = {rain}\n' if rain else ""
        wired = 'inputs = { height = "low", rain = "wet" }' if rain else 'inputs = { height = "low" }'
        body = wet + PASSES.replace('inputs = { height = "low" }', wired)
        sketch = make_sketch(body, size=49, extent=EXTENT, relief=RELIEF, low=LOW, wet=text)
        sketch = sketch.with_values({f"rivers.{k}": v for k, v in {**values, **more}.items()})
        height = RELIEF * engine.read(sketch, "rivers:height").astype(float)
        return height, engine.read(sketch, "rivers:receiver").astype(int)

    height, receiver = steady(49)
    half = np.where(2 * np.arange(49) < 49, 0.125, 1.5) * np.ones((49, 1))
    discharge = (EXTENT / 48) ** 2 * counted(receiver, half)
    slope, inner = slopes_of(height, receiver, EXTENT / 48), ~edge_of(height.shape)
    ratio = slope[inner] * 5e-6 * discharge[inner] ** 0.5 / 5e-4
    assert np.median(ratio) == pytest.approx(1.0, abs=0.01)
    assert (np.abs(ratio - 1) < 0.01).mean() > 0.95
    dry, wet = height[1:-1, 1:24].mean(), height[1:-1, 25:-1].mean()
    assert dry > 1.5 * wet

    # Rain of any size of its own: 4 everywhere is twice the K.
    result, _ = steady(5, HALF_DRY.replace("2 * texel.x < size.x ? 0.125 : 1.5", "4.0"))
    expected, _ = steady(erodibility=10.0)
    assert np.median(np.abs(result - expected)) < 0.01 * np.median(expected)
    np.testing.assert_allclose(np.quantile(result, [0.5, 0.9]), np.quantile(expected, [0.5, 0.9]), rtol=0.01)


def test_links_are_solved_as_one_after_another(engine, make_sketch):
    body = passes(links="./links", solved=("erosion/stream_power/solve", 'inputs = { initial = "links" }'))
    links = """
#include "noise/hash.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "link:rgba32f")
vec4 kernel(ivec2 texel) {
    vec2 drawn = random_pair(texel, 3u);
    ivec2 to = ivec2(clamp(texel.x + int(3.0 * random(texel, 4u)) - 1, 0, size.x - 1), texel.y - 1);
    return texel.y == 0 ? vec4(drawn.x, 0.0, number_of(texel, size), 0.0)
                        : vec4(drawn.x, drawn.y, number_of(to, size), 0.0);
}
"""
    sketch = make_sketch(body, size=[31, 90], links=links)
    link = engine.read(sketch, "links").reshape(-1, 4).astype(float)
    expected = link[:, 0].copy()
    for number in range(31, len(link)):
        expected[number] += link[number, 1] * expected[int(link[number, 2])]
    result = engine.read(sketch, "solved")[..., 0].ravel()
    np.testing.assert_allclose(result, expected, rtol=2e-6)


@pytest.mark.slow
def test_nothing_is_under_lakes_and_all_areas_arrive(worn):
    height, receiver, area, low = worn([97, 130], extent=[9600.0, 12900.0])
    edge = edge_of(height.shape)
    np.testing.assert_array_equal(height, flooded(height, (100.0, 100.0), 0.0))
    assert edge.ravel()[ends_of(receiver)].all()
    np.testing.assert_array_equal(area, 1e4 * counted(receiver))
    np.testing.assert_allclose(height[edge], low[edge], atol=2e-4, err_msg="edges stay")


@pytest.mark.slow
def test_rivers_of_a_coarse_grid_are_those_of_the_fine_one(engine, make_sketch):
    body = PASSES.replace("[[pass]]", '[[pass]]\nsize = "(size.x - 1) // 2 + 1"') + passes(
        finer=(
            "water/levels/finer",
            "set = { winding = 1.0 }",
            "[pass.inputs]",
            'start = "low"',
            'coarse = "rivers:height"',
            'coarse_receiver = "rivers:receiver"',
            'coarse_level = "rivers:height"',
        )
    )
    for size in (65, 66):
        sketch = make_sketch(body, size=size, extent=EXTENT, relief=RELIEF, low=LOW)
        coarse, way = engine.read(sketch, "rivers:height").copy(), engine.read(sketch, "rivers:receiver")
        fine, ways = engine.read(sketch, "finer:height").copy(), engine.read(sketch, "finer:receiver")
        np.testing.assert_array_equal(fine[2:-2:2, 2:-2:2][:31, :31], coarse[1:-1, 1:-1])
        assert edge_of(fine.shape).ravel()[ends_of(ways)].all(), "no way goes in a circle"
        kept = total = bent = 0
        for y, x in np.argwhere(~edge_of(coarse.shape)):
            goal = divmod(int(way[y, x]), 33)
            here = divmod(int(ways[2 * y, 2 * x]), size)
            bent += (here[0] != y + goal[0]) or (here[1] != x + goal[1])
            there = here
            for _ in range(3):
                if there[0] % 2 or there[1] % 2:
                    there = divmod(int(ways[there]), size)
            total += 1
            kept += there == (2 * goal[0], 2 * goal[1])
            assert coarse[there[0] // 2, there[1] // 2] < coarse[y, x], "down, from one to the next"
        # The others meet another stretch halfway, and go on to its lower end.
        assert kept > 0.8 * total and bent > 0.5 * total


@pytest.mark.slow
def test_hardness_divides_erodibility_and_uplift_multiplies_rate(worn):
    values = {"steps": 12, "finer_steps": 2, "erodibility": 8.0}
    factor = 'inputs = { height = "low", INPUT = "two" }'
    two = '[[pass]]\nname = "two"\nuse = "./two"\nsize = 5\n' + PASSES
    hard = two.replace('inputs = { height = "low" }', factor.replace("INPUT", "hardness"))
    lifted = two.replace('inputs = { height = "low" }', factor.replace("INPUT", "uplift"))
    for body, same in ((hard, {"erodibility": 4.0}), (lifted, {"rise": 1.0})):
        result, *_ = worn(65, body=body, **values)
        expected, *_ = worn(65, **{**values, **same})
        assert np.median(np.abs(result - expected)) < 0.01
        assert np.abs(expected - worn(65, **values)[0]).mean() > 10


@pytest.mark.slow
def test_hillsides_stand_no_steeper_than_they_may(worn):
    values = {"rise": 5.0, "creep": 0.0, "slides": 30, **ONE_LEVEL}
    height, *_ = worn(65, steepest=30.0, **values)
    drop = [np.abs(np.diff(height, axis=a)[1:-1, 1:-1]).max() for a in (0, 1)]
    assert max(drop) <= np.tan(np.radians(30)) * EXTENT / 64 * 1.001
    free, *_ = worn(65, steepest=80.0, **values)
    assert free.max() > height.max()


def test_turned_terrain_wears_turned(worn):
    """A hill without pits, and no chance: both drain alike, and differ by rounding alone."""
    values = {**ONE_LEVEL, "randomness": 0.0, "steps": 6, "age": 0.3, "dome": 4.0}
    height, *_ = worn(65, **values)
    turned, *_ = worn(65, turn=1, **values)
    np.testing.assert_allclose(turned[::-1, ::-1], height, atol=0.01)


@pytest.mark.parametrize("share", [0.1, 0.5, 3.0])
def test_a_checkerboard_on_a_hillside_decays_as_theory_says(engine, make_sketch, share):
    """By hand: of its nine points a step leaves (1 - 2 r) / (1 + 10 r / 3), r = D dt / spacing^2."""
    body = passes(
        board="./board",
        worn=(
            "erosion/stream_power/hillside",
            'inputs = { link = "board" }',
            "set = { age = 1.0, steps = 1, slides = SLIDES, steepest = 89.0, creep = CREEP }",
        ),
    )
    board = """
#pragma kernel(output = "link:rgba32f")
vec4 kernel(ivec2 texel) { return vec4((texel.x + texel.y) % 2 == 0 ? 0.51 : 0.49, 0.0, 0.0, 0.0); }
"""
    sign = (-1.0) ** np.add(*np.mgrid[:41, :41])
    for slides in (1, 4):
        creep = share * slides * 400.0**2 / 1e6
        text = body.replace("SLIDES", str(slides)).replace("CREEP", str(creep))
        sketch = make_sketch(text, size=41, extent=16000.0, relief=RELIEF, board=board)
        left = ((engine.read(sketch, "worn").astype(float) - 0.5) * sign)[15:-15, 15:-15] / 0.01
        np.testing.assert_allclose(left, ((1 - 2 * share) / (1 + 10 * share / 3)) ** slides, atol=2e-5)


BOARD = LOW.replace("return 0.1", "return ((texel.x + texel.y) % 2 == 0 ? 20.0 / 1200.0 : 0.0) + 0.1")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("low", "values"), [(LOW, ONE_LEVEL), (BOARD, {})], ids=["one level", "from a board"]
)
def test_rivers_leave_no_checkerboard(engine, make_sketch, low, values):
    """From noise, or on several levels from one of 20 m: its waves carry as much as waves a little longer.

    Spectra of terrains fall with the wave number, so the corner, of the shortest waves both ways, has less
    power a wave than the band before it, but for chance. The corner has 12 x 12 waves, half of them the
    others' mirror images, and a Hann window mixes 1.5 x 1.5: 32 are independent. The power of a wave of
    noise varies as much as its mean, so the mean of 32 by 1 / sqrt(32): four times that may be over.
    """

    def powers(field):
        window = np.hanning(129)[:, None] * np.hanning(129)
        power = np.abs(np.fft.fft2((field - field.mean()) * window)) ** 2
        least = np.minimum(*np.meshgrid(*(np.abs(np.fft.fftfreq(129)),) * 2))
        return power[least > 0.45].mean(), power[(least > 0.35) & (least <= 0.45)].mean()

    sketch = make_sketch(PASSES, size=129, extent=EXTENT, relief=RELIEF, low=low)
    sketch = sketch.with_values({f"rivers.{k}": v for k, v in {"keep": 1.0, **values}.items()})
    started, worn = (engine.read(sketch, name).astype(float) for name in ("low", "rivers:height"))
    corner, band = powers(started)
    assert (corner > 10 * band) == (low is BOARD)
    corner, band = powers(worn)
    assert corner < (1 + 4 / np.sqrt(32)) * band


@pytest.mark.parametrize(
    "hostile",
    [
        {"erodibility": 1000.0, "age": 100.0, "area_power": 0.8, "steps": 1},
        {"rise": 20.0, "age": 100.0, "erodibility": 0.01, "steepest": 89.0, "head": 0.0},
        {"creep": 10.0, "slides": 64, "age": 100.0, "steps": 2},
        {"steepest": 1.0, "rise": 20.0, "randomness": 1.0, "winding": 1.0, "roughness": 1.0},
    ],
    ids=["erodibility", "rise", "creep", "chance"],
)
@pytest.mark.parametrize("extent", [0.5, 20480.0, 5e6])
def test_hostile_parameters_give_numbers(worn, hostile, extent):
    height, receiver, *_ = worn(33, extent=extent, **{"coarsest": 8, "finer_steps": 3, **hostile})
    assert np.isfinite(height).all()
    assert edge_of(height.shape).ravel()[ends_of(receiver)].all()


REAL = passes(
    height=("generation/heightmap", 'set = { elevation = "real.npz" }'),
    fill="water/fill",
    down=("water/directions", 'inputs = { height = "fill" }'),
    area="water/accumulation",
)


@pytest.mark.slow
def test_it_drains_as_a_real_terrain(worn, kept, make_sketch, tmp_path):
    """The fraction of texels that drain more than a falls as a^-tau: 0.46 in the Cumberland Mountains."""
    shutil.copy(SKETCHES / "data" / "jacksboro_fault_dem.npz", tmp_path / "real.npz")
    real = make_sketch(REAL, size=[403, 344], extent=[402.0, 343.0])
    result = exponent_of(kept.read(real, "area"), 30, 30)
    assert result == pytest.approx(0.46, abs=0.02)
    *_, area, _ = worn(513)
    assert exponent_of(area / (EXTENT / 512) ** 2, 30, 30) == pytest.approx(result, abs=0.1)


def efficiency(result, expected):
    """Return the fraction of the variance that is explained, after Nash and Sutcliffe 1970."""
    return 1 - ((result - expected) ** 2).sum() / ((expected - expected.mean()) ** 2).sum()


@pytest.mark.slow
def test_it_is_the_same_terrain_at_any_size(worn):
    """Over blocks of a sixteenth of the side, by Nash and Sutcliffe's efficiency.

    Above 0.75 a model is very good (Moriasi et al. 2007). Rivers move aside by a texel or two as the
    grid is refined, so single texels are not compared. What a coarser grid cannot hold is a
    valley's head, one texel long and as steep as heads are: the mean differs by that height at most.
    """
    terrains = {size: worn(size)[0] for size in (257, 513, 1025)}
    for coarse, fine in ((257, 513), (513, 1025)):
        step = (fine - 1) // (coarse - 1)
        terrain, expected = terrains[coarse], terrains[fine][::step, ::step]
        blocks = [t[:-1, :-1].reshape(16, coarse // 16, 16, -1).mean((1, 3)) for t in (terrain, expected)]
        head = 5e-4 / 5e-6 / np.sqrt(3e4) * EXTENT / (coarse - 1)
        assert abs(terrain.mean() - expected.mean()) < head
        assert efficiency(*blocks) > 0.75
