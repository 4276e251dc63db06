"""Rewrite older GLSL (1.00 to 1.50, and that of OpenGL ES) as GLSL 3.30, line by line.

Tokens outside comments change, on ``Line.code``; lines stay, and columns where the new word is
not the longer one. ``Line.text`` stays what the author wrote.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace

from playground.shader.declarations import declared_names, is_declared
from playground.shader.source import Line, SourceText

_VERSION = re.compile(r"\s*#\s*version\s+(\d{1,9})\d*\s*(\w*)")
_EXTENSION = re.compile(r"\s*#\s*extension\b")
_PRAGMA = re.compile(r"\s*#\s*pragma\b")
_DIRECTIVE = re.compile(r"\s*#")
_OLD = re.compile(
    r"\b(?:(?P<lookup>texture(?:[123]D|Cube|2DRect)|shadow(?:[12]D|2DRect))(?P<way>Proj)?(?P<level>Lod|Grad)?"
    r"(?:EXT|ARB)?|varying|attribute"
    r"|gl_(?:FragColor|FragData|FragDepthEXT|TexCoord|Color|SecondaryColor|FogFragCoord))\b"
)
_COLOUR, _DATA = "k_frag_color", "k_frag_data"  # as long as gl_FragColor and gl_FragData
_OF_VERTICES = {
    "gl_TexCoord": ("k_tex_coord", "vec4 k_tex_coord[8]"),
    "gl_Color": ("k_color", "vec4 k_color"),
    "gl_SecondaryColor": ("k_second", "vec4 k_second"),
    "gl_FogFragCoord": ("k_fog", "float k_fog"),
}
"""What older vertex shaders gave under names of GLSL's own: the new name, and its declaration."""

_OURS = re.compile(
    r"k_(?:frag_color|frag_data|tex_coord|color|second|fog|window|part|picture|corner|share|place|i|z\d"
    r"|pixel|origin|ray|face|way|side)"
)
"""Names that come before or after a text, or are in the vertex shader that is made for it."""

_NEVER_NAMES = frozenset(
    """
    filter input output common active partition resource class union enum typedef template this packed
    goto inline noinline public static extern external interface long short half fixed unsigned superp
    namespace using cast sizeof asm hvec2 hvec3 hvec4 fvec2 fvec3 fvec4
    """.split()
)
"""Reserved words of GLSL 3.30 that mean nothing in older versions: a text that uses one means a name."""

_SINCE_TAKEN = frozenset(
    """
    sample smooth flat layout switch case default uint uvec2 uvec3 uvec4 centroid noperspective patch
    subroutine precise shared buffer coherent volatile restrict readonly writeonly double dvec2 dvec3
    dvec4 mat2x2 mat2x3 mat2x4 mat3x2 mat3x3 mat3x4 mat4x2 mat4x3 mat4x4
    """.split()
)
"""Words that mean something in GLSL 3.30 to 4.00: names only where the text declares them."""

_FUNCTIONS = ("texture", "textureSize", "textureProj", "textureLod", "textureGrad")
"""Functions that the rewriting calls: a variable of that name would hide them."""

_SAMPLER_FIRST = r"\s*\(\s*(?:const\s+)?(?:in\s+)?(?:(?:lowp|mediump|highp)\s+)?sampler"


@dataclass(frozen=True)
class Rewritten:
    """A text in GLSL 3.30 or later, or in the version of 3.30 and later that it asks for."""

    source: SourceText
    prelude: tuple[str, ...]  # lines that come before it: extensions, outputs
    names: Mapping[str, str] = field(default_factory=dict)  # the author's name → what it is called in it


def version_of(source: SourceText) -> int:
    """Return the desktop version that a text asks for, 0 where it asks for none or for one of OpenGL ES."""
    match = next(filter(None, (_VERSION.match(line.code) for line in source.lines)), None)
    return int(match.group(1)) if match and match.group(2) != "es" and match.group(1) != "100" else 0


def rewritten(source: SourceText, *, is_vertex: bool = False, declared: Collection[str] = ()) -> Rewritten:
    """Rewrite a text; one of ``#version`` 330 or more keeps its version and its extensions.

    ``declared`` are names that its tool declares for it: they are renamed where GLSL 3.30 has taken them.
    """
    is_modern = version_of(source) >= 330
    names: dict[str, str] = {}
    version = next(filter(None, (_VERSION.match(line.code) for line in source.lines)), None)
    if version is None or int(version.group(1)) < 130:
        names = _clashing(source, declared)
    names |= _free({name for name in source.names if _OURS.fullmatch(name)}, source)
    names |= _free(_lookups_of_its_own(source), source)
    data = "gl_FragData" in source.names and not is_vertex
    own = _own_functions(source) if names else ()
    inputs = [declared for old, (_, declared) in _OF_VERTICES.items() if old in source.names]
    rename = re.compile(rf"\b(?:{'|'.join(names)})\b") if names else None
    lines: list[Line] = []
    extensions: list[str] = []
    for line in source.lines:
        code = line.code
        if _DIRECTIVE.match(code):
            if _EXTENSION.match(code) and is_modern:
                extensions.append(code.strip())
            if _PRAGMA.match(code) or _EXTENSION.match(code) or (_VERSION.match(code) and not is_modern):
                lines.append(replace(line, code=""))
                continue
        new = rename.sub(lambda match: _renamed(match, names, own), code) if rename else code
        new = _OLD.sub(lambda match: _new(match, data=data, is_vertex=is_vertex), new)
        lines.append(line if new == code else replace(line, code=new))
    prelude = [*extensions, *(f"in {declared};" for declared in inputs)]
    if data:
        prelude = [*prelude, f"layout(location = 0) out vec4 {_DATA}[4];"]
    elif "gl_FragColor" in source.names and not is_vertex:
        prelude = [*prelude, f"layout(location = 0) out vec4 {_COLOUR};"]
    made = SourceText(source.path, tuple(lines), source.files)
    return Rewritten(made, tuple(prelude), names)


def _new(match: re.Match[str], *, data: bool, is_vertex: bool = False) -> str:
    """Return what replaces an old word, as long as it."""
    old = match.group()
    if match.group("lookup"):
        new = f"texture{match.group('way') or ''}{match.group('level') or ''}"
    elif old == "gl_FragColor":
        new = f"{_DATA}[0]" if data else _COLOUR
    elif old == "varying" and is_vertex:
        new = "out"
    else:
        new = {"gl_FragData": _DATA, "gl_FragDepthEXT": "gl_FragDepth"}.get(old) or _OF_VERTICES.get(
            old, ("in",)
        )[0]
    # In a definition, blanks before the bracket would make another macro of it.
    return new if _DIRECTIVE.match(match.string) else new.ljust(len(old))


def _renamed(match: re.Match[str], names: Mapping[str, str], own: Collection[str]) -> str:
    """Return the new name, but of GLSL's own function where it is called or a macro stands for it."""
    name, after = match.group(), match.string[match.end() :].strip()
    is_call = after.startswith("(") or (not after and _DIRECTIVE.match(match.string))
    return name if name in _FUNCTIONS and is_call and name not in own else names[name]


def _clashing(source: SourceText, declared: Collection[str]) -> dict[str, str]:
    """Return the author's names that GLSL 3.30 has taken, each with a free one."""
    code = source.code
    clashes = sorted(source.names & _NEVER_NAMES)
    clashes += [name for name in declared if name in _SINCE_TAKEN or name in _FUNCTIONS]
    clashes += [name for name in sorted(source.names & _SINCE_TAKEN) if _declares(code, name)]
    clashes += [name for name in _FUNCTIONS if name in source.names and _declares(code, name, variable=True)]
    clashes += sorted(_own_functions(source).difference(clashes))
    return _free(clashes, source)


def _free(declarations: Iterable[str], source: SourceText) -> dict[str, str]:
    """Return names that are taken, each with a free one."""
    names: dict[str, str] = {}
    for name in dict.fromkeys(declarations):
        new = f"{name}_"
        while new in source.names:
            new += "1"
        names[name] = new
    return names


def _own_functions(source: SourceText) -> set[str]:
    """Return the functions of a text that would hide what its older lookups are rewritten as."""
    code = source.code
    looked_up = {_new(match, data=False).rstrip() for match in _OLD.finditer(code) if match.group("lookup")}
    return {name for name in looked_up & source.names if _declares(code, name)}


def _lookups_of_its_own(source: SourceText) -> list[str]:
    """Return the older lookups that a text defines as functions: their calls are those of its own."""
    words = dict.fromkeys(match.group() for match in _OLD.finditer(source.code) if match.group("lookup"))
    typed = r"\b(?!return\b|else\b)[A-Za-z_]\w*\s+"
    return [word for word in words if re.search(rf"{typed}{word}{_SAMPLER_FIRST}", source.code)]


def _declares(code: str, name: str, *, variable: bool = False) -> bool:
    """Return whether a text declares a name, or defines it as a macro; ``variable``: no function either."""
    if variable:
        return bool(declared_names(code).get(name, frozenset()) - {"called"})
    return is_declared(code, name, anywhere=True) or bool(re.search(rf"#\s*define\s+{name}\b", code))
