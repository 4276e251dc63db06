"""Picture files in and out: NumPy arrays from PNG, JPEG, WebP, TIFF and EXR, and back.

Pictures have their top (north) row first, in the file and in the array. A file is written whole or
not at all: a temporary file in the same folder takes the name only when it is complete. Nothing here decodes
sRGB (`playground.shader.parameter` does), applies ICC profiles, or knows of metres
(`playground.data.elevation` does). Other files of numbers are read by `playground.data.arrays` and
written by `playground.data.values`.

16-bit PNG: Pillow keeps the precision of grey but not of colour, which GDAL reads; writing is done here,
since a PNG without adaptive filters is four chunks (W3C PNG specification, third edition, 2025, clauses 5,
9 and 11). TIFFs of 16 bits, or of numbers, are tifffile's; those of 8 bits and fewer, with palettes and other
colour spaces, are Pillow's.
Source: TIFF 6.0 (Adobe 1992), sections 8 and 18 for photometry and alpha, tag 274 for the orientation.

WebP and TIFF lose nothing. JPEG has no alpha and loses a little; its colours keep their full resolution.
"""

from __future__ import annotations

import io
import logging
import math
import re
import struct
import zlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from playground.data.arrays import ArrayHeader, array_body, array_header
from playground.data.bounds import refuse_bomb, refuse_too_many, webp_size
from playground.data.content_hash import content_key
from playground.data.place import gdal
from playground.errors import DataError
from playground.files import checked_file, reading, reason, write_file
from playground.memo import FILES

if TYPE_CHECKING:
    import PIL.Image
    import tifffile
    from PIL.PngImagePlugin import PngInfo

    _Picture = PIL.Image.Image


_PICTURED = (np.uint8, np.uint16, np.float32)
_START = b"\x93NUMPY"


def is_array(handle: BinaryIO) -> bool:
    """Return whether a file that is being read is NumPy's; leaves the handle at the start."""
    start = handle.read(6)
    handle.seek(0)
    return start == _START


def _picture_header(handle: BinaryIO, path: Path) -> ArrayHeader:
    """Return the header of a picture in an `.npy`, judged before any memory is taken."""
    header = array_header(handle, path)
    shape, dtype = header.shape, header.dtype
    if len(shape) != 3 or shape[2] not in (1, 3, 4) or 0 in shape or dtype not in _PICTURED:
        raise DataError(
            f"holds {dtype} {shape}; a picture is uint8, uint16 or float32, (rows, cols, 1, 3 or 4)",
            file=path,
        )
    refuse_too_many(path, shape[1], shape[0])
    return header


def _array_samples(handle: BinaryIO, path: Path) -> NDArray[Any]:
    """Return the numbers of a picture in an `.npy`, (rows, cols, 1, 3 or 4), top row first."""
    samples = array_body(handle, _picture_header(handle, path), path.stat().st_size, path)
    if samples.dtype.kind == "f" and not (samples.min() >= 0.0 and samples.max() <= 1.0):
        raise DataError(
            f"has numbers from {samples.min():g} to {samples.max():g}; expected 0 to 1", file=path
        )
    return samples


MAX_HALF = 65504.0
"""The largest number of a half float, as which a card holds a picture of floats."""

_STARTS = (b"II*\0", b"MM\0*", b"II+\0", b"MM\0+")
_WHITE_IS_ZERO, _ASSOCIATED = 0, 1
_ON_ITS_SIDE, _TURNED_X, _TURNED_Y = (5, 6, 7, 8), (2, 3, 6, 7), (3, 4, 7, 8)


def is_tiff(handle: BinaryIO) -> bool:
    """Return whether a file that is being read is a TIFF; leaves the handle at the start."""
    start = handle.read(4)
    handle.seek(0)
    return start in _STARTS


def is_deep_tiff(handle: BinaryIO) -> bool:
    """Return whether a file that is being read is a TIFF of more than 8 bits; leaves it at the start."""
    if not is_tiff(handle):
        return False
    with _first_page(handle) as page:
        return page.dtype is not None and page.dtype.itemsize > 1


def tiff_size(handle: BinaryIO) -> tuple[int, int]:
    """Return the width and height of a picture in a TIFF, as it is shown."""
    with _first_page(handle) as page:
        width, height = page.imagewidth, page.imagelength
        return (height, width) if _orientation(page) in _ON_ITS_SIDE else (width, height)


def tiff_samples(handle: BinaryIO, path: Path) -> NDArray[np.float32]:
    """Return the numbers of a picture in a TIFF, (rows, cols, 1 to 4), top row first, straight alpha.

    Whole numbers are of 1 at their most, floats as they are.
    """
    import tifffile

    with _first_page(handle) as page:
        axes, shape, dtype = page.axes, page.shape, page.dtype
        channels = shape[axes.index("S")] if "S" in axes else 1
        if axes not in ("YX", "YXS", "SYX") or channels > 4 or dtype is None or dtype.kind not in "uif":
            raise DataError(
                f"holds {dtype} {axes} {shape}; a picture is (rows, cols, 1 to 4) of numbers", file=path
            )
        refuse_too_many(path, page.imagewidth, page.imagelength)
        refuse_bomb(path, math.prod(shape) * dtype.itemsize, path.stat().st_size)
        try:
            samples = page.asarray()
        except ValueError as error:
            if "imagecodecs" not in str(error):
                raise
            name = tifffile.COMPRESSION(page.compression).name
            message = f"its compression, {name}, cannot be read; save it with Deflate or none"
            raise DataError(message, file=path) from None
        orientation, extra, photometric = _orientation(page), page.extrasamples, page.photometric
    samples = samples.transpose(1, 2, 0) if axes == "SYX" else samples.reshape(*samples.shape[:2], -1)
    pixels = samples.astype(np.float32)
    if dtype.kind != "f":
        pixels = np.clip(pixels / np.float32(np.iinfo(dtype).max), 0.0, 1.0)
    elif not np.abs(samples).max() <= MAX_HALF:  # not a number is not
        raise DataError(f"has numbers beyond {MAX_HALF:g}, the largest of a half float", file=path)
    if photometric == _WHITE_IS_ZERO:
        pixels = 1.0 - pixels
    if extra and int(extra[0]) == _ASSOCIATED:
        alpha = pixels[..., -1:]
        pixels[..., :-1] = np.divide(
            pixels[..., :-1], alpha, out=np.zeros_like(pixels[..., :-1]), where=alpha > 0
        )
    if orientation in _ON_ITS_SIDE:
        pixels = pixels.swapaxes(0, 1)
    if orientation in _TURNED_X:
        pixels = pixels[:, ::-1]
    if orientation in _TURNED_Y:
        pixels = pixels[::-1]
    return np.ascontiguousarray(pixels)


def _orientation(page: tifffile.TiffPage) -> int:
    tag: Any = page.tags.get("Orientation")
    return int(tag.value) if tag is not None else 1


@contextmanager
def _first_page(handle: BinaryIO) -> Iterator[tifffile.TiffPage]:
    """Open the first picture of a TIFF; leaves the handle at the start."""
    import tifffile

    log = logging.getLogger("tifffile")  # it logs each odd tag to the console
    was_disabled, log.disabled = log.disabled, True
    try:
        with tifffile.TiffFile(handle) as tif:
            page = tif.pages[0]
            assert isinstance(page, tifffile.TiffPage)
            yield page
    finally:
        log.disabled = was_disabled
        handle.seek(0)


PICTURE_ENDINGS = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
"""What a picture is written as; one that is drawn in parts as the first."""

VALUE_ENDINGS: dict[str, str] = {
    ".npy": "float32, south row first",
    ".png": "16 bits, 0 to 1",
    ".tif": "float32",
    ".tiff": "float32",
}
"""What a grid of values is written as, and what the file then holds."""

VIDEO_ENDINGS: dict[str, str] = {".mp4": "H.264", ".webm": "VP9", ".gif": "256 colours"}
"""What a video is written as."""


PNG_START = b"\x89PNG\r\n\x1a\n"
PNG_KINDS = {1: 0, 3: 2, 4: 6}  # colour type by channels
_WITH_ALPHA = frozenset({"RGBA", "RGBa", "LA", "La", "PA"})
_NO_TEXT: Mapping[str, str] = MappingProxyType({})


@dataclass(frozen=True, eq=False)
class Image:
    """A picture as the file holds it: sRGB-encoded, straight alpha."""

    pixels: NDArray[np.uint8] | NDArray[np.float32]  # (rows, cols, 4), top row first; uint8 0..255
    # from 8-bit files, float32 from others: 0..1, but of a TIFF of floats as it holds them; alpha is
    # full where the file has none
    name: str  # the file's name, for messages
    has_alpha: bool  # whether the file holds an alpha channel at all, be it full everywhere

    @property
    def size(self) -> tuple[int, int]:
        """Return (width, height) in pixels."""
        rows, cols = self.pixels.shape[:2]
        return cols, rows


# Reading


def read_image(path: str | Path) -> Image:
    """Read a PNG, JPEG, WebP or TIFF, or NumPy's array of a picture (recognised by content, not by the name).

    An `.npy` is (rows, cols, 1, 3 or 4), top row first: uint8, uint16, or float32 0..1. Palettes,
    grey and CMYK become RGBA; a camera's orientation mark is obeyed; of an animation, the first
    picture counts. Alpha is straight, not premultiplied.

    Raises:
        DataError: missing, not a picture, damaged or too large.
    """
    path = checked_file(path)
    with reading(path) as handle:
        depth = _png_depth(handle)
        pixels: NDArray[np.uint8] | NDArray[np.float32]
        if is_deep_tiff(handle):
            deep = tiff_samples(handle, path)
            pixels, has_alpha = _four_channels(deep), deep.shape[-1] in (2, 4)
        elif depth == 16 or is_array(handle):
            samples = _array_samples(handle, path) if is_array(handle) else _png_samples(handle, path)
            most = np.float32(65535.0 if samples.dtype == np.uint16 else 1.0)
            pixels = _four_channels(samples)
            pixels = pixels.astype(np.float32) / most if samples.dtype != np.uint8 else pixels
            has_alpha = samples.shape[-1] in (2, 4)
        else:
            picture = open_picture(handle, path)
            has_alpha = picture.mode in _WITH_ALPHA or "transparency" in picture.info
            pixels = _eight_bit(picture)
    return Image(pixels, path.name, has_alpha)


def read_png(path: str | Path) -> tuple[NDArray[np.uint8], dict[str, str]]:
    """Read a PNG as uint8 (rows, cols, 4), top row first, and the texts it carries.

    Of 16-bit files only the high bytes are read; `read_image` reads all.

    Raises:
        DataError: missing, not a PNG, damaged or too large.
    """
    path = checked_file(path)
    with reading(path) as handle:
        depth = _png_depth(handle)
        if not depth:
            raise DataError("not a PNG file; expected one, as write_png makes them", file=path)
        picture = open_picture(handle, path)
        picture.load()
        text = {str(k): str(v) for k, v in getattr(picture, "text", {}).items()}
        if depth == 16:
            handle.seek(0)
            return (_four_channels(_png_samples(handle, path)) >> 8).astype(np.uint8), text
        return _eight_bit(picture), text


def read_samples(path: str | Path) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Read the numbers a PNG stores: (rows, cols, 1 to 4), top row first.

    uint8, or uint16 from 16-bit files; a palette is replaced by its colours.

    Raises:
        DataError: missing, not a PNG, damaged or too large.
    """
    path = checked_file(path)
    with reading(path) as handle:
        if not _png_depth(handle):
            raise DataError("not a PNG file, despite its name; expected one", file=path)
        return _png_samples(handle, path)


def read_texts(path: str | Path) -> dict[str, str]:
    """Read the texts that a PNG carries before its pixels; its pixels are not decoded.

    Raises:
        DataError: missing, not a PNG, damaged or too large.
    """
    path = checked_file(path)
    with reading(path) as handle:
        return {str(k): v for k, v in open_picture(handle, path).info.items() if isinstance(v, str)}


def _png_depth(handle: BinaryIO) -> int:
    """Return the bits of a number of a PNG, 0 for what is not one; leaves the handle at the start."""
    start = handle.read(26)
    handle.seek(0)
    return start[24] if start.startswith(PNG_START) and len(start) == 26 else 0


def open_picture(handle: BinaryIO, path: Path) -> _Picture:
    """Open a picture that is being read, and judge its size; its pixels are not decoded yet."""
    import PIL.Image

    depth = _png_depth(handle)
    size = webp_size(handle.read(30))
    handle.seek(0)
    if size is not None:
        _judge(path, size, 8)
    try:
        picture: _Picture = PIL.Image.open(handle, formats=("PNG", "JPEG", "WEBP", "TIFF"))
    except PIL.Image.DecompressionBombError as error:
        raise DataError(f"too large a picture to open: {reason(error)}", file=path) from error
    except PIL.UnidentifiedImageError as error:
        raise DataError(
            "not a picture that can be read; expected PNG, JPEG, WebP or TIFF", file=path
        ) from error
    _judge(path, picture.size, depth)
    return picture


def _judge(path: Path, size: tuple[int, int], depth: int) -> None:
    """Raise ``DataError`` for a picture that takes too much memory, four channels of it."""
    refuse_too_many(path, *size)
    refuse_bomb(path, size[0] * size[1] * (16 if depth == 16 else 4), path.stat().st_size)


def _eight_bit(picture: _Picture) -> NDArray[np.uint8]:
    from PIL import ImageOps

    return np.array(ImageOps.exif_transpose(picture).convert("RGBA"), dtype=np.uint8)


def _png_samples(handle: BinaryIO, path: Path) -> NDArray[np.uint8] | NDArray[np.uint16]:
    depth = _png_depth(handle)
    picture = open_picture(handle, path)
    if depth == 16:
        grey = picture.mode.startswith("I")
        return np.array(picture, dtype=np.uint16)[..., None] if grey else _sixteen_bit(handle)
    if picture.mode == "P":
        picture = picture.convert("RGBA" if "transparency" in picture.info else "RGB")
    elif picture.mode == "1":
        picture = picture.convert("L")
    samples = np.array(picture, dtype=np.uint8)
    return samples.reshape(*samples.shape[:2], -1)


def _sixteen_bit(handle: BinaryIO) -> NDArray[np.uint16]:
    """Return the numbers of a PNG of 16 bits and several channels, whose size has been judged."""
    from rasterio.io import MemoryFile

    handle.seek(0)
    with gdal(), MemoryFile(handle.read()) as file, file.open(driver="PNG") as raster:
        return np.ascontiguousarray(np.moveaxis(raster.read(), 0, -1))


def _four_channels(samples: NDArray[Any]) -> NDArray[Any]:
    channels = samples.shape[-1]
    colours = samples if channels > 2 else samples[..., [0, 0, 0, *range(1, channels)]]
    if colours.shape[-1] == 4:
        return colours
    most = 1 if samples.dtype.kind == "f" else np.iinfo(samples.dtype).max
    opaque = np.full((*samples.shape[:2], 1), most, dtype=samples.dtype)
    return np.concatenate([colours, opaque], axis=-1)


# Writing

# Of a PNG, 0 to 9. A picture of 1280 x 720 takes a third of the time that it does at zlib's usual 6, and is
# 4 % larger.
_COMPRESSION = 4


def encode_png(array: NDArray[np.uint8], text: Mapping[str, str] = _NO_TEXT) -> bytes:
    """Return the bytes of a PNG: `array` is uint8 (rows, cols, 3 or 4), top row first.

    `text` becomes text chunks (the keys 1 to 79 Latin-1 characters, the values any
    text). The same array and text give the same bytes, on the same Pillow.

    Raises:
        DataError: another dtype or shape, or a key that PNG cannot hold.
    """
    import PIL.Image

    array = np.asarray(array)
    if array.dtype != np.uint8 or array.ndim != 3 or array.shape[2] not in (3, 4) or 0 in array.shape:
        raise DataError(f"a picture is a uint8 array (rows, cols, 3 or 4); found {array.dtype} {array.shape}")
    stream = io.BytesIO()
    image = PIL.Image.fromarray(np.ascontiguousarray(array))
    image.save(stream, "PNG", pnginfo=_texts(text), compress_level=_COMPRESSION)
    return stream.getvalue()


def _texts(text: Mapping[str, str]) -> PngInfo:
    from PIL.PngImagePlugin import PngInfo

    chunks = PngInfo()
    for key, value in text.items():
        if not re.fullmatch(r"[!-~¡-ÿ](?:[ -~¡-ÿ]{0,77}[!-~¡-ÿ])?", key) or "  " in key:
            raise DataError(f"{key!r} cannot name a text in a PNG; expected 1 to 79 Latin-1 characters")
        if "\0" in value:
            raise DataError(f"the text {key!r} has a zero character in it, which PNG cannot hold")
        chunks.add_text(key, value)
    return chunks


def text_chunks(text: Mapping[str, str]) -> list[bytes]:
    """Return the chunks of a PNG that hold texts."""
    return [chunk(kind, data) for kind, data, *_ in _texts(text).chunks]


def encode_samples(
    samples: NDArray[np.uint8] | NDArray[np.uint16], text: Mapping[str, str] = _NO_TEXT
) -> bytes:
    """Return the bytes of a PNG that stores numbers as they are, as `read_samples` gives them.

    `samples` is uint8 or uint16, (rows, cols) or (rows, cols, 1, 3 or 4), top row first;
    `text` as in `encode_png`.
    """
    if samples.ndim == 2:
        samples = samples[..., None]
    rows, cols, channels = samples.shape
    depth = 8 * samples.dtype.itemsize
    stored = samples.astype(samples.dtype.newbyteorder(">")).reshape(rows, -1).view(np.uint8)
    # Filter 2, "Up": each byte less the one above it; smooth terrain packs well that way.
    lines = np.empty((rows, stored.shape[1] + 1), dtype=np.uint8)
    lines[:, 0] = 2
    lines[0, 1:] = stored[0]
    np.subtract(stored[1:], stored[:-1], out=lines[1:, 1:])
    header = struct.pack(">IIBBBBB", cols, rows, depth, PNG_KINDS[channels], 0, 0, 0)
    body = zlib.compress(lines.tobytes(), 6)
    chunks = [chunk(b"IHDR", header), *text_chunks(text), chunk(b"IDAT", body), chunk(b"IEND", b"")]
    return PNG_START + b"".join(chunks)


def write_png(path: str | Path, array: NDArray[np.uint8], *, text: Mapping[str, str] = _NO_TEXT) -> None:
    """Write a PNG, whole or not at all; `array` and `text` as in `encode_png`.

    Raises:
        DataError: what `encode_png` refuses, a missing folder, no permission, a full disk.
    """
    data = encode_png(array, text)
    write_file(path, data)


def chunk(kind: bytes, data: bytes) -> bytes:
    """Return a chunk of a PNG."""
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


_MAX_SIDE = {".webp": 16383, ".jpg": 65500, ".jpeg": 65500}  # pixels a side that libwebp and libjpeg take
JPEG_QUALITY = 95  # of 100: above it files grow and nothing is seen


@contextmanager
def naming(path: str | Path) -> Iterator[None]:
    """Raise a ``DataError`` of the block with the name of a file."""
    try:
        yield
    except DataError as error:
        raise DataError(error.diagnostics[0].message, file=path) from error


def picture_ending(path: str | Path) -> str:
    """Return the ending of a picture's name; raise ``DataError`` for one that no picture has."""
    ending = Path(path).suffix.lower()
    if ending not in PICTURE_ENDINGS:
        endings = f"{', '.join(PICTURE_ENDINGS[:-1])} or {PICTURE_ENDINGS[-1]}"
        raise DataError(f"a picture is written to a name ending in {endings}", file=str(path))
    return ending


def encode_as(ending: str, array: NDArray[np.uint8], text: Mapping[str, str] = _NO_TEXT) -> bytes:
    """Return the bytes of a picture, uint8 (rows, cols, 3 or 4), top row first, sRGB and straight alpha.

    JPEG and WebP take grey too, (rows, cols). ``text`` as in `encode_png`, which alone can hold it.

    Raises:
        DataError: a picture larger than the format takes, text for another than PNG.
    """
    if ending == ".png":
        return encode_png(array, text)
    if text:
        raise DataError(f"a picture ending in {ending} holds no text; .png does")
    rows, cols = array.shape[:2]
    if max(rows, cols) > (limit := _MAX_SIDE.get(ending, 2**31)):
        raise DataError(f"{cols} x {rows} pixels are too many for {ending}, which takes {limit} a side")
    stream = io.BytesIO()
    if ending in (".tif", ".tiff"):
        import tifffile

        alpha = ["unassalpha"] if array.shape[2] == 4 else None
        tifffile.imwrite(stream, array, photometric="rgb", extrasamples=alpha, metadata=None, software=False)
        return stream.getvalue()
    import PIL.Image

    picture = PIL.Image.fromarray(np.ascontiguousarray(array))
    try:
        if ending == ".webp":
            colours = picture.convert("RGB") if picture.mode == "L" else picture
            colours.save(stream, "WEBP", lossless=True, quality=60, exact=True)
        else:
            opaque = picture.convert("RGB") if picture.mode == "RGBA" else picture
            opaque.save(stream, "JPEG", quality=JPEG_QUALITY, subsampling=0, optimize=True)
    except (KeyError, OSError) as error:
        raise DataError(f"this Pillow cannot write {ending}; .png can be written: {error}") from error
    return stream.getvalue()


def write_picture(path: str | Path, array: NDArray[np.uint8], *, text: Mapping[str, str] = _NO_TEXT) -> str:
    """Write a picture, whole or not at all; `array` and `text` as in `encode_as`.

    Returns a message on the alpha that a JPEG cannot hold, or `""`.

    Raises:
        DataError: what `picture_ending` and `encode_as` refuse, a missing folder, no permission, a full disk.
    """
    ending = picture_ending(path)
    with naming(path):
        data = encode_as(ending, array, text)
    write_file(path, data)
    lost = ending in (".jpg", ".jpeg") and array.shape[2] == 4 and bool((array[..., 3] < 255).any())
    return "a JPEG is opaque: the picture's alpha was dropped; .png, .webp and .tif keep it" if lost else ""


_ORIENTATION = 0x0112  # EXIF 2.3
_SIDEWAYS = (5, 6, 7, 8)


def picture_size(path: str | Path) -> tuple[int, int]:
    """Return the width and height in pixels that ``read_image`` gives; raise ``DataError`` as it does."""
    path = checked_file(path)
    return _size(path, content_key(path))


@FILES.cached()
def _size(path: Path, _: str) -> tuple[int, int]:
    with reading(path) as handle:
        if is_array(handle):
            rows, columns = _picture_header(handle, path).shape[:2]
            return columns, rows
        if is_tiff(handle):
            return tiff_size(handle)
        picture = open_picture(handle, path)
        width, height = picture.size
        on_its_side = picture.getexif().get(_ORIENTATION) in _SIDEWAYS
    return (height, width) if on_its_side else (width, height)
