"""Image files: round trips, both ways against a PNG codec spelt out here, and every refusal."""

from __future__ import annotations

import io
import struct
import subprocess
import sys
import time
import zlib
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import PIL.Image
import pytest
import tifffile
from PIL import Image as PillowImage

from playground.data.content_hash import content_hash
from playground.data.image_files import (
    PICTURE_ENDINGS,
    encode_png,
    encode_samples,
    picture_size,
    read_image,
    read_png,
    read_samples,
    write_picture,
    write_png,
)
from playground.data.values import write_values
from playground.engine.frame import Frame
from playground.errors import DataError
from playground.files import new_name
from playground.publish.large import PngStrips

RNG = np.random.default_rng(5)
KINDS = {1: 0, 2: 4, 3: 2, 4: 6}


def paeth(a: int, b: int, c: int) -> int:
    return min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]


def predicted(kind: int, line: bytearray, above: bytes, i: int, step: int) -> int:
    a = line[i - step] if i >= step else 0
    b, c = above[i], above[i - step] if i >= step else 0
    return (0, a, b, (a + b) // 2, paeth(a, b, c))[kind]


def slow_png(array: np.ndarray) -> bytes:
    """Encode slowly, each row with the next of the five filters."""
    rows, cols, channels = array.shape
    depth = 8 * array.dtype.itemsize
    step = channels * array.dtype.itemsize
    body, above = bytearray(), bytes(cols * step)
    for y, row in enumerate(array.astype(array.dtype.newbyteorder(">"))):
        line = bytearray(row.tobytes())
        body.append(y % 5)
        body += bytes((v - predicted(y % 5, line, above, i, step)) % 256 for i, v in enumerate(line))
        above = bytes(line)
    chunks = [
        (b"IHDR", struct.pack(">IIBBBBB", cols, rows, depth, KINDS[channels], 0, 0, 0)),
        (b"IDAT", zlib.compress(bytes(body))),
        (b"IEND", b""),
    ]
    packed = (struct.pack(">I", len(d)) + k + d + struct.pack(">I", zlib.crc32(k + d)) for k, d in chunks)
    return b"\x89PNG\r\n\x1a\n" + b"".join(packed)


def slow_unpng(data: bytes) -> np.ndarray:
    """Decode slowly: the numbers as (rows, cols, channels)."""
    at, body, header = 8, b"", b""
    while at < len(data):
        (length,), kind = struct.unpack(">I", data[at : at + 4]), data[at + 4 : at + 8]
        content = data[at + 8 : at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length : at + 12 + length])[0] == zlib.crc32(kind + content)
        header, body = (content, body) if kind == b"IHDR" else (header, body + content * (kind == b"IDAT"))
        at += 12 + length
    cols, rows, depth, kind, *_ = struct.unpack(">IIBBBBB", header)
    channels = {v: k for k, v in KINDS.items()}[kind]
    step = channels * depth // 8
    raw, above, out = zlib.decompress(body), bytes(cols * step), bytearray()
    for y in range(rows):
        start = y * (cols * step + 1)
        line = bytearray(raw[start + 1 : start + 1 + cols * step])
        for i in range(len(line)):
            line[i] = (line[i] + predicted(raw[start], line, above, i, step)) % 256
        out += line
        above = bytes(line)
    return np.frombuffer(bytes(out), f">u{depth // 8}").reshape(rows, cols, channels).astype(f"u{depth // 8}")


def left_in(folder: Path) -> list[str]:
    return sorted(p.name for p in folder.iterdir())


# Reading


@pytest.mark.parametrize("channels", [1, 2, 3, 4])
@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
def test_every_kind_of_png_is_read_to_the_last_bit(tmp_path, channels, dtype):
    array = RNG.integers(0, np.iinfo(dtype).max + 1, (11, 6, channels), dtype=dtype)
    path = tmp_path / "a.png"
    path.write_bytes(slow_png(array))
    samples = read_samples(path)
    assert samples.dtype == dtype
    assert np.array_equal(samples, array)
    image = read_image(path)
    scaled = image.pixels.astype(np.float64) * (1.0 if dtype == np.uint8 else 65535.0)
    assert image.pixels.dtype == (np.uint8 if dtype == np.uint8 else np.float32)
    assert image.pixels.shape == (11, 6, 4) and image.size == (6, 11) and image.name == "a.png"
    colour = array[..., :3] if channels > 2 else np.repeat(array[..., :1], 3, axis=-1)
    np.testing.assert_allclose(scaled[..., :3], colour, atol=0.01)
    alpha = array[..., -1] if channels in (2, 4) else np.full((11, 6), np.iinfo(dtype).max)
    np.testing.assert_allclose(scaled[..., 3], alpha, atol=0.01)
    assert image.has_alpha == (channels in (2, 4))


@pytest.mark.parametrize("ending", ["jpg", "webp"])
def test_jpeg_and_webp_have_their_top_row_first(tmp_path, ending):
    array = np.zeros((32, 48, 3), np.uint8)
    array[:16] = (250, 20, 20)
    PillowImage.fromarray(array).save(tmp_path / f"a.{ending}", quality=95)
    image = read_image(tmp_path / f"a.{ending}")
    assert image.pixels.shape == (32, 48, 4) and not image.has_alpha
    assert abs(image.pixels[4, 20].astype(int) - (250, 20, 20, 255)).max() < 12
    assert image.pixels[28, 20, :3].max() < 12


def test_palettes_keep_their_transparency(tmp_path):
    picture = PillowImage.new("P", (4, 3), 1)
    picture.putpalette([0, 0, 0, 10, 200, 30])
    picture.putpixel((0, 0), 0)
    picture.save(tmp_path / "p.png", transparency=0)
    image = read_image(tmp_path / "p.png")
    assert image.has_alpha
    assert image.pixels[0, 0, 3] == 0 and image.pixels[2, 3].tolist() == [10, 200, 30, 255]
    assert read_samples(tmp_path / "p.png").shape == (3, 4, 4)


def test_a_full_alpha_channel_is_one_all_the_same(tmp_path):
    PillowImage.new("RGBA", (4, 3), (1, 2, 3, 255)).save(tmp_path / "full.png")
    image = read_image(tmp_path / "full.png")
    assert image.has_alpha


def test_black_and_white_pictures_are_grey(tmp_path):
    PillowImage.fromarray(np.eye(9, dtype=bool)).save(tmp_path / "b.png")
    assert np.array_equal(read_samples(tmp_path / "b.png")[..., 0], 255 * np.eye(9, dtype=np.uint8))


def test_the_camera_s_orientation_is_obeyed(tmp_path):
    exif = PillowImage.Exif()
    exif[0x0112] = 6  # rotate a quarter clockwise to show
    PillowImage.new("RGB", (40, 24)).save(tmp_path / "o.jpg", exif=exif)
    assert read_image(tmp_path / "o.jpg").size == (24, 40)


def test_cmyk_is_converted(tmp_path):
    PillowImage.new("CMYK", (8, 8), (0, 0, 0, 0)).save(tmp_path / "c.jpg")
    assert read_image(tmp_path / "c.jpg").pixels.min() == 255


@pytest.mark.parametrize("read", [read_image, read_png, read_samples])
def test_what_cannot_be_read_is_a_sentence(tmp_path, read):
    def refused(path: Path, words: str) -> None:
        with pytest.raises(DataError, match=words) as caught:
            read(path)
        assert "\n" not in str(caught.value) and str(path) in str(caught.value)

    good = slow_png(RNG.integers(0, 256, (30, 30, 4), dtype=np.uint8))
    (tmp_path / "grass.png").write_bytes(good)
    refused(tmp_path / "gras.png", "no such file; did you mean 'grass.png'")
    refused(tmp_path / "nowhere" / "a.png", "no folder")
    refused(tmp_path / "grass.png" / "a.png", "no folder")
    refused(tmp_path, "is a folder")
    (tmp_path / "empty.png").touch()
    refused(tmp_path / "empty.png", "empty")
    (tmp_path / "text.png").write_text("not a picture, but long enough to look into")
    refused(tmp_path / "text.png", "not a p|not a P")
    (tmp_path / "cut.png").write_bytes(good[: len(good) // 2])
    refused(tmp_path / "cut.png", "damaged or cut short")
    (tmp_path / "short.png").write_bytes(good[:20])
    refused(tmp_path / "short.png", "not a PNG|damaged or cut short")
    for depth in (8, 16):
        header = b"IHDR" + struct.pack(">IIBBBBB", 100_000, 100_000, depth, 2, 0, 0, 0)
        bomb = good[:8] + struct.pack(">I", 13) + header + struct.pack(">I", zlib.crc32(header)) + good[33:]
        (tmp_path / "bomb.png").write_bytes(bomb)
        refused(tmp_path / "bomb.png", "too large")


def test_permission_denied_is_a_sentence(tmp_path, monkeypatch):
    (tmp_path / "a.png").write_bytes(b"x")

    def denied(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr("playground.files.open_regular", denied)
    with pytest.raises(DataError, match=r"cannot be read: Permission denied$"):
        read_image(tmp_path / "a.png")


def test_a_16_bit_png_cut_short_is_refused(tmp_path):
    for channels in (1, 2, 3, 4):
        whole = slow_png(RNG.integers(0, 65536, (40, 40, channels), dtype=np.uint16))
        (tmp_path / "a.png").write_bytes(whole[: len(whole) // 2])
        with pytest.raises(DataError, match="damaged or cut short"):
            read_image(tmp_path / "a.png")


# Writing pictures


@pytest.mark.parametrize("channels", [3, 4])
def test_a_picture_and_its_texts_come_back(tmp_path, channels):
    array = RNG.integers(0, 256, (7, 5, channels), dtype=np.uint8)
    text = {"sketch": 'title = "Hügel"\nsize = 65\n', "Author": "名前", "two words": "", "n": "x" * 100_000}
    write_png(tmp_path / "a.png", array, text=text)
    back, texts = read_png(tmp_path / "a.png")
    assert back.dtype == np.uint8 and np.array_equal(back[..., :channels], array)
    assert channels == 4 or (back[..., 3] == 255).all()
    assert texts == text
    assert np.array_equal(slow_unpng((tmp_path / "a.png").read_bytes()), array)
    assert encode_png(array, text) == (tmp_path / "a.png").read_bytes()


def test_a_view_of_an_array_is_written_as_it_looks(tmp_path):
    array = RNG.integers(0, 256, (7, 5, 4), dtype=np.uint8)[::-1, ::2, :3]
    assert np.array_equal(slow_unpng(encode_png(array)), array)


def test_read_png_keeps_the_high_bytes_of_16_bits(tmp_path):
    array = RNG.integers(0, 65536, (4, 4, 3), dtype=np.uint16)
    (tmp_path / "a.png").write_bytes(slow_png(array))
    assert np.array_equal(read_png(tmp_path / "a.png")[0][..., :3], array >> 8)


@pytest.mark.parametrize(
    "array",
    [
        np.zeros((4, 4), np.uint8),
        np.zeros((4, 4, 2), np.uint8),
        np.zeros((4, 4, 3), np.float32),
        np.zeros((0, 4, 3), np.uint8),
    ],
)
def test_what_is_no_picture_is_not_written(tmp_path, array):
    with pytest.raises(DataError, match="uint8 array"):
        write_png(tmp_path / "a.png", array)
    assert left_in(tmp_path) == []


@pytest.mark.parametrize("key", ["", "x" * 80, "schön 名", " a", "a  b", "a\nb"])
def test_a_key_that_png_cannot_hold_is_refused(key):
    with pytest.raises(DataError, match="cannot name a text"):
        encode_png(np.zeros((2, 2, 3), np.uint8), {key: "x"})


def test_a_zero_character_is_refused():
    with pytest.raises(DataError, match="zero character"):
        encode_png(np.zeros((2, 2, 3), np.uint8), {"a": "x\0y"})


# Whole or not at all


def write_anything(path: Path) -> None:
    if path.name.endswith("picture.png"):
        write_png(path, np.zeros((4, 4, 3), np.uint8))
    else:
        write_values(path, np.zeros((4, 4), np.float32))


NAMES = ["picture.png", "values.png", "values.npy", "values.tif"]


@pytest.mark.parametrize("name", NAMES)
def test_a_failure_in_the_middle_leaves_the_old_file(tmp_path, monkeypatch, name):
    path = tmp_path / name
    path.write_bytes(b"old")

    def full(*_: object, **__: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", full)
    with pytest.raises(DataError, match="cannot be written: No space left on device"):
        write_anything(path)
    assert left_in(tmp_path) == [name] and path.read_bytes() == b"old"


def test_an_interrupt_leaves_nothing_behind(tmp_path, monkeypatch):
    def interrupted(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(np.lib.format, "write_array", interrupted)
    with pytest.raises(KeyboardInterrupt):
        write_values(tmp_path / "a.npy", np.zeros((4, 4), np.float32))
    assert left_in(tmp_path) == []


@pytest.mark.parametrize("name", NAMES)
def test_the_old_file_is_replaced_and_nothing_else_is_left(tmp_path, name):
    (tmp_path / name).write_bytes(b"old")
    write_anything(tmp_path / name)
    assert left_in(tmp_path) == [name] and (tmp_path / name).stat().st_size > 60


@pytest.mark.parametrize("name", NAMES)
def test_places_that_cannot_be_written_are_sentences(tmp_path, name):
    with pytest.raises(DataError, match=r"there is no folder .*nowhere"):
        write_anything(tmp_path / "nowhere" / name)
    (tmp_path / name).mkdir()
    with pytest.raises(DataError, match="is a folder"):
        write_anything(tmp_path / name)
    with pytest.raises(DataError, match="cannot be written"):
        write_anything(tmp_path / ("é" * 300 + name))
    with pytest.raises(DataError, match="is a folder"):
        write_png(tmp_path / "..", np.zeros((4, 4, 3), np.uint8))
    with pytest.raises(DataError, match="is a folder"):
        write_png("", np.zeros((4, 4, 3), np.uint8))
    with pytest.raises(DataError, match="zero character"):
        write_anything(tmp_path / ("a\0" + name))
    assert left_in(tmp_path) == [name]


# Writing values


@pytest.mark.parametrize("shape", [(5, 7), (5, 7, 1), (5, 7, 2), (5, 7, 3), (5, 7, 4)])
def test_npy_has_exactly_the_values_south_first(tmp_path, shape):
    values = RNG.normal(size=shape).astype(np.float32)
    values.flat[0] = np.nan
    assert write_values(tmp_path / "a.npy", values) == ""
    back = np.load(tmp_path / "a.npy")
    assert back.dtype == np.float32 and back.shape == shape
    np.testing.assert_array_equal(back, values)


@pytest.mark.parametrize("channels", [0, 1, 3, 4])
def test_png_has_16_bits_north_first(tmp_path, channels):
    shape = (6, 5, channels) if channels else (6, 5)
    values = RNG.random(shape).astype(np.float32)
    values[0, 0], values[0, 1] = 0.0, 1.0
    assert write_values(tmp_path / "a.png", values) == ""
    stored = slow_unpng((tmp_path / "a.png").read_bytes())
    expected = np.floor(values.astype(np.float64) * 65535 + 0.5).reshape(6, 5, -1)[::-1]
    assert stored.dtype == np.uint16 and np.array_equal(stored, expected)
    assert np.array_equal(read_samples(tmp_path / "a.png"), stored)


@pytest.mark.parametrize("name", ["a.tif", "a.TIFF"])
@pytest.mark.parametrize("channels", [0, 2, 3, 4])
def test_tiff_has_exactly_the_values_north_first(tmp_path, name, channels):
    import tifffile

    values = RNG.normal(size=(6, 5, channels) if channels else (6, 5)).astype(np.float32)
    values.flat[3] = np.nan
    assert write_values(tmp_path / name, values) == ""
    back = tifffile.imread(tmp_path / name)
    assert back.dtype == np.float32
    np.testing.assert_array_equal(back, values[::-1])


def test_other_programs_read_the_tiff(tmp_path):
    values = RNG.random((6, 5)).astype(np.float32)
    write_values(tmp_path / "a.tif", values)
    np.testing.assert_array_equal(np.array(PillowImage.open(tmp_path / "a.tif")), values[::-1])


def test_what_was_clamped_is_reported(tmp_path):
    values = np.array([[0.0, -0.5], [1.0, 2.0], [0.5, 1e30]], np.float32)
    message = write_values(tmp_path / "a.png", values)
    assert message == "3 of 6 values (50.0 %) are outside 0 to 1 (from -0.5 to 1e+30) and were clamped"
    assert read_samples(tmp_path / "a.png")[..., 0].tolist() == [[32768, 65535], [65535, 65535], [0, 0]]


def test_the_smallest_numbers_do_not_underflow_loudly(tmp_path):
    tiny = np.full((2, 2), 1e-42, np.float32)
    with np.errstate(all="raise"):
        assert write_values(tmp_path / "a.png", tiny) == ""
        assert write_values(tmp_path / "a.npy", np.full((2, 2), 1e-300)) == ""


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_a_png_refuses_what_is_not_finite(tmp_path, bad):
    with pytest.raises(DataError, match=r"1 of 4 values are not finite.*\.npy and \.tif can"):
        write_values(tmp_path / "a.png", np.array([[0, 1], [bad, 0]], np.float32))
    assert left_in(tmp_path) == []


@pytest.mark.parametrize(
    ("name", "values", "words"),
    [
        ("a.pgn", np.zeros((4, 4)), r"'\.pgn'; did you mean '\.png'"),
        ("a", np.zeros((4, 4)), r"there are: \.npy, \.png, \.tif, \.tiff"),
        ("a.exr", np.zeros((4, 4)), "cannot be written as"),
        ("a.npy", np.zeros(4), "ny, nx"),
        ("a.npy", np.zeros((0, 4)), "ny, nx"),
        ("a.npy", np.zeros((4, 4), complex), "complex128"),
        ("a.npy", np.array([["a"]]), "found <U1"),
        ("a.tif", np.zeros((4, 4, 5)), "5 channels are too many"),
        ("a.png", np.zeros((4, 4, 2)), "1, 3 or 4 channels; found 2"),
    ],
)
def test_values_that_cannot_be_written_are_sentences(tmp_path, name, values, words):
    with pytest.raises(DataError, match=words):
        write_values(tmp_path / name, values)
    assert left_in(tmp_path) == []


def test_a_new_name_is_one_that_nothing_has(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with new_name("terrain.png") as first, new_name("terrain.png") as second:
        assert (first.name, second.name) == ("terrain.png", "terrain-2.png")
        assert first.exists() and second.exists(), "held from here on"
    assert left_in(tmp_path) == ["terrain-2.png", "terrain.png"]


def test_a_new_name_is_given_back_when_nothing_is_written(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(KeyboardInterrupt), new_name("terrain.png"):
        raise KeyboardInterrupt
    assert left_in(tmp_path) == []


def test_a_new_name_where_nothing_can_be_written_is_a_sentence(tmp_path):
    with (
        pytest.raises(DataError, match="nothing can be written here: No such file"),
        new_name(tmp_path / "a/b"),
    ):
        raise AssertionError


def test_importing_loads_no_heavy_library():
    code = (
        "import sys, playground.data.image_files, playground.data.elevation; "
        "print([m for m in ('PIL', 'tifffile', 'scipy', 'imagecodecs') if m in sys.modules])"
    )
    root = Path(__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=root, check=True)
    assert done.stdout.strip() == "[]"


def test_the_slow_codec_of_these_tests_agrees_with_pillow():
    array = RNG.integers(0, 256, (12, 9, 3), dtype=np.uint8)
    assert np.array_equal(np.array(PillowImage.open(io.BytesIO(slow_png(array)))), array)
    assert np.array_equal(slow_unpng(slow_png(array)), array)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16])
@pytest.mark.parametrize("shape", [(4, 7), (4, 7, 1), (3, 5, 3), (6, 1, 4)])
def test_samples_are_stored_as_they_are_with_texts(dtype, shape, tmp_path):
    samples = RNG.integers(0, np.iinfo(dtype).max, shape, dtype=dtype, endpoint=True)
    path = tmp_path / "a.png"
    path.write_bytes(encode_samples(samples, {"scale_m": "0.25", "Title": "Grès"}))
    result = read_samples(path)
    assert result.dtype == dtype
    np.testing.assert_array_equal(result, samples.reshape(result.shape))
    with PillowImage.open(path) as picture:
        assert picture.text == {"scale_m": "0.25", "Title": "Grès"}
    with pytest.raises(DataError, match="cannot name a text"):
        encode_samples(samples, {"": "x"})


def test_saves_in_one_tick_of_the_clock_have_different_hashes(tmp_path, monkeypatch):
    """Each keeps inode, size and time of change, as ``cp -p`` does; the clocks stand."""
    path, hashes, now = tmp_path / "a.png", set(), time.time_ns()
    tick = SimpleNamespace(st_ino=1, st_size=1, st_mtime_ns=10**18, st_ctime_ns=now)
    monkeypatch.setattr("playground.data.content_hash.require_regular", lambda _: tick)
    monkeypatch.setattr("playground.data.content_hash.time", SimpleNamespace(time_ns=lambda: now))
    for value in range(5):
        path.write_bytes(bytes([value]))
        hashes.add(content_hash(path))
    assert len(hashes) == 5


# ── A picture is what its name says: the format of the ending, with the same pixels in it


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


# ── The size of a picture is that of its pixels ──────────────────────────────


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


# ── A PNG written strip by strip is read by others as the pixels that went in


def rough_picture(rows: int, cols: int, channels: int) -> np.ndarray:
    random = np.random.default_rng(3)
    smooth = np.linspace(0, 255, rows * cols * channels).reshape(rows, cols, channels).astype(np.uint8)
    noise = random.integers(0, 256, smooth.shape, np.uint8)
    return np.where(np.arange(rows)[:, None, None] % 3 == 0, noise, smooth)


@pytest.mark.parametrize("channels", [3, 4])
@pytest.mark.parametrize("heights", [[7], [1, 1, 1, 4], [5, 2], [0, 7]])
def test_pillow_reads_what_was_written(channels, heights):
    total = rough_picture(7, 11, channels)
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


# ── Pictures in TIFF files are read to the bit, whatever numbers they hold and however these are lai


SHAPE = (6, 9)
LAYOUTS = [
    {},
    {"byteorder": ">"},
    {"compression": "zlib", "predictor": True},
    {"tile": (16, 16)},
    {"rowsperstrip": 2},
    {"bigtiff": True},
]


def written(path, array, **how):
    is_colour = array.ndim == 3 and array.shape[-1] > 2
    how = {"photometric": "rgb" if is_colour else "minisblack", "metadata": None} | how
    if array.ndim == 3 and array.shape[-1] in (2, 4) and how.get("planarconfig") != "separate":
        how.setdefault("extrasamples", ["unassalpha"])
    tifffile.imwrite(path, array[..., 0] if array.shape[-1] == 1 else array, **how)
    return path


def four(array):
    """Return an array of 1 to 4 channels as red, green, blue and alpha of 1."""
    channels = array.shape[-1]
    colour = array if channels > 2 else array[..., [0, 0, 0, *range(1, channels)]]
    return colour if colour.shape[-1] == 4 else np.concatenate([colour, np.ones_like(colour[..., :1])], -1)


@pytest.mark.parametrize("kind", ["uint8", "uint16", "uint32", "float16", "float32", "float64"])
@pytest.mark.parametrize("channels", [1, 3, 4])
def test_numbers_are_those_of_the_file(tmp_path, kind, channels):
    numbers = RNG.random((*SHAPE, channels))
    dtype = np.dtype(kind)
    most = 1.0 if dtype.kind == "f" else float(np.iinfo(dtype).max)
    stored = (numbers * 3 - 1 if dtype.kind == "f" else np.rint(numbers * most)).astype(dtype)
    for how in LAYOUTS:
        if dtype.kind == "f" and "predictor" in how:
            how = {"compression": "zlib"}
        path = written(tmp_path / "a.tif", stored, **how)
        image = read_image(path)
        pixels = image.pixels / 255 if image.pixels.dtype == np.uint8 else image.pixels
        np.testing.assert_allclose(pixels, four(stored.astype(np.float64) / most), atol=6e-8, rtol=6e-8)
        assert image.has_alpha == (channels == 4)
        assert picture_size(path) == image.size == (9, 6)


@pytest.mark.parametrize("kind", ["uint8", "uint16", "float32"])
def test_every_orientation_is_obeyed(tmp_path, kind):
    stored = RNG.integers(0, 250, (*SHAPE, 3)).astype(kind)
    most = 1.0 if kind == "float32" else np.iinfo(kind).max
    turned = stored.swapaxes(0, 1)
    shown = [stored, stored[:, ::-1], stored[::-1, ::-1], stored[::-1]]
    shown += [turned, turned[:, ::-1], turned[::-1, ::-1], turned[::-1]]
    for number, expected in enumerate(shown, 1):
        path = written(tmp_path / "a.tif", stored, extratags=[(274, 3, 1, number, True)])
        image = read_image(path)
        pixels = image.pixels / 255 if kind == "uint8" else image.pixels
        np.testing.assert_allclose(pixels[..., :3] * most, expected, atol=1e-3, err_msg=str(number))
        assert picture_size(path) == image.size


def test_planes_inverse_grey_and_premultiplied_alpha(tmp_path):
    planes = RNG.random((3, *SHAPE)).astype(np.float32)
    path = written(tmp_path / "a.tif", planes, photometric="rgb", planarconfig="separate")
    np.testing.assert_array_equal(read_image(path).pixels[..., :3], planes.transpose(1, 2, 0))
    grey = RNG.integers(0, 65536, SHAPE).astype(np.uint16)
    pixels = read_image(written(tmp_path / "b.tif", grey, photometric="miniswhite")).pixels
    np.testing.assert_allclose(pixels[..., 0], 1 - grey / 65535, atol=1e-7)
    straight = RNG.random((*SHAPE, 4)).astype(np.float32)
    straight[0, 0, 3] = 0.0
    stored = np.concatenate([straight[..., :3] * straight[..., 3:], straight[..., 3:]], -1)
    pixels = read_image(written(tmp_path / "c.tif", stored, extrasamples=["assocalpha"])).pixels
    straight[0, 0, :3] = 0.0
    np.testing.assert_allclose(pixels, straight, rtol=1e-6)


@pytest.mark.parametrize(
    ("stored", "words"),
    [
        (np.full(SHAPE, np.nan, np.float32), "beyond 65504"),
        (np.full(SHAPE, 1e6, np.float32), "beyond 65504"),
        (np.zeros((5, *SHAPE), np.uint16), "a picture is"),
        (np.zeros(SHAPE, np.complex64), "a picture is"),
    ],
)
def test_what_is_no_picture_is_one_sentence(tmp_path, stored, words):
    path = tmp_path / "a.tif"
    how = {"planarconfig": "contig"} if stored.ndim == 3 else {}
    tifffile.imwrite(path, stored.transpose(1, 2, 0) if stored.ndim == 3 else stored, metadata=None, **how)
    with pytest.raises(DataError, match=words):
        read_image(path)
    path.write_bytes(path.read_bytes()[:60])
    with pytest.raises(DataError, match="damaged or cut short"):
        read_image(path)
