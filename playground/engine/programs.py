"""Programs: compile wrapped kernels and cache them.

What explains a driver's messages is imported with the first of them: most programs have none.

A kernel is wrapped once for each driver, and a text is compiled once; setting a uniform
that the driver dropped does nothing.

Mesa reports nothing of a text that it finds in its cache on disk, so each stage is compiled
once more, with a comment at its end that no cache can know, and thrown away.
"""

from __future__ import annotations

import ctypes
import logging
import struct
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from playground.engine.heap import trim_heap
from playground.engine.plan import LoopIteration, Step
from playground.engine.tuning import Choices, Tuning
from playground.errors import Diagnostic, ShaderError
from playground.memo import GRAPHS, Memo
from playground.paths import shown
from playground.shader.expressions import FRAME_RATE, counts_frames
from playground.shader.own_shaders import TRIANGLE
from playground.shader.source import SourceText
from playground.shader.wrap import COMPUTE, CORNER, FRAGMENT, Wrapped, wrap, wrap_library
from playground.sketch.model import Input, Kernel, PlainFragment, TexelKernel

if TYPE_CHECKING:
    import moderngl


def compile_wrapped(ctx: moderngl.Context, wrapped: Wrapped) -> moderngl.Program | moderngl.ComputeShader:
    """Compile and link; raise ``ShaderError`` with one diagnostic for each of the driver's complaints."""
    import moderngl

    try:
        if "compute" in wrapped.stages:
            return ctx.compute_shader(wrapped.stages["compute"].text)
        return ctx.program(
            vertex_shader=wrapped.stages["vertex"].text, fragment_shader=wrapped.stages["fragment"].text
        )
    except moderngl.Error as error:
        from playground.shader.complaints import explain

        raise explain(str(error), wrapped) from None
    finally:
        _ = ctx.error  # a failed compile may leave one behind


def compile_library(ctx: moderngl.Context, source: SourceText) -> None:
    """Compile a library file alone, as a fragment shader and, where there is compute, as a compute shader.

    Raises ``ShaderError`` with one diagnostic for each of the driver's complaints.
    """
    kernel = TexelKernel(shown(source.path), source, ())
    for driver in (FRAGMENT, COMPUTE) if ctx.version_code >= 430 else (FRAGMENT,):
        compile_wrapped(ctx, wrap_library(kernel, driver)).release()


_log = logging.getLogger(__name__)

_CORNERS = struct.pack("6f", -1.0, -1.0, 3.0, -1.0, -1.0, 3.0)  # of a triangle over the whole picture
_SPARE = 64  # programs cached beyond those of the current frame


@dataclass(frozen=True, slots=True)
class Bound:
    """What a program's uniforms and samplers were last set for: see ``Binder.bind``."""

    step: Step
    uniforms: Mapping[str, Any]
    wires: tuple[int, ...]
    units: tuple[tuple[Input, int, moderngl.Sampler], ...]  # of textures, by input
    unit: int  # the next free one


class Program:
    """A compiled program, its active uniforms, and the vertex arrays made for it."""

    def __init__(self, ctx: moderngl.Context, compiled: Any) -> None:
        self.ctx = ctx
        self.compiled = compiled
        self.uniforms: dict[str, Any] = {name: compiled[name] for name in compiled}
        self.bound: Bound | None = None
        self._last: dict[str, Any] = {}  # the values that uniforms have
        self.arrays: dict[object, moderngl.VertexArray] = {}  # by mesh; None: the whole picture
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

    def count(
        self, repeat: str, iteration: int, whole: int, around: LoopIteration | None, at_once: int = 1
    ) -> None:
        """Set a kernel's iteration: its own where it repeats, else that of the loop around it."""
        number, total = iteration, whole
        if repeat == "1" and around is not None and around.total:
            number, total = around.number, around.total
        self.set("iteration", number)
        self.set("iterations", total)
        self.set("until", number + at_once)
        if counts_frames(repeat):
            self.set("time", number / FRAME_RATE)

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

    def __init__(self, ctx: moderngl.Context, tuning: Tuning) -> None:
        self.ctx = ctx
        self.write = tuning.write
        self.compile_times: dict[str, float] = {}  # [ms] of each program compiled, by file
        self.compiled = 0  # how many programs were compiled
        self._rested = 0  # of them, when memory was last given back
        self.frame = 0  # frames begun: programs of the current one stay
        self.by_text: Memo[tuple[str, ...], Program] = Memo(
            "programs",
            _SPARE,
            dropped=lambda _, program: program.release(),
            pinned=lambda _, program: program.frame == self.frame,
        )

    def __len__(self) -> int:
        return len(self.by_text)

    def get(self, kernel: Kernel, driver: str, choices: Choices = ()) -> Program:
        """Return the program of a kernel, with what is chosen written into its text.

        Raises ``ShaderError`` where its text is wrong.
        """
        plain, wrapped, text = _wrapped(kernel, driver, self.ctx.version_code, choices, self.write)
        if text not in self.by_text:
            start = time.perf_counter()
            self._keep(text, self._compiled(plain, wrapped, choices))
            self.compile_times[kernel.path] = milliseconds = (time.perf_counter() - start) * 1e3
            _log.debug("compiled %s (%s) in %.0f ms", shown(kernel.path), driver, milliseconds)
        return self._used(text)

    def wrapped(self, kernel: Kernel, driver: str, choices: Choices = ()) -> Wrapped:
        """Return the stages that ``get`` compiles."""
        return _wrapped(kernel, driver, self.ctx.version_code, choices, self.write)[1]

    def _compiled(self, plain: Wrapped, wrapped: Wrapped, choices: Choices) -> Any:
        """Compile a text; where functions or values are written into it and that fails, without.

        So a driver's complaints name what the author wrote.
        """
        try:
            return compile_wrapped(self.ctx, wrapped)
        except ShaderError:
            as_written = self.write(plain, choices, plainly=True)
            if _texts(as_written) == _texts(wrapped):
                raise
            program = compile_wrapped(self.ctx, as_written)
            if isinstance(plain.kernel, PlainFragment):
                _log.warning("%s: variables without a value are undefined here", shown(plain.kernel.path))
            return program

    def own(self, fragment: str) -> Program:
        """Return the program of a fragment shader of the engine's own."""
        text = (TRIANGLE, fragment)
        if text not in self.by_text:
            self._keep(text, self.ctx.program(vertex_shader=TRIANGLE, fragment_shader=fragment))
        return self._used(text)

    def forget_mesh(self, mesh: object) -> None:
        """Release every vertex array made for a mesh."""
        for program in self.by_text.values():
            array = program.arrays.pop(mesh, None)
            if array is not None:
                array.release()

    def rest(self) -> None:
        """Give back what compiling has freed, once after the latest program: when nothing is to be drawn."""
        if self._rested != self.compiled:
            self._rested = self.compiled
            trim_heap()

    def release(self) -> None:
        """Release every program."""
        self.by_text.clear()

    def _used(self, text: tuple[str, ...]) -> Program:
        program: Program = self.by_text.get(text)
        program.frame = self.frame
        return program

    def _keep(self, text: tuple[str, ...], compiled: Any) -> None:
        self.compiled += 1
        self.by_text.put(text, Program(self.ctx, compiled))


@GRAPHS.cached(identities=1)
def _wrapped(
    kernel: Kernel, driver: str, version: int, choices: Choices, write: Callable[[Wrapped, Choices], Wrapped]
) -> tuple[Wrapped, Wrapped, tuple[str, ...]]:
    """Return a kernel's text for a driver as it is written, as it is compiled first, and what that is."""
    plain = wrap(kernel, driver, version)
    wrapped = write(plain, choices) if choices else plain
    if isinstance(kernel, PlainFragment):
        from playground.shader.zero_values import with_zeros

        wrapped = with_zeros(wrapped)
    return plain, wrapped, _texts(wrapped)


def _texts(wrapped: Wrapped) -> tuple[str, ...]:
    """Return what a driver compiles."""
    return tuple(stage.text for stage in wrapped.stages.values())


_MAX_LOG_BYTES = 64 * 1024  # bytes of a log
_STAGES = {"vertex": 0x8B31, "fragment": 0x8B30, "compute": 0x91B9}

_UINT, _INT = ctypes.c_uint, ctypes.c_int
_AT = ctypes.POINTER


def warnings_of(ctx: moderngl.Context, wrapped: Wrapped) -> tuple[Diagnostic, ...]:
    """Return what a driver warns of in a kernel's text, in the kernel's own files.

    Only what is at a line of the files, not of what the wrapper adds. Empty where the text
    does not compile, and where OpenGL's functions cannot be reached: they are taken from where
    moderngl takes them, which is not part of its interface.
    """
    from playground.shader.complaints import diagnostic_of
    from playground.shader.driver_log import parse_log

    load = getattr(getattr(ctx.mglo, "_context", None), "load_opengl_function", None)
    diagnostics: dict[tuple[str, int, str], Diagnostic] = {}
    if load is None:
        return ()
    for name, stage in wrapped.stages.items():
        if not stage.first:  # none of it is the author's
            continue
        for entry in parse_log(_compile_log(load, _STAGES[name], f"{stage.text}// {time.time_ns()}\n")):
            if entry.severity == "error":
                return ()
            if isinstance(wrapped.kernel, PlainFragment) and "uninitialized" in entry.message:
                continue  # it begins at 0: see zero_values
            if stage.locate(entry.line) is not None:
                diagnostic = diagnostic_of(entry, stage, wrapped)
                diagnostics.setdefault((diagnostic.file, diagnostic.line, diagnostic.message), diagnostic)
    return tuple(diagnostics.values())


def _compile_log(load: Callable[[str], int], kind: int, text: str) -> str:
    """Compile a text, return the driver's log, and leave nothing behind."""

    def function(name: str, result: Any, *types: Any) -> Any:
        address = load(name)
        return ctypes.CFUNCTYPE(result, *types)(address) if address else None

    create = function("glCreateShader", _UINT, _UINT)
    source = function("glShaderSource", None, _UINT, _INT, _AT(ctypes.c_char_p), _AT(_INT))
    build = function("glCompileShader", None, _UINT)
    read = function("glGetShaderInfoLog", None, _UINT, _INT, _AT(_INT), ctypes.c_char_p)
    delete = function("glDeleteShader", None, _UINT)
    if None in (create, source, build, read, delete):
        return ""
    shader = create(kind)
    if not shader:
        return ""
    log = ctypes.create_string_buffer(_MAX_LOG_BYTES)
    source(shader, 1, ctypes.byref(ctypes.c_char_p(text.encode())), None)
    build(shader)
    read(shader, _MAX_LOG_BYTES, None, log)
    delete(shader)
    return log.value.decode("utf-8", "replace")
