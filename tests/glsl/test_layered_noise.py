"""Layered noise, alone, mixed, tiled and multiplied: against the thesis's loops, with exact fractions."""

import re
from fractions import Fraction
from functools import partial
from math import floor

import numpy as np
import pytest
from scipy.ndimage import maximum_filter

from playground.paths import GLSL
from playground.shader.expressions import evaluate_pair
from playground.sketch.techniques import read_technique

from ..sketch_texts import kernel, passes, use
from ..truth.noise import python_random, salt
from .conftest import BOTH_TEXTS

SEED = 7
DRAWN = SEED + salt("generation/layered_noise")
RANDOM_SIDE = 2**15  # numbers a side of the layer that all nodes read


def curve(y1, y2, n, delta, smooth):
    """Return section 1.3.9's two interpolations, without the slip at delta 0."""
    if n == 0:
        return y1
    if not smooth:
        return y1 + delta * (y2 - y1) / n
    a = delta / n
    return y1 * (3 * (1 - a) ** 2 - 2 * (1 - a) ** 3) + y2 * (3 * a**2 - 2 * a**3)


def bounds(position, size, frequency):
    """Return the nodes before and after a place: exact where the thesis rounds."""
    step = Fraction(size, frequency)
    q = floor(position / step)
    return floor(q * step), min(floor((q + 1) * step), size - 1)


def read_at(position, size, frequency):
    """Return which numbers of the random layer those nodes read: those at their shares of the side."""
    q = floor(Fraction(position * frequency, size))
    return tuple(floor(Fraction(k * RANDOM_SIDE, frequency)) for k in (q, q + 1))


def one_layer(size, frequencies, drawn, smooth):
    """Return a layer; ``drawn(x, y)`` are the numbers of the random layer."""
    nx, ny = size
    terrain = np.zeros((ny, nx))
    keys = [
        [read_at(i, n, frequency) for i in range(n)] for n, frequency in zip(size, frequencies, strict=True)
    ]
    xs, ys = (sorted({k for pair in axis for k in pair}) for axis in keys)
    numbers = dict(zip([(x, y) for y in ys for x in xs], drawn(*np.meshgrid(xs, ys)).ravel(), strict=True))
    for j in range(ny):
        y1, y2 = bounds(j, ny, frequencies[1])
        low, high = keys[1][j]
        for i in range(nx):
            x1, x2 = bounds(i, nx, frequencies[0])
            west, east = keys[0][i]
            v1 = curve(numbers[west, low], numbers[west, high], y2 - y1, j - y1, smooth)
            v2 = curve(numbers[east, low], numbers[east, high], y2 - y1, j - y1, smooth)
            terrain[j, i] = curve(v1, v2, x2 - x1, i - x1, smooth)
    return terrain


def frequencies_of(k, frequency, size):
    """Return the intervals along x and y: no more than gaps between texels, and as long as they are wide."""
    most = max(size[0] - 1, 1), max(size[1] - 1, 1)
    along = min(frequency ** (k + 1), most[0])
    upright = floor(Fraction(along * most[1], most[0]) + Fraction(1, 2))
    return along, min(max(upright, 1), most[1])


def twin(
    size=(33, 33),
    frequency=4,
    octaves=2,
    persistence=0.2,
    smooth=True,
    independent=False,
    overflow="divide",
    layer=0,
):
    """Return the sum of layers, or one of them."""

    def at(k):
        seed = DRAWN + k * 2654435769 if independent else DRAWN
        drawn = partial(python_random, seed=seed)
        return one_layer(size, frequencies_of(k, frequency, size), drawn, smooth)

    if layer:
        return at(layer - 1)
    weights = [persistence ** (k + 1) for k in range(octaves)]
    total = sum(w * at(k) for k, w in enumerate(weights))
    if overflow == "divide":
        return total / sum(weights)
    return np.minimum(total, 1) if overflow == "clamp" else np.where(total > 1, np.mod(total, 1), total)


@pytest.fixture
def sketch_of(single):
    return partial(single, "generation/layered_noise", seed=SEED)


def raw(engine, sketch, apart=1e-6):
    """Return the sum by the plain kernel, which the fast variant must be within ``apart`` of."""
    result = engine.read(sketch.plainly(), "terrain.sum")
    np.testing.assert_allclose(engine.read(sketch, "terrain.sum"), result, atol=apart)
    return result


@BOTH_TEXTS
@pytest.mark.parametrize(
    "size",
    [*((n, n) for n in (1, 2, 7, 32, 33, 65)), (40, 23), (23, 40), (1, 9), (9, 1), (2, 300)],
    ids=str,
)
@pytest.mark.parametrize("interpolation", ["linear", "smooth"])
def test_it_is_the_thesis_terrain(engine, sketch_of, size, interpolation):
    result = raw(engine, sketch_of(size, interpolation=interpolation))
    np.testing.assert_allclose(result, twin(size, smooth=interpolation == "smooth"), atol=1e-6)


@BOTH_TEXTS
@pytest.mark.parametrize("frequency", [1, 2, 3, 5, 31, 32, 33, 1000])
@pytest.mark.parametrize("octaves", [1, 3])
def test_every_frequency_even_above_the_size(engine, sketch_of, frequency, octaves):
    values = {"frequency": frequency, "octaves": octaves, "persistence": 0.5}
    result = raw(engine, sketch_of(**values))
    np.testing.assert_allclose(result, twin(**values), atol=1e-6)
    assert result.min() >= 0 and result.max() <= 1 and result.std() > 0.01


def test_a_large_terrain_at_places_of_its_own(any_engine, sketch_of):
    """All layers at 1025², each place by itself: bands are worked out, and laid, for the whole."""
    values = {"frequency": 4, "octaves": 5, "persistence": 0.6}
    result = raw(any_engine, sketch_of((1025, 1025), **values))
    drawn = np.random.default_rng(0)
    for x, y in drawn.integers(0, 1025, (200, 2)).tolist():
        total, weights = 0.0, 0.0
        for k in range(5):
            frequency = min(4 ** (k + 1), 1024)
            (x1, x2), (y1, y2) = bounds(x, 1025, frequency), bounds(y, 1025, frequency)
            (west, east), (low, high) = read_at(x, 1025, frequency), read_at(y, 1025, frequency)
            corners = python_random(np.array([west, east] * 2), np.array([low, low, high, high]), DRAWN)
            south = curve(corners[0], corners[1], x2 - x1, x - x1, True)
            north = curve(corners[2], corners[3], x2 - x1, x - x1, True)
            total += 0.6 ** (k + 1) * curve(south, north, y2 - y1, y - y1, True)
            weights += 0.6 ** (k + 1)
        assert abs(result[y, x] - total / weights) < 1e-6, (x, y)


def test_there_is_room_for_every_band():
    """The pass with the bands has as many rows as there are rows that begin one, or the terrain's own."""
    variants = read_technique("generation/layered_noise/sum", GLSL, GLSL).variants
    (fast,) = (variant for variant in variants if variant.kind == "passes")
    graph = fast.technique
    spec = next(p for p in graph.passes if p.name == "bands")
    text = ", ".join(map(str, spec.size)) if isinstance(spec.size, tuple) else str(spec.size)
    drawn = np.random.default_rng(1)
    for _ in range(2000):
        size = [int(2 ** drawn.uniform(0, 14)) for _ in range(2)]
        size = size if drawn.random() < 0.5 else [size[0]] * 2
        tiles = int(drawn.choice([1, 1, 2, 3, 8, 64]))
        frequency = int(drawn.choice([1, 2, 3, 4, 5, 8, 25, 33, 60, 70, 500, 1024]))
        octaves, layer = int(drawn.integers(0, 9)), int(drawn.choice([0, 0, 0, 1, 3, 8]))
        bands, whole = 1, 1
        for k in range(layer or octaves):
            whole = min(whole * frequency, max((size[0] - 1) * tiles, 1))
            part = max((whole + tiles // 2) // tiles, 1)
            up = floor(Fraction(part * max(size[1] - 1, 1), max(size[0] - 1, 1)) + Fraction(1, 2))
            if not layer or k == layer - 1:
                bands += min(max(up, 1), max(size[1] - 1, 1)) - 1
        names = {"size.x": size[0], "size.y": size[1], "tiles": tiles}
        names |= {"frequency": frequency, "octaves": octaves, "layer": layer}
        room = evaluate_pair(text, names)[1]
        assert min(bands, size[1]) <= room <= size[1], (size, tiles, frequency, octaves, layer)


@BOTH_TEXTS
def test_coarse_layers_left_out(engine, sketch_of):
    values = {"frequency": 3, "octaves": 3, "persistence": 0.5}
    sketch = sketch_of(40, **values).with_values({"terrain.sum.left_out": 1})
    layers = [raw(engine, sketch_of(40, layer=k, **values)).astype(np.float64) for k in (2, 3)]
    truth = (0.25 * layers[0] + 0.125 * layers[1]) / 0.375
    np.testing.assert_allclose(raw(engine, sketch), truth, atol=1e-6)
    np.testing.assert_array_equal(raw(engine, sketch.with_values({"terrain.sum.left_out": 8})), 0)


@BOTH_TEXTS
@pytest.mark.parametrize("random_layers", ["one", "independent"])
@pytest.mark.parametrize("layer", [0, 1, 2, 3])
def test_single_layers_and_independent_ones(engine, sketch_of, random_layers, layer):
    values = {"layer": layer, "frequency": 3, "octaves": 3 if layer == 0 else 2, "persistence": 0.6}
    truth = twin(independent=random_layers == "independent", **values)
    np.testing.assert_allclose(
        raw(engine, sketch_of(random_layers=random_layers, **values)), truth, atol=1e-6
    )


@BOTH_TEXTS
@pytest.mark.parametrize("overflow", ["divide", "clamp", "wrap"])
def test_what_exceeds_1(engine, sketch_of, overflow):
    """Figure 1.34's weights, 0.9 and 0.81."""
    values = {"persistence": 0.9, "overflow": overflow}
    truth = twin(**values)
    result = raw(engine, sketch_of(**values), apart=2e-6)
    apart = np.abs(result - truth)
    # A sum within rounding of 1 may fall on either side of the wrap.
    np.testing.assert_array_less(np.minimum(apart, 1 - apart) if overflow == "wrap" else apart, 2e-6)
    assert 0 <= result.min() and result.max() <= 1
    assert (twin(**values | {"overflow": "divide"}) * (0.9 + 0.81)).max() > 1, "nothing here exceeds 1"


# ── mixed with a shape ───────────────────────────────────────────────────────


@pytest.fixture
def mixed_of(make_sketch):
    def make(size=65, technique="mixed", seed=3, **values):
        noise = use(
            "generation/layered_noise", seed=seed, frequency=32, octaves=1, persistence=0.04, normalise="none"
        )
        text = passes(terrain=use(f"generation/{technique}", seed=seed, **values), noise=noise)
        return make_sketch(text, size=size)

    return make


@BOTH_TEXTS
@pytest.mark.parametrize("shape_range", ["none", "max", "minmax"])
@pytest.mark.parametrize(
    ("octaves", "persistence"), [(1, 0.04), (3, 0.3), (8, 0.9), (8, 1.0), (0, 0.5), (2, 0.0)]
)
def test_it_is_the_weighted_mean_of_shape_and_layers(engine, mixed_of, shape_range, octaves, persistence):
    sketch = mixed_of(frequency=4, octaves=octaves, persistence=persistence, shape_range=shape_range)
    shape = engine.read(sketch, "terrain.shape.raw").astype(np.float64)
    if shape_range == "max":
        shape = shape / shape.max()
    elif shape_range == "minmax":
        shape = np.interp(shape, [shape.min(), shape.max()], [0, 1])
    total, weights = shape, 1.0
    for k in range(octaves):
        layer = engine.read(sketch.with_values({"terrain.detail.layer": k + 1}), "terrain.detail")
        total = total + layer.astype(np.float64) * persistence ** (k + 1)
        weights += persistence ** (k + 1)
    np.testing.assert_allclose(engine.read(sketch, "terrain.mix"), total / weights, atol=2e-6)


@BOTH_TEXTS
def test_its_parts_are_diamond_square_and_layered_noise(engine, mixed_of, single):
    sketch = mixed_of()
    np.testing.assert_array_equal(engine.read(sketch, "terrain.detail"), engine.read(sketch, "noise"))
    alone = single("generation/diamond_square", 65, seed=3, normalise="max")
    np.testing.assert_array_equal(engine.read(sketch, "terrain.shape"), engine.read(alone, "terrain"))


@pytest.mark.parametrize("technique", ["mixed", "mixed_tiled"])
def test_its_shape_is_the_technique_with_its_fast_form(compute, any_engine, mixed_of, technique):
    """Where there is compute, diamond-square's own passes do not run: its one compute shader does."""
    any_engine.texture(mixed_of(technique=technique), "terrain")
    ran = any_engine.record.ran
    assert "terrain.shape" in ran and not [name for name in ran if name.startswith("terrain.shape.")], ran


def summits(terrain):
    """Count the texels that are higher than the eight around them."""
    around = np.ones((3, 3), bool)
    around[1, 1] = False
    highest = maximum_filter(terrain, footprint=around, mode="constant", cval=-np.inf)
    return int((terrain > highest)[1:-1, 1:-1].sum())


@pytest.mark.parametrize("technique", ["mixed", "mixed_tiled"])
def test_the_smoothing_counts(any_engine, mixed_of, technique):
    """A smoother shape is a flatter one, of which the same details take more summits away."""
    terrains = [
        any_engine.read(mixed_of(257, technique, smoothing=s), "terrain").astype(float) for s in (0.1, 0.5)
    ]
    assert np.abs(terrains[0] - terrains[1]).max() > 0.05
    assert summits(terrains[0]) < 0.9 * summits(terrains[1])


# ── tiled: a tile that knows nothing of its neighbours, its seams repaired layer by layer ──


@pytest.fixture
def tiled_of(single):
    def make(technique, size, seed=5, **values):
        return single(f"generation/{technique}", size, seed=seed, **values)

    return make


def bent(a):
    return a * a * (3 - 2 * a)


def weights_on_nodes(side, intervals, tiles):
    """Return (numbers, matrix): what each node reads, and counts for at each place along one side."""
    nodes = [q * side // intervals for q in range(intervals)] + [side - 1]
    numbers = [q * RANDOM_SIDE // (intervals * tiles) for q in range(intervals + 1)]
    matrix = np.zeros((side, intervals + 1))
    for index in range(side):
        q = index * intervals // side
        a = bent((index - nodes[q]) / max(nodes[q + 1] - nodes[q], 1))
        matrix[index, q] += 1 - a
        matrix[index, q + 1] += a
    return np.array(numbers), matrix


def drawn_anew(layer, intervals):
    """Mend the eastern seam of a layer: from its last column of nodes to the neighbour's first column."""
    side = layer.shape[1]
    start = (intervals - 1) * side // intervals
    part = bent((np.arange(start, side) - start) / (side - 1 - start))
    removed = layer.copy()
    removed[:, start:] = layer[:, [start]] * (1 - part) + layer[:, [0]] * part
    return removed


def tile_of(size, tiles, frequency, octaves, persistence, removed=True, left_out=0):
    """Return the sum of the layers on one part, divided by their weights."""
    width, height = (-(-(side - 1) // tiles) + 1 for side in size)
    total, weights = 0.0, 0.0
    for k in range(left_out, octaves):
        whole = min(frequency ** (k + 1), (width - 1) * tiles)
        x_intervals = max((whole + tiles // 2) // tiles, 1)
        y_intervals = max(round(x_intervals * (height - 1) / (width - 1)), 1)
        xs, across = weights_on_nodes(width, x_intervals, tiles)
        ys, up = weights_on_nodes(height, y_intervals, tiles)
        layer = up @ python_random(*np.meshgrid(xs, ys), 5 + salt("generation/layered_noise")) @ across.T
        if removed and tiles > 1:
            layer = drawn_anew(drawn_anew(layer, x_intervals).T, y_intervals).T
        total = total + persistence ** (k + 1) * layer
        weights += persistence ** (k + 1)
    return total / weights


def laid(tile, size, tiles):
    """Lay a tile on every part: later parts cover what they share with those before."""
    terrain = np.full(size[::-1], np.nan)
    height, width = (side - 1 for side in tile.shape)
    for j in range(tiles):
        for i in range(tiles):
            position = terrain[j * height : (j + 1) * height + 1, i * width : (i + 1) * width + 1]
            position[:] = tile[: position.shape[0], : position.shape[1]]
    return terrain


@pytest.mark.parametrize("seams", ["removed", "left"])
@pytest.mark.parametrize(
    ("size", "tiles", "frequency", "octaves"),
    [(65, 2, 16, 1), (129, 4, 8, 2), (129, 8, 32, 1), (65, 4, 4, 3), (33, 8, 8, 1), (65, 1, 8, 2)],
    ids=str,
)
def test_the_mixed_model_is_shape_and_tile(engine, tiled_of, size, tiles, frequency, octaves, seams):
    values = {"tiles": tiles, "frequency": frequency, "octaves": octaves, "persistence": 0.3}
    sketch = tiled_of("mixed_tiled", size, seams=seams, **values)
    tile = tile_of((size, size), tiles, frequency, octaves, 0.3, seams == "removed")
    weights = sum(0.3 ** (k + 1) for k in range(octaves))
    shape = engine.read(sketch, "terrain.shape").astype(np.float64)
    truth = (laid(tile, (size, size), tiles) * weights + shape) / (weights + 1)
    np.testing.assert_allclose(engine.read(sketch, "terrain.mix"), truth, atol=2e-6)
    result = engine.read(sketch, "terrain")
    assert result.min() == 0 and result.max() == 1


@pytest.mark.parametrize("seams", ["removed", "left"])
@pytest.mark.parametrize(
    ("size", "tiles", "frequency", "octaves"),
    [
        ((65, 65), 2, 4, 2),
        ((129, 129), 4, 4, 3),
        ((100, 100), 3, 4, 2),
        ((129, 65), 4, 8, 2),
        ((60, 97), 5, 6, 2),
        ((129, 129), 8, 16, 2),
    ],
    ids=str,
)
def test_layered_noise_is_its_first_layer_and_tile(engine, tiled_of, size, tiles, frequency, octaves, seams):
    values = {"tiles": tiles, "frequency": frequency, "octaves": octaves, "persistence": 0.4}
    sketch = tiled_of("layered_noise_tiled", size, seams=seams, **values)
    tile = tile_of(size, tiles, frequency, octaves, 0.4, seams == "removed", left_out=1)
    weights = [0.4 ** (k + 1) for k in range(octaves)]
    shape = tile_of(size, 1, frequency, 1, 0.4)
    truth = (laid(tile, size, tiles) * sum(weights[1:]) + shape * weights[0]) / sum(weights)
    np.testing.assert_allclose(engine.read(sketch, "terrain.mix"), truth, atol=2e-6)


def test_one_tile_is_the_terrain_without_tiles(engine, tiled_of):
    tiled = engine.read(tiled_of("mixed_tiled", 65, tiles=1), "terrain")
    np.testing.assert_array_equal(tiled, engine.read(tiled_of("mixed", 65), "terrain"))
    tiled = engine.read(tiled_of("layered_noise_tiled", 80, tiles=1, octaves=3), "terrain.mix")
    whole = engine.read(tiled_of("layered_noise", 80, octaves=3), "terrain.sum")
    np.testing.assert_allclose(tiled, whole, atol=5e-7)


def test_last_tile_is_cropped_if_parts_do_not_divide_terrain(any_engine, tiled_of):
    result = any_engine.read(tiled_of("layered_noise_tiled", 100, tiles=4, normalise="none"), "terrain.tile")
    assert result.shape == (26, 26)  # four parts of 25 texels are 100 wide: one more than there are gaps


# ── seams ────────────────────────────────────────────────────────────────────


def breaks(terrain, columns):
    """Return how far terrain jumps to the given columns, and how much its slope changes there."""
    jump = np.abs(terrain[:, columns] - terrain[:, columns - 1])
    bend = np.abs(terrain[:, columns + 1] - 2 * terrain[:, columns] + terrain[:, columns - 1])
    return np.array([jump.mean(), bend.mean()])


def seam_breaks(engine, tiled_of, size, tiles, seams, **values):
    """Return what stands at the seams of the details alone, over what stands there without tiles."""
    columns = np.arange(1, tiles) * ((size - 1) // tiles)
    result = {}
    for count in (tiles, 1):
        each = []
        for seed in range(16):
            sketch = tiled_of("mixed_tiled", size, tiles=count, seams=seams, seed=seed, **values)
            tile = engine.read(sketch, "terrain.tile").astype(np.float64)
            detail = laid(tile, (size, size), count)
            each += [breaks(detail, columns), breaks(detail.T, columns)]
        result[count] = np.mean(each, axis=0)
    return result[tiles] / result[1]


@pytest.mark.parametrize(("tiles", "frequency", "octaves"), [(2, 32, 1), (4, 32, 1), (8, 32, 1), (4, 8, 2)])
def test_a_removed_seam_is_like_any_other_row_of_nodes(any_engine, tiled_of, tiles, frequency, octaves):
    values = {"frequency": frequency, "octaves": octaves, "persistence": 0.2}
    ratios = seam_breaks(any_engine, tiled_of, 257, tiles, "removed", **values)
    assert (ratios <= 1.1).all(), ratios


# ── what a tile saves, and what it costs ─────────────────────────────────────


@pytest.mark.parametrize("use", ["mixed_tiled", "layered_noise_tiled"])
def test_a_tile_has_a_share_of_the_interpolations(any_engine, tiled_of, use):
    """Interpolations are counted as texels of the pass that makes the tile."""
    texels = {}
    for tiles in (1, 2, 4, 8, 16):
        plan = any_engine.plan(tiled_of(use, 1025, tiles=tiles), (64, 64))
        makes_it = "terrain.tile" if any_engine.info.compute else "terrain.tile.fast.along"
        width, height = plan.node(makes_it).size
        texels[tiles] = width * height
    for tiles, count in texels.items():
        # The row of texels that a part shares with its neighbour is counted as well.
        assert texels[1] <= count * tiles**2 < texels[1] * (1 + tiles / 1024) ** 2


def bands(terrain):
    """Return the mean power in octaves of frequency, from 1 to 2 cycles a side up."""
    n = len(terrain)
    window = np.hanning(n)
    spectrum = np.abs(np.fft.fft2((terrain - terrain.mean()) * np.outer(window, window))) ** 2
    radius = np.hypot(*np.meshgrid(np.fft.fftfreq(n, 1 / n), np.fft.fftfreq(n, 1 / n)))
    return np.array([spectrum[(radius >= 2**k) & (radius < 2 ** (k + 1))].mean() for k in range(8)])


@pytest.mark.parametrize(("tiles", "most"), [(2, 2.0), (4, 2.0), (8, 3.0)])
def test_the_spectrum_from_16_cycles_up_is_that_without_tiles(any_engine, tiled_of, tiles, most):
    """With three layers: of the two finer ones, the coarser has at least two intervals a part."""
    powers = {}
    for count in (tiles, 1):
        sketches = [
            tiled_of("layered_noise_tiled", 513, tiles=count, octaves=3, seed=seed) for seed in range(8)
        ]
        powers[count] = np.mean([bands(any_engine.read(s, "terrain.mix")) for s in sketches], axis=0)
    apart = 10 * np.log10(powers[tiles] / powers[1])
    assert np.abs(apart[4:]).max() <= most, apart


def test_the_tile_shows_in_the_curvature(any_engine, tiled_of):
    """What a tile cannot hide: the terrain's curvature repeats a part further on."""

    def repeats(tiles):
        sketch = tiled_of("layered_noise_tiled", 257, tiles=tiles, octaves=3)
        terrain = any_engine.read(sketch, "terrain.mix").astype(np.float64)
        curvature = np.diff(terrain, 2, axis=0)[:, 1:-1] + np.diff(terrain, 2, axis=1)[1:-1]
        return np.corrcoef(curvature[:, :-64].ravel(), curvature[:, 64:].ravel())[0, 1]

    assert repeats(4) > 0.9
    assert abs(repeats(1)) < 0.2


@pytest.mark.parametrize(
    ("use", "size", "values"),
    [
        ("mixed_tiled", 257, {"frequency": 32, "tiles": 32}),
        ("mixed_tiled", 257, {"frequency": 23, "tiles": 16}),
        ("mixed_tiled", 257, {"frequency": 24, "tiles": 16}),
        ("mixed_tiled", 257, {"frequency": 8, "tiles": 8, "seams": "left"}),
        ("layered_noise_tiled", [129, 65], {"frequency": 2, "tiles": 4}),
        ("layered_noise_tiled", 129, {"frequency": 4, "tiles": 4}),
        ("layered_noise_tiled", 129, {"frequency": 8, "tiles": 2, "octaves": 1}),
    ],
    ids=str,
)
def test_a_tile_without_detail_is_warned_of(any_engine, tiled_of, use, size, values):
    """Whether a tile has detail is seen in the tile itself."""
    warned = []
    any_engine.warnings.report = lambda result: warned.append(result.message)
    sketch = tiled_of(use, size, **values)
    tile = any_engine.read(sketch, "terrain.tile").astype(np.float64)
    any_engine.read(sketch, "terrain")
    messages = [message for message in warned if re.search("adds no detail|has any detail", message)]
    assert bool(messages) == (np.ptp(tile) < 1e-6)
    assert len(warned) <= 1


# ── the product of two terrains ──────────────────────────────────────────────

UNIFORMS = ("float scale = 1.0", "float base = 0.0", "uint seed = 3u")
TERRAIN = kernel("base + scale * random(texel, seed)", "height:r32f", *(f"uniform {u};" for u in UNIFORMS))
INSIDE = [(1.0, 0.0), (0.5, 0.25), (0.0, 0.5), (0.0, 1.0)]
OUTSIDE = [(2.0, -1.0), (3.0, 0.0), (0.5, 0.75), (0.5, -0.1), (0.0, 2.0), (0.0, -1.0)]
PRODUCT = {"first": "a", "second": "b"}


def factor(terrain):
    """Return a terrain as it is where it lies in 0..1, else from lowest to highest."""
    terrain = terrain.astype(np.float64)
    low, high = terrain.min(), terrain.max()
    if 0 <= low and high <= 1:
        return terrain
    return (terrain - low) / (high - low) if high > low else np.zeros_like(terrain)


@pytest.mark.parametrize("first", INSIDE + OUTSIDE, ids=str)
@pytest.mark.parametrize("second", [INSIDE[1], OUTSIDE[0]], ids=str)
@pytest.mark.parametrize("size", [(33, 20), (1, 1), (2, 2)], ids=str)
def test_it_is_the_product(engine, make_sketch, first, second, size):
    factors = {
        name: use("./terrain", seed=k + 1, scale=scale, base=base)
        for k, (name, (scale, base)) in enumerate({"a": first, "b": second}.items())
    }
    product = use("generation/multiply", inputs=PRODUCT, normalise="none")
    sketch = make_sketch(passes(**factors, terrain=product), size=size, terrain=TERRAIN)
    truth = factor(engine.read(sketch, "a")) * factor(engine.read(sketch, "b"))
    np.testing.assert_allclose(engine.read(sketch, "terrain"), truth, atol=1e-6)


def roughness(terrain):
    """Return the mean slope of the lowest quarter of a terrain over that of its highest."""
    slope = np.hypot(*np.gradient(terrain.astype(np.float64)))
    low, high = np.quantile(terrain, [0.25, 0.75])
    return slope[terrain <= low].mean() / slope[terrain >= high].mean()


@pytest.mark.slow
def test_valleys_become_smoother_than_ridges(any_engine, make_sketch):
    for seed in range(20):
        factors = {
            name: use("generation/diamond_square", seed=2 * seed + k, smoothing=0.5)
            for k, name in enumerate("ab")
        }
        text = passes(**factors, terrain=use("generation/multiply", inputs=PRODUCT))
        sketch = make_sketch(text, size=129)
        product = roughness(any_engine.read(sketch, "terrain"))
        factors = [roughness(any_engine.read(sketch, name)) for name in ("a", "b")]
        assert product < min(factors), (seed, product, factors)
