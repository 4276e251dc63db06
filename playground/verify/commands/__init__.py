"""The room's commands."""

import typer

from playground.verify.commands import bench, check, reduce, shots, variants


def add_to(app: typer.Typer) -> None:
    """Add the room's commands to a command line."""
    app.command("check", help=check.HELP)(check.check)
    app.command("reduce", help=reduce.HELP)(reduce.reduce)
    app.command("bench", help=bench.HELP)(bench.bench)
    app.add_typer(shots.app)
    app.add_typer(variants.app)
