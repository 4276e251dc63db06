"""Time opening a large elevation file: ``python tests/verify/benchmarks/elevation.py FOLDER [--side N]``.

Writes float32 files of N x N texels into the folder, by rasterio, and renders each in a process of
its own, as a user does: seconds, seconds of a processor, and the most memory that it took. The same
picture of a terrain that is made, and no file read, is the measure of what the rest takes.
"""

from __future__ import annotations

import argparse
import os
import subprocess
import sys
import time
from multiprocessing import Process
from pathlib import Path

import numpy as np
import rasterio
from rasterio.enums import Resampling
from rasterio.transform import Affine

TILES = {"tiled": True, "blockxsize": 512, "blockysize": 512}
FORMS: dict[str, dict[str, object]] = {
    "striped": {},
    "tiled": dict(TILES),
    "striped-deflate": {"compress": "deflate", "predictor": 3},
    "tiled-deflate": {"compress": "deflate", "predictor": 3, **TILES},
    "overviews": {"compress": "deflate", "predictor": 3, **TILES},
    "zstd": {"compress": "zstd", "predictor": 3, **TILES},
    "gaps": dict(TILES),
}


def terrain(side: int) -> np.ndarray:
    """Return hills and a little noise, in metres."""
    rng = np.random.default_rng(3)
    x = np.arange(side) * (2.0 * np.pi / side)
    heights = np.full((side, side), 900.0, np.float32)
    for waves in (1, 2, 3, 5, 8, 13, 21, 40, 90):
        a, b = rng.uniform(0.0, 2.0 * np.pi, 2)
        hills = np.outer(np.sin(waves * x + a), np.sin((waves + 1) * x + b))
        heights += np.float32(800.0 / waves) * hills.astype(np.float32)
    heights += np.float32(0.5) * rng.standard_normal((side, side), np.float32)
    return heights


def paths_in(folder: Path) -> list[Path]:
    """Return the files that are measured."""
    return [folder / f"{name}.tif" for name in FORMS] + [folder / "array.npy"]


def write(folder: Path, side: int) -> None:
    """Write the files."""
    paths = paths_in(folder)
    heights = terrain(side)
    facts = {"driver": "GTiff", "width": side, "height": side, "count": 1, "dtype": "float32"}
    position = {"crs": "EPSG:32633", "transform": Affine(10.0, 0.0, 4e5, 0.0, -10.0, 53e5), "nodata": -9999.0}
    for path, (name, options) in zip(paths, FORMS.items(), strict=False):
        with rasterio.open(path, "w", **facts, **position, **options) as file:
            file.write(heights, 1)
            if name == "overviews":
                file.build_overviews([2, 4, 8, 16], Resampling.average)
            if name == "gaps":
                window = rasterio.windows.Window(0, 0, side // 7, side)
                file.write(np.full((side, side // 7), -9999.0, np.float32), 1, window=window)
    np.save(paths[-1], heights)


def measured(sketch: str, picture: Path, *more: str) -> str:
    """Return the seconds, those of a processor, and the memory of rendering a sketch."""
    command = [sys.executable, "-m", "playground", "render", sketch, "-o", str(picture), *more]
    began = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0, f"{sketch} was not rendered"
    seconds, cpu = time.monotonic() - began, used.ru_utime + used.ru_stime
    return f"{seconds:6.1f} s  {cpu:6.1f} s CPU  {used.ru_maxrss / 2**20:5.2f} GiB"


def main() -> None:
    """Write the files and print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--side", type=int, default=10_000, help="texels of a file's side")
    names = parser.parse_args()
    names.folder.mkdir(parents=True, exist_ok=True)
    picture = names.folder / "picture.png"
    print(f"{'no file':16} {measured('fbm', picture, '--set', 'size=1025')}")
    if not all(path.exists() for path in paths_in(names.folder)):
        # In a process of its own: a program that is started begins with the most memory of who starts it.
        writer = Process(target=write, args=(names.folder, names.side))
        writer.start()
        writer.join()
    for path in paths_in(names.folder):
        print(f"{path.stem:16} {measured(str(path), picture)}")


if __name__ == "__main__":
    main()
