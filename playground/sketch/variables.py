"""Find the variables that a GLSL text declares, from its tokens: types, sizes of arrays, initial values.

GLSL is easy here: a statement that begins with qualifiers, a type and a name declares something. What is no
declaration, or one with a mistake, is passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

from playground.sketch.dialects.conditions import value_of
from playground.sketch.expanded import Token

BUILT_IN = re.compile(r"float|double|u?int|bool|[biud]?vec[234]|d?mat[234](?:x[234])?")
"""Types with a value that GLSL has by itself; samplers and images have none."""

_NAME = re.compile(r"[A-Za-z_]\w*")
_QUALIFIERS = frozenset(
    "const in out inout uniform varying attribute buffer shared flat smooth noperspective centroid sample "
    "patch invariant precise highp mediump lowp coherent volatile restrict readonly writeonly layout".split()
)
_NO_TYPES = frozenset(
    "return else do while for if switch case default break continue discard precision struct".split()
)
_JUMPS = frozenset({"break", "return", "continue", "discard"})
_HEADERS = frozenset({"for", "while", "if", "switch"})
_BEHIND_NAMES = frozenset({"=", ";", ",", ")", "[", "("})
_CLOSES = {"(": ")", "[": "]", "{": "}"}
_MAX_MEMBERS = 256  # of a struct, those of its members too

Size = tuple[str, ...]
"""The tokens between the brackets of an array."""


@dataclass(frozen=True, slots=True)
class Type:
    """What a variable is: the name of a type, "" of a struct without one, and the sizes of arrays of it."""

    name: str
    sizes: tuple[Size, ...] = ()  # the outermost first
    members: tuple[tuple[str, Type], ...] = ()  # of a struct

    @property
    def member_count(self) -> int:
        """How many members it has, and they have in turn; an array counts once."""
        return sum(1 + member.member_count for _, member in self.members)


@dataclass(frozen=True, slots=True)
class Variable:
    """One name that is declared."""

    name: str
    type: Type
    qualifiers: frozenset[str]
    at: int  # index of its token
    end: int  # index of the last token of its declarator, without a value
    has_value: bool = False
    close: int = -1  # index of the token that ends the declaration: a semicolon, or the bracket of a header
    is_global: bool = False
    may_follow: bool = False  # a statement may stand behind the semicolon
    block: int = -1  # index of the bracket that opens the block around it; -1: none does


@dataclass(slots=True)
class Function:
    """One definition of a function."""

    name: str
    type: Type
    parameters: tuple[Variable, ...]
    opens: int  # index of the bracket of its body
    closes: int = -1  # index of the bracket that closes it; -1: none does
    last: int = -1  # index of the first token of its last statement
    returns: bool = False  # somewhere a value is


@dataclass(slots=True)
class _Open:
    """An open bracket."""

    bracket: str
    at: int = -1  # its index
    header: str = ""  # for | while | if | switch before a round one
    function: Function | None = None  # whose body a curly one opens


@dataclass
class Declarations:
    """What a text declares; ``tokens`` are one of its readings."""

    tokens: Sequence[Token]
    variables: list[Variable] = field(default_factory=list)
    functions: list[Function] = field(default_factory=list)
    prototypes: list[Function] = field(default_factory=list)
    structs: dict[str, Type] = field(default_factory=dict)
    numbers: dict[str, str] = field(default_factory=dict)  # const ints with values that can be worked out
    entries: list[tuple[int, int]] = field(default_factory=list)  # labels that are only jumped to: the
    # bracket of their switch, and their colon
    is_balanced: bool = True

    def __post_init__(self) -> None:
        self._texts = [token.text for token in self.tokens]
        self._closing: dict[int, int] = {}
        opened: list[int] = []
        for index, text in enumerate(self._texts):
            if text in _CLOSES:
                opened.append(index)
            elif text in _CLOSES.values() and opened:
                self._closing[opened.pop()] = index
        self._read()

    # ── what there is ────────────────────────────────────────────────────────

    def count(self, size: Size) -> int | None:
        """Return an array's size; None where it cannot be worked out."""
        words = [self.numbers.get(word, word).rstrip("uU") for word in size]
        if any(_NAME.match(word) for word in words):
            return None
        return value_of(" ".join(words))

    def names(self) -> Iterator[tuple[str, str, int]]:
        """Yield each name that is declared, its kind, and the index of its token.

        The kind is global, local, called (a function or a struct) or member.
        """
        yield from ((one.name, "global" if one.is_global else "local", one.at) for one in self.variables)
        for function in (*self.functions, *self.prototypes):
            yield function.name, "called", function.opens - 1
            yield from ((one.name, "local", one.at) for one in function.parameters)
        for struct in self.structs.values():
            yield struct.name, "called", -1
            yield from ((name, "member", -1) for name, _ in struct.members)

    # ── reading ──────────────────────────────────────────────────────────────

    def _read(self) -> None:
        texts, count = self._texts, len(self._texts)
        stack: list[_Open] = []
        index, first = 0, ""  # of the statement: its first token's text
        begins, single = True, False  # a statement begins here; it stands alone behind a header
        jumped = False  # no statement goes on to this one
        while index < count:
            if begins:
                is_label = texts[index] in ("case", "default")
                if not (is_label and texts[index - 1] == ":"):
                    jumped = is_label and texts[index - 1] == ";" and first in _JUMPS
                first = "" if single else texts[index]
                body = stack[0].function if stack else None
                if body is not None and len(stack) == 1 and not single and texts[index] != "}":
                    body.last = index
                after = self._declaration(index, stack, single=single)
                if after is not None:
                    index, begins, single = after, False, False
                    continue
            text = texts[index]
            begins, single = False, False
            if text in ("(", "["):
                before = texts[index - 1] if index else ""
                stack.append(_Open(text, index, before if before in _HEADERS else ""))
                begins = before == "for"
            elif text == "{":
                own = self.functions[-1] if not stack and self.functions else None
                stack.append(_Open(text, index, function=own if own and own.opens == index else None))
                begins = True
            elif text in (")", "]", "}"):
                self.is_balanced &= bool(stack) and _CLOSES[stack[-1].bracket] == text
                while stack and text == "}" and stack[-1].bracket != "{":
                    stack.pop()
                closed = stack.pop() if stack and _CLOSES[stack[-1].bracket] == text else _Open("")
                if closed.function is not None:
                    closed.function.closes = index
                begins = text == "}" or bool(closed.header)
                single = bool(closed.header)
            elif text == ";":
                begins = True
            elif text == ":" and first in ("case", "default"):
                begins = True
                if jumped and stack:
                    self.entries.append((stack[-1].at, index))
            elif text in ("else", "do"):
                begins = single = True
            elif text == "return" and stack and stack[0].function and texts[index + 1 : index + 2] != [";"]:
                stack[0].function.returns = True
            index += 1
        self.is_balanced &= not stack

    def _declaration(self, start: int, stack: Sequence[_Open], *, single: bool) -> int | None:
        """Read a declaration; return the index of the token that ends it, or that its body opens with."""
        qualifiers, index = self._qualifiers(start)
        is_block = self._text(index + 1) == "{" and bool(qualifiers)
        kind = self._struct(index, is_block=is_block) if is_block else self._type(index)
        if kind is None:
            return None
        type_, index = kind
        name = self._name(index)
        if not name:
            if is_block:
                self.variables += [
                    Variable(member, own, qualifiers, index, index, is_global=True)
                    for member, own in type_.members
                ]
            return index if self._text(index) == ";" and index > start else None
        if not stack and self._text(index + 1) == "(":
            return self._function(type_, index)
        in_header = bool(stack) and stack[-1].header != ""
        found: list[Variable] = []
        while name:
            sizes, last = self._sizes(index + 1)
            close = self.end_of_value(last + 1)
            own = Type(type_.name, (*sizes, *type_.sizes), type_.members)
            found.append(Variable(name, own, qualifiers, index, last, self._text(last + 1) == "=", close))
            self._note_number(found[-1])
            if self._text(close) != ",":
                break
            index = close + 1
            name = self._name(index)
        if self._text(close) != ";" and not (in_header and self._text(close) == ")"):
            return None
        follows = not single and not in_header
        self.variables += [
            replace(
                one,
                close=close,
                is_global=not stack,
                may_follow=follows,
                block=stack[-1].at if stack else -1,
            )
            for one in found
        ]
        return close

    def _note_number(self, one: Variable) -> None:
        """Note the value of a constant that a size may name."""
        if "const" in one.qualifiers and one.has_value and one.type in (Type("int"), Type("uint")):
            number = self.count(tuple(self._texts[one.end + 2 : one.close]))
            if number is not None:  # one of two with a name counts for none of them
                known = self.numbers.setdefault(one.name, str(number))
                self.numbers[one.name] = known if known == str(number) else one.name

    def _function(self, type_: Type, at: int) -> int | None:
        closing = self.closing(at + 1)
        if closing is None:
            return None
        parameters = []
        index = at + 2
        while index < closing:
            qualifiers, index = self._qualifiers(index)
            kind = self._type(index)
            if kind is not None:
                own, index = kind
                name = self._name(index)
                sizes, last = self._sizes(index + 1) if name else ((), index - 1)
                whole = Type(own.name, (*sizes, *own.sizes), own.members)
                parameters.append(Variable(name, whole, qualifiers, index, last))
            index = self.end_of_value(index) + 1
        function = Function(self._texts[at], type_, tuple(parameters), closing + 1)
        if self._text(closing + 1) == "{":
            self.functions.append(function)
            return closing + 1
        self.prototypes.append(function)
        return closing + 1 if self._text(closing + 1) == ";" else None

    def _qualifiers(self, index: int) -> tuple[frozenset[str], int]:
        found = set()
        while (text := self._text(index)) in _QUALIFIERS:
            found.add(text)
            index += 1
            if text == "layout" and self._text(index) == "(":
                index = (self.closing(index) or index) + 1
        return frozenset(found), index

    def _type(self, index: int) -> tuple[Type, int] | None:
        """Return a type and the index behind it; None where none stands there that a variable may have."""
        text = self._text(index)
        if text == "struct":
            return self._struct(index)
        if not self._word(index):
            return None
        sizes, last = self._sizes(index + 1)
        return Type(text, sizes, self.structs[text].members if text in self.structs else ()), last + 1

    def _struct(self, index: int, *, is_block: bool = False) -> tuple[Type, int] | None:
        name = "" if is_block else self._word(index + 1)
        opens = index + 2 if name else index + 1
        closing = self.closing(opens) if self._text(opens) == "{" else None
        if closing is None:
            return None
        inner, members = opens + 1, []
        while inner < closing:
            _, inner = self._qualifiers(inner)
            kind = self._type(inner) if self._text(inner) != "struct" else None
            if kind is None:
                return None
            own, inner = kind
            while self._name(inner):
                sizes, last = self._sizes(inner + 1)
                members.append((self._texts[inner], Type(own.name, (*sizes, *own.sizes), own.members)))
                inner = last + 2
                if self._text(last + 1) != ",":
                    break
            else:
                return None
        made = Type(name, (), tuple(members))
        if made.member_count > _MAX_MEMBERS:
            return None
        if name:
            self.structs[name] = made
        return made, closing + 1

    def _sizes(self, index: int) -> tuple[tuple[Size, ...], int]:
        """Return the sizes in the brackets that follow, and the index of the last token of them."""
        found = []
        while self._text(index) == "[":
            closing = self.closing(index)
            if closing is None:
                break
            found.append(tuple(self._texts[index + 1 : closing]))
            index = closing + 1
        return tuple(found), index - 1

    def end_of_value(self, index: int) -> int:
        """Return the index of the comma, semicolon or bracket that ends what begins at an index."""
        while index < len(self._texts) and self._texts[index] not in (",", ";", ")", "]", "}"):
            if self._texts[index] in _CLOSES:
                index = self.closing(index) or len(self._texts)
            index += 1
        return min(index, len(self._texts))

    def closing(self, index: int) -> int | None:
        """Return the index of the bracket that closes the one at an index."""
        return self._closing.get(index)

    def _text(self, index: int) -> str:
        return self._texts[index] if index < len(self._texts) else ""

    def _word(self, index: int) -> str:
        """Return the name at an index, "" where none stands there."""
        text = self._text(index)
        return text if _NAME.match(text) and text not in _NO_TYPES and text not in _QUALIFIERS else ""

    def _name(self, index: int) -> str:
        """Return what is declared behind a type; older texts have names there that are qualifiers since."""
        text = self._text(index)
        return text if _NAME.match(text) and self._text(index + 1) in _BEHIND_NAMES else ""
