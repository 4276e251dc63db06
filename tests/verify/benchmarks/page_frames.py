"""Measure the processor's time of a page's frame against the engine's, on the same renderer.

    python -m tests.verify.benchmarks.page_frames [--frames 10] [--runs 5] [sketch ...]

The camera turns from frame to frame; all passes that it does not change are known. Milliseconds of
CPU time a frame, of all threads of the engine's process and of all of the browser's processes: medians
of several runs, the engine and the page in turn. "drawn" ends when the driver has finished; "shown"
draws in animation frames, each picture on a canvas in the page, as a figure does; "showing" is the same
with nothing to draw: what the browser takes for a canvas that changes.
"""

from __future__ import annotations

import argparse
import os
import statistics
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.table import Table

import playground
from playground.engine.engine import Engine
from playground.publish.web.page_data import page_data
from playground.sketch.load import load
from playground.sketch.model import Sketch

from ...publish.web.pages import MISSING, Pages

SIZE = (640, 360)
SKETCHES = ("white_noise", "lighting_hill", "jacksboro", "daylight", "splat", "triplanar", "wireframe",
            "geomipmap", "height_blend", "fbm", "detail", "soft_cone", "night", "gradient_noise")  # fmt: skip
TURN = 3.0  # [degrees] from frame to frame

_TURNED = """
const player = figures[arguments[0]], { gl } = engine.parts.context, [frames, turn, start] = arguments[1];
const { camera } = player.sketch;
const finish = () => {
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
};
const turned = (frame) => {
  player.state.camera = { ...camera, azimuth: camera.azimuth + start + frame * turn };
  player.render();
};
"""
_DRAWN = f"""{_TURNED}
for (let frame = 0; frame < frames; frame++) {{
  turned(frame);
  finish();
}}
"""
_SHOWN = f"""{_TURNED}
if (!window.shown) {{
  const canvas = document.createElement("canvas");
  [canvas.width, canvas.height] = player.plan.frame;
  document.body.append(canvas);
  window.shown = canvas.getContext("2d");
}}
return (async () => {{
  for (let frame = 0; frame < frames; frame++) {{
    await new Promise(requestAnimationFrame);
    if (turn) turned(frame);
    player.drawTo(window.shown);
  }}
  window.shown.getImageData(0, 0, 1, 1);
  finish();
}})()
"""


def main() -> None:
    """Measure each sketch and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("sketches", nargs="*", default=SKETCHES)
    parser.add_argument("--frames", type=int, default=10, help="frames of a run (default 10)")
    parser.add_argument("--runs", type=int, default=5, help="runs, of which the median is taken (default 5)")
    options = parser.parse_args()
    if MISSING:
        sys.exit(f"page_frames: {MISSING}")
    sketches = [load(name) for name in options.sketches]
    with (
        tempfile.TemporaryDirectory() as folder,
        playground.headless(software=True, driver="fragment") as engine,
        Pages(Path(folder)) as pages,
    ):
        table = Table(title=f"CPU time of a frame of {SIZE[0]} x {SIZE[1]}, page on {pages.renderer()}")
        for heading in (
            "sketch",
            "engine [ms]",
            "drawn [ms]",
            "shown [ms]",
            "showing [ms]",
            "drawn / engine",
            "shown / engine",
        ):
            table.add_column(heading)
        pages.begin(data := page_data(sketches, frame=SIZE))
        for sketch, item in zip(sketches, data["sketches"], strict=True):
            pages.open(item)
            times = measured(engine, pages, sketch, options.frames, options.runs)
            row = [f"{times[what]:.1f}" for what in ("engine", "drawn", "shown", "showing")]
            row += [f"{times[what] / times['engine']:.2f}" for what in ("drawn", "shown")]
            table.add_row(sketch.name, *row)
            pages.run("figures[arguments[0]].close()", sketch.name)
    Console(width=None if sys.stdout.isatty() else 110).print(table)


def measured(engine: Engine, pages: Pages, sketch: Sketch, frames: int, runs: int) -> dict[str, float]:
    """Return the milliseconds of CPU time a frame, by what is measured."""
    browser = pages.browser.process
    ways: dict[str, tuple[Callable[[], float], Callable[[float], object]]] = {
        "engine": (time.process_time, lambda start: drawn(engine, sketch, frames, start)),
        "drawn": (
            lambda: spent(browser),
            lambda start: pages.run(_DRAWN, sketch.name, [frames, TURN, start]),
        ),
        "shown": (
            lambda: spent(browser),
            lambda start: pages.run(_SHOWN, sketch.name, [frames, TURN, start + 0.05]),
        ),
        "showing": (lambda: spent(browser), lambda _: pages.run(_SHOWN, sketch.name, [frames, 0, 0])),
    }
    times: dict[str, list[float]] = {name: [] for name in ways}
    for run in range(runs + 1):
        for name, (clock, work) in ways.items():
            before = clock()
            work(run * 0.1)
            if run:  # the first compiles
                times[name].append(clock() - before)
    return {name: statistics.median(result) * 1000 / frames for name, result in times.items()}


def drawn(engine: Engine, sketch: Sketch, frames: int, start: float) -> None:
    """Draw frames of a camera that turns."""
    for frame in range(frames):
        camera = replace(sketch.camera, azimuth=sketch.camera.azimuth + start + frame * TURN)
        engine.draw(sketch.with_camera(camera), size=SIZE)
        engine.ctx.finish()


def spent(first: int) -> float:
    """Return the CPU time of a process and of all that it began [s], from Linux's /proc."""
    ticks: dict[int, int] = {}
    parents: dict[int, int] = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            result = (folder / "stat").read_text().rpartition(")")[2].split()
        except OSError:
            continue  # it has ended
        process = int(folder.name)
        parents[process] = int(result[1])
        ticks[process] = int(result[11]) + int(result[12])
    family = {first}
    while more := {each for each, parent in parents.items() if parent in family} - family:
        family |= more
    return sum(ticks.get(each, 0) for each in family) / os.sysconf("SC_CLK_TCK")


if __name__ == "__main__":
    main()
