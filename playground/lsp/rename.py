"""Rename a name where that is safe, in a function or in every file that can see it; else say why not.

A function's own name changes in that function alone. One of the top level changes in every shader that
includes the file, and in what those include; a parameter's in the sketches and techniques that set it, too.
What is outside the open folders is never changed, so a name that is used there is refused. Before anything
is given to the editor, the shaders and sketches are read with the new texts: what could be read before
must be readable still.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from lsprotocol import types

from playground.allowed_files import FAST, SHADERS, is_file, names_below, reading_unsaved
from playground.errors import PlaygroundError
from playground.lsp.documents import Document, Documents, root_for
from playground.lsp.shader import (
    Shader,
    has_branches,
    is_code,
    local_at,
    locals_of,
    macros_of,
    shader_at,
    shader_of,
    word_at,
    words,
)
from playground.lsp.sketch_text import SketchText
from playground.paths import shown
from playground.shader.header import is_given, parse_kernel
from playground.shader.outline import Declared, code_of, outline
from playground.shader.reserved_names import GLSL_WORDS, MATCHES, PREFIX, TOWARDS, WIRED
from playground.shader.source import read_source, read_text
from playground.sketch.assign import find_targets
from playground.sketch.load import load_with
from playground.sketch.model import Graph, Parameter, Technique
from playground.sketch.techniques import Techniques
from playground.sketch.toml_text import TomlPlaces

_NAME = re.compile(r"[A-Za-z_]\w*", re.ASCII)
_ENTRIES = frozenset({"main", "mainImage", "mainVR", "mainSound"})
_PRAGMA = re.compile(
    r"^[ \t]*#[ \t]*pragma[ \t]+(?:kernel|draw|compute)\b(?:[^\n\\]|\\\n|\\[^\n])*", re.MULTILINE
)
_FOLLOWS = re.compile(r"//![^\n]*\bfollows\(([^)\n]*)\)")


class Refused(Exception):
    """Why a name is not renamed, in a message."""


def prepare(document: Document, documents: Documents, at: int) -> types.Range:
    """Return where the name at a place is; raise ``Refused`` where it cannot be renamed."""
    name, start = _word(document, at)
    shader = shader_of(document, documents)
    if _local(shader, name, start) is None:
        _top_level(shader, name)
    return document.range(start, start + len(name))


def rename(document: Document, documents: Documents, at: int, new: str) -> dict[Path, list[Edit]]:
    """Return the edits, by file, that rename what is at a place; raise ``Refused`` where that is not safe."""
    name, start = _word(document, at)
    _check_new(new)
    if new == name:
        return {}
    shader = shader_of(document, documents)
    places = _local(shader, name, start)
    if places is not None:
        function = shader.function_at(start)
        assert function is not None
        inside = {word for word, at in words(document.text) if function.start <= at < function.end}
        inside |= {word for used in _macros_in(shader, function) for word in used.words}
        if new in inside:
            raise Refused(f"'{new}' is a name of this function already")
        return {document.path: [(index, index + len(name), new) for index in places]}
    _top_level(shader, name)
    edits = _Everywhere(document, documents, shader, name, new).edits()
    return {path: sorted(edits) for path, edits in edits.items() if edits}


def _word(document: Document, at: int) -> tuple[str, int]:
    name, start = word_at(document.text, at)
    if not name or not is_code(document.text, start):
        raise Refused("there is no name here that can be renamed")
    if name in GLSL_WORDS:
        raise Refused(f"'{name}' is a word of GLSL itself")
    if start and document.text[start - 1] == ".":
        raise Refused(f"'{name}' is a component or a struct's member; those are not renamed")
    if any(
        macro.start <= start < macro.end and name in macro.parameters for macro in macros_of(document.text)
    ):
        raise Refused(f"'{name}' is a macro's parameter; those are not renamed")
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


def _local(shader: Shader, name: str, start: int) -> list[int] | None:
    """Return the places of a name that a function declares; None for one of the top level."""
    function = shader.function_at(start)
    if function is None or start == function.at:
        return None
    locals_ = locals_of(shader.text, function)
    local = local_at(locals_, name, start)
    if local is None:
        return None
    for path, text, declaration in shader.declared():
        if declaration.name == name:
            line = text.count("\n", 0, declaration.at) + 1
            raise Refused(f"'{name}' is also declared at {shown(path)}:{line}, which this function hides")
    for used in _macros_in(shader, function):
        if name in used.words:
            raise Refused(
                f"'{name}' is in the macro {used.name} at {used.location}, which this function uses"
            )
    # Parts that exclude each other may declare it each for themselves, and close blocks that others open.
    branches = has_branches(shader.text, function)
    return [
        index
        for word, index in words(shader.text)
        if word == name
        and function.start <= index < function.end
        and not _is_member(shader.text, index)
        and not any(declaration.start <= index < declaration.end for declaration in macros_of(shader.text))
        and (other := local_at(locals_, name, index)) is not None
        and (branches or other.end == local.end)
    ]


@dataclass(frozen=True, slots=True)
class _Used:
    """A macro that a function uses."""

    name: str
    words: frozenset[str]  # in its body, without its parameters
    location: str  # as a user would name it


def _macros_in(shader: Shader, function: Declared) -> list[_Used]:
    """Return the macros that a function's text names, and those that they name."""
    macros_by_name: dict[str, list[_Used]] = {}
    for path, text in shader.files:
        inside = [(word, at) for word, at in words(text) if not _is_member(text, at)]
        for macro in macros_of(text):
            body = frozenset(word for word, at in inside if macro.body <= at < macro.end)
            line = text.count("\n", 0, macro.start) + 1
            macros_by_name.setdefault(macro.name, []).append(_Used(macro.name, body, f"{shown(path)}:{line}"))
    new = {word for word, at in words(shader.text) if function.start <= at < function.end}
    macros: dict[str, list[_Used]] = {}
    while new := {word for word in new if word in macros_by_name and word not in macros}:
        macros |= {word: macros_by_name[word] for word in new}
        new = {word for name in new for used in macros_by_name[name] for word in used.words}
    return [used for several in macros.values() for used in several]


def _is_member(text: str, index: int) -> bool:
    return code_of(text)[:index].rstrip().endswith(".")


def _top_level(shader: Shader, name: str) -> None:
    """Raise ``Refused`` for a name that no text of the shader declares, or that is not its to change."""
    if is_given(name) or name in _ENTRIES:
        raise Refused(f"'{name}' is what the playground gives or calls; its name is fixed")
    if any(declaration.name == name for declaration in shader.inputs):
        raise Refused(f"'{name}' is an input: sketches that wire it name it, so it is not renamed here")
    if not any(declaration.name == name for _, _, declaration in shader.declared()):
        raise Refused(f"no file that this one includes declares '{name}'")


class _Everywhere:
    """A name of the top level, in every file that can see it."""

    def __init__(self, document: Document, documents: Documents, shader: Shader, name: str, new: str) -> None:
        self.documents = documents
        self.name, self.new = name, new
        self.parameter = shader.parameter(name)
        around = [folder for folder in documents.folders if document.path.is_relative_to(folder)]
        self.folder = around[0] if around else document.root
        self.shader = shader
        self.shaders: dict[Path, Shader] = {}

    def edits(self) -> dict[Path, list[Edit]]:
        users = self._users()
        texts: dict[Path, str] = {}
        for user in users:
            texts |= dict(user.files)
        edits_by_file = {path: self._in_shader(path, text) for path, text in texts.items()}
        edits_by_file = {path: edits for path, edits in edits_by_file.items() if edits}
        for path, edits in edits_by_file.items():
            if not self._is_ours(path):
                what = "is declared" if self._declares(texts[path]) else "is used"
                raise Refused(f"'{self.name}' {what} in {shown(path)}, which is not in the open folder")
            self._check(path, texts[path], bool(edits))
        for user in users:
            for path, text in user.files:
                if any(word == self.new for word, _ in words(text)):
                    raise Refused(f"'{self.new}' is a name in {shown(path)} already")
        if self.parameter is not None:
            for path, edits in self._in_sketches(edits_by_file).items():
                edits_by_file[path] = edits
        self._verify(edits_by_file, users)
        return edits_by_file

    def _users(self) -> list[Shader]:
        """Return every shader that reads a file in which the name would change."""
        everything = [self.shader, *(self._shader(path) for path in self._files(SHADERS))]
        changed = {path for path, text in self.shader.files if self._names(text)}
        while True:
            users = [s for s in everything if any(path in changed for path, _ in s.files)]
            wider = {path for s in users for path, text in s.files if self._names(text)}
            if wider <= changed:
                return users
            changed |= wider

    def _shader(self, path: Path) -> Shader:
        if path not in self.shaders:
            with self.documents.reading():
                try:
                    text = read_text(path)
                except PlaygroundError:
                    text = ""
            self.shaders[path] = shader_at(path, text, root_for(path), self.documents)
        return self.shaders[path]

    def _files(self, endings: tuple[str, ...]) -> list[Path]:
        names = names_below((self.folder,), endings)
        folders = {self.folder / name for name in names} | {document.path for document in self.documents}
        return sorted(path for path in folders if path.name.endswith(endings) and path != self.shader.path)

    def _is_ours(self, path: Path) -> bool:
        return path.is_relative_to(self.folder) or self.documents.is_open_folder(path)

    def _names(self, text: str) -> bool:
        return self.name in text and any(word in self._old for word, _ in words(text))

    @property
    def _old(self) -> dict[str, str]:
        """What changes: name → new name; of a parameter that is a direction, the vector towards it too."""
        names = {self.name: self.new}
        if self.parameter is not None:
            names |= {f"{prefix}{self.name}": f"{prefix}{self.new}" for prefix in (TOWARDS, WIRED, MATCHES)}
        return names

    def _declares(self, text: str) -> bool:
        return any(declaration.name == self.name for declaration in outline(text))

    def _in_shader(self, path: Path, text: str) -> list[Edit]:
        members = [declaration for declaration in outline(text) if declaration.kind == "struct"]
        code = code_of(text)
        edits = []
        for word, index in words(text):
            new = self._old.get(word)
            if new is None or _is_member(text, index):
                continue
            after = code[index + len(word) :].lstrip()[:1]
            if after in tuple(";,[") and any(
                declaration.body < index < declaration.end for declaration in members
            ):
                continue  # a struct's member of that name
            edits.append((index, index + len(word), new))
        if self.parameter is not None:
            edits += self._in_texts(text)
        return edits

    def _in_texts(self, text: str) -> list[Edit]:
        """Return the edits in a pragma's expressions, and in annotations that follow the parameter."""
        edits = []
        for match in (*_PRAGMA.finditer(text), *_FOLLOWS.finditer(text)):
            for word in re.finditer(rf"(?<![\w.]){self.name}\b(?!\s*[:=])", match[0]):
                if match[0].count('"', 0, word.start()) % 2:
                    start = match.start() + word.start()
                    edits.append((start, start + len(self.name), self.new))
        return edits

    def _check(self, path: Path, text: str, is_changed: bool) -> None:
        for declaration in outline(text):
            inside = (
                locals_of(text, declaration)
                if declaration.kind == "function" and declaration.body >= 0
                else ()
            )
            at = next((local.at for local in inside if local.name == self.name), None)
            if at is not None:
                line = text.count("\n", 0, at) + 1
                raise Refused(f"'{self.name}' is hidden by another of that name at {shown(path)}:{line}")
        if is_changed and self.parameter is not None:
            for ending in FAST:
                variant = path.with_name(f"{path.stem}{ending}")
                if path.suffix == ".glsl" and is_file(variant):
                    raise Refused(
                        f"{shown(variant)} has the parameters of {path.name}, '{self.name}' among them"
                    )

    def _in_sketches(self, changed: Iterable[Path]) -> dict[Path, list[Edit]]:
        assert self.parameter is not None
        edits_by_file: dict[Path, list[Edit]] = {}
        files = set(changed)
        with self.documents.reading():
            for path in self._files((".toml",)):
                try:
                    document = self.documents.at(path) or self._unopened(path)
                except PlaygroundError:
                    continue
                if document.is_ours and (
                    edits := edits_in_toml(document, self.parameter, files, self.name, self.new)
                ):
                    edits_by_file[path] = edits
        return edits_by_file

    def _unopened(self, path: Path) -> Document:
        return Document(read_text(path), self.documents.units, "", path, None)

    def _verify(self, edits_by_file: Mapping[Path, list[Edit]], users: list[Shader]) -> None:
        """Raise ``Refused`` where something that can be read now could not be read with the edits."""
        open_texts = {document.path: document.text for document in self.documents}
        with self.documents.reading():
            new = {path: _edited(read_text(path), edits) for path, edits in edits_by_file.items()}
        tomls = self._files((".toml",)) if self.parameter is not None else []
        before = {path: why for path in tomls if (why := _load(path, open_texts)) is not None}
        for path in tomls:
            if path not in before and (why := _load(path, {**open_texts, **new})) is not None:
                raise Refused(f"{shown(path)} could not be read any more: {why}")
        for user in users:
            if _parse(user, open_texts) is None and (why := _parse(user, {**open_texts, **new})) is not None:
                raise Refused(f"{shown(user.path)} could not be read any more: {why}")


def _load(path: Path, texts: Mapping[Path, str]) -> str | None:
    """Return why a sketch cannot be loaded; None where it can, and for what is none."""
    with reading_unsaved(texts):
        try:
            if not Document(read_text(path), len, "", path, None).is_ours:
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
    document: Document, parameter: Parameter, files: Collection[Path], name: str, new: str
) -> list[Edit]:
    """Return the edits that rename a parameter in a sketch's or a technique's text.

    ``files`` are those that declare it or read it; ``name`` is what it is called, ``new`` what it will be.
    """
    sketch = SketchText(document)
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
            key = document.text[pair.key : pair.value]
            at = [match.start() for match in re.finditer(rf"(?<!\w){name}(?!\w)", key)][-1]
            edits.append((pair.key + at, pair.key + at + len(name), new))
    for key_path, pair in sketch.places.pairs.items():
        if key_path != ("main",) and key_path[:1] != ("parameters",):
            continue
        for match in _QUOTED.finditer(document.text, pair.value, pair.end):
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
