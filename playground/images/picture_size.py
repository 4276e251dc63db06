"""The size of a picture file, without its pixels."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path

from playground.images.array_pictures import array_shape, is_array
from playground.images.content_hash import content_key
from playground.images.files import checked_file, open_picture, reading
from playground.images.tiff_pictures import is_tiff, tiff_size

_ORIENTATION = 0x0112  # EXIF 2.3
_ON_ITS_SIDE = (5, 6, 7, 8)


def picture_size(path: str | Path) -> tuple[int, int]:
    """Return the width and height in pixels that ``read_image`` gives; raise ``DataError`` as it does."""
    path = checked_file(path)
    return _size(path, content_key(path))


@lru_cache(maxsize=256)
def _size(path: Path, _: str) -> tuple[int, int]:
    with reading(path) as handle:
        if is_array(handle):
            rows, columns = array_shape(handle, path)[0][:2]
            return columns, rows
        if is_tiff(handle):
            return tiff_size(handle)
        picture = open_picture(handle, path)
        width, height = picture.size
        on_its_side = picture.getexif().get(_ORIENTATION) in _ON_ITS_SIDE
    return (height, width) if on_its_side else (width, height)
