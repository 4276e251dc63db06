"""What commands share: their options, how arguments are read, the words of their help."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

from playground.errors import ParameterError, PlaygroundError
from playground.sketch.model import DRIVERS, LARGEST_SIDE, Shot, Sketch

FAILED = 1
"""Exit status of ``check`` and ``doctor`` that found something."""


@dataclass(frozen=True, slots=True)
class Renderer:
    """Which renderer was asked for before the command."""

    software: bool = False
    device: int | None = None

    def or_else(self, software: bool, device: str = "") -> Renderer:
        """Return what was asked for before or after the command."""
        return Renderer(self.software or software, read_device(device) if device else self.device)


def help_text(text: str, *examples: str) -> str:
    r"""Return a command's help: what it does, then examples, whose lines ``\b`` keeps as they are."""
    return f"{text}\n\n\b\nExamples:\n" + "\n".join(f"  {example}" for example in examples)


def either(words: Sequence[str]) -> str:
    """Return "a, b or c"."""
    return " or ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def complete_sketch(incomplete: str) -> list[str]:
    """Return the shipped sketches that complete a word."""
    from playground.sketch.find import shipped_sketches

    return [name for name in shipped_sketches() if name.startswith(incomplete)]


def complete_listed(incomplete: str) -> list[str]:
    """Return what ``list`` knows that completes a word."""
    from playground.sketch.find import shipped_names, shipped_sketches

    names = ["sketches", "techniques", *shipped_sketches(), *shipped_names()]
    return [name for name in names if name.startswith(incomplete)]


def complete_driver(incomplete: str) -> list[str]:
    """Return the drivers that complete a word."""
    return [name for name in DRIVERS if name.startswith(incomplete)]


def complete_setting(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the parameters, as ``path=``, that complete a word."""
    from playground.sketch.catalogue import settable
    from playground.sketch.load import load

    try:
        paths = settable(load(ctx.params.get("sketch") or ""))
    except PlaygroundError:
        return []
    return [f"{path}=" for path in paths if path.startswith(incomplete)]


SketchArgument = Annotated[
    str,
    typer.Argument(
        help="A shipped sketch's name, or the path of a sketch, of its folder, of a packed one (.zip), or of"
        " a shader."
        " Without it, the default sketch.",
        metavar="SKETCH",
        show_default=False,
        autocompletion=complete_sketch,
    ),
]
SizeOption = Annotated[
    str | None, typer.Option("--size", help="Size in pixels, as 1280x720.", metavar="WxH", show_default=False)
]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        help="Set a parameter, as light.sun=250,12, or the land, as size=513. May be repeated.",
        metavar="PATH=VALUE",
        show_default=False,
        autocompletion=complete_setting,
    ),
]
TimeOption = Annotated[str, typer.Option("--time", help="Time in seconds.", metavar="T", show_default=False)]
StepsOption = Annotated[
    list[str] | None,
    typer.Option(
        "--steps",
        help="Stop a repeated pass after so many turns. May be repeated.",
        metavar="PASS=TURNS",
        show_default=False,
    ),
]
DriverOption = Annotated[
    str,
    typer.Option(
        "--driver",
        help=f"What runs the kernels: {either(DRIVERS)}.",
        metavar="NAME",
        show_default=False,
        autocompletion=complete_driver,
    ),
]
PlainOption = Annotated[
    bool,
    typer.Option("--plain", metavar="", help="Run every technique in its plain form, no fast variant."),
]
SoftwareOption = Annotated[
    bool, typer.Option("--software", metavar="", help="Draw with the processor (Mesa llvmpipe).")
]
DeviceOption = Annotated[
    str, typer.Option("--device", help="Draw on this EGL device, from 0.", metavar="N", show_default=False)
]
JsonOption = Annotated[bool, typer.Option("--json", metavar="", help="Print JSON, for programs.")]


def read_steps(texts: Sequence[str] | None) -> dict[str, int]:
    """Return the turns of ``--steps`` by pass; raise ``ParameterError``."""
    found: dict[str, int] = {}
    for text in texts or ():
        path, _, turns = text.partition("=")
        if not path.strip() or not turns.strip().isdecimal():
            raise ParameterError(f"--steps {text}: expected a pass and a whole number, as height=9")
        found[path.strip()] = int(turns)
    return found


def read_pixels(text: str | None, most: int = LARGEST_SIDE) -> tuple[int, int] | None:
    """Return the width and height of ``--size``, at most so many pixels; raise ``ParameterError``."""
    if text is None:
        return None
    width, _, height = text.lower().replace("×", "x").partition("x")
    sides = [int(side) if side.strip().isdecimal() else 0 for side in (width, height)]
    if not all(1 <= side <= most for side in sides):
        raise ParameterError(f"--size {text}: expected width and height, 1 to {most} pixels, as 1280x720")
    return sides[0], sides[1]


def read_seconds(text: str) -> float | None:
    """Return the seconds of ``--time``; raise ``ParameterError``."""
    if not text:
        return None
    try:
        seconds = float(text)
    except ValueError:
        seconds = float("nan")
    if not abs(seconds) < 1e9:
        raise ParameterError(f"--time {text}: expected a number of seconds, as 2.5")
    return seconds


def read_driver(text: str) -> str:
    """Return the driver of ``--driver``; raise ``ParameterError``."""
    if text not in DRIVERS:
        raise ParameterError(f"--driver {text}: expected {either(DRIVERS)}")
    return text


def read_device(text: str) -> int | None:
    """Return the number of ``--device``; raise ``ParameterError``."""
    if text and not (text.isdecimal() and len(text) < 4):
        raise ParameterError(f"--device {text}: expected the number of an EGL device, from 0")
    return int(text) if text else None


def read_values(settings: Sequence[str] | None) -> dict[str, object]:
    """Split ``path=value`` settings; the last of a path counts."""
    found: dict[str, object] = {}
    for setting in settings or ():
        path, equals, value = setting.partition("=")
        path = path.strip()
        if not equals or not path:
            raise ParameterError(f"--set {setting}: expected PATH=VALUE, as light.sun=250,12 or size=513")
        found.pop(path, None)
        found[path] = value.strip()
    return found


def with_whole_paths(sketch: Sketch, values: dict[str, object]) -> dict[str, object]:
    """Make the files among the values absolute: the user named them from the current folder.

    A name that is not there but in the sketch's folder or in ``glsl/`` is left as it is.
    """
    from playground.paths import GLSL
    from playground.sketch.assign import resolve

    found = dict(values)
    for path, value in values.items():
        try:
            parameter = resolve(sketch.graph, path)[0].parameter
        except PlaygroundError:
            continue  # the land's own, or a mistake that with_values explains
        text = str(value)
        if parameter.widget.kind != "file" or not text:
            continue
        here = Path(text).expanduser()
        elsewhere = any((Path(folder) / text).is_file() for folder in (sketch.folder, GLSL))
        if here.exists() or not elsewhere:
            found[path] = str(Path.cwd() / here)
    return found


@dataclass(frozen=True, slots=True)
class Moment:
    """A sketch as it was asked for: its values, when, how many turns, and how large where a shot says so."""

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
    """Begin with a shot, where one is named, then a preset, then single values; later words count.

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
    turns = dict(promised.steps) if promised is not None else {}
    size = promised.size if promised is not None else None
    return Moment(sketch, usual if time is None else time, turns | (steps or {}), size, promised)


def quoted(text: str) -> str:
    """Return a word as the shell takes it."""
    if sys.platform == "win32":
        return f'"{text}"' if " " in text else text
    import shlex

    return shlex.quote(text)
