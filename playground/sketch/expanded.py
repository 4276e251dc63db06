"""Tokenise a GLSL text behind its preprocessor: macros expanded, branches that are off left out.

Each token knows its place in the text; one of a macro has the place of the whole call, the outermost one.
A macro that names itself, as ``#define iTime (iTime * 0.5)``, stays: its name is one of what it stands for.
A text whose conditions depend on the driver has two readings: see ``readings``.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from playground.sketch.dialects.conditions import Conditions

_TOKEN = re.compile(
    r"//.*|/\*.*?\*/|[A-Za-z_]\w*|\.?\d(?:[eE][+-]|[\w.])*|<<=|>>=|##|\+\+|--|<<|>>|[<>=!+\-*/%&|^]=|&&|\|\||\^\^"
    r"|[^\s\w]"
)
_DIRECTIVE = re.compile(r"\s*#")
_DEFINE = re.compile(r"\s*#\s*(define|undef)\s+([A-Za-z_]\w*)(\(([^)]*)\))?(.*)")
_MAX_TOKENS = 200_000  # behind the preprocessor: macros may double without end
_NO_NAMES: frozenset[str] = frozenset()


class TooLongError(Exception):
    """The macros of a text expand to more than anybody compiles."""


@dataclass(slots=True)
class Call:
    """The outermost call of a macro, or its name alone."""

    line: int  # from 0
    start: int  # column of its first letter, from 0
    end: int  # column behind its last
    is_whole: bool = True  # it is on one line


class Token(NamedTuple):
    """One token; its columns are those of its call where it comes from a macro."""

    text: str
    line: int  # from 0
    start: int
    end: int
    call: Call | None = None
    hidden: frozenset[str] = _NO_NAMES  # macros that it is not expanded by again


@dataclass(frozen=True, slots=True)
class _Macro:
    parameters: tuple[str, ...] | None  # None: it takes no brackets
    body: tuple[str, ...]


@lru_cache(maxsize=4)  # tokens are many
def readings(code: str, version: int = 0) -> tuple[tuple[Token, ...], ...]:
    """Return the tokens of a text whose comments are blanked, once or for two readings.

    What the driver defines (``GL_…``) is not known here: there is a reading without, and one with all of it
    where that makes a difference. ``version`` is the text's, 0 where ``__VERSION__`` is unknown too. Empty
    where its macros expand to too much.
    """
    lines = code.split("\n")
    conditions = Conditions([line.partition("//")[0] for line in lines])
    defined = {"__VERSION__": str(version)} if version else {}
    live = dict.fromkeys(conditions.live(defined, unknown=unknown) for unknown in (False, True))
    try:
        return tuple(tuple(_Reader(one).tokens()) for one in live)
    except TooLongError:
        return ()


class _Reader:
    """Reads one text, from above."""

    def __init__(self, lines: Sequence[str]) -> None:
        self.lines = lines
        self.macros: dict[str, _Macro] = {}
        self.pending: list[Token] = []  # the next one last
        self.next_line = 0
        self.left = _MAX_TOKENS

    def tokens(self) -> Iterator[Token]:
        while (token := self._next()) is not None:
            if not self._expand(token):
                yield token

    def _next(self) -> Token | None:
        """Return the next token, from the lines where none is pending."""
        while not self.pending:
            if self.next_line >= len(self.lines):
                return None
            number, line = self.next_line, self.lines[self.next_line]
            self.next_line += 1
            if _DIRECTIVE.match(line):
                self._define(line)
                continue
            self.pending = [
                Token(m.group(), number, m.start(), m.end())
                for m in _TOKEN.finditer(line)
                if not m.group().startswith(("//", "/*"))
            ]
            self.pending.reverse()
        self.left -= 1
        if self.left < 0:
            raise TooLongError
        return self.pending.pop()

    def _define(self, line: str) -> None:
        match = _DEFINE.match(line)
        if match is None:
            return
        word, name, brackets, parameters, rest = match.groups()
        self.macros.pop(name, None)
        if word == "undef":
            return
        names = tuple(p.strip() for p in parameters.split(",") if p.strip()) if brackets else None
        body = [text for text in _TOKEN.findall(rest) if not text.startswith(("//", "/*"))]
        if name not in body:
            self.macros[name] = _Macro(names, tuple(body))

    def _expand(self, token: Token) -> bool:
        """Replace a token that calls a macro by what the macro stands for; return whether it does."""
        macro = self.macros.get(token.text)
        if macro is None or token.text in token.hidden:
            return False
        call = token.call or Call(token.line, token.start, token.end)
        hidden = token.hidden | {token.text}
        given: Mapping[str, list[Token]] = {}
        if macro.parameters is not None:
            following = self._next()
            if following is None or following.text != "(":
                if following is not None:
                    self.pending.append(following)
                return False
            arguments, closing = self._arguments()
            if closing is None:
                self.pending += reversed([following, *(t for one in arguments for t in one)])
                return False
            hidden = (token.hidden & closing.hidden) | {token.text}
            if closing.call is None:
                call.end = closing.end
            call.is_whole &= closing.line == call.line and closing.call in (None, call)
            given = dict(zip(macro.parameters, [*arguments, *[[] for _ in macro.parameters]], strict=False))
        self.pending += reversed(list(self._substituted(macro, given, call, hidden)))
        return True

    def _arguments(self) -> tuple[list[list[Token]], Token | None]:
        """Take the arguments of a call behind its bracket; return them and the closing bracket."""
        found: list[list[Token]] = [[]]
        depth = 0
        while (token := self._next()) is not None:
            if token.text == ")" and depth == 0:
                return found, token
            depth += (token.text == "(") - (token.text == ")")
            if token.text == "," and depth == 0:
                found.append([])
            else:
                found[-1].append(token)
        return found, None

    def _substituted(
        self, macro: _Macro, given: Mapping[str, list[Token]], call: Call, hidden: frozenset[str]
    ) -> Iterator[Token]:
        """Yield the tokens of a macro's body with its arguments in place, pasted where ``##`` says so."""

        def own(text: str, before: frozenset[str] = _NO_NAMES) -> Token:
            return Token(text, call.line, call.start, call.end, call, hidden | before)

        found: list[Token] = []
        pastes = False
        for index, text in enumerate(macro.body):
            if text == "##":
                pastes = bool(found)
                continue
            if text in given:
                is_pasted = pastes or macro.body[index + 1 : index + 2] == ("##",)
                some = given[text] if is_pasted else self._expanded(given[text])
                new = [own(t.text, t.hidden) for t in some]
            else:
                new = [own(text)]
            if pastes and new:
                new[0] = own(found.pop().text + new[0].text)
            pastes = False
            found += new
        yield from found

    def _expanded(self, tokens: Sequence[Token]) -> list[Token]:
        """Return an argument with the macros in it expanded."""
        if not any(token.text in self.macros for token in tokens):
            return list(tokens)
        inner = _Reader(())
        inner.macros, inner.pending, inner.left = self.macros, list(reversed(tokens)), self.left
        found = list(inner.tokens())
        self.left = inner.left
        return found
