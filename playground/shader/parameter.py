"""Parameters, and their values read from TOML, the command line, and Python.

``coerce`` makes any value Python's own type for the parameter's GLSL type, checked against the range that
its annotation gives.
"""

from __future__ import annotations

import math
import os
import reprlib
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from playground.errors import DataError, ParameterError, nearest
from playground.shader.colours import parse_hex, to_hex
from playground.shader.widgets import PLAIN, VECTORS, WIDGETS, Value, Widget

MAX_SIDE = 16_384
"""Texels or pixels that a side may have: what common graphics cards take."""


@dataclass(frozen=True, slots=True)
class Sampling:
    """How a texture is read."""

    filter: str = "nearest"  # nearest | linear
    wrap: str = "clamp"  # clamp | repeat | mirror
    mipmap: bool = False
    magnify: str = ""  # how where a texel is larger than a pixel; "": as ``filter``
    flip: bool = False  # an image file's upper row is below
    decode: bool = False  # an image file's colours become linear, where they would stay encoded


AS_IT_IS = Sampling()
"""Texel by texel: what an annotation that says nothing means."""


@dataclass(frozen=True, slots=True)
class Brush:
    """What paints on a file in the window."""

    erode: str = ""  # the technique that it erodes with, as ``use`` names it; "": it does not


@dataclass(frozen=True, slots=True)
class Follows:
    """An angle that takes a direction's azimuth while it has its default."""

    direction: str  # a parameter of the same file
    menu: str = ""  # likewise; "" where it always follows
    choice: int = 0  # of the menu, while it follows


def label_of(name: str) -> str:
    """Return a name as a panel writes it: ``rock_from`` as "Rock from"; one in mixed case as it is."""
    return name.replace("_", " ").capitalize() if name.islower() else name


@dataclass(frozen=True, slots=True)
class Parameter:
    """A uniform with its ``//!`` annotation.

    For example:

        parameter, value = playground.parameters(playground.load("l_dot_n"))["product.sun"]
        print(parameter.title, parameter.type, parameter.default, parameter.unit)
    """

    name: str
    type: str  # GLSL: float int uint bool vec2..4 ivec2..4 uvec2..4, or sampler2D for a file
    default: Value
    widget: Widget = PLAIN
    step: float | None = None
    unit: str = ""
    group: str = ""
    label: str = ""
    tooltip: str = ""
    sampling: Sampling = AS_IT_IS  # of a file
    brush: Brush | None = None  # of a file that may be painted on in the window
    follows: Follows | None = None  # where its value comes from while it is not set
    parts: tuple[str, ...] = ()  # what a vector's components are, one name each; (): x, y, z, w
    file: str = ""
    line: int = 0

    @property
    def title(self) -> str:
        """Return its label in a panel.

        For example:

            parameter, _ = playground.parameters(playground.load("l_dot_n"))["product.sun"]
            assert parameter.title == "Sun"
        """
        return self.label or label_of(self.name)


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


def part_names(parameter: Parameter) -> tuple[str, ...]:
    """Return what the components of a vector are called in a panel; nothing for a scalar or a file."""
    return parameter.parts or components(parameter)


def components(parameter: Parameter) -> tuple[str, ...]:
    """Return the names by which a vector's components are set alone, as x; nothing for a scalar or a file."""
    count = length_of(parameter.type)
    return () if count == 1 else (parameter.widget.facts.parts or ("x", "y", "z", "w"))[:count]


def is_whole(glsl_type: str) -> bool:
    """Return whether a type's components are integers."""
    return glsl_type in ("int", "uint") or glsl_type.startswith(("ivec", "uvec"))


def coerce(parameter: Parameter, value: object, path: str = "") -> Value:
    """Return ``value`` as a value of the parameter.

    Takes numbers, sequences, arrays, ``{azimuth, elevation}``, ``"#rrggbb"`` (sRGB, becomes
    linear), menu names, and text as on the command line (``"135,25"``). Raises
    ``ParameterError`` in one message that says what was expected.
    """
    name = path or parameter.name
    kind = parameter.widget.kind
    if hasattr(value, "tolist"):  # a NumPy scalar or array
        value = value.tolist()
    if kind == "file" or parameter.type == "sampler2D":
        if isinstance(value, os.PathLike):
            value = os.fspath(value)
        if isinstance(value, str) and "\0" not in value:
            return value
        raise _wrong(name, value, WIDGETS["file"].expects)
    if kind == "menu":
        return _menu(parameter, value, name)
    if parameter.type == "bool":
        if isinstance(value, bool):
            return value
        if isinstance(value, str) and value.strip().lower() in _TRUE:
            return _TRUE[value.strip().lower()]
        raise _wrong(name, value, WIDGETS["checkbox"].expects)
    if kind == "direction" and isinstance(value, Mapping):
        value = _direction(value, name)
    if kind == "colour" and isinstance(value, str) and value.strip().startswith("#"):
        try:
            value = (*parse_hex(value.strip(), raw=parameter.widget.raw), 1.0)[: length_of(parameter.type)]
        except DataError as error:
            raise ParameterError(f"{name}: {error}") from None
    if isinstance(value, str):
        value = _numbers(value, name, expected(parameter))
    count = length_of(parameter.type)
    if count == 1:
        if isinstance(value, Sequence) and len(value) == 1:
            value = value[0]
        result: Value = _number(parameter, value, name)
    else:
        if not isinstance(value, Sequence) or isinstance(value, str) or len(value) != count:
            raise _wrong(name, value, expected(parameter))
        result = tuple(_number(parameter, item, name) for item in value)
    _check_range(parameter, result, name)
    return result


def expected(parameter: Parameter, say: Callable[..., str] = str.format) -> str:
    """Return in a few words what a parameter takes; ``say`` fills a template, and may translate it."""
    widget = parameter.widget
    if widget.choices:
        return say("one of {choices}", choices=", ".join(widget.choices))
    if words := widget.facts.expects:
        return say(words)
    if widget.kind == "point":
        ranges = [
            say("from {low} to {high}", low=f"{low:g}", high=f"{high:g}")
            for low, high in map(_ends(widget), range(2))
        ]
        middles = [f"{(low + high) / 2:g}" for low, high in map(_ends(widget), range(2))]
        both = say(" and ").join(dict.fromkeys(ranges))
        return say("two numbers {ranges}, as {example}", ranges=both, example=",".join(middles))
    count = length_of(parameter.type)
    if count == 1:
        what = say("a whole number") if is_whole(parameter.type) else say("a number")
    else:
        many = (
            "{count} whole numbers, as {example}"
            if is_whole(parameter.type)
            else "{count} numbers, as {example}"
        )
        what = say(many, count=count, example=",".join(["1"] * count))
    if widget.low is not None and widget.high is not None:
        what += " " + say("from {low} to {high}", low=f"{widget.low:g}", high=f"{widget.high:g}")
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


def _menu(parameter: Parameter, value: object, name: str) -> int:
    choices = parameter.widget.choices
    if isinstance(value, str):
        if value in choices:
            return choices.index(value)
        raise ParameterError(
            f"{name} = {spell(value)}: expected {expected(parameter)}{_meant(value, choices)}"
        )
    if isinstance(value, float) and value.is_integer():
        value = int(value)
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value < len(choices):
        return value
    raise _wrong(name, value, expected(parameter))


def _meant(text: str, choices: Sequence[str]) -> str:
    hint = nearest(text, choices)
    return hint if "did you mean" in hint else ""


def _direction(angles: Mapping[str, object], name: str) -> list[object]:
    extra = set(angles) - {"azimuth", "elevation"}
    if extra or len(angles) != 2:
        raise ParameterError(
            f"{name}: expected {{ azimuth, elevation }}, found {{ {', '.join(map(str, angles))} }}"
        )
    return [angles["azimuth"], angles["elevation"]]


def _numbers(text: str, name: str, expected: str) -> list[float]:
    try:
        return [float(part) for part in text.split(",")]
    except ValueError:
        raise _wrong(name, text, expected) from None


def _number(parameter: Parameter, value: object, name: str) -> float | int:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise _wrong(name, value, expected(parameter))
    if isinstance(value, int) and abs(value) > 2**64:
        raise ParameterError(f"{name} = {spell(value)}: expected {expected(parameter)}")
    if not math.isfinite(value):
        raise ParameterError(f"{name} = {value}: expected a finite number")
    if not is_whole(parameter.type):
        return float(value)
    if value != int(value):
        raise _wrong(name, value, expected(parameter))
    whole = int(value)
    low, high = (0, 2**32 - 1) if parameter.type.startswith("u") else (-(2**31), 2**31 - 1)
    if not low <= whole <= high:
        raise ParameterError(f"{name} = {whole}: expected a whole number from {low} to {high}")
    return whole


def _check_range(parameter: Parameter, value: Value, name: str) -> None:
    widget = parameter.widget
    items: tuple[float | str, ...] = value if isinstance(value, tuple) else (value,)
    facts = widget.facts
    for part, (low, high), item in reversed(list(zip(facts.parts, facts.limits, items, strict=False))):
        if not low <= float(item) <= high:
            raise ParameterError(f"{name}: {part} {float(item):g} is outside {low:g} to {high:g} degrees")
    if widget.low is None or widget.high is None:
        return
    for axis, item in enumerate(items):
        low, high = _ends(widget)(axis)
        slack = 1e-6 * max(abs(low), abs(high))
        if isinstance(item, int | float) and not low - slack <= item <= high + slack:
            raise ParameterError(f"{name} = {item:g} is outside its range {low:g} to {high:g}")


def _wrong(name: str, value: object, target: str) -> ParameterError:
    return ParameterError(f"{name} = {spell(value)}: expected {target}")
