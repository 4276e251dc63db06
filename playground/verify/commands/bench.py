"""Time techniques, frames, starts and saves next to their alternatives; compare with earlier runs."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import FAILED, Renderer, help_text, read_option, within
from playground.commands.options import flag, positional, value
from playground.errors import ParameterError
from playground.shader.parameter import read_whole
from playground.terminal import note, print_json, print_table, progress

if TYPE_CHECKING:
    from playground.verify.bench.results import Change, Results
    from playground.verify.bench.rows import Row

HELP = help_text(
    "Time techniques, frames, starts and saves next to what else does the same.\n\n"
    "NAME is a suite or a row, as --list shows them, with * and ?; without one, all are run, which takes"
    " several minutes. Ours and theirs run alternately, so that a busy machine slows both: ratios can be"
    " trusted more than times. Peers that are not installed are left out, which is said; the extra bench"
    " has them. With --against, figures of earlier runs are compared: those with a"
    " peer by their ratio to it, the others by their time; only what differs"
    " by more than a tenth, and by more than its runs do, counts. With --fail, exit status 1 where"
    " something has become slower.",
    "playground bench --list",
    "playground bench normalisation --size 257 --rounds 3",
    "playground bench generation lighting --size 513 4097 -o results.json --page results.html",
    "playground bench lighting --no-peers --size 513 4097",
    "playground bench engine --against results.json --fail",
)
MAX_SIDE = 8193


def bench(
    ctx: typer.Context,
    names: Annotated[
        list[str] | None, positional("NAME...", "Suites and rows to run (default: all).")
    ] = None,
    sizes: Annotated[
        list[str] | None,
        value("--size N", "Texels a side of terrain (default 1025); may be repeated, and growth is shown."),
    ] = None,
    rounds: Annotated[str, value("--rounds N", "Runs of each that count (default 7).")] = "",
    processor: Annotated[
        bool, flag("--processor", "Compare processors' time, not the clock's: for a busy machine.")
    ] = False,
    no_peers: Annotated[
        bool, flag("--no-peers", "Time ours alone: for growth to large sizes, where a peer takes minutes.")
    ] = False,
    output: Annotated[Path | None, value("-o --output FILE", "Write every sample as JSON.")] = None,
    page: Annotated[
        Path | None, value("--page FILE", "Write a page of tables and plots; needs matplotlib.")
    ] = None,
    against: Annotated[
        list[Path] | None,
        value("--against FILE", "Compare with this earlier run; repeated, the page plots all over time."),
    ] = None,
    fail: Annotated[bool, flag("--fail", "Exit status 1 where a figure has become slower.")] = False,
    listed: Annotated[bool, flag("--list", "List the rows, and run none.")] = False,
    as_json: options.Json = False,
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Time techniques, frames, starts and saves next to what else does the same."""
    from playground.verify.bench.context import Options
    from playground.verify.bench.measures import planned, run
    from playground.verify.bench.results import changes, read, write
    from playground.verify.bench.rows import chosen

    rows = chosen(names or ())
    if listed:
        print_table("Rows", ("suite", "row", "what", "goal"), [_listed(row) for row in rows])
        return
    count = read_option("--rounds", rounds, within(1, 1000), "a whole number from 1 to 1000, as 7") or 7
    sides = [_side(text) for text in sizes or ["1025"]]
    if fail and not against:
        raise ParameterError("--fail compares with earlier results: name them by --against FILE")
    earlier = [read(path) for path in against or ()]
    if page is not None:
        from playground.verify.bench.page import check_plots

        check_plots()
    renderer: Renderer = ctx.obj.or_else(software, device)
    clock = "processor" if processor else "wall"
    opts = Options(count, renderer.software, renderer.device, note)
    if no_peers:
        rows = [row.alone() for row in rows]
    with progress("rows", len(planned(rows, sides))) as advance:
        results = run(rows, sides, opts, advance)
    if output is not None:
        write(results, output)
    if page is not None:
        from playground.verify.bench.page import write_page

        write_page(results, earlier, page, clock)
    before = max(earlier, key=lambda each: each.date, default=None)
    compared = changes(results, before, clock) if before is not None else []
    if as_json:
        from playground.verify.bench.results import as_json as whole

        print_json({**whole(results), "changes": [_change_json(change) for change in compared]})
    else:
        _print(results, compared, sides, clock)
    for path in filter(None, (output, page)):
        note(f"written: {path}")
    if fail and any(change.word == "slower" for change in compared):
        raise typer.Exit(FAILED)


def _side(text: str) -> int:
    side = read_whole(text) or 0
    if not 17 <= side <= MAX_SIDE:
        raise ParameterError(f"--size {text}: expected texels a side, 17 to {MAX_SIDE}, as 1025")
    return side


def _listed(row: Row) -> tuple[str, ...]:
    return row.suite, row.name, row.what, str(row.goal)


def _print(results: Results, compared: Sequence[Change], sides: Sequence[int], clock: str) -> None:
    from playground.verify.bench.results import HEADINGS, MIN_RATIO, growth, rows_of

    has = results.machine
    note(f"{has['renderer']}, {has['processors']} processors, load {has['load']:g}; {clock} time, medians")
    rows = [cells for figure in results.figures for cells in rows_of(figure, clock)]
    print_table("Figures", HEADINGS, rows)
    grown = growth(results, sides, clock)
    if grown:
        title = f"Cost per texel at {max(sides)}², over that at {min(sides)}² (wanted: at most 1.3)"
        print_table(title, ("row", "ratio"), [(what, f"{ratio:.2f}") for what, ratio in grown])
    if compared:
        shown = [change for change in compared if change.word != "alike"]
        cells = [(c.figure.key, f"{c.times:.2f} × the time", c.word, c.by_peer) for c in shown]
        if cells:
            print_table("Changes", ("row", "", "", "by its ratio to"), cells)
        alike = len(compared) - len(shown)
        print(f"{alike} of {len(compared)} figures alike, within {MIN_RATIO - 1:.0%} or the runs' spread")


def _change_json(change: Change) -> dict[str, object]:
    return {
        "figure": change.figure.key,
        "times": change.times,
        "word": change.word,
        "by_peer": change.by_peer,
        "clear": change.clear,
    }
