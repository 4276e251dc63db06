"""The preprocessor of GLSL: conditions judged by what is defined, and tokens behind it, macros expanded.

Where every condition of a group can be judged, its directives and the branches that are left out become
blank; lines stay. What depends on the driver (``GL_…``, ``__VERSION__``) stays as it is, and so does a text
whose conditions do not close. Numbers are GLSL 4.60's, section 3.3; an undefined name is 0.

Each token knows its place in the text; one of a macro has the place of the whole call, the outermost one.
A macro that names itself, as ``#define iTime (iTime * 0.5)``, stays: its name is one of what it stands for.
A text whose conditions depend on the driver has two readings: see ``readings``.
"""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from playground.memo import TEXTS
from playground.shader.source import SourceText

_COMMENT = re.compile(r"//[^\n]*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_DIRECTIVE = re.compile(r"\s*#\s*(ifdef|ifndef|if|elif|else|endif|define|undef)\b\s*(.*)", re.DOTALL)
_DEFINE = re.compile(r"(\w+)(\()?(.*)", re.DOTALL)
_TOKEN = re.compile(
    r"\s*(0[xX][0-9a-fA-F]+|\d+|[A-Za-z_]\w*|<<|>>|<=|>=|==|!=|&&|\|\||[-+~!*/%<>&^|()])([uU]?)"
)
_OF_THE_DRIVER = re.compile(r"(?:GL_(?!ES$)|__)\w*")


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
_MAX_DEPTH = 32
_MAX_CONDITION_TOKENS = 4_096  # of one expression, its macros expanded: they may double without end
_MAX_SHIFT = 62


WEBGL = {
    "GL_ES": "1",
    "__VERSION__": "100",
    "GL_FRAGMENT_PRECISION_HIGH": "1",
    "GL_OES_standard_derivatives": "1",
    "GL_EXT_shader_texture_lod": "1",
    "GL_EXT_frag_depth": "1",
}
"""What WebGL 1 defines, with its extensions that every browser has."""

WEBGL_2 = {"GL_ES": "1", "__VERSION__": "300", "GL_FRAGMENT_PRECISION_HIGH": "1"}
"""What WebGL 2 defines."""

_OF_TOOLS = frozenset({"GL_ES", "SHADER_TOY", "GLSLVIEWER", "PASSINDEX", "HW_PERFORMANCE"})
"""What one tool defines and another does not."""


@dataclass
class _Branch:
    directive: int  # index of its line
    kind: str  # if | ifdef | ifndef | elif | else
    condition: str
    items: list[_Item] = field(default_factory=list)


@dataclass
class _Group:
    branches: list[_Branch]
    end: int = 0  # index of its #endif


_Item = int | _Group


class Conditions:
    """The lines of a text, comments blanked, and the conditions among them."""

    def __init__(self, codes: Sequence[str]) -> None:
        self.codes = tuple(codes)
        self._directives = {
            i: m for i, code in enumerate(codes) if "#" in code and (m := _DIRECTIVE.match(code))
        }
        self._items = self._parsed()
        texts = [m[2] for m in self._directives.values() if m[1] in ("if", "ifdef", "ifndef", "elif")]
        self.names = frozenset(name for text in texts for name in re.findall(r"[A-Za-z_]\w*", text))

    def live(
        self, defined: Mapping[str, str], *, unsure: Collection[str] = (), unknown: bool | None = None
    ) -> tuple[str, ...]:
        """Return the lines with what is left out blank, where these macros are defined before them.

        The conditions of those that are ``unsure`` stay. ``unknown``: whether what depends on the driver is
        defined; None: its conditions stay too.
        """
        if self._items is None:
            return self.codes
        return _ConditionEvaluator(self.codes, self._directives, defined, unsure, unknown).lines(self._items)

    def _parsed(self) -> list[_Item] | None:
        """Return lines and groups in order; None where conditions do not close, or nest too deeply."""
        items_found: list[_Item] = []
        open_groups: list[_Group] = []
        items = items_found
        for index in range(len(self.codes)):
            match = self._directives.get(index)
            kind = match[1] if match else ""
            if match and kind in ("if", "ifdef", "ifndef"):
                group = _Group([_Branch(index, kind, match[2])])
                items.append(group)
                open_groups.append(group)
                if len(open_groups) > _MAX_DEPTH:
                    return None
                items = group.branches[-1].items
            elif match and kind in ("elif", "else"):
                if not open_groups or open_groups[-1].branches[-1].kind == "else":
                    return None
                open_groups[-1].branches.append(_Branch(index, kind, match[2]))
                items = open_groups[-1].branches[-1].items
            elif kind == "endif":
                if not open_groups:
                    return None
                open_groups.pop().end = index
                items = open_groups[-1].branches[-1].items if open_groups else items_found
            else:
                items.append(index)
        return None if open_groups else items_found


def macros_of(lines: Iterable[str]) -> dict[str, str]:
    """Return the macros that some lines define, of those that take no arguments."""
    words = [line.split(maxsplit=2) for line in lines if line.startswith("#define")]
    return {name: " ".join(meaning) for _, name, *meaning in words}


def live_source(
    source: SourceText,
    defined: Mapping[str, str],
    *,
    unsure: Collection[str] = (),
    unknown: bool | None = False,
) -> SourceText:
    """Return a text without the branches that are off; see ``Conditions.live``."""
    conditions = Conditions([line.code for line in source.lines])
    return source.with_codes(conditions.live(defined, unsure=unsure, unknown=unknown))


def code_of(text: str) -> str:
    """Return a text without comments, its continued lines joined."""
    return _COMMENT.sub(" ", text).replace("\\\n", " ")


def live_code(text: str, defined: Mapping[str, str]) -> str:
    """Return the code of a text whose tool is not known yet, without the branches that are off.

    What one tool defines and another does not is unknown but for what is ``defined``.
    """
    unsure = _OF_TOOLS.difference(defined)
    return "\n".join(Conditions(code_of(text).split("\n")).live(defined, unsure=unsure))


class _ConditionEvaluator:
    """One judgement of a text."""

    def __init__(
        self,
        codes: Sequence[str],
        directives: Mapping[int, re.Match[str]],
        defined: Mapping[str, str],
        unsure: Collection[str] = (),
        unknown: bool | None = None,
    ) -> None:
        self.codes = list(codes)
        self.directives = directives
        self.unknown = unknown  # whether what depends on the driver is defined
        self.macros: dict[str, str | None] = dict(defined)  # None: a macro with arguments
        self.unsure = set(unsure)  # among them names that a branch which may be left out defines

    def lines(self, items: Sequence[_Item]) -> tuple[str, ...]:
        self._walk(items, certain=True)
        return tuple(self.codes)

    def _walk(self, items: Sequence[_Item], *, certain: bool) -> None:
        for item in items:
            if isinstance(item, int):
                if match := self.directives.get(item):
                    self._define(match, certain=certain)
                continue
            chosen, is_certain = self._choice(item)
            if not is_certain:
                for branch in item.branches:
                    self._walk(branch.items, certain=False)
                continue
            for branch in item.branches:
                self.codes[branch.directive] = ""
                if branch is not chosen:
                    self._blank(branch.items)
            self.codes[item.end] = ""
            if chosen is not None:
                self._walk(chosen.items, certain=certain)

    def _choice(self, group: _Group) -> tuple[_Branch | None, bool]:
        """Return the branch that stays, and whether that can be known."""
        for branch in group.branches:
            is_true = self._holds(branch)
            if is_true is None:
                return None, False
            if is_true:
                return branch, True
        return None, True

    def _holds(self, branch: _Branch) -> bool | None:
        if branch.kind == "else":
            return True
        if branch.kind in ("ifdef", "ifndef"):
            name = re.match(r"\w+", branch.condition)
            is_defined = self._is_defined(name[0]) if name else None
            return is_defined if is_defined is None or branch.kind == "ifdef" else not is_defined
        number = _Expression(self, branch.condition).value()
        return None if number is None else bool(number)

    def _is_defined(self, name: str) -> bool | None:
        if name in self.unsure or (_OF_THE_DRIVER.fullmatch(name) and name not in self.macros):
            return self.unknown
        return name in self.macros

    def meaning(self, name: str) -> str | None:
        """Return the text that a name stands for in an expression; None where that cannot be known."""
        if not self._is_defined(name):
            return None if self._is_defined(name) is None else "0"
        return self.macros.get(name, "1")

    def is_defined(self, name: str) -> int | None:
        """Return 1 or 0, None where it cannot be known."""
        is_macro = self._is_defined(name)
        return None if is_macro is None else int(is_macro)

    def _define(self, match: re.Match[str], *, certain: bool) -> None:
        result = _DEFINE.match(match[2]) if match[1] in ("define", "undef") else None
        if result is None:
            return
        if not certain:
            self.unsure.add(result[1])
        elif match[1] == "define":
            self.macros[result[1]] = None if result[2] else result[3].strip()
            self.unsure.discard(result[1])
        else:
            self.macros.pop(result[1], None)
            self.unsure.discard(result[1])

    def _blank(self, items: Sequence[_Item]) -> None:
        for item in items:
            if isinstance(item, int):
                self.codes[item] = ""
                continue
            for branch in item.branches:
                self.codes[branch.directive] = ""
                self._blank(branch.items)
            self.codes[item.end] = ""


class _Wrong(Exception):
    """An expression is none, nests too deeply or is too long."""


class _Expression:
    """The expression of one ``#if``."""

    def __init__(self, judge: _ConditionEvaluator, text: str) -> None:
        self.judge = judge
        self.tokens: list[str | None] = []  # None: what cannot be known
        self.left = _MAX_CONDITION_TOKENS
        try:
            self.tokens = [*self._expanded(text, frozenset())]
            self.is_wrong = False
        except _Wrong:
            self.is_wrong = True
        self.at = 0

    def value(self) -> int | None:
        """Return the number; None where it cannot be known."""
        if self.is_wrong or not self.tokens:
            return None
        try:
            value = self._level(0)
        except _Wrong:
            return None
        return value if self.at == len(self.tokens) else None

    def _expanded(self, text: str, inside: frozenset[str]) -> Iterator[str | None]:
        """Yield the tokens of a text with its macros replaced, ``defined`` answered."""
        if len(inside) > _MAX_DEPTH:
            raise _Wrong
        tokens = _tokens(text)
        index = 0
        while index < len(tokens):
            token = tokens[index]
            index += 1
            self.left -= 1
            if self.left < 0:
                raise _Wrong
            if token == "defined":
                names = (
                    tokens[index : index + 3]
                    if tokens[index : index + 1] == ["("]
                    else tokens[index : index + 1]
                )
                index += len(names)
                name = names[len(names) // 2] if names else ""
                expanded = self.judge.is_defined(name)
                yield None if expanded is None else str(expanded)
            elif token[0].isalpha() or token[0] == "_":
                meaning = None if token in inside else self.judge.meaning(token)
                if meaning is None:
                    yield None
                else:
                    yield from self._expanded(meaning, inside | {token})
            else:
                yield token

    def _level(self, level: int, depth: int = 0) -> int | None:
        if depth > _MAX_DEPTH:
            raise _Wrong
        if level == len(_LEVELS):
            return self._single(depth + 1)
        left = self._level(level + 1, depth)
        while self.at < len(self.tokens) and (sign := self.tokens[self.at]) in _LEVELS[level]:
            self.at += 1
            left = _worked_out(str(sign), level, left, self._level(level + 1, depth))
        return left

    def _single(self, depth: int) -> int | None:
        if depth > _MAX_DEPTH or self.at >= len(self.tokens):
            raise _Wrong
        token = self.tokens[self.at]
        self.at += 1
        if token is None:
            return None
        if token in ("!", "-", "+", "~"):
            number = self._single(depth + 1)
            if number is None:
                return None
            return {"!": int(not number), "-": -number, "+": number, "~": ~number}[token]
        if token == "(":
            number = self._level(0, depth + 1)
            if self.at >= len(self.tokens) or self.tokens[self.at] != ")":
                raise _Wrong
            self.at += 1
            return number
        if not token[0].isdigit():
            raise _Wrong
        octal = len(token) > 1 and token[0] == "0" and token.isdigit()
        try:
            return int(token, 8) if octal else int(token, 0)
        except ValueError:
            raise _Wrong from None


def _tokens(text: str) -> list[str]:
    tokens, at = [], 0
    text = text.rstrip()
    while at < len(text):
        match = _TOKEN.match(text, at)
        if match is None:
            raise _Wrong
        tokens.append(match[1])
        at = match.end()
    return tokens


def _worked_out(sign: str, level: int, left: int | None, right: int | None) -> int | None:
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


def value_of(text: str) -> int | None:
    """Return the number that an expression without names is; None for what is none."""
    return _Expression(_ConditionEvaluator((), {}, {}), text).value()


_GLSL_TOKEN = re.compile(
    r"//.*|/\*.*?\*/|[A-Za-z_]\w*|\.?\d(?:[eE][+-]|[\w.])*|<<=|>>=|##|\+\+|--|<<|>>|[<>=!+\-*/%&|^]=|&&|\|\||\^\^"
    r"|[^\s\w]"
)
_ANY_DIRECTIVE = re.compile(r"\s*#")
_DEFINITION = re.compile(r"\s*#\s*(define|undef)\s+([A-Za-z_]\w*)(\(([^)]*)\))?(.*)")
_MAX_EXPANDED_TOKENS = 200_000  # behind the preprocessor: macros may double without end
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


@TEXTS.cached(weight=512)  # tokens are many
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
        return tuple(tuple(_Reader(item).tokens()) for item in live)
    except TooLongError:
        return ()


class _Reader:
    """Reads one text, from above."""

    def __init__(self, lines: Sequence[str]) -> None:
        self.lines = lines
        self.macros: dict[str, _Macro] = {}
        self.pending: list[Token] = []  # the next one last
        self.next_line = 0
        self.left = _MAX_EXPANDED_TOKENS

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
            if _ANY_DIRECTIVE.match(line):
                self._define(line)
                continue
            self.pending = [
                Token(m.group(), number, m.start(), m.end())
                for m in _GLSL_TOKEN.finditer(line)
                if not m.group().startswith(("//", "/*"))
            ]
            self.pending.reverse()
        self.left -= 1
        if self.left < 0:
            raise TooLongError
        return self.pending.pop()

    def _define(self, line: str) -> None:
        match = _DEFINITION.match(line)
        if match is None:
            return
        word, name, brackets, parameters, rest = match.groups()
        self.macros.pop(name, None)
        if word == "undef":
            return
        names = tuple(p.strip() for p in parameters.split(",") if p.strip()) if brackets else None
        body = [text for text in _GLSL_TOKEN.findall(rest) if not text.startswith(("//", "/*"))]
        if name not in body:
            self.macros[name] = _Macro(names, tuple(body))

    def _expand(self, token: Token) -> bool:
        """Replace a token that calls a macro by what the macro stands for; return whether it does."""
        macro = self.macros.get(token.text)
        if macro is None or token.text in token.hidden:
            return False
        call = token.call or Call(token.line, token.start, token.end)
        hidden = token.hidden | {token.text}
        tokens: Mapping[str, list[Token]] = {}
        if macro.parameters is not None:
            following = self._next()
            if following is None or following.text != "(":
                if following is not None:
                    self.pending.append(following)
                return False
            arguments, closing = self._arguments()
            if closing is None:
                self.pending += reversed([following, *(t for argument in arguments for t in argument)])
                return False
            hidden = (token.hidden & closing.hidden) | {token.text}
            if closing.call is None:
                call.end = closing.end
            call.is_whole &= closing.line == call.line and closing.call in (None, call)
            tokens = dict(zip(macro.parameters, [*arguments, *[[] for _ in macro.parameters]], strict=False))
        self.pending += reversed(list(self._substituted(macro, tokens, call, hidden)))
        return True

    def _arguments(self) -> tuple[list[list[Token]], Token | None]:
        """Take the arguments of a call behind its bracket; return them and the closing bracket."""
        tokens: list[list[Token]] = [[]]
        depth = 0
        while (token := self._next()) is not None:
            if token.text == ")" and depth == 0:
                return tokens, token
            depth += (token.text == "(") - (token.text == ")")
            if token.text == "," and depth == 0:
                tokens.append([])
            else:
                tokens[-1].append(token)
        return tokens, None

    def _substituted(
        self, macro: _Macro, arguments: Mapping[str, list[Token]], call: Call, hidden: frozenset[str]
    ) -> Iterator[Token]:
        """Yield the tokens of a macro's body with its arguments in place, pasted where ``##`` says so."""

        def own(text: str, before: frozenset[str] = _NO_NAMES) -> Token:
            return Token(text, call.line, call.start, call.end, call, hidden | before)

        result_tokens: list[Token] = []
        pastes = False
        for index, text in enumerate(macro.body):
            if text == "##":
                pastes = bool(result_tokens)
                continue
            if text in arguments:
                is_pasted = pastes or macro.body[index + 1 : index + 2] == ("##",)
                some = arguments[text] if is_pasted else self._expanded(arguments[text])
                new = [own(t.text, t.hidden) for t in some]
            else:
                new = [own(text)]
            if pastes and new:
                new[0] = own(result_tokens.pop().text + new[0].text)
            pastes = False
            result_tokens += new
        yield from result_tokens

    def _expanded(self, tokens: Sequence[Token]) -> list[Token]:
        """Return an argument with the macros in it expanded."""
        if not any(token.text in self.macros for token in tokens):
            return list(tokens)
        inner = _Reader(())
        inner.macros, inner.pending, inner.left = self.macros, list(reversed(tokens)), self.left
        expanded = list(inner.tokens())
        self.left = inner.left
        return expanded


_IFNDEF = re.compile(r"\s*#\s*ifndef\s+(\w+)\s*$")
_DEFINE_ALONE = re.compile(r"\s*#\s*define\s+(\w+)\s*$")
_CONDITION = re.compile(r"\s*#\s*(if|ifdef|ifndef|else|elif|endif)\b")


def without_guards(lines: Sequence[str]) -> list[int]:
    """Return the indices of the lines that are neither a guard's nor there a second time.

    ``lines`` have no comments. A guard is ``#ifndef`` with a ``#define`` of its name in the next line.
    """
    numbers: list[int] = []
    guards: set[str] = set()
    stack: list[str] = []  # of each open condition: "guard", "twice" or "other"
    skip_define = ""
    for index, line in enumerate(lines):
        if skip_define and _DEFINE_ALONE.match(line):
            skip_define = ""
            continue
        condition = _CONDITION.match(line)
        word = condition.group(1) if condition else ""
        guard = _IFNDEF.match(line)
        following = _DEFINE_ALONE.match(lines[index + 1]) if index + 1 < len(lines) else None
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
            numbers.append(index)
    return numbers
