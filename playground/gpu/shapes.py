"""Copy two-dimensional textures into those of other shapes: cubes, volumes, arrays and lines.

A result has two dimensions. A cube's lies in N x 6N texels, its faces from the bottom in OpenGL's order, +X
-X +Y -Y +Z -Z, each as OpenGL has it: row 0 of a face is its coordinate t = 0. A volume of N slices lies in
N x N*N, an array of square layers of n in N x n*N, each above the one before; a line is row 0.

The copies stay on the graphics card, by way of a pixel buffer. moderngl has no textures of one dimension:
those are OpenGL's own.
"""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from playground.errors import ContextError
from playground.gpu.gl_calls import Calls
from playground.gpu.textures import bytes_of, drain, make_framebuffer

if TYPE_CHECKING:
    import moderngl

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
