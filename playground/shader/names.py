"""The names in GLSL texts, and what each means: of one text, or of a shader with its includes.

A ``Syntax`` has the symbols of one text, every branch of its conditions read; a ``Unit`` is a shader with its
includes in place, and knows where each part of it comes from. What cannot be read of a half-typed text has
names, too: they mean what is visible there.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

from playground.memo import Memo
from playground.shader.reserved_names import GIVEN
from playground.shader.syntax.influence import scopes_of
from playground.shader.syntax.nodes import Expression, Function, Member, Node, walk
from playground.shader.syntax.parser import Tree, parse
from playground.shader.syntax.symbols import Symbol, Symbols, resolve
from playground.shader.syntax.tokens import Comment, Token, tokenize
from playground.shader.syntax.types import ExpressionTypes

SYNTAX: Memo[Any, Any] = Memo("syntax of edited texts", 2**18, "tokens")
"""Trees and symbols of texts that are open, and of those that are read for a rename."""

Meaning = Hashable
"""What a name means: ("top", name), ("local", name, scope), ("member", struct, name) or ("macro", name)."""


_GIVEN_TYPES = {name: glsl_type for name, (glsl_type, _) in GIVEN.items()}


# ── words ──────────────────────────────────────────────────────────────────────


class Word(NamedTuple):
    """One identifier of a text."""

    text: str
    start: int
    is_parameter: bool = False  # of a macro, in its definition


class Occurrence(NamedTuple):
    """One place of a name, and what it means there."""

    at: int
    meaning: Meaning
    macro: str = ""  # in whose body it is


@SYNTAX.cached(weight=lambda lexed: len(lexed[0]) // 4 + 1)
def lexed(text: str) -> tuple[list[Token], list[Comment]]:
    """Return the tokens of a text, its directives whole, and its comments."""
    return tokenize(text)


@SYNTAX.cached(weight=lambda words: len(words) // 4 + 1)
def words(text: str) -> tuple[Word, ...]:
    """Return the identifiers of a text's code, those of macros too, but for includes and pragmas."""
    return tuple(_words_in(text, 0))


def _words_in(text: str, offset: int, *, comments: bool = False) -> Iterator[Word]:
    tokens, comments_found = tokenize(text)
    for token in tokens:
        if token.kind == "word":
            yield Word(token.text, offset + token.start)
        elif token.kind == "directive":
            yield from _words_of_directive(token, offset + token.start)
    for comment in comments_found if comments else ():
        yield from _words_in(comment.text[2:], offset + comment.start + 2, comments=True)


def _words_of_directive(directive: Token, offset: int) -> Iterator[Word]:
    tokens, _ = tokenize(directive.text[1:])
    kind = tokens[0].text if tokens else ""
    if kind in ("include", "pragma", "version", "extension"):
        return
    parameters: set[str] = set()
    if kind == "define" and len(tokens) > 2 and tokens[2].text == "(" and tokens[2].start == tokens[1].end:
        for token in tokens[3:]:
            if token.text == ")":
                break
            parameters.add(token.text)
    for token in tokens[1:]:
        if token.kind == "word":
            yield Word(token.text, offset + 1 + token.start, token.text in parameters)


def word_at(text: str, at: int) -> tuple[str, int]:
    """Return the identifier that a place is in or behind, and where it begins; ("", at) for none.

    Letters of numbers, as in 1e-3, 2.0f and 0xFFu, are none.
    """
    line = text.rfind("\n", 0, at) + 1
    end = text.find("\n", at)
    for word in _words_in(text[line : end if end >= 0 else len(text)], line, comments=True):
        if word.start <= at <= word.start + len(word.text):
            return word.text, word.start
    return "", at


def is_code(text: str, at: int) -> bool:
    """Return whether a place is in the text, and in no comment."""
    return at < len(text) and not is_comment(text, at)


def is_comment(text: str, at: int) -> bool:
    """Return whether a place is in a comment, or at the end of its line."""
    return any(c.start <= at < c.end + c.text.startswith("//") for c in lexed(text)[1])


# ── one text ───────────────────────────────────────────────────────────────────


@SYNTAX.cached(weight=lambda syntax: len(syntax.tree.tokens))
def syntax_of(text: str) -> Syntax:
    """Return the symbols of a text with every branch of its conditions."""
    return Syntax(text)


class _Reading:
    """One tree of a text, with the scopes of its locals."""

    def __init__(self, tree: Tree) -> None:
        self.tree = tree
        self.symbols: Symbols = resolve(tree)
        self.types = ExpressionTypes(self.symbols, _GIVEN_TYPES)
        functions = [node for node in tree.declarations if isinstance(node, Function)]
        self.scopes: dict[Node, Node] = dict(entry for each in functions for entry in scopes_of(each))
        self.symbol_at: Mapping[int, Symbol] = self.symbols.symbol_at

    def spelled(self, token: int) -> int:
        """Return where the text has a token: of a macro's, in its definition; -1 for nowhere."""
        place = self.tree.tokens[token].spelled
        text = self.tree.tokens[token].text
        return place if place >= 0 and self.tree.text.startswith(text, place) else -1


class Syntax:
    """The symbols of one text, every branch read."""

    def __init__(self, text: str) -> None:
        self.text = text
        self._occurrences: dict[str, list[Occurrence]] = {}
        self.tree = parse(text, all_branches=True)
        self._main = _Reading(self.tree)
        self.symbols = self._main.symbols
        self.readings = [self._main, *(_Reading(tree) for tree in _branches(self.tree))]

    @property
    def is_whole(self) -> bool:
        """Whether all of the text could be read, as one text."""
        return not self.tree.errors and len(self.readings) == 1

    def place(self, symbol: Symbol) -> int:
        """Return where a symbol of the text is declared."""
        token = self.tree.tokens[symbol.token]
        return token.spelled if token.spelled >= 0 else token.start

    @cached_property
    def _locals(self) -> list[tuple[Symbol, int, int]]:
        """Locals and parameters, each with the places from and up to which it can be named."""
        by_node = {symbol.node: symbol for symbol in self.symbols.symbols}
        found = []
        for node, scope in self._main.scopes.items():
            if (symbol := by_node.get(node)) is not None:
                found.append((symbol, self.tree.span(node)[1], self.tree.span(scope)[1]))
        return found

    def scopes(self) -> set[Node]:
        """Return the nodes that locals and parameters can be named in."""
        return {scope for reading in self.readings for scope in reading.scopes.values()}

    def visible(self, at: int) -> dict[str, Symbol]:
        """Return the locals and parameters that can be named at a place, by name."""
        inside = [entry for entry in self._locals if entry[1] <= at < entry[2]]
        return {symbol.name: symbol for symbol, _, _ in sorted(inside, key=lambda entry: entry[1])}

    def local_at(self, name: str, at: int) -> Symbol | None:
        """Return the local or parameter that a name at a place stands for, or declares; else None."""
        for token, symbol in self._tokens_at.get(at, ()):
            if self.tree.tokens[token].text == name:
                return symbol if symbol is not None and symbol.kind in ("local", "parameter") else None
        return self.visible(at).get(name)

    @cached_property
    def _tokens_at(self) -> dict[int, list[tuple[int, Symbol | None]]]:
        places: dict[int, list[tuple[int, Symbol | None]]] = {}
        for reference in self.symbols.references:
            place = self._main.spelled(reference.token)
            places.setdefault(place, []).append((reference.token, reference.symbol))
        return places

    @cached_property
    def macros(self) -> frozenset[str]:
        """The macros that the text defines."""
        trees = [reading.tree for reading in self.readings]
        return frozenset(macro.name for tree in trees for macro in tree.preprocessed.macros)

    def occurrences(self, name: str) -> list[Occurrence]:
        """Return every place of a name in the text, in order; one in a macro's text may have several."""
        if name not in self._occurrences:
            self._occurrences[name] = self._found(name) if name in self.text else []
        return self._occurrences[name]

    def _found(self, name: str) -> list[Occurrence]:
        if name in self.macros:
            places = [word for word in words(self.text) if word.text == name and not word.is_parameter]
            return [Occurrence(word.start, ("macro", name)) for word in places]
        found = {each for reading in self.readings for each in self._in_reading(reading, name)}
        found |= set(self._in_unused_macros(name, {each.at for each in found}))
        return sorted(found, key=lambda each: each.at)

    def _in_reading(self, reading: _Reading, name: str) -> Iterator[Occurrence]:
        tokens = reading.tree.tokens
        unread = {index for index, token in enumerate(tokens) if token.text == name}
        for reference in reading.symbols.references:
            token = tokens[reference.token]
            if token.text == name:
                unread.discard(reference.token)
                meaning = self._meaning(reading, reference.symbol, name, token.start)
                yield Occurrence(reading.spelled(reference.token), meaning, _macro_of(reading, token))
        for declaration in reading.tree.declarations:
            for node in walk(declaration):
                if isinstance(node, Member) and node.name == name:
                    unread.discard(node.at)
                    struct, dimensions = reading.types.of(node.base)
                    meaning = ("member", struct if not dimensions else "", name)
                    yield Occurrence(reading.spelled(node.at), meaning, _macro_of(reading, tokens[node.at]))
        for index in unread:  # in a part that is no GLSL by itself
            place = tokens[index].start
            meaning = ("member", "", name)
            if index == 0 or tokens[index - 1].text != ".":
                is_main = reading is self._main
                meaning = self._visible_meaning(name, place) if is_main else self._around(name, place)
            yield Occurrence(reading.spelled(index), meaning, _macro_of(reading, tokens[index]))

    def _meaning(self, reading: _Reading, symbol: Symbol | None, name: str, at: int) -> Meaning:
        if symbol is not None and symbol.kind == "member":
            return ("member", self._owners(reading).get(symbol.node, ""), name)
        if symbol is not None and (scope := reading.scopes.get(symbol.node)) is not None:
            return ("local", name, scope)
        if symbol is not None and symbol.function is not None:
            return ("local", name, symbol.node)  # a struct in a function
        return ("top", name) if reading is self._main else self._around(name, at)

    def _around(self, name: str, at: int) -> Meaning:
        """Return what a name means in a span that was left out, by what stands around it."""
        spans = [(*self.tree.span(s), s) for n, s in self._main.scopes.items() if _name_of(n) == name]
        inside = [(start, -end, scope) for start, end, scope in spans if start <= at < end]
        if not inside:
            return ("top", name)
        return ("local", name, max(inside, key=lambda entry: entry[:2])[2])

    def _owners(self, reading: _Reading) -> dict[Node, str]:
        """Return the struct or block of each member's declarator."""
        owners: dict[Node, str] = {}
        for symbol in reading.symbols.symbols:
            if symbol.kind in ("struct", "block"):
                for member in getattr(symbol.node, "members", ()):
                    owners |= dict.fromkeys(member.names, getattr(symbol.node, "name", ""))
        return owners

    def _in_unused_macros(self, name: str, known: set[int]) -> Iterator[Occurrence]:
        """Yield the places in macros' texts that no expansion has reached, by where the macros stand."""
        for reading in self.readings:
            preprocessed = reading.tree.preprocessed
            for macro in preprocessed.macros:
                for index, token in enumerate(macro.body):
                    behind_dot = index > 0 and macro.body[index - 1].text == "."
                    if token.text != name or token.start in known or name in (macro.parameters or ()):
                        continue
                    if behind_dot:
                        yield Occurrence(token.start, ("member", "", name), macro.name)
                        continue
                    places = [each.start for each in preprocessed.expansions if each.name == macro.name]
                    meanings = {self._visible_meaning(name, place) for place in places} or {("top", name)}
                    for meaning in meanings:
                        yield Occurrence(token.start, meaning, macro.name)

    def _visible_meaning(self, name: str, at: int) -> Meaning:
        symbol = self.visible(at).get(name)
        return ("top", name) if symbol is None else self._meaning(self._main, symbol, name, at)

    def type_at(self, at: int) -> str:
        """Return the type of the expression that is the statement at a place; "" for none."""
        for declaration in self.tree.declarations:
            start, end = self.tree.span(declaration)
            for node in walk(declaration) if start <= at < end else ():
                if isinstance(node, Expression) and self.tree.span(node)[0] == at:
                    glsl_type, dimensions = self._main.types.of(node.value)
                    return glsl_type if not dimensions else ""
        return ""

    def is_swizzle(self, name: str, struct: str) -> bool:
        """Return whether a member is of no struct of the text, and a name of a vector's components."""
        symbols = self.symbols.symbols
        structs = {s.name if s.kind == "struct" else s.type for s in symbols if s.kind in ("struct", "block")}
        return struct not in structs and any(set(name) <= set(each) for each in ("xyzw", "rgba", "stpq"))

    def declares(self, name: str) -> bool:
        """Return whether the text declares a name at its top level."""
        own = (s for reading in self.readings for s in reading.symbols.symbols)
        return name in self.macros or any(
            s.name == name and s.function is None and s.kind not in ("member", "parameter") for s in own
        )


def _branches(tree: Tree) -> Iterator[Tree]:
    for branch in tree.branches:
        yield branch
        yield from _branches(branch)


def _name_of(node: Node) -> str:
    return str(getattr(node, "name", ""))


def _macro_of(reading: _Reading, token: Token) -> str:
    """Return the macro in whose definition a token is spelled; "" for one that stands in the text."""
    if not token.macros:
        return ""
    inside = (m.name for m in reading.tree.preprocessed.macros if m.start <= token.spelled < m.end)
    return next(inside, "")


# ── a shader with its includes ─────────────────────────────────────────────────

_INCLUDE = re.compile(r"^[ \t]*#[ \t]*(?:pragma[ \t]+)?include[ \t]*[\"<]([^\">\n]*)", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Include:
    """An ``#include`` of a text."""

    name: str
    start: int  # of the name
    end: int


def includes(text: str) -> list[Include]:
    """Return the includes of a text."""
    return [Include(m[1], m.start(1), m.end(1)) for m in _INCLUDE.finditer(text)]


def include_at(text: str, at: int) -> Include | None:
    """Return the include whose name a place is in."""
    return next((include for include in includes(text) if include.start <= at <= include.end), None)


class Unit:
    """A shader's text with its includes in place, each once, and where each part of it comes from."""

    def __init__(
        self, path: Path, texts: Mapping[Path, str], targets: Mapping[tuple[Path, str], Path]
    ) -> None:
        """Make it of the texts of its files; ``targets`` has the file of each include that a file writes."""
        self._texts, self._targets = texts, targets
        self._parts: list[tuple[int, Path, int]] = []  # where a part begins, its file, where it begins there
        self._pieces: list[str] = []
        self._length = 0
        self._included: set[Path] = set()
        self._around: list[Path] = []  # files whose includes are being put in place
        self._add(path)
        self.text = "".join(self._pieces)
        self._starts = [start for start, _, _ in self._parts]

    def _add(self, path: Path) -> None:
        self._included.add(path)
        self._around.append(path)
        text, at = self._texts[path], 0
        for include in includes(text):
            target = self._targets.get((path, include.name))
            if target not in self._texts or target is None or len(self._parts) > _MAX_PARTS:
                continue
            if target in self._around or (target in self._included and _is_guarded(self._texts[target])):
                continue
            start = text.rfind("\n", 0, include.start) + 1
            end = text.find("\n", include.end)
            self._put(path, text, at, start)
            self._add(target)
            self._put(None, "\n", 0, 1)
            at = end if end >= 0 else len(text)
        self._put(path, text, at, len(text))
        self._around.pop()

    def _put(self, path: Path | None, text: str, start: int, end: int) -> None:
        if path is not None:
            self._parts.append((self._length, path, start))
        self._pieces.append(text[start:end])
        self._length += end - start

    @property
    def syntax(self) -> Syntax:
        """Its symbols."""
        return syntax_of(self.text)

    def origin(self, at: int) -> tuple[Path, int]:
        """Return the file that a place of the text comes from, and the place there."""
        start, path, offset = self._parts[max(bisect_right(self._starts, at) - 1, 0)]
        return path, at - start + offset

    def places(self, path: Path, at: int) -> list[int]:
        """Return where the text has a place of a file; several where that is included again and again."""
        ends = [*self._starts[1:], len(self.text) + 1]
        return [
            start + at - offset
            for (start, file, offset), end in zip(self._parts, ends, strict=True)
            if file == path and offset <= at <= offset + end - start
        ]

    def meanings(self, path: Path, at: int, name: str) -> set[Meaning]:
        """Return what a name at a place of a file means here."""
        places = set(self.places(path, at))
        return {each.meaning for each in self.syntax.occurrences(name) if each.at in places}

    def member_at(self, path: Path, at: int) -> tuple[Path, int] | None:
        """Return where the member of a struct is declared that a place of a file names; else None."""
        name, start = word_at(dict(self._texts)[path], at)
        for meaning in self.meanings(path, start, name) if name else ():
            if isinstance(meaning, tuple) and meaning[0] == "member" and meaning[1]:
                for symbol in self.syntax.symbols.symbols:
                    if symbol.kind == "member" and symbol.name == name:
                        place = self.syntax.place(symbol)
                        if Occurrence(place, meaning) in self.syntax.occurrences(name):
                            return self.origin(place)
        return None


_MAX_PARTS = 4096


def _is_guarded(text: str) -> bool:
    """Return whether a file is to be included once."""
    tokens, _ = lexed(text)
    return bool(tokens) and re.match(r"#\s*(?:ifndef|if\s*!|pragma\s+once)", tokens[0].text) is not None


@SYNTAX.cached(weight=64)
def unit_of(
    path: Path, files: tuple[tuple[Path, str], ...], targets: tuple[tuple[Path, str, Path], ...]
) -> Unit:
    """Return a shader with its includes in place.

    ``files`` are those that it reads, each with its text; ``targets`` a file, what it includes, and the file
    that this is.
    """
    return Unit(path, dict(files), {(file, name): target for file, name, target in targets})
