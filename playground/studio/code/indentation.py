"""Indent a text as its own lines do: what one step is, a new line, a closing bracket."""

from __future__ import annotations

import re
from collections import Counter

DEFAULT_STEP = " " * 4
_PAIRS = {"}": "{", "]": "[", ")": "("}
_COMMENT = re.compile(r"//[^\n]*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_BLANK = re.compile(r"[ \t]*")


def step_of(text: str) -> str:
    """Return one step of indentation: that of most lines after an open brace, else of most lines."""
    lines = [line for line in _COMMENT.sub(" ", text).split("\n") if line.strip()]
    indents = [_indent(line) for line in lines]
    if sum(indent.startswith("\t") for indent in indents) * 2 > sum(map(bool, indents)):
        return "\t"
    blocks, all_steps = Counter[int](), Counter[int]()
    for number in range(1, len(lines)):
        step = len(indents[number]) - len(indents[number - 1])
        if step > 1:  # one space aligns, it does not indent
            all_steps[step] += 1
            if lines[number - 1].rstrip().endswith("{"):
                blocks[step] += 1
    common = (blocks or all_steps).most_common(1)
    return " " * common[0][0] if common else DEFAULT_STEP


def new_line(before: str, after: str, step: str) -> tuple[str, str]:
    """Return what the Enter key inserts around the cursor: before it, and after it.

    ``before`` and ``after`` are the line to the left and to the right of the cursor.
    """
    indent = _indent(before)
    code = _COMMENT.sub(" ", before).rstrip()
    if not code.endswith(tuple(_PAIRS.values())):
        return f"\n{indent}", ""
    closes = _PAIRS.get(after.strip()[:1]) == code[-1]
    return f"\n{indent}{step}", f"\n{indent}" if closes else ""


def closing_indent(before: str, bracket: str) -> str | None:
    """Return the indentation of a closing bracket that begins a line: that of the line which opens it.

    ``before`` is the text up to the cursor. None where the bracket begins no line, or closes nothing.
    """
    code = _COMMENT.sub(lambda comment: re.sub(r"[^\n]", " ", comment[0]), before)
    line = before.rpartition("\n")[2]
    if bracket not in _PAIRS or line.strip():
        return None
    depth = 0
    for at in range(len(code) - 1, -1, -1):
        depth += (code[at] == bracket) - (code[at] == _PAIRS[bracket])
        if depth < 0:
            return _indent(before[before.rfind("\n", 0, at) + 1 :])
    return None


def _indent(line: str) -> str:
    match = _BLANK.match(line)
    return match[0] if match else ""
