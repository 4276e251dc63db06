"""Sources: an entry of the closed registry, and what is known of a terrain before its texels.

A source says what it knows of its terrain before any texel is made (``describe``), then makes the texels:
from its parameters (``make``), or from other passes' textures as well (``work``). What depends on more than
these, as a film does on the time, says on what (``moment``), and is made again when that changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.data.live_inputs import LiveInputs, Now
from playground.data.place import Georeference
from playground.sketch.model import Value


@dataclass(frozen=True, slots=True)
class Terrain:
    """What a source knows of its terrain; None where it does not."""

    size: tuple[int, int] | None = None  # texels, x and y
    extent: tuple[float, float] | None = None  # [m]
    relief: float | None = None  # [m] from height 0 to height 1
    base_elevation: float | None = None  # [m] above sea level at height 0
    place: Georeference | None = None  # where it lies on the Earth
    assumed: str = ""  # of the unit of its heights, where nothing says it

    def metres(self, heights: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return heights 0..1 in metres above sea level, float32; the relief and the base must be known."""
        assert self.relief is not None and self.base_elevation is not None
        return (heights.astype(np.float64) * self.relief + self.base_elevation).astype(np.float32)


class Make(Protocol):
    """Makes the texels of a source, by the names of its outputs; row 0 south."""

    def __call__(
        self, values: Mapping[str, Value], size: tuple[int, int], moment: Any = None, /
    ) -> Mapping[str, NDArray[Any]]:
        """Return an array (ny, nx) or (ny, nx, channels) for each output: 0..1, or bytes of r8 formats."""


@dataclass(frozen=True, slots=True)
class Material:
    """What a source works on that has inputs."""

    inputs: Mapping[str, NDArray[np.float32]]  # of those wired: (ny, nx) or (ny, nx, channels), row 0 south
    spacing: tuple[float, float] = (1.0, 1.0)  # [m] between its own texels, east and north
    relief: float = 1.0  # [m] from height 0 to height 1
    # Takes how many parts are done, and of how many; what it raises ends the work.
    report: Callable[[int, int], None] = lambda done, total: None


class Work(Protocol):
    """Makes the texels of a source from other passes' textures; may take seconds, in any thread."""

    def __call__(
        self, values: Mapping[str, Value], size: tuple[int, int], material: Material, /
    ) -> Mapping[str, NDArray[Any]]:
        """Return an array for each output, as ``Make`` does."""


Frames = Iterator[tuple[float, Mapping[str, NDArray[Any]]]]
"""What a source makes, frame by frame, each with the second of the source's own at which it begins."""


@dataclass(frozen=True, slots=True)
class Recording:
    """What a source that plays a file has to play, whatever the time is: for who plays it elsewhere.

    At a time it shows the second ``start + speed * time`` of the file, again and again where it loops.
    """

    frames: Callable[[Mapping[str, Value], tuple[int, int]], Frames]  # from the file's beginning
    length: Callable[[Mapping[str, Value]], float]  # [s]
    clock: Mapping[str, str]  # start, speed, loop → the parameters that say them
    laps: Callable[[Mapping[str, Value], tuple[int, int]], Frames] | None = None
    # where it repeats and hears what came before: from its end, as long as the silence before it is heard
    lead: float = 0.0  # [s] from the beginning until each lap is as the one before


@dataclass(frozen=True, slots=True)
class SourceKind:
    """One entry of the registry."""

    makes: str  # in words, with an article
    parameters: tuple[str, ...]  # what the kernel's file must declare
    make: Make | None = None  # or ``work``
    files: tuple[str, ...] = ()  # parameters that name files
    # What is known of its terrain; the size is the one it has where a sketch says none.
    describe: Callable[[Mapping[str, Value]], Terrain] = lambda values: Terrain()
    optional: tuple[str, ...] = ()  # what it may declare besides
    notes: Callable[[Mapping[str, Value]], tuple[str, ...]] = lambda _: ()  # what was assumed, what was lost
    picture: Callable[[Mapping[str, Value], tuple[int, int]], Path | None] = lambda values, size: None
    # the image whose channels, where it has this size, are the texels of the one output as they are
    # What of now the texels depend on: its ``repr`` says all of it, and ``make`` gets it. None: nothing.
    moment: Callable[[Mapping[str, Value], Now], object] | None = None
    recording: Recording | None = None  # of what plays a file
    inputs: tuple[str, ...] = ()  # what the kernel's file must declare; with these goes ``work``
    work: Work | None = None
    # Texels, where the pass says none; None: those of the terrain.
    size: Callable[[Mapping[str, Value]], tuple[int, int] | None] = lambda values: None
    # Why nothing comes, where a window feeds it; "": something may.
    lack: Callable[[Mapping[str, Value], LiveInputs], str] = lambda values, inputs: ""


def number_of(values: Mapping[str, Value], name: str) -> float:
    """Return the value of a parameter that a kernel's file must declare as a number."""
    value = values[name]
    assert isinstance(value, int | float)  # the kernel's file says so
    return value


def whole_number_of(values: Mapping[str, Value], name: str) -> int:
    """Return the value of a parameter that a kernel's file must declare as a whole number."""
    value = values[name]
    assert isinstance(value, int)  # the kernel's file says so
    return value
