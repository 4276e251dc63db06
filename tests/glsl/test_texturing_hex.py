"""texturing/hex_tiled: pieces of an image by chance, nothing repeats; mean and contrast stay."""

from __future__ import annotations

import numpy as np
import pytest

LIBRARY = "texturing/hex_tiling.glsl"
MIXING = "texturing/kept_contrast.glsl"
REPEATS, SIZE = 8, 513
PERIOD = (SIZE - 1) // REPEATS


def test_hex_weights_are_linear_hats_over_triangle_corners(on_gpu):
    """A corner's weight falls evenly from 1 to 0 at the six lines that join its neighbours."""
    tile = np.random.default_rng(2).uniform(-9, 9, (3000, 2))
    cells = 2.5
    weights = on_gpu(LIBRARY, f"hex_copies(t, {cells}).weights", t=tile).astype(float)
    corners = np.stack(
        [
            on_gpu(LIBRARY, f"vec2(hex_copies(t, {cells}).corner[{k}])", t=tile).astype(float)
            for k in range(3)
        ],
        axis=1,
    )
    assert weights.min() > -1e-5
    np.testing.assert_allclose(weights.sum(axis=1), 1, atol=1e-6)
    # Where the corners stand: east by whole cells, and half a cell east for each row north.
    there = (corners @ [[1, 0], [0.5, np.sqrt(0.75)]]) / cells
    sides = np.linalg.norm(there - np.roll(there, 1, axis=1), axis=2)
    np.testing.assert_allclose(sides, 1 / cells, rtol=1e-6)
    # The height of the triangle over the side opposite to a corner is where its weight is 0.
    axes = np.array([[np.cos(a), np.sin(a)] for a in np.radians([30, 90, 150])])
    apart = np.abs((tile[:, None] - there) @ axes.T).max(axis=2)
    np.testing.assert_allclose(weights, 1 - apart * cells / np.sqrt(0.75), atol=3e-5)


@pytest.mark.parametrize("power", [1.0, 3.0, 16.0])
def test_sharpened_weights_still_sum_to_one_and_keep_their_order(on_gpu, power):
    raw = np.random.default_rng(3).dirichlet([1, 1, 1], 2000)
    result = on_gpu(LIBRARY, f"hex_sharpened(w, {power})", w=raw).astype(float)
    np.testing.assert_allclose(result.sum(axis=1), 1, atol=1e-6)
    assert (np.argmax(result, axis=1) == np.argmax(raw, axis=1)).all()
    expected = raw**power / (raw**power).sum(axis=1, keepdims=True)
    np.testing.assert_allclose(result, expected, atol=1e-4)


@pytest.mark.parametrize("weights", [(1 / 3, 1 / 3, 1 / 3), (0.6, 0.3, 0.1), (0.5, 0.5, 0.0)])
def test_mix_of_three_independent_images_keeps_mean_and_variance(on_gpu, weights):
    random = np.random.default_rng(5)
    images = [random.normal(0.5, 0.08, (60000, 3)) for _ in range(3)]
    a, b, c = images
    mean = np.full((60000, 3), 0.5)
    value = "vec3({}, {}, {})".format(*weights)
    result = on_gpu(MIXING, f"mixed_with_contrast({value}, a, b, c, m)", a=a, b=b, c=c, m=mean).astype(float)
    np.testing.assert_allclose(result.mean(axis=0), 0.5, atol=2e-3)
    np.testing.assert_allclose(result.std(axis=0), 0.08, rtol=0.02)


@pytest.fixture
def laid(make_sketch):
    """Give ``laid(technique, settings, image)``: an image over a terrain of 8 x 8 tiles of 64 texels."""

    def make(technique, given, image="rock", size=SIZE):
        tile = f'[[pass]]\nname = "tile"\nuse = "texturing/{image}"\nsize = 256\n'
        cover = f'[[pass]]\nname = "c"\nuse = "texturing/{technique}"\ninputs = {{ colour = "tile" }}\n'
        return make_sketch(f"{tile}{cover}set = {{ repeats = {REPEATS}, {given} }}\n", size=size)

    return make


def rgb(engine, sketch, name="c"):
    return engine.read(sketch, name).astype(float)[..., :3]


def correlation(colour, north, east):
    """How far the texture agrees with itself so many texels away: 1 where it repeats, 0 where it does not."""
    away = colour - colour.mean(axis=(0, 1))
    rows, columns = colour.shape[:2]
    here, there = away[: rows - north, : columns - east], away[north:, east:]
    return (here * there).sum() / np.sqrt((here**2).sum() * (there**2).sum())


@pytest.mark.parametrize(("image", "turn"), [("rock", 0), ("path", 180), ("sand", 0)])
def test_hex_tiling_repeats_five_times_less_than_plain_tiles(any_engine, laid, image, turn):
    lags = [(0, PERIOD), (PERIOD, 0), (PERIOD, PERIOD), (0, 2 * PERIOD)]
    plain = rgb(any_engine, laid("tiled", "variety = 0.0", image))
    twice = rgb(any_engine, laid("tiled", "variety = 0.5", image))
    pieces = rgb(any_engine, laid("hex_tiled", f"turn = {turn}", image))
    for lag in lags:
        assert correlation(plain, *lag) > 0.99
        worst = abs(correlation(pieces, *lag))
        # Measured: 0.02 at most, against 1 for plain tiles and 0.6 to 0.84 for two readings.
        assert worst < correlation(plain, *lag) / 5
        assert worst < correlation(twice, *lag) / 5


@pytest.mark.parametrize("image", ["rock", "grass", "snow", "sand", "mud", "path"])
def test_the_mean_and_the_contrast_are_the_image_s(any_engine, laid, image):
    """Against the image at the same level of detail, read where texels fall between the image's."""
    sketch = laid("hex_tiled", "turn = 0", image)
    tile = rgb(any_engine, sketch, "tile")
    result = rgb(any_engine, sketch)
    mean = tile.mean(axis=(0, 1))
    np.testing.assert_allclose(result.mean(axis=(0, 1)), mean, rtol=0.01)
    level = tile.reshape(64, 4, 64, 4, 3).mean(axis=(1, 3))
    # The filter takes from a quarter to the whole of each texel: its mean loss, over 8 x 8 places.
    variances = []
    for east in (np.arange(8) + 0.5) / 8:
        for north in (np.arange(8) + 0.5) / 8:
            row = level * (1 - east) + np.roll(level, -1, axis=1) * east
            variances.append((row * (1 - north) + np.roll(row, -1, axis=0) * north).var(axis=(0, 1)))
    np.testing.assert_allclose(result.std(axis=(0, 1)), np.sqrt(np.mean(variances, axis=0)), rtol=0.05)


def test_hex_contrast_is_independent_of_border_sharpness(any_engine, laid):
    """A plain mean of three copies would lose a fifth of it where the borders are wide."""
    wide, narrow = (
        rgb(any_engine, laid("hex_tiled", f"sharpness = {s}", "rock")).std(axis=(0, 1)) for s in (1.0, 16.0)
    )
    np.testing.assert_allclose(wide, narrow, rtol=0.05)


def test_there_is_no_seam_between_pieces(any_engine, laid):
    """No step from texel to texel is larger than in the image itself, but by what keeps the variance."""
    sketch = laid("hex_tiled", "sharpness = 1.0", "snow")
    tile = rgb(any_engine, sketch, "tile").reshape(64, 4, 64, 4, 3).mean(axis=(1, 3))
    result = rgb(any_engine, sketch)
    inside = np.abs(tile - np.roll(tile, 1, axis=1)).max()
    assert np.abs(np.diff(result, axis=1)).max() < 2 * inside


def test_less_detail_another_seed_and_a_turn(engine, laid):
    plain = rgb(engine, laid("hex_tiled", "seed = 1", size=129))
    mean = rgb(engine, laid("hex_tiled", "seed = 1", size=129), "tile").mean(axis=(0, 1))
    half = rgb(engine, laid("hex_tiled", "seed = 1, detail = 0.5", size=129))
    np.testing.assert_allclose(half - mean, 0.5 * (plain - mean), atol=1e-3)
    for other in ("seed = 2", "seed = 1, turn = 90"):
        changed = rgb(engine, laid("hex_tiled", other, size=129))
        assert abs(np.corrcoef(plain[..., 1].ravel(), changed[..., 1].ravel())[0, 1]) < 0.15


def test_far_more_tiles_than_texels_are_the_mean(any_engine, laid):
    sketch = laid("hex_tiled", "cells = 3.0", size=33).with_values({"c.repeats": 256.0})
    result = rgb(any_engine, sketch)
    np.testing.assert_allclose(
        result, np.broadcast_to(rgb(any_engine, sketch, "tile").mean(axis=(0, 1)), result.shape), rtol=0.1
    )


@pytest.mark.slow
def test_hex_height_blend_matches_colours_of_tiled_height_blend(any_engine, make_sketch):
    ramp = '#pragma kernel(output = "height:r32f")\n'
    ramp += "float kernel(ivec2 texel) { return float(texel.x) / float(size.x - 1); }\n"
    bands = {}
    for technique in ("height_blend", "height_blend_hex"):
        passes = '[[pass]]\nname = "height"\nuse = "./ramp"\n'
        passes += f'[[pass]]\nname = "c"\nuse = "texturing/{technique}"\n'
        colour = rgb(any_engine, make_sketch(passes, size=257, ramp=ramp))
        bands[technique] = np.array([colour[:, at : at + 16].mean(axis=(0, 1)) for at in range(0, 257, 16)])
    np.testing.assert_allclose(bands["height_blend_hex"], bands["height_blend"], rtol=0.04)
