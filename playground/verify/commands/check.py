"""Check shaders and sketches in the sandbox process."""

from __future__ import annotations

import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import FAILED, Renderer, help_text, read_option, within
from playground.commands.options import flag, value
from playground.commands.standard_input import kept_path
from playground.errors import Diagnostic, counted
from playground.terminal import painted, print_json, progress

if TYPE_CHECKING:
    from playground.verify.check import FileReport


HELP = help_text(
    "Check shaders and sketches.\n\n"
    "Compiles every kernel by both drivers, loads every sketch, draws a small frame of each. A folder is"
    " searched for .glsl, .comp, .frag and .toml. What takes longer than --limit or crashes the driver is"
    " stopped and reported, and so are NaN and infinity: any in a sketch; in a technique, which is drawn on"
    " stand-ins, a texture of nothing else. Where there are no compute shaders, they are skipped. Exit"
    " status 1 when anything fails. As PATH, - checks a shader's text from standard input, which is kept as"
    " a new file in this folder.",
    "playground check my-land",
    "playground check land.glsl sketch.toml",
    "playground check - < shader.frag",
    "playground check --json glsl | jq 'select(.ok | not)'",
)


def check(
    ctx: typer.Context,
    paths: Annotated[list[Path], typer.Argument(help="Files, and folders to search.", metavar="PATH...")],
    as_json: Annotated[bool, flag("--json", "Print one JSON object a file, a line each.")] = False,
    limit: Annotated[
        str, value("--limit SECONDS", "Processor time that each pass may take, 10 s by default.")
    ] = "",
    plain: options.Plain = False,
    dialect: options.Dialect = "",
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Check shaders and sketches."""
    from playground.engine.sandbox import LIMIT_SECONDS, Sandbox
    from playground.shader.dialect import check_name
    from playground.verify.check import check_file, find_files

    renderer: Renderer = ctx.obj.or_else(software, device)
    seconds = read_option("--limit", limit, within(0.1, 86_400.0), "seconds, 0.1 to 86400, as 60")
    files = find_files([kept_path(path, "check") for path in paths])
    failed, skipped = 0, False
    printed: set[Diagnostic] = set()  # errors: those of a kernel are errors of the sketch that uses it, too
    reported: set[Diagnostic] = set()  # a warning of a kernel is one of the sketch that uses it, too
    with (
        Sandbox(
            limit_seconds=seconds or LIMIT_SECONDS, software=renderer.software, device=renderer.device
        ) as sandbox,
        progress("checking", len(files)) as advance,
    ):
        for path, root in files:
            report = check_file(path, sandbox, root, plain=plain, dialect=check_name(dialect))
            report = replace(report, warnings=tuple(w for w in report.warnings if w not in reported))
            reported |= set(report.warnings)
            failed += not report.ok
            skipped |= bool(report.skipped)
            if as_json:
                print_json(report.as_json(), indent=None)
            else:
                _print_report(report, printed)
            advance()
    if not as_json:
        warned = f", {counted(len(reported), 'warning')}" if reported else ""
        why = "; compute was skipped, because this context has no compute shaders" if skipped else ""
        print(f"{counted(len(files), 'file')} checked, {failed or 'none'} failed{warned}{why}")
    if failed:
        raise typer.Exit(FAILED)


def _print_report(report: FileReport, printed: set[Diagnostic]) -> None:
    """Print a report; of errors that are ``printed`` already, a line that names their files."""
    mark = painted("ok", "32", sys.stdout) if report.ok else painted("FAILED", "1;31", sys.stdout)
    skipped = f"  (skipped: {', '.join(report.skipped)})" if report.skipped else ""
    print(f"{mark}{' ' * (6 if report.ok else 2)}{report.path}{skipped}")
    alike = {error: replace(error, chain=()) for error in report.errors}  # however it is included
    again = [error for error in report.errors if alike[error] in printed]
    if again:
        files = ", ".join(dict.fromkeys(diagnostic.file for diagnostic in again))
        print(f"        {counted(len(again), 'error')} of {files}, printed above")
    for diagnostic in (*(error for error in report.errors if error not in again), *report.warnings):
        text = str(diagnostic) if diagnostic.severity == "error" else f"{diagnostic.severity}: {diagnostic}"
        print("\n".join(f"        {line}" for line in text.split("\n")))
    printed |= set(alike.values())
    for message in report.notes:
        print(f"        note: {message}")
    sys.stdout.flush()  # a pipe's reader sees each file as it is done
