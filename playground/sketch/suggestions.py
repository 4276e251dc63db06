"""What may stand at a place of a shader that is typed: names, words, options, files; texts alone.

The language server and the code pane of the window show it, each in its own way.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from playground.allowed_files import names_below
from playground.paths import GLSL, SKETCHES
from playground.shader.header import FALLBACKS, MODIFIERS
from playground.shader.kernel import FORMATS, PRAGMAS, Option, options_of
from playground.shader.libraries import libraries
from playground.shader.names import is_comment, syntax_of, word_at
from playground.shader.outline import Declared
from playground.shader.reserved_names import GLSL_WORDS
from playground.shader.syntax.nodes import Struct
from playground.shader.syntax.types import components
from playground.shader.widgets import WIDGETS
from playground.sketch.model import Parameter, Technique
from playground.sketch.shader_names import Shader, library_declared, shader_at

Listed = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class Suggestion:
    """One thing that may stand at a place."""

    label: str  # what is inserted
    kind: str  # function, struct, variable, uniform, macro, keyword, property, choice, field, file, module
    detail: str = ""  # a type, a signature
    about: str = ""
    order: int = 5  # a lower one is listed first
    origin: Parameter | Technique | tuple[Path, Declared] | None = None  # what it stands for
    include: str = ""  # what the text must include for it
    start: int = -1  # where what it replaces begins; -1: at the identifier's beginning


_INCLUDE = re.compile(r"\s*#\s*include\s*[\"<]([^\">]*)$")
_PRAGMA = re.compile(r"\s*#\s*pragma\s+(?:(\w+)\s*\((.*)|(\w*))$", re.DOTALL)
_OPTION = re.compile(r"(\w+)\s*=\s*\"([^\"]*)$")
_UNIFORM = re.compile(r"\s*uniform\s+(\w+)\s+\w+")
_SAMPLING = ("nearest", "linear", "clamp", "repeat", "mipmap")


def suggestions(path: Path, text: str, root: Path, at: int, listed: Listed) -> list[Suggestion]:
    """Return what may stand at a place of a shader's text; ``root``: the folder that it may include from.

    The text is that of the file as it is read (``reading_unsaved``). ``listed``: what options of pragmas may
    be that the engine knows, by their names: meshes and sources.
    """
    line = text.rfind("\n", 0, at) + 1
    before = text[line:at]
    if include := _INCLUDE.match(before):
        return _includes(path, root, include[1], at)
    if pragma := _PRAGMA.match(before):
        return _pragma(pragma, listed)
    if "//!" in before:
        return _annotation(text[line:at], _uniform_above(text, line))
    if not before.strip() or before.lstrip().startswith("#"):
        return [] if before.lstrip().startswith("#") else _names(path, text, root, at)
    return [] if is_comment(text, at) else _names(path, text, root, at)


def _includes(path: Path, root: Path, typed: str, at: int) -> list[Suggestion]:
    in_library = path.is_relative_to(GLSL) and not path.is_relative_to(SKETCHES)
    folders = (GLSL,) if in_library else (path.parent, root, GLSL)
    names: dict[str, str] = {}
    for folder in dict.fromkeys(folders):
        for name in names_below((folder,), (".glsl",)):
            if (folder / name) != path and not name.startswith("sketches/"):
                names.setdefault(name, "glsl" if folder == GLSL else "")
    for library, folder in libraries().items() if "/" in typed else ():
        if typed.startswith(f"{library}/"):
            names |= dict.fromkeys(
                (f"{library}/{name}" for name in names_below((folder,), (".glsl",))), library
            )
    names |= dict.fromkeys((f"{name}/" for name in libraries()), "library")
    start = at - len(typed)
    return [Suggestion(name, "file", origin, start=start) for name, origin in names.items()]


def _pragma(match: re.Match[str], listed: Listed) -> list[Suggestion]:
    kind, inside, is_started = match.groups()
    if is_started is not None:
        return [Suggestion(name, "keyword") for name in PRAGMAS]
    if kind not in PRAGMAS:
        return []
    rows = options_of(PRAGMAS[kind])
    if value := _OPTION.search(inside):
        return _choices(rows.get(value[1]), listed)
    if inside.count('"') % 2:  # one that may stand without its name
        return _choices(next((row for row in rows.values() if row.positional), None), listed)
    options = re.findall(r"(\w+)\s*=", inside)
    result = [row for name, row in rows.items() if name not in options]
    return [Suggestion(row.name, "property", f"#pragma {kind}", row.about) for row in result]


def _choices(row: Option | None, listed: Listed) -> list[Suggestion]:
    """Return what an option may be."""
    if row is None:
        return []
    names = {"output": FORMATS, **listed}.get(row.name, row.choices)
    return [Suggestion(name, "choice") for name in names]


def _uniform_above(text: str, line: int) -> str:
    """Return the GLSL type of the uniform whose annotation a line has, or goes on with."""
    lines = text[: text.find("\n", line) if text.find("\n", line) >= 0 else len(text)].split("\n")
    while len(lines) > 1 and lines[-1].lstrip().startswith("//!"):
        lines.pop()
    match = _UNIFORM.match(lines[-1])
    return match[1] if match else ""


def _annotation(before: str, glsl_type: str) -> list[Suggestion]:
    written = before.partition("//!")[2]
    if written.count('"') % 2:
        return []
    if written.count("(") > written.count(")"):
        word = re.findall(r"(\w+)\s*\(", written)[-1:]
        if word in (["input"], ["file"]):
            words = (*_SAMPLING, *(FALLBACKS if word == ["input"] else ("paint",)))
            return [Suggestion(choice, "choice") for choice in words]
        return []
    items = []
    if not re.search(r"\w", written.replace(re.split(r"\W", written)[-1], "", 1)):
        items = [
            Suggestion(name, "keyword", kind.takes, kind.about, order=1)
            for name, kind in WIDGETS.items()
            if name != "number" and glsl_type in kind.types
        ]
        if glsl_type == "sampler2D":
            items.append(Suggestion("input", "keyword", order=1))
    used = set(re.findall(r"\w+", written))
    return items + [Suggestion(f"{name}()", "keyword", order=2) for name in sorted(MODIFIERS - used)]


def _names(path: Path, text: str, root: Path, at: int) -> list[Suggestion]:
    shader = shader_at(path, text, root)
    start = word_at(text, at)[1]
    if start and text[start - 1] == ".":  # a component or a member
        return _members(shader, start - 1)
    items: dict[str, Suggestion] = {}
    for name, local in syntax_of(text).visible(start).items():
        items[name] = Suggestion(name, "variable", local.type, order=1)
    for parameter in shader.parameters:
        found = Suggestion(parameter.name, "variable", parameter.type, order=2, origin=parameter)
        items.setdefault(parameter.name, found)
    if shader.is_kernel:
        for name, (glsl_type, meaning) in shader.engine_names.items():
            items.setdefault(name, Suggestion(name, "variable", glsl_type, meaning, 2))
    for file, _, declaration in shader.declared():
        if not (file == path and declaration.at == start):
            found = Suggestion(
                declaration.name, declaration.kind, declaration.signature, order=3, origin=(file, declaration)
            )
            items.setdefault(declaration.name, found)
    typed = text[start:at]
    if typed:
        for name, places in library_declared().items():
            if name not in items and name[:1].lower() == typed[:1].lower():
                from_file, declaration = places[0]
                items[name] = Suggestion(
                    name,
                    "function",
                    declaration.signature,
                    order=4,
                    origin=(GLSL / from_file, declaration),
                    include=from_file,
                )
        for name in GLSL_WORDS:
            if name[:1].lower() == typed[:1].lower():
                items.setdefault(name, Suggestion(name, "keyword", order=6))
    items.pop("", None)
    return list(items.values())


def _members(shader: Shader, dot: int) -> list[Suggestion]:
    """Return the members of the struct before a dot; of every struct, where its type is not known."""
    structs = {s.name: s.node for s in shader.unit.syntax.symbols.symbols if isinstance(s.node, Struct)}
    glsl_type = shader.type_before(dot)
    items: dict[str, Suggestion] = {}
    for struct, node in structs.items() if glsl_type not in structs else [(glsl_type, structs[glsl_type])]:
        for member in node.members if not components(glsl_type)[1] else ():
            for name in member.names:
                items.setdefault(name.name, Suggestion(name.name, "field", f"{member.type.name} of {struct}"))
    return list(items.values())


def include_row(text: str) -> int:
    """Return the line that an include is added before: behind the first run of them, or behind the header."""
    lines = text.split("\n")
    rows = [row for row, line in enumerate(lines) if re.match(r"\s*#\s*include\b", line)]
    if rows:
        row = rows[0]
        while row + 1 in rows:
            row += 1
        return row + 1
    return next((row for row, line in enumerate(lines) if not line.startswith("//")), 0)
