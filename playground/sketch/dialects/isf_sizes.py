"""Translate the sizes of ISF's passes, as ``floor($WIDTH / 4.0)``, into expressions of a sketch."""

from __future__ import annotations

import ast
import re
from collections.abc import Mapping

from playground.errors import nearest
from playground.sketch import expressions
from playground.sketch.expressions import LONGEST, ExpressionError
from playground.sketch.values import spell

_NAME = re.compile(r"\$([A-Za-z_]\w*)")
_SIZES = {"WIDTH": "size.x", "HEIGHT": "size.y"}
_ELSEWHERE = ("time", "frames", "compute", "size")
"""Names that mean something else in an expression of a sketch."""

_SAME = ("min", "max", "abs", "floor", "ceil")
_TRANSLATED = {
    "round": (1, "floor({0} + 0.5)"),
    "trunc": (1, "(floor({0}) if {0} >= 0 else ceil({0}))"),
    "mod": (2, "({0} % {1})"),
    "pow": (2, "({0} ** {1})"),
    "clamp": (3, "max({1}, min({2}, {0}))"),
}
"""Functions with the number of their values, and what they are here."""


def translated(text: object, names: Mapping[str, str]) -> str:
    """Return a size in texels, at least 1, as an expression.

    ``names`` are the inputs that are numbers, with what they are called here. Raises
    ``ExpressionError`` in a sentence for what cannot be one.
    """
    if isinstance(text, bool) or not isinstance(text, str | int | float):
        raise ExpressionError(f'{text!r} is no size; expected a number or a text, as "$WIDTH / 2"')
    written = str(text).strip()

    def name(found: re.Match[str]) -> str:
        word = found.group(1)
        if word not in _SIZES and (word not in names or names[word] in _ELSEWHERE):
            valid = [f"${known}" for known in (*_SIZES, *names)]
            raise ExpressionError(
                f"'{written}' names '{found.group()}', which is not known here{nearest(found.group(), valid)}"
            )
        return _SIZES.get(word) or names[word]

    plain = _NAME.sub(name, written)
    if len(plain) > LONGEST:
        raise ExpressionError(f"{spell(written)} is longer than {LONGEST} characters")
    try:
        tree = ast.parse(plain, mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(f"'{written}' is not an expression") from None
    whole = f"max(1, floor({_text(tree, written)}))"
    try:
        expressions.check(whole, ("size.x", "size.y", *names.values()))
    except ExpressionError as error:
        reason = str(error).removeprefix(f"'{whole}' ")
        for word, here in _SIZES.items():
            reason = reason.replace(here, f"${word}")
        raise ExpressionError(f"'{written}' {reason}") from None
    return whole


def _text(tree: ast.expr, written: str) -> str:
    """Return an expression with the functions of a sketch in place of ISF's."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            called = node.func.id
            if called not in _SAME and called not in _TRANSLATED:
                hint = nearest(called, [*_SAME, *_TRANSLATED])
                raise ExpressionError(f"'{written}' calls '{called}'{hint}")
    return ast.unparse(_Calls(written).visit(tree))


class _Calls(ast.NodeTransformer):
    """Replaces the calls of functions that a sketch has not."""

    def __init__(self, written: str) -> None:
        self.written = written

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.func, ast.Name) or node.func.id in _SAME:
            return node
        count, form = _TRANSLATED[node.func.id]
        if len(node.args) != count or node.keywords:
            raise ExpressionError(f"'{self.written}' calls '{node.func.id}' with the wrong number of values")
        values = [f"({ast.unparse(argument)})" for argument in node.args]
        return ast.parse(form.format(*values), mode="eval").body
