"""Encode a texture as the bytes of a file: heights, colours or other numbers.

What whole numbers mean is written where the format has a place for it (PNG's texts,
GDAL's scale and offset in TIFF) and in a JSON next to the file where it has none (raw). GDAL writes TIFF,
with the place of the terrain on the Earth, in the reference system of the file that it came from;
else texels are points, the terrain's south-west corner is (0, 0), metres.
"""

from __future__ import annotations

import io
import json
import struct
import zlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground._version import __version__
from playground.data.image_files import JPEG_QUALITY, encode_as, encode_samples
from playground.data.place import Crs, Georeference, gdal, gdal_crs, horizontal
from playground.data.values import clamped_note
from playground.errors import DataError
from playground.publish.export_formats import COLOUR, HEIGHT, whole_numbers
from playground.shader.colours import linear_to_srgb

if TYPE_CHECKING:
    from rasterio.crs import CRS


SOFTWARE = f"terrain shader playground {__version__}"


@dataclass(frozen=True, eq=False)
class Layer:
    """A texture to write, and how."""

    values: NDArray[np.float32]  # (rows, cols) or (rows, cols, 1 to 4), north row first
    kind: str  # height: [m] above sea level; colour: linear; numbers
    spacing: tuple[float, float]  # [m] a texel, east and north
    bits: int
    span: tuple[float, float] | None = None  # what 0 and the largest whole number mean
    place: Georeference | None = None  # where it lies on the Earth

    @property
    def unit(self) -> str:
        """Return " m" for heights, else nothing."""
        return " m" if self.kind == HEIGHT else ""


@dataclass(frozen=True)
class Encoded:
    """The bytes of a file, and what there is to say of them."""

    data: bytes
    details: tuple[str, ...] = ()  # parts of a message: bits, what the numbers mean
    warning: str = ""  # what was lost
    sidecar: bytes = b""  # of a JSON file that describes it


def encode(layer: Layer, ending: str) -> Encoded:
    """Return the bytes of a file with that ending.

    Raises:
        DataError: values that the format cannot hold.
    """
    if not whole_numbers(ending, layer.bits):
        return _floats(layer, ending)
    if layer.kind == COLOUR:
        span = layer.span or (0.0, 1.0)
        samples, warning = colour_samples(layer.values, layer.bits, span)
        details = (f"sRGB in {layer.bits} bits", *_black_and_white(span))
        return Encoded(encode_samples(samples, _text(layer, span)), details, warning)
    span = layer.span or usual_span(layer)
    samples, warning = _quantised(layer, span, ending)
    top = 2**layer.bits - 1
    details = (f"{layer.bits} bits", f"0 is {span[0]:.7g}{layer.unit} and {top} is {span[1]:.7g}{layer.unit}")
    if ending == ".png":
        return Encoded(encode_samples(samples, _text(layer, span)), details, warning)
    if ending in (".tif", ".tiff"):
        return Encoded(_tiff(samples, layer, span), details, warning)
    sidecar = _description(layer, "unsigned integer", span)
    return Encoded(samples.astype("<u2").tobytes(), details, warning, sidecar)


def usual_span(layer: Layer) -> tuple[float, float]:
    """Return what 0 and the largest number mean unless given: of heights, the lowest and highest."""
    if layer.kind != HEIGHT:
        return 0.0, 1.0
    _check_finite(layer.values, "whole numbers")
    low, high = float(layer.values.min()), float(layer.values.max())
    return low, high if high > low else low + 1.0  # flat terrain: any scale will do, but one metre


def light_span(values: NDArray[np.float32]) -> tuple[float, float]:
    """Return black and white of light, which has no highest value: white is the brightest, 1 at least."""
    _check_finite(values, "a picture")
    return 0.0, max(float(values.max()), 1.0)


def scale_of(span: tuple[float, float], bits: int) -> float:
    """Return the difference in value of one step of the whole numbers."""
    return (span[1] - span[0]) / float(2**bits - 1)


def colour_samples(
    values: NDArray[np.float32], bits: int = 8, span: tuple[float, float] = (0.0, 1.0)
) -> tuple[NDArray[np.uint8] | NDArray[np.uint16], str]:
    """Return linear colours encoded as sRGB, in whole numbers, and a message on what was clamped.

    ``span`` is what black and white mean.
    """
    _check_finite(values, "a picture")
    top = 2**bits - 1
    encoded = np.rint(linear_to_srgb(_share_of(values, span)) * top)
    return encoded.astype(np.uint8 if bits == 8 else np.uint16), clamped_note(values, *span)


def _share_of(values: NDArray[np.float32], span: tuple[float, float]) -> NDArray[np.float64]:
    """Return values as shares of a range, 0 to 1."""
    low, high = span
    return np.clip((values.astype(np.float64) - low) / (high - low), 0.0, 1.0)


def _black_and_white(span: tuple[float, float]) -> tuple[str, ...]:
    return () if span == (0.0, 1.0) else (f"black is {span[0]:.7g} and white is {span[1]:.7g}",)


def encode_picture(
    colours: NDArray[np.float32], ending: str, span: tuple[float, float] = (0.0, 1.0)
) -> Encoded:
    """Return the bytes of a WebP or a JPEG; ``colours`` is (rows, cols) or (rows, cols, 3), linear.

    The north row comes first. WebP loses nothing; JPEG keeps its colours at full resolution.

    Raises:
        DataError: a picture larger than the format takes, or colours that are not finite.
    """
    samples, warning = colour_samples(colours, span=span)
    lossless = "lossless" if ending == ".webp" else f"quality {JPEG_QUALITY}"
    details = (f"sRGB in 8 bits, {lossless}", *_black_and_white(span))
    return Encoded(encode_as(ending, samples.astype(np.uint8)), details, warning)


def _quantised(
    layer: Layer, span: tuple[float, float], ending: str
) -> tuple[NDArray[np.uint8] | NDArray[np.uint16], str]:
    values = layer.values
    _check_finite(values, f"{layer.bits} bits of {ending}")
    whole = np.rint(_share_of(values, span) * (2**layer.bits - 1))
    return whole.astype(np.uint8 if layer.bits == 8 else np.uint16), clamped_note(values, *span, layer.unit)


def _check_finite(values: NDArray[np.float32], where: str) -> None:
    bad = int(np.count_nonzero(~np.isfinite(values)))
    if bad:
        raise DataError(
            f"{bad} of {values.size} values are not finite, which {where} cannot hold; floats can, "
            "as in .npy, .exr or .tif"
        )


def _floats(layer: Layer, ending: str) -> Encoded:
    details = f"float{layer.bits}"
    if layer.kind == COLOUR:
        details += ", linear"
    elif layer.kind == HEIGHT:
        details += ", metres above sea level"
    values = layer.values
    if ending == ".npy":
        stream = io.BytesIO()
        np.lib.format.write_array(stream, np.ascontiguousarray(values), allow_pickle=False)
        return Encoded(stream.getvalue(), (details,))
    if ending == ".exr":
        return _exr(layer, details)
    if ending == ".r32":
        return Encoded(values.astype("<f4").tobytes(), (details,), sidecar=_description(layer, "float"))
    return Encoded(_tiff(values, layer), (details,))


def _exr(layer: Layer, details: str) -> Encoded:
    comments = f"{_what(layer)}; {_spacing(layer)} m a texel; made by {SOFTWARE}"
    values: NDArray[Any] = layer.values
    warning = ""
    if layer.bits == 16:
        limit = float(np.finfo(np.float16).max)
        with np.errstate(invalid="ignore"):  # comparing what is not a number
            outside = int(np.count_nonzero(np.abs(values) > limit))
        if outside:
            warning = f"{outside} of {values.size} values are beyond {limit:.0f}, where halves end; clamped"
        with np.errstate(all="ignore"):
            values = np.clip(values, -limit, limit).astype(np.float16)
    return Encoded(encode_exr(values, comments), (details,), warning)


def _what(layer: Layer) -> str:
    return {HEIGHT: "heights in metres above sea level", COLOUR: "linear sRGB primaries"}.get(
        layer.kind, "numbers"
    )


def _spacing(layer: Layer) -> str:
    return f"{layer.spacing[0]:.9g} {layer.spacing[1]:.9g}"


def _text(layer: Layer, span: tuple[float, float] | None = None) -> dict[str, str]:
    """Return what a PNG says of itself: number * scale + offset is the value."""
    text = {"Software": SOFTWARE, "spacing_m": _spacing(layer)}
    if span is not None and layer.kind == COLOUR:
        text |= {"black": repr(span[0]), "white": repr(span[1])}
    elif span is not None:
        unit = "_m" if layer.kind == HEIGHT else ""
        text |= {f"offset{unit}": repr(span[0]), f"scale{unit}": repr(scale_of(span, layer.bits))}
    return text


def _description(layer: Layer, numbers: str, span: tuple[float, float] | None = None) -> bytes:
    """Return the JSON that goes with a raw file, which has no header for its size."""
    rows, cols = layer.values.shape[:2]
    description: dict[str, object] = {
        "software": SOFTWARE,
        "width": cols,
        "height": rows,
        "bits": layer.bits,
        "numbers": numbers,
        "byte_order": "little",
        "first_row": "north",
        "unit": layer.unit.strip(),
        "spacing_m": list(layer.spacing),
    }
    if span is not None:
        description |= {"offset": span[0], "scale": scale_of(span, layer.bits)}
    if layer.place is not None:
        description |= {
            "crs": layer.place.crs.name or layer.place.crs.text,
            "bounds": list(layer.place.bounds),
        }
    return (json.dumps(description, indent=2) + "\n").encode()


_OWN_CRS = Crs(
    'LOCAL_CS["metres from the south-west corner of the terrain",UNIT["metre",1],'
    'AXIS["Easting",EAST],AXIS["Northing",NORTH]]'
)


def _tiff(samples: NDArray[Any], layer: Layer, span: tuple[float, float] | None = None) -> bytes:
    """Return a GeoTIFF: its outermost texels' middles are on the terrain's edges."""
    import rasterio
    from rasterio.transform import Affine

    rows, cols = samples.shape[:2]
    bands = np.moveaxis(samples.reshape(rows, cols, -1), -1, 0)
    own = Georeference(
        0.0, (rows - 1) * layer.spacing[1], layer.spacing, (cols, rows), _OWN_CRS, is_point=True
    )
    position = layer.place or own
    dx, dy = position.step_at((cols, rows))
    facts: dict[str, Any] = {"count": len(bands), "dtype": samples.dtype, "crs": _crs(layer, position.crs)}
    if samples.dtype.kind == "f" and np.isnan(samples).any():
        facts["nodata"] = np.nan
    colours = layer.kind == COLOUR and samples.ndim == 3
    with gdal(), rasterio.MemoryFile() as memory:
        with memory.open(
            driver="GTiff",
            width=cols,
            height=rows,
            transform=Affine(dx, 0.0, position.west - 0.5 * dx, 0.0, -dy, position.north + 0.5 * dy),
            photometric="RGB" if colours else "MINISBLACK",
            interleave="pixel",
            BIGTIFF="IF_SAFER",
            **facts,
        ) as raster:
            raster.update_tags(
                AREA_OR_POINT="Point" if position.is_point else "Area", TIFFTAG_SOFTWARE=SOFTWARE
            )
            if span is not None:
                raster.scales = (scale_of(span, layer.bits),) * len(bands)
                raster.offsets = (span[0],) * len(bands)
            if layer.kind == HEIGHT:
                raster.units = ("m",) * len(bands)
            raster.write(bands)
        data: bytes = memory.read()
        return data


def _crs(layer: Layer, crs: Crs) -> CRS | None:
    """Return the reference system to write, without its heights where these are not metres."""
    facts = crs.facts
    if not facts.kind:
        return None
    keeps_heights = layer.kind != HEIGHT or facts.height_unit in (0.0, 1.0)
    return gdal_crs(crs.text) if keeps_heights else horizontal(crs.text)


# ── OpenEXR, one part, scan lines, ZIP compression ─────────────────────────────


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
