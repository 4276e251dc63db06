"""One tile of details on every part of a terrain, its seams removed layer by layer, against NumPy.

The truth makes a tile that knows nothing of its neighbours, and mends it afterwards: the
layer's last interval before a seam is drawn again, from its first column to the neighbour's.
"""

import re

import numpy as np
import pytest

from .drawing import salt

SEED = 5
RANDOM_SIDE = 2**15  # numbers a side of the layer that all nodes read


@pytest.fixture
def sketch_of(make_sketch):
    def make(use, size, **values):
        text = "".join(f"{k} = {v!r}\n" for k, v in ({"seed": SEED} | values).items())
        head = f'[[pass]]\nname = "terrain"\nuse = "generation/{use}"\n[pass.set]\n{text}'
        return make_sketch(head, size=size if isinstance(size, int) else list(size))

    return make


def curve(a):
    return a * a * (3 - 2 * a)


def weights_on_nodes(side, intervals, tiles):
    """Return (numbers, matrix): what each node reads, and counts for at each place along one side."""
    nodes = [q * side // intervals for q in range(intervals)] + [side - 1]
    numbers = [q * RANDOM_SIDE // (intervals * tiles) for q in range(intervals + 1)]
    matrix = np.zeros((side, intervals + 1))
    for index in range(side):
        q = index * intervals // side
        a = curve((index - nodes[q]) / max(nodes[q + 1] - nodes[q], 1))
        matrix[index, q] += 1 - a
        matrix[index, q + 1] += a
    return np.array(numbers), matrix


def drawn_anew(layer, intervals):
    """Mend the eastern seam of a layer: from its last column of nodes to the neighbour's first column."""
    side = layer.shape[1]
    start = (intervals - 1) * side // intervals
    part = curve((np.arange(start, side) - start) / (side - 1 - start))
    removed = layer.copy()
    removed[:, start:] = layer[:, [start]] * (1 - part) + layer[:, [0]] * part
    return removed


@pytest.fixture
def tile_of(python_random):
    def make(size, tiles, frequency, octaves, persistence, removed=True, left_out=0):
        """Return the sum of the layers on one part, divided by their weights."""
        width, height = (-(-(side - 1) // tiles) + 1 for side in size)
        total, weights = 0.0, 0.0
        for k in range(left_out, octaves):
            whole = min(frequency ** (k + 1), (width - 1) * tiles)
            x_intervals = max((whole + tiles // 2) // tiles, 1)
            y_intervals = max(round(x_intervals * (height - 1) / (width - 1)), 1)
            xs, across = weights_on_nodes(width, x_intervals, tiles)
            ys, up = weights_on_nodes(height, y_intervals, tiles)
            layer = (
                up @ python_random(*np.meshgrid(xs, ys), SEED + salt("generation/layered_noise")) @ across.T
            )
            if removed and tiles > 1:
                layer = drawn_anew(drawn_anew(layer, x_intervals).T, y_intervals).T
            total = total + persistence ** (k + 1) * layer
            weights += persistence ** (k + 1)
        return total / weights

    return make


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
def test_the_mixed_model_is_shape_and_tile(
    engine, sketch_of, tile_of, size, tiles, frequency, octaves, seams
):
    values = {"tiles": tiles, "frequency": frequency, "octaves": octaves, "persistence": 0.3}
    sketch = sketch_of("mixed_tiled", size, seams=seams, **values)
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
def test_layered_noise_is_its_first_layer_and_tile(
    engine, sketch_of, tile_of, size, tiles, frequency, octaves, seams
):
    values = {"tiles": tiles, "frequency": frequency, "octaves": octaves, "persistence": 0.4}
    sketch = sketch_of("layered_noise_tiled", size, seams=seams, **values)
    tile = tile_of(size, tiles, frequency, octaves, 0.4, seams == "removed", left_out=1)
    weights = [0.4 ** (k + 1) for k in range(octaves)]
    shape = tile_of(size, 1, frequency, 1, 0.4)
    truth = (laid(tile, size, tiles) * sum(weights[1:]) + shape * weights[0]) / sum(weights)
    np.testing.assert_allclose(engine.read(sketch, "terrain.mix"), truth, atol=2e-6)


def test_one_tile_is_the_terrain_without_tiles(engine, sketch_of):
    tiled = engine.read(sketch_of("mixed_tiled", 65, tiles=1), "terrain")
    np.testing.assert_array_equal(tiled, engine.read(sketch_of("mixed", 65), "terrain"))
    tiled = engine.read(sketch_of("layered_noise_tiled", 80, tiles=1, octaves=3), "terrain.mix")
    whole = engine.read(sketch_of("layered_noise", 80, octaves=3), "terrain.sum")
    np.testing.assert_allclose(tiled, whole, atol=5e-7)


@pytest.mark.parametrize("use", ["mixed_tiled", "layered_noise_tiled"])
def test_more_tiles_than_texels_and_no_layers_are_numbers(engine, sketch_of, use):
    for values in ({"tiles": 64}, {"octaves": 0}, {"persistence": 0.0}, {"tiles": 64, "octaves": 8}):
        for size in (3, 5, 33):
            assert np.isfinite(engine.read(sketch_of(use, size, **values), "terrain")).all()


def test_last_tile_is_cropped_if_parts_do_not_divide_terrain(any_engine, sketch_of):
    result = any_engine.read(sketch_of("layered_noise_tiled", 100, tiles=4, normalise="none"), "terrain.tile")
    assert result.shape == (26, 26)  # four parts of 25 texels are 100 wide: one more than there are gaps


# ── seams ────────────────────────────────────────────────────────────────────


def breaks(terrain, columns):
    """Return how far terrain jumps to the given columns, and how much its slope changes there."""
    jump = np.abs(terrain[:, columns] - terrain[:, columns - 1])
    bend = np.abs(terrain[:, columns + 1] - 2 * terrain[:, columns] + terrain[:, columns - 1])
    return np.array([jump.mean(), bend.mean()])


def seam_breaks(engine, sketch_of, size, tiles, seams, **values):
    """Return what stands at the seams of the details alone, over what stands there without tiles."""
    columns = np.arange(1, tiles) * ((size - 1) // tiles)
    result = {}
    for count in (tiles, 1):
        each = []
        for seed in range(16):
            sketch = sketch_of("mixed_tiled", size, tiles=count, seams=seams, seed=seed, **values)
            tile = engine.read(sketch, "terrain.tile").astype(np.float64)
            detail = laid(tile, (size, size), count)
            each += [breaks(detail, columns), breaks(detail.T, columns)]
        result[count] = np.mean(each, axis=0)
    return result[tiles] / result[1]


@pytest.mark.parametrize(("tiles", "frequency", "octaves"), [(2, 32, 1), (4, 32, 1), (8, 32, 1), (4, 8, 2)])
def test_a_removed_seam_is_like_any_other_row_of_nodes(any_engine, sketch_of, tiles, frequency, octaves):
    values = {"frequency": frequency, "octaves": octaves, "persistence": 0.2}
    ratios = seam_breaks(any_engine, sketch_of, 257, tiles, "removed", **values)
    assert (ratios <= 1.1).all(), ratios


def test_where_seams_are_left_the_terrain_tears(any_engine, sketch_of):
    jump, _ = seam_breaks(any_engine, sketch_of, 257, 4, "left", frequency=32, octaves=1)
    assert 20 < jump < 200, jump


# ── what a tile saves, and what it costs ─────────────────────────────────────


@pytest.mark.parametrize("use", ["mixed_tiled", "layered_noise_tiled"])
def test_a_tile_has_a_share_of_the_interpolations(any_engine, sketch_of, use):
    """Interpolations are counted as texels of the pass that makes the tile."""
    texels = {}
    for tiles in (1, 2, 4, 8, 16):
        plan = any_engine.plan(sketch_of(use, 1025, tiles=tiles), (64, 64))
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
def test_the_spectrum_from_16_cycles_up_is_that_without_tiles(any_engine, sketch_of, tiles, most):
    """With three layers: of the two finer ones, the coarser has at least two intervals a part."""
    powers = {}
    for count in (tiles, 1):
        sketches = [
            sketch_of("layered_noise_tiled", 513, tiles=count, octaves=3, seed=seed) for seed in range(8)
        ]
        powers[count] = np.mean([bands(any_engine.read(s, "terrain.mix")) for s in sketches], axis=0)
    apart = 10 * np.log10(powers[tiles] / powers[1])
    assert np.abs(apart[4:]).max() <= most, apart


def test_the_tile_shows_in_the_curvature(any_engine, sketch_of):
    """What a tile cannot hide: the terrain's curvature repeats a part further on."""

    def repeats(tiles):
        sketch = sketch_of("layered_noise_tiled", 257, tiles=tiles, octaves=3)
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
def test_a_tile_without_detail_is_warned_of(any_engine, sketch_of, use, size, values):
    """Whether a tile has detail is seen in the tile itself."""
    warned = []
    any_engine.warnings.report = lambda result: warned.append(result.message)
    sketch = sketch_of(use, size, **values)
    tile = any_engine.read(sketch, "terrain.tile").astype(np.float64)
    any_engine.read(sketch, "terrain")
    messages = [message for message in warned if re.search("adds no detail|has any detail", message)]
    assert bool(messages) == (np.ptp(tile) < 1e-6)
    assert len(warned) <= 1
