"""Hover, go to definition, and the symbols of a file."""

from __future__ import annotations

import re
from collections.abc import Sequence

from lsprotocol import types

from playground.errors import DataError, PlaygroundError
from playground.lsp import describe
from playground.lsp.documents import Document, Documents
from playground.lsp.highlight import influence_text
from playground.paths import GLSL, shown
from playground.shader.colours import parse_hex, to_hex
from playground.shader.header import title_of
from playground.shader.names import include_at, is_code, syntax_of, word_at
from playground.shader.outline import outline
from playground.shader.reserved_names import DRIVER_BOUND, RESERVED
from playground.shader.source import find_include, read_source, read_text
from playground.shader.widgets import WIDGETS
from playground.sketch.edited import shader_of
from playground.sketch.model import Parameter
from playground.sketch.shader_names import DeclarationSite, library_declared
from playground.sketch.sketch_text import SketchText
from playground.sketch.toml_suggestions import declaration_in_sketch, meaning_in_sketch

_SYMBOLS = {
    "function": types.SymbolKind.Function,
    "struct": types.SymbolKind.Struct,
    "variable": types.SymbolKind.Constant,
    "uniform": types.SymbolKind.Variable,
    "macro": types.SymbolKind.Constant,
}


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
        before = document.text[document.text.rfind("\n", 0, start) + 1 : start]
        return describe.widget(word) if before.rstrip().endswith("//!") and word in WIDGETS else ""
    shader = shader_of(document, documents)
    local = syntax_of(document.text).local_at(word, start)
    if local is not None:
        row = document.position(syntax_of(document.text).place(local)).line
        changes = influence_text(shader, word, start) if local.kind == "parameter" else ""
        return "\n\n".join(filter(None, [describe.code(document.lines[row].strip()), changes]))
    if (parameter := shader.parameter(word)) is not None:
        return f"{describe.parameter(parameter)}\n\n{influence_text(shader, word, start)}"
    if shader.is_kernel and word in (names := shader.engine_names):
        glsl_type, meaning = names[word]
        brackets = "()" if word in RESERVED or word.startswith("previous") else ""
        head = describe.code(f"{glsl_type} {word}{brackets}")
        return f"{head}\n\n{meaning}\n\n{influence_text(shader, word, start)}"
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


def define_shader(document: Document, documents: Documents, at: int) -> DeclarationSite | None:
    """Return where what stands at a place of a shader is declared: a file, or a name in one."""
    if include := include_at(document.text, at):
        with documents.reading():
            include_path = find_include(include.name, document.path, (document.root,))
            return DeclarationSite(include_path, read_text(include_path), 0, 0) if include_path else None
    word, start = word_at(document.text, at)
    if not word or not is_code(document.text, start):
        return None
    return shader_of(document, documents).find(word, start)


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
        meaning = meaning_in_sketch(document, at)
    return describe.suggestion(meaning) if meaning is not None else ""


def define_sketch(document: Document, documents: Documents, at: int) -> DeclarationSite | None:
    """Return where what stands at a place of a sketch is: a technique's file, a pass, a parameter."""
    with documents.reading():
        return declaration_in_sketch(document, at)


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


# ── colour boxes ───────────────────────────────────────────────────────────────


_LITERAL = re.compile(r"(vec[34])\s*\(([^()]*)\)")
_HEX = re.compile(r"([\"'])(#[0-9a-fA-F]{3,8})\1")
_LIST = re.compile(r"\[([^\[\]]*)\]")


def colours_of_shader(document: Document, documents: Documents) -> list[types.ColorInformation]:
    """Return the colours that a shader's own colour parameters have as defaults."""
    colours = []
    for parameter in shader_of(document, documents).parameters:
        literal = _literal(document, parameter)
        if literal is not None and isinstance(parameter.default, tuple):
            shown = _encoded(parameter.default, parameter.widget.raw)
            colours.append(types.ColorInformation(document.range(*literal), shown))
    return colours


def present_in_shader(
    document: Document, documents: Documents, where: types.Range, colour: types.Color
) -> list[types.ColorPresentation]:
    """Return how a colour is written as the default of the parameter whose colour is at a place."""
    for parameter in shader_of(document, documents).parameters:
        literal = _literal(document, parameter)
        if literal is not None and document.range(*literal) == where:
            numbers = _decoded(colour, parameter.widget.raw)[: 3 if parameter.type == "vec3" else 4]
            text = f"{parameter.type}({', '.join(_number(n) for n in numbers)})"
            return [types.ColorPresentation(text, types.TextEdit(where, text))]
    return []


def colours_of_sketch(document: Document, documents: Documents) -> list[types.ColorInformation]:
    """Return the colours that a sketch sets: texts as "#8a9a5b", and numbers of colour parameters."""
    return [
        types.ColorInformation(document.range(start, end), _encoded(numbers, raw))
        for start, end, numbers, raw, _ in _values(document, documents)
    ]


def present_in_sketch(
    document: Document, documents: Documents, where: types.Range, colour: types.Color
) -> list[types.ColorPresentation]:
    """Return how a colour is written as the value that is at a place: in hexadecimal, or as numbers."""
    for start, end, numbers, raw, is_text in _values(document, documents):
        if document.range(start, end) != where:
            continue
        encoded = _decoded(colour, raw)[: len(numbers)]
        if is_text and (colour.alpha >= 1.0 or len(numbers) == 4):
            quote = document.text[start]
            text = f"{quote}{to_hex(encoded[:3] if colour.alpha >= 1.0 else encoded, raw=raw)}{quote}"
        else:
            text = f"[{', '.join(_number(n) for n in encoded)}]"
        return [types.ColorPresentation(text, types.TextEdit(where, text))]
    return []


def _values(document: Document, documents: Documents) -> list[tuple[int, int, tuple[float, ...], bool, bool]]:
    """Return each colour that is set: where, its linear numbers, whether raw, whether in hexadecimal."""
    values = []
    with documents.reading():
        sketch = SketchText(document)
        for table, path, pair in sketch.settings():
            parameter = sketch.parameter(table, path)
            if parameter is None or parameter.widget.kind != "colour":
                continue
            raw = parameter.widget.raw
            text = document.text[pair.value : pair.end]
            if match := _HEX.match(text):
                try:
                    numbers = parse_hex(match[2], raw=raw)
                except DataError:
                    continue
                values.append((pair.value, pair.value + match.end(), numbers, raw, True))
            elif match := _LIST.match(text):
                numbers = _numbers(match[1])
                if len(numbers) in (3, 4):
                    values.append((pair.value, pair.value + match.end(), numbers, raw, False))
    return values


def _literal(document: Document, parameter: Parameter) -> tuple[int, int] | None:
    """Return where a colour parameter's default is in its own file; None where that is another file."""
    if parameter.widget.kind != "colour" or parameter.file != str(document.path):
        return None
    start = document.line_start(parameter.line - 1)
    end = document.line_start(parameter.line)
    match = _LITERAL.search(document.text, start, end)
    return match.span() if match else None


def _encoded(linear: Sequence[float], raw: bool) -> types.Color:
    """Return a colour as an editor shows it, within 0..1."""
    alpha = min(max(float(linear[3]), 0.0), 1.0) if len(linear) > 3 else 1.0
    text = to_hex([float(n) for n in linear[:3]], raw=raw)
    red, green, blue = (int(text[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return types.Color(red, green, blue, alpha)


def _decoded(colour: types.Color, raw: bool) -> tuple[float, ...]:
    """Return an editor's colour as the playground has it, with its alpha."""
    hex_text = to_hex((colour.red, colour.green, colour.blue), raw=True)
    return (*parse_hex(hex_text, raw=raw), colour.alpha)


def _numbers(text: str) -> tuple[float, ...]:
    try:
        return tuple(float(part) for part in text.split(",") if part.strip())
    except ValueError:
        return ()


def _number(value: float) -> str:
    """Return a number as GLSL and TOML both write it."""
    text = f"{value:.4f}".rstrip("0")
    return f"{text}0" if text.endswith(".") else text
