"""Completion in kernels and in sketches."""

from __future__ import annotations

import re
from collections.abc import Iterable

from lsprotocol import types

from playground.allowed_files import is_variant, names_below
from playground.engine.meshes import MESHES
from playground.engine.sources import SOURCES
from playground.lsp import describe
from playground.lsp.documents import Document, Documents, Text
from playground.lsp.names import is_comment, syntax_of, word_at
from playground.lsp.shader import Shader, library_declared, shader_of
from playground.lsp.sketch_text import Cursor, SketchText, cursor_at, own_techniques
from playground.paths import GLSL, SKETCHES
from playground.shader.header import FALLBACKS, MODIFIERS
from playground.shader.kernel import FORMATS, PRAGMAS, Option, options_of
from playground.shader.libraries import libraries
from playground.shader.parameter import spell
from playground.shader.reserved_names import GLSL_WORDS
from playground.shader.syntax.nodes import Struct
from playground.shader.syntax.types import components
from playground.shader.widgets import WIDGETS
from playground.sketch import toml_table
from playground.sketch.assign import all_paths, find_targets
from playground.sketch.find import shipped_names
from playground.sketch.keyframes import EASES
from playground.sketch.model import Parameter, Technique
from playground.sketch.toml_sketch import TECHNIQUE_KEYS
from playground.sketch.wiring import input_names, output_names

# ── kernels ────────────────────────────────────────────────────────────────────


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
    return [] if is_comment(text, at) else _names(document, documents, at)


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
        return _members(shader, start - 1)
    items: dict[str, types.CompletionItem] = {}
    for name, local in syntax_of(document.text).visible(start).items():
        items[name] = item(name, Kind.Variable, local.type, order=1)
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


def _members(shader: Shader, dot: int) -> list[types.CompletionItem]:
    """Return the members of the struct before a dot; of every struct, where its type is not known."""
    structs = {s.name: s.node for s in shader.unit.syntax.symbols.symbols if isinstance(s.node, Struct)}
    glsl_type = shader.type_before(dot)
    items: dict[str, types.CompletionItem] = {}
    for struct, node in structs.items() if glsl_type not in structs else [(glsl_type, structs[glsl_type])]:
        for member in node.members if not components(glsl_type)[1] else ():
            for name in member.names:
                items.setdefault(name.name, item(name.name, Kind.Field, f"{member.type.name} of {struct}"))
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


# ── sketches ───────────────────────────────────────────────────────────────────


_CHOICES: dict[str, tuple[object, ...]] = {
    "ease": EASES,
    "samples": (1, 2, 4, 8),
    "above_ground": (True, False),
    "format": (1,),
}
"""Key → what it may be."""


def complete_sketch(document: Document, documents: Documents, at: int) -> list[types.CompletionItem]:
    """Return what may stand at a place of a sketch or of a technique of several passes."""
    cursor = cursor_at(document.text, at)
    row = document.text.rfind("\n", 0, at) + 1
    end = document.text.find("\n", at)
    end = end if end >= 0 else len(document.text)
    with documents.reading():
        whole = SketchText(document, f"{document.text[:row]}{' ' * (end - row)}{document.text[end:]}")
        items = _Completion(whole, cursor, SketchText(document)).items()
    replacing(items, document, cursor.start, at)
    return items


class _Completion:
    """What may stand at one place."""

    def __init__(self, others: SketchText, cursor: Cursor, whole: SketchText) -> None:
        self.sketch = others  # without the line that is typed
        self.cursor = cursor
        self.whole = whole

    def items(self) -> list[types.CompletionItem]:
        cursor = self.cursor
        if cursor.is_header:
            return self._headers()
        head = cursor.table[0] if cursor.table else ""
        keys = tuple(str(key) for key in cursor.table[2 if head in toml_table.LISTS else 1 :]) + cursor.keys
        return self._values(str(head), keys) if cursor.is_value else self._keys(str(head), keys)

    def _headers(self) -> list[types.CompletionItem]:
        names = [*toml_table.LISTS, "view", *TECHNIQUE_KEYS]
        sketch = toml_table.SKETCH | toml_table.TECHNIQUE
        return [item(name, Kind.Module, "", sketch[name]) for name in names]

    # ── keys ─────────────────────────────────────────────────────────────────

    def _keys(self, head: str, keys: tuple[str, ...]) -> list[types.CompletionItem]:
        if not keys:
            table = toml_table.TABLES.get(head, {}) if head else toml_table.SKETCH | toml_table.TECHNIQUE
            return [item(key, Kind.Property, "", meaning) for key, meaning in table.items()]
        if keys == ("camera",):
            return [item(key, Kind.Property, "", meaning) for key, meaning in toml_table.CAMERA.items()]
        if keys[0] == "set":
            return self._settable(head, keys[1:])
        technique = self._technique(head)
        if keys == ("inputs",) and technique is not None:
            return [item(self._key(name), Kind.Field, "input") for name in input_names(technique)]
        if keys == ("feedback",) and technique is not None:
            return [item(self._key(name), Kind.Field, "input") for name in input_names(technique)]
        if keys == ("steps",):
            return [item(self._key(name), Kind.Module) for name in self.sketch.names("pass")]
        return []

    def _settable(self, head: str, keys: tuple[str, ...]) -> list[types.CompletionItem]:
        if keys:
            parameter = self._parameter(head, ".".join(keys))
            if parameter is not None and parameter.widget.kind == "direction":
                return [item(name, Kind.Field, "degrees") for name in ("azimuth", "elevation")]
            return []
        if head in ("pass", "view"):
            technique = self._technique(head)
            return self._parameters(technique, "") if technique is not None else []
        items = []
        for name in (*self.sketch.names("pass"), "view"):
            technique = self.sketch.technique_of(name)
            items += self._parameters(technique, f"{name}.") if technique is not None else []
        return items

    def _parameters(self, technique: Technique, prefix: str) -> list[types.CompletionItem]:
        items = []
        for path in all_paths(technique):
            for target in find_targets(technique, path)[:1]:
                about = describe.parameter(target.parameter)
                order = 2 if "." in path else 1
                label = self._key(f"{prefix}{path}")
                items.append(item(label, Kind.Variable, target.parameter.type, about, order))
        return items

    def _key(self, name: str) -> str:
        """Return a key as it is written where the cursor is: one with dots has quotes."""
        return f'"{name}"' if "." in name and not self.cursor.quoted else name

    # ── values ───────────────────────────────────────────────────────────────

    def _values(self, head: str, keys: tuple[str, ...]) -> list[types.CompletionItem]:
        key = keys[0] if keys else ""
        if key == "use" and head in ("pass", "view"):
            own = own_techniques(self.sketch.path.parent)
            names = [*own, *(name for name in shipped_names() if self._may_be_used(name))]
            return [self._text(name, Kind.Module) for name in names]
        if key == "inputs":
            return self._sources()
        if key == "feedback" and (technique := self._technique(head)) is not None:
            return [self._text(name, Kind.Field) for name in output_names(technique)]
        if key == "preset" and head == "shot":
            return [self._text(name, Kind.EnumMember) for name in self.whole.names("preset")]
        if key == "main" and not head:
            items = []
            for name in (*self.sketch.names("pass"), "view"):
                technique = self.sketch.technique_of(name)
                for path in all_paths(technique) if technique is not None else ():
                    items.append(self._text(f"{name}.{path}", Kind.Variable, 2 if "." in path else 1))
            return items
        if key == "set" and len(keys) > 1:
            parameter = self._parameter(head, ".".join(keys[1:]))
            return self._of_parameter(parameter) if parameter is not None else []
        if head in ("parameters", "outputs"):
            return self._inside(head)
        return [self._choice(entry) for entry in _CHOICES.get(key, ())]

    def _choice(self, value: object) -> types.CompletionItem:
        return (
            self._text(value, Kind.EnumMember)
            if isinstance(value, str)
            else item(spell(value), Kind.EnumMember)
        )

    def _sources(self) -> list[types.CompletionItem]:
        result = []
        for name, table in self.sketch.names("pass").items():
            if table == self.cursor.table:
                continue
            technique = self.sketch.technique(table)
            result.append(self._text(name, Kind.Module))
            outputs = output_names(technique) if technique is not None else ()
            if len(outputs) > 1:
                result += [self._text(f"{name}:{output}", Kind.Field, 6) for output in outputs]
        inputs = [str(position[-1]) for position in self.sketch.places.pairs if position[:1] == ("inputs",)]
        return [*result, *(self._text(name, Kind.Field) for name in inputs)]

    def _inside(self, head: str) -> list[types.CompletionItem]:
        """Return what a technique shows outside: paths of parameters, or outputs, of its passes."""
        items = []
        for name in self.sketch.names("pass"):
            technique = self.sketch.technique_of(name)
            if technique is not None and head == "parameters":
                items += [self._text(f"{name}.{path}", Kind.Variable) for path in all_paths(technique)]
            elif technique is not None:
                items += [self._text(f"{name}:{output}", Kind.Field) for output in output_names(technique)]
        return items

    def _of_parameter(self, parameter: Parameter) -> list[types.CompletionItem]:
        if parameter.widget.choices:
            return [self._text(choice, Kind.EnumMember) for choice in parameter.widget.choices]
        if parameter.type == "bool":
            return [item(word, Kind.EnumMember) for word in ("true", "false")]
        return []

    def _text(self, text: str, kind: types.CompletionItemKind, order: int = 5) -> types.CompletionItem:
        """Return a text as it is written where the cursor is: in quotes, unless one was opened."""
        return item(text if self.cursor.quoted else f'"{text}"', kind, order=order)

    def _may_be_used(self, name: str) -> bool:
        return not is_variant(self.sketch.path.with_name(f"{name.rpartition('/')[2]}.toml"))

    def _technique(self, head: str) -> Technique | None:
        """Return what fills the pass that the cursor is in; ``use`` may be on its own line."""
        table = self.cursor.table[: 2 if head in toml_table.LISTS else 1]
        return self.sketch.technique(table) or self.whole.technique(table)

    def _parameter(self, head: str, path: str) -> Parameter | None:
        table = self.cursor.table[: 2 if head in toml_table.LISTS else 1]
        return self.sketch.parameter(table, path) or self.whole.parameter(table, path)
