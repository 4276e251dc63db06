"""Measure whole views of sketches as a window shows them: the first picture, moving, and in full.

    python tests/benchmarks/whole_views.py [october ...] [--frames 7] [--size 1280x720]

The first picture is one, small on a software renderer, and says what a window takes to draw, without
its start and the sandbox; the driver's shader cache is warm if the machine has drawn the sketch
before. The others are medians of frames with the camera moved between them, after the driver has
finished: at the pixels that a preview has by then, and in full. The times of all cores are those of
the process, so that a load on the machine falls on the clock alone.
"""

from __future__ import annotations

import argparse
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import replace

from rich.console import Console
from rich.table import Table

import playground
from playground.engine.engine import Engine
from playground.workbench.session import Session

SETTLES = 8  # pictures until the size of a preview has settled
STEP = 0.3  # [degrees] that the camera turns between two


def main() -> None:
    """Run every measurement and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sketches", nargs="*", default=["october"], help="sketches to measure")
    parser.add_argument("--frames", type=int, default=7, help="frames to time (default 7)")
    parser.add_argument("--size", default="1280x720", help="pixels of a picture (default 1280x720)")
    options = parser.parse_args()
    width, _, height = options.size.partition("x")
    table = Table(title=f"Whole views, {options.size}")
    for heading in ("a picture", "pixels", "on the clock", "of all cores"):
        table.add_column(heading)
    for name in options.sketches:
        for row in measured(name, (int(width), int(height)), options.frames):
            table.add_row(*row)
    Console(width=None if sys.stdout.isatty() else 110).print(table)


def measured(name: str, size: tuple[int, int], frames: int) -> Iterator[tuple[str, ...]]:
    """Open a sketch, move its camera, and yield the rows of the table."""
    with playground.headless() as engine:
        session = Session(engine, name)
        session.clock.playing = False
        first = spent(engine, lambda: session.frame(size))
        yield row_of(f"{name}, the first", session.picture.drawn_size, [first])
        assert session.error is None and session.sketch is not None
        camera, sketch = session.sketch.camera, session.sketch
        session.read()  # in full
        moving, full = [], []
        for number in range(1, frames + SETTLES + 1):
            session.drafts.set_camera(replace(camera, azimuth=camera.azimuth + STEP * number))
            moving.append(spent(engine, lambda: session.frame(size)))
        yield row_of(f"{name}, moving", session.picture.drawn_size, moving[SETTLES:])
        for number in range(1, frames + 1):
            moved = sketch.with_camera(replace(camera, azimuth=camera.azimuth - STEP * number))
            full.append(spent(engine, lambda moved=moved: engine.draw(moved, size=size)))
        yield row_of(f"{name}, in full", size, full)
        session.release()


def spent(engine: Engine, draw: Callable[[], object]) -> tuple[float, float]:
    """Return the milliseconds that drawing takes: on the clock, and of all cores."""
    engine.ctx.finish()
    start, busy = time.perf_counter(), time.process_time()
    draw()
    engine.ctx.finish()
    return (time.perf_counter() - start) * 1e3, (time.process_time() - busy) * 1e3


def row_of(name: str, pixels: tuple[int, int], times: list[tuple[float, float]]) -> tuple[str, ...]:
    """Return a row: what was drawn, its pixels, and the medians of its times."""
    wall, cores = (statistics.median(column) for column in zip(*times, strict=True))
    return name, f"{pixels[0]} x {pixels[1]}", f"{wall:.0f} ms", f"{cores:.0f} ms"


if __name__ == "__main__":
    main()
