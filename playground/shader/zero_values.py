"""Initialise the variables of other tools' shaders to 0, as WebGL does: OpenGL leaves them undefined.

That is what is declared without a value, and what a function gives back: ``out``, outputs of ``main``, the
end of a function without ``return``. Lines stay; columns do not, so that a text which a driver refuses is
compiled again as it was, and its errors name the author's places.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

from playground.memo import TEXTS
from playground.shader.declarations import BUILT_IN, Declarations, Function, Type, Variable
from playground.shader.syntax.preprocessor import readings
from playground.shader.syntax.tokens import Token
from playground.shader.wrap import Wrapped

_MAX_WRITTEN = 64  # elements of an array that are written out; more are set by a loop
_MAX_WRITTEN_AT_ALL = 4096  # where no loop can stand
_OUTSIDE = frozenset("const in inout uniform varying attribute buffer shared".split())
_SCALARS = {"float": "0.0", "int": "0", "uint": "0u", "bool": "false"}
_INDEX = "k_z"


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
    for tokens in readings(text):
        for place, new in _Zeros(text, tokens).edits():
            edits.setdefault(place, new)
    for (start, end), new in sorted(edits.items(), reverse=True):
        text = f"{text[:start]}{new}{text[end:]}"
    return text


@dataclass
class _Zeros:
    """What is inserted into one reading of a text."""

    text: str
    tokens: tuple[Token, ...]
    behind: dict[int, str] = field(default_factory=dict)  # index of a token → what is inserted behind it

    def edits(self) -> Iterator[tuple[tuple[int, int], str]]:
        """Yield the span of what is replaced, and by what."""
        self.declared = Declarations(self.tokens)
        if not self.declared.is_balanced:
            return
        globals_ = "".join(map(self._begin, self.declared.variables))
        last_uses = {token.text: index for index, token in enumerate(self.tokens)}
        for block, colon in self.declared.entries:  # a jump there passes the declarations above
            for variable in self.declared.variables:
                is_read = variable.block == block and variable.at < colon < last_uses[variable.name]
                if is_read and not variable.qualifiers & _OUTSIDE:
                    self._insert(colon, self._statements(variable.name, variable.type))
        for function in self.declared.functions:
            if function.closes >= 0:
                self._frame(function, globals_ if function.name == "main" else "")
        calls: set[int] = set()
        for index, new in self.behind.items():
            token = self.tokens[index]
            if self._goes_on(index):
                calls.add(token.start)
            else:
                yield (token.end, token.end), new
        yield from self._written_out(calls)

    def _begin(self, variable: Variable) -> str:
        """Insert a variable's value; return the statements that set it at the beginning of ``main``."""
        if variable.has_value or variable.qualifiers & _OUTSIDE:
            return ""
        if "out" in variable.qualifiers:
            return self._statements(variable.name, variable.type)
        can_loop = variable.is_global or variable.may_follow
        value = self._value(variable.type, _MAX_WRITTEN if can_loop else _MAX_WRITTEN_AT_ALL)
        if value:
            self._insert(variable.end, f" = {value}")
        elif variable.is_global:
            return self._statements(variable.name, variable.type)
        elif variable.may_follow:
            self._insert(variable.close, self._statements(variable.name, variable.type))
        return ""

    def _frame(self, function: Function, first: str) -> None:
        """Insert what a function begins with, and what it returns at its end."""
        outs = [
            parameter for parameter in function.parameters if parameter.name and "out" in parameter.qualifiers
        ]
        first += "".join(self._statements(item.name, item.type) for item in outs)
        if first:
            self._insert(function.opens, first)
        is_open = function.returns and self.tokens[function.last].text != "return"
        value = self._value(function.type, _MAX_WRITTEN_AT_ALL) if is_open else ""
        if value:
            self._insert(function.closes - 1, f" return {value};")

    def _insert(self, index: int, new: str) -> None:
        self.behind[index] = f"{self.behind.get(index, '')}{new}"

    def _value(self, type_: Type, most: int) -> str:
        """Return the expression of a type's zero; "" where there is none, or a longer one than wanted."""
        if type_.sizes:
            count = self.declared.count(type_.sizes[0])
            inner = replace(type_, sizes=type_.sizes[1:])
            if count is None or not 0 < count <= most:
                return ""
            value = self._value(inner, most // count)
            brackets = "".join(f"[{''.join(size)}]" for size in inner.sizes)
            return f"{type_.name}[{count}]{brackets}({', '.join([value] * count)})" if value else ""
        if BUILT_IN.fullmatch(type_.name):
            return _SCALARS.get(type_.name, f"{type_.name}(0)")
        values = [self._value(member, most) for _, member in type_.members]
        return f"{type_.name}({', '.join(values)})" if type_.name and values and all(values) else ""

    def _statements(self, target: str, type_: Type, depth: int = 0) -> str:
        """Return the statements that set a place to zero."""
        value = self._value(type_, _MAX_WRITTEN)
        if value:
            return f" {target} = {value};"
        if type_.sizes:
            index = f"{_INDEX}{depth}"
            inner = self._statements(f"{target}[{index}]", replace(type_, sizes=type_.sizes[1:]), depth + 1)
            head = f" for (int {index} = 0; {index} < {target}.length(); ++{index})"
            return f"{head} {{{inner} }}" if inner else ""
        return "".join(self._statements(f"{target}.{name}", member, depth) for name, member in type_.members)

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
            if not takes and not again & of_all and "\n" not in self.text[start:end]:
                yield (start, end), " ".join(parts)
