"""Make, fill and read textures in the formats a kernel may write.

Arrays have row 0 in the south, as textures have.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.errors import ContextError

if TYPE_CHECKING:
    import moderngl

_DTYPES = {"8": "f1", "16": "nu2", "16f": "f2", "32f": "f4"}
_NUMPY = {"f1": np.dtype("u1"), "nu2": np.dtype("u2"), "f2": np.dtype("f2"), "f4": np.dtype("f4")}
_BYTES = {"f1": 1, "nu2": 2, "f2": 2, "f4": 4}


def split_format(form: str) -> tuple[int, str]:
    """Return (components, moderngl dtype) of a format, as "rgba16f"."""
    letters = form.rstrip("0123456789f")
    return len(letters), _DTYPES[form[len(letters) :]]


def bytes_of(size: tuple[int, int], form: str) -> int:
    """Return the bytes that a texture takes, without mipmaps."""
    components, dtype = split_format(form)
    return size[0] * size[1] * components * _BYTES[dtype]


def make_texture(ctx: moderngl.Context, size: tuple[int, int], form: str) -> moderngl.Texture:
    """Make a texture with undefined texels; raise ``ContextError`` where the driver refuses its size."""
    components, dtype = split_format(form)
    limit = int(ctx.info["GL_MAX_TEXTURE_SIZE"])
    if max(size) > limit:
        raise ContextError(f"a texture of {size[0]} x {size[1]} texels; this driver takes no more than {limit} a side")
    _ = ctx.error
    texture = ctx.texture(size, components, dtype=dtype)
    fault = ctx.error
    if fault != "GL_NO_ERROR":
        texture.release()
        megabytes = bytes_of(size, form) / 2**20
        raise ContextError(f"the driver refused a texture of {size[0]} x {size[1]} {form} ({megabytes:.0f} MiB): {fault}")
    return texture


def make_framebuffer(
    ctx: moderngl.Context,
    attachments: Sequence[moderngl.Texture | moderngl.Renderbuffer],
    depth: moderngl.Renderbuffer | None = None,
) -> moderngl.Framebuffer:
    """Make a framebuffer; raise ``ContextError`` where an OpenGL error stood before.

    moderngl 5.13 asks Mesa about attachments that are not there, which leaves
    GL_INVALID_OPERATION behind; it is taken away here, so that a real error shows.
    """
    before = ctx.error
    if before != "GL_NO_ERROR":
        raise ContextError(f"OpenGL reports {before}")
    framebuffer = ctx.framebuffer(list(attachments), depth)
    _ = ctx.error
    return framebuffer


def clear_texture(ctx: moderngl.Context, texture: moderngl.Texture) -> None:
    """Fill a texture with zeros."""
    framebuffer = make_framebuffer(ctx, [texture])
    framebuffer.use()  # clear() binds anew what was bound before, which may have been released by now
    framebuffer.clear()
    framebuffer.release()


def write_texture(texture: moderngl.Texture, values: NDArray[np.floating | np.uint8]) -> None:
    """Write an array, (ny, nx) or (ny, nx, components), row 0 south; 0..1 floats or bytes into r8 formats."""
    wanted = _NUMPY[texture.dtype]
    if wanted.kind == "u" and values.dtype.kind == "f":
        top = np.iinfo(wanted).max
        values = np.round(np.clip(values, 0, 1) * top)
    texture.write(np.ascontiguousarray(values, dtype=wanted).tobytes(), alignment=1)


def read_texture(texture: moderngl.Texture) -> NDArray[np.float32]:
    """Read a texture as float32, (ny, nx) or (ny, nx, components), row 0 south; r8 and r16 formats give 0..1."""
    raw = np.frombuffer(texture.read(alignment=1), dtype=_NUMPY[texture.dtype])
    width, height = texture.size
    shape = (height, width) if texture.components == 1 else (height, width, texture.components)
    values = raw.reshape(shape).astype(np.float32)
    if raw.dtype.kind == "u":
        values /= np.float32(np.iinfo(raw.dtype).max)
    return values
