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
from playground.engine.file_sources import read_mask, read_numbers
from playground.engine.source_kinds import Material, Recording, SourceKind, number_of
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
        points=int(number_of(values, "points")),
        seed=int(number_of(values, "seed")),
        random_weights=values["weights"] == 1,
        by_flips=values["method"] == 1,
        flips=int(number_of(values, "flips")),
        displaced=values["heights"] == 1,
        roughness=number_of(values, "roughness"),
        corners=tuple(map(float, values["corners"])),  # type: ignore[arg-type]
        proportion=number_of(values, "proportion"),
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
    normal, in_order = ranked(example, size, number_of(values, "widest"), material.report)
    return {"normal": normal.astype(np.float32), "sorted": in_order.astype(np.float32)}


SOURCES: dict[str, SourceKind] = {
    "elevation_file": SourceKind(
        "the elevation file's terrain",
        ("elevation", "raw_size", "packing", "no_data", "first_row", "metres"),
        file_sources.make,
        ("elevation",),
        file_sources.describe,
        optional=("longest",),
        notes=file_sources.notes,
    ),
    "delaunay": SourceKind(
        "the triangulation",
        ("points", "seed", "weights", "method", "flips", "heights", "roughness", "corners", "proportion"),
        _make_triangulation,
    ),
    "example_file": SourceKind(
        "the terrain",
        file_sources.EXAMPLE_PARAMETERS,
        files=("elevation",),
        describe=file_sources.describe_example,
        notes=file_sources.example_notes,
        inputs=file_sources.EXAMPLE_INPUTS,
        work=file_sources.make_from_example,
    ),
    "ranked_heights": SourceKind("the table of ranks", ("widest",), inputs=("example",), work=rank_heights),
    "mask_file": SourceKind("the mask", ("image", "texels"), _make_mask, ("image",), picture=_mask_picture),
    "array_file": SourceKind("the array", ("array",), _make_array, ("array",)),
    "numbers_file": SourceKind(
        "the layer of painted numbers",
        ("image",),
        _make_numbers,
        ("image",),
        picture=lambda values, size: Path(str(values["image"])),
    ),
    "vector_file": SourceKind(
        "the mask of what the file draws",
        ("vectors", "elevation", "width", "polygons"),
        file_sources.make_mask,
        ("vectors", "elevation"),
        notes=file_sources.mask_notes,
    ),
    "model_file": SourceKind(
        "the model", ("model",), file_sources.make_model, ("model",), size=file_sources.size_of_model
    ),
    "video_file": SourceKind(
        "the film",
        ("video", "start", "speed", "loop"),
        time_sources.make_video,
        ("video",),
        moment=time_sources.moment_of_video,
        recording=Recording(
            time_sources.frames_of_video,
            time_sources.length_of_video,
            {"start": "start", "speed": "speed", "loop": "loop"},
        ),
        size=time_sources.size_of_video,
    ),
    "sound_file": SourceKind(
        "the sound",
        ("sound", "start", "loop", "content"),
        time_sources.make_sound,
        ("sound",),
        moment=time_sources.moment_of_sound,
        recording=Recording(
            time_sources.frames_of_sound,
            time_sources.length_of_sound,
            {"start": "start", "loop": "loop"},
            time_sources.laps_of_sound,
            time_sources.LEAD,
        ),
        size=time_sources.size_of_sound,
    ),
    "keyboard": SourceKind(
        "the keyboard",
        (),
        time_sources.make_keys,
        moment=time_sources.moment_of_keys,
        size=time_sources.size_of_keys,
    ),
    "microphone": SourceKind(
        "the microphone",
        ("content",),
        time_sources.make_microphone,
        moment=time_sources.moment_of_microphone,
        size=time_sources.size_of_microphone,
        lack=time_sources.lack_of_microphone,
    ),
    "camera": SourceKind(
        "the camera",
        ("device", "mirror"),
        time_sources.make_camera,
        moment=time_sources.moment_of_camera,
        size=time_sources.size_of_camera,
        lack=time_sources.lack_of_camera,
    ),
}
"""Name → what it does."""
