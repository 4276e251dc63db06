"""A PNG written strip by strip is read by others as the pixels that went in."""

from __future__ import annotations

import io

import numpy as np
import PIL.Image
import pytest

from playground.errors import DataError
from playground.publish.png_strips import PngStrips


def picture(rows: int, cols: int, channels: int) -> np.ndarray:
    random = np.random.default_rng(3)
    smooth = np.linspace(0, 255, rows * cols * channels).reshape(rows, cols, channels).astype(np.uint8)
    noise = random.integers(0, 256, smooth.shape, np.uint8)
    return np.where(np.arange(rows)[:, None, None] % 3 == 0, noise, smooth)


@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("heights", [[7], [1, 1, 1, 4], [5, 2], [0, 7]])
def test_pillow_reads_what_was_written(channels, heights):
    total = picture(7, 11, channels)
    stream = io.BytesIO()
    writer = PngStrips(stream, (11, 7), channels, {"Title": "Terrain – hills"})
    done = 0
    for rows in heights:
        writer.write(total[done : done + rows])
        done += rows
    writer.close()
    stream.seek(0)
    result = PIL.Image.open(stream)
    np.testing.assert_array_equal(np.array(result), total)
    assert result.mode == {3: "RGB", 4: "RGBA"}[channels] and result.text == {"Title": "Terrain – hills"}


def test_smooth_rows_pack_well():
    """A slope in both directions takes a small part of its bytes: the filters are chosen."""
    rows = (np.add.outer(np.arange(200), np.arange(300)) // 2 % 256).astype(np.uint8)
    stream = io.BytesIO()
    writer = PngStrips(stream, (300, 200), 3)
    writer.write(np.repeat(rows[..., None], 3, axis=2))
    writer.close()
    assert len(stream.getvalue()) < 0.05 * rows.size * 3


def test_what_does_not_fit_is_refused():
    writer = PngStrips(io.BytesIO(), (4, 3))
    with pytest.raises(DataError, match="3 rows of the picture are missing"):
        writer.close()
    with pytest.raises(DataError, match="at most 3 rows"):
        writer.write(np.zeros((4, 4, 4), np.uint8))
    with pytest.raises(DataError, match="rows"):
        writer.write(np.zeros((1, 5, 4), np.uint8))
    with pytest.raises(DataError, match="cannot be written"):
        PngStrips(io.BytesIO(), (0, 3))
