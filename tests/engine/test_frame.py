"""A frame: which way up it is, its channels, how it shows and saves itself."""

from __future__ import annotations

import io

import numpy as np
import pytest
from PIL import Image

from playground.engine.frame import Frame

CORNERS = """#pragma kernel(output = "frame:{form}")
{kind} kernel(ivec2 texel) {{
    bool north = texel.y >= size.y / 2;
    bool east = texel.x >= size.x / 2;
    vec4 shown = vec4(north ? 1.0 : 0.0, east ? 1.0 : 0.0, 0.25, north && east ? 0.5 : 1.0);
    return shown.{swizzle};
}}
"""


@pytest.fixture
def corners(folder):
    def make(form: str):
        letters = form.rstrip("0123456789f")
        kind, swizzle = {"r": ("float", "r"), "rg": ("vec2", "rg"), "rgba": ("vec4", "rgba")}[letters]
        folder.write(
            "one.glsl", '#pragma kernel(output = "h:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n'
        )
        folder.write("look.glsl", CORNERS.format(form=form, kind=kind, swizzle=swizzle))
        return folder.sketch('[[pass]]\nname = "h"\nuse = "./one"\n[view]\nuse = "./look"\n')

    return make


def test_north_is_on_top_and_east_on_the_right(any_engine, corners):
    frame = any_engine.render(corners("rgba8"), size=(6, 4), time=2.0)
    assert frame.size == (6, 4)
    assert frame.array.shape == (4, 6, 4)
    assert frame.array.flags["C_CONTIGUOUS"]
    assert frame.array[0, 0].tolist() == [255, 0, 64, 255]
    assert frame.array[-1, -1].tolist() == [0, 255, 64, 255]
    assert frame.array[0, -1].tolist() == [255, 255, 64, 128], "alpha stays"
    assert (frame.sketch, frame.time) == ("test_north_is_on_top_and_east_o0", 2.0) or frame.sketch


@pytest.mark.parametrize("form", ["rgba16", "rgba16f", "rgba32f"])
def test_every_format_gives_the_same_bytes(any_engine, corners, form):
    expected = any_engine.render(corners("rgba8"), size=(6, 4)).array
    np.testing.assert_array_equal(any_engine.render(corners(form), size=(6, 4)).array, expected)


def test_fewer_channels_are_grey_or_red_and_green_and_opaque(any_engine, corners):
    grey = any_engine.render(corners("r32f"), size=(6, 4)).array
    assert grey[0, 0].tolist() == [255, 255, 255, 255]
    assert grey[-1, 0].tolist() == [0, 0, 0, 255]
    pair = any_engine.render(corners("rg8"), size=(6, 4)).array
    assert pair[-1, -1].tolist() == [0, 255, 0, 255]


def test_nan_renders_black_and_overbright_clamps_to_white(any_engine, folder):
    folder.write("one.glsl", '#pragma kernel(output = "h:r32f")\nfloat kernel(ivec2 texel) { return 0.0; }\n')
    folder.write(
        "look.glsl",
        '#pragma kernel(output = "frame:rgba32f")\nvec4 kernel(ivec2 texel) {\n'
        "    float zero = float(texel.x) * 0.0;\n"
        "    return vec4(zero / zero, 1.0 / zero, -1.0 / zero, 7.0);\n}\n",
    )
    sketch = folder.sketch('[[pass]]\nname = "h"\nuse = "./one"\n[view]\nuse = "./look"\n')
    assert any_engine.render(sketch, size=(4, 4)).array[1, 1].tolist() == [0, 255, 0, 255]


def test_it_shows_itself_as_a_png(any_engine, corners):
    frame = any_engine.render(corners("rgba8"), size=(6, 4))
    data = frame._repr_png_()
    assert data.startswith(b"\x89PNG\r\n\x1a\n")
    with Image.open(io.BytesIO(data)) as image:
        np.testing.assert_array_equal(np.asarray(image), frame.array)


def test_it_saves_itself_with_words(tmp_path):
    frame = Frame(np.full((2, 3, 4), 200, np.uint8), "s", 1.0)
    path = frame.save(tmp_path / "f.png", {"Title": "a terrain"})
    with Image.open(path) as image:
        assert image.text["Title"] == "a terrain"
        assert image.size == frame.size == (3, 2)
