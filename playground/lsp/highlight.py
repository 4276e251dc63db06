"""What an editor colours in a shader: a name's places, what a uniform can change, each name by its kind."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import groupby
from pathlib import Path

from lsprotocol import types

from playground.errors import Diagnostic
from playground.lsp.documents import Document, Documents
from playground.paths import shown
from playground.shader.names import Syntax, syntax_of, word_at, words
from playground.shader.reserved_names import GLSL_WORDS, MATCHES, TOWARDS, WIRED
from playground.shader.syntax.influence import Influence, unused
from playground.shader.syntax.nodes import (
    Assign,
    Declarator,
    Index,
    Member,
    Name,
    Node,
    Parameter,
    Unary,
    walk,
)
from playground.shader.syntax.symbols import Symbol
from playground.sketch.edited import shader_of
from playground.sketch.shader_names import Shader

LEGEND = types.SemanticTokensLegend(
    ["function", "variable", "parameter", "property", "struct", "macro"],
    ["declaration", "readonly", "defaultLibrary"],
)
"""Kinds of names, and what else is said of them, by number."""

_KINDS = {
    "function": 0,
    "uniform": 1,
    "variable": 1,
    "local": 1,
    "block": 1,
    "parameter": 2,
    "member": 3,
    "struct": 4,
}
_OF_PRAGMAS = [
    "size",
    "spacing",
    "iteration",
    "iterations",
    "until",
    "previous",
]  # what a repeat or a size sets
_MAX_RANGES = 16  # of lines in a hover
_DECLARATION, _READONLY, _GIVEN = 1, 2, 4


# ── what a name can change ─────────────────────────────────────────────────────


def influence(shader: Shader, name: str, at: int) -> list[tuple[Path, int, int]] | None:
    """Return what the uniform, parameter or given name at a place can change: file, beginning and end.

    None for every other name.
    """
    unit = shader.unit
    syntax = unit.syntax
    names: list[Symbol | str] = [*_symbols_of(syntax, name, set(unit.places(shader.path, at)))]
    if not names and name not in (*shader.engine_names, *(p.name for p in shader.parameters)):
        return None
    if shader.parameter(name) is not None:
        names += [f"{prefix}{name}" for prefix in (TOWARDS, WIRED, MATCHES)]
        if any(word.text == name for word in words(_pragmas(shader))):
            names += _OF_PRAGMAS
    if name in shader.engine_names:
        names.append(name)
    found = []
    for node in Influence(syntax.symbols).statements(names):
        (path, start), (last, end) = (unit.origin(place) for place in _ends(syntax, node))
        found.append((path, start, end + 1 if last == path else start + 1))
    return found


def _pragmas(shader: Shader) -> str:
    """Return what the quotes of a kernel's pragmas hold: expressions of its parameters among it."""
    directives = syntax_of(shader.text).tree.preprocessed.directives
    return " ".join(part for each in directives for part in each.text.split('"')[1::2])


def _symbols_of(syntax: Syntax, name: str, places: set[int]) -> Iterator[Symbol]:
    meant = {each.meaning for each in syntax.occurrences(name) if each.at in places}
    for symbol in syntax.symbols.symbols:
        if symbol.name == name and symbol.kind in ("uniform", "parameter"):
            own = {each.meaning for each in syntax.occurrences(name) if each.at == syntax.place(symbol)}
            if own & meant:
                yield symbol


def _ends(syntax: Syntax, node: Node) -> tuple[int, int]:
    start, end = syntax.tree.span(node)
    return start, max(end - 1, start)


def influence_text(shader: Shader, name: str, at: int) -> str:
    """Return, as Markdown, the lines that a name can change; "" for one that is no uniform or parameter."""
    spans = influence(shader, name, at)
    if spans is None:
        return ""
    texts = dict(shader.files)
    lines: dict[Path, set[int]] = {}
    for path, start, end in spans:
        rows = (texts[path].count("\n", 0, place) + 1 for place in (start, end - 1))
        lines.setdefault(path, set()).update(range(next(rows), next(rows) + 1))
    own = sorted(lines.pop(shader.path, ()))
    parts = [f"lines {_ranges(own)}" if own else ""]
    parts += [f"{len(rows)} of {shown(path)}" for path, rows in lines.items()]
    return f"can change {'; '.join(filter(None, parts))}" if own or lines else "changes no line"


def _ranges(numbers: list[int]) -> str:
    """Return line numbers as people read them: 3, 5-8."""
    parts = []
    for _, run in groupby(enumerate(numbers), lambda entry: entry[1] - entry[0]):
        rows = [number for _, number in run]
        parts.append(str(rows[0]) if len(rows) == 1 else f"{rows[0]}-{rows[-1]}")
    return ", ".join(parts if len(parts) <= _MAX_RANGES else [*parts[:_MAX_RANGES], "…"])


# ── highlights ─────────────────────────────────────────────────────────────────


def highlights(document: Document, documents: Documents, at: int) -> list[types.DocumentHighlight]:
    """Return where a text has the name at a place; of a uniform's declaration, what it can change as well."""
    shader = shader_of(document, documents)
    name, start = word_at(document.text, at)
    unit = shader.unit
    is_own = bool(name) and name not in GLSL_WORDS
    meanings = unit.meanings(document.path, start, name) if is_own else set()
    places = [unit.origin(each.at) for each in unit.syntax.occurrences(name) if each.meaning in meanings]
    written = set(_written(syntax_of(document.text)))
    found = []
    for place in sorted({place for path, place in places if path == document.path}):
        kind = types.DocumentHighlightKind.Write if place in written else types.DocumentHighlightKind.Read
        found.append(types.DocumentHighlight(document.range(place, place + len(name)), kind))
    if any(p.name == name and p.file == str(document.path) for p in shader.parameters) and start in written:
        for path, begin, end in influence(shader, name, start) or ():
            if path == document.path:
                found.append(
                    types.DocumentHighlight(document.range(begin, end), types.DocumentHighlightKind.Text)
                )
    return found


def _written(syntax: Syntax) -> Iterator[int]:
    """Yield where a text declares or writes a variable."""
    tokens = syntax.tree.tokens
    for declaration in syntax.tree.declarations:
        for node in walk(declaration):
            target: Node | None = None
            if isinstance(node, Declarator | Parameter) and node.name:
                yield tokens[node.at].spelled
            elif isinstance(node, Assign):
                target = node.target
            elif isinstance(node, Unary) and node.operator in ("++", "--"):
                target = node.operand
            while isinstance(target, Member | Index):
                target = target.base
            if isinstance(target, Name):
                yield tokens[target.first].spelled


# ── what nothing names ─────────────────────────────────────────────────────────


def unused_names(document: Document, documents: Documents) -> list[Diagnostic]:
    """Return a hint at each local and parameter of a text that nothing names; none of one half typed."""
    unit = shader_of(document, documents).unit
    if not unit.syntax.is_whole:
        return []
    hints = []
    for symbol in unused(unit.syntax.symbols):
        path, at = unit.origin(unit.syntax.place(symbol))
        if path == document.path:
            row = document.text.count("\n", 0, at)
            column = at - document.line_start(row) + 1
            message = f"nothing reads {'the parameter ' * (symbol.kind == 'parameter')}'{symbol.name}'"
            hints.append(Diagnostic(message, shown(path), row + 1, column, "hint"))
    return hints


# ── semantic tokens ────────────────────────────────────────────────────────────


def semantic_tokens(document: Document, documents: Documents) -> types.SemanticTokens:
    """Return the kind of each name of a text, as the protocol encodes them."""
    shader = shader_of(document, documents)
    data: list[int] = []
    line = column = 0
    for place, length, kind, modifiers in sorted(_named(syntax_of(document.text), shader)):
        position = document.position(place)
        size = document.units(document.text[place : place + length])
        data += [position.line - line, position.character - (column if position.line == line else 0)]
        data += [size, kind, modifiers]
        line, column = position.line, position.character
    return types.SemanticTokens(data)


def _named(syntax: Syntax, shader: Shader) -> set[tuple[int, int, int, int]]:
    """Return place, length, kind and modifiers of each name."""
    around = {declaration.name: declaration.kind for _, _, declaration in shader.declared()}
    given = shader.engine_names if shader.is_kernel else {}
    found: dict[int, tuple[int, int, int, int]] = {}
    for reading in syntax.readings:
        for reference in reading.symbols.references:
            place, symbol = reading.spelled(reference.token), reference.symbol
            name = reading.tree.tokens[reference.token].text
            kind = symbol.kind if symbol is not None else around.get(name, "")
            modifiers = _DECLARATION * (symbol is not None and symbol.token == reference.token)
            if symbol is None and not kind and name in given:
                kind, modifiers = "uniform", _GIVEN
            if kind == "uniform" or (symbol is not None and "const" in symbol.qualifiers):
                modifiers |= _READONLY
            if kind in _KINDS and place >= 0 and name not in GLSL_WORDS:
                found[place] = (place, len(name), _KINDS[kind], modifiers)
        for declaration in reading.tree.declarations:
            for node in walk(declaration):
                if isinstance(node, Member) and (place := reading.spelled(node.at)) >= 0:
                    found.setdefault(place, (place, len(node.name), _KINDS["member"], 0))
        for macro in reading.tree.preprocessed.macros:
            found[macro.at] = (macro.at, len(macro.name), 5, _DECLARATION)
        for expansion in reading.tree.preprocessed.expansions:
            found[expansion.start] = (expansion.start, len(expansion.name), 5, 0)
    return set(found.values())
