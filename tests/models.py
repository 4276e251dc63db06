"""Make the models that are shipped in ``glsl/sketches/data``: a rock and a conifer, as GLB files.

    python tests/models.py

Both are made of whole-number hashes, so every machine makes the same bytes; a test compares them.
"""

from __future__ import annotations

import json
import struct
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

DATA = Path(__file__).parents[1] / "glsl" / "sketches" / "data"


def glb(
    places: NDArray[np.float32], colours: NDArray[np.uint8], triangles: NDArray[np.uint16], name: str
) -> bytes:
    """Return a GLB of one mesh: places (n, 3) with y up, colours (n, 4), triangles (m, 3)."""
    parts = [places.astype("<f4").tobytes(), colours.tobytes(), triangles.astype("<u2").tobytes()]
    parts = [part + b"\0" * (-len(part) % 4) for part in parts]
    starts = np.cumsum([0, *map(len, parts)]).tolist()
    accessors = [
        {"componentType": 5126, "type": "VEC3", "count": len(places),
         "min": places.min(0).tolist(), "max": places.max(0).tolist()},
        {"componentType": 5121, "type": "VEC4", "count": len(colours), "normalized": True},
        {"componentType": 5123, "type": "SCALAR", "count": triangles.size},
    ]  # fmt: skip
    document = {
        "asset": {"version": "2.0", "generator": "terrain-shader-playground tests/models.py"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": name}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "COLOR_0": 1}, "indices": 2}]}],
        "accessors": [{"bufferView": k, **accessor} for k, accessor in enumerate(accessors)],
        "bufferViews": [
            {"buffer": 0, "byteOffset": starts[k], "byteLength": len(part)} for k, part in enumerate(parts)
        ],
        "buffers": [{"byteLength": starts[-1]}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(parts)
    chunks = (
        struct.pack("<II", len(text), 0x4E4F534A)
        + text
        + struct.pack("<II", len(binary), 0x004E4942)
        + binary
    )
    return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def random(keys: NDArray[np.int64], salt: int) -> NDArray[np.float64]:
    """Return a number in [0, 1) for each whole number."""
    mixed = (keys.astype(np.uint64) * np.uint64(2654435761) + np.uint64(salt * 40503)) % np.uint64(2**32)
    mixed = (mixed ^ (mixed >> np.uint64(15))) * np.uint64(2246822519) % np.uint64(2**32)
    return ((mixed ^ (mixed >> np.uint64(13))) % np.uint64(2**24)).astype(np.float64) / 2**24


def sphere(times: int) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Return an octahedron whose faces are halved so often: places on the unit sphere, triangles."""
    places = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    faces = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    points = [np.array(position, np.float64) for position in places]
    for _ in range(times):
        middles: dict[tuple[int, int], int] = {}
        finer = []
        for face in faces:
            between = []
            for a, b in ((face[0], face[1]), (face[1], face[2]), (face[2], face[0])):
                edge = (min(a, b), max(a, b))
                if edge not in middles:
                    middles[edge] = len(points)
                    middle = points[a] + points[b]
                    points.append(middle / np.sqrt(middle @ middle))
                between.append(middles[edge])
            (a, b, c), (ab, bc, ca) = face, between
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        faces = finer
    return np.array(points), np.array(faces)


def rock() -> bytes:
    """Return a boulder 1 m wide: a ball that planes have cut, rough all over."""
    places, triangles = sphere(3)
    keys = np.arange(14)
    cuts = np.stack([random(keys, salt) * 2 - 1 for salt in (1, 2, 3)], 1)
    cuts /= np.sqrt((cuts * cuts).sum(1, keepdims=True))
    far = 0.62 + 0.3 * random(keys, 4)
    radius = np.ones(len(places))
    for cut, distance in zip(cuts, far, strict=True):
        along = (places * cut).sum(1)
        radius = np.minimum(radius, distance / np.maximum(along, 1e-3))
    radius *= 1 + 0.05 * (random(np.arange(len(places)), 5) - 0.5)
    grown = places * radius[:, None] * np.array([0.56, 0.4, 0.5]) + np.array([0.0, 0.22, 0.0])
    tint = 0.75 + 0.25 * random(np.arange(len(places)), 6)
    colours = np.empty((len(places), 4), np.uint8)
    colours[:, :3] = np.floor(255 * tint[:, None] * np.array([0.42, 0.39, 0.35]))
    colours[:, 3] = 255
    rounded = np.round(grown * 4096).astype(np.float32) / np.float32(4096)
    return glb(rounded, colours, triangles.astype(np.uint16), "rock")


TURN = [(1.0, 0.0), (0.809, 0.588), (0.309, 0.951), (-0.309, 0.951), (-0.809, 0.588)]
TURN += [(-x, -y) for x, y in TURN]


def conifer() -> bytes:
    """Return a spruce 1 m tall: a trunk, and seven skirts of boughs whose rims hang in and out."""
    places: list[tuple[float, float, float]] = []
    colours: list[tuple[int, int, int, int]] = []
    triangles: list[tuple[int, int, int]] = []

    def ring(height: float, radius: float, colour: tuple[int, int, int], salt: int = 0) -> int:
        first = len(places)
        for k, (x, z) in enumerate(TURN):
            own = random(np.array([k]), salt)[0] if salt else 0.5
            out = radius * (0.78 + 0.44 * own if k % 2 else 0.62 + 0.3 * own) if salt else radius
            places.append((out * x, height - (0.035 * own if salt else 0.0), out * z))
            colours.append((*colour, 255))
        return first

    def fan(first: int, height: float, colour: tuple[int, int, int]) -> None:
        tip = len(places)
        places.append((0.0, height, 0.0))
        colours.append((*colour, 255))
        for k in range(10):
            triangles.append((tip, first + (k + 1) % 10, first + k))

    low, high = ring(0.0, 0.018, (70, 55, 42)), ring(0.2, 0.014, (70, 55, 42))
    for k in range(10):
        a, b, c, d = low + k, low + (k + 1) % 10, high + (k + 1) % 10, high + k
        triangles += [(a, c, b), (a, d, c)]
    for skirt in range(7):
        foot = 0.07 + 0.122 * skirt
        rim = ring(foot, 0.2 * (1 - skirt / 7.6), (26, 44, 20), 11 + skirt)
        fan(rim, min(foot + 0.3 - 0.012 * skirt, 1.0), (48, 72, 32))
    rounded = np.round(np.array(places) * 4096).astype(np.float32) / np.float32(4096)
    return glb(rounded, np.array(colours, np.uint8), np.array(triangles, np.uint16), "conifer")


FILES = {"rock.glb": rock, "conifer.glb": conifer}


if __name__ == "__main__":
    for name, make in FILES.items():
        (DATA / name).write_bytes(make())
