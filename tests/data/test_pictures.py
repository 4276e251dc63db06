"""A picture is what its name says: the format of the ending, with the same pixels in it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import PIL.Image
import pytest
import tifffile

from playground.data.image_files import PICTURE_ENDINGS, write_picture
from playground.engine.frame import Frame
from playground.errors import DataError

FORMATS = {".png": "PNG", ".jpg": "JPEG", ".jpeg": "JPEG", ".webp": "WEBP", ".tif": "TIFF", ".tiff": "TIFF"}


def picture(alpha: int = 255) -> np.ndarray:
    made = np.empty((24, 40, 4), np.uint8)
    made[..., 0] = np.linspace(20, 230, 40)
    made[..., 1] = np.linspace(200, 30, 24)[:, None]
    made[..., 2] = 90
    made[..., 3] = 255
    made[0, 0, 3] = alpha
    return made


def test_every_ending_has_its_format():
    assert set(FORMATS) == set(PICTURE_ENDINGS)


@pytest.mark.parametrize("ending", FORMATS)
@pytest.mark.parametrize("upper", [False, True])
def test_a_frame_is_saved_as_what_its_name_says(tmp_path: Path, ending: str, upper: bool):
    path = tmp_path / f"a{ending.upper() if upper else ending}"
    assert Frame(picture()).save(path) == path
    with PIL.Image.open(path) as result:
        assert result.format == FORMATS[ending]
        pixels = np.asarray(result.convert("RGB")).astype(int)
    worst = np.abs(pixels - picture()[..., :3]).max()
    assert worst == 0 if FORMATS[ending] != "JPEG" else worst <= 8, "top row first, sRGB as it is"
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


@pytest.mark.parametrize("ending", [".png", ".webp", ".tif"])
def test_alpha_and_the_colours_under_it_stay(tmp_path: Path, ending: str):
    messages: list[str] = []
    Frame(picture(alpha=0)).save(tmp_path / f"a{ending}", say=messages.append)
    read = tifffile.imread if ending == ".tif" else lambda path: np.asarray(PIL.Image.open(path))
    np.testing.assert_array_equal(read(tmp_path / f"a{ending}"), picture(alpha=0))
    assert messages == []


def test_a_jpeg_says_that_alpha_was_dropped(tmp_path: Path):
    messages: list[str] = []
    Frame(picture(alpha=254)).save(tmp_path / "a.jpg", say=messages.append)
    assert len(messages) == 1 and "alpha was dropped; .png, .webp and .tif keep it" in messages[0]
    assert write_picture(tmp_path / "b.jpg", picture()) == ""


@pytest.mark.parametrize("name", ["a.exr", "a.bmp", "a", "a.png.gif", ".png"])
def test_another_ending_is_refused_with_those_there_are(tmp_path: Path, name: str):
    with pytest.raises(DataError, match=r"ending in \.png, \.jpg, \.jpeg, \.webp, \.tif or \.tiff") as caught:
        Frame(picture()).save(tmp_path / name)
    assert name in str(caught.value) and not list(tmp_path.iterdir())


def test_what_a_format_cannot_hold_is_refused(tmp_path: Path):
    wide = np.zeros((1, 16384, 4), np.uint8)
    with pytest.raises(
        DataError, match=r"a\.webp: 16384 x 1 pixels are too many for \.webp, which takes 16383"
    ):
        write_picture(tmp_path / "a.webp", wide)
    with pytest.raises(DataError, match=r"a\.jpg: .*holds no text; \.png does"):
        write_picture(tmp_path / "a.jpg", picture(), text={"a": "b"})
    assert not list(tmp_path.iterdir())
