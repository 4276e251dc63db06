"""Compile wrapped kernels; give a driver's complaints back their file, line and column."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from playground.errors import Diagnostic, ShaderError
from playground.gpu.logs import LogEntry, hint, parse_log, source_column, split_moderngl
from playground.gpu.names import guess
from playground.gpu.wrap import COMPUTE, FRAGMENT, Stage, Wrapped, wrap_library
from playground.paths import shown
from playground.sketch.model import Kernel
from playground.sketch.source import SourceText

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
        raise explain(str(error), wrapped) from None
    finally:
        _ = ctx.error  # a failed compile may leave one behind


def compile_library(ctx: moderngl.Context, source: SourceText) -> None:
    """Compile a library file alone, as a fragment shader and, where there is compute, as a compute shader.

    Raises ``ShaderError`` with one diagnostic for each of the driver's complaints.
    """
    kernel = Kernel(shown(source.path), "kernel", source, ())
    for driver in (FRAGMENT, COMPUTE) if ctx.version_code >= 430 else (FRAGMENT,):
        compile_wrapped(ctx, wrap_library(kernel, driver)).release()


def explain(text: str, wrapped: Wrapped) -> ShaderError:
    """Turn moderngl's error text into diagnostics in the kernel's own files."""
    stage_name, log = split_moderngl(text)
    stage = wrapped.stages.get(stage_name) or wrapped.stages.get("fragment") or wrapped.stages["compute"]
    found: dict[tuple[str, int, str], Diagnostic] = {}
    for entry in parse_log(log):
        diagnostic = diagnostic_of(entry, stage, wrapped)
        found.setdefault((diagnostic.file, diagnostic.line, diagnostic.message), diagnostic)
    if not any(d.severity == "error" for d in found.values()):
        message = log.strip() or "the driver refused the shader and gave no reason"
        found[("", 0, "")] = Diagnostic(message, shown(wrapped.kernel.path))
    return ShaderError(diagnostics=found.values())


def diagnostic_of(entry: LogEntry, stage: Stage, wrapped: Wrapped) -> Diagnostic:
    """Return one complaint of a driver in the kernel's own files, with its hint."""
    line = stage.locate(entry.line) if entry.line else None
    more = guess(entry.message, stage.source, line) or hint(entry.message)
    message = f"{entry.message}; {more}" if more else entry.message
    if line is not None:
        column = (
            source_column(line.code, entry.column) if entry.column else _column_of(entry.message, line.code)
        )
        return line.diagnostic(message, min(column, len(line.text) + 1), entry.severity)
    if entry.line and entry.line >= stage.first + len(stage.source.lines) - 1:
        # Past the last line: either an unclosed bracket, or the wrapper's call does not fit.
        last = next((ln for ln in reversed(stage.source.lines) if ln.code.strip()), stage.source.lines[-1])
        return last.diagnostic(
            f"{entry.message}; is a bracket unclosed? the file needs {stage.expected}", 0, entry.severity
        )
    return Diagnostic(message, shown(wrapped.kernel.path), 0, 0, entry.severity)


def _column_of(message: str, code: str) -> int:
    """Find the name that a message quotes, for drivers that give no column."""
    for name in re.findall(r"[`'\"]([A-Za-z_]\w*)['\"]", message):
        if match := re.search(rf"\b{re.escape(name)}\b", code):
            return match.start() + 1
    return 0
