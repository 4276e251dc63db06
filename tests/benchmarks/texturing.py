"""Measure what texturing costs a frame, and print it with its limit.

    python tests/benchmarks/texturing.py [--land 1025] [--frames 9]

Every figure is the median of frames of 1280 x 720 with the camera moved between them, one
sample a pixel, each after the driver has finished. The rows are measured alternately, one frame
of each, so that a load on the machine falls on all of them alike: compare within one run. Where
the processor draws, the times of all its cores are summed as well, and the ratios are of
those: they depend less on what else the machine does.
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

SIZE = (1280, 720)
LOOK = Camera(azimuth=70.0, elevation=22.0, distance=2100.0, target=(1280.0, 1280.0, 150.0))

TERRAIN = """format = 1
size = {size}
extent = 2560.0
relief = 470.0
[[pass]]
name = "height"
use = "generation/gradient_noise"
set = {{ shape = "warped", warp = 0.6, octaves = 8, frequency = 2.2, gain = 0.4, seed = 8 }}
[[pass]]
name = "weights"
use = "texturing/alpha_map"
size = 513
[[pass]]
name = "light"
use = "lighting/l_dot_n"
"""
TILES = "".join(
    f'[[pass]]\nname = "{name}"\nuse = "texturing/{name}"\nsize = 512\n'
    for name in ("grass", "rock", "snow", "path")
)
BAKED = '[[pass]]\nname = "colour"\nuse = "texturing/splat"\nsize = 1025\n'
VIEW = '[view]\nuse = "{}"\nsamples = 1\nset = {{ grid = {} }}\n'

# The same six textures at every pixel of the screen, sky and sea of view/splat left out: four
# tiles filtered over mipmaps, a map of weights, the light.
FULL = """
#pragma draw(mesh = "sheet", output = "frame:rgba16f", depth = "none")
uniform sampler2D weights;  //! input("linear")
uniform sampler2D grass;    //! input("linear", "repeat", "mipmap")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap")
uniform sampler2D light;    //! input("linear", "mipmap", "white")
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy + 1e-3 * eye.xy / extent;
    return vec4(corner.xy * 2.0 - 1.0, 0.0, 1.0);
}
vec4 fragment(vec2 place) {
    vec4 weight = textureLod(weights, place, 0.0);
    vec3 shown = weight.x * texture(grass, place * 8.0).rgb + weight.y * texture(rock, place * 8.0).rgb
               + weight.z * texture(snow, place * 8.0).rgb + weight.w * texture(path, place * 8.0).rgb;
    return vec4(shown * texture(light, place, -0.7).rgb, 1.0);
}
"""
FULL_PASS = (
    f'[[pass]]\nname = "screen"\nuse = "./screen"\nsize = [{SIZE[0]}, {SIZE[1]}]\n[view]\nsamples = 1\n'
)


def main() -> None:
    """Run every measurement and print the table."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--land", type=int, default=1025, help="texels a side of the terrain (default 1025)")
    parser.add_argument("--frames", type=int, default=9, help="frames to time (default 9)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder, playground.headless() as engine:
        rows = sketches(Path(folder), options.land)
        times = measure(engine, rows, LOOK, SIZE, options.frames, before="view.sky")
        renderer = engine.info.renderer
        software = engine.info.software
    kind = 1 if software else 0
    full = times["full"][kind]
    table = Table(title=f"Texturing on {renderer}, {os.cpu_count()} processors, terrain of {options.land}²")
    for heading in ("a frame of 1280 x 720", "median", "of all cores", "over the first", "limit"):
        table.add_column(heading)
    for name, (what, limit) in WHAT.items():
        wall, cores = times[name]
        ratio = times[name][kind] / full
        table.add_row(what, f"{wall:.1f} ms", f"{cores:.1f} ms" if software else "", f"{ratio:.2f} x", limit)
    Console(width=None if sys.stdout.isatty() else 130).print(table)


WHAT = {
    "full": ("one pass over the screen, six textures a pixel", ""),
    "splat terrain": ("view/splat, its draw of the terrain, mesh of 257²", ""),
    "coarse terrain": ("the same, mesh of 65²: larger triangles", ""),
    "tiled terrain": ("the same by geomipmap at 1 pixel, vertices of 1025²", ""),
    "multipass terrain": ("view/splat_multipass, its four draws, mesh of 257²", "next to splat"),
    "baked terrain": ("view/terrain, its draw, the same layers baked to 1025²", ""),
    "splat": ("view/splat, whole frame", ""),
    "tiled": ("view/splat, whole frame by geomipmap at 1 pixel", "2 x"),
    "multipass": ("view/splat_multipass, whole frame", "next to splat"),
    "baked": ("view/terrain, whole frame", "40 ms"),
}
"""What each row is, and its limit."""


def sketches(folder: Path, size: int) -> dict[str, tuple[Sketch, str]]:
    """Write and load the sketch of every row, and say which of its passes is timed ("" for the frame)."""
    (folder / "screen.glsl").write_text(FULL)
    head = TERRAIN.format(size=size) + TILES

    def made(name: str, text: str) -> Sketch:
        path = folder / f"{name}.toml"
        path.write_text(text)
        return load(path)

    splat = made("splat", head + VIEW.format("view/splat", 257))
    coarse = made("coarse", head + VIEW.format("view/splat", 65))
    tiled = made("tiled", head + VIEW.format("view/splat", '257, detail = "geomipmap"'))
    many = made("multipass", head + VIEW.format("view/splat_multipass", 257))
    baked = made("baked", head + BAKED + VIEW.format("view/terrain", 257))
    return {
        "full": (made("full", head + FULL_PASS), "screen"),
        "splat terrain": (splat, "view.land"),
        "coarse terrain": (coarse, "view.land"),
        "tiled terrain": (tiled, "view.land"),
        "multipass terrain": (many, "view.fourth"),
        "baked terrain": (baked, "view.land"),
        "splat": (splat, ""),
        "tiled": (tiled, ""),
        "multipass": (many, ""),
        "baked": (baked, ""),
    }


if __name__ == "__main__":
    main()
