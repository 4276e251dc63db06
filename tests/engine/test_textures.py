"""Textures keep what is written to them; frames show them, pools reuse them, samplers filter them."""

from __future__ import annotations

import io

import moderngl
import numpy as np
import pytest
from PIL import Image

from playground.engine.binder import Binder
from playground.engine.frame import Frame
from playground.engine.results import Pool, Swap
from playground.engine.software import Software
from playground.engine.textures import (
    bytes_of,
    drain,
    make_framebuffer,
    make_texture,
    read_bands,
    read_picture,
    read_raw,
    read_texture,
    release_framebuffer,
    split_format,
    write_texture,
)
from playground.engine.tuning import Tuning
from playground.errors import ContextError
from playground.shader.kernel import FORMATS
from playground.shader.parameter import Sampling
from playground.sketch.model import Output

from ..cases import each

STEP = {"8": 1 / 255, "16": 1 / 65535, "16f": 2**-11, "32f": 0.0}


@each("size", [(1, 1), (3, 5), (17, 4)])
@each("form", FORMATS)
def test_what_is_written_is_read(ctx, form, size):
    components, _ = split_format(form)
    texture = make_texture(ctx, size, form)
    shape = (size[1], size[0]) if components == 1 else (size[1], size[0], components)
    values = np.random.default_rng(1).random(shape).astype(np.float32)
    write_texture(texture, values)
    array = read_texture(texture)
    assert array.dtype == np.float32
    assert array.shape == shape
    bits = form.lstrip("rgba")
    np.testing.assert_allclose(array, values, atol=STEP[bits] * 0.51)
    assert (
        bytes_of(size, form) == size[0] * size[1] * components * {"8": 1, "16": 2, "16f": 2, "32f": 4}[bits]
    )
    assert texture.size == size
    texture.release()


@each("form", FORMATS)
def test_large_texture_round_trips_in_bands_bit_for_bit(ctx, form, monkeypatch):
    components, _ = split_format(form)
    shape = (7, 5) if components == 1 else (7, 5, components)
    values = np.random.default_rng(2).random(shape).astype(np.float32)
    whole, parts = make_texture(ctx, (5, 7), form), make_texture(ctx, (5, 7), form)
    write_texture(whole, values)
    monkeypatch.setattr("playground.engine.textures.BAND", bytes_of((5, 3), form))
    write_texture(parts, values)
    bands = list(read_bands(parts))
    assert [south for south, _ in bands] == [0, 3, 6]
    np.testing.assert_array_equal(np.concatenate([band for _, band in bands]), read_raw(whole))
    whole.release()
    parts.release()


def test_the_first_row_is_the_south_and_a_picture_s_the_north(ctx):
    texture = make_texture(ctx, (2, 3), "r32f")
    write_texture(texture, np.array([[0.0, 0.0], [0.5, 0.5], [1.0, 1.0]]))
    assert read_texture(texture)[0, 0] == 0.0
    assert read_picture(texture)[:, 0, 0].tolist() == [255, 128, 0]
    framebuffer = make_framebuffer(ctx, [texture])
    below = np.frombuffer(framebuffer.read(viewport=(0, 0, 1, 1), components=1, dtype="f4"), "f4")
    assert below[0] == 0.0, "OpenGL counts rows from the south as well"
    framebuffer.release()
    texture.release()


@pytest.mark.parametrize("form", ["r8", "r16", "r16f", "r32f"])
def test_numbers_that_do_not_fit_are_clamped(ctx, form):
    texture = make_texture(ctx, (4, 1), form)
    write_texture(texture, np.array([[-1.0, 2.0, 1e6, 1e-30]], np.float32))
    result = read_texture(texture)[0]
    expected = {"r16f": [-1, 2, 65504, 0], "r32f": [-1, 2, 1e6, 1e-30]}.get(form, [0, 1, 1, 0])
    np.testing.assert_allclose(result, np.array(expected, np.float32), rtol=1e-6)
    texture.release()


def test_nan_becomes_zero_in_formats_without_nan(ctx):
    for form, keeps_nan in (("r8", False), ("r16", False), ("r16f", True), ("r32f", True)):
        texture = make_texture(ctx, (1, 1), form)
        write_texture(texture, np.array([[np.nan]]))
        assert np.isnan(read_texture(texture)[0, 0]) == keeps_nan
        assert read_picture(texture)[0, 0].tolist() == [0, 0, 0, 255]
        texture.release()


def test_whole_numbers_are_written_as_they_are(ctx):
    texture = make_texture(ctx, (2, 1), "r16")
    write_texture(texture, np.array([[258, 65535]], np.uint16))
    np.testing.assert_allclose(read_texture(texture)[0] * 65535, [258, 65535])
    texture.release()


def test_one_that_the_driver_cannot_hold_is_a_sentence(ctx):
    limit = int(ctx.info["GL_MAX_TEXTURE_SIZE"])
    with pytest.raises(ContextError, match=f"no more than {limit} a side"):
        make_texture(ctx, (limit + 1, 1), "r8")


def test_one_that_the_driver_refuses_is_a_sentence(ctx, monkeypatch):
    """moderngl hands out an object even then; only the error flag tells."""
    monkeypatch.setitem(ctx.info, "GL_MAX_TEXTURE_SIZE", 2**20)
    with pytest.raises(ContextError, match=r"refused a texture of \d+ x 1 r8 .*GL_"):
        make_texture(ctx, (2**19, 1), "r8")
    assert ctx.error == "GL_NO_ERROR"


def test_a_framebuffer_leaves_no_error_behind(ctx):
    texture = make_texture(ctx, (4, 4), "rgba16f")
    framebuffer = make_framebuffer(ctx, [texture])
    assert ctx.error == "GL_NO_ERROR"
    framebuffer.release()
    texture.release()


def test_drain_forgets_an_error(ctx):
    ctx.enable_direct(0x1234)
    drain(ctx)
    assert ctx.error == "GL_NO_ERROR"


def test_a_released_framebuffer_breaks_no_later_read(ctx):
    first, second = (make_texture(ctx, (2, 2), "rgba8", bytes(range(16))) for _ in range(2))
    framebuffer = make_framebuffer(ctx, [first])
    framebuffer.use()
    release_framebuffer(framebuffer)
    np.testing.assert_array_equal(read_raw(second).ravel(), np.arange(16))
    assert ctx.error == "GL_NO_ERROR"


# ── A frame: which way up it is, its channels, how it shows and saves itself ─


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


# ── How textures are filtered: along slanted ground by a graphics card, plainly where the processor


@pytest.mark.parametrize(
    ("software", "sampling", "expected"),
    [
        (False, Sampling("linear", "repeat", True), 8.0),
        (False, Sampling("linear", "repeat", False), 1.0),
        (False, Sampling("nearest", "clamp", True), 1.0),
        (True, Sampling("linear", "repeat", True), 1.0),
    ],
)
def test_anisotropy_is_for_mipmaps_on_a_graphics_card(ctx, software, sampling, expected):
    binder = Binder(ctx, Software(ctx) if software else Tuning())
    try:
        assert binder.new_sampler(sampling).anisotropy == min(expected, ctx.max_anisotropy)
    finally:
        binder.release()


# ── Textures are used again; where a pool clears, what they held is gone ─────


@pytest.mark.parametrize("clears", [False, True])
def test_a_pool_that_clears_gives_zeros_for_what_was_full(ctx: moderngl.Context, clears: bool):
    outputs = (Output("height", "r32f"), Output("colour", "rgba16f"))
    pool = Pool(ctx, 2**20)
    pool.clears = clears
    first = pool.take((5, 3), outputs)
    first.framebuffer(ctx).use()
    first.framebuffer(ctx).clear(1.0, 1.0, 1.0, 1.0)
    pool.give(first)
    again = pool.take((5, 3), outputs)
    assert pool.made == 1 and again.textures["height"] is first.textures["height"]
    result = {name: texture.read() for name, texture in again.textures.items()}
    full = np.ones(15, np.float32).tobytes(), np.ones(60, np.float16).tobytes()
    expected = (bytes(60), bytes(120)) if clears else full  # without clearing, it is as it was left
    assert (result["height"], result["colour"]) == expected
    again.release()


def test_a_repeat_that_fails_gives_all_its_textures_back(ctx: moderngl.Context):
    outputs, pool = (Output("height", "r32f"),), Pool(ctx, 2**20)
    with pytest.raises(ZeroDivisionError), Swap(pool, (5, 3), outputs, pool.take((5, 3), outputs)) as swap:
        for iteration in range(3):
            swap.target()
            if iteration == 2:
                raise ZeroDivisionError
            swap.advance()
    assert len(pool) == pool.made
    with Swap(pool, (5, 3), outputs, None) as swap:
        for _ in range(3):
            swap.target()
            swap.advance()
    assert swap.before is not None and len(pool) == pool.made - 1
    pool.give(swap.before)
    pool.clear()
