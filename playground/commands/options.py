"""The options and arguments that commands share, and how an own one is declared."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, Any

import typer

from playground.commands.arguments import (
    Pixels,
    either,
    read_device,
    read_driver,
    read_pixels,
    read_seconds,
)
from playground.errors import PlaygroundError
from playground.shader.kernel import DRIVERS


def value(
    usage: str,
    text: str,
    complete: Callable[..., list[str]] | None = None,
    *,
    read: Callable[[str], Any] | None = None,
) -> Any:
    """Declare an option with a value by its usage, as ``-o --output FILE``; its default is not shown.

    ``read`` returns the value that its text says, or raises ``ParameterError``.
    """
    *names, metavar = usage.split()
    return typer.Option(
        *names, help=text, metavar=metavar, show_default=False, autocompletion=complete, parser=read
    )


def flag(name: str, text: str) -> Any:
    """Declare an option without a value."""
    return typer.Option(name, help=text, metavar="")


def positional(metavar: str, text: str, complete: Callable[[str], list[str]] | None = None) -> Any:
    """Declare a positional argument; its default is not shown."""
    return typer.Argument(help=text, metavar=metavar, show_default=False, autocompletion=complete)


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


def complete_dialect(incomplete: str) -> list[str]:
    """Return the dialects that complete a word."""
    from playground.shader.dialect import dialects

    return [name for name in dialects().names if name.startswith(incomplete)]


def complete_setting(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the parameters, as ``path=``, that complete a word."""
    from playground.sketch.assign import TERRAIN_KEYS, shown_parameters
    from playground.sketch.load import load

    try:
        sketch = load(ctx.params.get("sketch") or "")
    except PlaygroundError:
        return []
    paths = [*(shown.path for shown in shown_parameters(sketch)), *TERRAIN_KEYS]
    return [f"{path}=" for path in paths if path.startswith(incomplete)]


Sketch = Annotated[
    str,
    positional(
        "SKETCH",
        "A shipped sketch's name, or the path of a sketch, of its folder, of a packed one (.zip), of"
        " a shader or an elevation file. Without it, the default sketch.",
        complete_sketch,
    ),
]
Size = Annotated[Pixels | None, value("--size WxH", "Size in pixels, as 1280x720.", read=read_pixels)]
Set = Annotated[
    list[str] | None,
    value(
        "--set PATH=VALUE",
        "Set a parameter, as light.sun=250,12, or the terrain, as size=513. May be repeated.",
        complete_setting,
    ),
]
Preset = Annotated[str, value("--preset NAME", "Begin with a preset.")]
Time = Annotated[float | None, value("--time T", "Time in seconds.", read=read_seconds)]
Steps = Annotated[
    list[str] | None,
    value("--steps PASS=COUNT", "Stop a repeated pass after COUNT iterations. May be repeated."),
]
Driver = Annotated[
    str,
    value("--driver NAME", f"What runs the kernels: {either(DRIVERS)}.", complete_driver, read=read_driver),
]
Plain = Annotated[bool, flag("--plain", "Run every technique in its plain form, no fast variant.")]
Dialect = Annotated[
    str,
    value(
        "--dialect NAME",
        "Read a shader as that of another tool: main, shadertoy, or own for none; by its text without it.",
        complete_dialect,
    ),
]
Software = Annotated[bool, flag("--software", "Render in software, on the CPU (Mesa llvmpipe).")]
Device = Annotated[int | None, value("--device N", "Render on this EGL device, from 0.", read=read_device)]
Json = Annotated[bool, flag("--json", "Print JSON, for programs.")]
