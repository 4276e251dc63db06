"""Complete what is typed in a shader: names, includes, options of pragmas, annotations."""

from __future__ import annotations

import re
from collections.abc import Iterable

from lsprotocol import types

from playground.allowed_files import names_below
from playground.engine.meshes import MESHES
from playground.engine.sources import SOURCES
from playground.lsp import describe
from playground.lsp.documents import Document, Documents, Text
from playground.lsp.names import locals_of
from playground.lsp.shader import Shader, is_code, library_declared, shader_of, word_at
from playground.paths import GLSL, SKETCHES
from playground.shader.header import FALLBACKS, MODIFIERS
from playground.shader.kernel import FORMATS, PRAGMAS, Option, options_of
from playground.shader.libraries import libraries
from playground.shader.outline import code_of
from playground.shader.reserved_names import GLSL_WORDS
from playground.shader.widgets import WIDGETS

Kind = types.CompletionItemKind
_INCLUDE = re.compile(r"\s*#\s*include\s*[\"<]([^\">]*)$")
_PRAGMA = re.compile(r"\s*#\s*pragma\s+(?:(\w+)\s*\((.*)|(\w*))$", re.DOTALL)
_OPTION = re.compile(r"(\w+)\s*=\s*\"([^\"]*)$")
_UNIFORM = re.compile(r"\s*uniform\s+(\w+)\s+\w+")
_SAMPLING = ("nearest", "linear", "clamp", "repeat", "mipmap")
_KINDS = {
    "function": Kind.Function,
    "struct": Kind.Struct,
    "variable": Kind.Constant,
    "uniform": Kind.Variable,
    "macro": Kind.Constant,
}


def complete_shader(document: Document, documents: Documents, at: int) -> list[types.CompletionItem]:
    """Return what may stand at a place of a shader."""
    text = document.text
    line = text.rfind("\n", 0, at) + 1
    before = text[line:at]
    if include := _INCLUDE.match(before):
        return _includes(document, include[1], at)
    if pragma := _PRAGMA.match(before):
        return _pragma(pragma)
    if "//!" in before:
        return _annotation(text[line:at], _uniform_above(text, line))
    if not before.strip() or before.lstrip().startswith("#"):
        return [] if before.lstrip().startswith("#") else _names(document, documents, at)
    last = len(before) - 1
    if not before[last].isspace() and not is_code(text, line + last):
        return []
    if "//" in before and "//" not in code_of(text)[line:at]:
        return []
    return _names(document, documents, at)


def item(
    label: str, kind: types.CompletionItemKind, detail: str = "", about: str = "", order: int = 5
) -> types.CompletionItem:
    """Return one thing that may stand there; a lower ``order`` is listed first."""
    markdown = types.MarkupContent(types.MarkupKind.Markdown, about) if about else None
    return types.CompletionItem(
        label, kind=kind, detail=detail or None, documentation=markdown, sort_text=f"{order}{label}"
    )


def replacing(items: Iterable[types.CompletionItem], text: Text, start: int, end: int) -> None:
    """Have completions replace a part of the text: what is typed may hold dots and slashes."""
    edit_range = text.range(start, end)
    for entry in items:
        entry.text_edit = types.TextEdit(edit_range, entry.insert_text or entry.label)
        entry.filter_text = entry.label
        entry.insert_text = None


def _includes(document: Document, typed: str, at: int) -> list[types.CompletionItem]:
    in_library = document.path.is_relative_to(GLSL) and not document.path.is_relative_to(SKETCHES)
    folders = (GLSL,) if in_library else (document.path.parent, document.root, GLSL)
    names: dict[str, str] = {}
    for folder in dict.fromkeys(folders):
        for name in names_below((folder,), (".glsl",)):
            if (folder / name) != document.path and not name.startswith("sketches/"):
                names.setdefault(name, "glsl" if folder == GLSL else "")
    for library, folder in libraries().items() if "/" in typed else ():
        if typed.startswith(f"{library}/"):
            names |= dict.fromkeys(
                (f"{library}/{name}" for name in names_below((folder,), (".glsl",))), library
            )
    names |= dict.fromkeys((f"{name}/" for name in libraries()), "library")
    items = [item(name, Kind.File, origin) for name, origin in names.items()]
    replacing(items, document, at - len(typed), at)
    return items


def _pragma(match: re.Match[str]) -> list[types.CompletionItem]:
    kind, inside, is_started = match.groups()
    if is_started is not None:
        return [item(name, Kind.Keyword) for name in PRAGMAS]
    if kind not in PRAGMAS:
        return []
    rows = options_of(PRAGMAS[kind])
    if value := _OPTION.search(inside):
        return _choices(rows.get(value[1]))
    if inside.count('"') % 2:  # one that may stand without its name
        return _choices(next((row for row in rows.values() if row.positional), None))
    options = re.findall(r"(\w+)\s*=", inside)
    result = [row for name, row in rows.items() if name not in options]
    return [item(row.name, Kind.Property, f"#pragma {kind}", row.about) for row in result]


def _choices(row: Option | None) -> list[types.CompletionItem]:
    """Return what an option may be."""
    if row is None:
        return []
    listed = {"mesh": tuple(MESHES), "name": tuple(SOURCES), "output": FORMATS}
    names = listed.get(row.name, row.choices)
    return [item(name, Kind.EnumMember) for name in names]


def _uniform_above(text: str, line: int) -> str:
    """Return the GLSL type of the uniform whose annotation a line has, or goes on with."""
    lines = text[: text.find("\n", line) if text.find("\n", line) >= 0 else len(text)].split("\n")
    while len(lines) > 1 and lines[-1].lstrip().startswith("//!"):
        lines.pop()
    match = _UNIFORM.match(lines[-1])
    return match[1] if match else ""


def _annotation(before: str, glsl_type: str) -> list[types.CompletionItem]:
    written = before.partition("//!")[2]
    if written.count('"') % 2:
        return []
    if written.count("(") > written.count(")"):
        word = re.findall(r"(\w+)\s*\(", written)[-1:]
        if word in (["input"], ["file"]):
            words = (*_SAMPLING, *(FALLBACKS if word == ["input"] else ("paint",)))
            return [item(choice, Kind.EnumMember) for choice in words]
        return []
    items = []
    if not re.search(r"\w", written.replace(re.split(r"\W", written)[-1], "", 1)):
        items = [
            item(name, Kind.Keyword, kind.takes, kind.about, order=1)
            for name, kind in WIDGETS.items()
            if name != "number" and glsl_type in kind.types
        ]
        if glsl_type == "sampler2D":
            items.append(item("input", Kind.Keyword, order=1))
    used = set(re.findall(r"\w+", written))
    return items + [item(f"{name}()", Kind.Keyword, order=2) for name in sorted(MODIFIERS - used)]


def _names(document: Document, documents: Documents, at: int) -> list[types.CompletionItem]:
    shader = shader_of(document, documents)
    start = word_at(document.text, at)[1]
    if start and document.text[start - 1] == ".":  # a component or a member
        return _members(shader)
    items: dict[str, types.CompletionItem] = {}
    function = shader.function_at(at)
    for local in locals_of(document.text, function) if function is not None else ():
        if local.seen <= start < local.end:
            items[local.name] = item(local.name, Kind.Variable, order=1)
    for parameter in shader.parameters:
        about = describe.parameter(parameter)
        items.setdefault(parameter.name, item(parameter.name, Kind.Variable, parameter.type, about, 2))
    if shader.is_kernel:
        for name, (glsl_type, meaning) in shader.engine_names.items():
            items.setdefault(name, item(name, Kind.Variable, glsl_type, meaning, 2))
    for path, _, declaration in shader.declared():
        if not (path == document.path and declaration.at == start):
            about = describe.declared(declaration, path)
            items.setdefault(
                declaration.name,
                item(declaration.name, _KINDS[declaration.kind], declaration.signature, about, 3),
            )
    typed = document.text[start:at]
    if typed:
        for name, places in library_declared().items():
            if name not in items and name[:1].lower() == typed[:1].lower():
                file, declaration = places[0]
                items[name] = _from_library(
                    document, file, declaration.signature, describe.declared(declaration, GLSL / file), name
                )
        for name in GLSL_WORDS:
            if name[:1].lower() == typed[:1].lower():
                items.setdefault(name, item(name, Kind.Keyword, order=6))
    items.pop("", None)
    return list(items.values())


def _members(shader: Shader) -> list[types.CompletionItem]:
    """Return the members of every struct that the text knows."""
    items: dict[str, types.CompletionItem] = {}
    for _, _, declaration in shader.declared():
        if declaration.kind == "struct":
            for glsl_type, name in re.findall(r"(\w+)\s+(\w+)\s*(?:\[[^\]]*\])?;", declaration.signature):
                items.setdefault(name, item(name, Kind.Field, f"{glsl_type} of {declaration.name}"))
    return list(items.values())


def _from_library(
    document: Document, file: str, signature: str, about: str, name: str
) -> types.CompletionItem:
    """Return a function of the library, and the include that it needs."""
    from_library = item(name, Kind.Function, signature, f'{about}\n\nadds `#include "{file}"`', 4)
    row = include_row(document)
    position = types.Position(row, 0)
    from_library.additional_text_edits = [
        types.TextEdit(types.Range(position, position), f'#include "{file}"\n')
    ]
    return from_library


def include_row(text: Text) -> int:
    """Return the line that an include is added before: behind the first run of them, or behind the header."""
    rows = [row for row, line in enumerate(text.lines) if re.match(r"\s*#\s*include\b", line)]
    if rows:
        row = rows[0]
        while row + 1 in rows:
            row += 1
        return row + 1
    return next((row for row, line in enumerate(text.lines) if not line.startswith("//")), 0)
