"""The sources a sketch may name: what the processor must do to make terrain.

A closed registry: a sketch is data and cannot bring Python. What an entry holds: see ``source_kinds``.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.data.by_example import ranked
from playground.data.delaunay import Rules, tables, triangulate
from playground.engine import file_sources, time_sources
from playground.engine.file_sources import make_model, read_mask, read_numbers, size_of_model
from playground.engine.source_kinds import Material, Recording, SourceKind, Terrain
from playground.engine.time_sources import (
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
from playground.errors import SketchError, nearest
from playground.sketch.model import Value


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


def _make_numbers(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    return {"painted": read_numbers(Path(str(values["image"])), size)}


def _make_array(
    values: Mapping[str, Value], size: tuple[int, int], moment: None = None
) -> dict[str, NDArray[np.float32]]:
    """Return the numbers of an array that the playground itself has written: see ``sketch.arrays``."""
    array: NDArray[np.float32] = np.load(str(values["array"]), allow_pickle=False)
    return {"values": array[..., 0] if array.shape[2] == 1 else array}


def rank_heights(
    values: Mapping[str, Value], size: tuple[int, int], material: Material
) -> dict[str, NDArray[np.float32]]:
    """Return of the example in a size (nx, ny): the normal deviate of each texel's rank, and all sorted."""
    value = material.inputs.get("example")
    example = None if value is None else value.reshape(*value.shape[:2], -1)[..., 0].astype(np.float64)
    normal, in_order = ranked(example, size, _number(values, "widest"), material.report)
    return {"normal": normal.astype(np.float32), "sorted": in_order.astype(np.float32)}


def _number(values: Mapping[str, Value], name: str) -> float:
    value = values[name]
    assert isinstance(value, int | float)  # the kernel's file says so
    return value


SOURCES: dict[str, SourceKind] = {
    "elevation_file": SourceKind(
        file_sources.describe,
        file_sources.make,
        ("elevation",),
        ("elevation", "raw_size", "packing", "no_data", "first_row", "metres"),
        "the elevation file's terrain",
        optional=("longest",),
        notes=file_sources.notes,
    ),
    "delaunay": SourceKind(
        lambda _: Terrain(),
        _make_triangulation,
        (),
        ("points", "seed", "weights", "method", "flips", "heights", "roughness", "corners", "proportion"),
        "the triangulation",
    ),
    "example_file": SourceKind(
        file_sources.describe_example,
        None,
        ("elevation",),
        file_sources.EXAMPLE_PARAMETERS,
        "the terrain",
        notes=file_sources.example_notes,
        inputs=file_sources.EXAMPLE_INPUTS,
        work=file_sources.make_from_example,
    ),
    "ranked_heights": SourceKind(
        lambda _: Terrain(),
        None,
        (),
        ("widest",),
        "the table of ranks",
        inputs=("example",),
        work=rank_heights,
    ),
    "mask_file": SourceKind(
        lambda _: Terrain(),
        _make_mask,
        ("image",),
        ("image", "texels"),
        "the mask",
        picture=_mask_picture,
    ),
    "array_file": SourceKind(
        lambda _: Terrain(),
        _make_array,
        ("array",),
        ("array",),
        "the array",
    ),
    "numbers_file": SourceKind(
        lambda _: Terrain(),
        _make_numbers,
        ("image",),
        ("image",),
        "the layer of painted numbers",
        picture=lambda values, size: Path(str(values["image"])),
    ),
    "vector_file": SourceKind(
        lambda _: Terrain(),
        file_sources.make_mask,
        ("vectors", "elevation"),
        ("vectors", "elevation", "width", "polygons"),
        "the mask of what the file draws",
        notes=file_sources.mask_notes,
    ),
    "model_file": SourceKind(
        lambda _: Terrain(),
        make_model,
        ("model",),
        ("model",),
        "the model",
        size=size_of_model,
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
        time_sources.make_keys,
        (),
        (),
        "the keyboard",
        moment=time_sources.moment_of_keys,
        size=time_sources.size_of_keys,
    ),
    "microphone": SourceKind(
        lambda _: Terrain(),
        time_sources.make_microphone,
        (),
        ("content",),
        "the microphone",
        moment=time_sources.moment_of_microphone,
        size=time_sources.size_of_microphone,
        lack=time_sources.lack_of_microphone,
    ),
    "camera": SourceKind(
        lambda _: Terrain(),
        time_sources.make_camera,
        (),
        ("device", "mirror"),
        "the camera",
        moment=time_sources.moment_of_camera,
        size=time_sources.size_of_camera,
        lack=time_sources.lack_of_camera,
    ),
}
"""Name → what it does."""
