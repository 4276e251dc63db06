"""Mip levels, and a plain seen through them: means over blocks, and the plain itself in float64."""

from __future__ import annotations

import numpy as np
import pytest

SIDE = 32
WIDE, HIGH = 64, 32
EYE, TILE, SQUARES = 2.0, 4.0, 8

NOISE = """
#include "noise/hash.glsl"
#pragma kernel(output = "colour:rgba32f")
vec4 kernel(ivec2 texel) { return vec4(random(texel, 3u), random(texel, 4u), 0.0, 1.0); }
"""


@pytest.fixture
def plain(make_sketch):
    def make(pattern="texturing/mipmaps/pattern", **values):
        text = ", ".join(f"{key} = {value}" for key, value in values.items())
        passes = (
            f'[[pass]]\nname = "pattern"\nuse = "{pattern}"\nsize = {SIDE}\n'
            f'[[pass]]\nname = "plain"\nuse = "texturing/mipmaps"\nsize = [{WIDE}, {HIGH}]\n'
            f'inputs = {{ image = "pattern" }}\nset = {{ {text} }}\n'
        )
        return make_sketch(passes, size=SIDE, noise=NOISE)

    return make


def levels(chain):
    """Cut a chain into its levels, the finest first."""
    side = chain.shape[0]
    result = [chain[:, :side]]
    low = 0
    while side > 1:
        side //= 2
        result.append(chain[low : low + side, chain.shape[0] : chain.shape[0] + side])
        low += side
    return result


def chessboard(x, y):
    """Return 0 or 1 at places in metres."""
    width = TILE / SQUARES
    return (np.floor(x / width) + np.floor(y / width)) % 2


def places(within_x, within_y, shift=0.0):
    """Return where on the plain the places of the pixels are, in metres, as float64 (HIGH, WIDE)."""
    y, x = np.mgrid[0:HIGH, 0:WIDE].astype(float)
    far = EYE / ((HIGH - (y + within_y)) / (WIDE / 2))
    return (x + within_x - WIDE / 2) / (WIDE / 2) * far, far + shift


def test_each_mip_level_averages_four_texels_and_preserves_mean(engine, plain):
    sketch = plain("./noise")
    image = engine.read(sketch, "pattern").astype(float)
    for k, level in enumerate(levels(engine.read(sketch, "plain:chain"))):
        block = 2**k
        expected = image.reshape(SIDE // block, block, SIDE // block, block, 4).mean(axis=(1, 3))
        np.testing.assert_allclose(level, expected, atol=2e-6)  # at most ten sums of numbers below 1
        np.testing.assert_allclose(level.mean(axis=(0, 1)), image.mean(axis=(0, 1)), atol=2e-6)


def test_one_sample_is_the_colour_of_the_pixel_s_middle(engine, plain):
    sketch = plain(filtered='"one sample"')
    result = engine.read(sketch, "plain:picture")[..., 0]
    x, y = places(0.5, 0.5)
    width = TILE / SQUARES
    edge = np.minimum(np.abs(x / width - np.round(x / width)), np.abs(y / width - np.round(y / width)))
    inside = edge > 0.51 * SQUARES / SIDE + 1e-3  # bilinear reading mixes within half a texel of an edge
    assert inside.mean() > 0.5
    np.testing.assert_allclose(result[inside], chessboard(x, y)[inside], atol=1e-3)


def test_many_samples_come_to_the_share_of_white_in_a_pixel(engine, plain):
    """Against 64 by 64 exact ones: a straight edge crosses at most 2 n cells of a lattice of n by n."""
    result = engine.read(plain(filtered='"many samples"', samples=32), "plain:picture")[..., 0]
    total = np.zeros((HIGH, WIDE))
    steps = (np.arange(64) + 0.5) / 64
    for dy in steps:
        for dx in steps:
            total += chessboard(*places(dx, dy))
    near = slice(0, 24)  # where a pixel is below two squares long
    assert np.abs(result - total / 4096)[near].mean() < 2 / 32
    assert np.abs(result - total / 4096).mean() < 0.05


def test_mip_level_follows_longer_side_of_pixel_footprint(engine, plain):
    """At a distance d a pixel sees d² / (eye · f) of a plain's length, d / f of its width; f in pixels."""
    result = engine.read(plain(), "plain:level")
    far = places(0.5, 0.5)[1]
    focal = WIDE / 2
    long = far * (places(0.5, -0.5)[1] / EYE) / focal  # from a pixel's middle to the one below it, exactly
    middle = [WIDE // 2 - 1, WIDE // 2]
    expected = np.log2(np.maximum(long, far / focal) * SIDE / TILE)
    np.testing.assert_allclose(result[:, middle], expected[:, middle], atol=0.02)


def test_the_ways_to_filter_come_nearer_and_nearer_to_the_truth(engine, plain):
    errors = []
    for way in ("one sample", "trilinear", "anisotropic"):
        sketch = plain(filtered=f'"{way}"', maximum=16.0)
        errors.append(float(engine.read(sketch, "plain:wrong").mean()))
    assert errors[0] > 2 * errors[1] > 0 and errors[1] > 1.3 * errors[2] > 0


def test_far_away_there_is_only_the_mean(engine, plain):
    for way in ("mip level", "trilinear", "anisotropic"):
        result = engine.read(plain(filtered=f'"{way}"', maximum=4.0), "plain:picture")[-1, :, 0]
        np.testing.assert_allclose(result, 0.5, atol=1e-5)


def test_a_tile_further_the_picture_is_the_same(engine, plain):
    """And the difference of two pictures is NumPy's."""
    first, again, between = (plain(filtered='"trilinear"', next_shift=s) for s in (0.0, TILE, 0.3))
    assert engine.read(first, "plain:shimmer").max() == 0
    assert engine.read(again, "plain:shimmer").max() < 2e-3
    now, later = (engine.read(between, f"plain:{name}")[..., 0] for name in ("picture", "later"))
    np.testing.assert_array_equal(engine.read(between, "plain:shimmer"), np.abs(now - later))
    assert np.abs(now - later).max() > 0.1


def test_cut_after_the_mean_is_not_the_mean_of_the_cut(engine, plain):
    """Of hills of which a fifth is over 0.6, the truth far away has a fifth of white; the mean is below."""
    values = {"filtered": '"trilinear"', "cut": "true"}
    sketch = plain(**values).with_values({"pattern.pattern": "hills"})
    share = (engine.read(sketch, "pattern")[..., 0] > 0.6).mean()
    assert 0.1 < share < 0.4
    assert engine.read(sketch, "plain:picture")[-3:, :, 0].max() == 0
    before = plain(filtered='"trilinear"').with_values({"pattern.pattern": "hills over 0.6"})
    np.testing.assert_allclose(engine.read(before, "plain:picture")[-1, :, 0], share, atol=1e-3)
    truth = engine.read(sketch, "plain:truth")[-3:, :, 0].mean()
    assert truth == pytest.approx(share, abs=0.05)
