"""What a parameter is: a uniform with its annotation, and the values that it takes."""

from __future__ import annotations

from dataclasses import dataclass

Value = float | int | bool | str | tuple[float, ...] | tuple[int, ...]
"""A parameter's value: a scalar, a tuple for a vector, or a path for a file."""

LARGEST_SIDE = 16_384
"""Texels or pixels that a side may have: what common graphics cards take."""


@dataclass(frozen=True, slots=True)
class Widget:
    """How a parameter is shown and what it may be."""

    kind: str = "number"  # a row of sketch/widgets.py
    low: float | None = None  # None: unbounded
    high: float | None = None
    choices: tuple[str, ...] = ()  # of a menu
    renamed: tuple[tuple[str, str], ...] = ()  # former choice → choice; a former one is still read
    values: tuple[int, ...] = ()  # of a menu: what the uniform gets for each choice; (): its number, from 0
    raw: bool = False  # of a colour: as it is shown, not linear
    axes: tuple[tuple[float, float], ...] = ()  # of a point: each number's range, where they differ

    def ends(self, axis: int = 0) -> tuple[float | None, float | None]:
        """Return the range of one of a vector's numbers; None where it is unbounded."""
        return self.axes[axis] if self.axes else (self.low, self.high)

    def given(self, value: Value) -> Value:
        """Return what the uniform gets: of a menu with values the chosen one."""
        return self.values[value] if self.values and isinstance(value, int) else value

    def chosen(self, given: Value) -> Value:
        """Return the value that gives a uniform what it has: the inverse of ``given``."""
        return self.values.index(given) if self.values and isinstance(given, int) else given


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
    former: tuple[str, ...] = ()  # names that it had, which are still read
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
