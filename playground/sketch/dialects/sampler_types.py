"""Tell from a text whether a channel that nothing declares is a picture or a cube map.

Shadertoy declares its channels by what a user puts there, which a file alone does not say. A lookup does: a
cube map, and a volume, is read at three coordinates. Types are followed by name, not by a compiler.
"""

from __future__ import annotations

import re
from collections import Counter

_LOOKUP = re.compile(r"\b(texture(?:Lod|Grad|Cube\w*)?)\s*\(\s*(iChannel\d)\s*,")
_TYPES = {
    "float": 1,
    "int": 1,
    "uint": 1,
    "bool": 1,
    **{f"{k}vec{n}": n for k in ("", "i", "u") for n in (2, 3, 4)},
}
_DECLARED = rf"\b({'|'.join(_TYPES)})\s+(?:[A-Za-z_]\w*\s*(?:=[^;,(){{}}]*)?,\s*)*"
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


def cubes_of(code: str) -> frozenset[str]:
    """Return the channels that a text reads at three coordinates and at no two."""
    threes, others = Counter[str](), set[str]()
    for match in _LOOKUP.finditer(code):
        name = match.group(2)
        if name in others or threes[name] >= _MOST_LOOKUPS:
            continue
        width = 3 if "Cube" in match.group(1) else _width(_argument(code, match.end()), code[: match.start()])
        if width == 3:
            threes[name] += 1
        else:
            others.add(name)
    return frozenset(threes.keys() - others)


def _argument(code: str, start: int) -> str:
    """Return an argument's text: up to its comma or the call's bracket."""
    depth = 0
    for place in range(start, min(len(code), start + 400)):
        depth += {"(": 1, "[": 1, ")": -1, "]": -1}.get(code[place], 0)
        if depth < 0 or (depth == 0 and code[place] == ","):
            return code[start:place]
    return ""


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
