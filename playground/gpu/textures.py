"""Make, fill and read textures in the formats a kernel may write.

Arrays have row 0 in the south, as textures have. Only what makes an object asks OpenGL for
errors: asking waits for the driver, so it stays out of what happens every frame.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import ContextError

if TYPE_CHECKING:
    import moderngl

_DTYPES = {"8": "f1", "16": "nu2", "16f": "f2", "32f": "f4"}
_NUMPY: dict[str, np.dtype[Any]] = {
    "f1": np.dtype("u1"),
    "nu2": np.dtype("u2"),
    "f2": np.dtype("f2"),
    "f4": np.dtype("f4"),
}
_LARGEST_HALF = 65504.0
_BAND = 2**26  # [bytes] of a texture that is read, or of numbers that are written, at once


@cache
def split_format(form: str) -> tuple[int, str]:
    """Return (components, moderngl dtype) of a format, as "rgba16f"."""
    letters = form.rstrip("0123456789f")
    return len(letters), _DTYPES[form[len(letters) :]]


@cache
def bytes_of(size: tuple[int, int], form: str) -> int:
    """Return the bytes that a texture takes, without mipmaps."""
    components, dtype = split_format(form)
    return size[0] * size[1] * components * _NUMPY[dtype].itemsize


def levels_of(size: tuple[int, int]) -> list[tuple[int, int]]:
    """Return the sizes of a texture's mipmaps, from itself down to one texel."""
    return [(max(size[0] >> k, 1), max(size[1] >> k, 1)) for k in range(max(size).bit_length())]


def make_texture(
    ctx: moderngl.Context, size: tuple[int, int], form: str, data: bytes | None = None
) -> moderngl.Texture:
    """Make a texture, its texels undefined without ``data``.

    Raises ``ContextError`` where the driver refuses its size: moderngl returns an object even then.
    """
    components, dtype = split_format(form)
    check_size(ctx, size, "a texture")
    drain(ctx)
    texture = ctx.texture(size, components, data, alignment=1, dtype=dtype)
    error = ctx.error
    if error != "GL_NO_ERROR":
        texture.release()
        megabytes = bytes_of(size, form) / 2**20
        raise ContextError(
            f"the driver refused a texture of {size[0]} x {size[1]} {form} ({megabytes:.0f} MiB): {error}"
        )
    return texture


def check_size(ctx: moderngl.Context, size: tuple[int, int], what: str) -> None:
    """Raise ``ContextError`` where a side is larger than this driver takes."""
    limit = int(ctx.info["GL_MAX_TEXTURE_SIZE"])
    if max(size) > limit:
        raise ContextError(
            f"{what} of {size[0]} x {size[1]} texels; this driver takes no more than {limit} a side"
        )


def make_framebuffer(
    ctx: moderngl.Context,
    attachments: Sequence[moderngl.Texture | moderngl.Renderbuffer],
    depth: moderngl.Renderbuffer | None = None,
) -> moderngl.Framebuffer:
    """Make a framebuffer that draws to textures or renderbuffers of one size.

    moderngl 5.13 asks Mesa about attachments that are not there, which leaves
    GL_INVALID_OPERATION behind; it is taken away here, so that a real error shows.
    """
    framebuffer = ctx.framebuffer(list(attachments), depth)
    drain(ctx)
    return framebuffer


def release_framebuffer(framebuffer: moderngl.Framebuffer) -> None:
    """Release a framebuffer; one that is bound is unbound first.

    moderngl binds again what is bound after each read, and a released name is GL_INVALID_OPERATION.
    """
    ctx = framebuffer.ctx
    if ctx.fbo is framebuffer:
        ctx.detect_framebuffer(0).use()
    framebuffer.release()


def drain(ctx: moderngl.Context) -> None:
    """Discard pending OpenGL errors."""
    for _ in range(8):  # one flag for each kind of error; a lost context answers forever
        if ctx.error == "GL_NO_ERROR":
            return


def is_lost(ctx: moderngl.Context) -> bool:
    """Return whether a context answers everything with an error, as one does after its driver was reset."""
    drain(ctx)
    return bool(ctx.error != "GL_NO_ERROR")


def write_texture(texture: moderngl.Texture, values: NDArray[Any]) -> None:
    """Write an array, (ny, nx) or (ny, nx, components), row 0 south.

    r8 and r16 formats take 0..1, or whole numbers of their own kind; what is not a number
    becomes 0 there. Half floats stop at their largest.
    """
    wanted = _NUMPY[texture.dtype]
    width, height = texture.size
    rows = max(_BAND // (width * texture.components * wanted.itemsize), 1)
    if len(values) != height or rows >= height:
        texture.write(texel_bytes(values, wanted), alignment=1)
        return
    for south in range(0, height, rows):  # copies of all of a large one would be as large
        write_texels(texture, (0, south), values[south : south + rows])


def write_texels(texture: moderngl.Texture, corner: tuple[int, int], values: NDArray[Any]) -> None:
    """Write a block of texels, as ``write_texture`` writes all; ``corner`` is its south-west texel."""
    block = (*corner, values.shape[1], values.shape[0])
    texture.write(texel_bytes(values, _NUMPY[texture.dtype]), viewport=block, alignment=1)


def texels_in(form: str, values: NDArray[Any]) -> bytes:
    """Return the texels of an array in a format such as ``rg16f``: what ``write_texture`` uploads."""
    return texel_bytes(values, _NUMPY[split_format(form)[1]])


def texel_bytes(values: NDArray[Any], wanted: np.dtype[Any]) -> bytes:
    """Return an array's numbers as a texture of a kind of number holds them: see ``write_texture``."""
    if values.dtype.kind == "f":
        if wanted.kind == "u":
            top = np.iinfo(wanted).max
            values = np.round(np.clip(np.nan_to_num(values, nan=0.0), 0, 1) * top)
        elif wanted == np.float16:
            values = np.clip(values, -_LARGEST_HALF, _LARGEST_HALF)
    with np.errstate(under="ignore"):
        return np.ascontiguousarray(values.astype(wanted, copy=False)).tobytes()


def read_texture(texture: moderngl.Texture) -> NDArray[np.float32]:
    """Read a texture as float32, (ny, nx) or (ny, nx, components), row 0 south.

    r8 and r16 formats give 0..1.
    """
    return _as_floats(read_raw(texture))


def _as_floats(raw: NDArray[Any]) -> NDArray[np.float32]:
    """Return a copy as float32; of whole numbers, as parts of their largest."""
    values = np.array(raw, np.float32)
    if raw.dtype.kind == "u":
        values /= np.float32(np.iinfo(raw.dtype).max)
    return values


def read_texels(
    texture: moderngl.Texture, corner: tuple[int, int], size: tuple[int, int]
) -> NDArray[np.float32]:
    """Read a block of texels as float32, (ny, nx, components), row 0 south: what ``read_texture`` has there.

    ``corner``: the south-west texel of the block, which must lie inside the texture.
    """
    raw: NDArray[Any] = np.frombuffer(read_block(texture, corner, size), _NUMPY[texture.dtype])
    return _as_floats(raw).reshape(size[1], size[0], texture.components)


def read_block(texture: moderngl.Texture, corner: tuple[int, int], size: tuple[int, int]) -> bytes:
    """Read a block of texels as bytes in the texture's own kind of number; arguments as ``read_texels``."""
    framebuffer = make_framebuffer(texture.ctx, [texture])
    try:
        return framebuffer.read((*corner, *size), texture.components, alignment=1, dtype=texture.dtype)
    finally:
        framebuffer.release()


def read_bands(texture: moderngl.Texture) -> Iterator[tuple[int, NDArray[Any]]]:
    """Yield a texture's rows as ``read_raw`` has them, with the number of the first of each band.

    A texture of up to ``_BAND`` bytes is one band.
    """
    width, height = texture.size
    dtype, components = _NUMPY[texture.dtype], texture.components
    rows = max(_BAND // (width * components * dtype.itemsize), 1)
    if rows >= height:
        yield 0, read_raw(texture)
        return
    for south in range(0, height, rows):
        high = min(rows, height - south)
        raw: NDArray[Any] = np.frombuffer(read_block(texture, (0, south), (width, high)), dtype)
        yield south, raw.reshape((high, width) if components == 1 else (high, width, components))


def read_picture(texture: moderngl.Texture) -> NDArray[np.uint8]:
    """Read a texture as a picture, (height, width, 4) bytes, top row first.

    One channel becomes grey, two red and green; without a fourth it is opaque. Numbers are
    clamped to 0..1; what is not a number becomes 0.
    """
    if texture.dtype == "f1" and texture.components == 4:
        return np.ascontiguousarray(read_raw(texture)[::-1])
    values = read_texture(texture)[::-1]
    height, width = values.shape[:2]
    picture = np.zeros((height, width, 4), np.uint8)
    picture[..., 3] = 255
    tidy = np.clip(np.nan_to_num(values, nan=0.0), 0, 1)
    shown = np.round(tidy * np.float32(255)).astype(np.uint8)
    if shown.ndim == 2:
        picture[..., :3] = shown[..., None]
    else:
        picture[..., : shown.shape[2]] = shown
    return picture


def read_raw(texture: moderngl.Texture) -> NDArray[Any]:
    """Read a texture in its own kind of number, (ny, nx) or (ny, nx, components), row 0 south; read-only."""
    width, height = texture.size
    shape = (height, width) if texture.components == 1 else (height, width, texture.components)
    array: NDArray[Any] = np.frombuffer(texture.read(alignment=1), dtype=_NUMPY[texture.dtype])
    return array.reshape(shape)
