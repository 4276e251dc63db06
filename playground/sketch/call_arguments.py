"""Read the arguments of functions and of calls from a GLSL text without comments."""

from __future__ import annotations

import re

DIRECTIVE = re.compile(r"^[ \t]*#(?:[^\n\\]|\\\n|\\[^\n])*", re.MULTILINE)  # and the lines that it goes on to

_NAME = re.compile(r"[A-Za-z_]\w*")
_CALLED = re.compile(r"([A-Za-z_]\w*)\s*\Z")
_BRACKETS = re.compile(r"[()\[\],]")
_OPENS = re.compile(r"\s*\(")


def without_directives(code: str) -> str:
    """Return a text as long as this one, with spaces in place of its directives."""
    return DIRECTIVE.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), code)


def arguments_of(signature: str) -> list[str]:
    """Return the names of a function's arguments; "" for one without."""
    inside = signature[signature.index("(") + 1 : signature.rindex(")")]
    return [(_NAME.findall(part) or [""])[-1] for part in inside.split(",")]


def given_to(code: str, at: int) -> list[str]:
    """Return the arguments of the call whose bracket opens at a place, or behind white space there."""
    opens = _OPENS.match(code, at)
    if opens is None:
        return []
    found, depth, start = [], 1, opens.end()
    for mark in _BRACKETS.finditer(code, opens.end()):
        if mark.group() in "([":
            depth += 1
        elif mark.group() in ")]":
            depth -= 1
        if depth == 0 or (depth == 1 and mark.group() == ","):
            found.append(code[start : mark.start()].strip())
            start = mark.end()
        if depth == 0:
            return found
    return []


def call_around(code: str, at: int) -> tuple[str, int, int] | None:
    """Return of the call that has an argument at a place its name, which argument it is, and its bracket.

    None where no bracket of a call is open there.
    """
    depth, index, opens = 0, 0, at - 1
    while opens >= 0 and not (depth == 0 and code[opens] in "(;{"):
        mark = code[opens]
        depth += (mark in ")]") - (mark in "([")
        index += mark == "," and depth == 0
        opens -= 1
    called = _CALLED.search(code, max(opens - 80, 0), max(opens, 0))
    return (called[1], index, opens) if called and opens >= 0 and code[opens] == "(" else None
