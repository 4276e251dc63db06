"""Textures keep what is written to them, in every format, row 0 in the south."""

from __future__ import annotations

import numpy as np
import pytest

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
from playground.errors import ContextError
from playground.shader.kernel import FORMATS

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
    monkeypatch.setattr("playground.engine.textures._BAND", bytes_of((5, 3), form))
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
