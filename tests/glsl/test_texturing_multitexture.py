"""texturing/multitexture: each texture by its own coordinates, one share for all, and the shadow map."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes

RAMP = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
IMAGE = """#include "noise/hash.glsl"
#pragma kernel(output = "colour:rgba16f")
vec4 kernel(ivec2 texel) {{ return vec4(random_pair(texel, {}u), random(texel, {}u), 1.0); }}
"""
FILES = {"one": IMAGE.format(1, 2), "other": IMAGE.format(3, 4)}
PASSES = passes(
    height=("./terrain", "size = 9"),
    one=("./one", "size = 8"),
    other=("./other", "size = 16"),
    colour=(
        "texturing/multitexture",
        'inputs = {{ "units.first" = "one", "units.second" = "other" }}',
        "set = {{ {} }}",
    ),
)
SIZE = 65
GIVEN = {
    "first_repeats": 3.0, "first_turn": 0.0, "first_shift": [0.25, 0.5],
    "second_repeats": 2.0, "second_turn": 40.0, "second_shift": [0.0, 0.0], "share": 0.3, "shadows": 0.0,
}  # fmt: skip


def sketch_of(make_sketch, height="0.3", **value):
    values = ", ".join(
        f"{name} = {f'{chr(34)}{value}{chr(34)}' if isinstance(value, str) else value}"
        for name, value in {**GIVEN, **value}.items()
    )
    return make_sketch(PASSES.format(values), size=SIZE, terrain=RAMP.format(height), **FILES)


def rgb(engine, sketch, name):
    return engine.read(sketch, name).astype(float)[..., :3]


def sampled(image, east, north):
    """Bilinear between texel centres, the image repeated: by the four corners' areas."""
    rows, columns = image.shape[:2]
    x, y = east * columns - 0.5, north * rows - 0.5
    total = np.zeros((*east.shape, 3))
    for dx in (0, 1):
        for dy in (0, 1):
            cx, cy = np.floor(x) + dx, np.floor(y) + dy
            area = (1 - np.abs(x - cx)) * (1 - np.abs(y - cy))
            total += area[..., None] * image[cy.astype(int) % rows, cx.astype(int) % columns]
    return total


def truth(engine, sketch, value):
    north, east = np.meshgrid(np.linspace(0, 1, SIZE), np.linspace(0, 1, SIZE), indexing="ij")
    result = []
    for name, unit in (("one", "first"), ("other", "second")):
        angle = np.radians(value[f"{unit}_turn"])
        # A picture turned by an angle is read at places turned back by it: complex numbers turn.
        position = (east + 1j * north) * value[f"{unit}_repeats"] * np.exp(-1j * angle)
        shift = value[f"{unit}_shift"]
        result.append(sampled(rgb(engine, sketch, name), position.real - shift[0], position.imag - shift[1]))
    return result


@pytest.mark.parametrize("combine", ["mix", "product", "sum"])
def test_each_image_is_read_by_its_own_coordinates(engine, make_sketch, combine):
    sketch = sketch_of(make_sketch, combine=combine)
    first, other = truth(engine, sketch, GIVEN)
    share = GIVEN["share"]
    expected = {
        "mix": (1 - share) * first + share * other,
        "product": first - share * first * (1 - other),
        "sum": first + share * other,
    }[combine]
    # Filters weigh in steps of 1/256.
    np.testing.assert_allclose(rgb(engine, sketch, "colour"), expected, atol=0.012)


def test_the_share_is_one_for_all_the_terrain(any_engine, make_sketch):
    sketch = sketch_of(make_sketch)
    ends = [rgb(any_engine, sketch.with_values({"colour.share": s}), "colour") for s in (0.0, 1.0)]
    between = rgb(any_engine, sketch.with_values({"colour.share": 0.4}), "colour")
    np.testing.assert_allclose(between, 0.6 * ends[0] + 0.4 * ends[1], atol=2e-3)


def test_shadow_map_is_slope_toward_sun_at_height_map_size(engine, make_sketch):
    """A roof: its eastern side turns to the sun, its western side from it."""
    sun = np.array([90.0, 30.0])
    sketch = sketch_of(
        make_sketch, height="0.5 - abs(float(texel.x) / 8.0 - 0.5)", shadows=1.0, sun=sun.tolist(), gain=1.0
    )
    lit, unlit = (
        rgb(engine, sketch.with_values({"colour.shadows": shadows}), "colour") for shadows in (1.0, 0.0)
    )
    slope = 50.0 / 500.0  # relief 100, half of it up in half of 1000 m
    elevation = np.radians(sun[1])
    east, west = (
        (side * slope * np.cos(elevation) + np.sin(elevation)) / np.hypot(1, slope) for side in (1, -1)
    )
    np.testing.assert_allclose(lit[:, 40:], east * unlit[:, 40:], rtol=0.01)
    np.testing.assert_allclose(lit[:, :25], west * unlit[:, :25], rtol=0.01)
    assert engine.texture(sketch, "colour.shadow").size == (9, 9)


def test_images_much_finer_than_the_texture_become_their_means(any_engine, make_sketch):
    sketch = sketch_of(make_sketch, first_repeats=256, second_repeats=256, share=0.5)
    mean = sum(rgb(any_engine, sketch, name).mean(axis=(0, 1)) for name in ("one", "other")) / 2
    np.testing.assert_allclose(rgb(any_engine, sketch, "colour").mean(axis=(0, 1)), mean, atol=0.02)
    assert rgb(any_engine, sketch, "colour").std(axis=(0, 1)).max() < 0.08
