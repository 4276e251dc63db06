"""Open a sketch in a window."""

from __future__ import annotations

import os
import sys
from contextlib import suppress
from typing import Annotated

import typer

from playground.commands.arguments import (
    DriverOption,
    PlainOption,
    Renderer,
    SetOption,
    SizeOption,
    SketchArgument,
    SoftwareOption,
    help_text,
    read_driver,
    read_pixels,
    read_values,
    with_whole_paths,
)
from playground.commands.lesson import LanguageOption, complete_lesson
from playground.errors import ContextError, PlaygroundError
from playground.terminal import complain

FreshOption = Annotated[
    bool, typer.Option("--fresh", metavar="", help="Forget what was set by hand the last time.")
]
NoCacheOption = Annotated[
    bool,
    typer.Option(
        "--no-cache",
        metavar="",
        help="Make all land anew, and keep none on disk (see playground cache).",
    ),
]

LessonOption = Annotated[
    str,
    typer.Option(
        "--lesson",
        metavar="NAME",
        show_default=False,
        help="Open a lesson beside it.",
        autocompletion=complete_lesson,
    ),
]

HELP = help_text(
    "Open a sketch in a window.\n\nEvery save of its files shows at once, and a panel sets its parameters."
    " What was set by hand, the camera and the time are there again the next time.",
    "playground live",
    "playground live jacksboro --size 1600x900",
    "playground live my-land --set height.seed=3",
    "playground live my-land --fresh",
    "playground live --lesson diamond_square --lang fr",
    "playground live my-land --no-cache",
    "playground live shader.frag",
)


def live(
    ctx: typer.Context,
    sketch: SketchArgument = "",
    size: SizeOption = None,
    settings: SetOption = None,
    driver: DriverOption = "auto",
    plain: PlainOption = False,
    software: SoftwareOption = False,
    fresh: FreshOption = False,
    lesson: LessonOption = "",
    lang: LanguageOption = "",
    no_cache: NoCacheOption = False,
) -> None:
    """Open a sketch in a window."""
    renderer: Renderer = ctx.obj.or_else(software)
    pixels = read_pixels(size)
    values = read_values(settings)
    check_display(renderer)
    open_window(
        sketch,
        pixels,
        renderer,
        read_driver(driver),
        values,
        plain=plain,
        fresh=fresh,
        lesson=lesson,
        language=lang,
        no_cache=no_cache,
    )


def check_display(renderer: Renderer) -> None:
    """Raise ``ContextError`` where no window can be opened, or not by what is asked for."""
    from playground.gpu.doctor import where_to_show

    if renderer.device is not None:
        raise ContextError("--device is for pictures without a window; a window opens where its display is")
    if not where_to_show(os.environ, sys.platform):
        from playground.gpu.driver_advice import mend

        raise ContextError(mend("unable to open display", sys.platform, os.environ))


def open_window(
    sketch: str,
    size: tuple[int, int] | None,
    renderer: Renderer,
    driver: str,
    values: dict[str, object],
    *,
    plain: bool = False,
    fresh: bool = False,
    lesson: str = "",
    language: str = "",
    beside: bool = False,
    no_cache: bool = False,
) -> None:
    """Open a window and stay until it is closed."""
    from playground.engine.disk_cache import limit_in

    keeps = 0 if no_cache else limit_in()
    from playground.live.app import run

    if values:
        from playground.sketch.load import load

        with suppress(PlaygroundError):  # what is wrong with the sketch, the window shows
            values = with_whole_paths(load(sketch), values)
    status = run(
        sketch,
        size=size,
        software=renderer.software,
        driver=driver,
        values=values,
        plain=plain,
        fresh=fresh,
        lesson=lesson,
        language=language,
        beside=beside,
        keeps=keeps,
        tell=complain,
    )
    if status:
        raise typer.Exit(status)
