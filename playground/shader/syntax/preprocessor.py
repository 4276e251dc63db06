"""The preprocessor of GLSL: conditions judged, macros expanded, each token with its place.

A macro's tokens have the place of the whole call that they stand for, the outermost one, and know where the
macro's definition spells them. A macro that names itself stays, as C has it. ``#version`` defines
``__VERSION__`` and ``GL_ES``. What else the driver defines (``GL_…``) is not known here.
Numbers in conditions are GLSL 4.60's, section 3.3; an undefined name is 0.

A condition is judged with all of its branches. Where that cannot be, since what it asks for is unknown or it
is no expression, every branch is there; and of a text whose conditions do not close, every branch of all.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from playground.shader.syntax.tokens import Comment, Token, tokenize

_DIRECTIVE = re.compile(r"#\s*(\w*)\s*(.*)", re.DOTALL)
_DEFINE = re.compile(r"([A-Za-z_]\w*)(\(([^)]*)\))?(.*)", re.DOTALL)
_SKIPPED = re.compile(r"/\*.*?\*/|\\\r?\n", re.DOTALL)
_NAME = re.compile(r"[A-Za-z_]\w*")
_VERSION = re.compile(r"(\d+)(?:\s+(\w+))?")
_OF_THE_DRIVER = re.compile(r"(?:GL_(?!ES$)|__)\w*")
_CONDITIONS = frozenset({"if", "ifdef", "ifndef", "elif", "else", "endif"})
_ANY_VERSION = "330"  # of a text that states none
_MAX_EXPANDED_TOKENS = 200_000  # macros may double without end
_MAX_CONDITION_TOKENS = 4_096  # of macros in one condition
_MAX_NESTING = 32  # of a condition's brackets
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
    directives: list[Token] = field(default_factory=list)  # those in force, but for ``judged``
    judged: list[Token] = field(default_factory=list)  # those of conditions that were judged
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
    the tokens of every branch are there. ``unknown``: whether what only the driver knows is defined, as 1.
    """
    tokens, comments = tokenize(text)
    result = Preprocessed(comments=comments)
    if not defined and not any(token.kind == "directive" for token in tokens):
        result.tokens = tokens
    else:
        _Preprocessor(result, tokens, defined or {}, unknown, all_branches=all_branches).run()
    return result


def judge(
    directives: Sequence[Token],
    defined: Mapping[str, str],
    *,
    unsure: Collection[str] = (),
    unknown: bool | None = None,
) -> Preprocessed:
    """Judge the conditions among a text's directives; ``defined`` are macros as in ``preprocess``.

    Whether the driver's names, and those that are ``unsure``, are defined is ``unknown``; where that is None,
    what depends on them is not judged.
    """
    result = Preprocessed()
    _Preprocessor(result, directives, defined, unknown, unsure).run()
    return result


@dataclass(slots=True)
class _Group:
    """An open condition."""

    chosen: int | None  # index of the directive whose branch is there; -1: none is; None: every branch is
    around: bool  # the text around it is there


class _Preprocessor:
    def __init__(
        self,
        result: Preprocessed,
        tokens: Sequence[Token],
        defined: Mapping[str, str],
        unknown: bool | None,
        unsure: Collection[str] = (),
        *,
        all_branches: bool = False,
    ) -> None:
        self._result = result
        self._tokens = tokens
        self._index = 0
        self._pending: list[Token] = []  # of macros, the next one last
        self._left = _MAX_EXPANDED_TOKENS
        self._unknown = unknown
        self._unsure = set(unsure)  # among them names that a branch which may be left out defines
        branches = None if all_branches else _branches_of(tokens)
        self._branches: Mapping[int, list[int]] = branches or {}
        self._all_branches = branches is None
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
                self._spend(len(rest))  # which are read again, once for each call that stays open
                return False
            end, hidden = max(end, closing.end), hidden & closing.macros
            padded = [*given, *([] for _ in macro.parameters)]
            arguments = dict(zip(macro.parameters, padded, strict=False))
        if not token.macros:
            self._result.expansions.append(Expansion(macro.name, token.start, end))
        expanded = self._substituted(macro, arguments, token.start, end, hidden | {macro.name})
        if not self._spend(len(expanded)):
            return False
        self._pending += reversed(expanded)
        return True

    def _spend(self, count: int) -> bool:
        """Count tokens of macros; return whether there may be so many. Else no more macros are expanded."""
        self._left -= count
        if self._left < 0:
            self._result.is_truncated = True
            self._macros.clear()
        return self._left >= 0

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
        inner = _Preprocessor(Preprocessed(), tokens, {}, self._unknown)
        inner._macros, inner._left = self._macros, self._left
        inner.run()
        self._left = inner._left
        self._result.is_truncated |= inner._result.is_truncated
        return inner._result.tokens

    # ── directives ───────────────────────────────────────────────────────────

    def _obey(self, token: Token) -> None:
        match = _DIRECTIVE.match(token.text)
        word, rest = (match[1], match[2]) if match else ("", "")
        if word in _CONDITIONS and not self._all_branches:
            self._enter(token, word)
            return
        if not self._is_live:
            return
        self._result.directives.append(token)
        if word == "define" and (define := _DEFINE.match(rest)):
            assert match is not None
            self._define(token, define, token.start + match.start(2))
        elif word == "undef" and (name := _NAME.match(rest)):
            if self._is_uncertain:
                self._unsure.add(name[0])
            else:
                self._unsure.discard(name[0])
                self._macros.pop(name[0], None)
        elif word == "version" and (version := _VERSION.match(rest)):
            self._macros.setdefault("__VERSION__", _predefined("__VERSION__", version[1]))
            if version[2] == "es" or version[1] == "100":
                self._macros.setdefault("GL_ES", _predefined("GL_ES", "1"))

    @property
    def _is_uncertain(self) -> bool:
        """Return whether what is read may be left out."""
        return self._all_branches or any(group.chosen is None for group in self._groups)

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
        if self._is_uncertain:
            self._unsure.add(macro.name)
        else:
            self._unsure.discard(macro.name)

    def _enter(self, token: Token, word: str) -> None:
        """Go on to the branch of a condition that a directive begins, or behind the condition."""
        was_live = self._is_live
        if word.startswith("if"):
            chosen = self._choice(self._branches[self._index - 1]) if was_live else -1
            self._groups.append(_Group(chosen, was_live))
        group = self._groups[-1]
        if word == "endif":
            self._groups.pop()
            self._is_live = group.around
        else:
            self._is_live = group.around and group.chosen in (None, self._index - 1)
        if group.around:
            (self._result.directives if group.chosen is None else self._result.judged).append(token)
            if not was_live:
                self._result.inactive.append((self._inactive_since, token.start))
            if not self._is_live:
                self._inactive_since = token.end

    def _choice(self, branches: Sequence[int]) -> int | None:
        """Return the index of the directive whose branch is there: see ``_Group``."""
        for index in branches:
            match = _DIRECTIVE.match(self._tokens[index].text)
            assert match is not None
            holds = match[1] == "else" or self._holds(match[1], match[2])
            if holds is None:
                return None
            if holds:
                return index
        return -1

    def _holds(self, word: str, rest: str) -> bool | None:
        tokens = tokenize(_SKIPPED.sub(" ", rest))[0]
        if word not in ("ifdef", "ifndef"):
            number = _Condition(self._condition_tokens(tokens)).value()
            return None if number is None else bool(number)
        is_defined = self._is_defined(tokens[0].text) if tokens else None
        return None if is_defined is None else is_defined == (word == "ifdef")

    def _condition_tokens(self, tokens: list[Token]) -> list[str | None]:
        """Return a condition's tokens, macros expanded, ``defined`` answered; None: not known."""
        plain: list[Token] = []
        index = 0
        while index < len(tokens):
            token = tokens[index]
            if token.text == "defined":
                has_bracket = index + 1 < len(tokens) and tokens[index + 1].text == "("
                index += 1 + has_bracket
                is_defined = self._is_defined(tokens[index].text if index < len(tokens) else "")
                text, kind = ("", "word") if is_defined is None else (str(int(is_defined)), "number")
                plain.append(token._replace(text=text, kind=kind))
                index += has_bracket
            else:
                plain.append(token)
            index += 1
        inner = _Preprocessor(Preprocessed(), plain, {}, self._unknown)
        inner._macros = {name: macro for name, macro in self._macros.items() if name not in self._unsure}
        inner._left = _MAX_CONDITION_TOKENS
        inner.run()
        if inner._result.is_truncated:
            return []
        return [self._number(one.text) if one.kind == "word" else one.text for one in inner._result.tokens]

    def _number(self, word: str) -> str | None:
        """Return what a word that is no macro's call stands for; None where that cannot be known."""
        if not word or (word in self._macros and word not in self._unsure):  # it names itself
            return None
        is_defined = self._is_defined(word)
        if is_defined and word == "__VERSION__":
            return _ANY_VERSION
        return None if is_defined is None else str(int(is_defined))

    def _is_defined(self, name: str) -> bool | None:
        if name not in self._macros and _OF_THE_DRIVER.fullmatch(name):
            self._result.depends_on_driver = True
            return self._unknown
        return self._unknown if name in self._unsure else name in self._macros


def _branches_of(tokens: Sequence[Token]) -> dict[int, list[int]] | None:
    """Return the directives of each condition, by the index of its first; None where one does not close."""
    branches: dict[int, list[int]] = {}
    stack: list[list[int]] = []
    has_else: list[bool] = []
    for index, token in enumerate(tokens):
        match = _DIRECTIVE.match(token.text) if token.kind == "directive" else None
        word = match[1] if match else ""
        if word in ("if", "ifdef", "ifndef"):
            stack.append([index])
            has_else.append(False)
        elif word in _CONDITIONS:
            if not stack or (word != "endif" and has_else[-1]):
                return None
            if word == "endif":
                group = stack.pop()
                branches[group[0]] = group
                has_else.pop()
            else:
                stack[-1].append(index)
                has_else[-1] = word == "else"
    return None if stack else branches


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


def value_of(text: str) -> int | None:
    """Return the number that an expression without names is; None for what is none."""
    return _Condition([token.text for token in tokenize(text)[0]]).value()


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
