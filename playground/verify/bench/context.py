"""Where and how rows are measured: engines on one context, a folder for sketches, new seeds, two clocks.

Runs are timed alternately, so that a load on the machine falls on all of them alike. Every sample has two
numbers: milliseconds on the clock, and of all processors together, which a load of others does not lengthen.
"""

from __future__ import annotations

import itertools
import os
import shutil
import statistics
import tempfile
import time
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from playground.api import headless
from playground.engine.engine import Engine
from playground.files import write_file
from playground.sketch.load import load
from playground.sketch.model import Sketch

# ── clocks ────────────────────────────────────────────────────────────


Run = Callable[[], object]


@dataclass
class Samples:
    """What several runs of the same took, in milliseconds: on the clock, and of processors."""

    wall: list[float] = field(default_factory=list)
    processor: list[float] = field(default_factory=list)

    def of(self, clock: str) -> list[float]:
        """Return the samples of a clock, "wall" or "processor"."""
        return self.processor if clock == "processor" else self.wall

    def median(self, clock: str = "wall") -> float:
        """Return the median."""
        return statistics.median(self.of(clock))

    def quartiles(self, clock: str = "wall") -> tuple[float, float]:
        """Return the first and the third quartile; of fewer than three samples, the least and the most."""
        return quartiles(self.of(clock))


def quartiles(times: Sequence[float]) -> tuple[float, float]:
    """Return the first and the third quartile; of fewer than three numbers, the least and the most."""
    if len(times) < 3:
        return min(times), max(times)
    low, _, high = statistics.quantiles(times, n=4, method="inclusive")
    return low, high


def alternate(
    runs: Mapping[str, Run], rounds: int, *, once: Collection[str] = (), unmeasured: int = 1
) -> dict[str, Samples]:
    """Return the samples of each run, by name: one of each in turn, ``rounds`` times.

    The first ``unmeasured`` rounds compile and fill caches, and do not count. Those in ``once`` take too
    long to run more than once.
    """
    samples = {name: Samples() for name in runs}
    for number in range(-unmeasured, rounds):
        for name, run in runs.items():
            if name in once and number != 0:
                continue
            wall, processor = timed(run)
            if number >= 0:
                samples[name].wall.append(wall)
                samples[name].processor.append(processor)
    return samples


def beyond(whole: Samples, part: Samples) -> Samples:
    """Return what each run took beyond that of a part of it in the same round."""
    return Samples(
        [whole_time - other for whole_time, other in zip(whole.wall, part.wall, strict=True)],
        [whole_time - other for whole_time, other in zip(whole.processor, part.processor, strict=True)],
    )


def timed(run: Run) -> tuple[float, float]:
    """Return the milliseconds that a run takes, on the clock and of this process's processors."""
    start, busy = time.perf_counter(), time.process_time()
    run()
    return (time.perf_counter() - start) * 1e3, (time.process_time() - busy) * 1e3


# ── engines and sketches ──────────────────────────────────────────────────


SUN_TURNS = 137.508  # degrees, by the golden angle: no two suns lie near each other


def processors() -> int:
    """Return how many processors this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


@dataclass
class Options:
    """How to measure."""

    rounds: int = 7
    software: bool = False
    device: int | None = None
    say: Callable[[str], None] = lambda _: None  # told what is left out, and why


class BenchContext:
    """Engines of both drivers on one context, opened when they are first asked for."""

    def __init__(self, options: Options) -> None:
        self.options = options
        self.folder = Path(tempfile.mkdtemp(prefix="playground-bench-"))
        self.numbers = itertools.count(1)
        self._engines: dict[str, Engine] = {}

    @property
    def rounds(self) -> int:
        """How many runs count."""
        return self.options.rounds

    def __enter__(self) -> BenchContext:
        return self

    def __exit__(self, *error: object) -> None:
        for engine in reversed(self._engines.values()):
            engine.release()
        self._engines.clear()
        shutil.rmtree(self.folder, ignore_errors=True)

    def engine(self, driver: str = "auto") -> Engine:
        """Return the engine of a driver, "auto" or "fragment"; both are on one context."""
        if "auto" not in self._engines:
            self._engines["auto"] = headless(software=self.options.software, device=self.options.device)
        if driver not in self._engines:
            self._engines[driver] = Engine(self._engines["auto"].ctx, driver=driver)
        return self._engines[driver]

    def seed(self) -> int:
        """Return a seed that no run had before."""
        return next(self.numbers) % 9999

    def written(self, name: str, text: str) -> Path:
        """Write a file of the sketches' folder and return its path."""
        path = self.folder / name
        write_file(path, text)
        return path

    def sketch(self, options: Mapping[str, Any], size: int) -> Sketch:
        """Return a row's sketch: one of the library by ``sketch``, or of the text of its ``passes``.

        ``first`` is the text of passes before those, which rows may share.
        ``texel`` is the metres between two texels; ``relief`` is in metres; ``even`` takes the
        even number below an odd size; ``set`` are values by path.
        """
        side = size - size % 2 if options.get("even") else size
        if "passes" not in options:
            loaded = load(str(options["sketch"]))
            values: dict[str, Any] = {"size": side} if size else {}
        else:
            head = f"format = 1\nsize = {side}\n" if size else "format = 1\n"
            if "texel" in options:
                head += f"extent = {(side - 1) * float(options['texel'])}\n"
            if "relief" in options:
                head += f"relief = {float(options['relief'])}\n"
            text = head + str(options.get("first", "")) + str(options["passes"])
            loaded = load(self.written(f"{next(self.numbers)}.toml", text))
            values = {}
        values |= options.get("set", {})
        return loaded.with_values(values) if values else loaded


def changing(context: BenchContext, options: Mapping[str, Any]) -> Callable[[Sketch], Sketch]:
    """Return what gives a sketch new values for each run, of the paths in ``seeds`` and ``suns``.

    A seed is a whole number. A sun stands at ``elevation`` degrees, and elsewhere each time, or ``turn``
    degrees further; its height differs a little from row to row, else the engine would know a part of one
    from another. ``nudged`` are paths of numbers that grow a little each time, from ``around``, else 0.
    """
    seeds, suns = options.get("seeds", ()), options.get("suns", ())
    nudged = options.get("nudged", ())
    own = next(context.numbers) * 1e-5
    turns, steps = itertools.count(), itertools.count(1)

    def changed(sketch: Sketch) -> Sketch:
        values: dict[str, Any] = {path: context.seed() for path in seeds}
        if suns:
            azimuth = (20.0 + options.get("turn", SUN_TURNS) * next(turns)) % 360.0
            values |= dict.fromkeys(suns, (azimuth, float(options["elevation"]) + own))
        if nudged:
            values |= dict.fromkeys(nudged, options.get("around", 0.0) + next(steps) * 1e-4)
        return sketch.with_values(values) if values else sketch

    return changed
