"""An image that is painted on, the file that it is stored in, and its strokes, which can be undone.

A layer holds four weights a texel, in a PNG of 8 bits a channel, or one number: metres that are added to
terrain, or factors; in a TIFF of 32-bit floats. What strokes do to it is in ``brush``.

The picture shows the image from memory, stroke by stroke (see ``engine.painted_images``); the file is
written when a stroke has ended, on a thread, of a copy (see ``LatestWrite``). What a stroke changes is
remembered by tiles: a copy of each tile from before the stroke, made where the brush reaches it first, so
that the cost of a stroke follows the brush and not the image.
"""

from __future__ import annotations

import secrets
import threading
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import read_image, write_png
from playground.data.resample import resample
from playground.engine.file_sources import read_numbers, resized, weights_of, write_numbers
from playground.errors import DataError, PlaygroundError
from playground.files import new_name
from playground.studio.paint.brush import Dab, Part, cover, rate_of, sculpt
from playground.studio.paint.erode_tool import ErodeTool
from playground.studio.reload.dependencies import hash_of


def _nothing() -> None:
    pass


class LatestWrite:
    """Writes one file, one state after another; a state that is replaced before its turn is left out."""

    def __init__(self, ended: Callable[[], None] = _nothing) -> None:
        self.ended = ended  # called on the thread after each write, before ``wait`` returns; raises nothing
        self.writes = 0  # that have ended, well or not
        self.error: PlaygroundError | None = None  # of the last one
        self._condition = threading.Condition()
        self._next: Callable[[], None] | None = None
        self._works = False

    @property
    def pending(self) -> bool:
        """Whether something is being written, or waits for that."""
        return self._works

    def give(self, write: Callable[[], None]) -> None:
        """Have a state written soon, in place of one that waits. ``write`` raises what goes wrong."""
        with self._condition:
            self._next = write
            if self._works:
                return
            self._works = True
        try:
            threading.Thread(target=self._work, name="writing an image").start()
        except RuntimeError:  # the system has no thread left, or Python is ending
            self._work()

    def wait(self) -> None:
        """Wait until all that was given is written; raise the error of the last write."""
        with self._condition:
            self._condition.wait_for(lambda: not self._works)
        if self.error is not None:
            raise self.error

    def _work(self) -> None:
        while True:
            with self._condition:
                write, self._next = self._next, None
                if write is None:
                    self._works = False
                    self._condition.notify_all()
                    return
            error: PlaygroundError | None = None
            try:
                write()
            except PlaygroundError as caught:
                error = caught
            except Exception as caught:
                error = DataError(f"an image could not be written: {caught}")
            self.error = error
            self.writes += 1
            self.ended()


MAX_TEXELS = 4097
"""Of an image's longer side; a larger terrain's is resampled from it."""
_TILE = 64  # texels of a side
_MAX_UNDO_STEPS = 24
_REMEMBERED = 256  # changes whose places are known


@dataclass(frozen=True)
class LayerKind:
    """What a layer holds a texel, and how its file does.

    ``read`` returns a file's pixels, row 0 south, at a size (nx, ny); ``write`` puts them into a file, whole
    or not at all. Both raise ``DataError``.
    """

    ending: str  # of the file's name
    channels: tuple[int, ...]  # () for one number a texel
    dtype: type[np.generic]
    read: Callable[[Path, tuple[int, int]], NDArray[Any]]
    write: Callable[[Path, NDArray[Any]], None]


def _bytes(weights: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.rint(np.clip(weights, 0.0, 1.0) * 255).astype(np.uint8)


WEIGHTS = LayerKind(
    ".png",
    (4,),
    np.uint8,
    lambda path, size: _bytes(resized(weights_of(read_image(path)), size)),
    lambda path, pixels: write_png(path, pixels[::-1]),
)
"""Four weights a texel, 0..1."""

NUMBERS = LayerKind(
    ".tif", (), np.float32, lambda path, size: np.array(read_numbers(path, size)), write_numbers
)
"""A number a texel."""


@dataclass(frozen=True)
class Patch:
    """A part of the image as it was at another time."""

    part: Part
    pixels: NDArray[Any]


_Stroke = list[Patch]


class Layer:
    """An image of (ny, nx) texels or (ny, nx, channels), row 0 south, and its file, north row first."""

    def __init__(self, path: Path, pixels: NDArray[Any], kind: LayerKind) -> None:
        self.path = path
        self.pixels = pixels  # what the file is to hold
        self.kind = kind
        # What strokes change: weights in steps finer than the file's, which soft strokes add up.
        self.array = pixels if kind.dtype == np.float32 else np.asarray(pixels / np.float32(255), np.float32)
        self.ground: NDArray[np.float32] | None = (
            None  # (ny, nx) [m] that numbers are added to; None: to none
        )
        self.eroding: ErodeTool | None = None  # what "erode" runs; None: nothing
        self.token = secrets.token_hex(8)
        self.version = 0
        self.writing = LatestWrite()
        self._level: float | None = None  # what the stroke that goes on flattens to
        self._queued_version = -1  # the version that was given to be written last
        self._written = ""  # a hash of the file, as it was written here
        self._changes: deque[tuple[int, Part]] = deque(maxlen=_REMEMBERED)  # each with its version
        self._tiles: dict[tuple[int, int], Patch] | None = None  # from before the stroke that goes on
        self._before: list[_Stroke] = []  # what was there before each stroke, oldest first
        self._after: list[_Stroke] = []  # after each that was undone, the last one at the end

    @classmethod
    def create(
        cls,
        folder: Path,
        name: str,
        kind: LayerKind,
        size: tuple[int, int],
        *,
        of: Path | None = None,
        most: int = MAX_TEXELS,
    ) -> Layer:
        """Begin a file that is new in a folder: a copy of another one, or nothing painted yet.

        ``size``: texels (nx, ny) of the pass that reads it, which it takes, up to ``most`` a side.
        Raises ``DataError`` where the file cannot be read or the folder not be written to.
        """
        shrunk = min(1.0, most / max(size))
        nx, ny = (max(round(side * shrunk), 2) for side in size)
        pixels = kind.read(of, (nx, ny)) if of else np.zeros((ny, nx, *kind.channels), kind.dtype)
        with new_name(folder.resolve() / f"{name}{kind.ending}") as path:
            layer = cls(path, pixels, kind)
            layer.save()
            layer.writing.wait()
        return layer

    def set_base(self, heights: NDArray[np.float32] | None) -> None:
        """Take the heights [m] that numbers are added to, at any size; None where they change no height."""
        if heights is not None and heights.shape != self.pixels.shape:
            heights = resample(heights, self.size)
        self.ground = heights

    def paint(self, dab: Dab) -> None:
        """Go on with a stroke. Raises ``PlaygroundError`` where a technique fails."""
        if self.kind.channels:
            self._alter(dab, lambda: cover(self.array, dab))
            return
        if self._level is None:
            start = self._height_at(dab.start)
            self._level = start if dab.brush.level is None else dab.brush.level
            if self.eroding is not None:
                self.eroding.begin(start)
        if dab.brush.tool == "erode":
            self._erode(dab)
            return
        level, rate = self._level, rate_of(dab.brush, metres=self.ground is not None)
        self._alter(dab, lambda: sculpt(self.array, self.ground, dab, rate=rate, level=level))

    def _alter(self, dab: Dab, alter: Callable[[], None]) -> None:
        """Change what a dab reaches, if it reaches anything."""
        part = dab.reached(self.size)
        if not self.pixels[part].size:
            return
        self._remember(part)
        alter()
        if self.array is not self.pixels:
            self.pixels[part] = _bytes(self.array[part])
        self._change(part)

    def _erode(self, dab: Dab) -> None:
        if self.eroding is None:
            return
        for stamp in self.eroding.stamps(dab):
            part, added = self.eroding.change((self.array, self.ground), stamp)
            self._remember(part)
            self.array[part] += added
            self._change(part)

    def _height_at(self, position: tuple[float, float]) -> float:
        """Return the terrain's height at its texel nearest to a place."""
        x, y = (
            round(min(max(fraction, 0.0), 1.0) * (n - 1))
            for fraction, n in zip(position, self.size, strict=True)
        )
        return float(self.pixels[y, x]) + (0.0 if self.ground is None else float(self.ground[y, x]))

    @property
    def size(self) -> tuple[int, int]:
        """Texels (nx, ny)."""
        ny, nx = self.pixels.shape[:2]
        return nx, ny

    @property
    def saved(self) -> bool:
        """Whether the file holds what is painted, or is about to; not where writing it has failed."""
        return self._queued_version == self.version and (self.writing.pending or self.writing.error is None)

    @property
    def can_undo(self) -> bool:
        """Whether there is a stroke to undo."""
        return bool(self._before or self._tiles)

    @property
    def can_redo(self) -> bool:
        """Whether there is a stroke to paint again."""
        return bool(self._after)

    def holds(self) -> bool:
        """Return whether it is what its file holds, or newer; not where others have written the file."""
        return self.writing.pending or not self.saved or hash_of(self.path) == self._written

    def changed_since(self, version: int) -> Part:
        """Return the rows and columns of all that was changed since a version."""
        if version == self.version:
            return slice(0, 0), slice(0, 0)
        if self.version - version > len(self._changes):
            return self._whole()
        return reduce(_around, (part for at, part in self._changes if at > version))

    def begin(self) -> None:
        """Begin a stroke, which one undo will take back; what was undone before is gone.

        It flattens to the height where it begins.
        """
        self._settle()
        self._tiles, self._after, self._level = {}, [], None

    def undo(self) -> None:
        """Undo the last stroke, and save."""
        self._settle()
        self._go(self._before, self._after)

    def redo(self) -> None:
        """Redo the stroke that was undone last, and save."""
        self._go(self._after, self._before)

    def clear(self) -> None:
        """Take all paint away, and save; that can be undone as well."""
        self.begin()
        whole = self._whole()
        self._remember(whole)
        self._replace(Patch(whole, np.zeros_like(self.pixels)))
        self._change(whole)
        self.save()

    def take_in(self) -> None:
        """Read the file, which others have written; strokes from before that cannot be undone.

        Raises ``DataError`` where it cannot be read.
        """
        whole = self._whole()
        self._replace(Patch(whole, self.kind.read(self.path, self.size)))
        self._tiles = None
        self._before, self._after = [], []
        self._change(whole)
        self._queued_version, self._written = self.version, hash_of(self.path)

    def save(self) -> None:
        """Have the file written soon, as the image is now; ``writing`` has what goes wrong."""
        pixels, self._queued_version = self.pixels.copy(), self.version

        def write() -> None:
            self.kind.write(self.path, pixels)
            self._written = hash_of(self.path)

        self.writing.give(write)

    def _replace(self, patch: Patch) -> None:
        """Put pixels in their place."""
        self.pixels[patch.part] = patch.pixels
        if self.array is not self.pixels:
            self.array[patch.part] = patch.pixels / np.float32(255)

    def _remember(self, part: Part) -> None:
        """Copy the tiles of a part that the stroke is about to reach for the first time."""
        if self._tiles is None or not self.pixels[part].size:
            return
        rows, columns = (range(side.start // _TILE, -(-side.stop // _TILE)) for side in part)
        for row in rows:
            for column in columns:
                if (row, column) not in self._tiles:
                    tile = _tile(row), _tile(column)
                    self._tiles[row, column] = Patch(tile, self.pixels[tile].copy())

    def _change(self, part: Part) -> None:
        """Note that a part has changed."""
        self.version += 1
        self._changes.append((self.version, part))

    def _settle(self) -> None:
        """End the stroke that goes on: what it has changed can be undone."""
        if self._tiles:
            self._before = [*self._before, list(self._tiles.values())][-_MAX_UNDO_STEPS:]
        self._tiles = None

    def _go(self, there: list[_Stroke], back: list[_Stroke]) -> None:
        """Put back the last stroke of a list, and what it replaces on the other."""
        if not there:
            return
        patches = there.pop()
        back.append([Patch(patch.part, self.pixels[patch.part].copy()) for patch in patches])
        for patch in patches:
            self._replace(patch)
        self._change(reduce(_around, (patch.part for patch in patches)))
        self.save()

    def _whole(self) -> Part:
        nx, ny = self.size
        return slice(0, ny), slice(0, nx)


def _tile(number: int) -> slice:
    return slice(number * _TILE, (number + 1) * _TILE)


def _around(first: Part, other: Part) -> Part:
    """Return the rectangle around two."""
    rows, columns = (
        slice(min(a.start, b.start), max(a.stop, b.stop)) for a, b in zip(first, other, strict=True)
    )
    return rows, columns
