"""The preprocessor of GLSL: conditions judged, macros expanded, each token with its place.

A macro's tokens have the place of the whole call that they stand for, the outermost one, and know where the
macro's definition spells them. A macro that names itself stays, as C has it. ``#version`` defines
``__VERSION__`` and ``GL_ES``. What else the driver defines (``GL_…``) is not known here.
Numbers in conditions are GLSL 4.60's, section 3.3; an undefined name is 0.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from playground.shader.syntax.tokens import Comment, Token, tokenize

_DIRECTIVE = re.compile(r"#\s*(\w*)\s*(.*)", re.DOTALL)
_DEFINE = re.compile(r"([A-Za-z_]\w*)(\(([^)]*)\))?(.*)", re.DOTALL)
_SKIPPED = re.compile(r"/\*.*?\*/|\\\r?\n", re.DOTALL)
_VERSION = re.compile(r"(\d+)(?:\s+(\w+))?")
_OF_THE_DRIVER = re.compile(r"(?:GL_(?!ES$)|__)\w*")
_CONDITIONS = frozenset({"if", "ifdef", "ifndef", "elif", "else", "endif"})
_MAX_EXPANDED_TOKENS = 200_000  # macros may double without end
_MAX_NESTING = 64
_MAX_SHIFT = 62


@dataclass(frozen=True, slots=True)
class Macro:
    """What a ``#define`` says; places are -1 of one that the text does not define."""

    name: str
    parameters: tuple[str, ...] | None  # None: it takes no brackets
    body: tuple[Token, ...]
    at: int = -1  # where its name is
    start: int = -1
    end: int = -1


@dataclass(frozen=True, slots=True)
class Expansion:
    """The outermost call of a macro, and where it stands."""

    name: str
    start: int
    end: int


@dataclass(slots=True)
class Preprocessed:
    """A text behind the preprocessor."""

    tokens: list[Token] = field(default_factory=list)
    comments: list[Comment] = field(default_factory=list)
    directives: list[Token] = field(
        default_factory=list
    )  # those in force, conditions that were judged excepted
    macros: list[Macro] = field(default_factory=list)  # each definition in force
    inactive: list[tuple[int, int]] = field(default_factory=list)  # spans that conditions leave out
    expansions: list[Expansion] = field(default_factory=list)
    depends_on_driver: bool = False  # a condition asks for what the driver defines
    is_truncated: bool = False  # macros expand to more than anybody compiles: the rest stays as written


def preprocess(
    text: str, defined: Mapping[str, str] | None = None, *, all_branches: bool = False, unknown: bool = False
) -> Preprocessed:
    """Return the tokens of a text behind the preprocessor; it never raises.

    ``defined``: the text of macros that are defined before it. ``all_branches``: no condition is judged, and
    the tokens of every branch are there. ``unknown``: whether what only the driver knows is defined.
    """
    tokens, comments = tokenize(text)
    result = Preprocessed(comments=comments)
    if not defined and not any(token.kind == "directive" for token in tokens):
        result.tokens = tokens
    else:
        _Preprocessor(result, tokens, defined or {}, all_branches, unknown).run()
    return result


@dataclass(slots=True)
class _Group:
    """An open condition."""

    is_live: bool  # its present branch
    was_live: bool  # any of its branches so far
    around: bool  # the text around it


class _Preprocessor:
    def __init__(
        self,
        result: Preprocessed,
        tokens: Sequence[Token],
        defined: Mapping[str, str],
        all_branches: bool,
        unknown: bool,
    ) -> None:
        self._result = result
        self._tokens = tokens
        self._index = 0
        self._pending: list[Token] = []  # of macros, the next one last
        self._left = _MAX_EXPANDED_TOKENS
        self._all_branches = all_branches
        self._unknown = unknown
        self._groups: list[_Group] = []
        self._is_live = True
        self._inactive_since = 0
        self._macros = {name: _predefined(name, meaning) for name, meaning in defined.items()}

    def run(self) -> None:
        add, macros = self._result.tokens.append, self._macros
        while (token := self._next()) is not None:
            if token.kind != "word" or token.text not in macros or not self._expand(token):
                add(token)
        if not self._is_live:
            self._result.inactive.append((self._inactive_since, self._tokens[-1].end))

    def _next(self) -> Token | None:
        """Return the next token that counts; directives on the way are obeyed."""
        if self._pending:
            return self._pending.pop()
        while self._index < len(self._tokens):
            token = self._tokens[self._index]
            self._index += 1
            if token.kind == "directive":
                self._obey(token)
            elif self._is_live:
                return token
        return None

    # ── macros ───────────────────────────────────────────────────────────────

    def _expand(self, token: Token) -> bool:
        """Put what a macro's call stands for in its place; return whether the token calls one."""
        macro = self._macros[token.text]
        if token.text in token.macros:
            return False
        end, hidden = token.end, token.macros
        arguments: dict[str, list[Token]] = {}
        if macro.parameters is not None:
            opening = self._next()
            if opening is None or opening.text != "(":
                if opening is not None:
                    self._pending.append(opening)
                return False
            given, closing = self._arguments()
            if closing is None:
                rest = [opening, *(one for argument in given for one in argument)]
                self._pending += reversed(rest)
                return False
            end, hidden = max(end, closing.end), hidden & closing.macros
            padded = [*given, *([] for _ in macro.parameters)]
            arguments = dict(zip(macro.parameters, padded, strict=False))
        if not token.macros:
            self._result.expansions.append(Expansion(macro.name, token.start, end))
        expanded = self._substituted(macro, arguments, token.start, end, hidden | {macro.name})
        self._left -= len(expanded)
        if self._left < 0:
            self._result.is_truncated = True
            self._macros.clear()
            return False
        self._pending += reversed(expanded)
        return True

    def _arguments(self) -> tuple[list[list[Token]], Token | None]:
        """Take a call's arguments behind its bracket; return them and the closing bracket."""
        arguments: list[list[Token]] = [[]]
        depth = 0
        while (token := self._next()) is not None:
            if token.text == ")" and depth == 0:
                return arguments, token
            depth += (token.text == "(") - (token.text == ")")
            if token.text == "," and depth == 0:
                arguments.append([])
                continue
            arguments[-1].append(token)
        return arguments, None

    def _substituted(
        self,
        macro: Macro,
        arguments: Mapping[str, list[Token]],
        start: int,
        end: int,
        macros: frozenset[str],
    ) -> list[Token]:
        """Return a macro's body with its arguments in place, pasted where ``##`` says so."""
        result: list[Token] = []
        is_pasting = False
        body = macro.body
        for index, token in enumerate(body):
            if token.text == "##":
                is_pasting = bool(result)
                continue
            if token.text in arguments:
                given = arguments[token.text]
                follows = index + 1 < len(body) and body[index + 1].text == "##"
                new = given if is_pasting or follows else self._expanded(given)
            else:
                new = [token]
            placed = [one._replace(start=start, end=end, macros=one.macros | macros) for one in new]
            if is_pasting and placed:
                text = result.pop().text + placed[0].text
                kind = (
                    "word"
                    if text[0].isalpha() or text[0] == "_"
                    else "number"
                    if text[0].isdigit()
                    else "mark"
                )
                placed[0] = placed[0]._replace(text=text, kind=kind)
            is_pasting = False
            result += placed
        return result

    def _expanded(self, tokens: list[Token]) -> list[Token]:
        """Return an argument with the macros in it expanded."""
        if not any(token.text in self._macros and token.text not in token.macros for token in tokens):
            return tokens
        inner = _Preprocessor(Preprocessed(), tokens, {}, False, self._unknown)
        inner._macros, inner._left = self._macros, self._left
        inner.run()
        self._left = inner._left
        self._result.is_truncated |= inner._result.is_truncated
        return inner._result.tokens

    # ── directives ───────────────────────────────────────────────────────────

    def _obey(self, token: Token) -> None:
        match = _DIRECTIVE.match(token.text)
        word, rest = (match[1], match[2]) if match else ("", "")
        if word in _CONDITIONS:
            if self._all_branches:
                self._result.directives.append(token)
            else:
                self._judge(token, word, rest)
            return
        if not self._is_live:
            return
        self._result.directives.append(token)
        if word == "define" and (define := _DEFINE.match(rest)):
            assert match is not None
            self._define(token, define, token.start + match.start(2))
        elif word == "undef" and rest.split() and not self._all_branches:
            self._macros.pop(rest.split()[0], None)
        elif word == "version" and (version := _VERSION.match(rest)):
            self._macros.setdefault("__VERSION__", _predefined("__VERSION__", version[1]))
            if version[2] == "es" or version[1] == "100":
                self._macros.setdefault("GL_ES", _predefined("GL_ES", "1"))

    def _define(self, token: Token, define: re.Match[str], at: int) -> None:
        offset = at + define.start(4)
        text = _SKIPPED.sub(lambda skipped: " " * len(skipped.group()), define[4])
        body = tuple(
            part._replace(start=part.start + offset, end=part.end + offset, spelled=part.start + offset)
            for part in tokenize(text)[0]
        )
        parameters = None
        if define[2] is not None:
            parameters = tuple(name.strip() for name in define[3].split(",") if name.strip())
        macro = Macro(define[1], parameters, body, at, token.start, token.end)
        self._macros[macro.name] = macro
        self._result.macros.append(macro)

    def _judge(self, token: Token, word: str, rest: str) -> None:
        was_live = self._is_live
        if word.startswith("if"):
            holds = was_live and self._holds(word, rest)
            self._groups.append(_Group(holds, holds, was_live))
        elif not self._groups:
            return
        elif word == "endif":
            self._is_live = self._groups.pop().around
        else:
            group = self._groups[-1]
            group.is_live = (
                group.around and not group.was_live and (word == "else" or self._holds("if", rest))
            )
            group.was_live |= group.is_live
        if word != "endif":
            self._is_live = self._groups[-1].is_live
        if was_live and not self._is_live:
            self._inactive_since = token.end
        elif self._is_live and not was_live:
            self._result.inactive.append((self._inactive_since, token.start))
        elif not was_live and word in ("elif", "else") and self._groups[-1].around:
            self._result.inactive.append((self._inactive_since, token.start))
            self._inactive_since = token.end

    def _holds(self, word: str, rest: str) -> bool:
        tokens = tokenize(_SKIPPED.sub(" ", rest))[0]
        if word == "if":
            return bool(_Condition(self._condition_tokens(tokens)).value())
        is_defined = bool(tokens) and bool(self._is_defined(tokens[0].text))
        return is_defined == (word == "ifdef")

    def _condition_tokens(self, tokens: list[Token]) -> list[str | None]:
        """Return a condition's tokens, macros expanded, ``defined`` answered; None: not known."""
        plain: list[Token] = []
        index = 0
        while index < len(tokens):
            token = tokens[index]
            if token.text == "defined":
                has_bracket = index + 1 < len(tokens) and tokens[index + 1].text == "("
                index += 1 + has_bracket
                name = tokens[index].text if index < len(tokens) else ""
                plain.append(token._replace(text=str(int(self._is_defined(name))), kind="number"))
                index += has_bracket
            else:
                plain.append(token)
            index += 1
        expanded = self._expanded(plain)
        return [self._number(token) if token.kind == "word" else token.text for token in expanded]

    def _number(self, token: Token) -> str | None:
        if token.text not in self._macros and self._is_defined(token.text):
            return None
        return "0"

    def _is_defined(self, name: str) -> bool:
        if name not in self._macros and _OF_THE_DRIVER.fullmatch(name):
            self._result.depends_on_driver = True
            return self._unknown
        return name in self._macros


def _predefined(name: str, meaning: str) -> Macro:
    return Macro(
        name, None, tuple(one._replace(start=-1, end=-1, spelled=-1) for one in tokenize(meaning)[0])
    )


# ── conditions ───────────────────────────────────────────────────────────────


def _quotient(left: int, right: int) -> int:
    """Return a quotient of whole numbers, towards 0."""
    return abs(left) // abs(right) * (1 if (left < 0) == (right < 0) else -1)


_LEVELS: tuple[Mapping[str, Callable[[int, int], int]], ...] = (
    {"||": lambda left, right: bool(left or right)},
    {"&&": lambda left, right: bool(left and right)},
    {"|": operator.or_},
    {"^": operator.xor},
    {"&": operator.and_},
    {"==": operator.eq, "!=": operator.ne},
    {"<": operator.lt, ">": operator.gt, "<=": operator.le, ">=": operator.ge},
    {"<<": operator.lshift, ">>": operator.rshift},
    {"+": operator.add, "-": operator.sub},
    {"*": operator.mul, "/": _quotient, "%": lambda left, right: left - _quotient(left, right) * right},
)
"""Operators of two numbers, those that bind least first."""


class _NoNumber(Exception):
    pass


class _Condition:
    """The expression of one ``#if``."""

    def __init__(self, tokens: Iterable[str | None]) -> None:
        self._tokens = list(tokens)
        self._at = 0

    def value(self) -> int | None:
        """Return the number; None where it cannot be known, or the expression is none."""
        try:
            value = self._level(0, 0)
        except _NoNumber:
            return None
        return value if self._at == len(self._tokens) else None

    def _level(self, level: int, depth: int) -> int | None:
        if level == len(_LEVELS):
            return self._single(depth)
        left = self._level(level + 1, depth)
        while self._at < len(self._tokens) and (sign := self._tokens[self._at]) in _LEVELS[level]:
            self._at += 1
            left = _combined(str(sign), level, left, self._level(level + 1, depth))
        return left

    def _single(self, depth: int) -> int | None:
        if depth > _MAX_NESTING or self._at >= len(self._tokens):
            raise _NoNumber
        token = self._tokens[self._at]
        self._at += 1
        if token is None:
            return None
        if token in ("!", "-", "+", "~"):
            number = self._single(depth + 1)
            if number is None:
                return None
            return {"!": int(not number), "-": -number, "+": number, "~": ~number}[token]
        if token == "(":
            number = self._level(0, depth + 1)
            if self._tokens[self._at : self._at + 1] != [")"]:
                raise _NoNumber
            self._at += 1
            return number
        digits = token.rstrip("uU")
        is_octal = len(digits) > 1 and digits.isdigit() and digits[0] == "0"
        try:
            return int(digits, 8) if is_octal else int(digits, 0)
        except ValueError:
            raise _NoNumber from None


def _combined(sign: str, level: int, left: int | None, right: int | None) -> int | None:
    """Return the number of an operator; of what cannot be known only where the other side decides."""
    if sign == "&&" and 0 in (left, right):
        return 0
    if sign == "||" and (left or right):
        return 1
    if left is None or right is None or (sign in ("/", "%") and not right):
        return None
    if sign in ("<<", ">>") and not 0 <= right <= _MAX_SHIFT:
        return None
    return int(_LEVELS[level][sign](left, right))
