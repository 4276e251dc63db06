"""Explain what a driver complains of: in the kernel's own files, with a hint.

``driver_log`` reads the log; here its entries, which count lines of the text that was compiled, become
diagnostics at lines of the files that the author wrote.
"""

from __future__ import annotations

import re
from dataclasses import replace
from unicodedata import name as name_of

from playground.errors import Diagnostic, ShaderError
from playground.paths import shown
from playground.shader.driver_log import (
    LogEntry,
    folded,
    guess,
    hint,
    names_given,
    parse_log,
    source_column,
    split_moderngl,
    whereabouts,
    without_consequences,
)
from playground.shader.reserved_names import FETCHES
from playground.shader.source import Line, SourceText
from playground.shader.stage_recipe import version_line
from playground.shader.syntax.nodes import Function
from playground.shader.syntax.symbols import symbols_of
from playground.shader.syntax.tokens import place_of
from playground.shader.wrap import ShaderStage, Wrapped

FOREIGN = "the character U+{0}, {1}, is none of GLSL's: only comments may have it"
"""Sentence for a character beyond ASCII; {0} is its number, {1} its name."""

NAMELESS = "of no name"

PAST_END = "{0}; is a bracket unclosed? the file needs {1}"
"""Sentence for what a driver finds behind the last line; {1} is what the file is to define."""


def explain(text: str, wrapped: Wrapped) -> ShaderError:
    """Convert moderngl's error text to diagnostics in the kernel's own files."""
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
    match, chain = DEFINED.search(message), CHAIN.search(message)
    if match is None and chain is None:
        return None
    tree = symbols_of(source.code, all_branches=True).tree
    kind, name, arguments = match.groups() if match else ("", chain[1] if chain else "", "")
    types = [words.split()[0] for words in arguments.split(",") if words.split()]
    defined = [
        node
        for node in tree.declarations
        if isinstance(node, Function) and node.name == name and node.body and kind in ("", node.type.name)
    ]
    fitting = [node for node in defined if [one.type.name for one in node.parameters] == types]
    return next((source.lines[tree.line(node.at)] for node in (*fitting, *defined)), None)


DEFINED = re.compile(r"function [`'\"](\w+) (\w+)\(([^)]*)\)[`'\"]")
CHAIN = re.compile(r"call chain: (\w+)")


def _column_of(message: str, code: str) -> int:
    """Find the name that a message quotes, for drivers that give no column."""
    for name in re.findall(r"[`'\"]([A-Za-z_]\w*)['\"]", message):
        if (column := place_of(code, name)) >= 0:
            return column + 1
    return 0
