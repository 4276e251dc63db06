"""Colour boxes: the colours of a kernel's defaults and of a sketch's values, and how a new one is written.

A kernel's literal is linear and an editor's colour is encoded, unless the parameter is ``colour("raw")``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from lsprotocol import types

from playground.errors import DataError
from playground.lsp.documents import Document, Documents
from playground.lsp.shader import shader_of
from playground.lsp.sketch_text import SketchText
from playground.shader.colours import parse_hex, to_hex
from playground.sketch.model import Parameter

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
