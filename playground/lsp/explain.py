"""Hover, go to definition, and the symbols of a file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from lsprotocol import types

from playground.errors import PlaygroundError
from playground.lsp import describe
from playground.lsp.documents import Document, Documents, Text
from playground.lsp.names import local_at, locals_of
from playground.lsp.shader import include_at, is_code, library_declared, shader_of, word_at
from playground.lsp.sketch_text import SketchText
from playground.paths import GLSL, shown
from playground.shader.header import title_of
from playground.shader.outline import outline
from playground.shader.reserved_names import DRIVER_BOUND, RESERVED
from playground.shader.source import find_include, read_source, read_text
from playground.sketch import toml_table
from playground.sketch.toml_text import KeyPath, Pair
from playground.sketch.wiring import inner

_SYMBOLS = {
    "function": types.SymbolKind.Function,
    "struct": types.SymbolKind.Struct,
    "variable": types.SymbolKind.Constant,
    "uniform": types.SymbolKind.Variable,
    "macro": types.SymbolKind.Constant,
}


@dataclass(frozen=True, slots=True)
class Target:
    """A place that something leads to."""

    path: Path
    start: int
    end: int


# ── shaders ──────────────────────────────────────────────────────────────────


def hover_shader(document: Document, documents: Documents, at: int) -> str:
    """Return what is known of what stands at a place of a shader, as Markdown; "" for nothing."""
    if include := include_at(document.text, at):
        with documents.reading():
            include_path = find_include(include.name, document.path, (document.root,))
            if include_path is None:
                return ""
            try:
                title = title_of(read_source(include_path, (document.root,)))
            except PlaygroundError:
                title = ""
            return "\n\n".join(filter(None, [f"*{shown(include_path)}*", title]))
    word, start = word_at(document.text, at)
    if not word:
        return ""
    if not is_code(document.text, start):
        return ""
    shader = shader_of(document, documents)
    function = shader.function_at(start)
    local = local_at(locals_of(document.text, function), word, start) if function is not None else None
    if local is not None:
        row = document.position(local.at).line
        return describe.code(document.lines[row].strip())
    if (parameter := shader.parameter(word)) is not None:
        return describe.parameter(parameter)
    if shader.is_kernel and word in (names := shader.engine_names):
        glsl_type, meaning = names[word]
        brackets = "()" if word in RESERVED or word.startswith("previous") else ""
        return f"{describe.code(f'{glsl_type} {word}{brackets}')}\n\n{meaning}"
    found_here = [
        (path, declaration) for path, _, declaration in shader.declared() if declaration.name == word
    ]
    found_here.sort(key=lambda item: item[1].is_prototype)
    if found_here:
        return "\n\n---\n\n".join(
            describe.declared(declaration, path) for path, declaration in found_here[:4]
        )
    if word in DRIVER_BOUND and shader.is_kernel:
        return f"A kernel may not use `{word}`: {DRIVER_BOUND[word]}"
    for file, declaration in library_declared().get(word, ())[:1]:
        return f'{describe.declared(declaration, GLSL / file)}\n\nneeds `#include "{file}"`'
    return ""


def define_shader(document: Document, documents: Documents, at: int) -> Target | None:
    """Return where what stands at a place of a shader is declared: a file, or a name in one."""
    if include := include_at(document.text, at):
        with documents.reading():
            include_path = find_include(include.name, document.path, (document.root,))
        return Target(include_path, 0, 0) if include_path is not None else None
    word, start = word_at(document.text, at)
    if not word or not is_code(document.text, start):
        return None
    location = shader_of(document, documents).find(word, start)
    return Target(location.path, location.at, location.at + location.length) if location is not None else None


def symbols_of_shader(document: Document) -> list[types.DocumentSymbol]:
    """Return what a shader declares."""
    symbols = []
    for declaration in outline(document.text):
        whole = document.range(
            declaration.start, max(declaration.end, declaration.at + len(declaration.name))
        )
        name = document.range(declaration.at, declaration.at + len(declaration.name))
        symbols.append(
            types.DocumentSymbol(
                declaration.name, _SYMBOLS[declaration.kind], whole, name, detail=declaration.signature[:120]
            )
        )
    return symbols


# ── sketches ─────────────────────────────────────────────────────────────────


def hover_sketch(document: Document, documents: Documents, at: int) -> str:
    """Return what is known of what stands at a place of a sketch, as Markdown; "" for nothing."""
    with documents.reading():
        sketch = SketchText(document)
        key_path, pair = _pair_at(sketch, at)
        if pair is None:
            name = _header_at(document, sketch, at)
            return (toml_table.SKETCH | toml_table.TECHNIQUE).get(name, "")
        table, keys = _parted(key_path)
        if keys[:1] == ("set",) and len(keys) > 1:
            parameter = sketch.parameter(table, ".".join(keys[1:]))
            return describe.parameter(parameter) if parameter is not None else ""
        if keys == ("use",) and at >= pair.value:
            technique = sketch.technique(table)
            return describe.technique(sketch.value(key_path), technique) if technique is not None else ""
        if keys[:1] == ("inputs",) and len(keys) > 1 and at >= pair.value:
            name = sketch.value(key_path).partition(":")[0].partition(".")[0]
            technique = sketch.technique_of(name)
            return describe.technique(name, technique) if technique is not None else ""
        head = str(table[0]) if table else ""
        keys_of_table = toml_table.TABLES.get(head, {}) if head else toml_table.SKETCH | toml_table.TECHNIQUE
        if keys[:1] == ("camera",) and len(keys) > 1:
            return toml_table.CAMERA.get(keys[1], "")
        return keys_of_table.get(keys[0], "") if len(keys) == 1 else ""


def define_sketch(document: Document, documents: Documents, at: int) -> Target | None:
    """Return where what stands at a place of a sketch is: a technique's file, a pass, a parameter."""
    with documents.reading():
        sketch = SketchText(document)
        key_path, pair = _pair_at(sketch, at)
        if pair is None:
            return None
        table, keys = _parted(key_path)
        if keys == ("use",):
            technique = sketch.technique(table)
            return Target(Path(technique.path), 0, 0) if technique is not None else None
        if keys[:1] == ("inputs",) and len(keys) > 1 and at >= pair.value:
            where = sketch.value(key_path).partition(":")[0]
            head, _, rest = where.partition(".")
            if rest and (technique := sketch.technique_of(head)) is not None:
                technique_inside = inner(technique, rest)
                return Target(Path(technique_inside.path), 0, 0) if technique_inside is not None else None
            return _table_target(document, sketch, sketch.names("pass").get(head))
        if keys == ("preset",):
            return _table_target(document, sketch, sketch.names("preset").get(sketch.value(key_path)))
        if keys[:1] == ("set",) and len(keys) > 1:
            parameter = sketch.parameter(table, ".".join(keys[1:]))
            if parameter is not None and parameter.file:
                return _line_target(Path(parameter.file), parameter.line, parameter.name)
        return None


def symbols_of_sketch(document: Document) -> list[types.DocumentSymbol]:
    """Return the tables of a sketch by their names."""
    sketch = SketchText(document)
    symbols = []
    headers = sketch.places.headers
    tables = [table_path for table_path in sketch.places.bodies if table_path]
    for header, table_path in zip(headers, tables, strict=False):
        end = sketch.places.bodies[table_path]
        name = sketch.value((*table_path, "name"))
        title = f"{header.keys[0]} {name}".strip()
        start = header.start
        line = document.text.find("\n", start)
        whole = document.range(start, max(end, start + 1))
        head = document.range(start, min(line if line >= 0 else len(document.text), max(end, start + 1)))
        symbols.append(types.DocumentSymbol(title, types.SymbolKind.Object, whole, head))
    return symbols


def _pair_at(sketch: SketchText, at: int) -> tuple[KeyPath, Pair | None]:
    """Return the innermost key and value that a place is in."""
    around = [
        (key_path, pair) for key_path, pair in sketch.places.pairs.items() if pair.key <= at <= pair.end
    ]
    return max(around, key=lambda item: item[1].key, default=((), None))


def _parted(key_path: KeyPath) -> tuple[KeyPath, tuple[str, ...]]:
    """Return a place's table, one with a header, and the keys in it."""
    size = 0
    if key_path and key_path[0] in toml_table.LISTS:
        size = 2
    elif len(key_path) > 1 and key_path[0] == "view":
        size = 1
    return key_path[:size], tuple(str(key) for key in key_path[size:])


def _header_at(document: Document, sketch: SketchText, at: int) -> str:
    row = document.position(at).line
    rows = {document.position(header.start).line: header.keys[0] for header in sketch.places.headers}
    return rows.get(row, "")


def _table_target(document: Document, sketch: SketchText, table: KeyPath | None) -> Target | None:
    pair = sketch.places.pairs.get((*table, "name")) if table is not None else None
    return Target(document.path, pair.key, pair.end) if pair is not None else None


def _line_target(path: Path, line: int, name: str) -> Target:
    """Return a name on a line of a file, counted from 1."""
    text = Text(read_text(path), len)
    start = text.line_start(line - 1)
    index = text.text.find(name, start)
    return Target(path, max(index, start), max(index, start) + len(name))
