"""The kernels of the lesson on ridges and warping: in float64, and equal to what they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from .drawing import salt
from .terrains import toml_value
from .test_gradient_noise import SHIFT, perlin

RIDGES, WARPING = "generation/gradient_noise/ridges", "generation/gradient_noise/warping"
SIZE, EXTENT = (65, 33), (1000.0, 500.0)
CELLS = 3.0


@pytest.fixture
def read(any_engine, make_sketch):
    """Give a texture of one pass, float64."""

    def of(use, output="", size=SIZE, extent=EXTENT, **values):
        value = "".join(f"{k} = {toml_value(v)}\n" for k, v in values.items())
        text = f'[[pass]]\nname = "a"\nuse = "{use}"\n[pass.set]\n{value}'
        sketch = make_sketch(text, size=list(size), extent=list(extent))
        return any_engine.read(sketch, f"a{output}").astype(np.float64)

    return of


def places():
    y, x = np.mgrid[0 : SIZE[1], 0 : SIZE[0]]
    return x * CELLS / (SIZE[0] - 1), y * CELLS / (SIZE[0] - 1)


def octave(x, y, k, more=0, seed=7):
    which = (seed + more + salt("generation/gradient_noise")) * 0x2545F491 + k * 0xC2B2AE3D
    return perlin(x * 2**k + SHIFT, y * 2**k, which)


def octaves(x, y, count, gain, more=0):
    return sum(gain**k * octave(x, y, k, more) for k in range(count))


@pytest.mark.parametrize(
    "fold, truth",
    [
        ("none", lambda noise: noise),
        ("valleys", lambda noise: np.maximum(noise, -noise)),
        ("ridges", lambda noise: np.minimum(1 - noise, 1 + noise)),
        ("sharp ridges", lambda noise: 1 - 2 * abs(noise) + noise**2),
    ],
)
def test_each_octave_is_folded_and_added(read, fold, truth):
    value = {"fold": fold, "weighed": False, "octaves": 3, "frequency": CELLS, "gain": 0.6}
    x, y = places()
    expected = sum(0.6**k * truth(octave(x, y, k)) for k in range(3))
    np.testing.assert_allclose(read(RIDGES, **value), expected, atol=2e-5)
    assert expected.std() > 0.1


def test_weighed_sharp_ridges_are_the_technique_s(read):
    """Four octaves of 3 cells on 65 texels: the last one's cells are wider than two texels."""
    value = {"octaves": 4, "frequency": CELLS, "gain": 0.45, "seed": 3}
    technique = read("generation/gradient_noise/sum", shape="ridged", **value)
    np.testing.assert_allclose(read(RIDGES, **value), technique, atol=1e-5)
    assert abs(read(RIDGES, weighed=False, **value) - technique).max() > 0.05


def test_warp_with_one_bend_per_octave_matches_technique(read):
    value = {"octaves": 4, "frequency": CELLS, "gain": 0.45, "warp": 0.7, "seed": 3}
    technique = read("generation/gradient_noise/sum", shape="warped", **value)
    np.testing.assert_allclose(read(WARPING, ":height", bends=4, **value), technique, atol=3e-5)
    assert abs(read(WARPING, ":height", bends=1, **value) - technique).max() > 0.05


@pytest.mark.parametrize("warp", [0.0, 0.3, 1.5])
def test_the_stretch_is_the_area_of_a_small_square_that_is_moved(read, warp):
    """By differences of the moved places, and its sign by the way that their corners run round."""
    result = read(WARPING, ":stretch", warp=warp, bends=2, gain=0.5, frequency=CELLS)
    x, y = places()
    step = 1e-5

    def moved(x, y):
        return np.stack(
            [x + warp * octaves(x, y, 2, 0.5, 0x51ED270B), y + warp * octaves(x, y, 2, 0.5, 0xA3DA4E16)]
        )

    east = moved(x + step, y) - moved(x - step, y)
    north = moved(x, y + step) - moved(x, y - step)
    area = (east[0] * north[1] - east[1] * north[0]) / (2 * step) ** 2
    np.testing.assert_allclose(result, area, atol=2e-4 * max(abs(area).max(), 1))
    if warp == 1.5:
        assert (area < 0).any(), "a strong warp folds the map"


def test_the_board_shows_where_places_go(read):
    value = {"squares": True, "frequency": 4.0, "size": (65, 65), "extent": (1000.0, 1000.0)}
    board = read(WARPING, ":height", warp=0.0, **value)
    np.testing.assert_array_equal(np.unique(board), [0, 1])
    y, x = np.mgrid[0:65, 0:65] // 4  # sixteen squares a side
    np.testing.assert_array_equal(board[:-1, :-1], ((x + y) % 2)[:-1, :-1])
    assert (read(WARPING, ":height", warp=0.5, **value) != board).mean() > 0.2
