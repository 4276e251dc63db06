"""Guess what a name was meant to be that a driver does not know, from what the text and the library have."""

from __future__ import annotations

import difflib
import re
from functools import cache

from playground.paths import GLSL, SKETCHES, shown
from playground.sketch.reserved_names import GIVEN, GIVEN_INSTEAD, GLSL_WORDS
from playground.sketch.source import Line, SourceText

_Q = "[`'\"]"
UNKNOWN = re.compile(
    rf"no function with name {_Q}(\w+)|invalid call of (?:undeclared identifier )?{_Q}(\w+)"
    rf"|{_Q}(\w+){_Q} ?: function is not known|{_Q}(\w+){_Q} ?: no matching overloaded function found"
    rf"|{_Q}(\w+){_Q} ?:? ?undeclared"
    rf"|(?:undefined variable|undeclared (?:identifier|variable)):? {_Q}?(\w+)",
    re.IGNORECASE,
)
TYPE = r"(?:void|bool|u?int|float|double|[biud]?vec[234]|d?mat[234](?:x[234])?|[iu]?sampler\w+|[A-Z]\w*)"
FUNCTION = re.compile(rf"\b{TYPE}\s+(\w+)\s*\(")
DEFINITION = re.compile(rf"^{TYPE}\s+(\w+)\s*\(", re.MULTILINE)
VARIABLE = re.compile(rf"\b{TYPE}\s+(\w+)\s*(?:\[[^\]]*\])?\s*(?=[=;,)])")
DEFINE = re.compile(r"^\s*#\s*define\s+(\w+)(\()?", re.MULTILINE)
RUNS = re.compile(r"^\s*#\s*(?:pragma\s+(?:kernel|source|draw|compute)\b|version\b)", re.MULTILINE)
UNREAD = re.compile(
    r"syntax error|parse error|NEW_IDENTIFIER|undeclared type|typename expected", re.IGNORECASE
)
CAST = re.compile(r"(?<![\w)\]])\(\s*(float|int|uint|bool|[iub]?vec[234])\s*\)\s*[\w(.]")
TYPES = (*"float int uint bool void vec2 vec3 vec4 ivec2 ivec3 ivec4 uvec2 uvec3 uvec4".split(),
          *"bvec2 bvec3 bvec4 mat2 mat3 mat4 sampler2D const uniform return struct".split())  # fmt: skip
NEAR = 0.75  # of difflib's ratio

ELSEWHERE = {
    "lerp": "mix", "frac": "fract", "fmod": "mod", "rsqrt": "inversesqrt", "ddx": "dFdx", "ddy": "dFdy",
    "atan2": "atan", "tex2D": "texture", "tex2Dlod": "textureLod", "float2": "vec2", "float3": "vec3",
    "float4": "vec4", "int2": "ivec2", "int3": "ivec3", "int4": "ivec4", "float4x4": "mat4",
    "fabs": "abs", "fabsf": "abs", "sinf": "sin", "cosf": "cos", "sqrtf": "sqrt", "floorf": "floor",
    "powf": "pow", "fmin": "min", "fmax": "max", "fminf": "min", "fmaxf": "max", "ln": "log",
}  # fmt: skip
"""Names of HLSL and C, with GLSL's for the same."""

GUESSES = {
    "elsewhere": "GLSL knows no `{0}`: its name for that is `{1}`.",
    "saturate": "GLSL knows no `saturate`: write `clamp(x, 0.0, 1.0)`.",
    "instead": "`{0}` is given to plain shaders; a kernel is given `{1}`.",
    "library": "`{0}` is in the library: add {1} above.",
    "near": "`{0}` is not declared; did you mean `{1}`?",
    "cast": "GLSL has no casts like ({0}): write {0}(...).",
    "type": "GLSL knows no `{0}`; did you mean `{1}`?",
    "below": "`{0}` is defined further down, at {1}: GLSL reads from above, so move it up.",
}
"""Kind of guess → its sentence."""


def guess(message: str, source: SourceText, line: Line | None) -> str:
    """Return in one sentence what an unknown name was meant to be; "" where that is not sure.

    ``message`` is a driver's, of any maker; ``line`` is where it points, None where it points nowhere.
    """
    head = message.split("\n", 1)[0][:600]
    found = UNKNOWN.search(head)
    if found is None:
        return _unread(source, line) if line is not None and UNREAD.search(head) else ""
    name = next(group for group in found.groups() if group)
    called = bool(re.search(rf"\b{name}\s*\(", line.code if line is not None else source.code))
    functions, variables = _declared(source)
    if name in functions or name in variables:
        return _below(name, functions, source, line) if called else ""
    if name in GLSL_WORDS:
        return ""  # known, but not with these arguments, or not to this version
    if name in ELSEWHERE:
        return GUESSES["elsewhere"].format(name, ELSEWHERE[name])
    if name == "saturate" and called:
        return GUESSES["saturate"]
    own = any(text.pragma for text in source.lines)
    if own and name in GIVEN_INSTEAD:
        return GUESSES["instead"].format(name, GIVEN_INSTEAD[name])
    files = library().get(name, ())
    if files:
        which = " or ".join(f'`#include "{file}"`' for file in files[:3])
        return GUESSES["library"].format(name, which)
    known = {*functions, *(GLSL_WORDS if called else ()), *(() if called else (*variables, *GIVEN))}
    near = _nearest(name, known)
    return GUESSES["near"].format(name, near) if near else ""


def _unread(source: SourceText, line: Line) -> str:
    """Report what a line that GLSL cannot read has of other languages, or which word of it is misspelt."""
    if cast := CAST.search(line.code):
        return GUESSES["cast"].format(cast[1])
    functions, variables = _declared(source)
    for word in re.findall(r"[A-Za-z_]\w*", line.code):
        if word in functions or word in variables or word in GLSL_WORDS or word in GIVEN:
            continue
        if word in ELSEWHERE:
            return GUESSES["elsewhere"].format(word, ELSEWHERE[word])
        # A word that the text has elsewhere as well is a name of its own.
        if source.code.count(word) == 1 and (near := _nearest(word, set(TYPES))):
            return GUESSES["type"].format(word, near)
    return ""


@cache
def library() -> dict[str, tuple[str, ...]]:
    """Return the files to include, from ``glsl/``, that define each function of the library."""
    found: dict[str, list[str]] = {}
    for path in sorted(GLSL.rglob("*.glsl")):
        if path.is_relative_to(SKETCHES):
            continue
        try:
            text = path.read_text(encoding="utf-8")
        except (OSError, UnicodeDecodeError):
            continue
        if RUNS.search(text):
            continue
        for name in {match[1] for match in DEFINITION.finditer(text)}:
            found.setdefault(name, []).append(path.relative_to(GLSL).as_posix())
    return {name: tuple(files) for name, files in found.items()}


def _declared(source: SourceText) -> tuple[dict[str, Line], set[str]]:
    """Return the functions that a text defines, with where, and its variables and macros."""
    functions: dict[str, Line] = {}
    variables: set[str] = set()
    for line in source.lines:
        if not line.code.strip():
            continue
        for match in FUNCTION.finditer(line.code):
            functions.setdefault(match[1], line)
        variables |= {match[1] for match in VARIABLE.finditer(line.code)}
        if macro := DEFINE.match(line.code):
            if macro[2]:
                functions.setdefault(macro[1], line)
            else:
                variables.add(macro[1])
    return functions, variables


def _below(name: str, functions: dict[str, Line], source: SourceText, line: Line | None) -> str:
    """Say so where a function is defined further down than where it is called."""
    there = functions.get(name)
    if there is None or line is None:
        return ""
    order = {id(text): place for place, text in enumerate(source.lines)}
    if order.get(id(there), 0) <= order.get(id(line), 0):
        return ""
    where = f"{shown(there.file)}:{there.number}"
    return GUESSES["below"].format(name, where)


def _nearest(name: str, known: set[str]) -> str:
    """Return the one known name that is like this one; "" where there is none, or two are as near."""
    folded = [other for other in known if other.lower() == name.lower()]
    if len(folded) == 1 and folded[0] != name:
        return folded[0]
    if len(name) < 3:
        return ""
    near = difflib.get_close_matches(name, sorted(known), n=2, cutoff=NEAR)
    if len(near) == 2:
        first, second = (difflib.SequenceMatcher(None, name, other).ratio() for other in near)
        if first == second:
            return ""
    return near[0] if near else ""
