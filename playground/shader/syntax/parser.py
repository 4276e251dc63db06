"""Parse GLSL into a syntax tree. What cannot be read is an error with its token; the rest is still read.

The tokens are those behind the preprocessor, so that all that a driver compiles can be read. A statement
that begins with a qualifier, with two names, or with a name, brackets and a name, declares something: GLSL
needs no table of types for that.
"""

from __future__ import annotations

import gc
import re
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field

from playground.shader.syntax.nodes import (
    Assign,
    Binary,
    Block,
    Call,
    Case,
    Conditional,
    Declaration,
    Declarator,
    Do,
    Empty,
    Expression,
    For,
    Function,
    If,
    Index,
    InitializerList,
    InterfaceBlock,
    Jump,
    Literal,
    Member,
    Method,
    Name,
    Node,
    Parameter,
    Parenthesized,
    ParseError,
    Precision,
    Struct,
    Switch,
    Type,
    Unary,
    While,
)
from playground.shader.syntax.preprocessor import Preprocessed, preprocess
from playground.shader.syntax.tokens import Token

QUALIFIERS = frozenset(
    "const in out inout uniform varying attribute buffer shared flat smooth noperspective centroid sample"
    " patch invariant precise highp mediump lowp coherent volatile restrict readonly writeonly subroutine"
    " layout".split()
)
_ASSIGNS = frozenset("= += -= *= /= %= &= |= ^= <<= >>=".split())
PRECEDENCE = {
    sign: level
    for level, signs in enumerate(
        ("||", "^^", "&&", "|", "^", "&", "== !=", "< > <= >=", "<< >>", "+ -", "* / %"), 1
    )
    for sign in signs.split()
}
_KEYWORDS = frozenset(
    "if else for while do switch case default break continue return discard struct precision".split()
)
_OPENING, _CLOSING = frozenset("([{"), frozenset(")]}")
_MAX_NESTING = 60  # of expressions and blocks: Python's stack holds some 1,000 calls


@dataclass(slots=True, eq=False)
class Tree:
    """The syntax tree of a text; its nodes count ``tokens``."""

    text: str
    preprocessed: Preprocessed
    declarations: list[Node] = field(default_factory=list)
    errors: list[ParseError] = field(default_factory=list)
    branches: list[Tree] = field(default_factory=list)
    """What conditions leave out, each span a tree of its own in its place; of an author's file alone."""
    _line_starts: list[int] = field(default_factory=list)

    @property
    def tokens(self) -> list[Token]:
        """The tokens behind the preprocessor."""
        return self.preprocessed.tokens

    def span(self, node: Node) -> tuple[int, int]:
        """Return where a node begins and ends in the text."""
        tokens = self.preprocessed.tokens
        if node.last <= node.first:
            place = tokens[node.first].start if node.first < len(tokens) else len(self.text)
            return place, place
        return tokens[node.first].start, tokens[node.last - 1].end

    def source(self, node: Node) -> str:
        """Return a node as the text has it."""
        start, end = self.span(node)
        return self.text[start:end]

    def place(self, offset: int) -> tuple[int, int]:
        """Return the line and the column of an offset of the text, both from 0."""
        if not self._line_starts:
            self._line_starts = [0, *(match.end() for match in re.finditer("\n", self.text))]
        line = bisect_right(self._line_starts, offset) - 1
        return line, offset - self._line_starts[line]

    def line(self, token: int) -> int:
        """Return the line of a token, from 0; of the end of the text for one behind the last."""
        tokens = self.preprocessed.tokens
        return self.place(tokens[token].start if token < len(tokens) else len(self.text))[0]


def parse(
    text: str, defined: Mapping[str, str] | None = None, *, all_branches: bool = False, unknown: bool = False
) -> Tree:
    """Return the tree of a text; it never raises.

    ``defined``: macros that are defined before it. ``all_branches``: a file whose conditions nobody
    has judged. All branches are read at once; where that is no GLSL, the judged text is, and each span that
    it leaves out apart, in ``branches``. ``unknown``: whether what only the driver knows is defined.
    """
    with collector_paused():
        tree = _parsed(text, preprocess(text, defined, all_branches=all_branches, unknown=unknown))
        if all_branches and tree.errors:
            judged = _parsed(text, preprocess(text, defined))
            if judged.preprocessed.inactive and len(judged.errors) <= len(tree.errors):
                judged.branches = [_branch(text, *span) for span in judged.preprocessed.inactive]
                return judged
    return tree


@contextmanager
def collector_paused() -> Iterator[None]:
    """Pause the cyclic garbage collector: for the many nodes of a tree it would run often, and in vain."""
    was_enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_enabled:
            gc.enable()


def _parsed(text: str, preprocessed: Preprocessed) -> Tree:
    parser = _Parser(preprocessed.tokens)
    declarations = parser.translation_unit()
    return Tree(text, preprocessed, declarations, parser.errors)


def _branch(text: str, start: int, end: int) -> Tree:
    """Return the tree of what a condition leaves out, in its place."""
    return parse(re.sub(r"[^\n]", " ", text[:start]) + text[start:end], all_branches=True)


class _Unexpected(Exception):
    pass


class _Parser:
    def __init__(self, tokens: Sequence[Token]) -> None:
        self._texts = [token.text for token in tokens] + ["", "", "", ""]
        self._kinds = [token.kind for token in tokens] + ["end", "end", "end", "end"]
        self._count = len(tokens)
        self._at = 0
        self._depth = 0
        self.errors: list[ParseError] = []

    # ── reading tokens ───────────────────────────────────────────────────────

    def _expect(self, text: str) -> None:
        if self._texts[self._at] != text:
            raise self._unexpected(f"expected '{text}'")
        self._at += 1

    def _unexpected(self, message: str) -> _Unexpected:
        read = f"'{self._texts[self._at]}'" if self._at < self._count else "the end of the text"
        self.errors.append(ParseError(self._at, f"{message}, found {read}"))
        return _Unexpected()

    def _word(self) -> str:
        if self._kinds[self._at] != "word":
            raise self._unexpected("expected a name")
        self._at += 1
        return self._texts[self._at - 1]

    def _deeper(self) -> None:
        self._depth += 1
        if self._depth > _MAX_NESTING:
            raise self._unexpected(f"nested more than {_MAX_NESTING} deep")

    def _behind(self, at: int) -> int:
        """Return the index behind the bracket that closes the one at an index."""
        depth = 0
        for index in range(at, self._count):
            text = self._texts[index]
            if text in _OPENING:
                depth += 1
            elif text in _CLOSING:
                depth -= 1
                if depth == 0:
                    return index + 1
        return self._count

    def _recover(self, before: int) -> None:
        """Go on after an error in what began at ``before``.

        That is at the next function, behind the next semicolon or block of this depth, or at the brace that
        closes this depth.
        """
        for at in range(before + 1, self._at):
            if self._begins_function(at):
                self._at = at
                return
        if self._at == before and not self._begins_function(before):
            self._at += 1
        depth = 0
        while self._at < self._count and not self._begins_function(self._at):
            text = self._texts[self._at]
            if text in _OPENING:
                depth += 1
            elif text in _CLOSING:
                if text == "}" and depth <= 0:
                    return
                depth -= 1
                if text == "}" and depth == 0:
                    self._at += 1
                    return
            self._at += 1
            if text == ";" and depth <= 0:
                return

    # ── the top level ────────────────────────────────────────────────────────

    def translation_unit(self) -> list[Node]:
        nodes: list[Node] = []
        while self._at < self._count:
            before, self._depth = self._at, 0
            try:
                if self._texts[before] == ";":
                    self._at += 1
                    nodes.append(Empty(before, self._at))
                else:
                    nodes.append(self._external())
            except (_Unexpected, RecursionError) as error:
                if isinstance(error, RecursionError):
                    self.errors.append(ParseError(self._at, "nested too deeply"))
                self._recover(before)
                if self._at == before or self._texts[self._at] == "}":
                    self._at += 1
        return nodes

    def _external(self) -> Node:
        first, texts = self._at, self._texts
        if texts[first] == "precision":
            return self._precision()
        qualifiers = self._qualifiers()
        at = self._at
        if qualifiers and texts[at] == ";":  # layout(…) in;
            self._at += 1
            return Declaration(first, self._at, Type(first, at, qualifiers, "", -1, [], None), [])
        if qualifiers and self._kinds[at] == "word" and texts[at] != "struct":
            if texts[at + 1] == "{":
                return self._interface(first, qualifiers)
            if texts[at + 1] in (";", ","):  # invariant gl_Position;
                names = self._declarators()
                self._expect(";")
                return Declaration(first, self._at, Type(first, at, qualifiers, "", -1, [], None), names)
        of_type = self._type(first, qualifiers)
        if self._kinds[self._at] == "word" and texts[self._at + 1] == "(":
            return self._function(first, of_type)
        return self._declaration(first, of_type)

    def _function(self, first: int, of_type: Type) -> Function:
        at = self._at
        name = self._word()
        self._expect("(")
        parameters: list[Parameter] = []
        if self._texts[self._at] == "void" and self._texts[self._at + 1] == ")":
            self._at += 1
        while self._texts[self._at] != ")":
            parameters.append(self._parameter())
            if self._texts[self._at] != ")":
                self._expect(",")
        self._at += 1
        body = None
        if self._texts[self._at] == "{":
            body = self._block()
        else:
            self._expect(";")
        return Function(first, self._at, of_type, name, at, parameters, body)

    def _parameter(self) -> Parameter:
        first = self._at
        of_type = self._type(first, self._qualifiers())
        at = self._at
        name = self._word() if self._kinds[at] == "word" else ""
        arrays = self._arrays()
        return Parameter(first, self._at, of_type, name, at, arrays)

    def _interface(self, first: int, qualifiers: list[str]) -> InterfaceBlock:
        at = self._at
        name = self._word()
        members = self._members()
        instance_at, instance, arrays = self._at, "", list[Node | None]()
        if self._kinds[self._at] == "word":
            instance = self._word()
            arrays = self._arrays()
        self._expect(";")
        return InterfaceBlock(first, self._at, qualifiers, name, at, members, instance, instance_at, arrays)

    def _precision(self) -> Precision:
        first = self._at
        while self._at < self._count and self._texts[self._at] != ";":
            self._at += 1
        self._expect(";")
        return Precision(first, self._at)

    # ── declarations ─────────────────────────────────────────────────────────

    def _qualifiers(self) -> list[str]:
        qualifiers: list[str] = []
        texts, kinds = self._texts, self._kinds
        while texts[self._at] in QUALIFIERS:
            word, first = texts[self._at], self._at
            has_bracket = word in ("layout", "subroutine") and texts[first + 1] == "("
            # GLSL ES 1.00 has names such as sample, buffer, shared: no word follows those.
            if not has_bracket and kinds[first + 1] != "word" and texts[first + 1] != ";":
                break
            self._at += 1
            if has_bracket:
                self._at = self._behind(self._at)
                word = "".join(texts[first : self._at])
            qualifiers.append(word)
        return qualifiers

    def _type(self, first: int, qualifiers: list[str]) -> Type:
        at, struct = self._at, None
        if self._texts[at] == "struct":
            struct = self._struct()
            name, at = struct.name, -1
        else:
            if self._texts[at] in _KEYWORDS or self._kinds[at] != "word":
                raise self._unexpected("expected a type")
            name = self._word()
        arrays = self._arrays()
        return Type(first, self._at, qualifiers, name, at, arrays, struct)

    def _struct(self) -> Struct:
        first = self._at
        self._at += 1
        at, name = self._at, ""
        if self._kinds[at] == "word":
            name = self._word()
        members = self._members()
        return Struct(first, self._at, name, at, members)

    def _members(self) -> list[Declaration]:
        members: list[Declaration] = []
        self._expect("{")
        while self._texts[self._at] != "}":
            first = self._at
            of_type = self._type(first, self._qualifiers())
            members.append(self._declaration(first, of_type))
        self._at += 1
        return members

    def _arrays(self) -> list[Node | None]:
        sizes: list[Node | None] = []
        while self._texts[self._at] == "[":
            self._at += 1
            sizes.append(None if self._texts[self._at] == "]" else self._comma())
            self._expect("]")
        return sizes

    def _declaration(self, first: int, of_type: Type) -> Declaration:
        names = [] if self._texts[self._at] == ";" else self._declarators()
        self._expect(";")
        return Declaration(first, self._at, of_type, names)

    def _declarators(self) -> list[Declarator]:
        names: list[Declarator] = []
        while True:
            at, value = self._at, None
            name = self._word()
            arrays = self._arrays()
            if self._texts[self._at] == "=":
                self._at += 1
                value = self._initializer()
            names.append(Declarator(at, self._at, name, at, arrays, value))
            if self._texts[self._at] != ",":
                return names
            self._at += 1

    def _initializer(self) -> Node:
        if self._texts[self._at] != "{":
            return self._assignment()
        first = self._at
        self._at += 1
        self._deeper()
        items: list[Node] = []
        while self._texts[self._at] != "}":
            items.append(self._initializer())
            if self._texts[self._at] != "}":
                self._expect(",")
        self._at += 1
        self._depth -= 1
        return InitializerList(first, self._at, items)

    def _declares(self) -> bool:
        """Return whether a statement begins a declaration."""
        at, texts, kinds = self._at, self._texts, self._kinds
        text = texts[at]
        if kinds[at] != "word":
            return False
        if text == "struct":
            return True
        if kinds[at + 1] == "word":
            return text not in _KEYWORDS
        if text == "layout" and texts[at + 1] == "(":
            return True
        if texts[at + 1] != "[":
            return False
        at += 1
        while texts[at] == "[":
            at = self._behind(at)
        return kinds[at] == "word"

    # ── statements ───────────────────────────────────────────────────────────

    def _block(self) -> Block:
        first, depth = self._at, self._depth
        self._expect("{")
        statements: list[Node] = []
        while True:
            self._depth = depth
            if self._at >= self._count:
                self.errors.append(ParseError(first, "this bracket is not closed"))
                return Block(first, self._at, statements)
            if self._texts[self._at] == "}":
                self._at += 1
                return Block(first, self._at, statements)
            before = self._at
            try:
                if self._begins_function(before):
                    self.errors.append(
                        ParseError(first, "this bracket is not closed before the next function")
                    )
                    return Block(first, self._at, statements)
                statements.append(self._statement())
            except _Unexpected:
                self._recover(before)

    def _begins_function(self, at: int) -> bool:
        """Return whether a function is defined here: a bracket before it was never closed."""
        texts, kinds = self._texts, self._kinds
        if texts[at + 2] != "(" or kinds[at] != "word" or kinds[at + 1] != "word" or texts[at] in _KEYWORDS:
            return False
        behind = self._behind(at + 2)
        return behind < self._count and texts[behind] == "{"

    def _statement(self) -> Node:
        first, text = self._at, self._texts[self._at]
        if text == ";":
            self._at += 1
            return Empty(first, self._at)
        self._deeper()
        node = self._deep_statement(first, text)
        self._depth -= 1
        return node

    def _deep_statement(self, first: int, text: str) -> Node:
        if text == "{":
            return self._block()
        method = _STATEMENTS.get(text)
        if method is not None:
            return method(self)
        if self._declares():
            of_type = self._type(first, self._qualifiers())
            if self._texts[self._at + 1] == "(" and self._kinds[self._at] == "word":
                return self._function(first, of_type)  # a prototype in a function's body, of GLSL 1.00
            return self._declaration(first, of_type)
        value = self._comma()
        self._expect(";")
        return Expression(first, self._at, value)

    def _condition(self) -> Node:
        """Return what is in the brackets of an if or a while: it may declare a variable."""
        first = self._at
        if not self._declares():
            return self._comma()
        of_type = self._type(first, self._qualifiers())
        return Declaration(first, self._at, of_type, self._declarators())

    def _in_brackets(self, inside: Callable[[], Node]) -> Node:
        self._expect("(")
        node = inside()
        self._expect(")")
        return node

    def _if(self) -> If:
        arms: list[tuple[int, Node, Node]] = []
        no = None
        while True:  # a loop: chains of else if may be longer than the stack is deep
            first = self._at
            self._at += 1
            condition = self._in_brackets(self._condition)
            arms.append((first, condition, self._statement()))
            if self._texts[self._at] != "else":
                break
            self._at += 1
            if self._texts[self._at] != "if":
                no = self._statement()
                break
        for first, condition, yes in reversed(arms):
            no = If(first, self._at, condition, yes, no)
        assert isinstance(no, If)
        return no

    def _for(self) -> For:
        first = self._at
        self._at += 1
        self._expect("(")
        start = self._statement()
        condition = None if self._texts[self._at] == ";" else self._condition()
        self._expect(";")
        step = None if self._texts[self._at] == ")" else self._comma()
        self._expect(")")
        body = self._statement()
        return For(first, self._at, start, condition, step, body)

    def _while(self) -> While:
        first = self._at
        self._at += 1
        condition = self._in_brackets(self._condition)
        body = self._statement()
        return While(first, self._at, condition, body)

    def _do(self) -> Do:
        first = self._at
        self._at += 1
        body = self._statement()
        self._expect("while")
        condition = self._in_brackets(self._comma)
        self._expect(";")
        return Do(first, self._at, body, condition)

    def _switch(self) -> Switch:
        first = self._at
        self._at += 1
        value = self._in_brackets(self._comma)
        body = self._block()
        return Switch(first, self._at, value, body)

    def _case(self) -> Case:
        first = self._at
        self._at += 1
        value = self._comma() if self._texts[first] == "case" else None
        self._expect(":")
        return Case(first, self._at, value)

    def _jump(self) -> Jump:
        first = self._at
        self._at += 1
        value = None if self._texts[self._at] == ";" else self._comma()
        self._expect(";")
        return Jump(first, self._at, self._texts[first], value)

    # ── expressions ──────────────────────────────────────────────────────────

    def _comma(self) -> Node:
        first = self._at
        node = self._assignment()
        while self._texts[self._at] == ",":
            self._at += 1
            right = self._assignment()
            node = Binary(first, self._at, ",", node, right)
        return node

    def _assignment(self) -> Node:
        first = self._at
        left = self._binary(1)
        text = self._texts[self._at]
        if text == "?":
            self._deeper()
            self._at += 1
            yes = self._comma()
            self._expect(":")
            no = self._assignment()
            self._depth -= 1
            return Conditional(first, self._at, left, yes, no)
        if text in _ASSIGNS:
            self._deeper()
            self._at += 1
            value = self._assignment()
            self._depth -= 1
            return Assign(first, self._at, text, left, value)
        return left

    def _binary(self, least: int) -> Node:
        first = self._at
        left = self._unary()
        texts = self._texts
        while (level := PRECEDENCE.get(texts[self._at], 0)) >= least:
            sign = texts[self._at]
            self._at += 1
            right = self._binary(level + 1)
            left = Binary(first, self._at, sign, left, right)
        return left

    def _unary(self) -> Node:
        first, texts = self._at, self._texts
        text = texts[first]
        if text in ("-", "+", "!", "~", "++", "--"):
            self._deeper()
            self._at += 1
            operand = self._unary()
            self._depth -= 1
            return Unary(first, self._at, text, operand, False)
        node = self._primary()
        while True:
            text = texts[self._at]
            if text == ".":
                self._at += 1
                at = self._at
                name = self._word()
                if texts[self._at] == "(":
                    arguments = self._arguments()
                    node = Method(first, self._at, node, name, arguments)
                else:
                    node = Member(first, self._at, node, name, at)
            elif text == "[":
                self._at += 1
                index = self._nested()
                self._expect("]")
                node = Index(first, self._at, node, index)
            elif text in ("++", "--"):
                self._at += 1
                node = Unary(first, self._at, text, node, True)
            else:
                return node

    def _nested(self) -> Node:
        self._deeper()
        node = self._comma()
        self._depth -= 1
        return node

    def _primary(self) -> Node:
        first = self._at
        text, kind = self._texts[first], self._kinds[first]
        if kind == "word" and text not in _KEYWORDS:
            self._at += 1
            following = self._texts[self._at]
            if following == "(":
                arguments = self._arguments()
                return Call(first, self._at, text, first, [], arguments)
            if following == "[":  # float[3](…), T[](…)
                behind = self._at
                while self._texts[behind] == "[":
                    behind = self._behind(behind)
                if self._texts[behind] == "(":
                    arrays = self._arrays()
                    arguments = self._arguments()
                    return Call(first, self._at, text, first, arrays, arguments)
            return Name(first, self._at, text)
        if kind == "number":
            self._at += 1
            return Literal(first, self._at, text)
        if text == "(":
            self._at += 1
            inside = self._nested()
            self._expect(")")
            return Parenthesized(first, self._at, inside)
        raise self._unexpected("expected an expression")

    def _arguments(self) -> list[Node]:
        texts = self._texts
        self._at += 1
        self._deeper()
        arguments: list[Node] = []
        if texts[self._at] == "void" and texts[self._at + 1] == ")":
            self._at += 1
        while texts[self._at] != ")":
            arguments.append(self._assignment())
            if texts[self._at] != ")":
                self._expect(",")
                if texts[self._at] == ")":
                    raise self._unexpected("expected an argument")
        self._at += 1
        self._depth -= 1
        return arguments


_STATEMENTS: Mapping[str, Callable[[_Parser], Node]] = {
    "if": _Parser._if,
    "for": _Parser._for,
    "while": _Parser._while,
    "do": _Parser._do,
    "switch": _Parser._switch,
    "case": _Parser._case,
    "default": _Parser._case,
    "return": _Parser._jump,
    "break": _Parser._jump,
    "continue": _Parser._jump,
    "discard": _Parser._jump,
    "precision": _Parser._precision,
}
