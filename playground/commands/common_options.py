"""What every command takes: --verbose, --quiet, --root and --help; and helps without the names of types."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer
from typer.main import get_command

from playground.allowed_files import ROOT
from playground.errors import ParameterError
from playground.terminal import Loudness, choose_loudness, loudness


def prepared(app: typer.Typer) -> Any:
    """Return the command of an app, in which each command has the options that all have."""
    command = get_command(app)
    _prepare(command, _common())
    return command


def _prepare(command: Any, common: list[Any]) -> None:
    command.params.extend(common)
    for parameter in command.params:
        _leave_out_type(parameter)
    for child in getattr(command, "commands", {}).values():
        _prepare(child, common)


def _leave_out_type(parameter: Any) -> None:
    """Have a help show the word for a parameter's value, where it has one, and not its type in Python."""
    if parameter.param_type_name == "argument":
        if hasattr(parameter, "display_type_rich"):  # newer versions of typer show both
            parameter.display_type_rich = lambda ctx: None
    elif parameter.is_flag and parameter.metavar is None:
        parameter.metavar = ""


def _common() -> list[Any]:
    """Declare the options; typer alone knows how, so they are those of a command that is not called."""
    app = typer.Typer(add_completion=False)
    app.command(add_help_option=False)(_declared)
    parameters: list[Any] = get_command(app).params
    for option in parameters:
        option.expose_value = False  # a command's function does not take them
    return parameters


def _be_verbose(requested: bool) -> None:
    _choose(requested, Loudness.VERBOSE)


def _be_quiet(requested: bool) -> None:
    _choose(requested, Loudness.QUIET)


def _choose(requested: bool, chosen: Loudness) -> None:
    if not requested:
        return
    if loudness() not in (Loudness.DEFAULT, chosen):
        raise ParameterError("--verbose and --quiet exclude each other; choose one")
    choose_loudness(chosen)


def _choose_root(folder: str) -> None:
    if not folder:
        return
    path = Path(folder).expanduser()
    if not path.is_dir():
        raise ParameterError(f"--root {folder}: expected a folder that is there")
    os.environ[ROOT] = str(path.resolve())


@contextmanager
def with_root() -> Iterator[None]:
    """Forget in the end which root was chosen."""
    before = os.environ.get(ROOT)
    try:
        yield
    finally:
        os.environ.pop(ROOT, None)
        os.environ |= {} if before is None else {ROOT: before}


def _print_help(ctx: typer.Context, requested: bool) -> None:
    if requested:
        print(ctx.get_help())
        raise typer.Exit()


def _declared(
    verbose: Annotated[
        bool,
        typer.Option(
            "--verbose",
            "-v",
            help="Log each step with its time on standard error: files, OpenGL, compiling, caches.",
            metavar="",
            callback=_be_verbose,
            is_eager=True,
        ),
    ] = False,
    quiet: Annotated[
        bool,
        typer.Option(
            "--quiet",
            "-q",
            help="Print only errors and the requested output: no notes, warnings or progress.",
            metavar="",
            callback=_be_quiet,
            is_eager=True,
        ),
    ] = False,
    root: Annotated[
        str,
        typer.Option(
            "--root",
            help="Let sketches and shaders in this folder read all of it, not their own folder alone.",
            metavar="FOLDER",
            callback=_choose_root,
            is_eager=True,
            show_default=False,
        ),
    ] = "",
    help_: Annotated[
        bool,
        typer.Option(
            "--help",
            "-h",
            help="Show this message and exit.",
            metavar="",
            callback=_print_help,
            is_eager=True,
        ),
    ] = False,
) -> None:
    """Declare what every command takes."""
