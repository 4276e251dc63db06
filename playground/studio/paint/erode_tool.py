"""The tool "erode": a technique that runs on a window of the terrain, under the brush.

Which technique is said where the file to paint on is declared, by ``erode("erosion/brush")``. It takes
``height`` and may take ``brush``, the brush's fraction 0..1 of each texel. Outputs that are called as an
input is are given back at the next stamp, shifted with the window: so water goes on while the button is down.

A stamp is always of the same seconds, and its window of the same size around the brush, on the terrain's
own texels. So a stroke is what the brush's path in time makes of it, whatever frames it was painted in,
and programs, plan and textures are made once. A side of the window is a multiple of 32 texels, so that
k steps of 256 / (32 k) hours by the clock of erosion/hydraulic are 8 hours with a brush of any radius. What
the window has past the terrain's edges is as high as the edge is and lies outside the brush.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.allowed_files import root_of
from playground.engine.on_arrays import OnArrays
from playground.engine.textures import split_format
from playground.errors import ParameterError
from playground.sketch.model import Kernel, Technique
from playground.sketch.techniques import read_technique
from playground.sketch.wiring import input_names, output_names, outputs_with_formats
from playground.studio.paint.brush import Dab, Part, falloff, spacing_of

if TYPE_CHECKING:
    from playground.engine.engine import Engine

STAMP = 0.05  # [s] of a stroke that each run of the technique makes
_HALF = 16  # texels of which half a window has a multiple: a side of 32 k + 1
_MIN_SOFTNESS = 0.25  # of the brush, so that its rim is no step


def technique_at(use: str, file: str) -> Technique:
    """Return the technique that a kernel's file names: of its own folder or the library.

    Raises ``SketchError`` where there is none.
    """
    path = Path(file)
    return read_technique(use, path.parent, root_of(path))


class ErodeTool:
    """Runs a technique under the brush, stroke by stroke. Raises ``ParameterError`` for one that cannot."""

    def __init__(self, engine: Engine, technique: Technique) -> None:
        self.runner = OnArrays(engine, technique)
        inputs, outputs = input_names(technique), output_names(technique)
        for names, role in ((inputs, "input"), (outputs, "output")):
            if "height" not in names:
                message = f"{technique.name} has no {role} 'height', so the brush cannot erode with it"
                raise ParameterError(message)
        self._weighs = "brush" in inputs
        made = technique.outputs if isinstance(technique, Kernel) else outputs_with_formats(technique)
        self._channels = {
            output.name: split_format(output.format)[0]
            for output in made
            if output.name in inputs and output.name not in ("height", "brush")
        }
        self._carried: dict[str, NDArray[np.float32]] = {}
        self._corner = 0, 0  # of the window that they are of: row, column
        self._owed = 0.0  # [s] of the stroke that no stamp has made yet
        self._level = 0.0  # [m] that heights are given above

    def begin(self, level: float) -> None:
        """Begin a stroke, dry; heights [m] are counted from a level near it, for their last bits' sake."""
        self._carried, self._owed, self._level = {}, 0.0, level

    def stamps(self, dab: Dab) -> Iterator[Dab]:
        """Yield the stamps of a part of a stroke, by time alone: those of a fast one lie apart."""
        owed, seconds = self._owed, dab.seconds
        count = int((owed + seconds) / STAMP + 1e-6)
        self._owed = max(owed + seconds - count * STAMP, 0.0)
        way = np.subtract(dab.end, dab.start)
        for n in range(count):
            fraction = ((n + 1) * STAMP - owed) / max(seconds, 1e-9)
            x, y = np.array(dab.start) + way * min(max(fraction, 0.0), 1.0)
            position = float(x), float(y)
            yield Dab(position, position, dab.extent, dab.brush, STAMP)

    def change(
        self, terrain: tuple[NDArray[np.float32], NDArray[np.float32] | None], stamp: Dab
    ) -> tuple[Part, NDArray[np.float32]]:
        """Return what one stamp adds to the terrain [m], and to which rows and columns.

        ``terrain``: what is painted (ny, nx) [m] and what it is added to, if anything.
        """
        shape, brush, extent, position = terrain[0].shape, stamp.brush, stamp.extent, stamp.start
        spacing = spacing_of((shape[1], shape[0]), extent)
        reach = np.ceil(brush.radius / spacing).astype(int) + 1
        half = -(-reach // _HALF) * _HALF
        middle = np.rint(np.array(position) * (np.array(shape[::-1]) - 1)).astype(int)
        first, last = (middle - half)[::-1], (middle + half)[::-1]
        rows, columns = (np.arange(a, b + 1) for a, b in zip(first, last, strict=True))
        inside = np.ix_(*(np.clip(i, 0, n - 1) for i, n in zip((rows, columns), shape, strict=True)))
        heights = terrain[0][inside].astype(np.float64) - self._level
        if terrain[1] is not None:
            heights += terrain[1][inside]
        before = heights.astype(np.float32)
        away = np.hypot(columns * spacing[0] - position[0] * extent[0],
                        (rows * spacing[1] - position[1] * extent[1])[:, None])  # fmt: skip
        softness = max(brush.softness, _MIN_SOFTNESS)
        weight = brush.strength * falloff(away, brush.radius, softness)
        weight[(rows < 0) | (rows >= shape[0])] = 0
        weight[:, (columns < 0) | (columns >= shape[1])] = 0
        weight = weight.astype(np.float32)
        self._shift((int(first[0]), int(first[1])), before.shape)
        inputs = {"height": before, **self._carried} | ({"brush": weight} if self._weighs else {})
        textures = self.runner.run(
            inputs,
            spacing=(float(spacing[0]), float(spacing[1])),
            relief=1.0,
            base_elevation=self._level,
            outputs=("height", *self._channels),
        )
        self._carried = {name: textures[name] for name in self._channels}
        added = textures["height"] - before
        if not self._weighs:
            added *= weight
        here = tuple(slice(max(a, 0), min(b + 1, n)) for a, b, n in zip(first, last, shape, strict=True))
        there = tuple(slice(s.start - a, s.stop - a) for s, a in zip(here, first, strict=True))
        return (here[0], here[1]), np.where(np.isfinite(added[there]), added[there], np.float32(0))

    def _shift(self, corner: tuple[int, int], shape: tuple[int, ...]) -> None:
        """Move what is carried to where the window is now; what it newly covers is zero."""
        moved = {}
        for name, channels in self._channels.items():
            array = np.zeros((*shape, channels) if channels > 1 else shape, np.float32)
            old = self._carried.get(name)
            if old is not None and old.shape == array.shape:
                sides = zip(corner, self._corner, shape, strict=True)
                to, of = zip(*(_overlap(*side) for side in sides), strict=True)
                array[to] = old[of]
            moved[name] = array
        self._carried, self._corner = moved, corner


def _overlap(now: int, then: int, count: int) -> tuple[slice, slice]:
    """Return where in a window, and where in the one before it, what both have lies."""
    by = min(max(now - then, -count), count)
    return slice(max(-by, 0), count - max(by, 0)), slice(max(by, 0), count - max(-by, 0))
