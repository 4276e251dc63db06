"""Write Wavefront OBJ, a text that nearly every program reads, and the MTL that names its texture.

The same axes as glTF: OBJ itself has none, and most programs take y for up. Source:
Wavefront Technologies, "Advanced Visualizer" manual, appendix B1 (OBJ); Ramey, Rose and
Tyerman 1995, "MTL material format (Lightwave, OBJ)", version 4.2.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.publish.export_options import one_word
from playground.publish.mesh import TerrainMesh

_ROWS = 65536  # formatted at once


def encode_obj(mesh: TerrainMesh, name: str, *, library: str, software: str = "") -> bytes:
    """Return the text of an OBJ whose material ``land`` is in the file ``library``, in the same folder."""
    uv = mesh.uv.copy()
    uv[:, 1] = 1.0 - uv[:, 1]  # from the texture's southern edge
    corners = np.repeat(mesh.triangles.astype(np.int64) + 1, 3, axis=1)  # place, texture and normal are alike
    head = (
        f"# {software}: x east, y up, z south, in metres\n"
        f"mtllib {library}\no {one_word(name)}\nusemtl land\ns 1\n"
    )
    return b"".join(
        [
            head.encode(),
            _lines("v %.9g %.9g %.9g\n", mesh.positions),
            _lines("vt %.9g %.9g\n", uv),
            _lines("vn %.7g %.7g %.7g\n", mesh.normals),
            _lines("f %d/%d/%d %d/%d/%d %d/%d/%d\n", corners),
        ]
    )


def encode_mtl(*, texture: str = "", unlit: bool = False, software: str = "") -> bytes:
    """Return the text of an MTL: material ``land``, with a picture's name where there is one."""
    lines = [f"# {software}", "newmtl land", "Ka 0 0 0", "Kd 1 1 1", "Ks 0 0 0"]
    lines.append(f"illum {0 if unlit else 1}")  # 0: the colour as it is
    if texture:
        lines.append(f"map_Kd {texture}")
    return ("\n".join(lines) + "\n").encode()


def _lines(form: str, rows: NDArray[np.generic]) -> bytes:
    parts = []
    for start in range(0, len(rows), _ROWS):
        band = rows[start : start + _ROWS]
        parts.append(((form * len(band)) % tuple(band.ravel().tolist())).encode())
    return b"".join(parts)
