"""The thesis's own methods, in C as its pseudo-code has them, compiled by the machine's compiler with -O2."""

from __future__ import annotations

import ctypes
import math
import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.verify.bench.timing import Run

HERE = Path(__file__).resolve().parent
SOURCES = ("thesis.c", "thesis_light.c")


class Thesis:
    """A library of the thesis's methods."""

    def __init__(self, library: ctypes.CDLL) -> None:
        self._library = library

    @classmethod
    def compiled(cls, folder: Path) -> Thesis | None:
        """Compile them into a folder; return None where there is no compiler."""
        compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
        if compiler is None:
            return None
        library = folder / "thesis.so"
        sources = [str(HERE / name) for name in SOURCES]
        options = ["-O2", "-shared", "-fPIC", "-o", str(library), *sources, "-lm"]
        subprocess.run([compiler, *options], check=True, capture_output=True)
        return cls(ctypes.CDLL(str(library)))

    def terrain(self, function: str, size: int, arguments: Sequence[float | int], seed: Run) -> Run:
        """Return a run of a method that makes terrain; ``seed`` gives each its seed."""
        out = np.empty((size, size), np.float32)
        value = [ctypes.c_float(a) if isinstance(a, float) else ctypes.c_int(a) for a in arguments]
        called = getattr(self._library, function)

        def run() -> None:
            called(out.ctypes.data_as(ctypes.c_void_p), size, *value, ctypes.c_uint(seed()))  # type: ignore[arg-type]

        return run

    def light(
        self, function: str, grey: NDArray[np.float32], elevation: float, more: Sequence[float], down: bool
    ) -> Run:
        """Return a run of a method that lights heights in texels, (ny, nx), each time from elsewhere.

        It takes the way to the sun, or the light's way ``down``.
        """
        out = np.empty_like(grey)
        called = getattr(self._library, function)
        turns = iter(range(10**9))
        level = math.cos(math.radians(elevation))
        turned = -1.0 if down else 1.0

        def run() -> None:
            azimuth = math.radians(20.0 + 137.508 * next(turns))
            way = (
                level * math.sin(azimuth),
                level * math.cos(azimuth),
                math.sin(math.radians(elevation)),
            )
            called(
                grey.ctypes.data_as(ctypes.c_void_p),
                out.ctypes.data_as(ctypes.c_void_p),
                grey.shape[0],
                *(ctypes.c_float(turned * component) for component in way),
                *(ctypes.c_float(number) for number in more),
            )

        return run
