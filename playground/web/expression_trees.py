"""Write an expression of a sketch as a tree that needs no parser: see ``Expression`` in schema.js.

The grammar is that of ``sketch/expressions.py``; names become what they stand for, whatever the
technique calls it: ``height.size.x`` is the size of a pass by its whole path.
"""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from playground.errors import SketchError
from playground.sketch import named_numbers
from playground.sketch.expressions import alternatives, dotted_name, parsed, parts_of
from playground.sketch.flat import Flat
from playground.sketch.model import PassSpec

Tree = Any
"""A number, a name, or a list of an operation and its arguments."""

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


def tree(text: str, name: Callable[[str], Tree]) -> Tree:
    """Return the tree of an expression, with its author's words; ``name`` says what a name becomes."""
    found = _tree(parsed(text), text, name)
    return ["text", text, found] if isinstance(found, list) else found


def header_tree(text: str) -> Tree:
    """Return the tree of an expression in a kernel's header: its names are the kernel's own."""
    return tree(text, lambda name: name)


def pass_tree(text: str, flat: Flat, path: str, spec: PassSpec) -> Tree:
    """Return the tree of a size or a repeat of the pass at a path of a flat sketch."""
    prefix = path.rpartition(".")[0]

    def name(word: str) -> Tree:
        kind, where, axis = named_numbers.named(flat, prefix, spec, word)
        if kind == named_numbers.CLOCK:
            return where
        if kind == named_numbers.COMPUTE:
            return 0
        where = flat.shape.copied.get(where, where)
        if kind == named_numbers.VALUE:
            return ["value", where]
        return ["size" if kind == named_numbers.SIZE else "picture", where, axis]

    try:
        return tree(text, name)
    except KeyError as error:
        raise spec.error(
            f"pass '{spec.name}': '{text}' names '{error.args[0]}', which is not known"
        ) from None


def accepted_trees(accepts: str) -> list[list[list[Tree]]]:
    """Return the sizes that a kernel takes as expressions of n, or m along y: see ``Accepted``."""
    return [
        [[tree(text, lambda name: name), most] for text, most in alternatives(part)]
        for part in parts_of(accepts)
    ]


def _tree(node: ast.expr, text: str, name: Callable[[str], Tree]) -> Tree:
    def go(inner: ast.expr) -> Tree:
        return _tree(inner, text, name)

    match node:
        case ast.Constant(value=int() as whole):
            return whole
        case ast.Constant(value=float() as number):
            return ["float", int(number)] if number.is_integer() else number
        case ast.Name() | ast.Attribute():
            return name(dotted_name(node, text))
        case ast.BinOp(op=operator) if type(operator) in _BINARY:
            return [_BINARY[type(operator)], go(node.left), go(node.right)]
        case ast.UnaryOp(op=ast.USub()):
            return ["*", go(node.operand), -1]
        case ast.UnaryOp(op=ast.UAdd()):
            return go(node.operand)
        case ast.IfExp():
            return ["if", go(node.test), go(node.body), go(node.orelse)]
        case ast.Compare(ops=[operator]) if type(operator) in _COMPARE:
            return [_COMPARE[type(operator)], go(node.left), go(node.comparators[0])]
        case ast.Call(func=ast.Name(id=function)):
            return [function, *map(go, node.args)]
    raise SketchError(f"'{text}' holds something that is no expression")
