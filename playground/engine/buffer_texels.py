"""Have compute shaders read buffers as textures, on a software renderer: there in half of the time.

A text reads number ``place`` of the buffer ``heights`` by ``read_heights(place)``. That is
``heights[place]``, which llvmpipe loads a float at a time; of a texture it loads a vec4 at once. Both are
the same memory: what an earlier step wrote is there.
"""

from __future__ import annotations

import ctypes
from collections.abc import Mapping
from functools import cached_property
from typing import TYPE_CHECKING

from playground.engine.gl_calls import Calls
from playground.shader.buffer_reads import FIRST_UNIT, read_by_functions
from playground.sketch.model import Buffer, ComputeVariant

if TYPE_CHECKING:
    import moderngl

_TEXTURE_BUFFER = 0x8C2A
_FORMATS = {"float": 0x822E, "vec2": 0x8230, "vec4": 0x8814}  # GL_R32F, GL_RG32F, GL_RGBA32F
_UINTS = (ctypes.c_uint,) * 3


class BufferTexels:
    """Textures of one context that are buffers, each on a texture unit as long as a variant runs."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._call = Calls(ctx)
        self._textures: list[ctypes.c_uint] = []  # by number of the buffer that is read

    def release(self) -> None:
        """Release the textures, not the buffers."""
        for name in self._textures:
            self._call("glDeleteTextures", (ctypes.c_int, ctypes.c_void_p), 1, ctypes.addressof(name))
        self._textures.clear()

    def read(self, kernel: ComputeVariant, buffers: Mapping[str, moderngl.Buffer]) -> list[Buffer]:
        """Return the buffers that a kernel reads so; none where one is longer than a texture may be."""
        found = read_by_functions(kernel)
        longest = max([buffers[b.name].size // 4 for b in found], default=0)  # in texels of a float
        return found if longest <= self.most else []

    @cached_property
    def most(self) -> int:
        """Return how many texels a texture may have that is a buffer."""
        return int(self._ctx.info["GL_MAX_TEXTURE_BUFFER_SIZE"])

    def bind(self, read: list[Buffer], buffers: Mapping[str, moderngl.Buffer]) -> None:
        """Bind what a kernel reads so."""
        while len(self._textures) < len(read):
            self._textures.append(self._made())
        for number, declared in enumerate(read):
            self._call.activate(FIRST_UNIT + number)
            self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, self._textures[number].value)
            form, buffer = _FORMATS[declared.type], buffers[declared.name].glo
            self._call("glTexBuffer", _UINTS, _TEXTURE_BUFFER, form, buffer)

    def let_go(self) -> None:
        """Take the buffers off: one that is released stays in memory while it is a texture."""
        for number, texture in enumerate(self._textures):
            self._call.activate(FIRST_UNIT + number)
            self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, texture.value)
            self._call("glTexBuffer", _UINTS, _TEXTURE_BUFFER, _FORMATS["float"], 0)
            self._call("glBindTexture", _UINTS[:2], _TEXTURE_BUFFER, 0)

    def _made(self) -> ctypes.c_uint:
        name = ctypes.c_uint()
        self._call("glGenTextures", (ctypes.c_int, ctypes.c_void_p), 1, ctypes.addressof(name))
        return name
