"""Parameters: their widgets, colours, and values read from TOML, the command line, and Python.

``WIDGETS`` has a row for each widget: types, arguments, range, unit. How the window draws it is another
table, ``CONTROLS`` in ``live/widgets.py``; a test compares the two.

``coerce`` makes any value Python's own type for the parameter's GLSL type, checked against the range that
its annotation gives.

Every colour is linear inside the playground; encoded ones live only in files, in TOML and on the screen.
There is no other colour space here, and no tone mapping (that is `view/present`).
Source: IEC 61966-2-1:1999 with Amendment 1 (2003), clause 5.2: the exact piecewise curve, not the power 2.2.
Its printed thresholds (0.04045 and 0.0031308) leave a step of less than 1e-7 between the pieces, far below
the 1/255 of a byte.
"""

from __future__ import annotations

import math
import os
import re
import reprlib
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from playground.errors import DataError, ParameterError, nearest

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray


SCALARS = ("float", "int", "uint", "bool")
VECTORS = ("vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4", "uvec2", "uvec3", "uvec4")
_NUMBERS = ("float", "int", "uint", *VECTORS)


@dataclass(frozen=True, slots=True)
class Kind:
    """What is true of every parameter with one widget."""

    types: tuple[str, ...]  # GLSL types that it may be given to
    takes: str = ""
    """In brackets: "" nothing, range, "range or nothing", ranges, "raw or nothing", choices, sampling."""
    range: tuple[float, float] | None = None  # of each number, where the brackets give none
    expects: str = ""  # a value, in words; "": numbers of the type, in the range
    listed: str = ""  # a value, in a word or two of a table; "": its range
    unit: str = ""  # where the annotation gives none

    @property
    def bare(self) -> bool:
        """Whether it may be written without brackets."""
        return self.takes not in ("range", "choices")


WIDGETS: dict[str, Kind] = {
    "number": Kind(_NUMBERS),  # what has no widget; no word of an annotation
    "slider": Kind(_NUMBERS, "range"),
    "log_slider": Kind(("float", "int", "uint"), "range"),
    "angle": Kind(("float",), "range or nothing", range=(-360.0, 360.0), unit="°"),
    "divider": Kind(
        ("float",),
        range=(0.0, 1.0),
        expects="a fraction of the picture's width, from 0 to 1",
        listed="0 to 1",
    ),
    "direction": Kind(
        ("vec2",),
        expects="azimuth and elevation in degrees, as 135,25",
        listed="azimuth, elevation",
        unit="°",
    ),
    "colour": Kind(("vec3", "vec4"), "raw or nothing", expects="a colour, as #8a9a5b"),
    "menu": Kind(("int",), "choices"),
    "checkbox": Kind(("bool",), expects="true or false"),
    "button": Kind(("bool",), expects="true or false", listed="true while pressed"),
    "point": Kind(("vec2",), "ranges", range=(0.0, 1.0)),
    "file": Kind(("sampler2D",), "sampling", expects="the path of a file"),
}
"""By the word that asks for it in an annotation."""


_HEX = re.compile(r"#(?:[0-9a-f]{3}|[0-9a-f]{6}|[0-9a-f]{8})", re.IGNORECASE | re.ASCII)


def srgb_to_linear(encoded: ArrayLike) -> NDArray[np.float64]:
    """Decode sRGB to linear light, component by component.

    `encoded` is 0..1, any shape (divide bytes by 255 first); the result is
    float64 of that shape. Below 0 the straight piece goes on, above 1 the
    curve does. Alpha is never encoded: leave it out.
    """
    import numpy as np  # a tenth of a second, which to list the sketches need not cost

    c = np.asarray(encoded, dtype=np.float64)
    curve = ((np.maximum(c, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.asarray(np.where(c <= 0.04045, c / 12.92, curve))


def linear_to_srgb(linear: ArrayLike) -> NDArray[np.float64]:
    """Encode linear light as sRGB: the inverse of `srgb_to_linear`, same shapes."""
    import numpy as np  # as above

    c = np.asarray(linear, dtype=np.float64)
    curve = 1.055 * np.maximum(c, 0.0031308) ** (1.0 / 2.4) - 0.055
    return np.asarray(np.where(c <= 0.0031308, 12.92 * c, curve))


def parse_hex(text: str, *, raw: bool = False) -> tuple[float, ...]:
    """Read `"#rgb"`, `"#rrggbb"` or `"#rrggbbaa"` as linear floats, 0..1; `raw`: not decoded.

    Returns three numbers, or four where an alpha was written (it is not decoded:
    alpha is a coverage, not a light).

    Raises:
        DataError: the text is not such a colour.
    """
    number = text.strip() if isinstance(text, str) else ""
    if not _HEX.fullmatch(number):
        raise DataError(f"{text!r} is not a colour; expected '#rrggbb', '#rgb' or '#rrggbbaa', as '#87a96b'")
    digits = number[1:]
    if len(digits) == 3:
        digits = "".join(2 * d for d in digits)
    values = [byte / 255.0 for byte in bytes.fromhex(digits)]
    return tuple(values) if raw else (*map(_decoded, values[:3]), *values[3:])


def to_hex(linear: Sequence[float], *, raw: bool = False) -> str:
    """Write a linear colour of three or four numbers as `"#rrggbb"` or `"#rrggbbaa"`; `raw`: not encoded.

    Components outside 0..1 are clamped. `to_hex(parse_hex(text))` is `text` in
    lower case and full length.

    Raises:
        DataError: not three or four finite numbers.
    """
    values = [float(v) for v in linear]
    if len(values) not in (3, 4) or not all(map(math.isfinite, values)):
        raise DataError(f"{tuple(values)} is not a colour; expected three or four finite numbers from 0 to 1")
    clamped = [min(max(v, 0.0), 1.0) for v in values]
    shown = clamped if raw else [*map(_encoded, clamped[:3]), *clamped[3:]]
    return "#" + bytes(round(255.0 * v) for v in shown).hex()


def _decoded(c: float) -> float:
    return c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4


def _encoded(c: float) -> float:
    return c * 12.92 if c <= 0.0031308 else 1.055 * c ** (1.0 / 2.4) - 0.055


Value = float | int | bool | str | tuple[float, ...] | tuple[int, ...]
"""A parameter's value: a scalar, a tuple for a vector, or a path for a file."""

MAX_SIDE = 16_384
"""Texels or pixels that a side may have: what common graphics cards take."""


@dataclass(frozen=True, slots=True)
class Widget:
    """How a parameter is shown and what it may be."""

    kind: str = "number"  # a row of WIDGETS
    low: float | None = None  # None: unbounded
    high: float | None = None
    choices: tuple[str, ...] = ()  # of a menu
    values: tuple[int, ...] = ()  # of a menu: what the uniform gets for each choice; (): its number, from 0
    raw: bool = False  # of a colour: as it is shown, not linear
    axes: tuple[tuple[float, float], ...] = ()  # of a point: each number's range, where they differ

    def ends(self, axis: int = 0) -> tuple[float | None, float | None]:
        """Return the range of one of a vector's numbers; None where it is unbounded."""
        return self.axes[axis] if self.axes else (self.low, self.high)

    def uniform_value(self, value: Value) -> Value:
        """Return what the uniform gets: of a menu with values the chosen one."""
        return self.values[value] if self.values and isinstance(value, int) else value

    def chosen(self, uniform: Value) -> Value:
        """Return the value that gives a uniform what it has: the inverse of ``uniform_value``."""
        return self.values.index(uniform) if self.values and isinstance(uniform, int) else uniform


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
    widget: Widget = Widget()
    step: float | None = None
    unit: str = ""
    group: str = ""
    label: str = ""
    tooltip: str = ""
    sampling: Sampling = AS_IT_IS  # of a file
    painted: bool = False  # a file that may be painted on in the window
    erode: str = ""  # the technique that the brush erodes with, as ``use`` names it; "": it does not
    preview: Value | None = None  # in a preview on a software renderer, while it is not set; a number
    # where that has fewer pixels
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


def _wrong(name: str, value: object, target: str) -> ParameterError:
    return ParameterError(f"{name} = {spell(value)}: expected {target}")
