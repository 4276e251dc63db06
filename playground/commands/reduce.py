"""Shrink a sketch that fails to the smallest that still fails."""

from __future__ import annotations

import os
import re
import sys
import time as clock
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands.arguments import (
    DeviceOption,
    Renderer,
    SetOption,
    SizeOption,
    SketchArgument,
    SoftwareOption,
    StepsOption,
    TimeOption,
    help_text,
    moment_of,
    quoted,
    read_device,
    read_driver,
    read_pixels,
    read_seconds,
    read_steps,
    read_values,
)
from playground.errors import ParameterError
from playground.terminal import console_for, note

if TYPE_CHECKING:
    from playground.reduce.initial_case import Question
    from playground.reduce.search import Search, State

HELP = help_text(
    "Shrink a sketch that fails to the smallest that still fails in the same way.\n\n"
    "Passes, parameters, sizes, lines and parts of expressions are taken out as long as it fails. What"
    " failing means is chosen by an option; without one, what the compiler refuses, a crash, NaN and"
    " a difference between the two drivers are looked for in turn. What is left goes into a folder, with"
    " a text for a report to the driver's makers. Ctrl-C keeps the smallest so far.",
    "playground reduce my-land                         # whatever fails",
    "playground reduce my-land --nan --pass height     # NaN or infinity in one pass",
    "playground reduce my-land --shot morning          # off its reference",
    "playground reduce my-land --drivers               # fragment and compute differ",
    "playground reduce my-land --against GALLIUM_DRIVER=softpipe",
    "playground reduce my-land --error 'no matching function' --plain",
    "playground reduce my-land --crash --limit 600 -o for-the-report",
    "playground reduce my-land --command 'playground render . -o out.png && ./is-good out.png'",
)
_FRAME = (64, 36)  # pixels, of a picture for which nobody asks another
_EVERY = 5.0  # [s] between lines of progress where there is no terminal


def reduce(
    ctx: typer.Context,
    sketch: SketchArgument = "",
    output: Annotated[
        str,
        typer.Option(
            "-o",
            "--output",
            help="The folder to write. Without it, NAME-reduced in this folder.",
            metavar="FOLDER",
            show_default=False,
        ),
    ] = "",
    shot: Annotated[
        str,
        typer.Option(
            "--shot",
            help="A shot that is off its reference; with another option, the moment to look at.",
            metavar="NAME",
            show_default=False,
        ),
    ] = "",
    drivers: Annotated[bool, typer.Option("--drivers", metavar="", help="The two drivers differ.")] = False,
    against: Annotated[
        list[str] | None,
        typer.Option(
            "--against",
            help="It differs where this is set in the environment. May be repeated.",
            metavar="ENV=VALUE",
            show_default=False,
        ),
    ] = None,
    against_device: Annotated[
        str,
        typer.Option(
            "--against-device", help="It differs on this EGL device.", metavar="N", show_default=False
        ),
    ] = "",
    nan: Annotated[bool, typer.Option("--nan", metavar="", help="A value is NaN or infinite.")] = False,
    anywhere: Annotated[
        bool,
        typer.Option(
            "--anywhere",
            metavar="",
            help="With --nan: let it turn up at other texels. Smaller, but it may be another NaN.",
        ),
    ] = False,
    error: Annotated[
        str,
        typer.Option(
            "--error",
            help="The compiler refuses with a message that this regular expression finds.",
            metavar="REGEX",
            show_default=False,
        ),
    ] = "",
    crash: Annotated[bool, typer.Option("--crash", metavar="", help="The driver crashes.")] = False,
    hang: Annotated[
        bool, typer.Option("--hang", metavar="", help="A candidate takes over --timeout.")
    ] = False,
    command: Annotated[
        str,
        typer.Option(
            "--command",
            help="A command, run where sketch.toml lies: 0 is good, 125 no answer, others up to 127 fail.",
            metavar="COMMAND",
            show_default=False,
        ),
    ] = "",
    path: Annotated[
        str,
        typer.Option("--pass", help="Look at this pass only.", metavar="PASS", show_default=False),
    ] = "",
    tolerance: Annotated[
        float, typer.Option("--tolerance", help="How far apart two sides may be.", metavar="X", min=0.0)
    ] = 0.0,
    driver: Annotated[
        str,
        typer.Option(
            "--driver",
            help="What runs the kernels: auto, fragment or compute. Without it, each is tried.",
            metavar="NAME",
            show_default=False,
        ),
    ] = "",
    limit: Annotated[
        str,
        typer.Option("--limit", help="Stop after so many seconds.", metavar="SECONDS", show_default=False),
    ] = "",
    tries: Annotated[
        int, typer.Option("--tries", help="Stop after so many tries; 0: never.", metavar="N", min=0)
    ] = 0,
    timeout: Annotated[
        float,
        typer.Option("--timeout", help="Seconds that one candidate may take.", metavar="SECONDS", min=0.1),
    ] = 10.0,
    plain: Annotated[
        bool,
        typer.Option(
            "--plain", metavar="", help="Also write the shader as the driver sees it, if that still fails."
        ),
    ] = False,
    settings: SetOption = None,
    size: SizeOption = None,
    time: TimeOption = "",
    steps: StepsOption = None,
    software: SoftwareOption = False,
    device: DeviceOption = "",
) -> None:
    """Shrink a sketch that fails to the smallest that still fails."""
    from playground.reduce.initial_case import Question
    from playground.sketch.load import load

    kinds = {
        "--drivers": drivers,
        "--against": bool(against or against_device),
        "--nan": nan,
        "--error": bool(error),
        "--crash": crash,
        "--hang": hang,
        "--command": bool(command),
    }
    chosen = [option for option, given in kinds.items() if given]
    if len(chosen) > 1:
        raise ParameterError(f"{' and '.join(chosen)}: only one thing can be what fails")
    kind = chosen[0].removeprefix("--") if chosen else "shot" if shot else ""
    renderer: Renderer = ctx.obj.or_else(software, device)
    moment = moment_of(
        load(sketch),
        shot=shot,
        values=read_values(settings),
        steps=read_steps(steps),
        time=read_seconds(time),
    )
    if kind == "shot" and (settings or size or time or steps):
        raise ParameterError("--shot is compared as it stands; leave out --set, --size, --time and --steps")
    question = Question(
        sketch=load(sketch) if kind == "shot" else moment.sketch,
        kind=kind,
        shot=shot if kind == "shot" else "",
        frame=read_pixels(size) or moment.size or _FRAME,
        time=moment.time,
        steps=moment.steps,
        path=path,
        driver=read_driver(driver) if driver else "",
        pattern=_pattern(error),
        command=command,
        environment=_environment(against),
        other_device=read_device(against_device),
        tolerance=tolerance,
        anywhere=anywhere,
        software=renderer.software,
        device=renderer.device,
        limit=timeout,
    )
    if anywhere and kind != "nan":
        raise ParameterError("--anywhere is for --nan")
    if plain and kind not in ("", "error", "crash", "hang"):
        raise ParameterError("--plain is for what the compiler refuses or dies of: --error, --crash, --hang")
    folder = Path(output).expanduser() if output else Path(f"{question.sketch.name}-reduced")
    _reduce(question, folder, read_seconds(limit) or 0.0, tries, plain)


def _pattern(text: str) -> str:
    try:
        re.compile(text)
    except re.error as error:
        raise ParameterError(f"--error {text}: no regular expression: {error}") from None
    return text


def _environment(given: list[str] | None) -> dict[str, str]:
    found = {}
    for text in given or ():
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise ParameterError(f"--against {text}: expected ENV=VALUE, as MESA_GL_VERSION_OVERRIDE=4.1")
        found[name.strip()] = value
    return found


def _reduce(question: Question, folder: Path, limit: float, tries: int, plain: bool) -> None:
    from playground.reduce.initial_case import CandidateBench
    from playground.reduce.output import Account, claim, plain_texts, to_reproduce, write_folder
    from playground.reduce.search import Search

    claim(folder)
    with CandidateBench(question) as bench, _shown() as tell:
        beginning = bench.begin()
        probe = beginning.probe
        found = beginning.finding
        # A refusal's word is its message; of the rest, the details say where and how much.
        note(found.kind if found.messages else f"{found.kind}: {found.details}")
        search = Search(beginning.case, beginning.finding, probe, seconds=limit, tries=tries, progress=tell)
        stopped = False
        try:
            search.run()
        except KeyboardInterrupt:
            stopped = True
        finding = search.confirmed()
        if finding is None:
            note("what is left does not fail every time: say so where you report it")
            finding = search.finding
        shader = plain_texts(search.best, probe, finding, bench.processes[0]) if plain else {}
        finding = replace(finding, details=finding.details.replace(f"{probe.folder}{os.sep}", ""))
    account = Account(
        command_line=f"playground {' '.join(map(quoted, sys.argv[1:]))}",
        sketch=question.sketch.name,
        before=beginning.case,
        after=search.best,
        finding=finding,
        renderers=beginning.renderers,
        environments=({}, question.environment),
        tries=search.tries,
        seconds=search.state.seconds,
        finished=search.finished,
        reproduce=to_reproduce(question, folder, search.best, probe.failure),
    )
    for path in write_folder(folder, account, shader):
        print(path)
    if plain and not shader:
        note("the plain shader does not fail in the same way, so none is written")
    note(_summary(beginning.case.lines, search))
    if stopped:
        raise typer.Exit(130)


def _summary(before: int, search: Search) -> str:
    state = search.state
    rate = search.tries / state.seconds if state.seconds else 0.0
    end = "nothing more goes" if search.finished else "stopped; it may be shortened further"
    return (
        f"{before} lines to {state.lines} in {search.tries} tries, {state.seconds:.1f} s"
        f" ({rate:.0f} a second); {end}"
    )


@contextmanager
def _shown() -> Iterator[Callable[[State], None]]:
    """Show how far it is, on standard error."""
    last = clock.monotonic()

    def line(state: State) -> str:
        rate = state.tries / state.seconds if state.seconds else 0.0
        return f"{state.what}: {state.lines} lines left, {state.tries} tries, {rate:.0f} a second"

    if sys.stderr.isatty():
        with console_for(sys.stderr).status("looking for what fails …") as status:
            yield lambda state: status.update(line(state))
        return

    def tell(state: State) -> None:
        nonlocal last
        if clock.monotonic() - last > _EVERY:
            last = clock.monotonic()
            note(line(state))

    yield tell
