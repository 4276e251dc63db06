"""Rewrite older GLSL (1.00 to 1.50, and that of OpenGL ES) as GLSL 3.30, line by line.

Tokens outside comments change, on ``Line.code``; lines stay, and columns where the new word is
not the longer one. ``Line.text`` stays what the author wrote.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from itertools import zip_longest

from playground.shader.declarations import declared_names, is_declared
from playground.shader.source import Line, SourceText
from playground.shader.syntax.nodes import Function
from playground.shader.syntax.symbols import symbols_of
from playground.shader.syntax.tokens import as_written

_LOOKUPS = {
    f"{kind}{way}{level}{origin}": f"texture{way}{level}"
    for kind in (
        *("texture1D", "texture2D", "texture3D", "textureCube", "texture2DRect"),
        *("shadow1D", "shadow2D", "shadow2DRect"),
    )
    for way in ("", "Proj")
    for level in ("", "Lod", "Grad")
    for origin in ("", "EXT", "ARB")
}
"""Older functions that look a texture up, each with what it is called since GLSL 1.30."""

_COLOUR, _DATA = "k_frag_color", "k_frag_data"  # as long as gl_FragColor and gl_FragData
_OF_VERTICES = {
    "gl_TexCoord": ("k_tex_coord", "vec4 k_tex_coord[8]"),
    "gl_Color": ("k_color", "vec4 k_color"),
    "gl_SecondaryColor": ("k_second", "vec4 k_second"),
    "gl_FogFragCoord": ("k_fog", "float k_fog"),
}
"""What older vertex shaders gave under names of GLSL's own: the new name, and its declaration."""

_OURS = frozenset(
    "k_frag_color k_frag_data k_tex_coord k_color k_second k_fog k_window k_part k_picture k_corner k_share "
    "k_place k_i k_pixel k_origin k_ray k_face k_way k_side".split()
).union(f"k_z{digit}" for digit in range(10))
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


@dataclass(frozen=True)
class Rewritten:
    """A text in GLSL 3.30 or later, or in the version of 3.30 and later that it asks for."""

    source: SourceText
    prelude: tuple[str, ...]  # lines that come before it: extensions, outputs
    names: Mapping[str, str] = field(default_factory=dict)  # the author's name → what it is called in it


def directives(source: SourceText) -> Iterator[list[str]]:
    """Yield the words and marks of each directive of a text, behind its ``#``."""
    for line in source.lines:
        if "#" in line.code and (texts := [token.text for token in as_written(line.code)])[:1] == ["#"]:
            yield texts[1:] or [""]


def _version(source: SourceText) -> list[str]:
    """Return the number of a text's ``#version`` and what follows it; nothing where it has none."""
    found = next((words for words in directives(source) if words[:1] == ["version"]), [])
    return found[1:] if found[1:] and found[1].isdecimal() else []


def version_of(source: SourceText) -> int:
    """Return the desktop version that a text asks for, 0 where it asks for none or for one of OpenGL ES."""
    number, *profile = _version(source) or ["0"]
    return 0 if profile == ["es"] or number == "100" else int(number[:9])


def rewritten(source: SourceText, *, is_vertex: bool = False, declared: Collection[str] = ()) -> Rewritten:
    """Rewrite a text; one of ``#version`` 330 or more keeps its version and its extensions.

    ``declared`` are names that its tool declares for it: they are renamed where GLSL 3.30 has taken them.
    """
    is_modern = version_of(source) >= 330
    names: dict[str, str] = {}
    if int((_version(source) or ["0"])[0][:9]) < 130:
        names = _clashing(source, declared)
    names |= _free(source.names & _OURS, source)
    names |= _free(_lookups_of_its_own(source), source)
    data = "gl_FragData" in source.names and not is_vertex
    own = _own_functions(source) if names else set[str]()
    words = {
        **_LOOKUPS,
        **{old: new for old, (new, _) in _OF_VERTICES.items()},
        "varying": "out" if is_vertex else "in",
        "attribute": "in",
        "gl_FragColor": f"{_DATA}[0]" if data else _COLOUR,
        "gl_FragData": _DATA,
        "gl_FragDepthEXT": "gl_FragDepth",
    }
    is_the_same = source.names.isdisjoint((*words, *names))
    lines: list[Line] = []
    extensions: list[str] = []
    for line in source.lines:
        code = line.code
        if "#" in code:
            _, word, *_ = (*(token.text for token in as_written(code)), "", "")
            if word == "extension" and is_modern:
                extensions.append(code.strip())
            if word in ("pragma", "extension") or (word == "version" and not is_modern):
                lines.append(replace(line, code=""))
                continue
        new = code if is_the_same else _with_words(code, words, names, own)
        lines.append(line if new == code else replace(line, code=new))
    inputs = [declared for old, (_, declared) in _OF_VERTICES.items() if old in source.names]
    prelude = [*extensions, *(f"in {declared};" for declared in inputs)]
    if data:
        prelude = [*prelude, f"layout(location = 0) out vec4 {_DATA}[4];"]
    elif "gl_FragColor" in source.names and not is_vertex:
        prelude = [*prelude, f"layout(location = 0) out vec4 {_COLOUR};"]
    made = SourceText(source.path, tuple(lines), source.files)
    return Rewritten(made, tuple(prelude), names)


def _with_words(code: str, words: Mapping[str, str], names: Mapping[str, str], own: Collection[str]) -> str:
    """Return a line with old words replaced by what is as long, and names by others.

    A name that is one of GLSL's functions stays where it is called, or where a macro stands for it.
    """
    pieces, end, tokens = list[str](), 0, list(as_written(code))
    is_directive = tokens[:1] and tokens[0].text == "#"
    for token, after in zip_longest(tokens, tokens[1:]):
        is_call = is_directive if after is None else after.text == "("
        if token.text in names and not (token.text in _FUNCTIONS and is_call and token.text not in own):
            new = names[token.text]
        elif token.text in words:  # in a definition, blanks before the bracket would make another macro of it
            new = words[token.text].ljust(0 if is_directive else len(token.text))
        else:
            continue
        pieces += [code[end : token.start], new]
        end = token.end
    return "".join([*pieces, code[end:]])


def _clashing(source: SourceText, declared: Collection[str]) -> dict[str, str]:
    """Return the author's names that GLSL 3.30 has taken, each with a free one."""
    clashes = sorted(source.names & _NEVER_NAMES)
    clashes += [name for name in declared if name in _SINCE_TAKEN or name in _FUNCTIONS]
    clashes += [name for name in sorted(source.names & _SINCE_TAKEN) if _declares(source, name)]
    functions = [name for name in _FUNCTIONS if name in source.names]
    clashes += [name for name in functions if _declares(source, name, variable=True)]
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
    looked_up = {_LOOKUPS[name] for name in source.names & _LOOKUPS.keys()}
    return {name for name in looked_up & source.names if _declares(source, name)}


def _lookups_of_its_own(source: SourceText) -> list[str]:
    """Return the older lookups that a text defines as functions: their calls are those of its own."""
    if source.names.isdisjoint(_LOOKUPS):
        return []
    return [
        node.name
        for node in symbols_of(source.code).tree.declarations
        if isinstance(node, Function) and node.name in _LOOKUPS
        if node.parameters and node.parameters[0].type.name.startswith("sampler")
    ]


def _declares(source: SourceText, name: str, *, variable: bool = False) -> bool:
    """Return whether a text declares a name, or defines it as a macro; ``variable``: no function either."""
    if variable:
        return bool(declared_names(source.code).get(name, frozenset()) - {"called"})
    is_macro = any(words[:2] == ["define", name] for words in directives(source))
    return is_macro or is_declared(source.code, name, anywhere=True)
