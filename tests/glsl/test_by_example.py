"""By-example noise: in float64 from its tables, and by the example's histogram."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, map_coordinates
from scipy.special import ndtr

from ..sketch_texts import passes, use
from ..truth.noise import python_random, salt

RNG = np.random.default_rng(6)
SIDE = 96


@pytest.fixture
def blended(engine, make_sketch, tmp_path):
    """Give what draws noise by an example: (normal, sorted, heights)."""
    heights = gaussian_filter(RNG.gumbel(size=(SIDE, SIDE)), 1.5, mode="wrap")
    heights = (heights - heights.min()) / np.ptp(heights)
    np.save(tmp_path / "example.npy", heights.astype(np.float32))

    def draw(size=(128, 128), extent=(20000.0, 20000.0), base=None, **values):
        text = passes(
            example=use("generation/heightmap", size=SIDE, elevation="example.npy", first_row="south"),
            hills=use("generation/gradient_noise", size=33),
            noise=use("generation/by_example", inputs={"example": "example"} | (base or {}), **values),
        )
        sketch = make_sketch(text, size=size, extent=extent)
        refs = ("noise.ranks:normal", "noise.ranks:sorted", "noise", "hills")
        return [engine.read(sketch, ref).astype(np.float64) for ref in refs]

    return draw


def test_hexagons_are_blended_as_they_say(blended):
    """Each texel from the three nearest of all corners, by its place among them."""
    width, cells, sharpness, seed = 9000.0, 2.5, 2.0, 4
    normal, ranks, result, _ = blended((40, 31), (12000.0, 8000.0), width=width, cells=cells,
                                      sharpness=sharpness, seed=seed)  # fmt: skip
    y, x = np.mgrid[0:31, 0:40]
    x, y = x * (12000.0 / 39) / width, y * (8000.0 / 30) / width
    total, squares, weights = np.zeros(x.shape), np.zeros(x.shape), np.zeros(x.shape)
    for j in range(-2, 8):
        for i in range(-6, 10):
            mx, my = (i + j / 2) / cells, j * np.sqrt(3) / 2 / cells
            # A corner counts by how near it is, against the side that faces it: 1 there, 0 on the side.
            u, v = (x - mx) * cells, (y - my) * cells
            slanted = [u - v / np.sqrt(3), v * 2 / np.sqrt(3), u + v / np.sqrt(3)]
            weight = np.maximum(1 - np.max(np.abs(slanted), axis=0), 0) ** sharpness
            shift = [
                1 / cells + python_random(i % 2**32, j % 2**32, seed + salt("generation/by_example/blend"), k)
                * max(1 - 2 / cells, 0)
                for k in (0, 1)
            ]  # fmt: skip
            position = [(shift[1] + y - my) * (SIDE - 1), (shift[0] + x - mx) * (SIDE - 1)]
            value = map_coordinates(normal, position, order=1, mode="nearest")
            total, squares, weights = total + weight * value, squares + weight**2, weights + weight
    at = ndtr(total / np.sqrt(squares)) * ranks.size - 0.5
    expected = np.interp(at, np.arange(ranks.size), ranks.ravel())
    # The normal distribution is 2e-7 off, which is 2e-3 of a rank; places in the example 1e-5 of a texel.
    np.testing.assert_allclose(result, expected, atol=2e-4)


def test_the_histogram_is_the_example_s(blended):
    """Over some fifty hexagons no share of heights is off by more than a tenth, and the mean by less."""
    _, ranks, result, _ = blended((200, 200), (60000.0, 60000.0), width=10000.0, cells=2.0)
    own, heights = ranks.ravel(), np.sort(result, axis=None)
    assert own[0] <= heights[0] and heights[-1] <= own[-1]
    shares = np.searchsorted(own, heights) / own.size
    assert abs(shares - np.linspace(0, 1, heights.size)).max() < 0.1
    assert np.std(result) == pytest.approx(np.std(own), rel=0.15)


def test_it_is_added_to_a_base_of_any_size(blended):
    alone = blended((65, 65), amount=0.3)[2]
    *_, added, hills = blended((65, 65), amount=0.3, base={"base": "hills"})
    y, x = np.mgrid[0:65, 0:65] / 2
    np.testing.assert_allclose(added - alone, map_coordinates(hills, [y, x], order=1), atol=1e-6)
    np.testing.assert_allclose(blended((65, 65), amount=0.0)[2], 0.0, atol=0)


def test_detail_has_no_wide_hills(blended):
    detail = blended(width=20000.0, widest=0.1)[2]
    assert gaussian_filter(detail, 16).std() < 0.2 * detail.std()
