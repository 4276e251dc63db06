"""Measure what each technique of the scene costs a frame, against the frame without it.

    python tests/verify/benchmarks/scene.py [--land 513] [--frames 7] [--size 1280x720]

Every figure is the median of frames with the camera moved between them, after the driver has
finished. Rows are measured alternately, one frame of each, so that a load on the machine falls on
all of them alike. Where the processor draws, the times of all its cores are summed as well, and
the differences are of those.
"""

from __future__ import annotations

import argparse
import os
import sys
import tempfile
from pathlib import Path

from moving_frames import measure
from rich.console import Console
from rich.table import Table

import playground
from playground.sketch.load import load
from playground.sketch.model import Camera, Sketch

TERRAIN = """format = 1
size = {size}
extent = 8000.0
relief = 1500.0
[[pass]]
name = "height"
use = "generation/mixed"
[[pass]]
name = "colour"
use = "texturing/height_colour"
[[pass]]
name = "daylight"
use = "lighting/daylight"
set = {{ hour = 8.5 }}
[[pass]]
name = "light"
use = "lighting/soft_cone"
{passes}[view]
use = "{view}"
samples = {samples}
inputs = {{ {inputs} }}
set = {{ {sky}, tone = "film"{given} }}
"""
AIR = """[[pass]]
name = "air"
use = "scene/air"
size = [128, 80]
inputs = { columns = "daylight.columns", bounced = "daylight.bounced" }
"""
CLOUDS = """[[pass]]
name = "cloud"
use = "clouds/field"
size = 512
[[pass]]
name = "drift"
use = "clouds/drift"
size = 1
"""
DENSITY = """[[pass]]
name = "density"
use = "trees/density"
"""
FIELD = """[[pass]]
name = "{0}"
use = "{1}"
"""
WET = """[[pass]]
name = "ways"
use = "water/directions"
[[pass]]
name = "area"
use = "water/accumulation"
inputs = { receiver = "ways" }
[[pass]]
name = "wetness"
use = "water/wetness"
"""
PIXELS = 'visibility = "light.visibility"'
OFF = ", antialias = false"
DOME = f'{PIXELS}, dome = "daylight:dome"'
FINE = f"{OFF}, fine_ground = true"
LOOK = Camera(azimuth=200.0, elevation=12.0, distance=6000.0, target=(4300.0, 4300.0, 500.0))
ROWS = {
    "view/terrain, 1 sample": ("", "view/terrain", 1, "", "", ""),
    "view/terrain, 4 samples": ("", "view/terrain", 4, "", "", ""),
    "the scene, light of a map": ("", "scene/terrain", 1, "", OFF, "view/terrain, 1 sample"),
    "the scene, each pixel lit": ("", "scene/terrain", 1, PIXELS, OFF, "the scene, light of a map"),
    "and edges smoothed": ("", "scene/terrain", 1, PIXELS, "", "the scene, each pixel lit"),
    "and exposure by itself": (
        "",
        "scene/terrain",
        1,
        PIXELS,
        f"{OFF}, adapts = true",
        "the scene, each pixel lit",
    ),
    "and glow": ("", "scene/terrain", 1, PIXELS, f"{OFF}, bloom = 0.05", "the scene, each pixel lit"),
    "and vignette": ("", "scene/terrain", 1, PIXELS, f"{OFF}, vignette = 0.3", "the scene, each pixel lit"),
    "and air": (AIR, "scene/terrain", 1, PIXELS, OFF, "the scene, each pixel lit"),
    "and shadows of clouds": (CLOUDS, "scene/terrain", 1, PIXELS, OFF, "the scene, each pixel lit"),
    "and sky, clouds and air": (CLOUDS, "scene/terrain", 1, DOME, OFF, "the scene, each pixel lit"),
    "and fine ground": ("", "scene/terrain", 1, PIXELS, FINE, "the scene, each pixel lit"),
    "fine, with cliffs": ("", "scene/terrain", 1, PIXELS, f"{FINE}, cliffs = true", "and fine ground"),
    "fine, exposed or not": (
        FIELD.format("exposed", "texturing/exposed"),
        "scene/terrain",
        1,
        PIXELS,
        FINE,
        "and fine ground",
    ),
    "fine, under snow": (
        FIELD.format("snow_depth", "texturing/snow_depth"),
        "scene/terrain",
        1,
        PIXELS,
        FINE,
        "and fine ground",
    ),
    "fine, wet": (WET, "scene/terrain", 1, PIXELS, FINE, "and fine ground"),
    "and trees": (DENSITY, "scene/terrain", 1, PIXELS, OFF, "the scene, each pixel lit"),
}
"""By name: more passes, the view, samples, inputs, what is set, and the row that it is compared with."""


def main() -> None:
    """Run every measurement and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--land", type=int, default=513, help="texels a side of the terrain (default 513)")
    parser.add_argument("--frames", type=int, default=7, help="frames to time (default 7)")
    parser.add_argument("--size", default="1280x720", help="pixels of a frame (default 1280x720)")
    options = parser.parse_args()
    width, _, height = options.size.partition("x")
    size = int(width), int(height)
    with tempfile.TemporaryDirectory() as folder, playground.headless() as engine:
        sketches = {name: (made(Path(folder), index, options.land), "") for index, name in enumerate(ROWS)}
        times = measure(engine, sketches, LOOK, size, options.frames)
        renderer, software = engine.info.renderer, engine.info.software
    kind = 1 if software else 0
    table = Table(title=f"The scene on {renderer}, {os.cpu_count()} processors, {options.size}")
    for heading in ("a frame, the camera moving", "median", "of all cores", "more than without"):
        table.add_column(heading)
    for name, (*_, without) in ROWS.items():
        wall, cores = times[name]
        more = f"{times[name][kind] - times[without][kind]:+.1f} ms" if without else ""
        table.add_row(name, f"{wall:.1f} ms", f"{cores:.1f} ms" if software else "", more)
    Console(width=None if sys.stdout.isatty() else 110).print(table)


def made(folder: Path, index: int, size: int) -> Sketch:
    """Write and load the sketch of a row."""
    passes, view, samples, inputs, value, _ = [*ROWS.values()][index]
    path = folder / f"row_{index}.toml"
    sky = "gain = 1.0, ambient = 1.0" if "dome" in inputs else 'sky = "daylight", haze = 0.3'
    text = TERRAIN.format(
        size=size, passes=passes, view=view, samples=samples, inputs=inputs, given=value, sky=sky
    )
    path.write_text(text, encoding="utf-8")
    return load(path)


if __name__ == "__main__":
    main()
