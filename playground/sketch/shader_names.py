"""What is known of a shader: its files, parameters, header, and the names that a kernel is given.

Texts are half typed most of the time. What cannot be read is left out, and the rest is still known; ``names``
has what each name in them means.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.shader.header import parse_kernel, read_uniforms
from playground.shader.names import Unit, includes, lexed, syntax_of, unit_of
from playground.shader.outline import Declared, outline
from playground.shader.reserved_names import GIVEN, MATCHES, SKIPS, TOWARDS, WIRED
from playground.shader.source import SourceText, find_include, read_source, read_text
from playground.shader.syntax.tokens import Token
from playground.sketch.model import Input, Kernel, Parameter, TexelKernel

_PRAGMA = re.compile(r"^[ \t]*#[ \t]*pragma[ \t]+(kernel|source|draw|compute)\b", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class DeclarationSite:
    """A name's declaration."""

    path: Path
    text: str  # of that file
    at: int
    length: int


@dataclass(frozen=True)
class Shader:
    """What is known of a shader's text with its includes."""

    path: Path
    text: str
    root: Path
    files: tuple[tuple[Path, str], ...]  # every file read with its text, the shader's own first
    targets: tuple[tuple[Path, str, Path], ...] = ()  # file, what it includes, which file that is
    parameters: tuple[Parameter, ...] = ()
    inputs: tuple[Input, ...] = ()
    kernel: Kernel | None = None  # None where its header cannot be read, and for a library file

    @property
    def is_kernel(self) -> bool:
        """Whether its text has a pragma, so that it is given names."""
        return bool(_PRAGMA.search(self.text))

    @property
    def engine_names(self) -> dict[str, tuple[str, str]]:
        """What a kernel is given: name → (type, meaning)."""
        names = dict(GIVEN)
        for declared in self.inputs:
            names[f"{WIRED}{declared.name}"] = (
                "bool",
                f"whether anything is wired to the input '{declared.name}'",
            )
            meaning = f"whether the input '{declared.name}' is wired and has the size of this pass"
            names[f"{MATCHES}{declared.name}"] = ("bool", meaning)
        for parameter in self.parameters:
            if parameter.widget.kind == "direction":
                meaning = f"the unit vector towards '{parameter.name}': east, north, up"
                names[f"{TOWARDS}{parameter.name}"] = ("vec3", meaning)
        outputs = self.kernel.outputs if self.kernel is not None else ()
        for output in outputs if isinstance(self.kernel, TexelKernel) else ():
            name = "previous" if len(outputs) == 1 else f"previous_{output.name}"
            meaning = "the texel of the step before, clamped to the edge: a function of ivec2"
            names[name] = (output.glsl, meaning)
        names[SKIPS] = ("bool", "a function: true in what a software renderer draws first of a kernel")
        return names

    def declared(self) -> Iterator[tuple[Path, str, Declared]]:
        """Yield what its files declare at their top level: file, its text, what is declared."""
        for path, text in self.files:
            for declaration in outline(text):
                yield path, text, declaration

    def parameter(self, name: str) -> Parameter | None:
        """Return a parameter by its name."""
        return next((parameter for parameter in self.parameters if parameter.name == name), None)

    def find(self, name: str, at: int) -> DeclarationSite | None:
        """Return where a name is declared that the text has at a place; None where it is not known."""
        syntax = syntax_of(self.text)
        if (local := syntax.local_at(name, at)) is not None:
            return DeclarationSite(self.path, self.text, syntax.place(local), len(name))
        if (member := self.unit.member_at(self.path, at)) is not None:
            path, place = member
            return DeclarationSite(path, dict(self.files)[path], place, len(name))
        for prefix in (WIRED, MATCHES, TOWARDS):
            if name.startswith(prefix) and name in self.engine_names:
                name = name.removeprefix(prefix)
        declarations = [
            (path, text, declaration)
            for path, text, declaration in self.declared()
            if declaration.name == name
        ]
        declarations.sort(key=lambda item: item[2].is_prototype)
        if declarations:
            path, text, declaration = declarations[0]
            return DeclarationSite(path, text, declaration.at, len(name))
        for file, declaration in library_declared().get(name, ()):
            return DeclarationSite(GLSL / file, read_text(GLSL / file), declaration.at, len(name))
        return None

    @property
    def unit(self) -> Unit:
        """Its text with its includes in place."""
        return unit_of(self.path, self.files, self.targets)

    def type_before(self, dot: int) -> str:
        """Return the type of what a dot of the text is behind, its statement typed or not; "" for unknown."""
        tokens = lexed(self.text)[0]
        index = next((i for i, token in enumerate(tokens) if token.start == dot), 0)
        first = _operand_before(tokens, index)
        before = next((i for i in range(first - 1, -1, -1) if tokens[i].text in (";", "{", "}")), None)
        if first == index or before is None:
            return ""
        start, operand = tokens[before].end, self.text[tokens[first].start : dot]
        line_end = (self.text.find("\n", dot) + 1 or len(self.text) + 1) - 1
        end = next((token.end for token in tokens[index:] if token.text == ";"), line_end)
        text = f"{self.text[:start]}\n{operand};{self.text[min(end, line_end) :]}"
        texts = tuple((path, text if path == self.path else other) for path, other in self.files)
        unit = unit_of(self.path, texts, self.targets)
        for place in unit.places(self.path, start + 1):
            if glsl_type := unit.syntax.type_at(place):
                return glsl_type
        return ""


def shader_at(path: Path, text: str, root: Path) -> Shader:
    """Return what is known of a shader's file, whose text is read in place of the file (``reading_unsaved``).

    ``root`` is the folder that it may include from, besides ``glsl/``.
    """
    try:
        source = read_source(path, (root,))
    except PlaygroundError:
        return Shader(path, text, root, *_reached(path, text, root))
    files = tuple((Path(file), read_text(Path(file))) for file in source.files)
    targets = tuple((Path(file), name, Path(target)) for file, name, target in source.includes)
    kernel, parameters, inputs = _header(source)
    return Shader(path, text, root, files, targets, parameters, inputs, kernel)


def _header(source: SourceText) -> tuple[Kernel | None, tuple[Parameter, ...], tuple[Input, ...]]:
    """Return what a header says, as much of it as can be read."""
    try:
        kernel = parse_kernel("", source)
        if kernel is not None:
            return kernel, kernel.parameters, kernel.inputs
    except PlaygroundError:
        pass
    try:
        return (None, *read_uniforms(source))
    except PlaygroundError:
        return None, (), ()


def _reached(
    path: Path, text: str, root: Path
) -> tuple[tuple[tuple[Path, str], ...], tuple[tuple[Path, str, Path], ...]]:
    """Return a file and what it includes, and its includes, without those that are not there."""
    files, targets, rest = {path: text}, [], [path]
    while rest:
        path = rest.pop(0)
        for include in includes(files[path]):
            target = find_include(include.name, path, (root,))
            if target is None:
                continue
            targets.append((path, include.name, target))
            if target not in files:
                try:
                    files[target] = read_text(target)
                except PlaygroundError:
                    continue
                rest.append(target)
    return tuple(files.items()), tuple(targets)


@cache
def library_declared() -> dict[str, tuple[tuple[str, Declared], ...]]:
    """Return the functions of the library: name → the files to include, and how each declares it."""
    from playground.shader.driver_log import library  # it reads the whole library, which a start does without

    declared: dict[str, list[tuple[str, Declared]]] = {}
    for name, files in library().items():
        for file in files:
            try:
                own = outline(read_text(GLSL / file))
            except PlaygroundError:
                continue
            for declaration in own:
                if (
                    declaration.name == name
                    and declaration.kind == "function"
                    and not declaration.is_prototype
                ):
                    declared.setdefault(name, []).append((file, declaration))
                    break
    return {name: tuple(places) for name, places in declared.items()}


def _operand_before(tokens: list[Token], dot: int) -> int:
    """Return where what a dot is behind begins, as ``points[i].far`` and ``at(p)``; the dot for nothing."""
    index = dot
    while index > 0:
        at = index - 1
        if tokens[at].text in (")", "]"):
            depth = 0
            while at >= 0:
                depth += (tokens[at].text in (")", "]")) - (tokens[at].text in ("(", "["))
                if depth == 0:
                    break
                at -= 1
            if at <= 0 or (tokens[at - 1].kind != "word" and tokens[at - 1].text not in ("]", ")")):
                return max(at, 0)
            index = at
            continue
        if tokens[at].kind != "word":
            return index
        if at == 0 or tokens[at - 1].text != ".":
            return at
        index = at - 1
    return index
