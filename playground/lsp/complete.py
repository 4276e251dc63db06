"""Completion in kernels and in sketches."""

from __future__ import annotations

from collections.abc import Iterable

from lsprotocol import types

from playground.allowed_files import is_variant
from playground.engine.meshes import MESHES
from playground.engine.sources import SOURCES
from playground.lsp import describe
from playground.lsp.documents import Document, Documents, Text
from playground.lsp.sketch_text import Cursor, SketchText, cursor_at, own_techniques
from playground.shader.parameter import spell
from playground.sketch import toml_table
from playground.sketch.assign import all_paths, find_targets
from playground.sketch.find import shipped_names
from playground.sketch.keyframes import EASES
from playground.sketch.model import Parameter, Technique
from playground.sketch.suggestions import Suggestion, include_row, suggestions
from playground.sketch.toml_sketch import TECHNIQUE_KEYS
from playground.sketch.wiring import input_names, output_names

# ── kernels ────────────────────────────────────────────────────────────────────


Kind = types.CompletionItemKind
_KINDS = {
    "function": Kind.Function,
    "struct": Kind.Struct,
    "variable": Kind.Constant,
    "uniform": Kind.Variable,
    "macro": Kind.Constant,
    "keyword": Kind.Keyword,
    "property": Kind.Property,
    "choice": Kind.EnumMember,
    "field": Kind.Field,
    "file": Kind.File,
}


def complete_shader(document: Document, documents: Documents, at: int) -> list[types.CompletionItem]:
    """Return what may stand at a place of a shader."""
    listed = {"mesh": tuple(MESHES), "name": tuple(SOURCES)}
    with documents.reading():
        found = suggestions(document.path, document.text, document.root, at, listed)
    return [_item_of(suggestion, document, at) for suggestion in found]


def _item_of(suggestion: Suggestion, document: Document, at: int) -> types.CompletionItem:
    about, origin = suggestion.about, suggestion.origin
    kind = _KINDS[suggestion.kind]
    if isinstance(origin, tuple):
        about = describe.declared(origin[1], origin[0])
    elif origin is not None:
        about = describe.parameter(origin)
    if suggestion.kind == "variable" and not isinstance(origin, tuple):
        kind = Kind.Variable
    if suggestion.include:
        about += f'\n\nadds `#include "{suggestion.include}"`'
    made = item(suggestion.label, kind, suggestion.detail, about, suggestion.order)
    if suggestion.include:
        position = types.Position(include_row(document.text), 0)
        edit_range = types.Range(position, position)
        made.additional_text_edits = [types.TextEdit(edit_range, f'#include "{suggestion.include}"\n')]
    if suggestion.start >= 0:
        replacing([made], document, suggestion.start, at)
    return made


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
