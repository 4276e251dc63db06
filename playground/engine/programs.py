"""Programs: compile wrapped kernels, cache them, and map a driver's messages to lines.

What reads those messages is imported with the first of them: most programs have none.

A kernel is wrapped once for each driver, and a text is compiled once; setting a uniform
that the driver dropped does nothing.

Mesa reports nothing of a text that it finds in its cache on disk, so each stage is compiled
once more, with a comment at its end that no cache can know, and thrown away.
"""

from __future__ import annotations

import ctypes
import logging
import re
import struct
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any
from unicodedata import name as name_of

from playground.engine.plan import LoopIteration
from playground.engine.tuning import Choices, Tuning
from playground.errors import Diagnostic, ShaderError
from playground.memo import GRAPHS, Memo
from playground.paths import shown
from playground.shader.expressions import FRAME_RATE, counts_frames
from playground.shader.own_shaders import TRIANGLE
from playground.shader.reserved_names import FETCHES
from playground.shader.source import Line, SourceText
from playground.shader.stage_recipe import version_line
from playground.shader.wrap import COMPUTE, CORNER, FRAGMENT, ShaderStage, Wrapped, wrap, wrap_library
from playground.sketch.model import Kernel, PlainFragment, TexelKernel

if TYPE_CHECKING:
    import moderngl

    from playground.shader.driver_log import LogEntry


FOREIGN = "the character U+{0}, {1}, is none of GLSL's: only comments may have it"
"""Sentence for a character beyond ASCII; {0} is its number, {1} its name."""

NAMELESS = "of no name"

PAST_END = "{0}; is a bracket unclosed? the file needs {1}"
"""Sentence for what a driver finds behind the last line; {1} is what the file is to define."""


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


def explain(text: str, wrapped: Wrapped) -> ShaderError:
    """Convert moderngl's error text to diagnostics in the kernel's own files."""
    from playground.shader.driver_log import parse_log, split_moderngl, without_consequences

    stage_name, log = split_moderngl(text)
    stage = wrapped.stages.get(stage_name) or wrapped.stages.get("fragment") or wrapped.stages["compute"]
    diagnostics: dict[tuple[str, int, str], Diagnostic] = {}
    foreign = None if stage.first else version_line(stage.source)
    for entry in without_consequences(parse_log(log)):
        if foreign is not None:
            # Of a plain shader the vertex stage is ours, and the version is all that it takes from the file.
            diagnostics[("", 0, "")] = foreign.diagnostic(f"this driver refuses the version: {entry.message}")
            break
        diagnostic = diagnostic_of(entry, stage, wrapped)
        # An open bracket makes everything behind the last line wrong: once is enough.
        past = _is_past_end(entry, stage) and diagnostic.severity == "error"
        key = (diagnostic.file, diagnostic.line, "" if past else diagnostic.message)
        diagnostics.setdefault(key, diagnostic)
    if not any(d.severity == "error" for d in diagnostics.values()):
        message = log.strip() or "the driver refused the shader and gave no reason"
        diagnostics[("", 0, "")] = Diagnostic(message, shown(wrapped.kernel.path))
    return ShaderError(diagnostics=diagnostics.values())


def diagnostic_of(entry: LogEntry, stage: ShaderStage, wrapped: Wrapped) -> Diagnostic:
    """Return one complaint of a driver in the kernel's own files, with its hint."""
    from playground.shader.driver_log import folded, guess, hint, names_given, source_column, whereabouts

    for name, ours in sorted(FETCHES.items(), reverse=True):  # the longer first
        entry = replace(entry, message=entry.message.replace(ours, name))
    line = stage.locate(entry.line) if entry.line else _defined(entry.message, stage.source)
    if line is not None and entry.severity == "error" and (column_index := _beyond_ascii(line)) is not None:
        character = line.text[column_index]
        message = FOREIGN.format(f"{ord(character):04X}", name_of(character, NAMELESS))
        return line.diagnostic(message, column_index + 1, entry.severity)
    more = (
        whereabouts(entry.message, stage.source, line, wrapped.kernel)
        or guess(entry.message, stage.source, line, names_given(wrapped.kernel))
        or hint(entry.message)
    )
    message = folded(entry.message)
    message = f"{message}; {more}" if more else message
    if line is not None:
        column = (
            source_column(line.code, entry.column) if entry.column else _column_of(entry.message, line.code)
        )
        return line.diagnostic(message, min(column, len(line.text) + 1), entry.severity)
    if _is_past_end(entry, stage):
        # Past the last line: either an unclosed bracket, or the wrapper's call does not fit.
        last = next((ln for ln in reversed(stage.source.lines) if ln.code.strip()), stage.source.lines[-1])
        return last.diagnostic(PAST_END.format(entry.message, stage.expected), 0, entry.severity)
    return Diagnostic(message, shown(wrapped.kernel.path), 0, 0, entry.severity)


def _is_past_end(entry: LogEntry, stage: ShaderStage) -> bool:
    """Return whether a complaint is of what stands behind the kernel's last line."""
    return bool(entry.line) and entry.line >= stage.first + len(stage.source.lines)


def _beyond_ascii(line: Line) -> int | None:
    """Return where a line has a character that the driver was given as "?"; None where it has none."""
    pairs = enumerate(zip(line.text, line.code, strict=False))
    return next((index for index, (own, character) in pairs if character == "?" and not own.isascii()), None)


def _defined(message: str, source: SourceText) -> Line | None:
    """Return the line on which the function is defined that a message without a line speaks of, as Mesa does.

    "function `float f(float)' has static recursion"; of ANGLE it is the first of "call chain: f -> g".
    """
    match = DEFINED.search(message)
    if match is None:
        chain = CHAIN.search(message)
        begins = re.compile(rf"^\s*\w+\s+{chain[1]}\s*\(") if chain else None
        return next((line for line in source.lines if begins and begins.match(line.code)), None)
    types = [words.split()[0] for words in match.group(3).split(",") if words.split()]
    code, near = source.code, None
    for definition in re.finditer(rf"\b{match.group(1)}\s+{match.group(2)}\s*\(([^)]*)\)\s*\{{", code):
        line = source.lines[code.count("\n", 0, definition.start())]
        near = near or line
        parameters = [
            [w for w in part.split() if w not in _QUALIFIERS] for part in definition.group(1).split(",")
        ]
        if [words[0] for words in parameters if words] == types:
            return line
    return near


DEFINED = re.compile(r"function [`'\"](\w+) (\w+)\(([^)]*)\)[`'\"]")
CHAIN = re.compile(r"call chain: (\w+)")
_QUALIFIERS = frozenset({"const", "in", "out", "inout", "lowp", "mediump", "highp"})


def _column_of(message: str, code: str) -> int:
    """Find the name that a message quotes, for drivers that give no column."""
    for name in re.findall(r"[`'\"]([A-Za-z_]\w*)['\"]", message):
        if match := re.search(rf"\b{re.escape(name)}\b", code):
            return match.start() + 1
    return 0


_log = logging.getLogger(__name__)

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
        if repeat == "1" and around is not None and around.whole:
            number, total = around.number, around.whole
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
        self._write = tuning.write
        self.compile_times: dict[str, float] = {}  # [ms] of each program compiled, by file
        self.compiled = 0  # how many programs were compiled
        self.frame = 0  # frames begun: programs of the current one stay
        self._by_text: Memo[tuple[str, ...], Program] = Memo(
            "programs",
            _SPARE,
            dropped=lambda _, program: program.release(),
            pinned=lambda _, program: program.frame == self.frame,
        )

    def __len__(self) -> int:
        return len(self._by_text)

    def get(self, kernel: Kernel, driver: str, choices: Choices = ()) -> Program:
        """Return the program of a kernel, with what is chosen written into its text.

        Raises ``ShaderError`` where its text is wrong.
        """
        plain, wrapped, text = _wrapped(kernel, driver, self.ctx.version_code, choices, self._write)
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
        try:
            return compile_wrapped(self.ctx, wrapped)
        except ShaderError:
            as_written = self._write(plain, choices, plainly=True)
            if _texts(as_written) == _texts(wrapped):
                raise
            program = compile_wrapped(self.ctx, as_written)
            if isinstance(plain.kernel, PlainFragment):
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
        self._by_text.clear()

    def _used(self, text: tuple[str, ...]) -> Program:
        program: Program = self._by_text.get(text)
        program.frame = self.frame
        return program

    def _keep(self, text: tuple[str, ...], compiled: Any) -> None:
        self.compiled += 1
        self._by_text.put(text, Program(self.ctx, compiled))


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
