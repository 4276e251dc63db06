"""What an option of a pragma is, and how its text is read; ``kernel`` has the table of them, by kind.

Functions that read a text take the option's name, the text, and what it may name; they raise ``ValueError``
with a message for users.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass, field
from operator import attrgetter
from typing import Any

from playground.errors import nearest
from playground.shader import expressions
from playground.shader.expressions import ExpressionError
from playground.shader.reserved_names import OF_THE_TERRAIN

FORMATS: tuple[str, ...] = tuple(f"{c}{d}" for c in ("r", "rg", "rgba") for d in ("8", "16", "16f", "32f"))
"""Formats of textures."""

SIZE = ("size.x", "size.y")
SOURCE_READS = ("time", "keys", "microphone", "camera", *OF_THE_TERRAIN)
_BUFFER_TYPES = ("float", "int", "uint", "vec2", "vec4", "ivec2", "ivec4", "uvec2", "uvec4")
_BOUND = re.compile(
    r"(?:(?P<names>[A-Za-z_]\w*(?:\s*,\s*[A-Za-z_]\w*)*)\s*:\s*)?"
    r"(?:(?P<exact>exact)|(?P<most>\d+\.?\d*(?:e[+-]?\d+)?)(?P<degrees>\s+degrees)?(?P<rms>\s+rms)?)",
    re.ASCII,
)
EXAMPLE = 'agrees = "exact", agrees = "1e-5" or agrees = "sky: 0.01 rms; exact"'


@dataclass(frozen=True, slots=True)
class Buffer:
    """A storage buffer of a compute variant."""

    name: str
    type: str  # GLSL scalar or vec4
    count: str  # expression


@dataclass(frozen=True, slots=True)
class Scope:
    """What the options of a file may name."""

    numbers: tuple[str, ...]  # parameters that are one number
    inputs: tuple[str, ...]


@dataclass(frozen=True)
class Option:
    """One option of a pragma."""

    help: str  # Markdown
    default: Any = ""
    # Its name, its text and what that may name → its value; raises ``ValueError``.
    parse: Callable[[str, str, Scope], Any] = lambda name, text, scope: text
    # The kernel with all its options → what is wrong with this one; "" for nothing.
    check: Callable[[Any], str] = lambda kernel: ""
    excludes: tuple[str, ...] = ()  # options that may not stand beside it
    choices: tuple[str, ...] = ()  # what it may be, where that is one of a few; for completion
    # Its value → its expressions, which may use the names of ``where``; None: it has none.
    expressions: Callable[[Any], tuple[str, ...]] | None = None
    required: str = ""  # what a pragma without it lacks
    positional: bool = False  # it may stand first, without its name
    keyed: bool = True  # the textures depend on it, beyond what a step's size and repeat say
    compared: bool = True  # part of what a fast variant was verified against
    page: str = ""  # its name in a page's data; "": pages have no use for it
    name: str = ""
    attribute: str = ""  # path of the kernel's field; "": the header reader replaces it by what it means

    def of(self, kernel: object) -> Any:
        """Return its value in a kernel."""
        return attrgetter(self.attribute)(kernel)

    @property
    def about(self) -> str:
        """What it says, with its choices and its default, as Markdown."""
        choices = f": {', '.join(f'`{item}`' for item in self.choices)}" if self.choices else ""
        default = ", ".join(map(str, self.default)) if isinstance(self.default, tuple) else self.default
        return f"{self.help}{choices}{f' (`{default}`)' if default not in ('', 0) else ''}"


def option(help: str, default: Any = "", **more: Any) -> Any:
    """Declare an option, as a field of a kernel."""
    return field(default=default, metadata={"option": Option(help, default, **more)})


def expression(
    help: str,
    default: str = "",
    *,
    names: tuple[str, ...] = (),
    of_inputs: tuple[str, ...] = (),
    count: int = 1,
    **more: Any,
) -> Any:
    """Declare an option with ``count`` expressions of sizes, parameters, ``names``, and parts of inputs."""

    def parse(name: str, text: str, scope: Scope) -> str:
        allowed = (
            *SIZE,
            *names,
            *scope.numbers,
            *(f"{item}{part}" for item in scope.inputs for part in of_inputs),
        )
        check_expression(name, text, allowed, count)
        if expressions.counts_frames(text) and "frames" in names and "frames" in scope.numbers:
            raise ValueError(f"{name} '{text}': 'frames' {expressions.TWO_FRAMES}")
        return text

    return option(help, default, parse=parse, expressions=lambda text: (text,), **more)


def check_expression(name: str, text: str, names: tuple[str, ...], count: int = 1) -> None:
    """Raise ``ValueError`` for an expression that is none, or names something else than what is known."""
    try:
        expressions.check(text, names, count=count)
    except ExpressionError as error:
        raise ValueError(f"{name}: {error}") from None


def choice(help: str, default: str, choices: tuple[str, ...], **more: Any) -> Any:
    """Declare an option that is one of a few words."""

    def parse(name: str, text: str, scope: Scope) -> str:
        if text not in choices:
            hint = nearest(text, choices).replace("; there are", ": expected one of")
            raise ValueError(f'{name} = "{text}"{hint}')
        return text

    return option(help, default, parse=parse, choices=choices, **more)


def read_accepts(name: str, text: str, scope: Scope) -> str:
    """Return a form of sizes, where it is one."""
    try:
        expressions.accepted_sizes(text)
    except ExpressionError as error:
        raise ValueError(f'{name}: {error}; as accepts = "2**n + 1"') from None
    return text


def read_warnings(name: str, text: str, scope: Scope) -> tuple[tuple[str, str], ...]:
    """Return conditions, and what is warned of where one holds."""
    warnings: list[tuple[str, str]] = []
    for part in parts_of(text, ";"):
        condition, colon, message = (piece.strip() for piece in part.partition(":"))
        if not colon or not message:
            example = "frequency <= tiles: no detail is left (several are separated by ;)"
            raise ValueError(f"{name} '{part}': expected condition: message, as {example}")
        check_expression(name, condition, (*SIZE, *scope.numbers))
        warnings.append((condition, " ".join(message.split())))
    return tuple(warnings)


def read_reads(name: str, text: str, scope: Scope) -> tuple[str, ...]:
    """Return what a source depends on."""
    parts = parts_of(text, ",")
    for item in parts:
        if item not in SOURCE_READS:
            raise ValueError(f"{name} = '{text}': a source cannot read '{item}'{nearest(item, SOURCE_READS)}")
    return parts


def read_samples(name: str, text: str, scope: Scope) -> int:
    """Return the samples of a pixel."""
    if text not in ("0", "1"):
        raise ValueError(f"{name} = {text}: expected 1, or 0 for as many as the view has")
    return int(text)


def read_input(name: str, text: str, scope: Scope) -> str:
    """Return the name of an input that there is."""
    if text not in scope.inputs:
        raise ValueError(f"{name}: there is no input '{text}'{nearest(text, scope.inputs)}")
    return text


def read_local(name: str, text: str, scope: Scope) -> tuple[int, int]:
    """Return the threads of a work group, along x and y."""
    parts = [part.strip() for part in text.split(",")]
    if len(parts) != 2 or not all(re.fullmatch(r"[1-9][0-9]{0,4}", part) for part in parts):
        raise ValueError(f'{name} = "{text}": expected two whole numbers, as "256, 1"')
    return int(parts[0]), int(parts[1])


def read_buffers(name: str, text: str, scope: Scope) -> tuple[Buffer, ...]:
    """Return storage buffers."""
    buffers: list[Buffer] = []
    for part in parts_of(text, ";"):
        pieces = [piece.strip() for piece in part.split(":", 2)]
        if len(pieces) != 3 or not re.fullmatch(r"[A-Za-z_]\w*", pieces[0], re.ASCII):
            example = "stack:vec4:size.x * 64 (several separated by ;)"
            raise ValueError(f"buffer '{part}': expected name:type:count, as {example}")
        if pieces[1] not in _BUFFER_TYPES:
            hint = nearest(pieces[1], _BUFFER_TYPES)
            raise ValueError(f"buffer '{pieces[0]}' has no type '{pieces[1]}'{hint}")
        check_expression(f"buffer '{pieces[0]}'", pieces[2], (*SIZE, *scope.numbers))
        buffers.append(Buffer(*pieces))
    return tuple(buffers)


def read_stages(name: str, text: str, scope: Scope) -> tuple[int, ...]:
    """Return the numbers of stages."""
    parts = parts_of(text, ",")
    if not all(re.fullmatch(r"[0-9]{1,4}", part, re.ASCII) for part in parts):
        raise ValueError(f'{name} = "{text}": expected whole numbers separated by commas')
    return tuple(map(int, parts))


def read_aligned(name: str, text: str, scope: Scope) -> int:
    """Return the bytes that rows are filled up to."""
    if text not in ("4", "8", "16", "32"):
        raise ValueError(f'{name} = "{text}": expected 4, 8, 16 or 32, the bytes that rows are filled up to')
    return int(text)


def read_agrees(name: str, text: str, scope: Scope) -> tuple[Bound, ...]:
    """Return the bounds of an agreement."""
    try:
        return read_agreement(text)
    except ValueError as error:
        raise ValueError(f"{name}: {error}") from None


@dataclass(frozen=True, slots=True)
class Bound:
    """How far numbers may be apart."""

    output: str = ""  # "": every output without a bound of its own
    most: float = 0.0  # 0: every bit is the same
    degrees: bool = False  # of angles, whose tangents the numbers are
    rms: bool = False  # of the root of the mean square, instead of every difference

    def __str__(self) -> str:
        words = f"{self.most:g}" if self.most else "the last bit"
        return f"{words}{' degrees' if self.degrees else ''}{' (rms)' if self.rms else ''}"


def read_agreement(text: str) -> tuple[Bound, ...]:
    """Return the bounds that a text states; raise ``ValueError`` with what is wrong with it.

    ``agrees = "exact"`` is every bit; ``"1e-5"`` the most that any number of any output may differ by. Bounds
    of single outputs are separated by semicolons, and may count otherwise:

        "sky: 0.012 rms; ahead, behind: 0.9 degrees rms; exact"

    ``rms`` bounds the root of the mean square of the differences, ``degrees`` compares tangents as angles. A
    bound without a name is for all outputs that have none of their own.
    """
    bounds: list[Bound] = []
    for part in (part.strip() for part in text.split(";")):
        match = _BOUND.fullmatch(part)
        if match is None or (match["most"] and not 0.0 < float(match["most"]) < math.inf):
            raise ValueError(f"'{part}' states no bound; expected {EXAMPLE}")
        for name in [n.strip() for n in (match["names"] or "").split(",")]:
            if name in [bound.output for bound in bounds]:
                raise ValueError(f"'{part}': {name or 'all other outputs'} appears twice")
            most = float(match["most"] or 0.0)
            bounds.append(Bound(name, most, bool(match["degrees"]), bool(match["rms"])))
    return tuple(bounds)


def bound_of(bounds: tuple[Bound, ...], output: str) -> Bound | None:
    """Return the bound of an output; None where none is stated."""
    named = {bound.output: bound for bound in bounds}
    return named.get(output, named.get(""))


def parts_of(text: str, separator: str) -> tuple[str, ...]:
    """Return the parts of a text that are not empty."""
    return tuple(filter(None, (part.strip() for part in text.split(separator))))
