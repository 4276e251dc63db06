"""Sweep parameters: a sketch with one value after another.

``light.sun.elevation=5..60,12`` is twelve values from 5 to 60, ends included; ``=1,2,4``
those three. A sweep of a part of a vector names it: ``.azimuth`` and ``.elevation`` of a
direction, ``.r`` to ``.a`` of a colour, ``.x`` to ``.w`` of any other. Two sweeps make a
grid, the first along the rows.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from playground.errors import ParameterError, nearest
from playground.shader.parameter import coerce, components, expected, is_whole, length_of, read_whole, write
from playground.sketch.assign import TERRAIN_KEYS, check_value, resolve, value_of, values_of
from playground.sketch.model import Parameter, Sketch, Value

DEFAULT_STEPS = 9
MAX_PICTURES = 400
_TURN = {"azimuth": (0.0, 350.0), "elevation": (5.0, 60.0)}  # [degrees] usual ranges
_Target = tuple[str, int | None, Parameter | None]


@dataclass(frozen=True)
class Sweep:
    """The values that one parameter, or a part of it, takes one after another."""

    path: str  # as it was written, with the part
    parameter: str  # path of the parameter
    part: int | None  # which number of a vector; None: all of it
    declared: Parameter | None  # the parameter; None: a number of the terrain's own
    values: tuple[Value, ...]
    labels: tuple[str, ...]  # each value as text

    @property
    def parts(self) -> tuple[str, ...]:
        """What the numbers of a whole vector are called."""
        if self.part is not None or not isinstance(self.values[0], tuple):
            return ()
        return ("x", "y") if self.declared is None else components(self.declared)

    @property
    def unit(self) -> str:
        """The unit of its values, "" for none."""
        metres = self.path in ("relief", "base_elevation")
        return self.declared.unit if self.declared is not None else "m" if metres else ""

    @property
    def is_plain(self) -> bool:
        """Whether its values are numbers or truth values, and mean what they are."""
        texts = self.declared is not None and self.declared.widget.kind in ("menu", "file")
        return not self.parts and not texts


@dataclass(frozen=True)
class Swept:
    """A sketch with one value of each sweep."""

    sketch: Sketch
    caption: tuple[str, ...]  # "light.sun.elevation = 5", a line for each sweep


def read_sweep(sketch: Sketch, text: str, steps: int = DEFAULT_STEPS) -> Sweep:
    """Return what ``path=a..b``, ``path=a..b,steps`` or ``path=1,2,4`` says; raise ``ParameterError``.

    ``steps`` is how many values a range has that does not say. Values of a whole vector are
    separated by semicolons, as ``light.sun=135,25;250,12``.
    """
    path, equals, text_range = (each.strip() for each in text.partition("="))
    if not equals or not path or not text_range:
        raise ParameterError(f"sweep {text}: expected PATH=FROM..TO, as light.gain=0.5..3, or PATH=1,2,4")
    _, part, parameter = target = _target(sketch, path)
    try:
        if ".." in text_range:
            return _sweep(sketch, path, target, _range(text_range, steps, parameter, part))
        vector = parameter is not None and part is None and length_of(parameter.type) > 1
        values = text_range.split(";" if vector or ";" in text_range else ",")
        return _sweep(sketch, path, target, map(str.strip, values))
    except ParameterError as error:
        raise ParameterError(f"sweep {text}: {error.diagnostics[0].message}") from None


def sweep_of(sketch: Sketch, path: str, arguments: object) -> Sweep:
    """Return a sweep of values that Python has, or that a text says; raise ``ParameterError``."""
    if isinstance(arguments, str):
        return read_sweep(sketch, f"{path}={arguments}")
    target = _target(sketch, path)
    if not isinstance(arguments, Iterable) or isinstance(arguments, Mapping):
        raise ParameterError(f"sweep {path}: expected its values, as [1, 2, 4]; found {arguments!r}")
    sweep = _sweep(sketch, path, target, arguments, unique=True)
    if not sweep.values:
        raise ParameterError(f"sweep {path}: expected one value or more; there is none")
    return sweep


def _sweep(
    sketch: Sketch, path: str, target: _Target, values: Iterable[object], *, unique: bool = False
) -> Sweep:
    """Return a sweep of values as they are written; one that is there twice is left out, or refused."""
    whole_path, part, parameter = target
    labels: dict[Value, str] = {}
    for each in values:
        value = _value(sketch, whole_path, part, parameter, each)
        if value in labels and unique:
            raise ParameterError(f"sweep {path}: {labels[value]} is there twice")
        labels.setdefault(value, _label(parameter, part, value))
    return Sweep(path, whole_path, part, parameter, tuple(labels), tuple(labels.values()))


def _target(sketch: Sketch, path: str) -> _Target:
    """Return the parameter that a path names, and which of its numbers; raise ``ParameterError``."""
    if path in TERRAIN_KEYS:
        return path, None, None
    around, _, last = path.rpartition(".")
    for whole in (path, around):
        try:
            parameter = resolve(sketch.graph, whole)[0].parameter
        except ParameterError:
            continue
        if whole == path:
            return path, None, parameter
        names = components(parameter)
        if last in names and len(names) > 1:
            return around, names.index(last), parameter
        hint = nearest(last, names if len(names) > 1 else ())
        raise ParameterError(f"sweep {path}: {around} has no part '{last}'{hint}")
    check_value(sketch, path, 0)  # says which path is nearest
    raise ParameterError(f"sweep {path}: no such parameter")


def _range(text: str, steps: int, parameter: Parameter | None, part: int | None) -> list[object]:
    """Return the numbers of ``a..b`` or ``a..b,steps``, ends included."""
    ends, _, count = text.partition(",")
    low, _, high = ends.partition("..")
    if count.strip():
        if (whole := read_whole(count)) is None:
            raise ParameterError(f"'{count.strip()}' steps: expected a whole number from 2")
        steps = whole
    if not 2 <= steps <= MAX_PICTURES:
        raise ParameterError(f"{steps} steps: expected 2 to {MAX_PICTURES}")
    if parameter is not None and (
        (part is None and length_of(parameter.type) > 1) or parameter.type in ("bool", "sampler2D")
    ):
        raise ParameterError(f"a range needs a number; {parameter.name} takes {expected(parameter)}")
    try:
        first, last = float(low), float(high)
    except ValueError:
        raise ParameterError(f"'{ends}': expected two numbers, as 5..60") from None
    if not (abs(first) < 1e12 and abs(last) < 1e12):
        raise ParameterError(f"'{ends}': expected two finite numbers, as 5..60")
    numbers = [first + (last - first) * k / (steps - 1) for k in range(steps)]
    whole = parameter is not None and is_whole(parameter.type)
    return [round(number) if whole else float(f"{number:.9g}") for number in numbers]


def _value(sketch: Sketch, path: str, part: int | None, parameter: Parameter | None, number: object) -> Value:
    if part is None or parameter is None:
        return check_value(sketch, path, number)
    now: list[object] = list(_now(sketch, path))
    try:
        now[part] = float(str(number))
    except ValueError:
        raise ParameterError(f"{path} = '{number}': expected a number") from None
    value = coerce(parameter, now, path)
    assert isinstance(value, tuple)
    return value[part]


def _label(parameter: Parameter | None, part: int | None, value: Value) -> str:
    if parameter is not None and part is None:
        return write(parameter, value)
    numbers = value if isinstance(value, tuple) else (value,)
    return ",".join(f"{number:.6g}" if isinstance(number, float) else str(number) for number in numbers)


def sweep_text(path: str, parameter: Parameter, part: str = "") -> str:
    """Return a sweep of a parameter, or of a part of it, over its range."""
    axis = parts_of(parameter).index(part) if part else 0
    low, high = _TURN.get(part, parameter.widget.ends(axis))
    default = parameter.default
    if low is None or high is None:
        number = float(default) if isinstance(default, int | float) else 1.0
        low, high = 0.0, 2.0 * abs(number) or 1.0
    if parameter.widget.kind == "menu":
        return f"{path}={','.join(parameter.widget.choices)}"
    if parameter.type == "bool":
        return f"{path}=false,true"
    where = f"{path}.{part}" if part else path
    if is_whole(parameter.type):
        return f"{where}={round(low)}..{round(high)},{min(round(high) - round(low) + 1, 9)}"
    return f"{where}={low:g}..{high:g},9"


def parts_of(parameter: Parameter) -> tuple[str, ...]:
    """Return the parts that a parameter is swept by, ("",) for one number, () for what cannot be."""
    if parameter.type == "sampler2D" or parameter.widget.kind == "file":
        return ()
    return components(parameter) or ("",)


def combinations(sketch: Sketch, sweeps: Sequence[Sweep]) -> tuple[Swept, ...]:
    """Return a sketch with each combination of the values of sweeps; those of the first change fastest."""
    picks = product(*(range(len(sweep.values)) for sweep in reversed(sweeps)))
    return tuple(_set(sketch, list(zip(sweeps, pick[::-1], strict=True))) for pick in picks)


def columns_of(count: int) -> int:
    """Return how many of so many pictures are side by side: all rows full if that leaves few columns."""
    best = math.ceil(math.sqrt(count))
    full = [columns for columns in range(best, min(count, 2 * best) + 1) if count % columns == 0]
    return full[0] if full else best


def _set(sketch: Sketch, chosen: Sequence[tuple[Sweep, int]]) -> Swept:
    caption = []
    for sweep, index in chosen:
        value = sweep.values[index]
        if sweep.part is not None:
            now: list[object] = list(_now(sketch, sweep.parameter))
            now[sweep.part] = value
            sketch = sketch.with_values({sweep.parameter: now})
        else:
            sketch = sketch.with_values({sweep.parameter: value})
        caption.append(f"{sweep.path} = {sweep.labels[index]}")
    return Swept(sketch, tuple(caption))


def _now(sketch: Sketch, path: str) -> tuple[float, ...]:
    value = value_of(sketch, path, values_of(sketch))
    assert isinstance(value, tuple)
    return value
