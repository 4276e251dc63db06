"""Time our methods against their alternatives, in one run, and print them as tables.

A figure is the median of several
runs, ours and theirs alternately, so that a busy machine slows both. Nothing compiled is timed.
"""

from __future__ import annotations

import argparse
import itertools
import os
import shutil
import statistics
import sys
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from rich.console import Console
from rich.table import Table

from playground.engine.context import open_context, release_context
from playground.engine.engine import Engine
from playground.sketch.load import load
from playground.sketch.model import Sketch

SEEDS = itertools.count(1)
CORES = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
FORMS = ("auto", "fragment", "plain")
"""What of ours is timed: by compute shaders where there are any, without, and in the plain form."""
Run = Callable[[], object]


@dataclass
class Comparison:
    """One of our methods, and its alternative."""

    what: str
    ours: dict[str, Run]  # by form, see FORMS
    theirs: dict[str, Run] = field(default_factory=dict)
    wanted: str = ""
    once: frozenset[str] = frozenset()  # those of theirs that are too slow to run more than once
    alone: frozenset[str] = frozenset()  # those of theirs that use one processor


@dataclass(frozen=True)
class Clock:
    """How runs are timed."""

    rounds: int
    processor: bool  # processor time over processors; else the wall's

    def times(self, comparison: Comparison) -> dict[str, float]:
        """Return the milliseconds of each; they alternate, after one unmeasured round."""
        runs = comparison.ours | comparison.theirs
        values: dict[str, list[float]] = {name: [] for name in runs}
        for number in range(self.rounds + 1):
            for name, run in runs.items():
                if name in comparison.once and number != 1:
                    continue
                start = time.process_time() if self.processor else time.perf_counter()
                run()
                end = time.process_time() if self.processor else time.perf_counter()
                shared = CORES if self.processor and name not in comparison.alone else 1
                if number:
                    values[name].append((end - start) * 1e3 / shared)
        return {name: statistics.median(times) for name, times in values.items()}

    def __str__(self) -> str:
        over = " of processor time over processors" if self.processor else ""
        return f"milliseconds{over}, medians of {self.rounds}"


def run_all(
    description: str,
    bench: type[Bench],
    comparisons: Mapping[str, Callable[..., Iterator[Comparison]]],
) -> None:
    """Read the command line, run every comparison and print one table a size."""
    parser = argparse.ArgumentParser(
        description=description, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"only these: {', '.join(comparisons)}")
    parser.add_argument("--size", type=int, nargs="+", default=[1025, 4097], help="texels a side")
    parser.add_argument("--rounds", type=int, default=7, help="runs of each (default 7)")
    parser.add_argument(
        "--processor", action="store_true", help="count processor time over processors: for a busy machine"
    )
    options = parser.parse_args()
    unknown = [name for name in options.names if name not in comparisons]
    if unknown:
        parser.error(f"no comparison '{unknown[0]}'; there are: {', '.join(comparisons)}")
    console = Console(width=None if sys.stdout.isatty() else 150)
    clock = Clock(options.rounds, options.processor)
    with bench() as opened:
        console.print(f"{opened.renderer}, {CORES} processors", highlight=False)
        costs: dict[tuple[str, int], float] = {}
        for size in options.size:
            table = Table(title=f"{size} x {size}, {clock}")
            for heading in ("what", *FORMS, "alternative", "ms", "ratio", "wanted"):
                table.add_column(heading, justify="left" if heading in ("what", "alternative") else "right")
            for name, make in comparisons.items():
                if options.names and name not in options.names:
                    continue
                for comparison in make(opened, size):
                    times = clock.times(comparison)
                    if "auto" in times:
                        costs[comparison.what, size] = times["auto"]
                    _add(table, comparison, times)
            console.print(table)
        _growth(console, costs, options.size)


def _add(table: Table, comparison: Comparison, times: dict[str, float]) -> None:
    ours = [f"{times[form]:.1f}" if form in times else "" for form in FORMS]
    if not comparison.theirs:
        table.add_row(comparison.what, *ours, "", "", "", comparison.wanted)
    for index, name in enumerate(comparison.theirs):
        ratios = " / ".join(f"{times[name] / times[form]:.2f}" for form in comparison.ours)
        head = (comparison.what, *ours) if index == 0 else ("",) * (1 + len(ours))
        table.add_row(*head, name, f"{times[name]:.1f}", ratios, comparison.wanted if index == 0 else "")


def _growth(console: Console, costs: dict[tuple[str, int], float], sizes: list[int]) -> None:
    if len(sizes) < 2:
        return
    low, high = min(sizes), max(sizes)
    table = Table(title=f"cost per texel at {high}², over that at {low}² (wanted: at most 1.3)")
    table.add_column("what")
    table.add_column("ratio", justify="right")
    for what in dict.fromkeys(name for name, _ in costs):
        if (what, low) in costs and (what, high) in costs:
            table.add_row(what, f"{costs[what, high] / costs[what, low] * (low / high) ** 2:.2f}")
    console.print(table)


class Bench:
    """Engines of both drivers, and a folder for sketches."""

    def __init__(self) -> None:
        self.ctx = open_context()
        self.folder = Path(tempfile.mkdtemp(prefix="playground-bench-"))
        self.engines = {driver: Engine(self.ctx, driver=driver) for driver in ("auto", "fragment")}
        self.renderer = self.engines["auto"].info.renderer

    def __enter__(self) -> Bench:
        return self

    def __exit__(self, *error: object) -> None:
        for engine in self.engines.values():
            engine.release()
        release_context(self.ctx)
        shutil.rmtree(self.folder)

    def sketch(self, text: str) -> Sketch:
        """Load a sketch of this text."""
        path = self.folder / f"{next(SEEDS)}.toml"
        path.write_text(f"format = 1\n{text}", encoding="utf-8")
        return load(path)
