"""texturing/height_blend: the thesis's weights (section 2.3.2), and images of any size in their places."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from ..sketch_texts import passes

# Terrain_RemplitPerc as a table: heights where a weight begins or ends to change.
BYTES = [0, 60, 130, 180, 220, 255]
TABLE = {"grass": [1, 1, 0, 0, 0, 0], "rock": [0, 0, 1, 1, 0, 0], "snow": [0, 0, 0, 0, 1, 1]}

IMAGE = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return vec4({}); }}\n'
RAMP = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) {{ return {}; }}\n'
EASTWARD = RAMP.format("float(texel.x) / float(size.x - 1)")
IMAGES = {
    "meadow": IMAGE.format("1.0, 0.0, 0.0, 1.0"),
    "stone": IMAGE.format("0.0, 1.0, 0.0, 1.0"),
    "ice": IMAGE.format("0.0, 0.0, 1.0, 1.0"),
}
PASSES = passes(
    height="./ramp",
    meadow=("./meadow", "size = 4"),
    stone=("./stone", "size = 16"),
    ice=("./ice", "size = 1"),
    colour=(
        "texturing/height_blend",
        'inputs = {{ "grass.colour" = "meadow", "rock.colour" = "stone", "snow.colour" = "ice" }}',
        "{}",
    ),
)


def thesis(height: np.ndarray) -> np.ndarray:
    """Weights of grass, rock and snow for heights in bytes."""
    return np.stack([np.interp(height, BYTES, TABLE[name]) for name in ("grass", "rock", "snow")], axis=-1)


THRESHOLDS = "vec4(60.0, 130.0, 180.0, 220.0)"


def test_weights_are_the_thesis_s_for_every_byte_and_between(on_gpu):
    height = np.concatenate([np.arange(256.0), np.random.default_rng(5).uniform(0, 255, 2000)])
    result = on_gpu("texturing/height_weights.glsl", f"height_weights(h, {THRESHOLDS})", h=height)
    np.testing.assert_allclose(result, thesis(height), atol=1e-6)


def test_weights_sum_to_one_wherever_the_thresholds_are(on_gpu):
    random = np.random.default_rng(6)
    height, thresholds = random.uniform(0, 255, 5000), random.uniform(0, 255, (5000, 4))
    result = on_gpu("texturing/height_weights.glsl", "height_weights(h, t)", h=height, t=thresholds)
    assert result.min() >= 0
    np.testing.assert_allclose(result.sum(axis=1), 1.0, atol=1.2e-7)


def test_thresholds_that_meet_make_a_step(on_gpu):
    result = on_gpu(
        "texturing/height_weights.glsl", "height_weights(h, vec4(100.0, 100.0, 200.0, 200.0))",
        h=np.array([99.9, 100.0, 199.9, 200.0]),
    )  # fmt: skip
    np.testing.assert_array_equal(result, [[1, 0, 0], [0, 1, 0], [0, 1, 0], [0, 0, 1]])


def test_the_mixture_has_each_image_by_its_weight(engine, make_sketch):
    sketch = make_sketch(PASSES.format(""), size=[256, 4], ramp=EASTWARD, **IMAGES)
    colour = engine.read(sketch, "colour").astype(float)
    np.testing.assert_allclose(colour[2, :, :3], thesis(np.arange(256.0)), atol=6e-4)
    np.testing.assert_allclose(colour[..., :3].sum(axis=-1), 1.0, atol=1e-3)
    assert (colour[..., 3] == 1).all()


def test_its_texture_may_be_finer_or_coarser_than_the_heights(engine, make_sketch):
    for size in (511, 33):
        sketch = make_sketch(PASSES.format(f"size = {size}"), size=[256, 4], ramp=EASTWARD, **IMAGES)
        colour = engine.read(sketch, "colour").astype(float)
        assert colour.shape[:2] == (size, size)
        np.testing.assert_allclose(colour[size // 2, :, :3], thesis(np.linspace(0, 255, size)), atol=2e-3)


def test_thresholds_are_parameters(any_engine, make_sketch):
    value = "set = { grass_below = 10, rock_from = 20, rock_below = 30, snow_from = 40 }"
    sketch = make_sketch(PASSES.format(value), size=[256, 4], ramp=EASTWARD, **IMAGES)
    colour = any_engine.read(sketch, "colour").astype(float)[0, :, :3]
    assert colour[:11, 0].min() == 1
    assert colour[20:31, 1].min() == 1
    assert colour[40:, 2].min() == 1


def test_ragged_edges_stay_near_the_thresholds_and_keep_the_sum(any_engine, make_sketch):
    sketch = make_sketch(PASSES.format("set = { ragged = 20 }"), size=[256, 64], ramp=EASTWARD, **IMAGES)
    colour = any_engine.read(sketch, "colour").astype(float)[..., :3]
    np.testing.assert_allclose(colour.sum(axis=-1), 1.0, atol=1e-3)
    assert colour[:, :40, 0].min() == 1
    assert colour[:, 240:, 2].min() == 1
    assert colour[:, 95].std(axis=0).max() > 0.01


def test_heights_that_are_no_numbers_leave_the_colour_a_number(engine, make_sketch):
    nowhere = RAMP.format("texel.x > 3 ? uintBitsToFloat(0x7fc00000u) : 0.9")
    sketch = make_sketch(PASSES.format("set = { ragged = 20 }"), size=[9, 9], ramp=nowhere, **IMAGES)
    assert np.isfinite(engine.read(sketch, "colour")).all()


@pytest.mark.parametrize("repeats", [1, 4])
def test_an_image_repeats_so_often_over_the_terrain(any_engine, make_sketch, repeats):
    files = {**IMAGES, "meadow": IMAGE.format("float(texel.x >= size.x / 2)")}
    text = PASSES.format(f"set = {{ repeats = {repeats}, variety = 0 }}\nsize = [257, 5]")
    sketch = make_sketch(text, size=[257, 5], extent=[1000.0, 1000.0], ramp=RAMP.format("0.0"), **files)
    row = any_engine.read(sketch, "colour").astype(float)[2, :, 0]
    rising = np.flatnonzero((row[:-1] < 0.5) & (row[1:] >= 0.5))
    assert len(rising) == repeats
    np.testing.assert_allclose((rising + 0.5) / 256, (np.arange(repeats) + 0.5) / repeats, atol=0.3 / repeats)


def test_far_more_repeats_than_texels_give_the_image_s_mean(any_engine, make_sketch):
    files = {**IMAGES, "meadow": IMAGE.format("float(texel.x < 16)")}
    text = PASSES.format("set = { repeats = 256, variety = 0 }").replace("size = 4", "size = 64")
    sketch = make_sketch(text, size=[65, 65], ramp=RAMP.format("0.0"), **files)
    colour = any_engine.read(sketch, "colour").astype(float)[..., 0]
    np.testing.assert_allclose(colour, 0.25, atol=0.02)


def test_texels_of_the_image_are_taken_modulo_its_size(any_engine, make_sketch):
    """As section 2.3.3 has it, but that a texel of the terrain stands where four of the image meet."""
    noise = '#include "noise/hash.glsl"\n' + IMAGE.format("random(texel, 3u), random(texel, 4u), 0.5, 1.0")
    text = PASSES.replace("size = 4", "size = 8").format("set = { repeats = 8, variety = 0 }")
    sketch = make_sketch(text, size=[65, 65], ramp=RAMP.format("0.0"), **{**IMAGES, "meadow": noise})
    colour = any_engine.read(sketch, "colour").astype(float)[..., :3]
    image = any_engine.read(sketch, "meadow").astype(float)[..., :3]
    expected = np.empty_like(colour)
    for i in range(65):
        for j in range(65):
            expected[i, j] = sum(image[(i - a) % 8, (j - b) % 8] for a in (0, 1) for b in (0, 1)) / 4
    np.testing.assert_allclose(colour, expected, atol=5e-3)


def test_a_user_s_image_replaces_each_material(any_engine, make_sketch, tmp_path):
    for name, pixel in (("meadow", (255, 0, 0)), ("stone", (0, 255, 0)), ("ice", (0, 0, 255))):
        Image.new("RGB", (5, 3), pixel).save(tmp_path / f"{name}.png")
    text = PASSES.format("")
    for name in ("meadow", "stone", "ice"):
        text = text.replace(f'use = "./{name}"', f'use = "texturing/image"\nset = {{ image = "{name}.png" }}')
    colour = any_engine.read(make_sketch(text, size=[256, 4], ramp=EASTWARD), "colour").astype(float)
    np.testing.assert_allclose(colour[2, :, :3], thesis(np.arange(256.0)), atol=2e-3)


def test_its_own_images_stand_in_where_none_is_wired(any_engine, make_sketch):
    body = PASSES.format("")
    begin, end = body.index('[[pass]]\nname = "meadow"'), body.index('[[pass]]\nname = "colour"')
    own = body[:begin] + body[end:].split("inputs", maxsplit=1)[0]
    colour = any_engine.read(make_sketch(own, size=[256, 16], ramp=EASTWARD), "colour").astype(float)
    grass, rock, snow = (colour[:, a:b, :3].mean(axis=(0, 1)) for a, b in ((0, 50), (135, 175), (225, 256)))
    assert grass[1] > grass[0] > grass[2]
    assert grass.sum() < rock.sum() < snow.sum()
    inside = ("grass_tile", "grass", "rock_tile", "rock", "snow_tile", "snow", "ragged", "mix")
    assert any_engine.record.ran == ["height", *(f"colour.{name}" for name in inside)]


def test_less_detail_is_less_contrast_about_the_same_mean(engine, make_sketch):
    """Each channel's deviation from the image's own mean shrinks by the share that is asked for."""
    files = {
        **IMAGES,
        "meadow": IMAGE.format("0.1 + 0.8 * float(texel.x < 3), 0.3, 0.02 * float(texel.y), 1.0"),
    }
    text = PASSES.replace("size = 4", "size = [8, 4]")
    result = {}
    for detail in (1.0, 0.4, 0.0):
        value = text.format(f"set = {{ repeats = 4, detail = {detail} }}")
        sketch = make_sketch(value, size=[97, 97], ramp=RAMP.format("0.0"), **files)
        result[detail] = engine.read(sketch, "colour").astype(float)[..., :3]
    mean = np.array([0.1 + 0.8 * 3 / 8, 0.3, 0.02 * 1.5])
    np.testing.assert_allclose(result[0.0], np.broadcast_to(mean, (97, 97, 3)), atol=5e-4)
    np.testing.assert_allclose(result[0.4] - mean, 0.4 * (result[1.0] - mean), atol=1e-3)
    assert result[1.0].std(axis=(0, 1)).max() > 0.2
