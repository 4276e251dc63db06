"""The room's commands, and the picture that is rendered where there is no display."""

import typer

from playground.commands.arguments import Renderer, moment_of
from playground.paths import program
from playground.publish.commands import export, pack, render
from playground.terminal import note


def add_to(app: typer.Typer) -> None:
    """Add the room's commands to a command line."""
    app.command("render", help=render.HELP)(render.render)
    app.command("export", help=export.HELP)(export.export)
    app.command("pack", help=pack.HELP)(pack.pack)


def open_default(renderer: Renderer) -> bool:
    """Render the default sketch."""
    from playground.sketch.load import load

    note(f"no display here, so a picture is rendered instead; {program()} --help lists the commands")
    render.write_output(moment_of(load()), render.Output(), renderer)
    return True
