"""Widgets of parameters: one table, ``widgets.json``, that Python and the page runtime read.

A row says what a widget is for, what it takes in brackets, its range, unit and scale, and which control
edits it. A widget that is like a slider is one row; another control is one function in the studio's
``widgets.py`` and one in the page runtime's ``controls.js``, by its name there.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SCALARS = ("float", "int", "uint", "bool")
VECTORS = ("vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4", "uvec2", "uvec3", "uvec4")

Range = tuple[float, float]

Value = float | int | bool | str | tuple[float, ...] | tuple[int, ...]
"""A parameter's value: a scalar, a tuple for a vector, or a path for a file."""


@dataclass(frozen=True, slots=True)
class Kind:
    """What is true of every parameter with one widget."""

    types: tuple[str, ...]  # GLSL types that it may be given to
    control: str  # what edits it: numbers, direction, point, colour, menu, checkbox, button, file
    about: str  # what it is for, as Markdown: the library's README and editors show it
    takes: str = ""
    """In brackets: "" nothing, range, "range or nothing", ranges, "raw or nothing", choices, sampling."""
    scale: str = "linear"  # of a slider's, a knob's or a random way over the range: linear, or log
    range: Range | None = None  # of each number, where the brackets give none
    spans: tuple[Range, ...] = ()  # of each part: what knobs and faders go over, where no range is enforced
    limits: tuple[Range, ...] = ()  # of each part: what a value may be, where no range is enforced
    parts: tuple[str, ...] = ()  # what a vector's components are called; (): x, y, z, w
    expects: str = ""  # a value, in words; "": numbers of the type, in the range
    listed: str = ""  # a value, in a word or two of a table; "": its range
    unit: str = ""  # where the annotation gives none

    @property
    def bare(self) -> bool:
        """Whether it may be written without brackets."""
        return self.takes not in ("range", "choices")

    @property
    def is_log(self) -> bool:
        """Whether equal ways over its range are equal ratios; the range lies above 0."""
        return self.scale == "log"

    @property
    def is_switch(self) -> bool:
        """Whether it has a few choices rather than a range."""
        return self.control in ("menu", "checkbox", "button")

    @property
    def has_vectors(self) -> bool:
        """Whether it may be given to a vector."""
        return any(name in VECTORS for name in self.types)


def _kind(row: dict[str, Any]) -> Kind:
    values = {name: _tuples(value) for name, value in row.items()}
    return Kind(**values | {"types": tuple(row["types"].split())})


def _tuples(value: Any) -> Any:
    return tuple(map(_tuples, value)) if isinstance(value, list) else value


_FILE = Path(__file__).with_suffix(".json")

WIDGETS = {name: _kind(row) for name, row in json.loads(_FILE.read_text(encoding="utf-8")).items()}
"""By the word that asks for it in an annotation; "number" is what has none."""


@dataclass(frozen=True, slots=True)
class Widget:
    """How a parameter is shown and what it may be."""

    kind: str = "number"  # a row of WIDGETS
    low: float | None = None  # None: unbounded
    high: float | None = None
    choices: tuple[str, ...] = ()  # of a menu
    values: tuple[int, ...] = ()  # of a menu: what the uniform gets for each choice; (): its number, from 0
    raw: bool = False  # of a colour: as it is shown, not linear
    axes: tuple[Range, ...] = ()  # of a point: each number's range, where they differ
    preview: Value | None = None  # in a preview on a software renderer, while it is not set; a number
    # where that has fewer pixels

    @property
    def facts(self) -> Kind:
        """What is true of every parameter with this widget."""
        return WIDGETS[self.kind]

    def ends(self, axis: int = 0) -> tuple[float | None, float | None]:
        """Return the range of one of a vector's numbers; None where it is unbounded."""
        return self.axes[axis] if self.axes else (self.low, self.high)

    def uniform_value(self, value: Value) -> Value:
        """Return what the uniform gets: of a menu with values the chosen one."""
        return self.values[value] if self.values and isinstance(value, int) else value

    def chosen(self, uniform: Value) -> Value:
        """Return the value that gives a uniform what it has: the inverse of ``uniform_value``."""
        return self.values.index(uniform) if self.values and isinstance(uniform, int) else uniform


PLAIN = Widget()
"""A number without a range: what a uniform without an annotation is."""


def at_fraction(fraction: float, low: float, high: float, *, log: bool) -> float:
    """Return the number at a fraction (0..1) of the way over a range; ``log``: by its logarithm."""
    return float(low * (high / low) ** fraction) if log else low + (high - low) * fraction


def fraction_of(number: float, low: float, high: float, *, log: bool) -> float:
    """Return the fraction of the way over a range at which a number lies: the inverse of ``at_fraction``.

    Of an empty range 0. By the logarithm, what lies below the range is at its lower end.
    """
    if high <= low:
        return 0.0
    if log:
        return math.log(max(number, low) / low) / math.log(high / low)
    return (number - low) / (high - low)


def usage(name: str) -> str:
    """Return how annotations write a widget, as Markdown: each form it has."""
    kind = WIDGETS[name]
    forms = {
        "range": [f"{name}(low, high)"],
        "range or nothing": [name, f"{name}(low, high)"],
        "ranges": [name, f"{name}(low, high)"],
        "choices": [f'{name}("a", "b")'],
        "sampling": [f'{name}("a.png")'],
    }
    return ", ".join(f"`{form}`" for form in forms.get(kind.takes, [name]))
