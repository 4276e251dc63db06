"""Find what a shader's text declares for all of it: uniforms, and what its vertex shader gives.

Text only, by statements: comments are blanked already, and so are branches that are off.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from itertools import groupby

from playground.sketch.expanded import readings
from playground.sketch.variables import Declarations

_PRECISION = r"(?:(?:lowp|mediump|highp)\s+)?"
_MEMORY = r"(?:(?:coherent|volatile|restrict|readonly|writeonly)\s+)*"
_BEGINS = r"(?:^|[;{}\n])[ \t]*"
_UNIFORM = re.compile(
    rf"{_BEGINS}(?:layout\s*\([^)]*\)\s*)?uniform\s+{_MEMORY}{_PRECISION}(\w+)(\s*\[[^\]]*\]\s*|\s+)"
    r"([^;{}]*)(?=;)",
    re.MULTILINE,
)
_IN = re.compile(
    rf"{_BEGINS}(layout\s*\([^)]*\)\s*)?"
    rf"((?:(?:flat|smooth|noperspective|centroid|sample|invariant)\s+)*)in\s+"
    rf"((?:(?:flat|smooth|noperspective|centroid|sample)\s+)*){_PRECISION}(\w+)\s+([^;(){{}}]*)(?=;)",
    re.MULTILINE,
)
_BLOCK = re.compile(rf"{_BEGINS}in\s+(\w+)\s*\{{([^}}]*)\}}\s*(\w*)\s*;", re.MULTILINE)
_MEMBER = re.compile(
    rf"\s*((?:(?:flat|smooth|noperspective|centroid|sample)\s+)*){_PRECISION}(\w+)\s+([^;]*);"
)
_NAME = re.compile(r"\s*([A-Za-z_]\w*)\s*(\[[^\]]*\])?")
_DIRECTIVE = re.compile(r"^[ \t]*#.*$", re.MULTILINE)
_BRACKETS = re.compile(r"\([^()]*\)")
_VECTOR = re.compile(r"vec([234])|float")
_KINDS = {
    "numbers": re.compile(r"float|double|int|uint|bool|[iubd]?vec[234]"),
    "matrix": re.compile(r"mat[34]"),
    "sampler": re.compile(r"[iu]?sampler\w+"),
}
"""What a tool gives that declares a uniform of one of these types, another of them can be given, too."""


@dataclass(frozen=True, slots=True)
class Declared:
    """A uniform."""

    name: str
    type: str
    is_array: bool
    line: int  # of the text, from 0
    written: str  # the name, its array and its initial value


@lru_cache(maxsize=32)  # passes of one file share a text
def uniforms(code: str) -> Mapping[str, Declared]:
    """Return the uniforms that a text declares, by name; of one in two branches, the first."""
    code = expanded(code)
    found: dict[str, Declared] = {}
    for match in _UNIFORM.finditer(code):
        of_type = match.group(2).strip()  # the array of "float[3] a"
        for name, array, at, written in _names(match.group(3)):
            line = code.count("\n", 0, match.start(3) + at)
            written = written.replace(name, f"{name}{of_type}", 1)
            found.setdefault(name, Declared(name, match.group(1), bool(array or of_type), line, written))
    return found


def expanded(code: str) -> str:
    """Return a text, as many lines, without its directives and with the macros expanded."""
    lines = _DIRECTIVE.sub("", code).split("\n")
    for tokens in readings(code):
        for line, some in groupby(tokens, key=lambda token: token.line):
            texts = [token.text for token in some]
            if "".join(texts) != "".join(lines[line].split()):
                lines[line] = " ".join(texts)
    return "\n".join(lines)


def takes(kind: str, given: str) -> bool:
    """Return whether a uniform of a type can be given what another type is given."""
    kinds = [
        next((n for n, sign in _KINDS.items() if sign.fullmatch(one.partition("[")[0])), one)
        for one in (kind, given)
    ]
    return kinds[0] == kinds[1]


def is_declared(code: str, name: str, *, anywhere: bool) -> bool:
    """Return whether a text declares a variable or a function, outside of functions or ``anywhere``."""
    kinds = declared_names(code).get(name, frozenset())
    return bool(kinds & {"global", "called"}) or (anywhere and bool(kinds))


@lru_cache(maxsize=32)
def declared_names(code: str) -> Mapping[str, frozenset[str]]:
    """Return the names that a text declares, its macros expanded, with their kinds: see ``Declarations``."""
    found: dict[str, frozenset[str]] = {}
    for tokens in readings(code):
        for name, kind, _ in Declarations(tokens).names():
            found[name] = found.get(name, frozenset()) | {kind}
    return found


@lru_cache(maxsize=32)
def vertex_outputs(code: str) -> tuple[tuple[str, str], ...]:
    """Return what the vertex shader gives a fragment shader: declarations, and statements that set them."""
    code = expanded(code)
    found: dict[str, tuple[str, str]] = {}
    for block in _BLOCK.finditer(code):
        members = " ".join(block.group(2).split())
        instance = block.group(3)
        statements = [
            _set(f"{instance}.{name}" if instance else name, name, member.group(2), array)
            for member in _MEMBER.finditer(block.group(2))
            for name, array, _, _ in _names(member.group(3))
        ]
        declaration = f"out {block.group(1)} {{ {members} }} {instance};"
        found.setdefault(block.group(1), (declaration, " ".join(statements)))
    for match in _IN.finditer(code):
        layout, before, after, kind, names = match.groups()
        for name, array, _, _ in _names(names):
            if not name.startswith("gl_"):
                ways = " ".join(f"{before}{after}".split())
                declaration = " ".join(f"{layout or ''} {ways} out {kind} {name}{array};".split())
                found.setdefault(name, (declaration, _set(name, name, kind, array)))
    return tuple(found.values())


def _names(text: str) -> Iterator[tuple[str, str, int, str]]:
    """Yield (name, array, place, as written with its initial value) of each name that a declaration lists."""
    flat = text
    while (inner := _BRACKETS.sub(lambda m: " " * len(m.group()), flat)) != flat:
        flat = inner
    start = 0
    for part in flat.split(","):
        if match := _NAME.match(part):
            written = text[start + match.start(1) : start + len(part)]
            yield match.group(1), (match.group(2) or "").strip(), start + match.start(1), written
        start += len(part) + 1


def _set(place: str, name: str, kind: str, array: str) -> str:
    """Return the statement that sets one output."""
    value = _value(name.lower(), kind)
    if array:
        return f"for (int k_i = 0; k_i < {place}.length(); ++k_i) {place}[k_i] = {value};"
    return f"{place} = {value};"


def _value(name: str, kind: str) -> str:
    """Return an output's value by its name: coordinates 0..1, a position -1..1, a normal, white, else 0."""
    vector = _VECTOR.fullmatch(kind)
    if kind.startswith("mat"):
        return f"{kind}(1.0)"
    if vector is None or kind == "float":
        return f"{kind}({'1' if 'color' in name or 'colour' in name else '0'})"
    count = int(vector.group(1))
    if "color" in name or "colour" in name:
        return f"{kind}(1.0)"
    if "normal" in name:
        return {2: "vec2(0.0)", 3: "vec3(0.0, 0.0, 1.0)", 4: "vec4(0.0, 0.0, 1.0, 0.0)"}[count]
    if re.search(r"uv|tex|coord", name.replace("vertex", "")):
        return {2: "k_share", 3: "vec3(k_share, 0.0)", 4: "vec4(k_share, 0.0, 1.0)"}[count]
    if "pos" in name:
        return {2: "k_place", 3: "vec3(k_place, 0.0)", 4: "vec4(k_place, 0.0, 1.0)"}[count]
    return f"{kind}(0.0)"
