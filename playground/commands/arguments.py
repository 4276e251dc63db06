"""What commands share: how arguments are read, how help is written, where output goes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import typer

from playground.errors import DataError, ParameterError, PlaygroundError
from playground.shader.kernel import DRIVERS
from playground.shader.parameter import read_whole
from playground.sketch.model import MAX_SIDE, Shot, Sketch

if TYPE_CHECKING:
    from playground.engine.engine import Engine

T = TypeVar("T")
Number = TypeVar("Number", int, float)

FAILED = 1
"""Exit status of ``check`` and ``doctor`` that found something."""


@dataclass(frozen=True, slots=True)
class Renderer:
    """Which renderer the user chose."""

    software: bool = False
    device: int | None = None

    def or_else(self, software: bool, device: int | None = None) -> Renderer:
        """Return what was chosen before or after the command's name."""
        return Renderer(self.software or software, self.device if device is None else device)

    def open_engine(self, **options: Any) -> Engine:
        """Open a headless engine on it; the options are those of ``playground.api.headless``."""
        from playground.api import headless

        return headless(software=self.software, device=self.device, **options)


def help_text(text: str, *examples: str) -> str:
    r"""Return a command's help: what it does, then examples, whose lines ``\b`` keeps as they are."""
    return f"{text}\n\n\b\nExamples:\n" + "\n".join(f"  {example}" for example in examples)


def either(names: Sequence[str]) -> str:
    """Return "a, b or c"."""
    return " or ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def command_group(name: str, text: str, short: str) -> typer.Typer:
    """Return an empty group of commands that prints its help where none of them is named."""
    app = typer.Typer(
        name=name, help=text, short_help=short, invoke_without_command=True, rich_markup_mode="rich"
    )

    @app.callback()
    def print_help(ctx: typer.Context) -> None:
        if ctx.invoked_subcommand is None:
            print(ctx.get_help())

    return app


def read_option(name: str, text: str, read: Callable[[str], T | None], expected: str) -> T | None:
    """Return the value of an option, None where it is absent.

    Raises ``ParameterError`` where ``read`` returns None or raises ``ValueError``.
    """
    if not text:
        return None
    try:
        value = read(text)
    except (ValueError, ZeroDivisionError):
        value = None
    if value is None:
        raise ParameterError(f"{name} {text}: expected {expected}")
    return value


def refuse(conflicts: Mapping[str, object]) -> None:
    """Raise ``ParameterError`` with the first message of a table whose condition is true."""
    for message, is_wrong in conflicts.items():
        if is_wrong:
            raise ParameterError(message)


def within(low: Number, high: Number) -> Callable[[str], Number | None]:
    """Return a reader of numbers between two bounds, both included: of digits only, where they are whole."""

    def read(text: str) -> Number | None:
        if isinstance(low, int) and not text.isdecimal():
            return None
        number = type(low)(text)
        return number if low <= number <= high else None

    return read


def read_steps(texts: Sequence[str] | None) -> dict[str, int]:
    """Return the iterations of ``--steps`` by pass; raise ``ParameterError``."""
    numbers: dict[str, int] = {}
    for text in texts or ():
        path, _, count = text.partition("=")
        steps = read_whole(count)
        if not path.strip() or steps is None:
            raise ParameterError(f"--steps {text}: expected a pass and a whole number, as height=9")
        numbers[path.strip()] = steps
    return numbers


class Pixels(NamedTuple):
    """A size in pixels."""

    width: int
    height: int


def read_pixels(text: str, most: int = MAX_SIDE) -> Pixels:
    """Return the width and height of ``--size``, at most so many pixels; raise ``ParameterError``."""
    width, _, height = text.lower().replace("×", "x").partition("x")
    sides = [read_whole(side) or 0 for side in (width, height)]
    if not all(1 <= side <= most for side in sides):
        raise ParameterError(f"--size {text}: expected width and height, 1 to {most} pixels, as 1280x720")
    return Pixels(*sides)


def read_seconds(text: str) -> float | None:
    """Return the seconds of ``--time``; raise ``ParameterError``."""
    return read_option("--time", text, within(-1e9, 1e9), "a number of seconds, as 2.5")


def read_driver(text: str) -> str:
    """Return the driver of ``--driver``; raise ``ParameterError``."""
    if text not in DRIVERS:
        raise ParameterError(f"--driver {text}: expected {either(DRIVERS)}")
    return text


def read_device(text: str) -> int | None:
    """Return the number of ``--device``; raise ``ParameterError``."""
    return read_option("--device", text, within(0, 999), "the number of an EGL device, from 0")


def read_values(settings: Sequence[str] | None) -> dict[str, object]:
    """Split ``path=value`` settings; the last of a path counts."""
    values: dict[str, object] = {}
    for setting in settings or ():
        path, equals, value = setting.partition("=")
        path = path.strip()
        if not equals or not path:
            raise ParameterError(f"--set {setting}: expected PATH=VALUE, as light.sun=250,12 or size=513")
        values.pop(path, None)
        values[path] = value.strip()
    return values


def with_whole_paths(sketch: Sketch, values: dict[str, object]) -> dict[str, object]:
    """Resolve the files among the values: the user named them from the current folder.

    A name that is not there but in the sketch's folder or in ``glsl/`` is left as it is.
    """
    from playground.paths import GLSL
    from playground.sketch.assign import resolve

    absolute = dict(values)
    for path, value in values.items():
        try:
            parameter = resolve(sketch.graph, path)[0].parameter
        except PlaygroundError:
            continue  # the terrain's own, or a mistake that with_values explains
        text = str(value)
        if parameter.widget.kind != "file" or not text:
            continue
        here = Path(text).expanduser()
        elsewhere = any((Path(folder) / text).is_file() for folder in (sketch.folder, GLSL))
        if here.exists() or not elsewhere:
            absolute[path] = str(Path.cwd() / here)
    return absolute


@dataclass(frozen=True, slots=True)
class Moment:
    """A sketch at a moment: its values, when, after how many iterations, how large where a shot says so."""

    sketch: Sketch
    time: float
    steps: dict[str, int]
    size: tuple[int, int] | None
    shot: Shot | None = None  # that it begins with


def moment_of(
    sketch: Sketch,
    *,
    shot: str = "",
    preset: str = "",
    values: dict[str, object] | None = None,
    steps: dict[str, int] | None = None,
    time: float | None = None,
) -> Moment:
    """Begin with a shot, where one is named, then a preset, then single values; later ones win.

    Raises ``SketchError`` or ``ParameterError`` for what the sketch does not have.
    """
    promised = sketch.shot(shot) if shot else None
    if promised is not None:
        sketch = sketch.for_shot(promised)
    if preset:
        sketch = sketch.with_preset(preset)
    if values:
        sketch = sketch.with_values(with_whole_paths(sketch, values))
    usual = promised.time if promised is not None else 0.0
    stops = dict(promised.steps) if promised is not None else {}
    size = promised.size if promised is not None else None
    return Moment(sketch, usual if time is None else time, stops | (steps or {}), size, promised)


def output_file(output: str, usual: str, endings: Sequence[str], what: str) -> AbstractContextManager[Path]:
    """Open the path of a file to write: the one that was given, or a new name like ``usual`` in this folder.

    Raises ``DataError`` where it could not be written, before anything is computed for it; ``what`` begins
    the sentence, as "a picture is".
    """
    if not output:
        from playground.files import new_name

        return new_name(usual)
    path = Path(output).expanduser()
    if path.is_dir():
        raise DataError("is a folder; expected the name of a file to write", file=output)
    if path.suffix.lower() not in endings:
        raise DataError(f"{what} written to a name ending in {either(endings)}", file=output)
    check_parent(path, output)
    return nullcontext(path)


def check_parent(path: Path, output: str) -> None:
    """Raise ``DataError`` where the folder that a file is to be written into is not there."""
    if not path.expanduser().parent.is_dir():
        raise DataError(f"there is no folder '{path.parent}' to write into", file=output)
