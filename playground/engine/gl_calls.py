"""OpenGL's own functions by name, and timers of its work.

By timer queries, which are never nested; where a renderer's are wrong, by the wall clock between two
``finish()`` calls. Only while profiling: both slow a frame down.
"""

from __future__ import annotations

import ctypes
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from playground.errors import ContextError

if TYPE_CHECKING:
    import moderngl


_ACTIVE, _TEXTURE0 = "glActiveTexture", 0x84C0
_SAMPLER_BINDING = 0x8919
_WRAPS = (0x2802, 0x2803, 0x8072)  # GL_TEXTURE_WRAP_S, T and R
_TEXTURE_2D, _INTERNAL_FORMAT = 0x0DE1, 0x1003
_PACK_ALIGNMENT, _UNPACK_ALIGNMENT = 0x0D05, 0x0CF5
_CHANNELS = {1: 0x1903, 2: 0x8227, 4: 0x1908}  # GL_RED, GL_RG, GL_RGBA
_NUMBERS = {"f1": 0x1401, "nu2": 0x1403, "f2": 0x140B, "f4": 0x1406}  # by moderngl's name of a kind of number
_READ_FRAMEBUFFER, _DEPTH_BUFFER_BIT, _NEAREST = 0x8CA8, 0x0100, 0x2600


class Calls:
    """The functions of the library that a context came from."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._load = ctx.mglo._context.load_opengl_function

    def __call__(self, name: str, kinds: tuple[Any, ...], *arguments: Any) -> None:
        """Call a function that returns nothing; ``kinds`` are the types of its arguments."""
        address = self._load(name)
        if not address:
            raise ContextError(f"this driver has no {name}")
        ctypes.CFUNCTYPE(None, *kinds)(address)(*arguments)

    def activate(self, unit: int) -> None:
        """Make a texture unit the one that other calls mean."""
        self(_ACTIVE, (ctypes.c_int,), _TEXTURE0 + unit)


def copy_depth(
    ctx: moderngl.Context,
    target: moderngl.Framebuffer,
    source: moderngl.Framebuffer,
    size: tuple[int, int],
) -> None:
    """Copy the depth of a framebuffer to another of its size and samples, and no colour; ``target`` is bound.

    moderngl copies depth with each of the colours.
    """
    call, (width, height) = Calls(ctx), size
    target.use()
    call("glBindFramebuffer", (ctypes.c_uint, ctypes.c_uint), _READ_FRAMEBUFFER, source.glo)
    area = (0, 0, width, height)
    kinds = (*(ctypes.c_int,) * 8, ctypes.c_uint, ctypes.c_uint)
    call("glBlitFramebuffer", kinds, *area, *area, _DEPTH_BUFFER_BIT, _NEAREST)
    target.use()


def read_mipmap(texture: moderngl.Texture, level: int, size: tuple[int, int]) -> bytes:
    """Return the texels of a mipmap, whose size is given; moderngl reads none that it has not made."""
    ctx = texture.ctx
    call = Calls(ctx)
    buffer = ctypes.create_string_buffer(size[0] * size[1] * _texel(texture))
    texture.use(ctx.default_texture_unit)
    call("glPixelStorei", (ctypes.c_int, ctypes.c_int), _PACK_ALIGNMENT, 1)
    kinds = (*(ctypes.c_int,) * 4, ctypes.c_void_p)
    call("glGetTexImage", kinds, _TEXTURE_2D, level, *_kind(texture), ctypes.addressof(buffer))
    return buffer.raw


def write_mipmaps(texture: moderngl.Texture, sizes: Sequence[tuple[int, int]], data: memoryview) -> None:
    """Give a texture the mipmaps that another of its format had; ``sizes`` without its own.

    The bytes of the largest are first. moderngl writes none where none were made, and to have llvmpipe make
    the first of a format takes a tenth of a second: what draws them is compiled in each process.
    """
    ctx, form = texture.ctx, ctypes.c_int()
    call, start = Calls(ctx), 0
    texture.use(ctx.default_texture_unit)
    query = (ctypes.c_int, ctypes.c_int, ctypes.c_int, ctypes.c_void_p)
    call("glGetTexLevelParameteriv", query, _TEXTURE_2D, 0, _INTERNAL_FORMAT, ctypes.addressof(form))
    call("glPixelStorei", (ctypes.c_int, ctypes.c_int), _UNPACK_ALIGNMENT, 1)
    kinds = (*(ctypes.c_int,) * 8, ctypes.c_char_p)
    for level, (width, height) in enumerate(sizes, 1):
        texels = bytes(data[start : start + width * height * _texel(texture)])
        start += len(texels)
        level_arguments = (_TEXTURE_2D, level, form.value, width, height, 0)
        call("glTexImage2D", kinds, *level_arguments, *_kind(texture), texels)
    texture.filter = ctx.LINEAR_MIPMAP_LINEAR, ctx.LINEAR


def _kind(texture: moderngl.Texture) -> tuple[int, int]:
    """Return the channels and the kind of number of a texture's texels, as OpenGL names them."""
    return _CHANNELS[texture.components], _NUMBERS[texture.dtype]


def _texel(texture: moderngl.Texture) -> int:
    """Return the bytes of a texel."""
    return texture.components * int(texture.dtype[-1])


def wrap_sampler(ctx: moderngl.Context, sampler: moderngl.Sampler, mode: int) -> None:
    """Set how a sampler goes on outside of a texture, by OpenGL's number; it is taken off unit 0 again."""
    call, name = Calls(ctx), ctypes.c_int()
    sampler.use(0)
    call.activate(0)
    call("glGetIntegerv", (ctypes.c_int, ctypes.c_void_p), _SAMPLER_BINDING, ctypes.addressof(name))
    for wrap in _WRAPS:
        call("glSamplerParameteri", (ctypes.c_uint, ctypes.c_int, ctypes.c_int), name.value, wrap, mode)
    sampler.clear(0)


WALL, QUERY = "wall clock", "GPU timer"


class Timer:
    """Measure stretches of work on one context."""

    def __init__(self, ctx: moderngl.Context, *, queries: bool) -> None:
        self._ctx = ctx
        self._query = ctx.query(time=True) if queries else None
        self._open = False
        self.clock = QUERY if queries else WALL  # which clock the figures come from

    @contextmanager
    def measure(self, into: dict[str, float], name: str) -> Iterator[None]:
        """Add the milliseconds that the block takes to ``into[name]``; blocks may not be nested."""
        if self._open:
            raise RuntimeError("a timer measures one stretch at a time")
        self._open = True
        try:
            if self._query is not None:
                with self._query:
                    yield
                spent = self._query.elapsed / 1e6
            else:
                self._ctx.finish()
                start = time.perf_counter()
                yield
                self._ctx.finish()
                spent = (time.perf_counter() - start) * 1e3
            into[name] = into.get(name, 0.0) + spent
        finally:
            self._open = False
