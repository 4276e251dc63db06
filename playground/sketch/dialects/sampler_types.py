"""Tell from a text whether a channel that nothing declares is a picture, a cube map or a volume.

Shadertoy declares its channels by what a user puts there, which a file alone does not say. A lookup does: a
cube map is read at three coordinates, a volume by texels of three. So does a function that a channel is
handed to. Types are followed by name, not by a compiler.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Collection, Iterator

from playground.sketch.dialects.declarations import expanded

_LOOKUP = re.compile(r"\b(texture(?:Lod|Grad|Cube\w*)?)\s*\(\s*(iChannel\d)\s*,")
_TYPES = {
    "float": 1,
    "int": 1,
    "uint": 1,
    "bool": 1,
    **{f"{k}vec{n}": n for k in ("", "i", "u") for n in (2, 3, 4)},
}
_DECLARED = rf"\b({'|'.join(_TYPES)})\s+(?:[A-Za-z_]\w*\s*(?:=[^;,(){{}}]*)?,\s*)*"
_CHANNEL = re.compile(r"iChannel\d")
_TEXELS = re.compile(r"\b(?:texelFetch\s*\(\s*(?=iChannel\d\s*,\s*ivec3\b)|texture3D\w*\s*\(\s*)(iChannel\d)")
_FUNCTION = re.compile(r"\b[A-Za-z_]\w*\s+([A-Za-z_]\w*)\s*\(([^(){};]*)\)\s*[{;]")
_BODY = re.compile(r"\b(?!(?:if|for|while|switch)\b)([A-Za-z_]\w*)\s*\([^(){};]*\)\s*\{")
_MACRO = re.compile(r"^[ \t]*#[ \t]*define[ \t]+([A-Za-z_]\w*)(.*)$", re.MULTILINE)
_WORD = re.compile(r"[A-Za-z_]\w*")
_PARAMETER = re.compile(r"\s*(?:(?:const|in|out|inout|lowp|mediump|highp)\s+)*([A-Za-z_]\w*)")
_SHAPED = {"samplerCube", "sampler3D"}
_LONGEST_CALL = 1_000  # characters
_MOST_LOOKUPS = 4  # of one channel that are looked at
_NEAR = 4_000  # characters, in which most names are declared
_BRACKETS = re.compile(r"\([^()]*\)")
_SWIZZLE = re.compile(r"\.\s*([xyzw]+|[rgba]+|[stpq]+)$")
_NAME = re.compile(r"[A-Za-z_]\w*$")
_CALL = re.compile(r"([A-Za-z_]\w*)\s*\($")
_GIVEN = {"iResolution": 3, "iMouse": 4, "iTime": 1, "fragCoord": 2, "gl_FragCoord": 4}
_OF_ARGUMENTS = frozenset(
    "abs sign floor ceil fract mod min max clamp mix step smoothstep normalize reflect refract sin cos tan "
    "pow exp log sqrt round trunc faceforward".split()
)


def sampler_types(code: str) -> dict[str, str]:
    """Return the channels of a text that are no pictures, each with its type in GLSL."""
    code = expanded(code)
    threes, twos = _looked_up(code)
    types: dict[str, set[str]] = {name: {"sampler2D"} for name in twos}
    for name, kind in (*_handed(code), *((name, "sampler3D") for name in _TEXELS.findall(code))):
        types.setdefault(name, set()).add(kind)
    found = {name: kinds.pop() for name, kinds in types.items() if len(kinds) == 1 and kinds < _SHAPED}
    return {name: "samplerCube" for name in threes - types.keys()} | found


def names_reached(code: str, names: Collection[str]) -> set[str]:
    """Return names, with those that the functions and macros of a text of these names name in turn."""
    bodies: dict[str, set[str]] = {}
    for name, body in (*_bodies(code), *_MACRO.findall(code)):
        bodies.setdefault(name, set()).update(_WORD.findall(body))
    found, added = set[str](), set(names)
    while added:
        found |= added
        added = set().union(*(bodies.get(name, ()) for name in added)) - found
    return found


def _bodies(code: str) -> Iterator[tuple[str, str]]:
    """Yield each function that a text defines, with what is between its braces."""
    for match in _BODY.finditer(code):
        depth, end = 1, match.end()
        while depth and end < len(code):
            depth += {"{": 1, "}": -1}.get(code[end], 0)
            end += 1
        yield match[1], code[match.end() : end]


def _handed(code: str) -> Iterator[tuple[str, str]]:
    """Yield the channels that functions are called with, each with the type that the function takes."""
    functions: dict[str, list[list[str]]] = {}
    for name, parameters in _FUNCTION.findall(code):
        kinds = [found[1] if (found := _PARAMETER.match(one)) else "" for one in parameters.split(",")]
        functions.setdefault(name, []).append(kinds)
    for name, forms in functions.items():
        if not any(kind.startswith("sampler") for kinds in forms for kind in kinds):
            continue
        looked_at = Counter[str]()
        for call in re.finditer(rf"\b{name}\s*\(", code):
            given = _arguments(code, call.end())
            channels = " ".join(one for one in given if _CHANNEL.fullmatch(one))
            looked_at[channels] += 1
            if not channels or looked_at[channels] > _MOST_LOOKUPS:
                continue
            fitting = [kinds for kinds in forms if len(kinds) == len(given)]
            if len(fitting) > 1:
                widths = [_width(one, code[: call.start()]) for one in given]
                fitting = [
                    kinds
                    for kinds in fitting
                    if all(not w or _TYPES.get(k, w) == w for k, w in zip(kinds, widths, strict=True))
                ]
            for at, one in enumerate(given):
                if _CHANNEL.fullmatch(one):
                    yield from ((one, kinds[at]) for kinds in fitting)


def _looked_up(code: str) -> tuple[set[str], set[str]]:
    """Return the channels that a text reads at three coordinates and nowhere else, and those read at two."""
    threes, twos, unknown = Counter[str](), set[str](), set[str]()
    for match in _LOOKUP.finditer(code):
        name = match.group(2)
        if name in twos or threes[name] >= _MOST_LOOKUPS:
            continue
        given = _arguments(code, match.end())
        width = 3 if "Cube" in match.group(1) else _width(given[0] if given else "", code[: match.start()])
        if width == 3:
            threes[name] += 1
        else:
            (twos if width else unknown).add(name)
    return threes.keys() - twos - unknown, twos


def _arguments(code: str, start: int) -> list[str]:
    """Return the texts of a call's arguments from one on, up to the call's bracket; none where it is far."""
    depth, found = 0, list[str]()
    for place in range(start, min(len(code), start + _LONGEST_CALL)):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(code[place], 0)
        if depth < 0 or (depth == 0 and code[place] == ","):
            found.append(code[start:place].strip())
            start = place + 1
        if depth < 0:
            return found
    return []


def _width(text: str, before: str) -> int:
    """Return how many numbers an expression is; 0 where that is not known."""
    text = text.strip()
    parts = _split(text)
    if len(parts) > 1:
        return max((_width(part, before) for part in parts), default=0)
    text = text.lstrip("+-! \n\t")
    if swizzle := _SWIZZLE.search(text):
        return len(swizzle.group(1))
    if text.endswith(")"):
        start = _opening(text)
        inside = text[start + 1 : -1]
        call = _CALL.search(text[: start + 1])
        if call is None:
            return _width(inside, before) if start == 0 else 0
        name = call.group(1)
        if name in _TYPES:
            return _TYPES[name]
        if name == "cross":
            return 3
        if name in _OF_ARGUMENTS:
            return max((_width(part, before) for part in _split(inside, ",")), default=0)
        return _declared(rf"{name}\s*\(", before)
    if _NAME.fullmatch(text):
        return _declared(rf"{text}\b(?!\s*\()", before) or _GIVEN.get(text, 0)
    return 0


def _declared(name: str, before: str) -> int:
    """Return the width of the latest declaration of a name, also behind others with calls in their values."""
    near = before[-_NEAR:]
    found = list(re.finditer(f"{_DECLARED}{name}", near)) or list(re.finditer(f"{_DECLARED}{name}", before))
    if not found:
        flat = before
        while (inner := _BRACKETS.sub(lambda match: " " * len(match.group()), flat)) != flat:
            flat = inner
        found = list(re.finditer(f"{_DECLARED}{name}", flat))
    return _TYPES[found[-1].group(1)] if found else 0


def _split(text: str, at: str = "+-*/") -> list[str]:
    """Return the parts of an expression between its outer operators, or its commas."""
    found, depth, start = list[str](), 0, 0
    for place, letter in enumerate(text):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(letter, 0)
        is_exponent = letter in "+-" and re.search(r"[\d.][eE]$", text[:place])
        if depth == 0 and letter in at and text[start:place].strip() and not is_exponent:
            found.append(text[start:place])
            start = place + 1
    return [*found, text[start:]]


def _opening(text: str) -> int:
    """Return where the bracket opens that a text ends with; -1 where none does."""
    depth = 0
    for place in range(len(text) - 1, -1, -1):
        depth += {")": 1, "(": -1}.get(text[place], 0)
        if depth == 0:
            return place
    return -1
