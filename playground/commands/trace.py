"""Print every value of one texel beside the lines that computed it, or where two such runs part."""

from __future__ import annotations

import math
import shutil
import sys
import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any

import typer

from playground.commands import options
from playground.commands.arguments import (
    Moment,
    Renderer,
    help_text,
    moment_of,
    read_option,
    read_values,
    refuse,
    within,
)
from playground.commands.options import positional, value
from playground.commands.standard_input import kept
from playground.errors import ParameterError, PlaygroundError
from playground.paths import shown
from playground.shader.parameter import read_whole
from playground.sketch.model import DEFAULT_PICTURE
from playground.terminal import busy, note, painted, print_json

if TYPE_CHECKING:
    from playground.engine.engine import Engine
    from playground.engine.trace.listing import AnnotatedLine
    from playground.engine.trace.model import Event, Loop, Trace

HELP = help_text(
    "Print what a shader computed for one texel: every value, beside the line that gave it.\n\n"
    "X and Y are the texel's column and row, from the south-west corner, 0, 0, of the texture of PASS, which"
    " may lie inside a technique, as height.raw. Values of several calls or iterations are separated by |,"
    " ? shows conditions, → what a function returns. The traced run is compared with the real texel, and the"
    " first line says whether it is the same, bit for bit. NaN and infinity are marked.\n\n"
    "With --compare or --against, the first value is printed that differs between two runs, of two texels or"
    " with other parameters, and the first condition by which they take different paths. Numbers that are not"
    " finite are texts in JSON: NaN, Infinity, -Infinity.",
    "playground trace diamond_square height.raw 192 320 --iteration 5",
    "playground trace diamond_square height.raw 192 320 --iteration 5 --loop i",
    "playground trace jacksboro light.visibility 300 200 --function all",
    "playground trace fbm height 10 20 --set height.octaves=3 --json",
    "playground trace l_dot_n product 10 20 --compare 11 20",
    "playground trace l_dot_n product 10 20 --against product.sun=90,10",
    "playground trace shader.frag view 320 180 --time 2.5",
)

_MAX_LOOPS = 3  # runs of the loop of --loop that are printed
_MIN_NOTE = 24  # letters of a line that values have at least
_ROWS = 40  # of a loop's table on a terminal


def _complete_pass(ctx: typer.Context, incomplete: str) -> list[str]:
    """Return the passes of the sketch that complete a word."""
    from playground.sketch.flatten import flatten
    from playground.sketch.load import load

    try:
        outputs = flatten(load(ctx.params.get("sketch") or "")).outputs
    except PlaygroundError:
        return []
    return [path for path in outputs if path.startswith(incomplete)]


@dataclass(frozen=True, slots=True)
class _Asked:
    """One run to trace."""

    moment: Moment
    path: str
    texel: tuple[int, int]
    iteration: int | None
    function: str | None

    def __str__(self) -> str:
        return f"texel {self.texel[0]}, {self.texel[1]} of {self.path}"


def trace(
    ctx: typer.Context,
    sketch: Annotated[
        str,
        positional(
            "SKETCH",
            "A shipped sketch's name, or the path of a sketch, of its folder or of a shader.",
            options.complete_sketch,
        ),
    ],
    path: Annotated[
        str,
        positional("PASS", "The pass, one inside a technique as height.raw.", _complete_pass),
    ],
    x: Annotated[str, positional("X", "The texel's column, from the west, 0.")],
    y: Annotated[str, positional("Y", "The texel's row, from the south, 0.")],
    loop: Annotated[
        str,
        value("--loop NAME", "Print a table of the loop over this variable, or of that line, too."),
    ] = "",
    iteration: Annotated[
        str,
        value(
            "--iteration N",
            "Of a repeated pass, or of the loop around it: this iteration, from 0; the last without it.",
        ),
    ] = "",
    function: Annotated[
        str,
        value(
            "--function NAME",
            "Record this function alone, or all: those of included files too, which compile longer.",
        ),
    ] = "",
    compare: Annotated[
        tuple[str, str] | None,
        typer.Option("--compare", help="Print where this texel's run parts from it.", metavar="X2 Y2"),
    ] = None,
    against: Annotated[
        list[str] | None,
        value(
            "--against PATH=VALUE",
            "Print where a run with this value parts from it. May be repeated.",
            options.complete_setting,
        ),
    ] = None,
    settings: options.Set = None,
    shot: Annotated[str, value("--shot NAME", "Trace a shot of the sketch.")] = "",
    preset: options.Preset = "",
    time: options.Time = None,
    size: options.Size = None,
    as_json: options.Json = False,
    dialect: options.Dialect = "",
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Print every value of one texel beside the code."""
    from playground.sketch.load import load

    refuse({"--compare and --against exclude each other; choose one": compare and against})
    refuse({"--loop is for one run; leave out --compare and --against": loop and (compare or against)})
    moment = moment_of(
        load(kept(sketch, "trace"), dialect=dialect),
        shot=shot,
        preset=preset,
        values=read_values(settings),
        time=time,
    )
    if size is not None:
        moment = replace(moment, size=size)
    step = read_option("--iteration", iteration, within(0, 2**31 - 1), "a whole number from 0")
    asked = _Asked(moment, path, _read_texel(x, y), step, function or None)
    runs = [asked]
    if compare:
        runs.append(replace(asked, texel=_read_texel(*compare)))
    elif against:
        other = moment_of(moment.sketch, values=read_values(against), steps=moment.steps, time=moment.time)
        runs.append(replace(asked, moment=replace(other, size=moment.size)))
    renderer: Renderer = ctx.obj.or_else(software, device)
    with busy(f"tracing {asked}"), renderer.open_engine() as engine:
        traces = [_traced(engine, each) for each in runs]
    if len(traces) > 1:
        _print_difference(traces, as_json)
    elif as_json:
        print_json(_as_json(traces[0]))
    else:
        _print_trace(traces[0], loop)


def _read_texel(x: str, y: str) -> tuple[int, int]:
    """Return a texel; raise ``ParameterError`` for what are no whole numbers."""
    column, row = read_whole(x), read_whole(y)
    if column is None or row is None:
        raise ParameterError(f"texel {x} {y}: expected its column and its row, whole numbers from 0")
    return column, row


def _traced(engine: Engine, asked: _Asked) -> Trace:
    """Trace one run; raise ``PlaygroundError`` for what there is not."""
    from playground.engine.plan import drawn_size

    moment, tracer = asked.moment, engine.tracer
    size = drawn_size(moment.sketch, moment.size or DEFAULT_PICTURE)
    plan = tracer.plan(moment.sketch, asked.path, size, moment.time, moment.steps)
    return tracer.trace(plan, asked.path, asked.texel, asked.iteration, asked.function)


# ── one run ──────────────────────────────────────────────────────────────────


def _print_trace(trace: Trace, loop: str) -> None:
    from playground.engine.trace.listing import annotated, event_text, heading, loop_table

    tables = _loops(trace, loop) if loop else []
    print(heading(trace))
    if bad := trace.first_not_finite():
        text = f"! first NaN or infinity: {event_text(bad)}, {shown(bad.path)}:{bad.line}"
        print(painted(text, "1;31", sys.stdout))
    for path in dict.fromkeys([*trace.files, *(event.path for event in trace.events)]):
        if lines := annotated(trace, path):
            print(painted(f"── {shown(path)}", "1", sys.stdout))
            for row in _rows(lines):
                print(row)
    for table in tables[:_MAX_LOOPS]:
        call = trace.calls[table.call]
        over = f"over {table.variable}, " if table.variable else ""
        print(f"\nloop {over}line {table.line}, in {call.function}: {len(table.rows)} iterations")
        print("\n".join(loop_table(table, rows=_ROWS if sys.stdout.isatty() else len(table.rows) + 1)))
    if len(tables) > _MAX_LOOPS:
        note(f"note: the loop runs {len(tables) - _MAX_LOOPS} times more; --json has all of them")
    if trace.others:
        names = ", ".join(trace.others[:4]) + (", …" if len(trace.others) > 4 else "")
        note(f"note: not recorded: {names}; --function all records every function, or name one")


def _rows(lines: Sequence[AnnotatedLine]) -> Iterator[str]:
    """Yield lines of source with their values, as wide as a terminal is; in a pipe as wide as they are."""
    is_terminal = sys.stdout.isatty()
    width = shutil.get_terminal_size((120, 24)).columns if is_terminal else 10**6
    codes = [line.code.expandtabs(4) for line in lines]
    margin = 2 + len(str(lines[-1].number)) + 1
    room = max(map(len, codes), default=0)
    if margin + room + 3 + _MIN_NOTE > width:
        room = max(min(room, (width - margin - 3) * 3 // 5), 16)
    rest = max(width - margin - room - 3, _MIN_NOTE)
    before = lines[0].number - 1
    for line, code in zip(lines, codes, strict=True):
        if line.number > before + 1:
            yield painted(f"{'⋮':>{margin}}", "2", sys.stdout)
        before = line.number
        mark = " " if line.is_finite else "!"
        head = f"{mark} {line.number:>{margin - 3}} "
        text = f"{code if len(code) <= room else code[: room - 1] + '…':{room}}"
        notes = textwrap.wrap(line.note, rest, subsequent_indent="  ", break_on_hyphens=False) or [""]
        bar, colour = painted("│", "2", sys.stdout), "36" if line.is_finite else "1;31"
        for number, part in enumerate(notes):
            head = head if number == 0 else " " * len(head)
            text = text if number == 0 else " " * room
            dim = "" if line.note else "2"
            shown_text = painted(text, dim, sys.stdout) if dim else text
            yield f"{head}{shown_text} {bar} {painted(part, colour, sys.stdout) if part else ''}".rstrip()


def _loops(trace: Trace, name: str) -> list[Loop]:
    """Return the runs of a loop, by its variable or its line; raise ``ParameterError`` for none."""
    loops = trace.loops()
    chosen = [loop for loop in loops if name in (loop.variable, str(loop.line))]
    if not chosen:
        names = list(dict.fromkeys(loop.variable or str(loop.line) for loop in loops))
        ran = f"; loops that ran: {', '.join(names)}" if names else ""
        raise ParameterError(f"--loop {name}: no loop over that variable, or in that line, ran here{ran}")
    return chosen


# ── two runs ─────────────────────────────────────────────────────────────────


def _print_difference(traces: Sequence[Trace], as_json: bool) -> None:
    """Print the first value that differs, and where the runs take other ways; texels differ anyway."""
    from playground.engine.trace.listing import heading
    from playground.engine.trace.model import first_difference

    if traces[0].texel != traces[1].texel:
        traces = [_without_entry(trace) for trace in traces]
    found, parting = first_difference(*traces), first_difference(*traces, values=False)
    if as_json:
        pairs = {"first": found, "path": parting}
        print_json({name: [_event_json(e) for e in pair] if pair else None for name, pair in pairs.items()})
        return
    for number, trace in enumerate(traces, 1):
        print(f"{number}: {heading(trace)}")
    if found is None:
        print("no recorded value differs")
        return
    print("first value that differs:")
    _print_pair(found, traces)
    if parting is not None and parting != found:
        print("from here on the runs take different paths:")
        _print_pair(parting, traces)


def _without_entry(trace: Trace) -> Trace:
    """Return a trace without the arguments of the function that everything else is called from."""
    events = [e for e in trace.events if e.kind != "argument" or trace.calls[e.call].depth > 0]
    return replace(trace, events=events)


def _print_pair(events: Sequence[Event | None], traces: Sequence[Trace]) -> None:
    from playground.engine.trace.listing import event_text

    for number, (event, trace) in enumerate(zip(events, traces, strict=True), 1):
        if event is None:
            print(f"{number}: has ended")
            continue
        code = trace.files[event.path][event.line - 1].strip()
        inside = f", iteration {', '.join(map(str, event.iterations))}" if event.iterations else ""
        call = trace.calls[event.call].function
        colour = "36" if event.is_finite else "1;31"
        text = painted(event_text(event) + ("" if event.is_finite else " !"), colour, sys.stdout)
        print(f"{number}: {shown(event.path)}:{event.line}, in {call}{inside}: {text}")
        print(painted(f"     {code}", "2", sys.stdout))


# ── for programs ─────────────────────────────────────────────────────────────


def _as_json(trace: Trace) -> dict[str, Any]:
    """Return a trace as what JSON has."""
    calls = [
        {
            "function": call.function,
            "path": shown(call.path),
            "line": call.line,
            "end_line": call.end_line,
            "caller": call.caller,
            "depth": call.depth,
        }
        for call in trace.calls
    ]
    return {
        "pass": trace.step,
        "texel": list(trace.texel),
        "iteration": list(trace.iteration),
        "exact": trace.is_exact,
        "complete": trace.is_complete,
        "discarded": trace.is_discarded,
        "outputs": _plain(trace.outputs),
        "texel_values": _plain(trace.texel_values),
        "functions": list(trace.functions),
        "not_recorded": list(trace.others),
        "calls": calls,
        "events": [_event_json(event) for event in trace.events],
    }


def _event_json(event: Event | None) -> dict[str, Any] | None:
    if event is None:
        return None
    return {
        "kind": event.kind,
        "name": event.name,
        "type": event.type,
        "value": _plain(event.value),
        "path": shown(event.path),
        "line": event.line,
        "column": event.column,
        "call": event.call,
        "iterations": list(event.iterations),
        "loops": list(event.loops),
    }


def _plain(value: Any) -> Any:
    """Return a value as JSON has it; of numbers that are not finite their names in JavaScript."""
    if isinstance(value, float) and not math.isfinite(value):
        return "NaN" if math.isnan(value) else "Infinity" if value > 0 else "-Infinity"
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    return [_plain(part) for part in value] if isinstance(value, list | tuple) else value
