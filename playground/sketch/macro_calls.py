"""Join calls of function-like macros that span lines, for a driver that miscounts them.

Mesa's preprocessor (22.3) forgets the line ends inside such a call, so that every later error
names a line too early. A joined call is on its first line; the lines it took stay, empty.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

_DEFINE = re.compile(r"\s*#\s*define\s+(\w+)(\(|\s+(\w+)\s*$)?")
_DIRECTIVE = re.compile(r"\s*#")
_MOST_LINES = 1_000  # that one call may span: an unclosed one must not swallow the file


def with_calls_joined(codes: Sequence[str]) -> list[str]:
    """Return lines of code, comments blanked, with each macro call on one line; as many lines."""
    found = list(codes)
    if not any("define" in code for code in found):
        return found
    macros: set[str] = set()
    for index, code in enumerate(found):
        if "define" in code and (define := _DEFINE.match(code)):
            name, bracket, meaning = define.groups()
            if bracket == "(" or meaning in macros:
                macros.add(name)
        elif macros and not _DIRECTIVE.match(code):
            _join(found, index, macros)
    return found


def _join(codes: list[str], index: int, macros: set[str]) -> None:
    """Append to a line those that a macro call begun on it goes on to; leave it where the call never ends."""
    pattern = re.compile(rf"\b(?:{'|'.join(sorted(macros))})\b\s*(\(?)")
    joined, last = codes[index], index
    taken, end = joined, index  # as far as calls are whole
    while (opens := _is_open(joined, pattern)) != "no":
        last += 1
        if last >= len(codes) or last - index > _MOST_LINES or _DIRECTIVE.match(codes[last]):
            break
        code = codes[last].strip()
        if opens == "maybe" and code and not code.startswith("("):
            break
        joined = f"{joined} {code}" if code else joined
        if _is_open(joined, pattern) == "no":
            taken, end = joined, last
    codes[index : end + 1] = [taken, *[""] * (end - index)]


def _is_open(code: str, pattern: re.Pattern[str]) -> str:
    """Return whether a macro's call is open at a line's end: "no", "yes", "maybe" (the name ends it)."""
    position = 0
    while match := pattern.search(code, position):
        position = match.end()
        if not match.group(1):
            if position == len(code.rstrip()) or not code[position:].strip():
                return "maybe"
            continue
        depth = 1
        for at in range(position, len(code)):
            depth += {"(": 1, ")": -1}.get(code[at], 0)
            if depth == 0:
                break
        if depth:
            return "yes"
    return "no"
