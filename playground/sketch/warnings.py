"""Warn of what a sketch's texts say and its picture does not show.

That is a sampler that nothing feeds, a division of whole numbers with a remainder, a ``#line``; and what the
readers of the files noted. ``engine.sketch_warnings`` has those that only a check looks for.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from playground.errors import Diagnostic
from playground.paths import GLSL
from playground.shader import expressions
from playground.shader.expressions import ExpressionError
from playground.shader.header import unfed_samplers
from playground.shader.reserved_names import GIVEN
from playground.shader.source import SourceText
from playground.shader.syntax.nodes import (
    Assign,
    Binary,
    Call,
    Case,
    Conditional,
    Declarator,
    Function,
    Index,
    Jump,
    Literal,
    Node,
    Parameter,
    Parenthesized,
    Switch,
    Type,
    Unary,
    children,
    walk,
)
from playground.shader.syntax.symbols import Symbols, symbols_of
from playground.shader.syntax.types import ExpressionTypes, components
from playground.sketch.model import ForeignShader, Graph, Kernel, PlainShader, Sketch


def unheeded(kernel: Kernel) -> tuple[Diagnostic, ...]:
    """Return what a picture does not show though the text says it: unfed samplers, ``1/4``, ``#line``."""
    is_plain = isinstance(kernel, PlainShader) and not isinstance(kernel, ForeignShader)
    diagnostics = [*(unfed_samplers(kernel.source) if is_plain else ())]
    diagnostics += whole_divisions(kernel.source)
    if isinstance(kernel, ForeignShader) and kernel.vertex_source:
        diagnostics += whole_divisions(kernel.vertex_source)
    diagnostics += [
        line.diagnostic("#line is left out, so that errors name the file's own lines", severity="warning")
        for line in kernel.source.lines
        if line.left_out
    ]
    return tuple(dict.fromkeys(diagnostics))


# ── divisions of whole numbers ───────────────────────────────────────────────

_MAYBE_DIVIDED = re.compile(r"[\d)]\s*/\s*[\d(]")
_MAX_TOKENS = 64  # of a division of literals
_TAKES_WHOLE = frozenset(
    "texelFetch texelFetchOffset textureSize imageLoad imageStore bitfieldExtract".split()
)
_GENERIC = frozenset("abs clamp max min sign".split())  # whole if their arguments are
_ARITHMETIC = frozenset("+ - * / == != < > <= >=".split())
_WHOLE_OPERATORS = frozenset("% << >> & | ^".split())
_GIVEN_TYPES = {**{name: kind for name, (kind, _) in GIVEN.items()}, "texel": "ivec2"}


def whole_divisions(source: SourceText) -> list[Diagnostic]:
    """Return a warning for each division of two whole literals that leaves a remainder, as ``1/4``.

    In GLSL that is a whole number, here 0. Left alone is what is meant so: an index, an array's size, and
    where a whole number is declared, set, compared or handed over.
    """
    if not _MAYBE_DIVIDED.search(source.code):
        return []
    return _Divisions(symbols_of(source.code, all_branches=True)).warnings(source)


class _Divisions:
    """The divisions of a text."""

    def __init__(self, symbols: Symbols) -> None:
        self.symbols = symbols
        self.tree = symbols.tree
        self.types = ExpressionTypes(symbols, _GIVEN_TYPES)
        self.parents: dict[Node, tuple[Node, Function | None]] = {}  # with the function around
        for declaration in self.tree.declarations:
            function = declaration if isinstance(declaration, Function) else None
            for node in walk(declaration):
                self.parents |= {part: (node, function) for part in children(node)}

    def warnings(self, source: SourceText) -> list[Diagnostic]:
        diagnostics: list[Diagnostic] = []
        for node in self.parents:
            if not isinstance(node, Binary) or node.operator != "/":
                continue
            left, right = self._literal(node.left), self._literal(node.right)
            if left is None or not right or left % right == 0 or self._is_meant(node):
                continue
            (number, column), end = map(self.tree.place, self.tree.span(node))
            line = source.lines[number]
            written = line.code[column : end[1]] if end[0] == number else f"{left}/{right}"
            message = (
                f"{written} divides whole numbers, which gives {left // right}; write {left}.0/{right}.0"
            )
            diagnostics.append(line.diagnostic(message, column + 1, "warning"))
        return diagnostics

    def _literal(self, node: Node) -> int | None:
        """Return the value of whole literals, brackets and operators, as GLSL has it of positive numbers."""
        tokens = self.tree.tokens[node.first : node.last]
        if len(tokens) > _MAX_TOKENS or any(token.macros for token in tokens):
            return None
        if not all(token.text.isdecimal() or token.text in "()+*/%-" for token in tokens):
            return None
        text = " ".join("//" if token.text == "/" else token.text for token in tokens)
        try:
            return int(expressions.evaluate(text, {}))
        except ExpressionError:
            return None

    def _is_meant(self, node: Node) -> bool:
        """Return whether a division stands where a whole number is meant."""
        while node in self.parents:
            part, (node, function) = node, self.parents[node]
            match node:
                case Binary() if node.operator in _ARITHMETIC:
                    others = [node.left if part is node.right else node.right]
                case Conditional():
                    others = [one for one in (node.yes, node.no) if one is not part]
                case Call() if node.name in _GENERIC and not self.symbols.callees.get(node):
                    others = [one for one in node.arguments if one is not part]
                case Call():
                    return self._takes_whole(node, part)
                case Assign():
                    return self._is_whole(self.types.of(node.target)[0])
                case Declarator():
                    symbol = self.symbols.symbol_at.get(node.at)
                    return part is not node.value or (symbol is not None and self._is_whole(symbol.type))
                case Jump():
                    return function is not None and self._is_whole(function.type.name)
                case Parenthesized() | Unary():
                    continue
                case Binary():
                    return node.operator in _WHOLE_OPERATORS
                case _:  # an index, a size, a label
                    return isinstance(node, Index | Switch | Case | Type | Parameter)
            named = [one for one in others if not isinstance(one, Literal) or not one.text.isdecimal()]
            named = [one for one in named if self._literal(one) is None]
            if named:
                return all(self._is_whole(self.types.of(one)[0]) for one in named)
        return False

    def _takes_whole(self, call: Call, argument: Node) -> bool:
        """Return whether a call takes a whole number as an argument."""
        index = next((i for i, one in enumerate(call.arguments) if one is argument), -1)
        if index < 0:  # the size of a constructor's array
            return True
        callees = self.symbols.callees.get(call, ())
        chosen = self.types.overload(call)
        for callee in (chosen,) if chosen is not None else callees:
            if isinstance(callee.node, Function) and index < len(callee.node.parameters):
                return self._is_whole(callee.node.parameters[index].type.name)
        return not callees and (call.name in _TAKES_WHOLE or self._is_whole(call.name))

    @staticmethod
    def _is_whole(of_type: str) -> bool:
        return components(of_type)[0] in ("int", "uint")


def warnings_of_sketch(sketch: Sketch) -> tuple[Diagnostic, ...]:
    """Return the warnings of a sketch's file and of its own techniques' files."""
    return tuple(dict.fromkeys([*sketch.warnings, *_of_graph(sketch.graph)]))


def _of_graph(graph: Graph) -> Iterator[Diagnostic]:
    if not Path(graph.path).is_relative_to(GLSL):
        yield from graph.warnings
    for spec in graph.passes:
        if isinstance(spec.technique, Graph):
            yield from _of_graph(spec.technique)
