"""What a shader's text names, and where: includes, parameters, functions, the names that a kernel is given.

Texts are half typed most of the time. What cannot be read is left out, and the rest is still known.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from playground.errors import PlaygroundError
from playground.lsp.documents import Document, Documents
from playground.memo import TEXTS
from playground.paths import GLSL
from playground.shader.driver_log import library
from playground.shader.header import parse_kernel, read_uniforms
from playground.shader.outline import DIRECTIVE, Declared, blank, code_of, outline, without_directives
from playground.shader.reserved_names import GIVEN, MATCHES, SKIPS, TOWARDS, WIRED
from playground.shader.source import SourceText, find_include, read_source, read_text
from playground.sketch.model import Input, Kernel, Parameter, TexelKernel

_INCLUDE = re.compile(r"^[ \t]*#[ \t]*(?:pragma[ \t]+)?include[ \t]*[\"<]([^\">\n]*)", re.MULTILINE)
_PRAGMA = re.compile(r"^[ \t]*#[ \t]*pragma[ \t]+(kernel|source|draw|compute)\b", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Include:
    """An ``#include`` of a text."""

    name: str
    start: int  # of the name
    end: int


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
        function = self.function_at(at)
        if function is not None:
            local = local_at(locals_of(self.text, function), name, at)
            if local is not None:
                return DeclarationSite(self.path, self.text, local.at, len(name))
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

    def function_at(self, at: int) -> Declared | None:
        """Return the function that a place of the text is in."""
        own = (
            function for function in outline(self.text) if function.kind == "function" and function.body >= 0
        )
        return next((function for function in own if function.start <= at <= function.end), None)


def shader_of(document: Document, documents: Documents) -> Shader:
    """Return what is known of an open shader."""
    return shader_at(document.path, document.text, document.root, documents)


def shader_at(path: Path, text: str, root: Path, documents: Documents) -> Shader:
    """Return what is known of a shader's file, with the texts that are open in place of the files'."""
    with documents.reading():
        try:
            source = read_source(path, (root,))
        except PlaygroundError:
            return Shader(path, text, root, tuple(_reached(path, text, root)))
        files = tuple((Path(file), read_text(Path(file))) for file in source.files)
        kernel, parameters, inputs = _header(source)
    return Shader(path, text, root, files, parameters, inputs, kernel)


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


def _reached(path: Path, text: str, root: Path) -> Iterator[tuple[Path, str]]:
    """Yield a file and what it includes, without the includes that are not there."""
    seen, rest = {path}, [(path, text)]
    while rest:
        path, text = rest.pop(0)
        yield path, text
        for include in includes(text):
            include_path = find_include(include.name, path, (root,))
            if include_path is not None and include_path not in seen:
                seen.add(include_path)
                try:
                    rest.append((include_path, read_text(include_path)))
                except PlaygroundError:
                    continue


def includes(text: str) -> list[Include]:
    """Return the includes of a text."""
    return [Include(m[1], m.start(1), m.end(1)) for m in _INCLUDE.finditer(text)]


def include_at(text: str, at: int) -> Include | None:
    """Return the include whose name a place is in."""
    return next((include for include in includes(text) if include.start <= at <= include.end), None)


def word_at(text: str, at: int) -> tuple[str, int]:
    """Return the identifier that a place is in or behind, and where it begins; ("", at) for none."""
    line = text.rfind("\n", 0, at) + 1
    end = text.find("\n", at)
    for word, start in identifiers(text, line, end if end >= 0 else len(text)):
        if start <= at <= start + len(word):
            return word, start
    return "", at


def is_code(text: str, at: int) -> bool:
    """Return whether a place, where something stands, is in the code and in no comment."""
    return at < len(text) and code_of(text)[at] == text[at]


@cache
def library_declared() -> dict[str, tuple[tuple[str, Declared], ...]]:
    """Return the functions of the library: name → the files to include, and how each declares it."""
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


# ── names that are free ────────────────────────────────────────────────────────


# A number takes its suffix and its exponent, so that their letters are no names.
_NAME_OR_NUMBER = re.compile(r"([A-Za-z_]\w*)|0[xX]\w*|\.?\d(?:[eE][-+]|[\w.])*", re.ASCII)
_LOCAL = re.compile(
    r"(?<![\w.])([A-Za-z_]\w*)(?:(?:\s*\[[^\]]*\])+\s*|\s+)([A-Za-z_]\w*)(?=\s*(?:[;,=)[{]|$))", re.ASCII
)
_NOT_TYPES = frozenset("return else do in out inout const flat highp mediump lowp goto case".split())
_NEXT_IN_LIST = re.compile(r",\s*([A-Za-z_]\w*)(?=\s*[][;,=])", re.ASCII)
_BEFORE_BRACKET = re.compile(r"([A-Za-z_]\w*)\s*\Z", re.ASCII)
_OWN_SCOPE = frozenset(("for", "while", "if", "switch"))
_CONTROL = re.compile(r"\s*(?:(for|while|if|switch)\s*\(|do\b)", re.ASCII)
_ELSE = re.compile(r"\s*else\b", re.ASCII)
_MACRO = re.compile(r"\s*#\s*define\s+([A-Za-z_]\w*)(\([^)]*\))?", re.ASCII)


@dataclass(frozen=True, slots=True)
class Local:
    """One name that a function declares, an argument or a variable of a block."""

    name: str
    at: int  # where it is declared
    seen: int  # from where on it stands for this one: behind its value
    end: int  # where its block ends


@dataclass(frozen=True, slots=True)
class Macro:
    """One ``#define``, the lines that it goes on to too."""

    name: str
    parameters: frozenset[str]
    start: int  # of the directive
    body: int  # where its body begins
    end: int


def identifiers(text: str, start: int = 0, end: int | None = None) -> Iterator[tuple[str, int]]:
    """Yield each identifier of a text with its place: no letters of numbers, as in 1e-3, 2.0f and 0xFFu."""
    for match in _NAME_OR_NUMBER.finditer(text, start, len(text) if end is None else end):
        if match[1]:
            yield match[1], match.start()


def words(text: str) -> Iterator[tuple[str, int]]:
    """Yield each identifier of the code with its place, of macros too, but for macros' own parameters.

    Pragmas and includes are left out.
    """
    macros = list(macros_of(text))
    for word, at in identifiers(_without_strings(text)):
        while macros and macros[0].end <= at:
            macros.pop(0)
        if not (macros and macros[0].start <= at and word in macros[0].parameters):
            yield word, at


@TEXTS.cached()
def _without_strings(text: str) -> str:
    """Return a text with spaces in place of comments, includes and pragmas."""
    return DIRECTIVE.sub(
        lambda match: blank(match) if re.match(r"\s*#\s*(?:include|pragma)\b", match[0]) else match[0],
        code_of(text),
    )


@TEXTS.cached()
def macros_of(text: str) -> tuple[Macro, ...]:
    """Return the macros of a text, in its order."""
    macros = []
    for directive in DIRECTIVE.finditer(code_of(text)):
        if match := _MACRO.match(directive[0]):
            parameters = frozenset(word for word, _ in identifiers(match[2] or ""))
            start = directive.start()
            macros.append(Macro(match[1], parameters, start, start + match.end(), directive.end()))
    return tuple(macros)


@TEXTS.cached()
def locals_of(text: str, function: Declared) -> tuple[Local, ...]:
    """Return the names that a function declares, its own arguments too, in their order."""
    code = without_directives(text)[: max(function.end, function.start)]
    locals_found: list[Local] = []
    for match in _LOCAL.finditer(code, function.start):
        if match[1] in _NOT_TYPES or match.start(2) <= function.at:
            continue
        end = _scope_end(code, match.start(2))
        name, at = match[2], match.start(2)
        while True:
            behind = _declarator_end(code, at + len(name))
            locals_found.append(Local(name, at, behind, end))
            following = _NEXT_IN_LIST.match(code, behind)
            if following is None:
                break
            name, at = following[1], following.start(1)
    return tuple(locals_found)


def has_branches(text: str, function: Declared) -> bool:
    """Return whether parts of a function exclude each other, by ``#else`` or ``#elif``."""
    inside = DIRECTIVE.finditer(code_of(text), function.start, max(function.end, function.start))
    return any(re.match(r"\s*#\s*el", directive[0]) for directive in inside)


def local_at(candidates: Iterable[Local], name: str, at: int) -> Local | None:
    """Return the local that a name at a place stands for, or declares; None for a name of the top level."""
    there = [
        local
        for local in candidates
        if local.name == name and (local.at == at or local.seen <= at < local.end)
    ]
    return next(
        (local for local in there if local.at == at), max(there, key=lambda local: local.at, default=None)
    )


def _declarator_end(code: str, at: int) -> int:
    """Return where a declared name ends, with its brackets and its value."""
    depth = 0
    for match in re.compile(r"[][(){};,]").finditer(code, at):
        mark = match[0]
        if depth == 0 and mark in ";,)]}":
            return match.start()
        depth += (mark in "([{") - (mark in ")]}")
    return len(code)


def _scope_end(code: str, at: int) -> int:
    """Return where the block ends that a place is in: of a loop's head, behind the loop."""
    depth = 0
    for match in reversed(list(re.compile(r"[(){}]").finditer(code, 0, at))):
        depth += 1 if match[0] in ")}" else -1
        if depth < 0 and match[0] == "{":
            return _closing(code, match.start())
        if depth < 0:
            before = _BEFORE_BRACKET.search(code[: match.start()])
            if before is not None and before[1] in _OWN_SCOPE:
                return _statement_end(code, _closing(code, match.start()) + 1)
            return len(code)  # an argument
    return len(code)


def _closing(code: str, at: int) -> int:
    """Return where the bracket at a place is closed; the code's end where it is not."""
    depth = 0
    for match in re.compile(r"[(){}]").finditer(code, at):
        depth += 1 if match[0] in "({" else -1
        if depth == 0:
            return match.start()
    return len(code)


def _statement_end(code: str, at: int) -> int:
    """Return where the statement that begins at a place ends."""
    branches = 0
    while (control := _CONTROL.match(code, at)) is not None:
        branches += control[1] == "if"
        at = _closing(code, control.end() - 1) + 1 if control[1] else control.end()
    brace = re.compile(r"\s*\{").match(code, at)
    end = _closing(code, brace.end() - 1) if brace is not None else code.find(";", at)
    end = end + 1 if end >= 0 else len(code)
    following = _ELSE.match(code, end) if branches else None
    return end if following is None else _statement_end(code, following.end())
