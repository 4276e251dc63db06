"""Layered noise against a twin in Python: the thesis's loops, with exact fractions for its nodes."""

from fractions import Fraction
from math import floor

import numpy as np
import pytest

from playground.paths import GLSL
from playground.shader.expressions import evaluate_pair
from playground.sketch.techniques import read_technique

from .drawing import salt

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


@pytest.fixture
def twin(python_random):
    def make(
        size=(33, 33),
        frequency=4,
        octaves=2,
        persistence=0.2,
        smooth=True,
        independent=False,
        overflow="divide",
        layer=0,
    ):
        def at(k):
            seed = DRAWN + k * 2654435769 if independent else DRAWN
            return one_layer(
                size, frequencies_of(k, frequency, size), lambda x, y: python_random(x, y, seed), smooth
            )

        if layer:
            return at(layer - 1)
        weights = [persistence ** (k + 1) for k in range(octaves)]
        if sum(weights) == 0:
            return np.zeros(size[::-1])
        total = sum(w * at(k) for k, w in enumerate(weights))
        if overflow == "divide":
            return total / sum(weights)
        return np.minimum(total, 1) if overflow == "clamp" else np.where(total > 1, np.mod(total, 1), total)

    return make


@pytest.fixture
def sketch_of(make_sketch):
    def make(size=(33, 33), **values):
        text = "".join(f"{k} = {v!r}\n" for k, v in values.items())
        use = '[[pass]]\nname = "terrain"\nuse = "generation/layered_noise"\n'
        use += f"[pass.set]\nseed = {SEED}\n{text}"
        return make_sketch(use, size=list(size))

    return make


def raw(engine, sketch, apart=1e-6):
    """Return the sum by the plain kernel, which the fast variant must be within ``apart`` of."""
    result = engine.read(sketch.plainly(), "terrain.sum")
    np.testing.assert_allclose(engine.read(sketch, "terrain.sum"), result, atol=apart)
    return result


@pytest.mark.parametrize("size", [(33, 33), (32, 32), (65, 65), (7, 7), (40, 23), (23, 40)], ids=str)
@pytest.mark.parametrize("interpolation", ["linear", "smooth"])
def test_it_is_the_thesis_terrain(engine, sketch_of, twin, size, interpolation):
    result = raw(engine, sketch_of(size, interpolation=interpolation))
    np.testing.assert_allclose(result, twin(size, smooth=interpolation == "smooth"), atol=1e-6)


@pytest.mark.parametrize("frequency", [1, 2, 3, 5, 31, 32, 33, 1000])
@pytest.mark.parametrize("octaves", [1, 3])
def test_every_frequency_even_above_the_size(engine, sketch_of, twin, frequency, octaves):
    result = raw(engine, sketch_of(frequency=frequency, octaves=octaves, persistence=0.5))
    np.testing.assert_allclose(result, twin(frequency=frequency, octaves=octaves, persistence=0.5), atol=1e-6)
    assert result.min() >= 0 and result.max() <= 1 and result.std() > 0.01


@pytest.mark.parametrize("size", [(9, 120), (120, 9), (3, 70), (40, 83)], ids=str)
@pytest.mark.parametrize("frequency", [1, 4])
def test_terrains_that_are_not_square(engine, sketch_of, twin, size, frequency):
    values = {"frequency": frequency, "octaves": 4, "persistence": 0.7}
    np.testing.assert_allclose(raw(engine, sketch_of(size, **values)), twin(size, **values), atol=2e-6)


def test_a_large_terrain_at_places_of_its_own(any_engine, sketch_of, python_random):
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


def test_coarse_layers_left_out(engine, sketch_of):
    values = {"frequency": 3, "octaves": 3, "persistence": 0.5}
    sketch = sketch_of((40, 40), **values).with_values({"terrain.sum.left_out": 1})
    layers = [raw(engine, sketch_of((40, 40), layer=k, **values)).astype(np.float64) for k in (2, 3)]
    truth = (0.25 * layers[0] + 0.125 * layers[1]) / 0.375
    np.testing.assert_allclose(raw(engine, sketch), truth, atol=1e-6)
    nothing = sketch.with_values({"terrain.sum.left_out": 8})
    np.testing.assert_array_equal(raw(engine, nothing), 0)


def test_lattice_at_texel_spacing_gives_each_texel_own_number(engine, sketch_of, python_random):
    result = raw(engine, sketch_of(frequency=32, octaves=1))
    y, x = np.mgrid[0:33, 0:33] * (RANDOM_SIDE // 32)
    np.testing.assert_allclose(result, python_random(x, y, DRAWN), atol=4e-7)


@pytest.mark.parametrize("random_layers", ["one", "independent"])
@pytest.mark.parametrize("layer", [1, 2, 3])
def test_single_layers(engine, sketch_of, twin, random_layers, layer):
    values = {"random_layers": random_layers, "layer": layer, "frequency": 3, "octaves": 2}
    truth = twin(frequency=3, layer=layer, independent=random_layers == "independent")
    np.testing.assert_allclose(raw(engine, sketch_of(**values)), truth, atol=1e-6)


def test_independent_layers_add_up(engine, sketch_of, twin):
    values = {"octaves": 3, "persistence": 0.6, "frequency": 3}
    result = raw(engine, sketch_of(random_layers="independent", **values))
    np.testing.assert_allclose(result, twin(independent=True, **values), atol=1e-6)


@pytest.mark.parametrize("overflow", ["divide", "clamp", "wrap"])
def test_what_exceeds_1(engine, sketch_of, twin, overflow):
    """Figure 1.34's weights, 0.9 and 0.81."""
    values = {"persistence": 0.9, "overflow": overflow}
    truth = twin(**values)
    result = raw(engine, sketch_of(**values), apart=2e-6)
    apart = np.abs(result - truth)
    # A sum within rounding of 1 may fall on either side of the wrap.
    np.testing.assert_array_less(np.minimum(apart, 1 - apart) if overflow == "wrap" else apart, 2e-6)
    assert 0 <= result.min() and result.max() <= 1
    assert (twin(**values | {"overflow": "divide"}) * (0.9 + 0.81)).max() > 1, "nothing here exceeds 1"


def test_wrapping_tears_and_dividing_does_not(any_engine, sketch_of):
    steps = {
        overflow: np.abs(
            np.diff(raw(any_engine, sketch_of((129, 129), persistence=0.9, overflow=overflow)))
        ).max()
        for overflow in ("divide", "clamp", "wrap")
    }
    assert steps["wrap"] > 0.8 and steps["divide"] < 0.2 and steps["clamp"] < 0.35


def test_nothing_to_add_is_flat_terrain(engine, sketch_of):
    for values in ({"octaves": 0}, {"persistence": 0.0}):
        for overflow in ("divide", "clamp", "wrap"):
            sketch = sketch_of(overflow=overflow, **values)
            for ref in ("terrain.sum", "terrain"):
                np.testing.assert_array_equal(engine.read(sketch, ref), 0)


@pytest.mark.parametrize("size", [(1, 1), (2, 2), (1, 9), (9, 1), (2, 300)], ids=str)
def test_tiny_terrains_are_numbers(engine, sketch_of, twin, size):
    np.testing.assert_allclose(raw(engine, sketch_of(size)), twin(size), atol=1e-6)
    assert np.isfinite(engine.read(sketch_of(size), "terrain")).all()


def test_extremes_of_every_slider_are_numbers(engine, sketch_of):
    for frequency in (1, 1024):
        for octaves in (1, 8):
            for persistence in (0.01, 1.0):
                terrain = engine.read(
                    sketch_of(frequency=frequency, octaves=octaves, persistence=persistence), "terrain"
                )
                assert np.isfinite(terrain).all() and terrain.min() == 0 and terrain.max() == 1


def test_the_smooth_curve_is_level_at_nodes(any_engine, sketch_of):
    terrain = raw(any_engine, sketch_of((257, 257), octaves=1, interpolation="smooth")).astype(np.float64)
    creases = raw(any_engine, sketch_of((257, 257), octaves=1, interpolation="linear")).astype(np.float64)
    node = 257 // 4
    assert (
        np.abs(terrain[:, node + 1] - terrain[:, node]).max() < 0.1 * np.abs(np.diff(terrain, axis=1)).max()
    )
    bend = np.abs(np.diff(creases, 2, axis=1)).max(axis=0)
    assert bend[node - 1] > 20 * bend[node // 2]


def test_it_is_normalised_by_default_and_not_where_that_is_off(engine, sketch_of):
    terrain = engine.read(sketch_of(), "terrain")
    assert terrain.min() == 0 and terrain.max() == 1
    sketch = sketch_of(normalise="none")
    np.testing.assert_array_equal(engine.read(sketch.plainly(), "terrain"), raw(engine, sketch))
    sketch = sketch_of(normalise="max")
    assert engine.read(sketch, "terrain").max() == 1 and engine.read(sketch, "terrain").min() > 0


def test_smaller_weights_make_smoother_terrain(any_engine, sketch_of):
    rough = [
        np.abs(np.diff(any_engine.read(sketch_of((129, 129), persistence=p, octaves=3), "terrain"))).mean()
        for p in (0.05, 0.2, 0.6)
    ]
    assert rough[0] < rough[1] < rough[2]
