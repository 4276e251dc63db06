"""Initialise the variables of other tools' shaders to 0, as WebGL does: OpenGL leaves them undefined.

That is what is declared without a value, and what a function gives back: ``out``, outputs of ``main``, the
end of a function without ``return``. Lines stay; columns do not, so that a text which a driver refuses is
compiled again as it was, and its errors name the author's places.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Sequence
from dataclasses import replace
from functools import cached_property
from itertools import pairwise

from playground.memo import TEXTS
from playground.shader.syntax.nodes import (
    Block,
    Case,
    Declaration,
    Declarator,
    Function,
    InterfaceBlock,
    Jump,
    Node,
    Struct,
    Switch,
    Type,
    walk,
)
from playground.shader.syntax.preprocessor import value_of
from playground.shader.syntax.symbols import Symbols, readings
from playground.shader.syntax.tokens import with_edits
from playground.shader.syntax.types import is_built_in
from playground.shader.wrap import Wrapped

_MAX_WRITTEN = 64  # elements of an array that are written out; more are set by a loop
_MAX_WRITTEN_AT_ALL = 4096  # where no loop can stand
_MAX_MEMBERS = 256  # of a struct, those of its members too
_MAX_DEPTH = 16  # of constants that name constants
_OUTSIDE = frozenset("const in inout uniform varying attribute buffer shared".split())
_SCALARS = {"float": "0.0", "int": "0", "uint": "0u", "bool": "false"}
_INDEX = "k_z"

_Arrays = Sequence[Node | None]


def with_zeros(wrapped: Wrapped) -> Wrapped:
    """Return a wrapped text in whose author's stages nothing is read before it is set."""
    return replace(
        wrapped,
        stages={
            name: replace(stage, text=zeroed(stage.text)) if stage.first else stage
            for name, stage in wrapped.stages.items()
        },
    )


@TEXTS.cached()
def zeroed(text: str) -> str:
    """Return a stage's text with its variables beginning at 0, as many lines."""
    edits: dict[tuple[int, int], str] = {}
    for symbols in readings(text):
        if not symbols.tree.errors:
            for place, new in _Zeros(symbols).edits():
                edits.setdefault(place, new)
    return with_edits(text, edits)


class _Zeros:
    """What is inserted into one reading of a text."""

    def __init__(self, symbols: Symbols) -> None:
        self.symbols = symbols
        self.tree = symbols.tree
        self.tokens = symbols.tree.tokens
        self.behind: dict[int, str] = {}  # index of a token → what is inserted behind it
        self._members: dict[Struct, int] = {}

    def edits(self) -> Iterator[tuple[tuple[int, int], str]]:
        """Yield the span of what is replaced, and by what."""
        nodes = list(walk(*self.tree.declarations))
        followed = {one for node in nodes if isinstance(node, Block) for one in node.statements}
        members = {one for node in nodes if isinstance(node, Struct | InterfaceBlock) for one in node.members}
        globals_, outside = "", set(self.tree.declarations)
        for node in nodes:
            if isinstance(node, Declaration) and node not in members:
                for one in node.names:
                    is_global = node in outside
                    globals_ += self._begin(node, one, is_global=is_global, may_follow=node in followed)
            elif isinstance(node, InterfaceBlock) and "out" in node.qualifiers:
                for member in node.members:
                    for one in member.names:
                        target = f"{node.instance}.{one.name}" if node.instance else one.name
                        arrays = (*one.arrays, *member.type.arrays)
                        globals_ += self._statements(target, member.type, arrays)
            elif isinstance(node, Switch):
                self._enter_cases(node)
        for node in self.tree.declarations:
            if isinstance(node, Function) and node.body is not None:
                self._frame(node, node.body, globals_ if node.name == "main" else "")
        calls: set[int] = set()
        for index, new in self.behind.items():
            token = self.tokens[index]
            if self._goes_on(index):
                calls.add(token.start)
            else:
                yield (token.end, token.end), new
        yield from self._written_out(calls)

    def _enter_cases(self, node: Switch) -> None:
        """Set what is declared above a label that is only jumped to, and read below it."""
        declared: list[Declaration] = []
        before: Node | None = None  # the statement above, labels apart
        for statement in node.body.statements:
            if isinstance(statement, Declaration):
                declared.append(statement)
            if not isinstance(statement, Case):
                before = statement
            elif isinstance(before, Jump):
                for declaration in declared:
                    for one in declaration.names:
                        is_read = self._last_use.get(one.at, -1) > statement.last
                        if is_read and not _OUTSIDE.intersection(declaration.type.qualifiers):
                            arrays = (*one.arrays, *declaration.type.arrays)
                            new = self._statements(one.name, declaration.type, arrays)
                            self._insert(statement.last - 1, new)

    @cached_property
    def _last_use(self) -> dict[int, int]:
        """The last token that names a symbol, by the token of its declaration."""
        uses: dict[int, int] = {}
        for one in self.symbols.references:
            if one.symbol is not None:
                uses[one.symbol.token] = max(uses.get(one.symbol.token, -1), one.token)
        return uses

    def _begin(self, node: Declaration, one: Declarator, *, is_global: bool, may_follow: bool) -> str:
        """Insert a variable's value; return the statements that set it at the beginning of ``main``."""
        qualifiers, arrays = set(node.type.qualifiers), (*one.arrays, *node.type.arrays)
        has_type = bool(node.type.name) or node.type.struct is not None
        if one.value is not None or qualifiers & _OUTSIDE or not has_type:
            return ""
        if "out" in qualifiers:
            return self._statements(one.name, node.type, arrays)
        can_loop = is_global or may_follow
        value = self._value(node.type, arrays, _MAX_WRITTEN if can_loop else _MAX_WRITTEN_AT_ALL)
        if value:
            self._insert(one.last - 1, f" = {value}")
        elif is_global:
            return self._statements(one.name, node.type, arrays)
        elif may_follow:
            self._insert(node.last - 1, self._statements(one.name, node.type, arrays))
        return ""

    def _frame(self, function: Function, body: Block, first: str) -> None:
        """Insert what a function begins with, and what it returns at its end."""
        for one in function.parameters:
            if one.name and "out" in one.type.qualifiers:
                first += self._statements(one.name, one.type, (*one.arrays, *one.type.arrays))
        if first:
            self._insert(body.first, first)
        returns = any(isinstance(node, Jump) and node.value is not None for node in walk(body))
        last = body.statements[-1] if body.statements else None
        if returns and not (isinstance(last, Jump) and last.word == "return"):
            value = self._value(function.type, function.type.arrays, _MAX_WRITTEN_AT_ALL)
            if value:
                self._insert(body.last - 2, f" return {value};")

    def _insert(self, index: int, new: str) -> None:
        self.behind[index] = f"{self.behind.get(index, '')}{new}"

    # ── zeros ────────────────────────────────────────────────────────────────

    def _value(self, of_type: Type, arrays: _Arrays, most: int) -> str:
        """Return the expression of a type's zero; "" where there is none, or a longer one than wanted."""
        if arrays:
            count, inner = self._count(arrays[0]), arrays[1:]
            if count is None or not 0 < count <= most:
                return ""
            value = self._value(of_type, inner, most // count)
            brackets = "".join(f"[{self._text(size)}]" for size in inner)
            return f"{of_type.name}[{count}]{brackets}({', '.join([value] * count)})" if value else ""
        if is_built_in(of_type.name):  # samplers and images have no value
            return _SCALARS.get(of_type.name, f"{of_type.name}(0)")
        values = [self._value(kind, sizes, most) for _, kind, sizes in self._members_of(of_type)]
        return f"{of_type.name}({', '.join(values)})" if of_type.name and values and all(values) else ""

    def _statements(self, target: str, of_type: Type, arrays: _Arrays, depth: int = 0) -> str:
        """Return the statements that set a place to zero."""
        value = self._value(of_type, arrays, _MAX_WRITTEN)
        if value:
            return f" {target} = {value};"
        if arrays:
            index = f"{_INDEX}{depth}"
            inner = self._statements(f"{target}[{index}]", of_type, arrays[1:], depth + 1)
            head = f" for (int {index} = 0; {index} < {target}.length(); ++{index})"
            return f"{head} {{{inner} }}" if inner else ""
        members = self._members_of(of_type)
        return "".join(
            self._statements(f"{target}.{name}", kind, sizes, depth) for name, kind, sizes in members
        )

    def _members_of(self, of_type: Type) -> list[tuple[str, Type, _Arrays]]:
        """Return a struct's members with their types; none of anything else, or of one with too many."""
        struct = self._struct(of_type)
        if struct is None or self._member_count(struct) > _MAX_MEMBERS:
            return []
        return [
            (one.name, member.type, (*one.arrays, *member.type.arrays))
            for member in struct.members
            for one in member.names
        ]

    def _struct(self, of_type: Type) -> Struct | None:
        symbol = self.symbols.symbol_at.get(of_type.at)
        node = of_type.struct or (symbol.node if symbol is not None else None)
        return node if isinstance(node, Struct) else None

    def _member_count(self, struct: Struct) -> int:
        """Return how many members a struct has, and they have in turn; an array counts once."""
        if struct not in self._members:
            self._members[struct] = 0
            for member in struct.members:
                inner = self._struct(member.type)
                count = 1 + (self._member_count(inner) if inner is not None else 0)
                self._members[struct] += count * len(member.names)
        return self._members[struct]

    def _count(self, size: Node | None) -> int | None:
        """Return an array's size; None where it cannot be worked out."""
        text = "" if size is None else self._number(size, 0)
        return value_of(text) if text else None

    def _number(self, node: Node, depth: int) -> str:
        """Return an expression with the constants that it names written out; "" where it names others."""
        texts = []
        for index in range(node.first, node.last):
            token = self.tokens[index]
            text = token.text.rstrip("uU")
            if token.kind == "word":
                symbol = self.symbols.symbol_at.get(index)
                value = (
                    symbol.node.value if symbol is not None and isinstance(symbol.node, Declarator) else None
                )
                is_known = (
                    symbol is not None and "const" in symbol.qualifiers and symbol.type in ("int", "uint")
                )
                text = self._number(value, depth + 1) if value and is_known and depth < _MAX_DEPTH else ""
                if not text:
                    return ""
                text = f"({text})"
            texts.append(text)
        return " ".join(texts)

    def _text(self, node: Node | None) -> str:
        return "" if node is None else "".join(token.text for token in self.tokens[node.first : node.last])

    # ── macros ───────────────────────────────────────────────────────────────

    def _goes_on(self, index: int) -> bool:
        """Return whether a token and the next one stand for the same call of a macro."""
        token = self.tokens[index]
        return bool(token.macros) and any(
            following.start == token.start for following in self.tokens[index + 1 : index + 2]
        )

    def _written_out(self, calls: Collection[int]) -> Iterator[tuple[tuple[int, int], str]]:
        """Yield the calls of macros within which something is inserted, expanded; ``calls`` are their places.

        Within one, a macro that names itself is written as its name. What takes arguments and names itself,
        or is on several lines, stays as it is.
        """
        texts: dict[int, list[int]] = {}
        for index, token in enumerate(self.tokens):
            if token.start in calls:
                texts.setdefault(token.start, []).append(index)
        for start, indices in texts.items():
            tokens = [self.tokens[index] for index in indices]
            again = frozenset(token.text for token in tokens if token.text in token.macros)
            parts, name = list[str](), ""
            for index, token in zip(indices, tokens, strict=True):
                inside = min(token.macros & again, default="")
                if not inside or inside != name:
                    parts.append(inside or token.text)
                name = inside
                if self._goes_on(index):
                    parts[-1] += self.behind.get(index, "")
            end, of_all = tokens[0].end, frozenset.intersection(*(token.macros for token in tokens))
            takes = any(one.text in again and two.text == "(" for one, two in pairwise(tokens))
            if not takes and not again & of_all and "\n" not in self.tree.text[start:end]:
                yield (start, end), " ".join(parts)
