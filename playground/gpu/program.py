"""Compile wrapped kernels; map a driver's messages to their file, line and column.

What reads those messages is imported with the first of them: most programs have none.
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING
from unicodedata import name as name_of

from playground.errors import Diagnostic, ShaderError
from playground.gpu.stage_recipe import version_line
from playground.gpu.wrap import COMPUTE, FRAGMENT, ShaderStage, Wrapped, wrap_library
from playground.paths import shown
from playground.sketch.model import Kernel
from playground.sketch.reserved_names import FETCHES
from playground.sketch.source import Line, SourceText

if TYPE_CHECKING:
    import moderngl

    from playground.gpu.driver_log import LogEntry

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
    kernel = Kernel(shown(source.path), "kernel", source, ())
    for driver in (FRAGMENT, COMPUTE) if ctx.version_code >= 430 else (FRAGMENT,):
        compile_wrapped(ctx, wrap_library(kernel, driver)).release()


def explain(text: str, wrapped: Wrapped) -> ShaderError:
    """Convert moderngl's error text to diagnostics in the kernel's own files."""
    from playground.gpu.driver_log import parse_log, split_moderngl
    from playground.gpu.name_suggestions import without_consequences

    stage_name, log = split_moderngl(text)
    stage = wrapped.stages.get(stage_name) or wrapped.stages.get("fragment") or wrapped.stages["compute"]
    found: dict[tuple[str, int, str], Diagnostic] = {}
    foreign = None if stage.first else version_line(stage.source)
    for entry in without_consequences(parse_log(log)):
        if foreign is not None:
            # Of a plain shader the vertex stage is ours, and the version is all that it takes from the file.
            found[("", 0, "")] = foreign.diagnostic(f"this driver refuses the version: {entry.message}")
            break
        diagnostic = diagnostic_of(entry, stage, wrapped)
        # An open bracket makes everything behind the last line wrong: once is enough.
        past = _is_past_end(entry, stage) and diagnostic.severity == "error"
        key = (diagnostic.file, diagnostic.line, "" if past else diagnostic.message)
        found.setdefault(key, diagnostic)
    if not any(d.severity == "error" for d in found.values()):
        message = log.strip() or "the driver refused the shader and gave no reason"
        found[("", 0, "")] = Diagnostic(message, shown(wrapped.kernel.path))
    return ShaderError(diagnostics=found.values())


def diagnostic_of(entry: LogEntry, stage: ShaderStage, wrapped: Wrapped) -> Diagnostic:
    """Return one complaint of a driver in the kernel's own files, with its hint."""
    from playground.gpu.driver_log import folded, hint, source_column
    from playground.gpu.name_suggestions import guess, names_given, whereabouts

    for name, ours in sorted(FETCHES.items(), reverse=True):  # the longer first
        entry = replace(entry, message=entry.message.replace(ours, name))
    line = stage.locate(entry.line) if entry.line else _defined(entry.message, stage.source)
    if line is not None and entry.severity == "error" and (place := _beyond_ascii(line)) is not None:
        found = line.text[place]
        message = FOREIGN.format(f"{ord(found):04X}", name_of(found, NAMELESS))
        return line.diagnostic(message, place + 1, entry.severity)
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
    return next((place for place, (own, given) in pairs if given == "?" and not own.isascii()), None)


def _defined(message: str, source: SourceText) -> Line | None:
    """Return the line on which the function is defined that a message without a line speaks of, as Mesa does.

    "function `float f(float)' has static recursion"; of ANGLE it is the first of "call chain: f -> g".
    """
    match = DEFINED.search(message)
    if match is None:
        chain = CHAIN.search(message)
        begins = re.compile(rf"^\s*\w+\s+{chain[1]}\s*\(") if chain else None
        return next((line for line in source.lines if begins and begins.match(line.code)), None)
    wanted = [words.split()[0] for words in match.group(3).split(",") if words.split()]
    code, near = source.code, None
    for found in re.finditer(rf"\b{match.group(1)}\s+{match.group(2)}\s*\(([^)]*)\)\s*\{{", code):
        line = source.lines[code.count("\n", 0, found.start())]
        near = near or line
        given = [[w for w in part.split() if w not in _QUALIFIERS] for part in found.group(1).split(",")]
        if [words[0] for words in given if words] == wanted:
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
