"""Find which lines of a flattened text remain once each include guard has done its work."""

from __future__ import annotations

import re
from collections.abc import Sequence

_IFNDEF = re.compile(r"\s*#\s*ifndef\s+(\w+)\s*$")
_DEFINE = re.compile(r"\s*#\s*define\s+(\w+)\s*$")
_CONDITION = re.compile(r"\s*#\s*(if|ifdef|ifndef|else|elif|endif)\b")


def without_guards(lines: Sequence[str]) -> list[int]:
    """Return the indices of the lines that are neither a guard's nor there a second time.

    ``lines`` have no comments. A guard is ``#ifndef`` with a ``#define`` of its name in the next line.
    """
    found: list[int] = []
    guards: set[str] = set()
    stack: list[str] = []  # of each open condition: "guard", "twice" or "other"
    skip_define = ""
    for index, line in enumerate(lines):
        if skip_define and _DEFINE.match(line):
            skip_define = ""
            continue
        condition = _CONDITION.match(line)
        word = condition.group(1) if condition else ""
        guard = _IFNDEF.match(line)
        following = _DEFINE.match(lines[index + 1]) if index + 1 < len(lines) else None
        if word.startswith("if"):
            if guard and guard.group(1) in guards:
                stack.append("twice")
                continue
            if guard and following and following.group(1) == guard.group(1):
                stack.append("guard")
                guards.add(guard.group(1))
                skip_define = guard.group(1)
                continue
            stack.append("other")
        elif word == "endif" and stack:
            kind = stack.pop()
            if kind != "other":
                continue
        if "twice" not in stack:
            found.append(index)
    return found
