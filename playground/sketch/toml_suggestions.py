"""What may stand at a place of a sketch's TOML, what stands there, and where that is declared; texts alone.

The language server and the code pane of the window show it, each in its own way. Who calls these has the
texts that are open read in place of their files (``EditedTexts.reading``).
"""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

from playground.allowed_files import is_variant
from playground.shader.parameter import spell
from playground.shader.source import read_text
from playground.sketch import toml_table
from playground.sketch.assign import all_paths, find_targets
from playground.sketch.edited import EditedText
from playground.sketch.find import shipped_names
from playground.sketch.keyframes import EASES
from playground.sketch.model import Parameter, Technique
from playground.sketch.shader_names import DeclarationSite
from playground.sketch.sketch_text import Cursor, SketchText, cursor_at, own_techniques
from playground.sketch.suggestions import Suggestion
from playground.sketch.toml_sketch import TECHNIQUE_KEYS
from playground.sketch.toml_text import KeyPath, Pair
from playground.sketch.wiring import inner, input_names, output_names

_CHOICES: dict[str, tuple[object, ...]] = {
    "ease": EASES,
    "samples": (1, 2, 4, 8),
    "above_ground": (True, False),
    "format": (1,),
}
"""Key → what it may be."""


_QUOTED = re.compile(r"\"(?:[^\"\\]|\\.)*(?:\"|$)|'[^']*(?:'|$)")


def suggestions_in_sketch(opened: EditedText, at: int) -> list[Suggestion]:
    """Return what may stand at a place of a sketch or of a technique of several passes."""
    row = opened.text.rfind("\n", 0, at) + 1
    if "#" in _QUOTED.sub("", opened.text[row:at]):  # a comment
        return []
    cursor = cursor_at(opened.text, at)
    end = opened.text.find("\n", at)
    end = end if end >= 0 else len(opened.text)
    others = SketchText(opened, f"{opened.text[:row]}{' ' * (end - row)}{opened.text[end:]}")
    found = _Completion(others, cursor, SketchText(opened)).items()
    return [replace(suggestion, start=cursor.start) for suggestion in found]


class _Completion:
    """What may stand at one place."""

    def __init__(self, others: SketchText, cursor: Cursor, whole: SketchText) -> None:
        self.sketch = others  # without the line that is typed
        self.cursor = cursor
        self.whole = whole

    def items(self) -> list[Suggestion]:
        cursor = self.cursor
        if cursor.is_header:
            return self._headers()
        head = cursor.table[0] if cursor.table else ""
        keys = tuple(str(key) for key in cursor.table[2 if head in toml_table.LISTS else 1 :]) + cursor.keys
        return self._values(str(head), keys) if cursor.is_value else self._keys(str(head), keys)

    def _headers(self) -> list[Suggestion]:
        names = [*toml_table.LISTS, "view", *TECHNIQUE_KEYS]
        sketch = toml_table.SKETCH | toml_table.TECHNIQUE
        return [Suggestion(name, "module", about=sketch[name]) for name in names]

    # ── keys ─────────────────────────────────────────────────────────────────

    def _keys(self, head: str, keys: tuple[str, ...]) -> list[Suggestion]:
        if not keys:
            table = toml_table.TABLES.get(head, {}) if head else toml_table.SKETCH | toml_table.TECHNIQUE
            return [Suggestion(key, "property", about=meaning) for key, meaning in table.items()]
        if keys == ("camera",):
            return [Suggestion(key, "property", about=meaning) for key, meaning in toml_table.CAMERA.items()]
        if keys[0] == "set":
            return self._settable(head, keys[1:])
        technique = self._technique(head)
        if keys == ("inputs",) and technique is not None:
            return [Suggestion(self._key(name), "field", "input") for name in input_names(technique)]
        if keys == ("feedback",) and technique is not None:
            return [Suggestion(self._key(name), "field", "input") for name in input_names(technique)]
        if keys == ("steps",):
            return [Suggestion(self._key(name), "module") for name in self.sketch.names("pass")]
        return []

    def _settable(self, head: str, keys: tuple[str, ...]) -> list[Suggestion]:
        if keys:
            parameter = self._parameter(head, ".".join(keys))
            if parameter is not None and parameter.widget.kind == "direction":
                return [Suggestion(name, "field", "degrees") for name in ("azimuth", "elevation")]
            return []
        if head in ("pass", "view"):
            technique = self._technique(head)
            return self._parameters(technique, "") if technique is not None else []
        items = []
        for name in (*self.sketch.names("pass"), "view"):
            technique = self.sketch.technique_of(name)
            items += self._parameters(technique, f"{name}.") if technique is not None else []
        return items

    def _parameters(self, technique: Technique, prefix: str) -> list[Suggestion]:
        items = []
        for path in all_paths(technique):
            for target in find_targets(technique, path)[:1]:
                parameter, order = target.parameter, 2 if "." in path else 1
                label = self._key(f"{prefix}{path}")
                items.append(Suggestion(label, "variable", parameter.type, order=order, origin=parameter))
        return items

    def _key(self, name: str) -> str:
        """Return a key as it is written where the cursor is: one with dots has quotes."""
        return f'"{name}"' if "." in name and not self.cursor.quoted else name

    # ── values ───────────────────────────────────────────────────────────────

    def _values(self, head: str, keys: tuple[str, ...]) -> list[Suggestion]:
        key = keys[0] if keys else ""
        if key == "use" and head in ("pass", "view"):
            own = own_techniques(self.sketch.path.parent)
            names = [*own, *(name for name in shipped_names() if self._may_be_used(name))]
            return [self._text(name, "module") for name in names]
        if key == "inputs":
            return self._sources()
        if key == "feedback" and (technique := self._technique(head)) is not None:
            return [self._text(name, "field") for name in output_names(technique)]
        if key == "preset" and head == "shot":
            return [self._text(name, "choice") for name in self.whole.names("preset")]
        if key == "main" and not head:
            items = []
            for name in (*self.sketch.names("pass"), "view"):
                technique = self.sketch.technique_of(name)
                for path in all_paths(technique) if technique is not None else ():
                    items.append(self._text(f"{name}.{path}", "variable", 2 if "." in path else 1))
            return items
        if key == "set" and len(keys) > 1:
            parameter = self._parameter(head, ".".join(keys[1:]))
            return self._of_parameter(parameter) if parameter is not None else []
        if head in ("parameters", "outputs"):
            return self._inside(head)
        return [self._choice(entry) for entry in _CHOICES.get(key, ())]

    def _choice(self, value: object) -> Suggestion:
        return self._text(value, "choice") if isinstance(value, str) else Suggestion(spell(value), "choice")

    def _sources(self) -> list[Suggestion]:
        result = []
        for name, table in self.sketch.names("pass").items():
            if table == self.cursor.table:
                continue
            technique = self.sketch.technique(table)
            result.append(self._text(name, "module"))
            outputs = output_names(technique) if technique is not None else ()
            if len(outputs) > 1:
                result += [self._text(f"{name}:{output}", "field", 6) for output in outputs]
        inputs = [str(position[-1]) for position in self.sketch.places.pairs if position[:1] == ("inputs",)]
        return [*result, *(self._text(name, "field") for name in inputs)]

    def _inside(self, head: str) -> list[Suggestion]:
        """Return what a technique shows outside: paths of parameters, or outputs, of its passes."""
        items = []
        for name in self.sketch.names("pass"):
            technique = self.sketch.technique_of(name)
            if technique is not None and head == "parameters":
                items += [self._text(f"{name}.{path}", "variable") for path in all_paths(technique)]
            elif technique is not None:
                items += [self._text(f"{name}:{output}", "field") for output in output_names(technique)]
        return items

    def _of_parameter(self, parameter: Parameter) -> list[Suggestion]:
        if parameter.widget.choices:
            return [self._text(choice, "choice") for choice in parameter.widget.choices]
        if parameter.type == "bool":
            return [Suggestion(word, "choice") for word in ("true", "false")]
        return []

    def _text(self, text: str, kind: str, order: int = 5) -> Suggestion:
        """Return a text as it is written where the cursor is: in quotes, unless one was opened."""
        return Suggestion(text if self.cursor.quoted else f'"{text}"', kind, order=order)

    def _may_be_used(self, name: str) -> bool:
        return not is_variant(self.sketch.path.with_name(f"{name.rpartition('/')[2]}.toml"))

    def _technique(self, head: str) -> Technique | None:
        """Return what fills the pass that the cursor is in; ``use`` may be on its own line."""
        table = self.cursor.table[: 2 if head in toml_table.LISTS else 1]
        return self.sketch.technique(table) or self.whole.technique(table)

    def _parameter(self, head: str, path: str) -> Parameter | None:
        table = self.cursor.table[: 2 if head in toml_table.LISTS else 1]
        return self.sketch.parameter(table, path) or self.whole.parameter(table, path)


# ── what stands at a place ─────────────────────────────────────────────────────


def meaning_in_sketch(opened: EditedText, at: int) -> Suggestion | None:
    """Return what stands at a place of a sketch: a key, a parameter, a technique; None for nothing known."""
    sketch = SketchText(opened)
    key_path, pair = _pair_at(sketch, at)
    if pair is None:
        name = _header_at(opened, sketch, at)
        return _known(name, (toml_table.SKETCH | toml_table.TECHNIQUE).get(name, ""))
    table, keys = _parted(key_path)
    if keys[:1] == ("set",) and len(keys) > 1:
        parameter = sketch.parameter(table, ".".join(keys[1:]))
        if parameter is None:
            return None
        return Suggestion(parameter.name, "variable", parameter.type, origin=parameter)
    technique: Technique | None = None
    use = ""
    if keys == ("use",) and at >= pair.value:
        use = sketch.value(key_path)
        technique = sketch.technique(table)
    elif keys[:1] == ("inputs",) and len(keys) > 1 and at >= pair.value:
        use = sketch.value(key_path).partition(":")[0].partition(".")[0]
        technique = sketch.technique_of(use)
    if use:
        return Suggestion(use, "module", technique.title, origin=technique) if technique else None
    if keys[:1] == ("camera",) and len(keys) > 1:
        return _known(keys[1], toml_table.CAMERA.get(keys[1], ""))
    head = str(table[0]) if table else ""
    keys_of_table = toml_table.TABLES.get(head, {}) if head else toml_table.SKETCH | toml_table.TECHNIQUE
    return _known(keys[0], keys_of_table.get(keys[0], "")) if len(keys) == 1 else None


def _known(key: str, about: str) -> Suggestion | None:
    return Suggestion(key, "property", about=about) if about else None


def declaration_in_sketch(opened: EditedText, at: int) -> DeclarationSite | None:
    """Return where what stands at a place of a sketch is: a technique's file, a pass, a parameter."""
    sketch = SketchText(opened)
    key_path, pair = _pair_at(sketch, at)
    if pair is None:
        return None
    table, keys = _parted(key_path)
    if keys == ("use",):
        return _file_of(sketch.technique(table))
    if keys[:1] == ("inputs",) and len(keys) > 1 and at >= pair.value:
        head, _, rest = sketch.value(key_path).partition(":")[0].partition(".")
        if rest and (technique := sketch.technique_of(head)) is not None:
            return _file_of(inner(technique, rest))
        return _name_of(opened, sketch, sketch.names("pass").get(head))
    if keys == ("preset",):
        return _name_of(opened, sketch, sketch.names("preset").get(sketch.value(key_path)))
    if keys[:1] == ("set",) and len(keys) > 1:
        parameter = sketch.parameter(table, ".".join(keys[1:]))
        if parameter is not None and parameter.file:
            return _on_line(Path(parameter.file), parameter.line, parameter.name)
    return None


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


def _header_at(opened: EditedText, sketch: SketchText, at: int) -> str:
    row = opened.text.count("\n", 0, at)
    rows = {opened.text.count("\n", 0, header.start): header.keys[0] for header in sketch.places.headers}
    return rows.get(row, "")


def _file_of(technique: Technique | None) -> DeclarationSite | None:
    path = Path(technique.path) if technique is not None else None
    return DeclarationSite(path, read_text(path), 0, 0) if path is not None else None


def _name_of(opened: EditedText, sketch: SketchText, table: KeyPath | None) -> DeclarationSite | None:
    pair = sketch.places.pairs.get((*table, "name")) if table is not None else None
    return DeclarationSite(opened.path, opened.text, pair.key, pair.end - pair.key) if pair else None


def _on_line(path: Path, line: int, name: str) -> DeclarationSite:
    """Return a name on a line of a file, counted from 1."""
    text = read_text(path)
    start = sum(len(each) + 1 for each in text.split("\n")[: line - 1])
    return DeclarationSite(path, text, max(text.find(name, start), start), len(name))
