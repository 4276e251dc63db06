"""Call OpenGL's own functions by name, for the little that moderngl has no word for."""

from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any

from playground.errors import ContextError

if TYPE_CHECKING:
    import moderngl

_ACTIVE, _TEXTURE0 = "glActiveTexture", 0x84C0
_SAMPLER_BINDING = 0x8919
_WRAPS = (0x2802, 0x2803, 0x8072)  # GL_TEXTURE_WRAP_S, T and R
_MIRRORED = 0x8370
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


def mirror(ctx: moderngl.Context, sampler: moderngl.Sampler) -> None:
    """Let a sampler repeat a texture mirrored; it is taken off unit 0 again."""
    call, name = Calls(ctx), ctypes.c_int()
    sampler.use(0)
    call.activate(0)
    call("glGetIntegerv", (ctypes.c_int, ctypes.c_void_p), _SAMPLER_BINDING, ctypes.addressof(name))
    for wrap in _WRAPS:
        call("glSamplerParameteri", (ctypes.c_uint, ctypes.c_int, ctypes.c_int), name.value, wrap, _MIRRORED)
    sampler.clear(0)
