"""Cache compiled programs: one for each text, for as long as it is used.

A kernel is wrapped once for each driver, and a text is compiled once; setting a uniform
that the driver dropped does nothing.
"""

from __future__ import annotations

import logging
import struct
import time
from collections import OrderedDict
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from playground.errors import ShaderError
from playground.gpu.choices import QUICKER, fixed_texel, with_choices
from playground.gpu.own_shaders import TRIANGLE
from playground.gpu.program import compile_wrapped
from playground.gpu.wrap import CORNER, Wrapped, wrap
from playground.paths import shown
from playground.sketch.model import Kernel

if TYPE_CHECKING:
    import moderngl

_log = logging.getLogger(__name__)

Choices = tuple[tuple[str, int], ...]
"""Checkboxes and menus with their values."""

_CORNERS = struct.pack("6f", -1.0, -1.0, 3.0, -1.0, -1.0, 3.0)  # of a triangle over the whole picture
_SPARE = 64  # programs cached beyond those of the current frame


class Program:
    """A compiled program, its active uniforms, and the vertex arrays made for it."""

    def __init__(self, ctx: moderngl.Context, compiled: Any) -> None:
        self.ctx = ctx
        self.compiled = compiled
        self.uniforms: dict[str, Any] = {name: compiled[name] for name in compiled}
        self.bound: object = None  # what its uniforms were last bound for: see ``Binder.bind``
        self._last: dict[str, Any] = {}  # the values that uniforms have
        self.arrays: dict[object, moderngl.VertexArray] = {}  # by mesh; None: the whole picture
        # Uniforms that are texels of inputs, and which: see ``gpu.choices.with_choices``.
        self.fixed = [(name, *of) for name in self.uniforms if (of := fixed_texel(name)) is not None]
        self.frame = 0  # when it was last used
        self._corners: moderngl.Buffer | None = None

    def set(self, name: str, value: Any) -> None:
        """Set a uniform, unless the driver dropped it, or it has that very value, which is immutable."""
        uniform = self.uniforms.get(name)
        if uniform is not None and self._last.get(name, self) is not value:
            uniform.value = self._last[name] = value

    def set_all(self, values: Mapping[str, Any]) -> None:
        """Set uniforms by name, as ``set`` does."""
        uniforms, last = self.uniforms, self._last
        for name, value in values.items():
            uniform = uniforms.get(name)
            if uniform is not None and last.get(name, self) is not value:
                uniform.value = last[name] = value

    def write(self, name: str, value: Any) -> None:
        """Set a uniform that there is to numbers in a list or a tuple of their own."""
        self._last.pop(name, None)
        self.uniforms[name].value = value

    def fill(self, vertices: int = 3) -> None:
        """Draw one triangle over the whole of the bound framebuffer, or two of 6 vertices in all."""
        array = self.arrays.get(None)
        if array is None:
            content: list[tuple[Any, ...]] = []
            if CORNER in self.uniforms:  # an old version, which cannot make corners of vertices' numbers
                self._corners = self.ctx.buffer(_CORNERS)
                content = [(self._corners, "2f", CORNER)]
            array = self.arrays[None] = self.ctx.vertex_array(self.compiled, content)
        array.render(self.ctx.TRIANGLES, vertices=vertices)

    def run(self, x: int, y: int) -> None:
        """Dispatch so many work groups, and make what they wrote visible."""
        self.compiled.run(x, y)
        self.ctx.memory_barrier()

    def release(self) -> None:
        """Release it and its vertex arrays."""
        for array in self.arrays.values():
            array.release()
        self.arrays.clear()
        if self._corners is not None:
            self._corners.release()
        self.compiled.release()


class Programs:
    """Programs of one context, by kernel and by text."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self.compile_times: dict[str, float] = {}  # [ms] of each program compiled, by file
        self.compiled = 0  # how many programs were compiled
        self.frame = 0  # frames begun: programs of the current one stay
        self._by_text: OrderedDict[tuple[str, ...], Program] = OrderedDict()
        # The kernel is held with its texts so that its identity stays its own.
        self._texts: OrderedDict[tuple[int, str, Choices], tuple[Kernel, tuple[str, ...]]] = OrderedDict()

    def __len__(self) -> int:
        return len(self._by_text)

    def get(self, kernel: Kernel, driver: str, choices: Choices = ()) -> Program:
        """Return the program of a kernel, some of its checkboxes and menus written in as constants.

        Raises ``ShaderError`` where its text is wrong.
        """
        wanted = (id(kernel), driver, choices)
        known = self._texts.get(wanted)
        if known is not None and known[1] in self._by_text:
            self._texts.move_to_end(wanted)
            return self._used(known[1])
        plain = wrap(kernel, driver, self.ctx.version_code)
        wrapped = with_choices(plain, choices) if choices else plain
        if kernel.kind == "plain_fragment":
            from playground.gpu.zero_values import with_zeros

            wrapped = with_zeros(wrapped)
        text = _texts(wrapped)
        self._texts[wanted] = (kernel, text)
        while len(self._texts) > 4 * _SPARE:
            self._texts.popitem(last=False)
        if text not in self._by_text:
            start = time.perf_counter()
            self._keep(text, self._compiled(plain, wrapped, choices))
            self.compile_times[kernel.path] = milliseconds = (time.perf_counter() - start) * 1e3
            _log.debug("compiled %s (%s) in %.0f ms", shown(kernel.path), driver, milliseconds)
        return self._used(text)

    def _compiled(self, plain: Wrapped, wrapped: Wrapped, choices: Choices) -> Any:
        """Compile a text; where functions or values are written into it and that fails, without.

        So a driver's complaints name what the author wrote.
        """
        own = tuple([choice for choice in choices if choice[0] not in QUICKER])
        try:
            return compile_wrapped(self.ctx, wrapped)
        except ShaderError:
            as_written = with_choices(plain, own)
            if _texts(as_written) == _texts(wrapped):
                raise
            program = compile_wrapped(self.ctx, as_written)
            if plain.kernel.kind == "plain_fragment":
                _log.warning("%s: variables without a value are undefined here", shown(plain.kernel.path))
            return program

    def own(self, fragment: str) -> Program:
        """Return the program of a fragment shader of the engine's own."""
        text = (TRIANGLE, fragment)
        if text not in self._by_text:
            self._keep(text, self.ctx.program(vertex_shader=TRIANGLE, fragment_shader=fragment))
        return self._used(text)

    def forget_mesh(self, mesh: object) -> None:
        """Release every vertex array made for a mesh."""
        for program in self._by_text.values():
            array = program.arrays.pop(mesh, None)
            if array is not None:
                array.release()

    def release(self) -> None:
        """Release every program."""
        for program in self._by_text.values():
            program.release()
        self._by_text.clear()
        self._texts.clear()

    def _used(self, text: tuple[str, ...]) -> Program:
        self._by_text.move_to_end(text)
        program = self._by_text[text]
        program.frame = self.frame
        return program

    def _keep(self, text: tuple[str, ...], compiled: Any) -> None:
        self.compiled += 1
        self._by_text[text] = Program(self.ctx, compiled)
        for old in list(self._by_text)[:-_SPARE]:
            if self._by_text[old].frame != self.frame and old != text:
                self._by_text.pop(old).release()


def _texts(wrapped: Wrapped) -> tuple[str, ...]:
    """Return what a driver compiles."""
    return tuple(stage.text for stage in wrapped.stages.values())
