"""Time air, clouds and sky in one run.

    python tests/verify/benchmarks/air.py [--size 1280x720] [--rounds 9]

Each figure is the median of several runs, each at another time, so that clouds have drifted and all
that reads them is made again: up to the texture that the row names, where nothing else has changed.
Processor time is that of all threads together, which a busy machine changes least; with a graphics
card see the wall clock.
"""

from __future__ import annotations

import argparse
import itertools
import statistics
import time

from rich.console import Console
from rich.table import Table

from playground.engine.context import open_context
from playground.engine.engine import Engine
from playground.sketch.load import load

ROWS = (
    ("air in front of the terrain, with shafts", "view.heaven:scattered", {}),
    ("flat layer of clouds", "view.heaven.sky.flat", {"view.clouds": "flat"}),
    ("heaped clouds, 16 steps", "view.heaven.sky.heaped", {}),
    ("air and sky without clouds", "view.heaven", {"view.clouds": "none"}),
    ("air and sky, flat layer", "view.heaven", {"view.clouds": "flat"}),
    ("air and sky, heaped clouds", "view.heaven", {}),
)
"""What is timed, the texture that is made, and what is set."""


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--rounds", type=int, default=9)
    names = parser.parse_args()
    width, height = (int(n) for n in names.size.split("x"))
    table = Table("", "processor ms", "wall ms")
    moments = itertools.count()  # no two rows share one, or the second would find its textures made
    with open_context() as ctx, Engine(ctx) as engine:
        for name, texture, values in ROWS:
            sketch = load("sky").with_values(values)
            taken = []
            for _ in range(names.rounds + 2):
                ctx.finish()
                start = time.process_time(), time.perf_counter()
                engine.texture(sketch, texture, size=(width, height), time=0.37 * next(moments))
                ctx.finish()
                taken.append((time.process_time() - start[0], time.perf_counter() - start[1]))
            # The first compile, and make what does not change with the time.
            figures = (statistics.median(column[2:]) * 1e3 for column in zip(*taken, strict=True))
            table.add_row(name, *(f"{figure:.1f}" for figure in figures))
        Console().print(f"{engine.info.renderer}, {names.size}", table)


if __name__ == "__main__":
    main()
