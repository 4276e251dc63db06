"""Write OpenEXR: floats as they are, which no other picture format that programs share can hold.

One part, scan lines, ZIP compression. It does not read, and writes no tiles, no mipmaps.
Source: "OpenEXR File Layout" and "Technical Introduction to OpenEXR" of the Academy Software
Foundation (openexr.com, 2024); for ZIP's two reorderings, the same, "Data Compression".
"""

from __future__ import annotations

import struct
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

_MAGIC, _VERSION = 20000630, 2
_HALF, _FLOAT = 1, 2
_ZIP, _ZIP_LINES = 3, 16
_CHANNELS = {1: "Y", 2: "RG", 3: "RGB", 4: "RGBA"}


def encode_exr(image: NDArray[Any], comments: str = "") -> bytes:
    """Return the bytes of an EXR.

    ``image`` is float16 or float32, (rows, cols) or (rows, cols, 1 to 4), top row first; its
    channels are called Y, RG, RGB or RGBA. ``comments`` goes to the attribute of that name.
    """
    if image.ndim == 2:
        image = image[..., None]
    rows, cols, count = image.shape
    kind = {"f2": _HALF, "f4": _FLOAT}[image.dtype.str[1:]]
    # A line holds one channel after the other, in the order of their names.
    names = sorted(zip(_CHANNELS[count], range(count), strict=True))
    lines = np.ascontiguousarray(np.moveaxis(image[..., [index for _, index in names]], -1, 1))
    stored = lines.astype(image.dtype.newbyteorder("<")).view(np.uint8).reshape(rows, -1)

    header = struct.pack("<ii", _MAGIC, _VERSION) + _header([name for name, _ in names], kind, cols, rows)
    header += (_attribute("comments", "string", comments.encode()) if comments else b"") + b"\0"
    blocks = []
    for top in range(0, rows, _ZIP_LINES):
        data = _packed(stored[top : top + _ZIP_LINES].ravel())
        blocks.append(struct.pack("<ii", top, len(data)) + data)
    starts = np.cumsum([len(header) + 8 * len(blocks), *map(len, blocks[:-1])])
    return header + starts.astype("<u8").tobytes() + b"".join(blocks)


def _header(names: list[str], kind: int, cols: int, rows: int) -> bytes:
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", kind, 0, 1, 1) for name in names)
    window = struct.pack("<4i", 0, 0, cols - 1, rows - 1)
    return b"".join(
        [
            _attribute("channels", "chlist", channels + b"\0"),
            _attribute("compression", "compression", bytes([_ZIP])),
            _attribute("dataWindow", "box2i", window),
            _attribute("displayWindow", "box2i", window),
            _attribute("lineOrder", "lineOrder", b"\0"),
            _attribute("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
            _attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0.0, 0.0)),
            _attribute("screenWindowWidth", "float", struct.pack("<f", 1.0)),
        ]
    )


def _attribute(name: str, kind: str, data: bytes) -> bytes:
    return name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data


def _packed(raw: NDArray[np.uint8]) -> bytes:
    """Compress some lines: bytes at even places, then those at odd ones, each less the one before."""
    parted = np.concatenate([raw[0::2], raw[1::2]])
    steps = parted.copy()
    steps[1:] = parted[1:] - parted[:-1] + np.uint8(128)  # modulo 256, as the format wants
    data = zlib.compress(steps.tobytes(), 6)
    return data if len(data) < raw.size else raw.tobytes()
