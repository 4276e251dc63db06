"""Read and write parameter values: from TOML, the command line, Python; to text.

Every value ends as Python's own type for the parameter's GLSL type, checked
against the range its annotation gives.
"""

from __future__ import annotations

import math
import os
import reprlib
import struct
from collections.abc import Callable, Mapping, Sequence

from playground.errors import DataError, ParameterError, nearest
from playground.sketch.colour import parse_hex, to_hex
from playground.sketch.parameter import Parameter, Value, Widget
from playground.sketch.widgets import VECTORS, WIDGETS

_LENGTH = {vector: int(vector[-1]) for vector in VECTORS}
_MAX_DIGITS = 18  # those of 64 bits
_TRUE = {
    "true": True,
    "on": True,
    "yes": True,
    "1": True,
    "false": False,
    "off": False,
    "no": False,
    "0": False,
}


def length_of(glsl_type: str) -> int:
    """Return the number of components of a GLSL type, 1 for a scalar."""
    return _LENGTH.get(glsl_type, 1)


def is_whole(glsl_type: str) -> bool:
    """Return whether a type's components are integers."""
    return glsl_type in ("int", "uint") or glsl_type.startswith(("ivec", "uvec"))


def coerce(parameter: Parameter, given: object, path: str = "") -> Value:
    """Return ``given`` as a value of the parameter.

    Takes numbers, sequences, arrays, ``{azimuth, elevation}``, ``"#rrggbb"`` (sRGB, becomes
    linear), menu names, and text as on the command line (``"135,25"``). Raises
    ``ParameterError`` in one sentence that says what was expected.
    """
    name = path or parameter.name
    kind = parameter.widget.kind
    if hasattr(given, "tolist"):  # a NumPy scalar or array
        given = given.tolist()
    if kind == "file" or parameter.type == "sampler2D":
        if isinstance(given, os.PathLike):
            given = os.fspath(given)
        if isinstance(given, str) and "\0" not in given:
            return given
        raise _wrong(name, given, WIDGETS["file"].expects)
    if kind == "menu":
        return _menu(parameter, given, name)
    if parameter.type == "bool":
        if isinstance(given, bool):
            return given
        if isinstance(given, str) and given.strip().lower() in _TRUE:
            return _TRUE[given.strip().lower()]
        raise _wrong(name, given, WIDGETS["checkbox"].expects)
    if kind == "direction" and isinstance(given, Mapping):
        given = _direction(given, name)
    if kind == "colour" and isinstance(given, str) and given.strip().startswith("#"):
        try:
            given = (*parse_hex(given.strip(), raw=parameter.widget.raw), 1.0)[: length_of(parameter.type)]
        except DataError as error:
            raise ParameterError(f"{name}: {error}") from None
    if isinstance(given, str):
        given = _numbers(given, name, expected(parameter))
    count = length_of(parameter.type)
    if count == 1:
        if isinstance(given, Sequence) and len(given) == 1:
            given = given[0]
        value: Value = _number(parameter, given, name)
    else:
        if not isinstance(given, Sequence) or isinstance(given, str) or len(given) != count:
            raise _wrong(name, given, expected(parameter))
        value = tuple(_number(parameter, item, name) for item in given)
    _check_range(parameter, value, name)
    return value


def expected(parameter: Parameter) -> str:
    """Return in a few words what a parameter takes."""
    widget = parameter.widget
    if widget.choices:
        return "one of " + ", ".join(widget.choices)
    if words := WIDGETS[widget.kind].expects:
        return words
    if widget.kind == "point":
        ranges = [f"from {low:g} to {high:g}" for low, high in map(_ends(widget), range(2))]
        middles = [f"{(low + high) / 2:g}" for low, high in map(_ends(widget), range(2))]
        return f"two numbers {' and '.join(dict.fromkeys(ranges))}, as {','.join(middles)}"
    count = length_of(parameter.type)
    noun = "whole number" if is_whole(parameter.type) else "number"
    what = f"a {noun}" if count == 1 else f"{count} {noun}s, as " + ",".join(["1"] * count)
    if widget.low is not None and widget.high is not None:
        what += f" from {widget.low:g} to {widget.high:g}"
    return what


def _ends(widget: Widget) -> Callable[[int], tuple[float, float]]:
    """Return a function that gives the range of a bounded vector's number."""

    def of(axis: int) -> tuple[float, float]:
        low, high = widget.ends(axis)
        assert low is not None and high is not None
        return low, high

    return of


def write(parameter: Parameter, value: Value) -> str:
    """Return a value as the command line would take it, exactly: ``coerce`` gives it back.

    A colour is written as ``#rrggbb`` where that says the same, else as linear numbers.
    """
    if parameter.widget.kind == "menu" and isinstance(value, int):
        return parameter.widget.choices[value]
    if parameter.widget.kind == "colour" and isinstance(value, tuple):
        raw = parameter.widget.raw
        text = to_hex(value, raw=raw)
        there = (*parse_hex(text, raw=raw), 1.0)[: len(value)]
        if all(math.isclose(a, b, rel_tol=0.0, abs_tol=1e-7) for a, b in zip(there, value, strict=True)):
            return text
    if isinstance(value, tuple):
        return ",".join(map(_digits, value))
    return value if isinstance(value, str) else _digits(value)


def tidied(value: float) -> float:
    """Return the shortest decimal number that a shader cannot tell from it: 0.37 for 0.3700000048."""
    try:
        (single,) = struct.unpack("f", struct.pack("f", value))
    except OverflowError:  # no single-precision number is so large
        return value
    if not math.isfinite(single):
        return value
    decimals = (float(f"{single:.{digits}g}") for digits in range(1, 10))
    return next((d for d in decimals if struct.unpack("f", struct.pack("f", d))[0] == single), single)


def shortest(value: Value) -> Value:
    """Return a value whose numbers with fractions are ``tidied``: what a file is to say of it."""
    if isinstance(value, tuple):
        return tuple(tidied(n) if isinstance(n, float) else n for n in value)
    return tidied(value) if isinstance(value, float) else value


def read_whole(text: str) -> int | None:
    """Return the number that a text of digits is; None for any other text, and for one of too many digits."""
    text = text.strip()
    return int(text) if text.isdecimal() and len(text) <= _MAX_DIGITS else None


def spell(value: object) -> str:
    """Return any value as a message shows it, short."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f"'{value}'" if len(value) <= 80 else f"'{value[:77]}…'"
    try:
        return reprlib.repr(value)
    except ValueError:  # an integer of thousands of digits
        return "a number of thousands of digits"


def _digits(value: float | int | bool) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    short = f"{value:.6g}"
    return short if float(short) == value and abs(value) < 1e6 else repr(value)


def _menu(parameter: Parameter, given: object, name: str) -> int:
    choices = parameter.widget.choices
    if isinstance(given, str):
        given = dict(parameter.widget.renamed).get(given, given)
        if given in choices:
            return choices.index(given)
        raise ParameterError(
            f"{name} = {spell(given)}: expected {expected(parameter)}{_meant(given, choices)}"
        )
    if isinstance(given, float) and given.is_integer():
        given = int(given)
    if isinstance(given, int) and not isinstance(given, bool) and 0 <= given < len(choices):
        return given
    raise _wrong(name, given, expected(parameter))


def _meant(given: str, choices: Sequence[str]) -> str:
    hint = nearest(given, choices)
    return hint if "did you mean" in hint else ""


def _direction(given: Mapping[str, object], name: str) -> list[object]:
    extra = set(given) - {"azimuth", "elevation"}
    if extra or len(given) != 2:
        raise ParameterError(
            f"{name}: expected {{ azimuth, elevation }}, found {{ {', '.join(map(str, given))} }}"
        )
    return [given["azimuth"], given["elevation"]]


def _numbers(text: str, name: str, wanted: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise _wrong(name, text, wanted) from None


def _number(parameter: Parameter, given: object, name: str) -> float | int:
    if isinstance(given, bool) or not isinstance(given, int | float):
        raise _wrong(name, given, expected(parameter))
    if isinstance(given, int) and abs(given) > 2**64:
        raise ParameterError(f"{name} = {spell(given)}: expected {expected(parameter)}")
    if not math.isfinite(given):
        raise ParameterError(f"{name} = {given}: expected a finite number")
    if not is_whole(parameter.type):
        return float(given)
    if given != int(given):
        raise _wrong(name, given, expected(parameter))
    whole = int(given)
    low, high = (0, 2**32 - 1) if parameter.type.startswith("u") else (-(2**31), 2**31 - 1)
    if not low <= whole <= high:
        raise ParameterError(f"{name} = {whole}: expected a whole number from {low} to {high}")
    return whole


def _check_range(parameter: Parameter, value: Value, name: str) -> None:
    widget = parameter.widget
    items: tuple[float | str, ...] = value if isinstance(value, tuple) else (value,)
    if widget.kind == "direction":
        azimuth, elevation = items[0], items[-1]
        if not -90 <= float(elevation) <= 90:
            raise ParameterError(f"{name}: elevation {float(elevation):g} is outside -90 to 90 degrees")
        if not -720 <= float(azimuth) <= 720:
            raise ParameterError(f"{name}: azimuth {float(azimuth):g} is outside -720 to 720 degrees")
        return
    if widget.low is None or widget.high is None:
        return
    for axis, item in enumerate(items):
        low, high = _ends(widget)(axis)
        slack = 1e-6 * max(abs(low), abs(high))
        if isinstance(item, int | float) and not low - slack <= item <= high + slack:
            raise ParameterError(f"{name} = {item:g} is outside its range {low:g} to {high:g}")


def _wrong(name: str, given: object, wanted: str) -> ParameterError:
    return ParameterError(f"{name} = {spell(given)}: expected {wanted}")
