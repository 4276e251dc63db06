"""Measure what erosion costs a step, how fast it can be watched, and how alike sizes are.

    python tests/verify/benchmarks/erosion.py [--sizes 257 513 1025] [--hours 100] [--rounds 7]

Where the processor draws, the times of all its cores are summed (C) and the ratios are of those:
they depend less on what else the machine does. Rows are measured alternately and the median is
taken. `--hours 600` is the whole of the default rain, for the table of sizes: 2,400 steps at 1025.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table
from scipy.ndimage import gaussian_filter

import playground
from playground.engine.engine import Engine
from playground.sketch.load import load
from playground.sketch.model import Sketch

STEPS = 8
"""Steps between two readings of the clock."""

SKETCH = """format = 1
size = 257
extent = 10240.0
relief = 1800.0
[[pass]]
name = "raw"
use = "generation/gradient_noise"
set = { frequency = 3, octaves = 5, seed = 5 }
[[pass]]
name = "worn"
use = "erosion/hydraulic"
inputs = { height = "raw" }
[[pass]]
name = "fallen"
use = "erosion/thermal"
inputs = { height = "raw" }
set = { coarse = false }
[[pass]]
name = "light"
use = "lighting/l_dot_n"
inputs = { height = "worn" }
[view]
use = "view/terrain"
inputs = { height = "worn" }
samples = 1
"""


def main() -> None:
    """Run every measurement and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[257, 513, 1025], help="texels a side")
    parser.add_argument("--hours", type=int, default=100, help="of rain, for the table of sizes")
    parser.add_argument("--rounds", type=int, default=7, help="times each row is measured")
    options = parser.parse_args()
    console = Console(width=None if sys.stdout.isatty() else 110)
    with tempfile.TemporaryDirectory() as folder, playground.headless() as engine:
        path = Path(folder) / "sketch.toml"
        path.write_text(SKETCH)
        sketch = load(path)
        where = f"{engine.info.renderer}, {os.cpu_count()} processors"
        console.print(steps_table(engine, sketch, options.rounds, where))
        console.print(watched_table(engine, sketch))
        console.print(sizes_table(engine, sketch, options.sizes, options.hours))
        console.print(axes_table(engine, Path(folder)))


def steps_table(engine: Engine, sketch: Sketch, rounds: int, where: str) -> Table:
    """Return what a step of each technique costs at 257 and at 1025 texels a side."""
    result: dict[tuple[str, int], list[tuple[float, float]]] = {}
    for number in range(rounds + 1):
        for size in (257, 1025):
            # The pipes go on from the steps before; what falls begins with another terrain each time.
            pipes = sketch.with_values({"size": size, "worn.hours": 5000})
            falls = sketch.with_values({"size": size, "raw.seed": number, "fallen.steps": STEPS})
            engine.texture(falls, "raw")
            for what, sized, ref, stopped in (
                ("pipes", pipes, "worn.water:state", {"worn.water": 2 + STEPS * number}),
                ("thermal", falls, "fallen.level:ground", {}),
            ):
                engine.ctx.finish()
                wall, cores = time.perf_counter(), time.process_time()
                engine.texture(sized, ref, steps=stopped)
                engine.ctx.finish()
                spent = time.perf_counter() - wall, time.process_time() - cores
                if number:
                    each = (1000 * spent[0] / STEPS, 1000 * spent[1] / STEPS)
                    result.setdefault((what, size), []).append(each)
    table = Table(title=f"A step on {where}")
    for heading in ("technique", "texels", "wall", "C", "least C", "to reach"):
        table.add_column(heading)
    limits = {("pipes", 1025): "60 ms C"}
    for (what, size), times in result.items():
        wall, cores = (statistics.median(column) for column in zip(*times, strict=True))
        least = min(time for _, time in times)
        columns = f"{size}²", f"{wall:.2f} ms", f"{cores:.2f} ms", f"{least:.2f} ms"
        table.add_row(what, *columns, limits.get((what, size), ""))
    return table


def watched_table(engine: Engine, sketch: Sketch, frames: int = 20) -> Table:
    """Return how many steps a second run beside the picture while the rain is watched."""
    table = Table(title="Watched at 257²: 1280 x 720, each frame a picture")
    headings = "hours a frame", "frames a second", "steps a second", "C of a frame", "steps by C", "to reach"
    for heading in headings:
        table.add_column(heading)
    for pace in (1, 8, 30):
        watched = sketch.with_values({"worn.watched": True, "worn.pace": pace, "worn.hours": 5000})
        engine.draw(watched, size=(1280, 720), time=0.0)
        engine.ctx.finish()
        wall, cores = time.perf_counter(), time.process_time()
        for frame in range(1, frames + 1):
            engine.draw(watched, size=(1280, 720), time=frame / 60)
            engine.ctx.finish()
        wall, cores = time.perf_counter() - wall, time.process_time() - cores
        steps, each = pace * frames / wall, cores / frames
        # What the machine's cores could do if they did nothing else.
        free = pace * (os.cpu_count() or 1) / each
        columns = f"{frames / wall:.1f}", f"{steps:.0f}", f"{1000 * each:.0f} ms", f"{free:.0f}"
        table.add_row(f"{pace}", *columns, "100 steps a second")
    return table


def sizes_table(engine: Engine, sketch: Sketch, sizes: list[int], hours: int) -> Table:
    """Return how far what was worn differs from the finest grid's, both without what the coarsest lacks."""
    table = Table(title=f"The same terrain after {hours} h: what was worn, next to the finest grid's")
    for heading in ("texels", "rms difference", "of what was worn", "mean wear", "C"):
        table.add_column(heading)
    coarsest, changes, wear, cores = min(sizes), {}, {}, {}
    for size in sizes:
        sized, started = sketch.with_values({"size": size, "worn.hours": hours}), time.process_time()
        change = engine.read(sized, "worn").astype(np.float64) - engine.read(sized, "raw")
        cores[size] = time.process_time() - started
        per = (size - 1) // (coarsest - 1)
        changes[size] = 1800 * gaussian_filter(change, 2 * per, mode="nearest")[::per, ::per]
        wear[size] = float(engine.read(sized, "worn:wear").mean())
        engine.forget_unused()
    finest = changes[max(sizes)]
    scale = float(np.sqrt((finest**2).mean()))
    for size in sizes:
        off = float(np.sqrt(((changes[size] - finest) ** 2).mean()))
        columns = f"{off:.2f} m", f"{off / scale:.1%}", f"{wear[size]:.2f} m", f"{cores[size]:.1f} s"
        table.add_row(f"{size}²", *columns)
    return table


CONE = """format = 1
size = 129
extent = 5120.0
relief = 900.0
[[pass]]
name = "cone"
use = "generation/heightmap"
set = { elevation = "cone.npy", first_row = "south" }
[[pass]]
name = "worn"
use = "erosion/hydraulic"
set = { hours = 5000 }
"""


def axes_table(engine: Engine, folder: Path, cones: int = 4) -> Table:
    """Return whether streams down cones of even noise prefer some directions: the mean of cos 4a.

    1 is all along axes, -1 all along diagonals, 0 neither. Streams are the tenth of the texels with
    the most flow; their directions are those of the flow over so many texels.
    """
    table = Table(title="Streams down cones of even noise: the mean of cos 4a")
    for heading in ("steps", "directions, 1 texel", "2 texels", "4 texels", "places around the summit"):
        table.add_column(heading)
    y, x = np.mgrid[-1:1:129j, -1:1:129j]
    away = np.hypot(x, y)
    ring = (away > 0.2) & (away < 0.85)
    values: dict[int, list[list[float]]] = {75: [], 300: []}
    (folder / "cone.toml").write_text(CONE)
    for seed in range(cones):
        noise = gaussian_filter(np.random.default_rng(seed).normal(size=(129, 129)), 1.5)
        cone = 0.05 + 0.9 * np.clip(1 - 0.9 * away, 0, 1) + 0.02 * noise / noise.std()
        np.save(folder / "cone.npy", cone.astype(np.float32))
        sketch = load(folder / "cone.toml")
        for steps, rows in values.items():
            flux = engine.read(sketch, "worn.water:flux", steps={"worn.water": steps})
            west, east, south, north = np.moveaxis(flux.astype(np.float64), -1, 0)
            across = east - west + np.roll(east, 1, 1) - np.roll(west, -1, 1)
            along = north - south + np.roll(north, 1, 0) - np.roll(south, -1, 0)
            flow = np.hypot(across, along)
            streams = ring & (flow > np.quantile(flow[ring], 0.9))
            fields = [(gaussian_filter(across, s), gaussian_filter(along, s)) for s in (1, 2, 4)]
            rows.append([np.cos(4 * np.arctan2(v[streams], u[streams])).mean() for u, v in (*fields, (x, y))])
    for steps, rows in values.items():
        table.add_row(f"{steps}", *(f"{value:.2f}" for value in np.mean(rows, axis=0)))
    return table


if __name__ == "__main__":
    main()
