"""A small file that would become a large one is refused by its header, before any memory is taken."""

from __future__ import annotations

import io
import struct
import tracemalloc
import zipfile
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from playground.data.bounds import ALWAYS_FINE, MAX_RATIO, refuse_bomb, webp_size
from playground.data.elevation import read_elevation
from playground.data.image_files import chunk, read_image, read_samples
from playground.errors import DataError

SIDE = 16384
LITTLE = 48 * 2**20
"""[bytes] that reading headers may take at most; a picture of that many pixels takes 1 GiB."""


@contextmanager
def little_memory() -> Iterator[None]:
    """See that what happens inside takes little memory at its peak."""
    tracemalloc.start()
    try:
        yield
        assert tracemalloc.get_traced_memory()[1] < LITTLE
    finally:
        tracemalloc.stop()


def zeros_deflated(head: bytes, count: int, wrapped: bool) -> bytes:
    """Return a head and ``count`` MiB of zeros after it, deflated: a block that repeats itself."""
    pack = zlib.compressobj(9, zlib.DEFLATED, 15 if wrapped else -15)
    start = pack.compress(head) + pack.flush(zlib.Z_FULL_FLUSH)
    blocks = [pack.compress(bytes(2**20)) + pack.flush(zlib.Z_FULL_FLUSH) for _ in range(2)]
    return start + blocks[0] + blocks[1] * (count - 1) + pack.flush()


def npz(path: Path) -> None:
    """Write 16384 x 16384 zeros as NumPy does, packed to about 1 MB."""
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(
        head, {"descr": "<f4", "fortran_order": False, "shape": (SIDE, SIDE)}
    )
    data = zeros_deflated(head.getvalue(), SIDE * SIDE * 4 // 2**20, False)
    name, size = b"elevation.npy", len(head.getvalue()) + SIDE * SIDE * 4
    common = struct.pack("<HHHHHIIIHH", 20, 0, 8, 0, 33, 0, len(data), size, len(name), 0)
    local = b"PK\x03\x04" + common + name + data
    central = b"PK\x01\x02" + struct.pack("<H", 20) + common + struct.pack("<HHHII", 0, 0, 0, 0, 0) + name
    end = b"PK\x05\x06" + struct.pack("<HHHHIIH", 0, 0, 1, 1, len(central), len(local), 0)
    path.write_bytes(local + central + end)
    with zipfile.ZipFile(path) as archive, archive.open("elevation.npy") as handle:
        assert np.lib.format.read_magic(handle) == (1, 0)


def png(path: Path, depth: int = 8) -> None:
    """Write a grey picture of 13000 x 13000 zeros: fewer than Pillow itself refuses."""
    side = 13000
    count = side * (1 + side * depth // 8) // 2**20 + 1
    header = struct.pack(">IIBBBBB", side, side, depth, 0, 0, 0, 0)
    parts = [chunk(b"IHDR", header), chunk(b"IDAT", zeros_deflated(b"", count, True)), chunk(b"IEND", b"")]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))


def tiff(path: Path) -> None:
    """Write 16384 x 16384 float zeros, deflated, as one strip."""
    data = zeros_deflated(b"", SIDE * SIDE * 4 // 2**20, True)
    tags = [(256, SIDE), (257, SIDE), (258, 32), (259, 8), (262, 1), (273, 8 + 2 + 12 * 10 + 4), (277, 1)]
    tags += [(278, SIDE), (279, len(data)), (339, 3)]
    entries = b"".join(struct.pack("<HHII", tag, 4, 1, value) for tag, value in tags)
    path.write_bytes(b"II*\0" + struct.pack("<IH", 8, len(tags)) + entries + bytes(4) + data)


def webp(path: Path) -> None:
    """Write the head of a WebP of 16383 x 16383; decoding it takes memory for all of it."""
    small = io.BytesIO()
    PIL.Image.fromarray(np.zeros((8, 8, 3), np.uint8)).save(small, "WEBP", lossless=True)
    data = bytearray(small.getvalue())
    (bits,) = struct.unpack("<I", data[21:25])
    data[21:25] = struct.pack("<I", bits & ~0xFFFFFFF | 16382 | 16382 << 14)
    path.write_bytes(bytes(data))


def jpeg(path: Path) -> None:
    """Write a JPEG whose head says 13000 x 13000."""
    small = io.BytesIO()
    PIL.Image.fromarray(np.zeros((8, 8, 3), np.uint8)).save(small, "JPEG")
    data = small.getvalue()
    at = data.index(b"\xff\xc0") + 5
    path.write_bytes(data[:at] + struct.pack(">HH", 13000, 13000) + data[at + 4 :])


@pytest.mark.always
@pytest.mark.parametrize(
    ("name", "write", "read"),
    [
        ("a.npz", npz, read_elevation),
        ("a.tif", tiff, read_elevation),
        ("a.png", png, read_elevation),
        ("b.png", lambda path: png(path, 16), read_elevation),
        ("a.png", png, read_image),
        ("b.png", lambda path: png(path, 16), read_image),
        ("a.png", png, read_samples),
        ("a.webp", webp, read_image),
        ("a.jpg", jpeg, read_image),
    ],
)
def test_a_bomb_is_refused_by_its_header(
    tmp_path: Path, name: str, write: Callable[[Path], None], read: Callable[[Path], object]
) -> None:
    path = tmp_path / name
    write(path)
    assert path.stat().st_size < 2 * 2**20
    with (
        little_memory(),
        pytest.raises(DataError, match=r"would become \d+ MiB from .* not opened") as caught,
    ):
        read(path)
    assert caught.value.diagnostics[0].file.endswith(name)


def test_what_is_flat_and_not_large_is_read(tmp_path: Path) -> None:
    np.savez_compressed(tmp_path / "flat.npz", elevation=np.zeros((1025, 1025), np.float32))
    assert read_elevation(tmp_path / "flat.npz").size == (1025, 1025)
    PIL.Image.new("RGBA", (2048, 2048)).save(tmp_path / "flat.png")
    assert read_image(tmp_path / "flat.png").size == (2048, 2048)


@pytest.mark.parametrize("packed", [1, 2**20, 2**30])
def test_the_bound_is_what_it_says(tmp_path: Path, packed: int) -> None:
    most = max(ALWAYS_FINE, MAX_RATIO * packed)
    refuse_bomb(tmp_path / "a", most, packed)
    with pytest.raises(DataError, match="of more than 200 times its size"):
        refuse_bomb(tmp_path / "a", most + 1, packed)


@pytest.mark.parametrize("mode", ["RGB", "RGBA"])
@pytest.mark.parametrize("lossless", [False, True])
@pytest.mark.parametrize("size", [(53, 37), (1, 1), (640, 3)])
def test_the_size_in_a_webp_s_head_is_what_pillow_reads(
    mode: str, lossless: bool, size: tuple[int, int]
) -> None:
    stream = io.BytesIO()
    PIL.Image.new(mode, size, (9,) * len(mode)).save(stream, "WEBP", lossless=lossless)
    assert webp_size(stream.getvalue()[:30]) == size


def test_what_is_no_webp_has_no_such_size() -> None:
    assert webp_size(b"") is None and webp_size(b"RIFF" + bytes(40)) is None
