"""Join calls of function-like macros that span lines, for a driver that miscounts them.

Mesa's preprocessor (22.3) forgets the line ends inside such a call, so that every later error
names a line too early. A joined call is on its first line; the lines it took stay, empty.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence

_DEFINE = re.compile(r"\s*#\s*define\s+(\w+)(\(|\s+(\w+)\s*$)?")
_DIRECTIVE = re.compile(r"\s*#")
_NAME = re.compile(r"\b([A-Za-z_]\w*)\s*(\(?)")
_BRACKET = re.compile(r"[()]")
_MOST_LINES = 1_000  # that one call may span: an unclosed one must not swallow the file


def with_calls_joined(codes: Sequence[str]) -> list[str]:
    """Return lines of code, comments blanked, with each macro call on one line; as many lines."""
    found = list(codes)
    if not any("define" in code for code in found):
        return found
    macros: set[str] = set()
    index = 0
    while index < len(found):
        code = found[index]
        if "define" in code and (define := _DEFINE.match(code)):
            name, bracket, meaning = define.groups()
            if bracket == "(" or meaning in macros:
                macros.add(name)
        elif macros and not _DIRECTIVE.match(code):
            index = _join(found, index, macros)
        index += 1
    return found


def _join(codes: list[str], index: int, macros: set[str]) -> int:
    """Append to a line those that a macro call begun on it goes on to; leave it where the call never ends.

    Return the last line that is done: of a call that never ends, the last that was looked at.
    """
    joined, last = codes[index], index
    taken, end = joined, index  # as far as calls are whole
    while (is_open := _is_open(joined, macros)) != "no":
        last += 1
        if last >= len(codes) or last - index > _MOST_LINES or _DIRECTIVE.match(codes[last]):
            break
        code = codes[last].strip()
        if is_open == "maybe" and code and not code.startswith("("):
            break
        joined = f"{joined} {code}" if code else joined
        if _is_open(joined, macros) == "no":
            taken, end = joined, last
    codes[index : end + 1] = [taken, *[""] * (end - index)]
    return last - 1 if is_open == "yes" else end


def _is_open(code: str, macros: Collection[str]) -> str:
    """Return whether a macro's call is open at a line's end: "no", "yes", "maybe" (the name ends it)."""
    position = 0
    while match := _NAME.search(code, position):
        position = match.end(1)
        if match[1] not in macros:
            continue
        if not match[2]:
            if match.end() == len(code):
                return "maybe"
            continue
        depth = 0
        for bracket in _BRACKET.finditer(code, match.start(2)):
            depth += 1 if bracket[0] == "(" else -1
            if depth == 0:
                position = bracket.start()
                break
        if depth:
            return "yes"
    return "no"
