"""Measure what comparing pictures costs: FLIP, the judge, and the plugin in a pytest without shots.

    python -m tests.verify.benchmarks.comparison [--rounds 9] [--size 1280x720]

Beside them, in turn: FLIP's authors' own (flip-evaluator), matplotlib's comparison of two files, and
pytest with ``-p no:playground.verify.shots.plugin``. Medians of the time on the wall and of that which
processors spent, which says more on a busy machine. The pictures are a shipped reference, repeated,
and the same with a little noise.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from playground.data.image_files import read_png, write_png
from playground.verify.shots.fingerprint import Fingerprint
from playground.verify.shots.flip import flip
from playground.verify.shots.judge import judge
from playground.verify.shots.references import Reference

ROOT = Path(__file__).resolve().parents[3]
SHOWN = ROOT / "screenshots" / "jacksboro" / "llvmpipe" / "morning.png"


def pictures(size: tuple[int, int]) -> tuple[NDArray[np.uint8], NDArray[np.uint8]]:
    """Return a picture of that width and height, uint8 (height, width, 4), and one that is a little off."""
    shown, _ = read_png(SHOWN)
    width, height = size
    times = (-(-height // shown.shape[0]), -(-width // shown.shape[1]), 1)
    whole = np.ascontiguousarray(np.tile(shown, times)[:height, :width])
    noise = np.random.default_rng(1).integers(-6, 7, whole[..., :3].shape)
    other = whole.copy()
    other[..., :3] = np.clip(whole[..., :3].astype(np.int16) + noise, 0, 255)
    return whole, other


def spent() -> float:
    """Return the seconds that processors have spent on this process and on those that it started."""
    ours = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in ours)


def medians(runs: dict[str, Callable[[], object]], rounds: int) -> dict[str, tuple[float, float]]:
    """Return the milliseconds of each run, by the wall and of processors.

    The runs alternate, after one round that is not counted.
    """
    result: dict[str, list[tuple[float, float]]] = {name: [] for name in runs}
    for number in range(rounds + 1):
        for name, run in runs.items():
            start, before = time.perf_counter(), spent()
            run()
            if number:
                result[name].append(((time.perf_counter() - start) * 1e3, (spent() - before) * 1e3))
    return {
        name: (statistics.median(wall for wall, _ in times), statistics.median(cpu for _, cpu in times))
        for name, times in result.items()
    }


def comparing(size: tuple[int, int], folder: Path) -> dict[str, Callable[[], object]]:
    """Return what compares two pictures: ours, and what else there is here."""
    first, other = pictures(size)
    fingerprint = Fingerprint(renderer="llvmpipe", size=f"{size[0]}x{size[1]}", mesa="1", llvm="1")
    same = [Reference(Path("a.png"), first.copy(), fingerprint.texts())]
    runs: dict[str, Callable[[], object]] = {
        "FLIP": lambda: flip(first, other),
        "the judge, equal pictures": lambda: judge(first, fingerprint, same),
        "the judge, another picture": lambda: judge(other, fingerprint, same),
    }
    try:
        import flip_evaluator
    except ImportError:
        pass
    else:
        light = [np.ascontiguousarray(p[..., :3], np.float32) / np.float32(255) for p in (first, other)]
        runs["flip-evaluator"] = lambda: flip_evaluator.evaluate(*light, "LDR")
    try:
        from matplotlib.testing.compare import compare_images
    except ImportError:
        pass
    else:
        files = [str(folder / name) for name in ("one.png", "other.png")]
        for file, picture in zip(files, (first, other), strict=True):
            write_png(Path(file), picture)
        runs["matplotlib's compare_images, of files"] = lambda: compare_images(files[0], files[1], tol=100)
    return runs


def starting(folder: Path) -> dict[str, Callable[[], object]]:
    """Return what runs pytest on one test that checks no picture, with the plugin and without."""
    (folder / "test_nothing.py").write_text("def test_nothing():\n    pass\n")
    (folder / "pytest.ini").write_text("[pytest]\n")
    environment = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST")}

    def run(*words: str) -> None:
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *words]
        subprocess.run(command, cwd=folder, env=environment, check=True, capture_output=True)

    return {
        "pytest, with the plugin": run,
        "pytest, without it": lambda: run("-p", "no:playground.verify.shots.plugin"),
    }


def main() -> None:
    """Measure, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--rounds", type=int, default=9)
    parser.add_argument("--size", default="1280x720")
    options = parser.parse_args()
    width, height = map(int, options.size.split("x"))
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        result = medians(comparing((width, height), folder), options.rounds)
        result |= medians(starting(folder), options.rounds)
    table = Table(title=f"{options.size}: milliseconds, medians of {options.rounds}")
    table.add_column("what")
    table.add_column("wall", justify="right")
    table.add_column("processors", justify="right")
    for what, took in result.items():
        table.add_row(what, *(f"{ms:.1f}" for ms in took))
    extra = zip(result["pytest, with the plugin"], result["pytest, without it"], strict=True)
    table.add_row("what the plugin adds", *(f"{more - less:.1f}" for more, less in extra), style="bold")
    Console().print(table)


if __name__ == "__main__":
    main()
