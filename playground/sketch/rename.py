"""Rename a name where that is safe, in a function or in every file that can see it; else say why not.

A local or a function's parameter changes in its scope alone, in branches that are off and in macros that mean
it too. A name of the top level, a macro or a member changes in every shader that includes the file, and in
what those include, all overloads of a function together; a uniform's also in the sketches and techniques that
set it. What is outside the open folders is never changed, so a name that is used there is refused.

Before anything is changed, each shader is resolved with the new texts: every name must mean what
it meant. The shaders and sketches are read, too: what could be read before must be readable still.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from playground.allowed_files import FAST, SHADERS, is_file, names_below, reading_unsaved
from playground.errors import PlaygroundError
from playground.paths import shown
from playground.shader.header import is_given, parse_kernel
from playground.shader.names import Meaning, Syntax, Unit, is_code, syntax_of, word_at, words
from playground.shader.reserved_names import GLSL_WORDS, MATCHES, PREFIX, TOWARDS, WIRED
from playground.shader.source import read_source, read_text
from playground.shader.syntax.influence import ENTRY
from playground.shader.syntax.nodes import For, Function, Node, While
from playground.sketch.assign import find_targets
from playground.sketch.edited import EditedText, EditedTexts, root_for, shader_at, shader_of
from playground.sketch.load import load_with
from playground.sketch.model import Graph, Parameter, Technique
from playground.sketch.shader_names import Shader
from playground.sketch.sketch_text import SketchText
from playground.sketch.techniques import Techniques
from playground.sketch.toml_text import TomlPlaces

_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_ENTRIES = frozenset({"main", "mainImage", "mainVR", "mainSound"})
_OWN_PRAGMA = re.compile(r"#\s*pragma\s+(?:kernel|draw|compute)\b")
_FOLLOWS = re.compile(r"//!.*?\bfollows\(([^)\n]*)\)")


class Refused(PlaygroundError):
    """Why a name is not renamed, in a message."""


def prepare(opened: EditedText, texts: EditedTexts, at: int) -> tuple[int, int]:
    """Return where the name at a place is; raise ``Refused`` where it cannot be renamed."""
    name, start = _word(opened, at)
    _meaning(shader_of(opened, texts), name, start)
    return start, start + len(name)


def rename(opened: EditedText, texts: EditedTexts, at: int, new: str) -> dict[Path, list[Edit]]:
    """Return the edits, by file, that rename what is at a place; raise ``Refused`` where that is not safe."""
    name, start = _word(opened, at)
    _check_new(new)
    if new == name:
        return {}
    return _Rename(opened, texts, name, start, new).edits()


def references(opened: EditedText, texts: EditedTexts, at: int) -> dict[Path, list[tuple[int, int]]]:
    """Return the places, by file, of what is named at a place, in every shader that can see it."""
    try:
        name, start = _word(opened, at)
        found = _Rename(opened, texts, name, start, name)
    except Refused:
        return {}
    return {path: [(place, place + len(name)) for place in sorted(places)] for path, places in found.places()}


def _word(opened: EditedText, at: int) -> tuple[str, int]:
    if opened.is_toml:
        raise Refused("names are renamed in a shader: a parameter is renamed where it is declared")
    name, start = word_at(opened.text, at)
    if not name or not is_code(opened.text, start):
        raise Refused("there is no name here that can be renamed")
    if name in GLSL_WORDS:
        raise Refused(f"'{name}' is a word of GLSL itself")
    if any(word.start == start and word.is_parameter for word in words(opened.text)):
        raise Refused(f"'{name}' is a macro's parameter; those are not renamed")
    if not any(word.start == start for word in words(opened.text)):
        raise Refused("there is no name here that can be renamed")
    return name, start


def _check_new(new: str) -> None:
    if not _NAME.fullmatch(new):
        raise Refused(f"'{new}' is no name: letters, digits and _, and no digit first")
    if is_given(new):
        raise Refused(f"'{new}' is given to every kernel")
    if new in GLSL_WORDS or new in _ENTRIES:
        raise Refused(f"'{new}' is a word of GLSL itself")
    if new.startswith((PREFIX, "gl_")) or "__" in new:
        raise Refused(f"'{new}': names that begin with {PREFIX} or gl_, or hold __, are reserved")


def _meaning(shader: Shader, name: str, start: int) -> tuple[Any, ...]:
    """Return what a name at a place means; raise ``Refused`` where it is not the text's own, or not one."""
    meanings = shader.unit.meanings(shader.path, start, name)
    if len(meanings) > 1:
        raise Refused(f"'{name}' is in a macro that is used where it means several things")
    if not meanings:
        local = syntax_of(shader.text).visible(start).get(name)
        raise Refused(
            f"'{name}' is in a part of the text that cannot be read"
            if local is not None or shader.unit.syntax.declares(name)
            else f"no file that this one includes declares '{name}'"
        )
    (meaning,) = meanings
    assert isinstance(meaning, tuple)
    if meaning[0] == "member" and not meaning[1]:
        raise Refused(f"'{name}' is a component, or a member of what has no known type")
    if meaning[0] == "member" and shader.unit.syntax.is_swizzle(name, meaning[1]):
        raise Refused(f"'{name}' is a component; those are not renamed")
    if meaning[0] == "local" and isinstance(function := meaning[2], Function):
        for parameter in function.parameters:
            is_output = function.name == ENTRY and "out" in parameter.type.qualifiers
            if parameter.name == name and (is_output or function.name in ("vertex", "fragment")):
                raise Refused(f"{function.name} gives or takes '{name}' by its name; its name is fixed")
    if meaning[0] == "top":
        if is_given(name) or name in _ENTRIES:
            raise Refused(f"'{name}' is what the playground gives or calls; its name is fixed")
        if any(declaration.name == name for declaration in shader.inputs):
            raise Refused(f"'{name}' is an input: sketches that wire it name it, so it is not renamed here")
        if not shader.unit.syntax.declares(name):
            raise Refused(f"no file that this one includes declares '{name}'")
    return meaning


@dataclass
class _User:
    """A shader in which names change."""

    shader: Shader
    edits: dict[tuple[Path, int], tuple[str, str]] = field(default_factory=dict)  # file, place → old, new
    others: dict[tuple[Path, int], str] = field(default_factory=dict)  # where it means something else → macro
    is_in_macro: bool = False


class _Rename:
    """One name, in every file that can see it."""

    def __init__(self, opened: EditedText, texts: EditedTexts, name: str, start: int, new: str) -> None:
        self.texts = texts
        self.name, self.new = name, new
        around = [folder for folder in texts.folders if opened.path.is_relative_to(folder)]
        self.folder = around[0] if around else opened.root
        self.shader = shader_of(opened, texts)
        self.meaning = _meaning(self.shader, name, start)
        self.kind = self.meaning[0]
        self.parameter = self.shader.parameter(name) if self.kind == "top" else None
        self.declared: set[tuple[Path, int]] = set()  # of a local: where one of its declarations is
        self._shaders: dict[Path, Shader] = {}
        self.users = self._users()

    def places(self) -> Iterator[tuple[Path, set[int]]]:
        """Yield each file with the places of the name in it."""
        yield from ((path, set(edits)) for path, edits in self._by_file(self.users).items())

    def edits(self) -> dict[Path, list[Edit]]:
        changes = self._by_file(self.users)
        for path in changes:
            if not self._is_ours(path):
                raise Refused(self._outside(path))
        for user in self.users:
            self._check_others(user, changes)
        edits_by_file = {
            path: [(at, at + len(old), new) for at, (old, new) in places.items()]
            for path, places in changes.items()
        }
        if self.parameter is not None:
            self._check_variants(edits_by_file)
            for path, edits in self._in_pragmas().items():
                edits_by_file.setdefault(path, []).extend(edits)
            for path, edits in self._in_sketches(edits_by_file).items():
                edits_by_file[path] = edits
        if self.kind != "local":
            self._verify(edits_by_file)
        return {path: sorted(set(edits)) for path, edits in edits_by_file.items()}

    # ── where the name is ────────────────────────────────────────────────────

    def _users(self) -> list[_User]:
        """Return every shader that reads a file in which the name changes."""
        users = [self._user(self.shader)]
        if self.kind == "local" and not users[0].is_in_macro:
            return users
        changed = set(self._by_file(users))
        rest = [self._shader(path) for path in self._files(SHADERS)]
        while True:
            near = [s for s in rest if any(path in changed for path, _ in s.files)]
            if not near:
                return users
            rest = [s for s in rest if s not in near]
            users += [self._user(shader) for shader in near]
            changed |= set(self._by_file(users))

    def _user(self, shader: Shader) -> _User:
        """Find the name in a shader; raise ``Refused`` where the new one would change a meaning there."""
        user, unit, places = _User(shader), shader.unit, dict[int, tuple[str, str]]()
        syntax = unit.syntax if shader is self.shader else Syntax(unit.text)  # one alone is seen again
        own = self._own_meanings(unit, syntax)
        for old, new in self._names.items():
            for each in syntax.occurrences(old):
                is_meant = each.meaning in own if old == self.name else each.meaning == ("top", old)
                if is_meant and each.at < 0:
                    raise Refused(f"'{old}' is put together by a macro in {shown(shader.path)}")
                if is_meant:
                    places[each.at] = (old, new)
                    user.is_in_macro |= bool(each.macro)
                elif each.at >= 0:
                    user.others[unit.origin(each.at)] = each.macro
        user.edits = {unit.origin(at): change for at, change in places.items()}
        unknown = ("member", "", self.name)
        if (
            self.kind == "member"
            and self.new != self.name
            and not syntax.is_swizzle(self.name, "")
            and any(each.meaning == unknown for each in syntax.occurrences(self.name))
        ):
            raise Refused(f"'.{self.name}' in {shown(shader.path)} is of something with no known type")
        self._check_others(user, self._by_file([user]))
        if shader is self.shader or self.new in unit.text:
            self._check_meanings(unit, syntax, own, places)
        return user

    def _own_meanings(self, unit: Unit, syntax: Syntax) -> set[Meaning]:
        """Return what the name has to mean in a shader: of a local, what is declared in the same place."""
        if self.kind != "local":
            return {self.meaning}
        found = syntax.occurrences(self.name)
        if not self.declared:
            self.declared = {unit.origin(e.at) for e in found if e.meaning == self.meaning and e.at >= 0}
            return {self.meaning}
        return {e.meaning for e in found if e.at >= 0 and not e.macro and unit.origin(e.at) in self.declared}

    @property
    def _names(self) -> dict[str, str]:
        """What changes: name → new name; of a parameter what the engine derives from it, too."""
        names = {self.name: self.new}
        if self.parameter is not None:
            names |= {f"{prefix}{self.name}": f"{prefix}{self.new}" for prefix in (TOWARDS, WIRED, MATCHES)}
        return names

    def _by_file(self, users: Iterable[_User]) -> dict[Path, dict[int, tuple[str, str]]]:
        """Return the places that change, by file: place → old, new."""
        places: dict[Path, dict[int, tuple[str, str]]] = {}
        for user in users:
            for (path, place), change in user.edits.items():
                places.setdefault(path, {})[place] = change
        return places

    def _shader(self, path: Path) -> Shader:
        if path not in self._shaders:
            with self.texts.reading():
                try:
                    text = read_text(path)
                except PlaygroundError:
                    text = ""
            self._shaders[path] = shader_at(path, text, root_for(path), self.texts)
        return self._shaders[path]

    def _files(self, endings: tuple[str, ...]) -> list[Path]:
        names = names_below((self.folder,), endings)
        folders = {self.folder / name for name in names} | {opened.path for opened in self.texts}
        return sorted(path for path in folders if path.name.endswith(endings) and path != self.shader.path)

    def _is_ours(self, path: Path) -> bool:
        return path.is_relative_to(self.folder) or self.texts.is_open_folder(path)

    def _outside(self, path: Path) -> str:
        syntax = syntax_of(self.texts.read(path))
        what = "is declared" if syntax.declares(self.name) else "is used"
        return f"'{self.name}' {what} in {shown(path)}, which is not in the open folder"

    # ── whether every name keeps its meaning ─────────────────────────────────

    def _check_others(self, user: _User, changes: Mapping[Path, Collection[int]]) -> None:
        """Raise ``Refused`` where a place that changes means something else in a shader, too."""
        if self.new == self.name:
            return
        for (path, place), macro in user.others.items():
            if place in changes.get(path, ()):
                where = self._location(path, place)
                if macro:
                    raise Refused(
                        f"'{self.name}' is in the macro {macro} at {where}, where it means several things"
                    )
                raise Refused(f"'{self.name}' at {where} means something else in {shown(user.shader.path)}")

    def _check_meanings(
        self, unit: Unit, syntax: Syntax, own: set[Meaning], places: Mapping[int, tuple[str, str]]
    ) -> None:
        """Raise ``Refused`` where, in a shader with the new name, any name would mean something else."""
        if self.new == self.name:
            return
        edits = ((at, at + len(old), new) for at, (old, new) in places.items())
        place = _first_difference(syntax, Syntax(_edited(unit.text, edits)))
        taken: set[Meaning] = {("macro", self.new)}
        taken |= {("member", self.meaning[1], self.new)} if self.kind == "member" else set()
        taken |= {("top", self.new)} if self.kind in ("top", "macro") else set()
        for meaning in own if self.kind == "local" else ():
            taken |= {("local", self.new, scope) for scope in _same_scope(meaning, syntax)}
        is_unsure = not syntax.is_whole and self.kind != "member"
        for each in syntax.occurrences(self.new):
            if each.at >= 0 and (is_unsure or each.meaning in taken):
                place = each.at
                break
        if place is not None:
            path, at = unit.origin(place)
            if self.kind == "local" and path == self.shader.path:
                raise Refused(f"'{self.new}' is a name of this function already: {self._location(path, at)}")
            raise Refused(f"'{self.new}' is a name in {self._location(path, at)} already")

    def _location(self, path: Path, at: int) -> str:
        text = self.texts.read(path)
        return f"{shown(path)}:{text.count(chr(10), 0, at) + 1}"

    def _check_variants(self, changed: Iterable[Path]) -> None:
        for path in changed:
            for ending in FAST:
                variant = path.with_name(f"{path.stem}{ending}")
                if path.suffix == ".glsl" and is_file(variant):
                    raise Refused(
                        f"{shown(variant)} has the parameters of {path.name}, '{self.name}' among them"
                    )

    # ── pragmas, annotations and sketches ────────────────────────────────────

    def _in_pragmas(self) -> dict[Path, list[Edit]]:
        """Return the edits in pragmas' expressions, and in annotations that follow the parameter."""
        edits: dict[Path, list[Edit]] = {}
        for path, text in {path: text for user in self.users for path, text in user.shader.files}.items():
            preprocessed = syntax_of(text).tree.preprocessed
            parts = [(d.start, d.text) for d in preprocessed.directives if _OWN_PRAGMA.match(d.text)]
            for comment in preprocessed.comments:
                parts += [(comment.start, m[0]) for m in [_FOLLOWS.match(comment.text)] if m]
            for start, part in parts:
                for word in re.finditer(rf"(?<![\w.]){self.name}\b(?!\s*[:=])", part):
                    if part.count('"', 0, word.start()) % 2:
                        at = start + word.start()
                        edits.setdefault(path, []).append((at, at + len(self.name), self.new))
        return edits

    def _in_sketches(self, changed: Iterable[Path]) -> dict[Path, list[Edit]]:
        assert self.parameter is not None
        edits_by_file: dict[Path, list[Edit]] = {}
        files = set(changed)
        with self.texts.reading():
            for path in self._files((".toml",)):
                try:
                    opened = self.texts.at(path) or self._unopened(path)
                except PlaygroundError:
                    continue
                if opened.is_ours and (
                    edits := edits_in_toml(opened, self.parameter, files, self.name, self.new)
                ):
                    edits_by_file[path] = edits
        return edits_by_file

    def _unopened(self, path: Path) -> EditedText:
        return EditedText(path, read_text(path))

    def _verify(self, edits_by_file: Mapping[Path, list[Edit]]) -> None:
        """Raise ``Refused`` where something that can be read now could not be read with the edits."""
        open_texts = {opened.path: opened.text for opened in self.texts}
        with self.texts.reading():
            new = {path: _edited(read_text(path), edits) for path, edits in edits_by_file.items()}
        tomls = self._files((".toml",)) if self.parameter is not None else []
        before = {path: why for path in tomls if (why := _load(path, open_texts)) is not None}
        for path in tomls:
            if path not in before and (why := _load(path, {**open_texts, **new})) is not None:
                raise Refused(f"{shown(path)} could not be read any more: {why}")
        for shader in [user.shader for user in self.users if _parse(user.shader, open_texts) is None]:
            if (why := _parse(shader, {**open_texts, **new})) is not None:
                raise Refused(f"{shown(shader.path)} could not be read any more: {why}")


def _same_scope(meaning: Meaning, syntax: Syntax) -> Iterator[Node]:
    """Yield the scopes in which a local of this meaning cannot be declared twice: a loop's is its body's."""
    assert isinstance(meaning, tuple)
    scope = meaning[2]
    yield scope
    if isinstance(scope, For | While):
        yield scope.body
    yield from (node for node in syntax.scopes() if isinstance(node, For | While) and node.body is scope)


def _first_difference(one: Syntax, other: Syntax) -> int | None:
    """Return a place of the first text whose name means something else in the other; None where none does."""
    for before, after in zip(one.readings, other.readings, strict=False):
        for first, second in zip(before.symbols.references, after.symbols.references, strict=False):
            links = [
                (each.token, each.symbol and each.symbol.token, sorted(s.token for s in each.overloads))
                for each in (first, second)
            ]
            if links[0] != links[1]:
                return before.tree.tokens[first.token].start
    counts = [[len(reading.tree.tokens) for reading in syntax.readings] for syntax in (one, other)]
    return None if counts[0] == counts[1] else 0


def _load(path: Path, texts: Mapping[Path, str]) -> str | None:
    """Return why a sketch cannot be loaded; None where it can, and for what is none."""
    with reading_unsaved(texts):
        try:
            if not EditedText(path, read_text(path)).is_ours:
                return None
            load_with(Techniques(), path)
        except PlaygroundError as error:
            return error.diagnostics[0].message
    return None


def _parse(shader: Shader, texts: Mapping[Path, str]) -> str | None:
    with reading_unsaved(texts):
        try:
            parse_kernel("", read_source(shader.path, (shader.root,)))
        except PlaygroundError as error:
            return error.diagnostics[0].message
    return None


def _edited(text: str, edits: Iterable[Edit]) -> str:
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + text[end:]
    return text


# ── parameters in a sketch's text ──────────────────────────────────────────────


Edit = tuple[int, int, str]
"""Where a text begins and ends that is replaced, and by what."""

_QUOTED = re.compile(r"\"([^\"\n]*)\"|'([^'\n]*)'")


def edits_in_toml(
    opened: EditedText, parameter: Parameter, files: Collection[Path], name: str, new: str
) -> list[Edit]:
    """Return the edits that rename a parameter in a sketch's or a technique's text.

    ``files`` are those that declare it or read it; ``name`` is what it is called, ``new`` what it will be.
    """
    sketch = SketchText(opened)
    edits: list[Edit] = []

    def is_meant(technique: Technique | None, path: str) -> bool:
        """Return whether the last part of a path is the parameter's own name."""
        if technique is None or path.rpartition(".")[2] != name:
            return False
        targets = find_targets(technique, path)
        if not any((t.parameter.file, t.parameter.line) == (parameter.file, parameter.line) for t in targets):
            return False
        head, _, rest = path.partition(".")
        if isinstance(technique, Graph) and rest:
            spec = technique.find(head)
            return spec is not None and is_meant(spec.technique, rest)
        return not (isinstance(technique, Graph) and _exports_by_name(technique, name))

    def is_meant_in_sketch(path: str) -> bool:
        head, _, rest = path.partition(".")
        return bool(rest) and is_meant(sketch.technique_of(head), rest)

    for table, path, pair in sketch.settings():
        own = table[:1] in (("pass",), ("view",))
        if is_meant(sketch.technique(table), path) if own else is_meant_in_sketch(path):
            key = opened.text[pair.key : pair.value]
            at = [match.start() for match in re.finditer(rf"(?<!\w){name}(?!\w)", key)][-1]
            edits.append((pair.key + at, pair.key + at + len(name), new))
    for key_path, pair in sketch.places.pairs.items():
        if key_path != ("main",) and key_path[:1] != ("parameters",):
            continue
        for match in _QUOTED.finditer(opened.text, pair.value, pair.end):
            text = match[1] if match[1] is not None else match[2]
            if is_meant_in_sketch(text):
                end = match.end() - 1
                edits.append((end - len(name), end, new))
    return edits


def _exports_by_name(technique: Graph, name: str) -> bool:
    """Return whether a technique's text writes an export of that name, which then is its own."""
    try:
        return ("parameters", name) in TomlPlaces(read_text(Path(technique.path))).pairs
    except PlaygroundError:
        return False
