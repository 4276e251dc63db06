"""Evaluate expressions safely: a sketch's sizes, repeats, visits, accepted sizes; numbers that are typed.

An expression is parsed by Python's grammar, and its tree is evaluated here, never by
``eval``. There are + - * / // % **, comparisons, ``a if b else c``, and the
functions ``log2`` (exact), ``bits`` (binary digits), ``min``, ``max``, ``abs``, ``floor``,
``ceil``. Names may be dotted (``size.x``, ``height.size.y``); the caller gives their values.
Whole numbers are divided exactly: ``3 * (n / 3)`` is n.
"""

from __future__ import annotations

import ast
import math
import operator
import warnings
from collections.abc import Callable, Collection, Mapping
from fractions import Fraction
from typing import cast

from playground.errors import nearest
from playground.memo import TEXTS
from playground.shader.parameter import MAX_SIDE

Number = int | float | Fraction
_LIMIT = 2**62
MAX_LETTERS = 500
FRAME_RATE = 60  # frames of a sketch's state in a second
CLOCKS = ("time", "frames")
"""Names that follow the time: seconds, and the frames that are to run: see ``frames_at``."""
ITERATION, ITERATIONS = COUNTERS = "iteration", "iterations"
"""Names that are a loop's: its step, from 0, and its steps in all."""
_MAX_DEPTH = 100
TWO_FRAMES = "is the number of frames at a time; give the parameter of that name another one"


class ExpressionError(ValueError):
    """An expression is wrong; the caller adds its place."""


def evaluate(text: str, names: Mapping[str, Number] | Callable[[str], Number]) -> int:
    """Evaluate an expression to an integer.

    ``names`` maps a dotted name to its number, or is a function that does so and
    raises ``KeyError``. Raises ``ExpressionError``.
    """
    if callable(names):
        return _evaluated(text, names, ())
    names_and_values = [(name, type(names[name]), names[name]) for name in _names(text) if name in names]
    if len(names_and_values) < len(_names(text)):
        return _evaluated(text, names.__getitem__, tuple(names))
    return _cached(text, tuple(names_and_values))


@TEXTS.cached()
def _cached(text: str, names_and_values: tuple[tuple[str, type, Number], ...]) -> int:
    """Evaluate once for the same names: steps repeat them. Types count: 1 is not 1.0 in 1 / 3."""
    return _evaluated(text, {name: number for name, _, number in names_and_values}.__getitem__, ())


@TEXTS.cached()
def _names(text: str) -> tuple[str, ...]:
    return tuple(sorted(names_in(text)))


def _evaluated(text: str, look_up: Callable[[str], Number], valid: tuple[str, ...]) -> int:
    value = _value_of(parsed(text), text, look_up, valid)
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if not isinstance(value, int):
        raise ExpressionError(f"'{text}' gives {float(value):g}; a whole number was expected")
    return int(value)


def evaluate_number(text: str, names: Mapping[str, Number]) -> float:
    """Evaluate an expression to a number, whole or not. Raises ``ExpressionError``."""
    return float(_value_of(parsed(text), text, names.__getitem__, tuple(names)))


def evaluate_numbers(text: str, names: Mapping[str, Number]) -> list[float]:
    """Return the numbers of expressions separated by commas. Raises ``ExpressionError``."""
    return [evaluate_number(part, names) for part in split_at_commas(text)]


def evaluate_pair(text: str, names: Mapping[str, Number] | Callable[[str], Number]) -> tuple[int, int]:
    """Evaluate the two integers of ``"w, h"``."""
    parts = split_at_commas(text)
    if len(parts) != 2:
        raise ExpressionError(f"'{text}' should be two expressions separated by a comma")
    return evaluate(parts[0], names), evaluate(parts[1], names)


def check(text: str, valid: Collection[str], *, count: int = 1) -> None:
    """Raise ``ExpressionError`` where ``text`` is not ``count`` expressions of the names ``valid``."""
    parts = split_at_commas(text)
    if len(parts) != count:
        what = "one expression" if count == 1 else f"{count} expressions separated by a comma"
        raise ExpressionError(f"'{text}' should be {what}")
    for part in parts:
        _value_of(parsed(part), part, dict.fromkeys(valid, 1).__getitem__, tuple(valid), dry=True)


def names_in(text: str) -> frozenset[str]:
    """Return the dotted names that an expression, or several separated by commas, reads."""
    names: set[str] = set()

    def look_up(name: str) -> int:
        names.add(name)
        return 1

    for part in split_at_commas(text):
        _value_of(parsed(part), part, look_up, (), dry=True)
    return frozenset(names)


@TEXTS.cached()
def follows_time(text: str) -> bool:
    """Return whether an expression, or "", names the time or the frames."""
    return bool(text) and not names_in(text).isdisjoint(CLOCKS)


@TEXTS.cached()
def counts_frames(text: str) -> bool:
    """Return whether an expression, or "", names the frames: its iteration n is at n / 60 seconds."""
    return bool(text) and "frames" in names_in(text)


def frames_at(time: float) -> int:
    """Return ``frames``: how many frames have run at a time [s], that of second 0 included."""
    return last_frame_at(time) + 1


def last_frame_at(time: float) -> int:
    """Return the number of the frame that shows at a time [s], from 0."""
    return math.floor(FRAME_RATE * time + 1e-6)  # n / 60 is frame n, however it was rounded


def accepted_sizes(accepts: str, limit: int = MAX_SIDE) -> tuple[tuple[int, ...], tuple[int, ...]]:
    """List the sizes up to ``limit`` that ``accepts`` allows along x and along y, smallest first.

    ``"2**n + 1"`` allows square sizes; ``"2**n, 2**m"`` allows each axis its own. The
    values must grow with n, which goes from 0 up. ``"2**n or 2**n + 1"`` allows either, and
    ``"n up to 4097"`` none above.
    """
    parts = split_at_commas(accepts)
    if len(parts) > 2:
        raise ExpressionError(f"'{accepts}' should be one expression of n, or two of n and m")
    axes = [_either(part, "n" if index == 0 else "m", limit) for index, part in enumerate(parts)]
    return axes[0], axes[-1]


def is_accepted(accepts: str, size: tuple[int, int]) -> bool:
    """Return whether a size is one of those that ``accepts`` allows."""
    xs, ys = accepted_sizes(accepts)
    if len(split_at_commas(accepts)) == 1 and size[0] != size[1]:
        return False
    return size[0] in xs and size[1] in ys


def nearest_accepted(accepts: str, size: tuple[int, int]) -> tuple[tuple[int, int], ...]:
    """Return the accepted sizes just below and just above ``size`` (one of them where it has no other)."""
    xs, ys = accepted_sizes(accepts)
    if len(split_at_commas(accepts)) == 1:
        size = (max(size), max(size))
    axes = list(zip((xs, ys), size, strict=True))
    below = tuple(max((v for v in axis if v <= s), default=axis[0]) for axis, s in axes)
    above = tuple(min((v for v in axis if v >= s), default=axis[-1]) for axis, s in axes)
    return tuple(dict.fromkeys([(below[0], below[1]), (above[0], above[1])]))


@TEXTS.cached()
def split_at_commas(text: str) -> tuple[str, ...]:
    """Split expressions at the commas that are in no bracket."""
    parts: list[str] = []
    depth, start = 0, 0
    for index, letter in enumerate(text):
        depth += {"(": 1, ")": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            parts.append(text[start:index].strip())
            start = index + 1
    return (*parts, text[start:].strip())


def _either(text: str, variable: str, limit: int) -> tuple[int, ...]:
    numbers: set[int] = set()
    for part in text.split(" or "):
        expression, _, most = part.partition(" up to ")
        if most and not (most.strip().isdecimal() and len(most) < MAX_LETTERS):
            raise ExpressionError(f"'{part}': expected a whole number after 'up to'")
        numbers.update(_values(expression, variable, min(limit, int(most)) if most else limit))
    return tuple(sorted(numbers))


@TEXTS.cached()
def _values(text: str, variable: str, limit: int) -> tuple[int, ...]:
    check(text, (variable,))
    values: list[int] = []
    for n in range(limit + 1):
        try:
            value = _evaluated(text, {variable: n}.__getitem__, ())  # thousands: none is asked for again
        except ExpressionError:  # not whole for this n, as 2**(n - 1) for 0
            continue
        if value > limit:
            break
        if value >= 1 and value not in values[-1:]:
            values.append(value)
    if not values:
        raise ExpressionError(f"'{text}' allows no size")
    return tuple(sorted(set(values)))


@TEXTS.cached()
def parsed(text: str) -> ast.expr:
    """Parse an expression, which may be no expression of these; raise ``ExpressionError``."""
    if len(text) > MAX_LETTERS:
        raise ExpressionError(f"an expression may not be longer than {MAX_LETTERS} characters")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # "1 if 2else 3" is deprecated: no line on the console for it
            tree = ast.parse(text.strip(), mode="eval").body
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ExpressionError(f"'{text}' is not an expression") from None
    level: list[ast.AST] = [tree]
    for _ in range(_MAX_DEPTH):
        level = [child for node in level for child in ast.iter_child_nodes(node)]
        if not level:
            return tree
    raise ExpressionError(f"'{text}' is nested more than {_MAX_DEPTH} deep")


def _dotted(node: ast.expr, text: str) -> str:
    if isinstance(node, ast.Name):
        return node.id
    if isinstance(node, ast.Attribute):
        return f"{_dotted(node.value, text)}.{node.attr}"
    raise ExpressionError(f"'{text}' names something that is neither a parameter nor a size")


def _power(base: Number, exponent: Number) -> Number:
    result: Number
    if not isinstance(exponent, int):
        raise ExpressionError("the exponent of a power should be a whole number")
    if not -62 <= exponent <= 62 or not -(2**31) <= base <= 2**31:
        raise ExpressionError("a power may not be that large")
    if base == 0 and exponent < 0:
        raise ExpressionError("division by zero")
    try:
        result = Fraction(base) ** exponent if exponent < 0 and isinstance(base, int) else base**exponent
    except OverflowError:
        raise ExpressionError("a power may not be that large") from None
    return result


def _divide(a: Number, b: Number) -> Number:
    return Fraction(a, b) if isinstance(a, int) and isinstance(b, int) else a / b


def _log2(value: Number) -> int:
    whole = int(value)
    if whole != value or whole < 1 or whole & (whole - 1):
        raise ExpressionError(f"log2({float(value):g}) is not whole: a power of two was expected")
    return whole.bit_length() - 1


def _bits(value: Number) -> int:
    whole = int(value)
    if whole != value or whole < 0:
        raise ExpressionError(f"bits({float(value):g}): a whole number from 0 was expected")
    return whole.bit_length()


_BINARY: dict[type[ast.operator], Callable[[Number, Number], Number]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: _divide,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
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
    "bits": _bits,
    "min": min,
    "max": max,
    "abs": abs,
    "floor": math.floor,
    "ceil": math.ceil,
}


def _value_of(
    node: ast.expr, text: str, look_up: Callable[[str], Number], valid: tuple[str, ...], *, dry: bool = False
) -> Number:
    """Return the value of a node; ``dry`` looks at names and kinds only, in both branches of an ``if``."""

    def go(inner: ast.expr) -> Number:
        return _value_of(inner, text, look_up, valid, dry=dry)

    value: Number
    if isinstance(node, ast.Constant) and type(node.value) in (int, float):
        value = cast(Number, node.value)
    elif isinstance(node, ast.Name | ast.Attribute):
        name = _dotted(node, text)
        try:
            value = look_up(name)
        except KeyError:
            message = f"'{text}' names '{name}', which is not known here{nearest(name, valid)}"
            raise ExpressionError(message) from None
    elif isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
        left, right = go(node.left), go(node.right)
        if not dry and right == 0 and isinstance(node.op, ast.Div | ast.FloorDiv | ast.Mod):
            raise ExpressionError("division by zero")
        value = 1 if dry else _BINARY[type(node.op)](left, right)
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.UAdd):
        value = go(node.operand) * (-1 if isinstance(node.op, ast.USub) else 1)
    elif isinstance(node, ast.IfExp):
        test = go(node.test)
        value = go(node.body) if test or dry else go(node.orelse)
        if dry:
            go(node.orelse)
    elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in _COMPARE:
        value = int(_COMPARE[type(node.ops[0])](go(node.left), go(node.comparators[0])))
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        if node.func.id not in _FUNCTIONS:
            raise ExpressionError(f"'{text}' calls '{node.func.id}'{nearest(node.func.id, _FUNCTIONS)}")
        arguments = [go(argument) for argument in node.args]
        try:
            value = _FUNCTIONS[node.func.id](*([1] * len(arguments) if dry else arguments))
        except TypeError:
            message = f"'{text}' calls '{node.func.id}' with the wrong number of values"
            raise ExpressionError(message) from None
    else:
        raise ExpressionError(
            f"'{text}' holds something other than numbers, names, + - * / // % ** and log2()"
        )
    return _checked(value, text)


def _checked(value: Number, text: str) -> Number:
    # A fraction can stay small and grow without end: ((1/3)**62)**62 has thousands of digits.
    if not -_LIMIT <= value <= _LIMIT or (isinstance(value, Fraction) and value.denominator > _LIMIT):
        raise ExpressionError(f"'{text}' grows beyond 2**62")
    return value.numerator if isinstance(value, Fraction) and value.denominator == 1 else value
