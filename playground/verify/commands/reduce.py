"""Shrink a sketch that fails to the smallest that still fails."""

from __future__ import annotations

import os
import re
import sys
import time as clock
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import (
    Moment,
    Renderer,
    help_text,
    moment_of,
    read_device,
    read_driver,
    read_option,
    read_seconds,
    read_steps,
    read_values,
    refuse,
    within,
)
from playground.commands.options import complete_driver, flag, value
from playground.errors import ParameterError
from playground.paths import quoted
from playground.terminal import console_for, has_bars, note

if TYPE_CHECKING:
    from playground.verify.reduce.initial_case import Question
    from playground.verify.reduce.search import Search, State

HELP = help_text(
    "Shrink a sketch that fails to the smallest that still fails in the same way.\n\n"
    "Passes, parameters, sizes, lines and parts of expressions are taken out as long as it fails. What"
    " failing means is chosen by an option; without one, what the compiler refuses, a crash, NaN and"
    " a difference between the two drivers are looked for, in that order. The result goes into a folder,"
    " with a text for a report to the driver's makers. Ctrl-C keeps the smallest so far.",
    "playground reduce my-land                         # any failure",
    "playground reduce my-land --nan --pass height     # NaN or infinity in one pass",
    "playground reduce my-land --shot morning          # off its reference",
    "playground reduce my-land --drivers               # fragment and compute differ",
    "playground reduce my-land --against GALLIUM_DRIVER=softpipe",
    "playground reduce my-land --error 'no matching function' --plain",
    "playground reduce my-land --crash --limit 600 -o for-the-report",
    "playground reduce my-land --command 'playground render . -o out.png && ./is-good out.png'",
)
_FRAME = (64, 36)  # pixels, of a picture without --size and --shot
_EVERY = 5.0  # [s] between lines of progress where there is no terminal


def reduce(
    ctx: typer.Context,
    sketch: options.Sketch = "",
    output: Annotated[
        str,
        value("-o --output FOLDER", "The folder to write. Without it, NAME-reduced in this folder."),
    ] = "",
    shot: Annotated[
        str,
        value("--shot NAME", "A shot that is off its reference; with another option, the moment to use."),
    ] = "",
    drivers: Annotated[bool, flag("--drivers", "The two drivers differ.")] = False,
    against: Annotated[
        list[str] | None,
        value("--against ENV=VALUE", "It differs where this is set in the environment. May be repeated."),
    ] = None,
    against_device: Annotated[
        int | None, value("--against-device N", "It differs on this EGL device.", read=read_device)
    ] = None,
    nan: Annotated[bool, flag("--nan", "A value is NaN or infinite.")] = False,
    anywhere: Annotated[
        bool,
        flag("--anywhere", "With --nan: let it appear at other texels. Smaller, but maybe another NaN."),
    ] = False,
    error: Annotated[
        str,
        value("--error REGEX", "The compiler refuses with a message that this regular expression finds."),
    ] = "",
    crash: Annotated[bool, flag("--crash", "The driver crashes.")] = False,
    hang: Annotated[bool, flag("--hang", "A candidate takes over --timeout.")] = False,
    command: Annotated[
        str,
        value(
            "--command COMMAND",
            "A command, run where sketch.toml is: 0 is good, 125 no answer, others up to 127 fail.",
        ),
    ] = "",
    path: Annotated[str, value("--pass PASS", "Look at this pass only.")] = "",
    tolerance: Annotated[str, value("--tolerance X", "How far apart two sides may be; 0 by default.")] = "",
    driver: Annotated[
        str,
        value(
            "--driver NAME",
            "What runs the kernels: auto, fragment or compute. Without it, each is tried.",
            complete_driver,
        ),
    ] = "",
    limit: Annotated[str, value("--limit SECONDS", "Stop after this number of seconds.")] = "",
    tries: Annotated[str, value("--tries N", "Stop after this number of tries; without it, never.")] = "",
    timeout: Annotated[
        str, value("--timeout SECONDS", "Seconds that one candidate may take; 10 by default.")
    ] = "",
    plain: Annotated[
        bool, flag("--plain", "Also write the shader as the driver sees it, if that still fails.")
    ] = False,
    settings: options.Set = None,
    size: options.Size = None,
    time: options.Time = None,
    steps: options.Steps = None,
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Shrink a sketch that fails to the smallest that still fails."""
    from playground.verify.reduce.initial_case import Criterion, Question

    apart = read_option("--tolerance", tolerance, within(0.0, 1e9), "a number, 0 or more, as 0.01")
    most = read_option("--tries", tries, within(0, 10**9), "a whole number; 0 for no end")
    seconds = read_option("--timeout", timeout, within(0.1, 1e6), "seconds, 0.1 or more, as 10")
    kinds = {
        "drivers": drivers,
        "against": bool(against) or against_device is not None,
        "nan": nan,
        "error": bool(error),
        "crash": crash,
        "hang": hang,
        "command": bool(command),
    }
    kind = _kind([name for name, is_set in kinds.items() if is_set], shot)
    moment = _moment(sketch, kind, shot, settings, steps, time)
    _check_options(
        kind, anywhere=anywhere, plain=plain, moved=bool(settings or size or steps) or time is not None
    )
    renderer: Renderer = ctx.obj.or_else(software, device)
    question = Question(
        sketch=moment.sketch,
        criterion=Criterion(
            kind=kind,
            pattern=_pattern(error),
            command=command,
            tolerance=apart or 0.0,
            anywhere=anywhere,
        ),
        shot=shot if kind == "shot" else "",
        frame=size or moment.size or _FRAME,
        time=moment.time,
        steps=moment.steps,
        path=path,
        driver=read_driver(driver) if driver else "",
        environment=_environment(against),
        other_device=against_device,
        software=renderer.software,
        device=renderer.device,
        limit=seconds or 10.0,
    )
    folder = Path(output).expanduser() if output else Path(f"{question.sketch.name}-reduced")
    _reduce(question, folder, read_seconds(limit) or 0.0, most or 0, plain)


def _kind(chosen: Sequence[str], shot: str) -> str:
    """Return what failing means, "" where it is to be found out; raise ``ParameterError`` for two."""
    if len(chosen) > 1:
        options = " and ".join(f"--{name}" for name in chosen)
        raise ParameterError(f"{options}: only one thing can be what fails")
    return chosen[0] if chosen else "shot" if shot else ""


def _check_options(kind: str, *, anywhere: bool, plain: bool, moved: bool) -> None:
    """Raise ``ParameterError`` for options that do not go together."""
    as_it_is = "--shot is compared as it is; leave out --set, --size, --time and --steps"
    of_compiler = "--plain is for what the compiler refuses or dies of: --error, --crash, --hang"
    refuse(
        {
            as_it_is: kind == "shot" and moved,
            "--anywhere is for --nan": anywhere and kind != "nan",
            of_compiler: plain and kind not in ("", "error", "crash", "hang"),
        }
    )


def _moment(
    sketch: str, kind: str, shot: str, settings: list[str] | None, steps: list[str] | None, time: float | None
) -> Moment:
    """Return the moment to look at; a shot off its reference is set by the comparison itself."""
    from playground.sketch.load import load

    loaded = load(sketch)
    values, stops = read_values(settings), read_steps(steps)
    moment = moment_of(loaded, shot=shot, values=values, steps=stops, time=time)
    return replace(moment, sketch=loaded) if kind == "shot" else moment


def _pattern(text: str) -> str:
    try:
        re.compile(text)
    except re.error as error:
        raise ParameterError(f"--error {text}: no regular expression: {error}") from None
    return text


def _environment(settings: list[str] | None) -> dict[str, str]:
    variables = {}
    for text in settings or ():
        name, equals, value = text.partition("=")
        if not equals or not name.strip():
            raise ParameterError(f"--against {text}: expected ENV=VALUE, as MESA_GL_VERSION_OVERRIDE=4.1")
        variables[name.strip()] = value
    return variables


def _reduce(question: Question, folder: Path, limit: float, tries: int, plain: bool) -> None:
    """Shrink the sketch, and write what is left of it into the folder."""
    from playground.verify.reduce.initial_case import CandidateBench
    from playground.verify.reduce.output import Account, claim, plain_texts, write_folder
    from playground.verify.reduce.search import Search

    claim(folder)
    with CandidateBench(question) as bench, _shown() as show:
        beginning = bench.begin()
        probe, result = beginning.probe, beginning.finding
        # The message of a refusal is its kind; of the rest, the details say where and how much.
        note(result.kind if result.messages else f"{result.kind}: {result.details}")
        search = Search(beginning.case, result, probe, seconds=limit, tries=tries, progress=show)
        stopped = False
        try:
            search.run()
        except KeyboardInterrupt:
            stopped = True
        finding = search.confirmed()
        if finding is None:
            note("the reduced sketch does not fail every time: mention it in the report")
            finding = search.finding
        shader = plain_texts(search.best, probe, finding, bench.processes[0]) if plain else {}
        finding = replace(finding, details=finding.details.replace(f"{probe.folder}{os.sep}", ""))
    command_line = f"playground {' '.join(map(quoted, sys.argv[1:]))}"
    for path in write_folder(folder, Account(command_line, question, beginning, search, finding), shader):
        print(path)
    if plain and not shader:
        note("the plain shader does not fail in the same way, so none is written")
    note(_summary(beginning.case.lines, search))
    if stopped:
        raise typer.Exit(130)


def _summary(before: int, search: Search) -> str:
    state = search.state
    end = "nothing more goes" if search.finished else "stopped; it may be shortened further"
    return (
        f"{before} lines to {state.lines} in {search.tries} tries, {state.seconds:.1f} s"
        f" ({_rate(state):.0f} a second); {end}"
    )


def _rate(state: State) -> float:
    """Return how many candidates are tried each second."""
    return state.tries / state.seconds if state.seconds else 0.0


@contextmanager
def _shown() -> Iterator[Callable[[State], None]]:
    """Show how far it is, on standard error."""
    last = clock.monotonic()

    def line(state: State) -> str:
        return f"{state.what}: {state.lines} lines left, {state.tries} tries, {_rate(state):.0f} a second"

    if has_bars():
        with console_for(sys.stderr).status("looking for what fails …") as status:
            yield lambda state: status.update(line(state))
        return

    def show(state: State) -> None:
        nonlocal last
        if clock.monotonic() - last > _EVERY:
            last = clock.monotonic()
            note(line(state))

    yield show
