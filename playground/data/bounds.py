"""Return how large a file may become in memory, judged by its header, before any memory is taken.

A packed file of a megabyte can hold a gigabyte of zeros. Pictures and terrain that people have stay far
below ``MAX_RATIO``; what is flat, as a mask with nothing painted on it, stays below ``ALWAYS_FINE``.
"""

from __future__ import annotations

import struct
from pathlib import Path

from playground.errors import DataError

MAX_TEXELS = 2**28  # 16384 x 16384: what a graphics card takes, and 1 GiB as float32
ALWAYS_FINE = 2**29  # [bytes] unpacked, at any ratio
MAX_RATIO = 200  # of what is unpacked to what is on the disk


def refuse_bomb(path: Path, unpacked: int, packed: int) -> None:
    """Raise ``DataError`` for a file that would become so many bytes from so few."""
    if unpacked > ALWAYS_FINE and unpacked > MAX_RATIO * packed:
        what = f"would become {unpacked / 2**20:.0f} MiB from {packed / 2**20:.2g} MiB"
        bound = (
            f"above {ALWAYS_FINE // 2**20} MiB a file of more than {MAX_RATIO} times its size is not opened"
        )
        raise DataError(f"{what}; {bound}", file=path)


def refuse_too_many(path: Path, width: int, height: int) -> None:
    """Raise ``DataError`` for a picture of too many pixels."""
    if width * height > MAX_TEXELS:
        raise DataError(f"{width} x {height} pixels are too many; the limit is 2**28", file=path)


def webp_size(start: bytes) -> tuple[int, int] | None:
    """Return the width and height in a WebP's first 30 bytes; None for another format.

    A WebP is decoded as a whole, into memory for all of it. RFC 9649 (2024), sections 2.5 to 2.7.
    """
    if len(start) < 30 or start[:4] != b"RIFF" or start[8:12] != b"WEBP":
        return None
    kind = start[12:16]
    if kind == b"VP8X":
        return int.from_bytes(start[24:27], "little") + 1, int.from_bytes(start[27:30], "little") + 1
    if kind == b"VP8L":
        (bits,) = struct.unpack("<I", start[21:25])
        return (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    width, height = struct.unpack("<HH", start[26:30])
    return width & 0x3FFF, height & 0x3FFF
