"""Outline a GLSL file: its top-level declarations with their comments.

Read from the text alone, one file at a time, so that a text that does not compile has an outline too:
what is after a bracket that was never closed belongs to its block.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from playground.memo import TEXTS

WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
# Of a pragma, // in quotes is no comment; one of // goes on behind a backslash at the line's end.
_MARK = re.compile(r'"(?:[^"\\\n]|\\.)*"?|//(?:[^\n\\]|\\.)*|/\*.*?(?:\*/|\Z)', re.DOTALL)
_QUALIFIERS = r"(?:(?:const|flat|highp|mediump|lowp|in|out|uniform|shared)\s+)*"
_FUNCTION = re.compile(rf"{_QUALIFIERS}([A-Za-z_]\w*)\s+([A-Za-z_]\w*)\s*\(([^)]*)\)\s*$", re.DOTALL)
_VARIABLE = re.compile(
    rf"({_QUALIFIERS})([A-Za-z_]\w*)\s+([A-Za-z_]\w*)\s*(\[[^\]]*\]\s*)?(?:=.*)?$", re.DOTALL
)
_STRUCT = re.compile(r"struct\s+([A-Za-z_]\w*)\s*$")
_DEFINE = re.compile(r"[ \t]*#[ \t]*define[ \t]+([A-Za-z_]\w*)(\([^)\n]*\))?[^\n]*")
DIRECTIVE = re.compile(r"[ \t]*#(?:[^\n\\]|\\\n|\\[^\n])*")  # and the lines that it goes on to


@dataclass(frozen=True, slots=True)
class Declared:
    """One name that a file declares at its top level."""

    name: str
    kind: str  # function | struct | variable | uniform | macro
    signature: str  # as written, on one line: "float random(ivec2 point, uint seed)"
    comment: str  # the lines of // above it, without their marks; "" where there are none
    at: int  # where the name begins in the text
    start: int  # where the declaration begins, without its comment
    end: int  # behind it: of a function, its body
    body: int = -1  # where a function's body begins; -1: there is none, as of a prototype

    @property
    def is_prototype(self) -> bool:
        """Whether it is a function that the file asks of whoever includes it."""
        return self.kind == "function" and self.body < 0


@TEXTS.cached()
def outline(text: str) -> tuple[Declared, ...]:
    """Return what a text declares at its top level, in its order; lines end in LF."""
    return tuple(sorted((*_macros(text), *_statements(text)), key=lambda declaration: declaration.start))


@TEXTS.cached()
def code_of(text: str) -> str:
    """Return a text as long as this one, with spaces in place of its comments."""
    return _MARK.sub(lambda match: match[0] if match[0][0] == '"' else blank(match), text)


def blank(match: re.Match[str]) -> str:
    """Return spaces for a match, its line ends kept."""
    return re.sub(r"[^\n]", " ", match[0])


@TEXTS.cached()
def without_directives(text: str) -> str:
    """Return a text with spaces in place of comments and directives."""
    return DIRECTIVE.sub(blank, code_of(text))


def _macros(text: str) -> Iterator[Declared]:
    code = code_of(text)
    for match in _DEFINE.finditer(code):
        line = code.rfind("\n", 0, match.start()) + 1
        if not code[line : match.start()].strip() and not _is_guard(code, match):
            signature = f"#define {' '.join(code[match.start(1) : match.end()].split())}"
            comment = _comment_above(text, line)
            yield Declared(match[1], "macro", signature, comment, match.start(1), line, match.end())


def _is_guard(code: str, match: re.Match[str]) -> bool:
    """Return whether a macro is defined to mark the file as included."""
    guard = re.compile(rf"#\s*ifndef\s+{match[1]}\s*\n\s*\Z")
    return bool(guard.search(code[: match.start() + len(match[0]) - len(match[0].lstrip())]))


def _statements(text: str) -> Iterator[Declared]:
    code = without_directives(text)
    depth, start, body, head = 0, 0, -1, ""
    for match in re.finditer(r"[{};]", code):
        mark, at = match.group(), match.start()
        if mark == "{":
            if depth == 0:
                head, body = code[start:at], at
            depth += 1
        elif mark == "}" and depth:
            depth -= 1
            if depth == 0:
                block = _block(text, head, start, body, at + 1)
                if block is not None:
                    yield block
                    # What follows a struct's bracket is a variable or the semicolon alone.
                start = at + 1
        elif mark == ";" and depth == 0:
            block = _statement(text, code[start:at], start, at + 1)
            if block is not None:
                yield block
            start = at + 1
    if depth and (block := _block(text, head, start, body, len(code))) is not None:
        yield block


def _block(text: str, head: str, start: int, body: int, end: int) -> Declared | None:
    lead = len(head) - len(head.lstrip())
    start += lead
    head = head[lead:].rstrip()
    if match := _FUNCTION.match(head):
        signature, at = " ".join(head.split()), start + match.start(2)
        return Declared(match[2], "function", signature, _comment_above(text, start), at, start, end, body)
    if match := _STRUCT.match(head):
        signature = " ".join(code_of(text)[start:end].split())
        at = start + match.start(1)
        return Declared(match[1], "struct", signature, _comment_above(text, start), at, start, end, body)
    return None


def _statement(text: str, code: str, start: int, end: int) -> Declared | None:
    lead = len(code) - len(code.lstrip())
    start += lead
    code = code[lead:].rstrip()
    if match := _FUNCTION.match(code):
        signature, at = " ".join(code.split()), start + match.start(2)
        return Declared(match[2], "function", signature, _comment_above(text, start), at, start, end)
    if match := _VARIABLE.match(code):
        kind = "uniform" if "uniform" in match[1].split() else "variable"
        signature, at = " ".join(code.split()), start + match.start(3)
        return Declared(match[3], kind, signature, _comment_above(text, start), at, start, end)
    return None


def _comment_above(text: str, start: int) -> str:
    """Return the lines of ``//`` right above a place, without their marks, their line ends kept."""
    lines: list[str] = []
    end = text.rfind("\n", 0, start)
    while end >= 0:
        begins = text.rfind("\n", 0, end) + 1
        line = text[begins:end].strip()
        if not line.startswith("//") or line.startswith("//!"):
            break
        if not re.match(r"//\s*(?:anchor|end):", line):
            lines.append(line[2:].removeprefix(" "))
        end = begins - 1
    return "\n".join(reversed(lines)).strip()
