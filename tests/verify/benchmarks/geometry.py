"""Measure the terrain's meshes: the full grid, tiles at levels of detail, tiles that morph.

    python tests/verify/benchmarks/geometry.py [--sizes 1025 4097] [--samples 1 4] [--rounds 7]

A frame is what a turned camera runs again. Its time is the median of the rounds, in each
in which every mesh is drawn once, so that a busy machine is so to all of them. The error
is how far the mesh lies from the full grid in the picture: the most over the picture, and
what 99 in 100 places stay below.
"""

from __future__ import annotations

import argparse
import os
import shutil
import statistics
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

import playground
from playground.engine.camera import look
from playground.engine.engine import Engine
from playground.sketch.model import Sketch

SIZE = (1280, 720)
TOLERANCES = (1.0, 2.0)
# The same mesh straight from above: how high it is over each place.
ABOVE = """#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "heights:rgba32f", depth = "none", samples = 1)
uniform sampler2D height;  //! input("linear")
uniform sampler2D spans;   //! input
uniform sampler2D errors;  //! input
uniform int detail = 2;    //! menu("full grid", "geomipmap", "morph")
uniform int grid = 257;
uniform float tolerance = 1.0;
vec4 vertex(vec3 corner, vec4 tile, out float up) {
    vec2 share = share_of_vertex(height, detail, corner, tile);
    up = textureLod(height, drape_uv(share, textureSize(height, 0)), 0.0).r * relief;
    return vec4(share * 2.0 - 1.0, 0.0, 1.0) + 0.0 * (clip_from_world * vec4(eye, extent.x));
}
vec4 fragment(float up) { return vec4(up, 0.0, 0.0, 1.0); }
"""
PASSES = f"""
[[pass]]
name = "tiles"
use = "view/geomipmap/errors"
inputs = {{ height = "height" }}
size = ["(height.size.x + 14) // 16", "(height.size.y + 14) // 16"]
[[pass]]
name = "above"
use = "./above"
size = [{SIZE[0]}, {SIZE[1]}]
inputs = {{ height = "height", spans = "tiles:spans", errors = "tiles:errors" }}
"""


def main() -> None:
    """Run every measurement and print the tables."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--sizes", type=int, nargs="+", default=[1025, 4097], help="texels a side")
    parser.add_argument("--samples", type=int, nargs="+", default=[1, 4], help="samples of a pixel")
    parser.add_argument("--rounds", type=int, default=7, help="frames to time (default 7)")
    options = parser.parse_args()
    console = Console(width=None if sys.stdout.isatty() else 130)
    lands = [("jacksboro", playground.load("jacksboro"))]
    lands += [
        (f"diamond-square, {n} x {n}", playground.load("diamond_square").with_values({"size": n}))
        for n in options.sizes
    ]
    with playground.headless() as engine, tempfile.TemporaryDirectory() as folder:
        for name, sketch in lands:
            drawn = with_above(sketch, Path(folder))
            console.print(table_of(engine, name, drawn, options.samples, options.rounds))


def table_of(engine: Engine, name: str, sketch: Sketch, samples: list[int], rounds: int) -> Table:
    """Return what the meshes of one terrain cost, and how far from it they lie."""
    size = engine.plan(sketch, SIZE).terrain.size
    assert size is not None
    meshes = {"full grid, texel by texel": {"detail": "full grid", "grid": max(size)}}
    if max(size) > 1025:  # its own mesh would take a gigabyte
        meshes = {"tiles, all at level 0": {"detail": "geomipmap", "tolerance": 0.0}}
    meshes["full grid, 257 x 257"] = {"detail": "full grid", "grid": 257}
    for detail in ("geomipmap", "morph"):
        for tolerance in TOLERANCES:
            meshes[f"{detail}, {tolerance:g} px"] = {"detail": detail, "tolerance": tolerance}
    table = Table(title=f"{name} on {engine.info.renderer}, {os.cpu_count()} processors, {SIZE[0]}x{SIZE[1]}")
    headings = ("mesh", "triangles", "fewer", "error [px]", "99 % below")
    for heading in (*headings, *(f"ms, {n} sample{'s' * (n > 1)}" for n in samples)):
        table.add_column(heading)
    times = {n: frame_times(engine, sketch.with_picture(samples=n), meshes, rounds) for n in samples}
    truth = heights(engine, sketch, {"detail": "geomipmap", "tolerance": 0.0})
    scale = pixels(sketch, truth)
    most = 0
    for mesh, value in meshes.items():
        away = abs(heights(engine, sketch, value) - truth) * scale
        count = engine.runner.draws.triangles
        most = most or count
        error = away[scale > 0]
        table.add_row(
            mesh,
            f"{count:,}",
            f"{most / count:.1f}",
            f"{error.max():.2f}",
            f"{np.percentile(error, 99):.2f}",
            *(f"{times[n][mesh]:.1f}" for n in samples),
        )
    table.caption = f"errors of tiles, once for each terrain: {errors_time(engine, sketch):.1f} ms"
    return table


def with_above(sketch: Sketch, folder: Path) -> Sketch:
    """Return the sketch, copied to a folder, with its mesh seen from above as one more pass."""
    if (data := Path(sketch.folder) / "data").is_dir():
        shutil.copytree(data, folder / "data", dirs_exist_ok=True)
    (folder / "above.glsl").write_text(ABOVE, encoding="utf-8")
    before, view, after = Path(sketch.file).read_text("utf-8").partition("\n[view]")
    path = folder / f"{sketch.name}.toml"
    path.write_text(before + PASSES + view + after, encoding="utf-8")
    return playground.load(path).with_values({"size": sketch.terrain.size})


def frame_times(
    engine: Engine, sketch: Sketch, meshes: dict[str, dict[str, object]], rounds: int
) -> dict[str, float]:
    """Return the milliseconds of a frame after the camera has turned, by mesh."""
    values: dict[str, list[float]] = {mesh: [] for mesh in meshes}
    for number in range(rounds + 1):
        for mesh, value in meshes.items():
            camera = replace(sketch.camera, azimuth=sketch.camera.azimuth + number)
            seen = sketch.with_camera(camera).with_values({f"view.{k}": v for k, v in value.items()})
            engine.ctx.finish()
            start = time.perf_counter()
            engine.draw(seen, size=SIZE)
            engine.ctx.finish()
            if number:
                values[mesh].append((time.perf_counter() - start) * 1e3)
    return {mesh: statistics.median(times) for mesh, times in values.items()}


def heights(engine: Engine, sketch: Sketch, values: dict[str, object]) -> np.ndarray:
    """Return the heights [m] of a mesh over the terrain, as the sketch's camera is shown it."""
    seen = sketch.with_values({f"above.{key}": value for key, value in values.items()})
    return engine.read(seen, "above", size=SIZE)[..., 0].astype(np.float64)


def pixels(sketch: Sketch, truth: np.ndarray) -> np.ndarray:
    """Return the length in pixels of a metre upwards at each place of the terrain, 0 outside the picture."""
    with playground.headless() as engine:
        terrain = engine.plan(sketch, SIZE).terrain
    eye = look(sketch.camera, terrain.extent, terrain.relief, SIZE)
    matrix = eye.clip_from_world.astype(np.float64).T
    shares = ((np.arange(n) + 0.5) / n for n in SIZE)
    east, north = np.meshgrid(*(s * e for s, e in zip(shares, terrain.extent, strict=True)))
    low, high = (np.stack([east, north, truth + up, np.ones_like(truth)], -1) @ matrix for up in (0.0, 0.01))
    inside = (np.abs(low[..., :3]) <= low[..., 3:]).all(axis=-1)
    low, high = (clip[..., :2] / np.where(inside, clip[..., 3], 1.0)[..., None] for clip in (low, high))
    return np.where(inside, np.hypot(*np.moveaxis((high - low) * np.array(SIZE) / 2, -1, 0)) / 0.01, 0.0)


def errors_time(engine: Engine, sketch: Sketch) -> float:
    """Return the milliseconds that the tiles' errors take, as for terrain that is new."""
    times = []
    for _ in range(5):
        engine.texture(sketch, "height")
        engine.cache.clear()
        engine.options.profiling = True
        engine.texture(sketch, "tiles:errors")
        engine.options.profiling = False
        times.append(engine.record.times["tiles"])
    return statistics.median(times)


if __name__ == "__main__":
    main()
