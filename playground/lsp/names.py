"""The identifiers of a GLSL text: words of its code, macros, and what its functions declare."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from playground.memo import TEXTS
from playground.shader.outline import DIRECTIVE, Declared, blank, code_of, without_directives

# A number takes its suffix and its exponent, so that their letters are no names.
_NAME_OR_NUMBER = re.compile(r"([A-Za-z_]\w*)|0[xX]\w*|\.?\d(?:[eE][-+]|[\w.])*", re.ASCII)
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
    return DIRECTIVE.sub(
        lambda match: blank(match) if re.match(r"\s*#\s*(?:include|pragma)\b", match[0]) else match[0],
        code_of(text),
    )


@TEXTS.cached()
def macros_of(text: str) -> tuple[Macro, ...]:
    """Return the macros of a text, in its order."""
    macros = []
    for directive in DIRECTIVE.finditer(code_of(text)):
        if match := _MACRO.match(directive[0]):
            parameters = frozenset(word for word, _ in identifiers(match[2] or ""))
            start = directive.start()
            macros.append(Macro(match[1], parameters, start, start + match.end(), directive.end()))
    return tuple(macros)


@TEXTS.cached()
def locals_of(text: str, function: Declared) -> tuple[Local, ...]:
    """Return the names that a function declares, its own arguments too, in their order."""
    code = without_directives(text)[: max(function.end, function.start)]
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
    inside = DIRECTIVE.finditer(code_of(text), function.start, max(function.end, function.start))
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
