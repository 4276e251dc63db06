"""texturing/image and texturing/drape: files decoded to linear light, laid as tiles or over the terrain."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from playground.errors import DataError
from playground.shader.colours import srgb_to_linear

PLAIN = '#pragma kernel(output = "colour:rgba16f")\nvec4 kernel(ivec2 texel) {{ return vec4({}, 1.0); }}\n'
EASTWARD = PLAIN.format("vec3(float(texel.x) / float(size.x - 1))")


@pytest.fixture
def picture(tmp_path):
    """Give ``picture(pixels, name)``: rows from the north, 8 bits, written where sketches look."""

    def write(pixels, name="photo.png", **more):
        Image.fromarray(np.asarray(pixels, np.uint8)).save(tmp_path / name, **more)
        return name

    return write


def use(technique, value, more=""):
    return f'[[pass]]\nname = "c"\nuse = "texturing/{technique}"\nset = {{ {value} }}\n{more}'


def rgb(engine, sketch, name="c"):
    return engine.read(sketch, name).astype(float)[..., :3]


def test_native_size_tile_returns_decoded_image_texels(engine, make_sketch, picture):
    pixels = np.random.default_rng(4).integers(0, 256, (6, 10, 3))
    sketch = make_sketch(use("image", f'image = "{picture(pixels)}"'), size=[10, 6])
    # The software renderer decodes by a polynomial, off by up to 0.0015: less than half a level of the file.
    np.testing.assert_allclose(rgb(engine, sketch), srgb_to_linear(pixels / 255)[::-1], rtol=0, atol=2e-3)


@pytest.mark.parametrize("name", ["a.jpg", "a.webp", "a.png"])
def test_every_kind_of_file_gives_its_colours(any_engine, make_sketch, picture, tmp_path, name):
    smooth = np.add.outer(np.linspace(20, 200, 16), np.linspace(0, 40, 16))
    pixels = np.stack([smooth, smooth[::-1], np.full((16, 16), 128.0)], axis=-1)
    sketch = make_sketch(use("image", f'image = "{picture(pixels, name)}"'), size=16)
    colour = rgb(any_engine, sketch)
    with Image.open(tmp_path / name) as kept:
        expected = srgb_to_linear(np.asarray(kept.convert("RGB")) / 255)[::-1]
    np.testing.assert_allclose(colour, expected, atol=2e-3)
    np.testing.assert_allclose(
        colour.mean(axis=(0, 1)), srgb_to_linear(pixels / 255).mean(axis=(0, 1)), atol=0.01
    )


@pytest.mark.parametrize("fit", ["tile", "land"])
def test_a_finer_image_is_averaged_in_linear_light(engine, make_sketch, picture, fit):
    """Black and white in turn are half the light, not the light of a middle grey."""
    pixels = np.zeros((64, 64, 3))
    pixels[::2, ::2] = pixels[1::2, 1::2] = 255
    sketch = make_sketch(use("image", f'image = "{picture(pixels)}", fit = "{fit}"'), size=9)
    np.testing.assert_allclose(rgb(engine, sketch), 0.5, atol=0.01)


def test_draped_image_meets_terrain_corners_without_edge_wrap(engine, make_sketch, picture):
    pixels = np.zeros((32, 32, 3))
    pixels[:16, :16, 0] = pixels[:16, 16:, 1] = pixels[16:, :16, 2] = 255  # red in the north-west
    sketch = make_sketch(use("drape", f'image = "{picture(pixels)}"'), size=65)
    colour = rgb(engine, sketch)
    for (row, column), expected in {
        (64, 0): [1, 0, 0], (64, 64): [0, 1, 0], (0, 0): [0, 0, 1], (0, 64): [0, 0, 0],
    }.items():  # fmt: skip
        np.testing.assert_allclose(colour[row, column], expected, atol=1e-3)
    middle = (colour[32, :31].mean(axis=0), colour[32, 33:].mean(axis=0))
    np.testing.assert_allclose(middle, [[0.5, 0, 0.5], [0, 0.5, 0]], atol=1e-2)


def test_a_tile_meets_its_own_copy(any_engine, make_sketch, picture):
    """Enlarged, the texels next to the edges are mixed of both edges, as in the middle of a repeat."""
    pixels = np.random.default_rng(7).integers(0, 256, (4, 4, 3))
    sketch = make_sketch(use("image", f'image = "{picture(pixels)}"'), size=16)
    colour = rgb(any_engine, sketch)
    source = srgb_to_linear(pixels / 255)[::-1]
    between = (np.arange(16) + 0.5) / 4 - 0.5
    low, part = np.floor(between).astype(int), between - np.floor(between)

    def along(values, axis):
        first, second = values.take(low % 4, axis), values.take((low + 1) % 4, axis)
        share = part.reshape((-1, 1, 1) if axis == 0 else (1, -1, 1))
        return first * (1 - share) + second * share

    np.testing.assert_allclose(colour, along(along(source, 0), 1), atol=5e-3)


def test_pass_replacing_image_keeps_its_bits_at_own_size(engine, make_sketch):
    text = '[[pass]]\nname = "photo"\nuse = "./photo"\n' + use(
        "drape", "", 'inputs = { "laid.colour" = "photo" }\n'
    )
    sketch = make_sketch(text, size=33, photo=EASTWARD)
    np.testing.assert_array_equal(engine.read(sketch, "c"), engine.read(sketch, "photo"))
    assert "c.image" not in engine.record.ran, "a file that nobody reads is not read"


def test_a_pass_of_another_size_is_stretched_corner_to_corner(engine, make_sketch):
    first = '[[pass]]\nname = "photo"\nuse = "./photo"\nsize = 9\n'
    text = first + use("drape", "", 'inputs = { "laid.colour" = "photo" }\n')
    colour = rgb(engine, make_sketch(text, size=65, photo=EASTWARD))
    np.testing.assert_allclose(colour[30, :, 0], np.linspace(0, 1, 65), atol=4e-3)


def test_a_file_that_is_not_there_is_named(any_engine, make_sketch):
    sketch = make_sketch(use("drape", 'image = "nowhere.png"'), size=9)
    with pytest.raises(DataError, match=r"nowhere\.png.*there is no such file"):
        any_engine.read(sketch, "c")


def test_the_shipped_picture_is_read_by_default(any_engine, make_sketch):
    colour = rgb(any_engine, make_sketch('[[pass]]\nname = "c"\nuse = "texturing/drape"\n', size=65))
    assert colour.std() > 0.03
    # Snow lies in the south, a third of the way from the west; the valley in the east is green.
    assert colour[15:25, 52:62, 1].mean() > colour[15:25, 52:62, 0].mean()
