"""Fast variants: list them, verify them against the canonical form, renew the record of them."""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Annotated

import typer

from playground.commands import options
from playground.commands.arguments import FAILED, Renderer, command_group, help_text
from playground.commands.options import positional
from playground.errors import counted
from playground.terminal import print_json, print_table, progress

if TYPE_CHECKING:
    from playground.verify.variants import Subject, Verdict

HELP = help_text(
    "Fast variants: other forms of a technique, that give the same result and exist only for speed.\n\n"
    "A technique is its plain text, x.glsl or x.toml. In the same folder, x.comp (a compute shader) or"
    " x.fast.toml (several passes) replaces it only while both texts are those that were found to agree,"
    " within the bound that the variant states; a file fast_variants.json there records so. Otherwise the"
    " plain form runs. Without WHAT, the variants that ship.",
    "playground variants list",
    "playground variants verify lighting",
    "playground variants renew my-land",
)
LIST_HELP = help_text(
    "List fast variants, how closely they agree, and which of them run.", "playground variants list"
)
VERIFY_HELP = help_text(
    "Draw fast variants and the canonical form, and compare.\n\n"
    "At several sizes, square and not, of several terrains and seeds, with each choice of the menus and"
    " both ends of the sliders. Nothing is written. Exit status 1 where one does not agree.",
    "playground variants verify",
    "playground variants verify my-land/height.comp",
)
RENEW_HELP = help_text(
    "Verify fast variants, and record those that agree.\n\n"
    "The record is fast_variants.json: for what ships, in glsl/; for your own, in the folder of the variant.",
    "playground variants renew",
    "playground variants renew my-land",
)

app = command_group("variants", HELP, "List, verify and record the fast variants of techniques.")

WhatArgument = Annotated[
    str,
    positional("WHAT", "A technique or a folder of glsl/, or the path of a variant, a kernel or a sketch."),
]


@app.command("list", help=LIST_HELP)
def list_(what: WhatArgument = "", as_json: options.Json = False) -> None:
    """List fast variants, how closely they agree, and which of them run."""
    from playground.verify.variants import subjects

    rows = [_row(subject) for subject in subjects(what, Path())]
    if as_json:
        print_json([dict(zip(_HEADINGS, row, strict=True)) for row in rows])
        return
    print_table("Fast variants", _HEADINGS, rows)


@app.command("verify", help=VERIFY_HELP)
def verify_(
    ctx: typer.Context,
    what: WhatArgument = "",
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Draw fast variants and the canonical form, and compare."""
    _refuse(_verdicts(what, ctx.obj.or_else(software, device)))


@app.command("renew", help=RENEW_HELP)
def renew(
    ctx: typer.Context,
    what: WhatArgument = "",
    software: options.Software = False,
    device: options.Device = None,
) -> None:
    """Verify fast variants, and record those that agree."""
    from playground.verify.variants import recorded

    verdicts = _verdicts(what, ctx.obj.or_else(software, device))
    for path in recorded(verdicts):
        print(path)
    _refuse(verdicts)


_HEADINGS = ("variant", "agrees", "runs")


def _row(subject: Subject) -> tuple[str, str, str]:
    from playground.paths import shown
    from playground.sketch.variants import is_verified, why_not

    technique, variant = subject.technique, subject.variant
    bounds = "; ".join(f"{b.output}: {b}" if b.output else str(b) for b in variant.technique.agrees)
    runs = "yes" if is_verified(technique, variant) else f"no: {why_not(technique, variant)}"
    return shown(variant.path), bounds, runs


def _verdicts(what: str, renderer: Renderer) -> list[Verdict]:
    from playground.engine.plain_forms import silent
    from playground.paths import shown
    from playground.verify.variants import subjects, verify

    verdicts: list[Verdict] = []
    with TemporaryDirectory(prefix="playground-variants-") as folder:
        chosen = subjects(what, Path(folder) / "stand-in.png")
        with (
            renderer.open_engine(notice=silent) as engine,
            progress("verifying", len(chosen)) as advance,
        ):
            for subject in chosen:
                verdict = verify(engine, subject.variant, subject.technique, subject.places)
                mark = "ok" if verdict.ok else "skipped" if verdict.skipped else "FAILED"
                print(f"{mark:8}{shown(subject.variant.path)}: {verdict.words}", flush=True)
                verdicts.append(verdict)
                engine.cache.clear()
                advance()
    return verdicts


def _refuse(verdicts: list[Verdict]) -> None:
    wrong = sum(1 for verdict in verdicts if verdict.wrong)
    if wrong:
        print(f"{counted(wrong, 'variant')} of {len(verdicts)} not verified: the plain form runs")
        raise typer.Exit(FAILED)
