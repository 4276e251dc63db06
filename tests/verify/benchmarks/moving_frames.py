"""Time frames of several sketches while the camera moves, one frame of each in turn.

A load on the machine falls on all of them alike: compare within one run. Every figure is the median of
frames, each timed until the driver has finished.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Mapping
from dataclasses import replace

from playground.engine.engine import Engine
from playground.sketch.model import Camera, Sketch

_FIRST = 2  # frames that make the terrain and compile


def measure(
    engine: Engine,
    rows: Mapping[str, tuple[Sketch, str]],
    look: Camera,
    size: tuple[int, int],
    frames: int,
    before: str = "",
) -> dict[str, tuple[float, float]]:
    """Return the median milliseconds of each row: on the clock, and of all cores.

    A row is a sketch and the pass that is timed, "" for the frame; what the pass draws over is the texture
    ``before``, which is made untimed. The camera goes on from ``look`` by 0.1 degrees a frame.
    """
    times: dict[str, list[tuple[float, float]]] = {name: [] for name in rows}
    azimuth = look.azimuth
    for number in range(frames + _FIRST):
        for name, (sketch, path) in rows.items():
            azimuth += 0.1
            moved = sketch.with_camera(replace(look, azimuth=azimuth))
            if path:
                engine.texture(moved, before, size=size)
            engine.ctx.finish()
            start, busy = time.perf_counter(), time.process_time()
            if path:
                engine.texture(moved, path, size=size)
            else:
                engine.draw(moved, size=size)
            engine.ctx.finish()
            if number >= _FIRST:
                spent = time.perf_counter() - start, time.process_time() - busy
                times[name].append((spent[0] * 1e3, spent[1] * 1e3))
    return {
        name: (statistics.median(w for w, _ in result), statistics.median(c for _, c in result))
        for name, result in times.items()
    }
