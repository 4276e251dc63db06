"""Textures in the formats that a kernel may write: made, filled, read, copied to other shapes.

Arrays have row 0 in the south, as textures have. Only what makes an object asks OpenGL for
errors: asking waits for the driver, so it stays out of what happens every frame.

A result has two dimensions. A cube's lies in N x 6N texels, its faces from the bottom in OpenGL's order, +X
-X +Y -Y +Z -Z, each as OpenGL has it: row 0 of a face is its coordinate t = 0. A volume of N slices lies in
N x N*N, an array of square layers of n in N x n*N, each above the one before; a line is row 0.

The copies stay on the graphics card, by way of a pixel buffer. moderngl has no textures of one dimension:
those are OpenGL's own.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.gl_calls import Calls
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
_MAX_HALF = 65504.0
BAND = 2**26  # [bytes] of a texture that is read, or of numbers that are written, at once


def split_format(form: str) -> tuple[int, str]:
    """Return (components, moderngl dtype) of a format, as "rgba16f"."""
    letters = form.rstrip("0123456789f")
    return len(letters), _DTYPES[form[len(letters) :]]


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
    dtype = _NUMPY[texture.dtype]
    width, height = texture.size
    rows = max(BAND // (width * texture.components * dtype.itemsize), 1)
    if len(values) != height or rows >= height:
        texture.write(texel_bytes(values, dtype), alignment=1)
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


def texel_bytes(values: NDArray[Any], dtype: np.dtype[Any]) -> bytes:
    """Return an array's numbers as a texture of a kind of number holds them: see ``write_texture``."""
    if values.dtype.kind == "f":
        if dtype.kind == "u":
            top = np.iinfo(dtype).max
            values = np.round(np.clip(np.nan_to_num(values, nan=0.0), 0, 1) * top)
        elif dtype == np.float16:
            values = np.clip(values, -_MAX_HALF, _MAX_HALF)
    with np.errstate(under="ignore"):
        return np.ascontiguousarray(values.astype(dtype, copy=False)).tobytes()


def floats_in(form: str, texels: bytes) -> NDArray[np.float32]:
    """Return the numbers in texels of a format such as ``rg16f``, as ``read_texture`` has them."""
    raw: NDArray[Any] = np.frombuffer(texels, _NUMPY[split_format(form)[1]])
    return _as_floats(raw)


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

    A texture of up to ``BAND`` bytes is one band.
    """
    width, height = texture.size
    dtype, components = _NUMPY[texture.dtype], texture.components
    rows = max(BAND // (width * components * dtype.itemsize), 1)
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


FACES = 6
_SEAMLESS = 0x884F  # GL_TEXTURE_CUBE_MAP_SEAMLESS
_TEXTURE_1D = 0x0DE0
_LETTERS = {1: "r", 2: "rg", 4: "rgba"}
_BITS = {"f1": "8", "nu2": "16", "f2": "16f", "f4": "32f"}
_LAYOUT = {1: 0x1903, 2: 0x8227, 4: 0x1908}  # GL_RED GL_RG GL_RGBA
_INTERNAL = {  # the sized formats of OpenGL, by components and moderngl's dtype
    (1, "f1"): 0x8229, (2, "f1"): 0x822B, (4, "f1"): 0x8058,
    (1, "nu2"): 0x822A, (2, "nu2"): 0x822C, (4, "nu2"): 0x805B,
    (1, "f2"): 0x822D, (2, "f2"): 0x822F, (4, "f2"): 0x881A,
    (1, "f4"): 0x822E, (2, "f4"): 0x8230, (4, "f4"): 0x8814,
}  # fmt: skip


def misfit(shape: str, size: tuple[int, int]) -> str:
    """Return what size a texture of a shape should have, "" where ``size`` is one."""
    width, height = size
    if shape == "cube" and height != FACES * width:
        return f"a cube map is six faces above each other, 1 : 6, as {width} x {FACES * width}"
    if shape == "volume" and height != width * width:
        return f"a volume of n texels a side is n slices above each other, as {width} x {width * width}"
    if shape == "layers" and height % width:
        return f"an array is square layers above each other, as {width} x {max(height // width, 1) * width}"
    return ""


def shaped_size(shape: str, size: tuple[int, int]) -> tuple[int, int, int]:
    """Return a shape's own size in texels, by the size of the texture that it is copied from."""
    width, height = size
    deep = {"volume": width, "layers": height // width}
    return (width, 1 if shape == "line" else width, deep.get(shape, 1)) if shape else (width, height, 1)


def copied(ctx: moderngl.Context, shape: str, texture: moderngl.Texture) -> Shaped:
    """Return a copy of a texture in another shape, without mipmaps, which is the caller's.

    Raises ``ContextError`` where the size does not fit the shape, or is more than this driver takes.
    """
    if wrong := misfit(shape, texture.size):
        raise ContextError(f"a texture of {texture.width} x {texture.height} texels; {wrong}")
    _check_largest(ctx, shape, shaped_size(shape, texture.size))
    drain(ctx)
    if shape == "line":
        made: Any = _Line(ctx, texture)
    elif shape == "cube":
        ctx.enable_direct(_SEAMLESS)
        made = _cube(ctx, texture)
    else:
        size = shaped_size(shape, texture.size)
        make = ctx.texture3d if shape == "volume" else ctx.texture_array
        made = make(size, texture.components, None, dtype=texture.dtype)
        _with_buffer(ctx, texture, lambda buffer: made.write(buffer, alignment=1))
    error = ctx.error
    if error != "GL_NO_ERROR":
        made.release()
        raise ContextError(f"the driver refused a {shape} of {texture.width} x {texture.height}: {error}")
    return Shaped(made, texture)


class Shaped:
    """A texture of another shape; ``use`` binds it to a unit, ``release`` frees it."""

    def __init__(self, made: Any, of: moderngl.Texture) -> None:
        self._made = made
        self._bytes = bytes_of(of.size, _form(of))
        self.has_mipmaps = False
        self.use: Callable[[int], None] = made.use
        self.release: Callable[[], None] = made.release

    @property
    def bytes(self) -> int:
        """Bytes held, mipmaps included: of a third dimension they are fewer."""
        return self._bytes + (self._bytes // 3 if self.has_mipmaps else 0)

    def build_mipmaps(self) -> None:
        """Make the mipmaps, once."""
        if not self.has_mipmaps:
            self._made.build_mipmaps()
            self.has_mipmaps = True


def _form(texture: moderngl.Texture) -> str:
    """Return a texture's format, as "rgba16f"."""
    return f"{_LETTERS[texture.components]}{_BITS[texture.dtype]}"


def _with_buffer(
    ctx: moderngl.Context, texture: moderngl.Texture, write: Callable[[moderngl.Buffer], None]
) -> None:
    """Call ``write`` with a buffer that holds a texture's texels."""
    buffer = ctx.buffer(reserve=bytes_of(texture.size, _form(texture)))
    try:
        texture.read_into(buffer, alignment=1)
        write(buffer)
    finally:
        buffer.release()


def _cube(ctx: moderngl.Context, texture: moderngl.Texture) -> moderngl.TextureCube:
    side, components, kind = texture.width, texture.components, texture.dtype
    cube = ctx.texture_cube((side, side), components, None, dtype=kind)
    buffer = ctx.buffer(reserve=bytes_of((side, side), _form(texture)))
    source = make_framebuffer(ctx, [texture])
    try:
        for face in range(FACES):
            block = (0, face * side, side, side)
            source.read_into(buffer, block, components, alignment=1, dtype=kind)
            cube.write(face, buffer, alignment=1)
    finally:
        source.release()
        buffer.release()
    return cube


def _check_largest(ctx: moderngl.Context, shape: str, size: tuple[int, int, int]) -> None:
    names = {"cube": "GL_MAX_CUBE_MAP_TEXTURE_SIZE", "volume": "GL_MAX_3D_TEXTURE_SIZE"}
    limit = int(ctx.info.get(names.get(shape, "GL_MAX_TEXTURE_SIZE")) or 0)
    if limit and max(size[:2]) > limit:
        raise ContextError(f"a {shape} of {size[0]} texels a side; this driver takes no more than {limit}")


class _Line:
    """A texture of one dimension, of row 0 of another."""

    def __init__(self, ctx: moderngl.Context, texture: moderngl.Texture) -> None:
        self._call = Calls(ctx)
        name = ctypes.c_uint()
        self._call("glGenTextures", (ctypes.c_int, ctypes.c_void_p), 1, ctypes.addressof(name))
        self._name = name.value
        source = make_framebuffer(ctx, [texture])
        before = ctx.fbo
        try:
            source.use()
            self.use(0)
            shape = (texture.width, 0, _LAYOUT[texture.components], 0x1406)  # GL_FLOAT
            kinds = (*(ctypes.c_int,) * 7, ctypes.c_void_p)
            internal = _INTERNAL[texture.components, texture.dtype]
            self._call("glTexImage1D", kinds, _TEXTURE_1D, 0, internal, *shape, None)
            self._call("glCopyTexSubImage1D", (ctypes.c_int,) * 6, _TEXTURE_1D, 0, 0, 0, 0, texture.width)
        finally:
            if before is not None:
                before.use()
            source.release()

    def use(self, unit: int) -> None:
        self._call.activate(unit)
        self._call("glBindTexture", (ctypes.c_int, ctypes.c_uint), _TEXTURE_1D, self._name)

    def build_mipmaps(self) -> None:
        self.use(0)
        self._call("glGenerateMipmap", (ctypes.c_int,), _TEXTURE_1D)

    def release(self) -> None:
        name, self._name = ctypes.c_uint(self._name), 0
        if name.value:
            self._call("glDeleteTextures", (ctypes.c_int, ctypes.c_void_p), 1, ctypes.addressof(name))
