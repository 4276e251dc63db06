"""Evaluate integer expressions of a sketch safely: sizes, repeats, visits, accepted sizes.

An expression is read as Python's grammar and walked; nothing is ever handed to
``eval``. There are + - * / // % **, comparisons, ``a if b else c``, and the
functions ``log2`` (exact), ``min``, ``max``, ``abs``, ``floor``, ``ceil``. Names may be
dotted (``size.x``, ``height.size.y``); the caller says what they stand for.
"""

from __future__ import annotations

import ast
import math
import operator
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import lru_cache

from playground.errors import nearest

Number = int | float | Fraction
_LIMIT = 2**62


class ExpressionError(ValueError):
    """An expression is wrong; the caller adds where it stands."""


def evaluate(text: str, names: Mapping[str, Number] | Callable[[str], Number]) -> int:
    """Return the integer that ``text`` stands for.

    ``names`` maps a dotted name to its number, or is a function that does so and
    raises ``KeyError``. Raises ``ExpressionError`` in a sentence.
    """
    look_up = names if callable(names) else names.__getitem__
    known: tuple[str, ...] = () if callable(names) else tuple(names)
    value = _walk(_parse(text), text, look_up, known)
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, Fraction) and value.denominator == 1:
        value = value.numerator
    if isinstance(value, bool) or not isinstance(value, int):
        raise ExpressionError(f"'{text}' gives {float(value):g}; a whole number was expected")
    return value


def evaluate_pair(text: str, names: Mapping[str, Number] | Callable[[str], Number]) -> tuple[int, int]:
    """Return the two integers of ``"w, h"``."""
    parts = text.split(",")
    if len(parts) != 2:
        raise ExpressionError(f"'{text}' should be two expressions parted by a comma")
    return evaluate(parts[0], names), evaluate(parts[1], names)


def names_in(text: str) -> frozenset[str]:
    """Return the dotted names that an expression reads."""
    found: set[str] = set()

    def visit(node: ast.AST) -> None:
        if isinstance(node, ast.Name | ast.Attribute):
            found.add(_dotted(node, text))
        elif isinstance(node, ast.Call):
            for argument in node.args:
                visit(argument)
        else:
            for child in ast.iter_child_nodes(node):
                visit(child)

    for part in text.split(",") if "(" not in text else [text]:
        visit(_parse(part))
    return frozenset(found)


def accepted_sizes(accepts: str, limit: int = 65_537) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """List the sizes that ``accepts`` allows along x and along y, smallest first.

    ``"2**n + 1"`` allows square sizes; ``"2**n, 2**m"`` allows each axis its own.
    """
    parts = [part.strip() for part in accepts.split(",")]
    if len(parts) > 2:
        raise ExpressionError(f"'{accepts}' should be one expression of n, or two of n and m")
    axes = [_values(part, "n" if index == 0 else "m", limit) for index, part in enumerate(parts)]
    return axes[0], axes[-1]


def is_accepted(accepts: str, size: tuple[int, int]) -> bool:
    """Say whether a size is one of those that ``accepts`` allows."""
    xs, ys = accepted_sizes(accepts, max(*size, 2))
    if "," not in accepts and size[0] != size[1]:
        return False
    return size[0] in xs and size[1] in ys


def nearest_accepted(accepts: str, size: tuple[int, int]) -> tuple[tuple[int, int], ...]:
    """Return the accepted sizes just below and just above ``size`` (one of them where it has no other)."""
    xs, ys = accepted_sizes(accepts)
    if "," not in accepts:
        size = (max(size), max(size))
    below = tuple(max((v for v in axis if v <= s), default=axis[0]) for axis, s in zip((xs, ys), size, strict=True))
    above = tuple(min((v for v in axis if v >= s), default=axis[-1]) for axis, s in zip((xs, ys), size, strict=True))
    return tuple(dict.fromkeys([(below[0], below[1]), (above[0], above[1])]))


@lru_cache(maxsize=256)
def _values(text: str, variable: str, limit: int) -> tuple[int, ...]:
    found: list[int] = []
    for n in range(64):
        value = evaluate(text, {variable: n})
        if value > limit:
            break
        if value >= 1 and value not in found:
            found.append(value)
    if not found:
        raise ExpressionError(f"'{text}' allows no size")
    return tuple(found)


@lru_cache(maxsize=1024)
def _parse(text: str) -> ast.expr:
    if len(text) > 500:
        raise ExpressionError("an expression may not be longer than 500 characters")
    try:
        return ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(f"'{text}' is not an expression") from None


def _dotted(node: ast.expr, text: str) -> str:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{_dotted(node.value, text)}.{node.attr}"
    raise ExpressionError(f"'{text}' names something that is neither a parameter nor a size")


def _power(base: Number, exponent: Number) -> Number:
    if not isinstance(exponent, int) or abs(exponent) > 62 or abs(base) > 2**31:
        raise ExpressionError("a power may not be that large")
    return Fraction(base) ** exponent if exponent < 0 and isinstance(base, int) else base**exponent


def _divide(a: Number, b: Number) -> Number:
    if b == 0:
        raise ExpressionError("division by zero")
    return Fraction(a, b) if isinstance(a, int) and isinstance(b, int) else a / b


def _floor_divide(a: Number, b: Number) -> Number:
    if b == 0:
        raise ExpressionError("division by zero")
    return a // b


def _modulo(a: Number, b: Number) -> Number:
    if b == 0:
        raise ExpressionError("division by zero")
    return a % b


def _log2(value: Number) -> int:
    whole = int(value)
    if whole != value or whole < 1 or whole & (whole - 1):
        raise ExpressionError(f"log2({float(value):g}) is not whole: a power of two was expected")
    return whole.bit_length() - 1


_BINARY: dict[type[ast.operator], Callable[[Number, Number], Number]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: _divide,
    ast.FloorDiv: _floor_divide,
    ast.Mod: _modulo,
    ast.Pow: _power,
}
_COMPARE: dict[type[ast.cmpop], Callable[[Number, Number], bool]] = {
    ast.Lt: operator.lt,
    ast.LtE: operator.le,
    ast.Gt: operator.gt,
    ast.GtE: operator.ge,
    ast.Eq: operator.eq,
    ast.NotEq: operator.ne,
}
_FUNCTIONS: dict[str, Callable[..., Number]] = {
    "log2": _log2,
    "min": min,
    "max": max,
    "abs": abs,
    "floor": math.floor,
    "ceil": math.ceil,
}


def _walk(node: ast.expr, text: str, look_up: Callable[[str], Number], known: tuple[str, ...]) -> Number:
    def go(inner: ast.expr) -> Number:
        return _walk(inner, text, look_up, known)

    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        value: Number = node.value
    elif isinstance(node, ast.Name | ast.Attribute):
        name = _dotted(node, text)
        try:
            value = look_up(name)
        except KeyError:
            raise ExpressionError(f"'{text}' names '{name}', which is not known here{nearest(name, known)}") from None
    elif isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        value = _BINARY[type(node.op)](go(node.left), go(node.right))
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        value = -go(node.operand)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.UAdd):
        value = go(node.operand)
    elif isinstance(node, ast.IfExp):
        value = go(node.body) if go(node.test) else go(node.orelse)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in _COMPARE:
        value = int(_COMPARE[type(node.ops[0])](go(node.left), go(node.comparators[0])))
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id not in _FUNCTIONS:
            raise ExpressionError(f"'{text}' calls '{node.func.id}'{nearest(node.func.id, _FUNCTIONS)}")
        arguments = [go(argument) for argument in node.args]
        try:
            value = _FUNCTIONS[node.func.id](*arguments)
        except (TypeError, OverflowError):
            raise ExpressionError(f"'{text}' calls '{node.func.id}' with the wrong number of values") from None
    else:
        raise ExpressionError(f"'{text}' holds something other than numbers, names, + - * / // % ** and log2()")
    if abs(value) > _LIMIT:
        raise ExpressionError(f"'{text}' grows beyond 2**62")
    return value
