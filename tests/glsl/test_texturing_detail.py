"""texturing/detail and view/terrain with it: a fine image over a coarse cover, by rays in float64."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from playground.sketch.model import Camera

from ..sketch_texts import passes
from ..truth.eyes import on_level

HEIGHT = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
PLAIN = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return vec4({}, 1.0); }}\n'
PASSES = (
    passes(height="./terrain", colour="./cover", detail=("./{}", "size = 8"))
    + """[view]
use = "view/terrain"
samples = 1
{}
set = {{ {} }}
"""
)
COVER = "vec3(0.2, 0.4, 0.1)"
FINE = PLAIN.format("vec3(0.25 + 0.5 * float((texel.x * 5 + texel.y * 3) % 8) / 7.0)")
CAMERA = Camera(azimuth=180.0, elevation=35.0, distance=500.0, target=(500.0, 400.0, 0.0))


@pytest.fixture
def terrain(make_sketch):
    def make(given="", *, wired=True, height="0.0", cover=COVER, fine="fine"):
        common = "grid = 33" + given
        wires = 'inputs = { detail_image = "detail" }' if wired else ""
        files = {"terrain": HEIGHT.format(height), "cover": PLAIN.format(cover), "fine": FINE}
        files["flat"] = PLAIN.format("vec3(0.07)")
        return make_sketch(PASSES.format(fine, wires, common), size=33, **files).with_camera(CAMERA)

    return make


def linear_frame(engine, sketch, name="view.land"):
    """The draw's own frame, before exposure and encoding, rows from the south."""
    return engine.read(sketch, name, size=(320, 180)).astype(float)[..., :3]


def on_the_ground(engine, shape):
    """Where each pixel's ray meets height 0, and how far from the eye, in float64."""
    position, length = on_level(engine.record.plan.eye, shape[::-1])
    inside = (length > 0) & (position[..., :2] > 20).all(axis=-1) & (position[..., :2] < 980).all(axis=-1)
    return position, length, inside


def nearness(distance, reach):
    """From 0 at the reach to 1 at the eye: the area under the parabola 6s(1 - s), summed."""
    share = np.clip(1 - distance / reach, 0, 1)
    steps = np.linspace(0, 1, 201)
    middle = (steps[1:] + steps[:-1]) / 2
    area = np.concatenate([[0], np.cumsum(6 * middle * (1 - middle) * np.diff(steps))])
    return np.interp(share, steps, area)


def test_detail_scales_cover_by_ratio_to_mean_and_by_nearness(any_engine, terrain):
    reach, repeats, strength = 700.0, 4.0, 0.8
    sketch = terrain(
        f", detail_max_distance = {reach}, detail_repeats = {repeats}, detail_strength = {strength}"
    )
    frame = linear_frame(any_engine, sketch)
    position, distance, inside = on_the_ground(any_engine, frame.shape[:2])
    texels = any_engine.read(sketch, "detail")[..., 0].astype(float)
    # Only pixels in the middle of a texel: between texels the filter decides.
    at = position[..., :2] / 1000 * repeats * 8
    middle = inside & (np.abs(at % 1 - 0.5) < 0.04).all(axis=-1)
    assert middle.sum() > 30
    column, row = (np.floor(at[middle]).astype(int) % 8).T
    ratio = texels[row, column] / texels.mean()
    weight = strength * nearness(distance[middle], reach)
    assert weight.max() > 0.2 and weight.min() < 0.05
    expected = np.array([0.2, 0.4, 0.1]) * (1 + weight * (ratio - 1))[:, None]
    np.testing.assert_allclose(frame[middle], expected, rtol=0.04)


def test_it_is_stronger_the_nearer_the_eye_and_gone_at_its_reach(any_engine, terrain):
    reach = 600.0
    frame = linear_frame(any_engine, terrain(f", detail_max_distance = {reach}, detail_repeats = 6"))[..., 1]
    _, distance, inside = on_the_ground(any_engine, frame.shape)
    edges = np.linspace(distance[inside].min(), reach, 6)
    spread = [frame[inside & (distance > low) & (distance < high)].std() for low, high in pairwise(edges)]
    assert spread == sorted(spread, reverse=True)
    assert spread[0] > 5 * spread[-1]
    np.testing.assert_allclose(frame[inside & (distance > reach)], 0.4, atol=3e-4)


def test_the_mean_is_the_cover_s(any_engine, terrain):
    frame = linear_frame(any_engine, terrain(", detail_max_distance = 5000, detail_repeats = 40"))
    _, _, inside = on_the_ground(any_engine, frame.shape[:2])
    np.testing.assert_allclose(frame[inside].mean(axis=0), [0.2, 0.4, 0.1], rtol=0.01)


def test_too_fine_to_be_seen_it_does_not_flicker(any_engine, terrain):
    """Where a pixel holds whole images, it holds their mean."""
    frame = linear_frame(any_engine, terrain(", detail_max_distance = 50000, detail_repeats = 2000"))[..., 1]
    _, _, inside = on_the_ground(any_engine, frame.shape)
    assert frame[inside].std() < 0.02 * 0.4


def test_under_small_moves_it_hardly_flickers(any_engine, terrain):
    """Linear light, four frames a fraction of a pixel apart, each against sixteen times the pixels.

    Flicker is what changes from frame to frame in the difference of the two: measured, 1.7 times what
    the truth itself changes by; 4.2 times where levels of detail are not read.
    """
    sketch = terrain(
        ", detail_max_distance = 50000, detail_repeats = 60", height="0.1 * sin(float(texel.x) * 0.4)"
    )
    differences, truths = [], []
    for turn in range(4):
        moved = sketch.with_camera(replace(CAMERA, azimuth=180.0 + 0.05 * turn, elevation=25.0 + 0.02 * turn))
        frame = any_engine.read(moved, "view.land", size=(160, 90)).astype(float)[..., :3]
        fine = any_engine.read(moved, "view.land", size=(640, 360)).astype(float)[..., :3]
        truths.append(fine.reshape(90, 4, 160, 4, 3).mean(axis=(1, 3)))
        differences.append(frame - truths[-1])
    _, _, inside = on_the_ground(any_engine, (360, 640))
    inside = inside.reshape(90, 4, 160, 4).all(axis=(1, 3))
    flicker = np.std(differences, axis=0)[inside]
    change = np.std(truths, axis=0)[inside]
    assert np.sqrt((change**2).mean()) > 1e-3, "the camera moved"
    assert np.sqrt((flicker**2).mean()) < 2.5 * np.sqrt((change**2).mean())


@pytest.mark.parametrize(("value", "fine"), [(", detail_strength = 0", "fine"), ("", "flat")])
def test_zero_strength_or_uniform_detail_matches_plain_view(any_engine, terrain, value, fine):
    height, cover = "0.4 * sin(float(texel.x) * 0.3) + 0.3", "vec3(float(texel.x % 5), 1.0, 0.5) * 0.2"
    plain = terrain(wired=False, height=height, cover=cover)
    expected = any_engine.render(plain, size=(160, 90)).array
    array = any_engine.render(terrain(value, height=height, cover=cover, fine=fine), size=(160, 90)).array
    if value:
        np.testing.assert_array_equal(array, expected)
    else:
        np.testing.assert_allclose(array, expected, atol=1)


def test_terrain_that_is_not_a_number_shows(any_engine, terrain):
    sketch = terrain(cover="vec3(uintBitsToFloat(0x7fc00000u))")
    frame = linear_frame(any_engine, sketch)
    _, _, inside = on_the_ground(any_engine, frame.shape[:2])
    np.testing.assert_array_equal(frame[inside], np.broadcast_to([1.0, 0.0, 1.0], (inside.sum(), 3)))


@pytest.fixture
def tile(make_sketch):
    def make(size=256, given=""):
        text = f'[[pass]]\nname = "detail"\nuse = "texturing/detail"\nset = {{ {given} }}\n'
        return make_sketch(text, size=size)

    return make


def test_the_image_is_grey_seamless_and_holds_no_coarse_pattern(engine, tile):
    image = engine.read(tile(512), "detail").astype(float)
    assert (image[..., 0] == image[..., 1]).all() and (image[..., 0] == image[..., 2]).all()
    grey = image[..., 0]
    assert 0 < grey.min() < grey.max() <= 1
    assert 0.4 < grey.mean() < 0.6
    for axis in (0, 1):
        steps = np.abs(grey - np.roll(grey, 1, axis)).mean(axis=1 - axis)
        assert steps[0] <= steps[1:].mean() + 3 * steps[1:].std()
    power = np.abs(np.fft.fft2(grey - grey.mean())) ** 2
    cycles = np.hypot(*np.meshgrid(*[np.fft.fftfreq(512) * 512] * 2))
    assert power[cycles < 6].sum() < 0.05 * power.sum(), "from afar its repeats would show"


def test_each_of_its_parts_can_be_taken_out(any_engine, tile):
    none = "cracks = 0, roughness = 0, furrows = 0, grains = 0"
    spread = any_engine.read(tile(given=none), "detail")[..., 0].astype(float).std()
    for part in ("cracks", "roughness", "furrows", "grains"):
        value = none.replace(f"{part} = 0", f"{part} = 1")
        assert any_engine.read(tile(given=value), "detail")[..., 0].astype(float).std() > 1.5 * spread, part


def test_another_seed_is_another_image(any_engine, tile):
    first, other = (
        any_engine.read(tile(given=f"seed = {s}"), "detail")[..., 0].astype(float) for s in (1, 2)
    )
    assert abs(np.corrcoef(first.ravel(), other.ravel())[0, 1]) < 0.1
