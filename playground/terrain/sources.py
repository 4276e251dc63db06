"""The sources a sketch may name: what the processor must do to make terrain.

A closed registry: a sketch is data and cannot bring Python. A source says what it knows
of its terrain before any texel is made (``describe``), then makes the texels (``make``). What depends on
more than its parameters, as a film does on the time, says on what (``moment``), and is made again when
that changes.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.errors import SketchError, nearest
from playground.media.live_inputs import LiveInputs
from playground.media.now import Now
from playground.sketch.model import Value
from playground.terrain import elevation_source as elevation
from playground.terrain import live_sources as live
from playground.terrain import vector_source as vector
from playground.terrain.delaunay import Rules, tables, triangulate
from playground.terrain.known import Terrain
from playground.terrain.masks import read_mask
from playground.terrain.over_time import (
    LEAD,
    frames_of_sound,
    frames_of_video,
    laps_of_sound,
    length_of_sound,
    length_of_video,
    make_sound,
    make_video,
    moment_of_sound,
    moment_of_video,
    size_of_sound,
    size_of_video,
)


class Make(Protocol):
    """Makes the texels of a source, by the names of its outputs; row 0 south."""

    def __call__(
        self, values: Mapping[str, Value], size: tuple[int, int], moment: Any = None, /
    ) -> Mapping[str, NDArray[Any]]:
        """Return an array (ny, nx) or (ny, nx, channels) for each output: 0..1, or bytes of r8 formats."""


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

    describe: Callable[[Mapping[str, Value]], Terrain]  # its size: the one it has, where a sketch says none
    make: Make
    files: tuple[str, ...]  # parameters that name files
    parameters: tuple[str, ...]  # what the kernel's file must declare
    makes: str  # in words, with an article
    optional: tuple[str, ...] = ()  # what it may declare besides
    notes: Callable[[Mapping[str, Value]], tuple[str, ...]] = lambda _: ()  # what was assumed, what was lost
    picture: Callable[[Mapping[str, Value], tuple[int, int]], Path | None] = lambda values, size: None
    # the image whose channels, where it has this size, are the texels of the one output as they are
    # What of now the texels depend on: its ``repr`` says all of it, and ``make`` gets it. None: nothing.
    moment: Callable[[Mapping[str, Value], Now], object] | None = None
    recording: Recording | None = None  # of what plays a file
    # Texels, where the pass says none; None: those of the terrain.
    size: Callable[[Mapping[str, Value]], tuple[int, int] | None] = lambda values: None
    # Why nothing comes, where a window feeds it; "": something may.
    lack: Callable[[Mapping[str, Value], LiveInputs], str] = lambda values, inputs: ""


def source_kind(name: str) -> SourceKind:
    """Return a registered source; raise ``SketchError`` with the nearest name."""
    if name not in SOURCES:
        raise SketchError(f"there is no source '{name}'{nearest(name, SOURCES)}")
    return SOURCES[name]


def _make_triangulation(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    rules = Rules(
        points=int(_number(values, "points")),
        seed=int(_number(values, "seed")),
        random_weights=values["weights"] == 1,
        by_flips=values["method"] == 1,
        flips=int(_number(values, "flips")),
        displaced=values["heights"] == 1,
        roughness=_number(values, "roughness"),
        corners=tuple(map(float, values["corners"])),  # type: ignore[arg-type]
        proportion=_number(values, "proportion"),
    )
    return tables(triangulate(rules), size)


def _make_mask(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    stated = values["texels"]
    assert isinstance(stated, tuple)  # the kernel's file says so
    return {"mask": read_mask(Path(str(values["image"])), size, (int(stated[0]), int(stated[1])))}


def _mask_picture(values: Mapping[str, Value], size: tuple[int, int]) -> Path | None:
    return Path(str(values["image"])) if values["texels"] in ((0, 0), size) else None


def _number(values: Mapping[str, Value], name: str) -> float:
    value = values[name]
    assert isinstance(value, int | float)  # the kernel's file says so
    return value


SOURCES: dict[str, SourceKind] = {
    "elevation_file": SourceKind(
        elevation.describe,
        elevation.make,
        ("elevation",),
        ("elevation", "raw_size", "packing", "no_data", "first_row", "metres"),
        "the elevation file's terrain",
        optional=("longest",),
        notes=elevation.notes,
    ),
    "delaunay": SourceKind(
        lambda _: Terrain(),
        _make_triangulation,
        (),
        ("points", "seed", "weights", "method", "flips", "heights", "roughness", "corners", "proportion"),
        "the triangulation",
    ),
    "mask_file": SourceKind(
        lambda _: Terrain(),
        _make_mask,
        ("image",),
        ("image", "texels"),
        "the mask",
        picture=_mask_picture,
    ),
    "vector_file": SourceKind(
        lambda _: Terrain(),
        vector.make,
        ("vectors", "elevation"),
        ("vectors", "elevation", "width", "polygons"),
        "the mask of what the file draws",
        notes=vector.notes,
    ),
    "video_file": SourceKind(
        lambda _: Terrain(),
        make_video,
        ("video",),
        ("video", "start", "speed", "loop"),
        "the film",
        moment=moment_of_video,
        recording=Recording(
            frames_of_video, length_of_video, {"start": "start", "speed": "speed", "loop": "loop"}
        ),
        size=size_of_video,
    ),
    "sound_file": SourceKind(
        lambda _: Terrain(),
        make_sound,
        ("sound",),
        ("sound", "start", "loop", "content"),
        "the sound",
        moment=moment_of_sound,
        recording=Recording(
            frames_of_sound, length_of_sound, {"start": "start", "loop": "loop"}, laps_of_sound, LEAD
        ),
        size=size_of_sound,
    ),
    "keyboard": SourceKind(
        lambda _: Terrain(),
        live.make_keys,
        (),
        (),
        "the keyboard",
        moment=live.moment_of_keys,
        size=live.size_of_keys,
    ),
    "microphone": SourceKind(
        lambda _: Terrain(),
        live.make_microphone,
        (),
        ("content",),
        "the microphone",
        moment=live.moment_of_microphone,
        size=live.size_of_microphone,
        lack=live.lack_of_microphone,
    ),
    "camera": SourceKind(
        lambda _: Terrain(),
        live.make_camera,
        (),
        ("device", "mirror"),
        "the camera",
        moment=live.moment_of_camera,
        size=live.size_of_camera,
        lack=live.lack_of_camera,
    ),
}
"""Name → what it does."""
