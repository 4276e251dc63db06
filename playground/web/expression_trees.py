"""Write expressions as the page's runtime evaluates them: trees, see ``Expression`` in runtime/schema.js."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from playground.shader.expressions import parsed, split_at_commas
from playground.sketch.model import MAX_SIDE

Tree = Any
"""A number, a name, or a list: an operation and what it is of."""

_EXACT = 2**53

_BINARY: dict[type[ast.operator], str] = {
    ast.Add: "+",
    ast.Sub: "-",
    ast.Mult: "*",
    ast.Div: "/",
    ast.FloorDiv: "//",
    ast.Mod: "%",
    ast.Pow: "**",
}
_COMPARE: dict[type[ast.cmpop], str] = {
    ast.Lt: "<",
    ast.LtE: "<=",
    ast.Gt: ">",
    ast.GtE: ">=",
    ast.Eq: "==",
    ast.NotEq: "!=",
}


def tree(text: str, named: Callable[[str], Tree] = str) -> Tree:
    """Return an expression as a tree, with its text, which messages call it by, unless it is a number.

    ``named`` returns what stands for a dotted name. The expression is one that ``expressions.check``
    lets pass.
    """
    result = _tree(parsed(text), named)
    return result if isinstance(result, int | float) else ["text", text, result]


def accepted(accepts: str) -> list[list[tuple[Tree, int]]]:
    """Return the sizes that a kernel's ``accepts`` allows, as ``Accepted`` of schema.js."""
    numbers = []
    for axis in split_at_commas(accepts):
        forms = [each.partition(" up to ") for each in axis.split(" or ")]
        numbers.append([(tree(form), int(most or MAX_SIDE)) for form, _, most in forms])
    return numbers


def _tree(node: ast.expr, named: Callable[[str], Tree]) -> Tree:
    def go(inner: ast.expr) -> Tree:
        return _tree(inner, named)

    match node:
        case ast.Constant(value=float(number)) if number.is_integer():
            return ["float", number]
        case ast.Constant(value=int(number)) if number > _EXACT:  # JavaScript reads a float
            return ["+", ["*", number // _EXACT, _EXACT], number % _EXACT]
        case ast.Constant(value=number):
            return number
        case ast.Name() | ast.Attribute():
            return named(ast.unparse(node))
        case ast.BinOp(left=left, op=op, right=right):
            return [_BINARY[type(op)], go(left), go(right)]
        case ast.UnaryOp(op=op, operand=operand):
            return ["*", go(operand), -1 if isinstance(op, ast.USub) else 1]
        case ast.IfExp(test=test, body=body, orelse=otherwise):
            return ["if", go(test), go(body), go(otherwise)]
        case ast.Compare(left=left, ops=[op], comparators=[right]):
            return [_COMPARE[type(op)], go(left), go(right)]
        case ast.Call(func=ast.Name(id=name), args=arguments):
            return [name, *map(go, arguments)]
    raise AssertionError(f"expressions.check() lets no {type(node).__name__} pass")
