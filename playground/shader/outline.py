"""Outline a GLSL file: its top-level declarations with their comments, and the arguments of calls.

Read from the text alone, one file at a time, so that a text that does not compile has an outline too:
what is after a bracket that was never closed belongs to its block.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from playground.memo import TEXTS

WORD = re.compile(r"[A-Za-z_]\w*", re.ASCII)
# A number takes its suffix and its exponent, so that their letters are no names.
_NAME_OR_NUMBER = re.compile(r"([A-Za-z_]\w*)|0[xX]\w*|\.?\d(?:[eE][-+]|[\w.])*", re.ASCII)
# Of a pragma, // in quotes is no comment; one of // goes on behind a backslash at the line's end.
_MARK = re.compile(r'"(?:[^"\\\n]|\\.)*"?|//(?:[^\n\\]|\\.)*|/\*.*?(?:\*/|\Z)', re.DOTALL)
_QUALIFIERS = r"(?:(?:const|flat|highp|mediump|lowp|in|out|uniform|shared)\s+)*"
_FUNCTION = re.compile(rf"{_QUALIFIERS}([A-Za-z_]\w*)\s+([A-Za-z_]\w*)\s*\(([^)]*)\)\s*$", re.DOTALL)
_VARIABLE = re.compile(
    rf"({_QUALIFIERS})([A-Za-z_]\w*)\s+([A-Za-z_]\w*)\s*(\[[^\]]*\]\s*)?(?:=.*)?$", re.DOTALL
)
_STRUCT = re.compile(r"struct\s+([A-Za-z_]\w*)\s*$")
_DEFINE = re.compile(r"[ \t]*#[ \t]*define[ \t]+([A-Za-z_]\w*)(\([^)\n]*\))?[^\n]*")
_DIRECTIVE = re.compile(r"[ \t]*#(?:[^\n\\]|\\\n|\\[^\n])*")  # and the lines that it goes on to
_LOCAL = re.compile(
    r"(?<![\w.])([A-Za-z_]\w*)(?:(?:\s*\[[^\]]*\])+\s*|\s+)([A-Za-z_]\w*)(?=\s*(?:[;,=)[{]|$))", re.ASCII
)
_NOT_TYPES = frozenset("return else do in out inout const flat highp mediump lowp goto case".split())
_NEXT_IN_LIST = re.compile(r",\s*([A-Za-z_]\w*)(?=\s*[][;,=])", re.ASCII)
_BEFORE_BRACKET = re.compile(r"([A-Za-z_]\w*)\s*\Z", re.ASCII)
_OWN_SCOPE = frozenset(("for", "while", "if", "switch"))
_CONTROL = re.compile(r"\s*(?:(for|while|if|switch)\s*\(|do\b)", re.ASCII)
_ELSE = re.compile(r"\s*else\b", re.ASCII)
_MACRO = re.compile(r"\s*#\s*define\s+([A-Za-z_]\w*)(\([^)]*\))?", re.ASCII)


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


@dataclass(frozen=True, slots=True)
class Local:
    """One name that a function declares, an argument or a variable of a block."""

    name: str
    at: int  # where it is declared
    seen: int  # from where on it stands for this one: behind its value
    end: int  # where its block ends


@dataclass(frozen=True, slots=True)
class Macro:
    """One ``#define``, the lines that it goes on to too."""

    name: str
    parameters: frozenset[str]
    start: int  # of the directive
    body: int  # where its body begins
    end: int


@TEXTS.cached()
def code_of(text: str) -> str:
    """Return a text as long as this one, with spaces in place of its comments."""
    return _MARK.sub(lambda match: match[0] if match[0][0] == '"' else _blank(match), text)


def _blank(match: re.Match[str]) -> str:
    return re.sub(r"[^\n]", " ", match[0])


def identifiers(text: str, start: int = 0, end: int | None = None) -> Iterator[tuple[str, int]]:
    """Yield each identifier of a text with its place: no letters of numbers, as in 1e-3, 2.0f and 0xFFu."""
    for match in _NAME_OR_NUMBER.finditer(text, start, len(text) if end is None else end):
        if match[1]:
            yield match[1], match.start()


def words(text: str) -> Iterator[tuple[str, int]]:
    """Yield each identifier of the code with its place, of macros too, but for macros' own parameters.

    Pragmas and includes are left out.
    """
    macros = list(macros_of(text))
    for word, at in identifiers(_without_strings(text)):
        while macros and macros[0].end <= at:
            macros.pop(0)
        if not (macros and macros[0].start <= at and word in macros[0].parameters):
            yield word, at


@TEXTS.cached()
def _without_strings(text: str) -> str:
    """Return a text with spaces in place of comments, includes and pragmas."""
    return _DIRECTIVE.sub(
        lambda match: _blank(match) if re.match(r"\s*#\s*(?:include|pragma)\b", match[0]) else match[0],
        code_of(text),
    )


@TEXTS.cached()
def _without_directives(text: str) -> str:
    """Return a text with spaces in place of comments and directives."""
    return _DIRECTIVE.sub(_blank, code_of(text))


@TEXTS.cached()
def macros_of(text: str) -> tuple[Macro, ...]:
    """Return the macros of a text, in its order."""
    macros = []
    for directive in _DIRECTIVE.finditer(code_of(text)):
        if match := _MACRO.match(directive[0]):
            parameters = frozenset(word for word, _ in identifiers(match[2] or ""))
            start = directive.start()
            macros.append(Macro(match[1], parameters, start, start + match.end(), directive.end()))
    return tuple(macros)


@TEXTS.cached()
def locals_of(text: str, function: Declared) -> tuple[Local, ...]:
    """Return the names that a function declares, its own arguments too, in their order."""
    code = _without_directives(text)[: max(function.end, function.start)]
    locals_found: list[Local] = []
    for match in _LOCAL.finditer(code, function.start):
        if match[1] in _NOT_TYPES or match.start(2) <= function.at:
            continue
        end = _scope_end(code, match.start(2))
        name, at = match[2], match.start(2)
        while True:
            behind = _declarator_end(code, at + len(name))
            locals_found.append(Local(name, at, behind, end))
            following = _NEXT_IN_LIST.match(code, behind)
            if following is None:
                break
            name, at = following[1], following.start(1)
    return tuple(locals_found)


def has_branches(text: str, function: Declared) -> bool:
    """Return whether parts of a function exclude each other, by ``#else`` or ``#elif``."""
    inside = _DIRECTIVE.finditer(code_of(text), function.start, max(function.end, function.start))
    return any(re.match(r"\s*#\s*el", directive[0]) for directive in inside)


def local_at(candidates: Iterable[Local], name: str, at: int) -> Local | None:
    """Return the local that a name at a place stands for, or declares; None for a name of the top level."""
    there = [
        local
        for local in candidates
        if local.name == name and (local.at == at or local.seen <= at < local.end)
    ]
    return next(
        (local for local in there if local.at == at), max(there, key=lambda local: local.at, default=None)
    )


def _declarator_end(code: str, at: int) -> int:
    """Return where a declared name ends, with its brackets and its value."""
    depth = 0
    for match in re.compile(r"[][(){};,]").finditer(code, at):
        mark = match[0]
        if depth == 0 and mark in ";,)]}":
            return match.start()
        depth += (mark in "([{") - (mark in ")]}")
    return len(code)


def _scope_end(code: str, at: int) -> int:
    """Return where the block ends that a place is in: of a loop's head, behind the loop."""
    depth = 0
    for match in reversed(list(re.compile(r"[(){}]").finditer(code, 0, at))):
        depth += 1 if match[0] in ")}" else -1
        if depth < 0 and match[0] == "{":
            return _closing(code, match.start())
        if depth < 0:
            before = _BEFORE_BRACKET.search(code[: match.start()])
            if before is not None and before[1] in _OWN_SCOPE:
                return _statement_end(code, _closing(code, match.start()) + 1)
            return len(code)  # an argument
    return len(code)


def _closing(code: str, at: int) -> int:
    """Return where the bracket at a place is closed; the code's end where it is not."""
    depth = 0
    for match in re.compile(r"[(){}]").finditer(code, at):
        depth += 1 if match[0] in "({" else -1
        if depth == 0:
            return match.start()
    return len(code)


def _statement_end(code: str, at: int) -> int:
    """Return where the statement that begins at a place ends."""
    branches = 0
    while (control := _CONTROL.match(code, at)) is not None:
        branches += control[1] == "if"
        at = _closing(code, control.end() - 1) + 1 if control[1] else control.end()
    brace = re.compile(r"\s*\{").match(code, at)
    end = _closing(code, brace.end() - 1) if brace is not None else code.find(";", at)
    end = end + 1 if end >= 0 else len(code)
    following = _ELSE.match(code, end) if branches else None
    return end if following is None else _statement_end(code, following.end())


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
    code = _without_directives(text)
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
            block = _plain(text, code[start:at], start, at + 1)
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


def _plain(text: str, code: str, start: int, end: int) -> Declared | None:
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
