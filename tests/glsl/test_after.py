"""view/: what is done to a finished picture: exposure by itself, glow, vignette, smooth edges."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from playground.shader.colours import linear_to_srgb

LIGHT = '#pragma kernel(output = "frame:rgba16f")\nuniform float angle = 0.3;\n'
LIGHT += "vec4 kernel(ivec2 texel) {{ return {}; }}\n"
# Light of six stops, tinted, with one very bright spot.
SCENE = (
    "vec4(exp2(4.0 * sin(float(texel.x) * 0.11) + 2.0 * cos(float(texel.y) * 0.07)) * vec3(0.9, 1.0, 0.6)"
    " * (texel == ivec2(20, 31) ? 400.0 : 1.0), 1.0)"
)
WEIGHTS = np.array([0.2126, 0.7152, 0.0722])
SIZE = (97, 61)


@pytest.fixture
def picture(make_sketch):
    """Give a function that makes a sketch of a light, and a view that is made of it."""

    def make(light, view, given="", more=""):
        body = f'[[pass]]\nname = "light"\nuse = "./light"\nsize = [{SIZE[0]}, {SIZE[1]}]\n{more}'
        wired = "initial" if "antialias" in view else "picture"
        body += f'[view]\nuse = "{view}"\ninputs = {{ {wired} = "light" }}\n'
        return make_sketch(f"{body}set = {{ {given} }}\n", light=LIGHT.format(light))

    return make


@pytest.mark.parametrize(
    ("key", "minimum", "maximum"), [(0.18, -16, 16), (0.5, -1, 16), (0.05, -16, 0), (1, -2, 0.5)]
)
def test_the_mean_of_logarithms_becomes_the_key(any_engine, picture, key, minimum, maximum):
    text = f"adapts = true, key = {key}, minimum = {minimum}, maximum = {maximum}"
    sketch = picture(SCENE, "view/exposure", text)
    light = any_engine.read(sketch, "light").astype(float)[..., :3]
    expected = np.clip(np.log2(key) - np.log2(light @ WEIGHTS).mean(), minimum, maximum)
    result = any_engine.read(sketch, "view.adapted", size=SIZE)
    np.testing.assert_allclose(result.ravel(), [expected, 1.0], atol=2e-4)
    off = any_engine.read(sketch.with_values({"view.adapts": False}), "view.adapted", size=SIZE)
    np.testing.assert_array_equal(off.ravel(), 0.0)


def test_overbright_pixel_keeps_exposure_mean_finite(any_engine, picture):
    """It counts as the brightest half float, 65504: one of 5917 pixels moves the mean by 16 / 5917 stops."""
    light = "vec4(vec3(texel == ivec2(20, 31) ? uintBitsToFloat(0x7f800000u) : 1.0), 1.0)"
    sketch = picture(light, "view/exposure", "adapts = true")
    assert np.isinf(any_engine.read(sketch, "light")[31, 20, 0])
    result = any_engine.read(sketch, "view.adapted", size=SIZE).ravel()
    np.testing.assert_allclose(result, [np.log2(0.18) - np.log2(65504) / (97 * 61), 1.0], atol=2e-4)


def test_glow_loses_no_light_and_stays_around_its_source(any_engine, picture):
    sketch = picture(SCENE, "view/bloom", "bloom = 0.1")
    light = any_engine.read(sketch, "light").astype(float)[..., :3]
    half = any_engine.read(sketch, "view.down_1", size=SIZE).astype(float)[..., :3]
    assert half.shape == (30, 48, 3)
    np.testing.assert_allclose(half.mean(axis=(0, 1)), light.mean(axis=(0, 1)), rtol=1e-3)
    # The exact mean over each texel's area, as a product of two matrices in float64.
    rows, columns = areas(61, 30), areas(97, 48)
    np.testing.assert_allclose(half, np.einsum("iy,yxc,jx->ijc", rows, light, columns), rtol=2e-3, atol=1e-3)
    spread = any_engine.read(sketch, "view.up_1", size=SIZE).astype(float)[..., :3]
    # Half of each level and half of the wider ones, by matrices in float64. Eleven roundings to half floats.
    sides = [(61, 97), (30, 48), (15, 24), (7, 12), (3, 6), (1, 3), (1, 1)]
    levels = [light]
    for (y0, x0), (y1, x1) in pairwise(sides):
        levels.append(np.einsum("iy,yxc,jx->ijc", areas(y0, y1), levels[-1], areas(x0, x1)))
    wide = levels[6]
    for level in levels[5:0:-1]:
        rows, columns = (between(wide.shape[k], level.shape[k]) for k in (0, 1))
        wide = 0.5 * (level + np.einsum("iy,yxc,jx->ijc", rows, wide, columns))
    np.testing.assert_allclose(spread, wide, rtol=11 * 2.0**-11)
    assert np.unravel_index(spread[..., 1].argmax(), spread.shape[:2]) == (15, 10), "at the bright spot"


def areas(pixels, texels):
    """Return how much each of so many texels takes of each pixel along a side, (texels, pixels)."""
    edges = np.arange(texels + 1) * pixels / texels
    overlap = np.minimum(edges[1:, None], np.arange(1, pixels + 1)) - np.maximum(
        edges[:-1, None], np.arange(pixels)
    )
    return np.clip(overlap, 0, None) * texels / pixels


def between(texels, pixels):
    """Return the weights of interpolation between so many texels at so many pixels, (pixels, texels)."""
    at = np.clip((np.arange(pixels) + 0.5) * texels / pixels - 0.5, 0, texels - 1)
    return np.clip(1 - np.abs(at[:, None] - np.arange(texels)), 0, None)


def shown(light):
    """Return light as bytes of sRGB, in float64."""
    value = np.clip(light, 0, 1)
    return 255 * linear_to_srgb(value)


def test_a_picture_is_shown_in_the_order_of_a_camera(any_engine, make_sketch):
    """Glow, then vignette, then exposure, each as its header has it."""
    make = '[[pass]]\nname = "{}"\nuse = "{}"\n{}'
    body = make.format("light", "./light", f"size = [{SIZE[0]}, {SIZE[1]}]\n")
    body += make.format(
        "exposure", "view/exposure", 'inputs = { picture = "light" }\nset = { adapts = true }\n'
    )
    body += make.format("bloom", "view/bloom", 'inputs = { picture = "light" }\nset = { bloom = 0.2 }\n')
    wired = 'inputs = { picture = "light", spread = "bloom", adapted = "exposure" }\n'
    body += f'[view]\nuse = "view/present"\n{wired}set = {{ bloom = 0.2, vignette = 0.5, exposure = -1 }}\n'
    sketch = make_sketch(body, light=LIGHT.format(SCENE))
    result = any_engine.render(sketch, size=SIZE).array[::-1, :, :3].astype(float)
    light = any_engine.read(sketch, "light").astype(float)[..., :3]
    spread = any_engine.read(sketch, "bloom").astype(float)[..., :3]
    stops = float(any_engine.read(sketch, "exposure").ravel()[0])
    rows, columns = np.indices(SIZE[::-1]) + 0.5
    # Bilinear between the glow's texels, in float64.
    u, v = np.clip(columns / SIZE[0] * 48 - 0.5, 0, 47), np.clip(rows / SIZE[1] * 30 - 0.5, 0, 29)
    x, y = u.astype(int), v.astype(int)
    p, q = (u - x)[..., None], (v - y)[..., None]
    right, up = np.minimum(x + 1, 47), np.minimum(y + 1, 29)
    glow = (spread[y, x] * (1 - p) + spread[y, right] * p) * (1 - q)
    glow += (spread[up, x] * (1 - p) + spread[up, right] * p) * q
    off = ((2 * columns - SIZE[0]) ** 2 + (2 * rows - SIZE[1]) ** 2) / (SIZE[0] ** 2 + SIZE[1] ** 2)
    cosine = np.cos(np.arctan(np.sqrt(0.5 * off)))
    expected = shown((0.8 * light + 0.2 * glow) * cosine[..., None] ** 4 * 2.0 ** (stops - 1))
    np.testing.assert_allclose(result, expected, atol=1.01)


def cover(angle, size=SIZE, inside=24):
    """Return how much of each pixel lies above a line through the middle, in float64."""
    side = (np.arange(inside) + 0.5) / inside
    x = (np.arange(size[0])[:, None] + side).ravel() - size[0] / 2
    y = (np.arange(size[1])[:, None] + side).ravel() - size[1] / 2
    above = y[:, None] * np.cos(angle) > x[None, :] * np.sin(angle)
    return above.reshape(size[1], inside, size[0], inside).mean(axis=(1, 3))


EDGE = (
    "vec4(vec3((float(texel.y) + 0.5 - 30.5) * cos(angle) > (float(texel.x) + 0.5 - 48.5) * sin(angle)"
    " ? 0.8 : 0.2), 1.0)"
)


@pytest.mark.parametrize("degrees", [4, 9, 18, 33, 45, 62, 78, 86, -9, -33, -78])
def test_steps_of_an_edge_come_nearer_to_its_cover(any_engine, picture, degrees):
    """Of encoded numbers, as the eye sees them; its own pixels alone, far from the picture's ends."""
    sketch = picture(EDGE, "view/antialias").with_values({"light.angle": np.radians(degrees).item()})
    result = any_engine.read(sketch, "view", size=SIZE)[..., 0].astype(float)
    stepped = any_engine.read(sketch, "light")[..., 0].astype(float)
    expected = 0.2 + 0.6 * cover(np.radians(degrees))
    middle = (slice(14, -14), slice(14, -14))
    before, after = (np.abs(item - expected)[middle] for item in (stepped, result))
    # An end of a step is found to half a pixel, so the edge that is drawn lies off by half the slope at
    # most, where a stepped one lies off by half a pixel: that ratio, also of the means. Two bytes a pixel
    # of the edge are rounded by 1 / 510 each at most, of a mean error of a quarter of 0.6.
    slope = np.tan(np.radians(min(abs(degrees), 90 - abs(degrees))))
    assert after.sum() < min(slope + 2 / 510 / 0.15, 1.0) * before.sum()
    assert result.min() > 0.199 and result.max() < 0.801
    changed = np.abs(result - stepped) > 0.01
    near = (expected > 0.201) & (expected < 0.799)
    grown = near.copy()
    for axis in (0, 1):
        for step in (1, -1):
            grown |= np.roll(near, step, axis)
    assert not np.any(changed[middle] & ~grown[middle]), "and nothing away from the edge changes"


@pytest.mark.parametrize(
    "light", ["vec4(0.3)", "vec4(vec3(texel.x > 40 ? 0.8 : 0.2), 1.0)", "vec4(vec3(texel.y > 9), 1.0)"]
)
def test_what_has_no_steps_stays(any_engine, picture, light):
    sketch = picture(light, "view/antialias")
    result, before = any_engine.read(sketch, "view", size=SIZE), any_engine.read(sketch, "light")
    np.testing.assert_allclose(result, np.clip(before, 0, 1), atol=0.5 / 255 + 1e-3)
