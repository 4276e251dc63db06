"""The size of a picture is that of its pixels."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from playground.data.image_files import picture_size, read_image
from playground.errors import DataError


@pytest.mark.parametrize("name", ["a.png", "a.jpg", "a.webp"])
@pytest.mark.parametrize("turned", [None, 1, 3, 6, 8])
def test_it_is_that_of_the_pixels(tmp_path: Path, name: str, turned: int | None) -> None:
    picture, path = PIL.Image.fromarray(np.zeros((5, 9, 3), np.uint8)), tmp_path / name
    exif = PIL.Image.Exif()
    if turned is not None:
        exif[0x0112] = turned
    picture.save(path, exif=exif)
    height, width = read_image(path).pixels.shape[:2]
    assert picture_size(path) == (width, height)


def test_it_follows_the_file(tmp_path: Path) -> None:
    path = tmp_path / "a.png"
    for size in ((3, 4), (8, 2)):
        PIL.Image.new("RGB", size).save(path)
        assert picture_size(path) == size


@pytest.mark.parametrize("data", [b"", b"no picture", b"\x89PNG\r\n\x1a\n"])
def test_what_is_no_picture_says_so(tmp_path: Path, data: bytes) -> None:
    path = tmp_path / "a.png"
    path.write_bytes(data)
    with pytest.raises(DataError, match=r"a\.png"):
        picture_size(path)
    with pytest.raises(DataError, match="no such file"):
        picture_size(tmp_path / "b.png")
