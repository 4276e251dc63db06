"""Break a sketch in every known way, and see whether the comparison of its pictures detects it."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping, Sequence
from contextlib import nullcontext
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import FAILED, Renderer, help_text, read_option, within
from playground.commands.options import positional, value
from playground.errors import counted
from playground.paths import PLAIN_SKETCH, shown
from playground.terminal import note, painted, print_json, print_table, progress

if TYPE_CHECKING:
    from playground.verify.shots.mutants.repeatability import Redrawn
    from playground.verify.shots.mutants.suite import MutantResult
    from playground.verify.shots.suite import RenderedShot

HELP = help_text(
    "Break a sketch in every known way, and see whether the comparison of its pictures tells.\n\n"
    "Each mutant is a sketch or a picture with one real defect: no shadow, a sun one degree off, layers"
    " swapped, a row that is dead. It is judged as if the reference came from the same build of the"
    " renderer, from another build, from another renderer: the stricter the comparison, the more it"
    " catches. The same build must catch all that the shot shows, and let pass the one that is no"
    " defect. With --again, the unbroken shot is drawn again under conditions that must not matter, and"
    " none may be refused. Exit status 1 where the same build lets a defect pass or refuses a good"
    " picture.",
    "playground shots mutants",
    "playground shots mutants --again 200",
    "playground shots mutants my-land --shot evening --pictures mutants",
    "playground shots mutants --mutant no-shadow --mutant seam --json",
)


def mutants(
    ctx: typer.Context,
    sketch: Annotated[
        str,
        positional(
            "SKETCH",
            f"A sketch, as for render. Without it, {PLAIN_SKETCH}, for which the defects were made.",
            options.complete_sketch,
        ),
    ] = PLAIN_SKETCH,
    shot: Annotated[
        str,
        value("--shot NAME", "The shot to break; without it, of each mutant the one that shows it."),
    ] = "",
    size: options.Size = None,
    only: Annotated[list[str] | None, value("--mutant NAME", "Draw this one only; may be repeated.")] = None,
    again: Annotated[str, value("--again N", "Draw the unbroken shot so often again.")] = "",
    pictures: Annotated[
        Path | None, value("--pictures DIR", "Write every mutant's picture into this folder.")
    ] = None,
    as_json: options.Json = False,
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Break a sketch in every known way, and see whether the comparison of its pictures tells."""
    from playground.sketch.load import load
    from playground.verify.shots.mutants.repeatability import redraw
    from playground.verify.shots.mutants.suite import MutantRunner, named, shot_of

    count = read_option("--again", again, within(0, 10**6), "a whole number, as 20") or 0
    chosen = named(only or ())
    renderer: Renderer = ctx.obj.or_else(software, device)
    loaded = load(sketch)
    first = shot_of(loaded, shot, size)
    if pictures is not None:
        from playground.files import make_folder

        make_folder(pictures)
    results: list[MutantResult] = []
    redrawn: list[Redrawn] = []
    with renderer.open_engine() as engine:
        bench = MutantRunner(engine, loaded, shot, size)
        expected = bench.unbroken(first)
        with progress("mutants", len(chosen)) as advance:
            for result in bench.run(chosen):
                results.append(result)
                advance()
        info = engine.info
    if pictures is not None:
        _write(pictures, bench.expected, results)
    with progress("drawn again", count) if count else nullcontext(lambda: None) as advance:
        for drawn in redraw(loaded, first, expected, info, count, **asdict(renderer)):
            redrawn.append(drawn)
            advance()
    if as_json:
        print_json(_as_json(loaded.name, info.renderer, results, redrawn))
    else:
        _print(results)
        _print_again(redrawn)
        if pictures is not None:
            print(f"pictures: {shown(pictures)}")
    if not all(result.well for result in results) or any(drawn.refused for drawn in redrawn):
        raise typer.Exit(FAILED)


def _print(results: Sequence[MutantResult]) -> None:
    from playground.verify.shots.mutants.suite import TIERS, kill_rate, survivors

    rows = [_row(result) for result in results if result.applies and not result.unseen]
    headings: tuple[str, ...] = ("mutant", *_NUMBERS, *TIERS, "broken")
    if sys.stdout.isatty() and shutil.get_terminal_size().columns < _WIDE:
        headings, rows = headings[:-1], [row[:-1] for row in rows]
    print_table("Mutants, and what the comparison finds", headings, rows)
    for number, tier in enumerate(TIERS):
        caught, of = kill_rate(results, number)
        passed = survivors(results, number)
        print(f"{tier}: {caught} of {of} caught{'; passed: ' if passed else ''}{', '.join(passed)}")
    for result in results:
        if result.mutant.exempt and result.applies:
            verdict = "passes, as it should" if result.well else "is refused, and should not be"
            print(f"{result.mutant.name}: {verdict} (same build)")
    unseen = [result.mutant.name for result in results if result.unseen]
    if unseen:
        note(f"the shot does not show {', '.join(unseen)}: no level differs by more than one")
    for result in results:
        if not result.applies:
            note(f"{result.mutant.name} does not apply: {result.why_not}")


_WIDE = 120  # columns of a terminal that has room for messages
_NUMBERS = ("most", "over 1", "FLIP", "FLIP tile")


def _row(result: MutantResult) -> tuple[str, ...]:
    from playground.verify.shots.verdicts import VERDICTS

    comparison = result.comparison
    assert comparison is not None
    numbers = (
        [str(comparison.most), f"{result.fraction:.2%}"]
        if VERDICTS[comparison.verdict].measured
        else ["", ""]
    )
    perceived = result.perceived
    numbers += ["", ""] if perceived is None else [f"{perceived.mean:.3f}", f"{perceived.tile:.3f}"]
    verdicts = ("passes" if judgement.ok else judgement.word for judgement in result.tiers)
    return (result.mutant.name, *numbers, *verdicts, result.mutant.broke)


def _print_again(redrawn: Sequence[Redrawn]) -> None:
    if not redrawn:
        return
    refused = [drawn for drawn in redrawn if drawn.refused]
    identical = sum(drawn.identical for drawn in redrawn)
    print(
        f"drawn again {counted(len(redrawn), 'time')}: {len(refused)} refused, "
        f"{identical} the same to the last bit"
    )
    for drawn in refused:
        print(f"{painted('refused', '1;31', sys.stdout)}  {drawn.words}\n    {drawn.refused}")


def _as_json(
    sketch: str, renderer: str, results: Sequence[MutantResult], redrawn: Sequence[Redrawn]
) -> dict[str, object]:
    from playground.verify.shots.mutants.suite import TIERS, kill_rate, survivors

    tiers = {}
    for number, tier in enumerate(TIERS):
        caught, of = kill_rate(results, number)
        tiers[tier] = {"caught": caught, "of": of, "passed": survivors(results, number)}
    refused = [{"how": drawn.words, "why": drawn.refused} for drawn in redrawn if drawn.refused]
    identical = sum(drawn.identical for drawn in redrawn)
    return {
        "sketch": sketch,
        "renderer": renderer,
        "mutants": [result.as_json() for result in results],
        "tiers": tiers,
        "again": {"drawn": len(redrawn), "identical": identical, "refused": refused},
    }


def _write(folder: Path, expected: Mapping[str, RenderedShot], results: Sequence[MutantResult]) -> None:
    """Write each mutant's picture and its difference ×16, and the unbroken shots."""
    from playground.data.image_files import write_png
    from playground.verify.shots.compare import difference_picture

    for name, picture in expected.items():
        write_png(folder / f"unbroken.{name}.png", picture.array)
    for result in results:
        if result.picture is not None:
            write_png(folder / f"{result.mutant.name}.png", result.picture)
            difference = difference_picture(result.picture, expected[result.shot].array)
            write_png(folder / f"{result.mutant.name}.difference.png", difference)
