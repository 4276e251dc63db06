"""Guess what a name was meant to be that a driver does not know, from what the text and the library have."""

from __future__ import annotations

import difflib
import re
from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator
from functools import cache

from playground.gpu.driver_log import LogEntry
from playground.gpu.own_shaders import own_part
from playground.paths import GLSL, SKETCHES, shown
from playground.sketch.model import Kernel
from playground.sketch.reserved_names import GIVEN, GIVEN_INSTEAD, GLSL_WORDS, PLAIN_UNIFORMS
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
FOLLOWS = re.compile(
    r"\berror\b|numeric|mismatch|no matching|cannot|can't|could not|wrong|incompatible|invalid|does not"
    r"|must be|non-vector|swizzle|field|unable to find",
    re.IGNORECASE,
)
"""What drivers say of an expression around a name that they do not know."""
UNFIT = re.compile(r"no matching|unable to find compatible", re.IGNORECASE)
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


def without_consequences(entries: Iterable[LogEntry]) -> Iterator[LogEntry]:
    """Yield the entries of a log: of an unknown name the first, and nothing that follows from it.

    What follows is an expression around the name, or around a call that fits no function.
    """
    seen: set[str] = set()
    cause = (0, 0)  # line and column
    for entry in entries:
        head, place = _head(entry.message), (entry.line, entry.column)
        follows = 0 < entry.line and place <= cause and FOLLOWS.search(head) is not None
        name = "" if follows else _unknown(head)
        if name or (UNFIT.search(head) and not follows):
            cause = place
        if entry.severity != "error" or not (follows or name in seen):
            yield entry
        if name:
            seen.add(name)


def names_given(kernel: Kernel) -> frozenset[str]:
    """Return the names that a kernel, or the tool of another shader, is given without declaring them."""
    if kernel.dialect:
        helpers = "\n".join(own_part(part) for part in kernel.helpers)
        found = [*FUNCTION.finditer(helpers), *DEFINE.finditer(helpers)]
        return frozenset({*(name for name, _ in kernel.tool_names), *(match[1] for match in found)})
    return frozenset(GIVEN) if _is_own(kernel) else frozenset()


def whereabouts(message: str, source: SourceText, line: Line | None, kernel: Kernel) -> str:
    """Return in one sentence where an unknown name is declared, or who is given it; "" where nobody is."""
    name = _unknown(message)
    if not name or line is None:
        return ""
    here = next((number for number, one in enumerate(source.lines) if one is line), 0)
    places = _places(source)
    for kind, number in sorted(places.get(name, ())):
        place = f"{shown(source.lines[number].file)}:{source.lines[number].number}"
        if kind == "called" or (kind == "global" and number <= here):
            return ""  # ``guess`` knows functions
        return (GUESSES["below"] if kind == "global" else WHEREABOUTS["block"]).format(name, place)
    return _given_elsewhere(name, kernel)


def _places(source: SourceText) -> dict[str, set[tuple[str, int]]]:
    """Return the names that a text declares, each with the kinds and the lines, from 0, of where."""
    from playground.sketch.expanded import readings
    from playground.sketch.variables import Declarations

    found: dict[str, set[tuple[str, int]]] = defaultdict(set)
    for tokens in readings(source.code):
        for name, kind, at in Declarations(tokens).names():
            if kind != "member":
                found[name].add((kind, tokens[at].line))
    return found


def _given_elsewhere(name: str, kernel: Kernel) -> str:
    """Say so where other shaders are given a name, and what is called otherwise here."""
    from playground.sketch.dialects import isf, main

    kinds = {**isf.NAMES, **main.NAMES}
    given = kernel.tool_names if kernel.dialect else tuple(_MEANINGS.items()) if _is_own(kernel) else ()
    if kernel.kind == "plain_fragment" and not kernel.dialect and name in _PLAIN:
        return WHEREABOUTS["undeclared"].format(name, kinds[name][0])
    if name in dict(given) or (_is_own(kernel) and name in GIVEN_INSTEAD):
        return ""
    meaning = _MEANINGS.get(name) or _ALIKE.get(kinds.get(name, ("", ""))[1], "")
    if not meaning and name not in GIVEN:
        return ""
    same = next((own for own, means in given if meaning and _ALIKE.get(means) == meaning), "")
    if same:
        return WHEREABOUTS["same"].format(name, same)
    return WHEREABOUTS["kernels"].format(name) if name in GIVEN and not _is_own(kernel) else ""


def _is_own(kernel: Kernel) -> bool:
    """Return whether a kernel is one of ours, not a library file alone."""
    return bool(kernel.outputs) and not kernel.kind.startswith("plain")


def _head(message: str) -> str:
    return message.split("\n", 1)[0][:600]


def _unknown(message: str) -> str:
    """Return the name that a message calls unknown; "" for any other."""
    found = UNKNOWN.search(_head(message))
    return next(group for group in found.groups() if group) if found else ""


WHEREABOUTS = {
    "block": "`{0}` is declared at {1}, in a block or a function of its own: it exists only there.",
    "undeclared": "`{0}` is given where it is declared: add `uniform {1} {0};` above.",
    "same": "`{0}` is not given here; `{1}` is the same.",
    "kernels": "`{0}` is given to kernels, and this file is none: take it as an argument, or declare it.",
}
"""Where a name is known, or to whom → its sentence."""

_MEANINGS = {"time": "time", "size": "resolution"}  # of names that a kernel is given
_ALIKE = {
    **{meaning: meaning for meaning in PLAIN_UNIFORMS},
    **dict.fromkeys(("hover", "hover_share", "drag"), "mouse"),
    "frame_of_time": "frame",
    "date_from_1": "date",
}
"""Meanings of what tools give → those of ``PLAIN_UNIFORMS`` that are the same."""
_PLAIN = frozenset(name for names in PLAIN_UNIFORMS.values() for name in names)


def guess(
    message: str, source: SourceText, line: Line | None, given: Collection[str] = frozenset(GIVEN)
) -> str:
    """Return in one sentence what an unknown name was meant to be; "" where that is not sure.

    ``message`` is a driver's, of any maker; ``line`` is where it points, None where it points nowhere.
    ``given`` are names that need no declaration.
    """
    name = _unknown(message)
    if not name:
        return _unread(source, line) if line is not None and UNREAD.search(_head(message)) else ""
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
    known = {*functions, *given, *(GLSL_WORDS if called else variables)}
    near = _nearest(name, known - {name})
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
