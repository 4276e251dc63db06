"""Measure every method of lighting against the truth, on three terrains under three suns.

    python tests/truth [--size 97] [--json] [NAME…]

Prints one table: the mean and the 99th percentile, over the texels, of the error of the
sun's visible part and of the light, both 0..1; and the mean error of the visible part over the
texels that truly see a part of the sun. Methods of the sky are held against an even sky of
strength 1, those of sun and sky against both, and those that throw light on against radiosity,
on the same terrains at 25 x 25, over ground of colour 0.5.
"""

from __future__ import annotations

import argparse
import json
import sys
import tempfile
from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from playground.api import headless
from playground.engine.engine import Engine

from .bounce import bounced
from .land import LANDS, SUNS, Array, Land
from .methods import AMBIENT, BOTH, BOUNCED, GROUND, METHODS, SKY, SUN, Method, as_read, lit, sketch_of
from .sky import sky_visibility
from .sun import sunlight


@dataclass(frozen=True)
class Errors:
    """One method on one terrain under one sun: mean and 99th percentile of |found - truth|."""

    method: str
    land: str
    gives: str  # "sun", "sky", "sun and sky", "sky and bounces"
    elevation: float | None  # [degrees] of the sun; None for the sky
    visibility_mean: float | None
    visibility_p99: float | None
    penumbra_mean: float | None  # of the visibility where the truth is neither 0 nor 1; None: nowhere
    light_mean: float
    light_p99: float


@dataclass(frozen=True)
class Truth:
    """What a terrain's light should be."""

    land: Land
    suns: tuple[tuple[Array, Array], ...]  # visible share and light, for each of SUNS
    sky: Array
    small: Land
    bounced: Array  # on the small terrain, over ground of colour GROUND


SMALL = 25  # texels a side, where each sees each


@lru_cache(maxsize=8)
def _heights(name: str, size: int) -> Land:
    return LANDS[name](size)


def truth_of(
    engine: Engine, folder: Path, name: str, size: int, *, strips: int = 12, azimuths: int = 48
) -> Truth:
    """Work out the truth for one of the terrains, at the heights that the engine's texture has."""
    land, small = (
        as_read(engine, sketch_of(folder, _heights(name, n), ""), _heights(name, n)) for n in (size, SMALL)
    )
    suns = tuple(sunlight(land, *sun, count=strips) for sun in SUNS)
    thrown = bounced(small, sky_visibility(small, count=azimuths), GROUND, count=azimuths)
    return Truth(land, suns, sky_visibility(land, count=azimuths), small, thrown)


def measure(engine: Engine, folder: Path, method: Method, truth: Truth) -> Iterator[Errors]:
    """Yield a method's errors on one terrain."""
    head = (method.name, truth.land.name, method.gives)
    if method.gives in (SKY, BOUNCED):
        land, expected = (truth.land, truth.sky) if method.gives == SKY else (truth.small, truth.bounced)
        result = lit(engine, folder, method, land, None)
        yield Errors(*head, None, None, None, None, *_spread(result[..., 0] - expected))
        return
    for sun, (share, light) in zip(SUNS, truth.suns, strict=True):
        result = lit(engine, folder, method, truth.land, sun)
        away, partly = result[..., 3] - share, (share > 0) & (share < 1)
        inside = float(np.abs(away[partly]).mean()) if partly.any() else None
        expected = light + AMBIENT * truth.sky if method.gives == BOTH else light
        yield Errors(*head, sun[1], *_spread(away), inside, *_spread(result[..., 0] - expected))


def _spread(error: Array) -> tuple[float, float]:
    away = np.abs(error)
    return float(away.mean()), float(np.percentile(away, 99))


def main(arguments: list[str] | None = None) -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    names = [m.name for m in METHODS if m.exists and m.measured]
    parser.add_argument("methods", nargs="*", metavar="NAME", help=f"only these: {', '.join(names)}")
    parser.add_argument("--size", type=int, default=97, help="texels a side (default 97)")
    parser.add_argument("--json", action="store_true", help="as JSON, on one line a row")
    options = parser.parse_args(arguments)
    if unknown := [name for name in options.methods if name not in names]:
        parser.error(f"no method '{unknown[0]}'; there are: {', '.join(names)}")
    methods = [m for m in METHODS if m.name in (options.methods or names)]
    with headless() as engine, tempfile.TemporaryDirectory(prefix="playground-truth-") as folder:
        truths = [truth_of(engine, Path(folder), name, options.size) for name in LANDS]
        result = [e for m in methods for t in truths for e in measure(engine, Path(folder), m, t)]
        renderer = engine.info.renderer
    if options.json:
        for row in result:
            print(json.dumps(asdict(row)))
        return
    console = Console(width=None if sys.stdout.isatty() else 110)
    console.print(table_of(result, f"error against the truth, {options.size} x {options.size}, {renderer}"))


def table_of(errors: Iterable[Errors], title: str) -> Table:
    """Return the errors as a table, a row for each method, terrain and sun."""
    table = Table(title=title)
    for heading in ("method", "land"):
        table.add_column(heading)
    for heading in ("sun", "visibility: mean", "p99", "in penumbra", "light: mean", "p99"):
        table.add_column(heading, justify="right")
    last, land = ("", ""), ""
    for row in errors:
        head = (row.method, row.gives)
        if last[0] and head != last:
            table.add_section()
        if head != last:
            land = ""
        numbers = (row.visibility_mean, row.visibility_p99, row.penumbra_mean, row.light_mean, row.light_p99)
        table.add_row(
            "" if head == last else row.method if row.gives == SUN else f"{row.method} ({row.gives})",
            row.land if row.land != land else "",
            "" if row.elevation is None else f"{row.elevation:g}°",
            *("" if number is None else f"{number:.4f}" for number in numbers),
        )
        last, land = head, row.land
    return table
