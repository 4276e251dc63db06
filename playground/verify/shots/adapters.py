"""Take a picture or a mask from whatever a test gives, and turn its numbers into bytes.

Each adapter recognises one kind of thing, by its class or by what it can do, and gives its
numbers as they are, top row first. None of the libraries is imported for it: whoever hands in a
figure of matplotlib has matplotlib. The first adapter that gives something decides.

    moderngl              framebuffers, also of several samples, and textures; bottom row first there
    moderngl-window       a window, or a WindowConfig: its framebuffer
    matplotlib            a figure, or anything with one's savefig; drawn by Agg
    Pillow                an image of any mode
    vispy                 a canvas: what its render() gives
    pygfx, rendercanvas   a renderer: its snapshot(); an offscreen canvas: its draw()
    to_rgba()             any object that has it
    arrays                NumPy's, and whatever NumPy makes one of: __array__, a buffer, lists

Numbers become bytes by rules that are stated:

    bool                 black and white
    uint8                as they are
    uint16               65535 is white, to the nearest of the 255 levels
    floats               0..1, display-encoded, to the nearest level; other numbers are refused

A ``tone`` says what else floats are, and what becomes of those outside 0..1:

    clip                 display-encoded; below 0 is black, above 1 white
    srgb                 linear light, encoded as sRGB; below 0 is black, above 1 white
    reinhard             linear light x of each channel, shown as x / (1 + x), encoded as sRGB

Grey has no third axis, or one of 1; two channels are grey and alpha; alpha has no tone.
"""

from __future__ import annotations

import io
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.context import ContextInfo
from playground.errors import DataError, nearest
from playground.shader.colours import linear_to_srgb
from playground.sketch.toml_sketch import MASK_ENDING
from playground.verify.shots.compare import Light, Rectangle

if TYPE_CHECKING:
    import moderngl

# ── adapters ─────────────────────────────────────────────────────────────────


_NUMBERS = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "nu1": np.uint8, "nu2": np.uint16}
"""What moderngl calls its kinds of number that have a picture's meaning, as NumPy has them."""


@dataclass(frozen=True, eq=False)
class PictureFromTest:
    """The numbers of a picture, and what is known of what drew it."""

    values: NDArray[Any]  # (height, width), or with 1 to 4 channels; top row first, of any dtype
    context: moderngl.Context | None = None  # that drew it
    tool: ContextInfo | None = None  # that drew it without OpenGL
    fonts: str = ""  # the files of the fonts in it, as "DejaVuSans.ttf"


def picture_from(thing: object) -> PictureFromTest:
    """Return the picture that a thing holds; raise ``DataError`` for what holds none."""
    for adapter in ADAPTERS:
        test_picture = adapter(thing)
        if test_picture is not None:
            return test_picture
    raise AssertionError("the last adapter gives an array or raises")


def _of_moderngl(thing: Any) -> PictureFromTest | None:
    if not _is_a(thing, "moderngl"):
        return None
    if hasattr(thing, "color_attachments"):
        _make_current(thing.ctx)
        return PictureFromTest(_framebuffer(thing), thing.ctx)
    if not all(hasattr(thing, name) for name in ("read", "components", "dtype")):
        return None
    if getattr(thing, "samples", 0):
        raise DataError("a texture of several samples has no pixels to read: give its framebuffer")
    _make_current(thing.ctx)
    pixels = _pixels(thing.read(alignment=1), thing.size, thing.components, thing.dtype)
    return PictureFromTest(pixels, thing.ctx)


def _of_moderngl_window(thing: Any) -> PictureFromTest | None:
    if not _is_a(thing, "moderngl_window"):
        return None
    window = getattr(thing, "wnd", thing)
    if not hasattr(window, "fbo"):
        return None
    _make_current(window.ctx)
    return PictureFromTest(_framebuffer(window.fbo), window.ctx)


def _of_matplotlib(thing: Any) -> PictureFromTest | None:
    figure = getattr(thing, "figure", thing)
    savefig = getattr(thing, "savefig", None) or getattr(figure, "savefig", None)
    if not callable(savefig):
        return None
    import PIL.Image

    file = io.BytesIO()
    savefig(file, format="png", dpi="figure")  # by Agg, whatever shows the figure
    with PIL.Image.open(file) as image:
        pixels = np.array(image.convert("RGBA"))
    return PictureFromTest(pixels, tool=_matplotlib(), fonts=_fonts(figure))


def _matplotlib() -> ContextInfo | None:
    """Return what draws figures, as a renderer; None where what has a savefig is not matplotlib's."""
    library = sys.modules.get("matplotlib")
    if library is None:
        return None
    outlines = getattr(sys.modules.get("matplotlib.ft2font"), "__freetype_version__", "")
    version = f"{library.__version__}{f', FreeType {outlines}' if outlines else ''}"
    return ContextInfo(0, "matplotlib Agg", "", version, 0)


def _fonts(figure: Any) -> str:
    """Return the files of the fonts that a figure's texts are set in."""
    find = getattr(sys.modules.get("matplotlib.font_manager"), "findfont", None)
    if find is None or not hasattr(figure, "findobj"):
        return ""
    texts = figure.findobj(lambda artist: hasattr(artist, "get_fontproperties"))
    return ", ".join(sorted({Path(find(text.get_fontproperties())).name for text in texts}))


def _of_pillow(thing: Any) -> PictureFromTest | None:
    if not _is_a(thing, "PIL"):
        return None
    if thing.mode in ("F", "I") or thing.mode.startswith("I;16"):
        return PictureFromTest(np.array(thing))
    return PictureFromTest(np.array(thing.convert("RGBA")))


def _of_vispy(thing: Any) -> PictureFromTest | None:
    draws = _is_a(thing, "vispy") and hasattr(thing, "render")
    return PictureFromTest(np.asarray(thing.render())) if draws else None


def _of_snapshots(thing: Any) -> PictureFromTest | None:
    if callable(getattr(thing, "snapshot", None)):
        return PictureFromTest(np.asarray(thing.snapshot()))
    offscreen = _is_a(thing, "rendercanvas", "wgpu") and callable(getattr(thing, "draw", None))
    return PictureFromTest(np.asarray(thing.draw())) if offscreen else None


def _of_rgba(thing: Any) -> PictureFromTest | None:
    return PictureFromTest(np.asarray(thing.to_rgba())) if callable(getattr(thing, "to_rgba", None)) else None


def _of_arrays(thing: Any) -> PictureFromTest | None:
    try:
        array = np.asarray(thing)
    except (TypeError, ValueError):  # lists of several lengths
        array = np.asarray(None)
    if array.dtype == object:
        raise DataError(
            f"there is no picture in a {type(thing).__name__}: expected a frame, an array, an image, "
            "a framebuffer, a window or a figure"
        )
    return PictureFromTest(array)


ADAPTERS: tuple[Callable[[Any], PictureFromTest | None], ...] = (
    _of_moderngl,
    _of_moderngl_window,
    _of_pillow,
    _of_vispy,
    _of_snapshots,
    _of_rgba,
    _of_matplotlib,
    _of_arrays,
)


def _is_a(thing: object, *packages: str) -> bool:
    """Return whether a thing is of a class of a package, or of one that is derived from it."""
    return any(kind.__module__.partition(".")[0] in packages for kind in type(thing).__mro__)


def _make_current(context: Any) -> None:
    """Make a context current: names of objects are its own, and another one may have drawn since."""
    context.__enter__()  # and no way back: glcontext's leaves none


def _framebuffer(source: Any) -> NDArray[Any]:
    """Return the pixels of a framebuffer's first attachment, top row first; of a window's, without alpha."""
    attached = source.color_attachments
    if source.size[0] * source.size[1] == 0 or (attached is not None and len(attached) == 0):
        raise DataError("the framebuffer has no colours to read")
    components, kind = (attached[0].components, attached[0].dtype) if attached else (3, "f1")
    if not getattr(source, "samples", 0):
        read = source.read(components=components, dtype=kind, alignment=1)
        return _pixels(read, source.size, components, kind)
    context = source.ctx
    texture = context.texture(source.size, components, dtype=kind)
    resolved = context.framebuffer([texture])
    try:
        context.copy_framebuffer(resolved, source)
        return _pixels(texture.read(alignment=1), source.size, components, kind)
    finally:
        resolved.release()
        texture.release()


def _pixels(data: bytes, size: tuple[int, int], components: int, kind: str) -> NDArray[Any]:
    """Return what OpenGL gives, bottom row first, as a picture; of two channels, red and green."""
    if kind not in _NUMBERS:
        raise DataError(f"a texture of {kind!r} holds no colours; expected one of {', '.join(_NUMBERS)}")
    values = np.frombuffer(data, _NUMBERS[kind]).reshape(size[1], size[0], components)[::-1]
    if components == 2:
        values = np.concatenate([values, np.zeros_like(values[..., :1])], axis=2)
    return values


# ── numbers as bytes ─────────────────────────────────────────────────────────


Numbers = NDArray[np.float64]

HALF = 0.5 / 255.0
"""How far outside 0..1 a number may be and still round to the first or the last level."""


def _clip(values: Numbers) -> Numbers:
    return np.clip(values, 0.0, 1.0)


def _srgb(values: Numbers) -> Numbers:
    return linear_to_srgb(np.clip(values, 0.0, 1.0))


def _reinhard(values: Numbers) -> Numbers:
    light = np.maximum(values, 0.0)
    return linear_to_srgb(light / (1.0 + light))


TONES: dict[str, Callable[[Numbers], Numbers]] = {"clip": _clip, "srgb": _srgb, "reinhard": _reinhard}
"""What ``tone`` may be: numbers → display-encoded ones, 0..1."""


def levels_of(values: NDArray[Any], tone: str = "") -> tuple[NDArray[np.uint8], str]:
    """Return a picture as uint8 (height, width, 4), and a message on numbers that are not finite, or "".

    Raises ``DataError`` for another shape or dtype, for numbers outside 0..1 without a tone, and
    for a tone that is not known or that has nothing to do.
    """
    if tone and tone not in TONES:
        raise DataError(f"tone = {tone!r}: expected one of {', '.join(TONES)}{nearest(tone, TONES)}")
    channels = {2: 1}.get(values.ndim, values.shape[-1] if values.ndim == 3 else 0)
    if channels not in (1, 2, 3, 4) or 0 in values.shape:
        raise DataError(f"a picture is an array (height, width, 3 or 4), or grey; found {values.shape}")
    values = values.reshape(*values.shape[:2], channels)
    wrong = ""
    if np.issubdtype(values.dtype, np.floating):
        values, wrong = _of_floats(values, tone)
    elif tone:
        raise DataError(f"tone = {tone!r} is for floats; this picture is of {values.dtype}")
    elif values.dtype == np.bool_:
        values = values.astype(np.uint8) * np.uint8(255)
    elif values.dtype == np.uint16:
        values = ((values.astype(np.uint32) * 255 + 32767) // 65535).astype(np.uint8)
    elif values.dtype != np.uint8:
        raise DataError(
            f"a picture is of uint8, or of floats from 0 to 1, of uint16 or bool; found {values.dtype}"
        )
    return _four_channels(values), wrong


def _of_floats(values: NDArray[Any], tone: str) -> tuple[NDArray[np.uint8], str]:
    wide = values.astype(np.float64)
    finite = np.isfinite(wide)
    wrong = ""
    if not finite.all():
        bad = int(np.count_nonzero(~finite.all(axis=2)))
        wrong = f"{bad} of {wide.shape[0] * wide.shape[1]} pixels are not finite numbers"
        wide = np.where(finite, wide, 0.0)
    if not tone:
        _refuse_beyond(wide)
        return np.rint(np.clip(wide, 0.0, 1.0) * 255.0).astype(np.uint8), wrong
    colours = wide.shape[2] - (wide.shape[2] in (2, 4))
    _refuse_beyond(wide[..., colours:], ": that is alpha")
    shown = np.concatenate([TONES[tone](wide[..., :colours]), np.clip(wide[..., colours:], 0, 1)], axis=2)
    return np.rint(shown * 255.0).astype(np.uint8), wrong


def _refuse_beyond(values: Numbers, what: str = "") -> None:
    if values.size == 0:
        return
    least, most = float(values.min()), float(values.max())
    if least < -HALF or most > 1.0 + HALF:
        advice = "" if what else f"; say what they mean with tone=, one of {', '.join(TONES)}"
        raise DataError(
            f"a picture of floats is from 0 to 1, and this one from {least:.4g} to {most:.4g}{what}{advice}"
        )


def _four_channels(values: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Return grey, grey and alpha, or colours as red, green, blue and alpha."""
    channels = values.shape[2]
    colours = values[..., : channels - (channels in (2, 4))]
    alpha = values[..., -1:] if channels in (2, 4) else np.full((*values.shape[:2], 1), 255, np.uint8)
    if colours.shape[2] == 1:
        colours = np.repeat(colours, 3, axis=2)
    return np.ascontiguousarray(np.concatenate([colours, alpha], axis=2))


# ── masks ────────────────────────────────────────────────────────────────────


class MaskOfTest:
    """What a test hides of a picture. Raises ``ValueError`` for what is no mask."""

    def __init__(self, mask: object) -> None:
        __tracebackhide__ = True
        self.named: tuple[Rectangle | str, ...] = ()  # rectangles, and paths from the test file's folder
        self.textures: tuple[str, ...] = ()  # of the sketch
        self.arrays: tuple[Light, ...] = ()
        if isinstance(mask, Sequence) and not isinstance(mask, str) and _rectangle(mask) is None:
            for item in mask:
                self._add(item)
        elif mask is not None:
            self._add(mask)

    def _add(self, item: object) -> None:
        __tracebackhide__ = True
        rectangle = _rectangle(item)
        if rectangle:
            self.named += (rectangle,)
        elif isinstance(item, Path) or (isinstance(item, str) and item.endswith(MASK_ENDING)):
            self.named += (str(item),)
        elif isinstance(item, str):
            self.textures += (item,)
        elif hasattr(item, "__array__") or hasattr(item, "__array_interface__"):
            self.arrays += (Light(picture_from(item).values),)
        else:
            raise ValueError(
                f"mask = {item!r}: expected a rectangle (x, y, width, height) in pixels, the path of a PNG, "
                "a texture of the sketch, an array, or a list of such"
            )


def _rectangle(item: object) -> Rectangle | None:
    if not isinstance(item, Sequence) or isinstance(item, str) or len(item) != 4:
        return None
    if not all(isinstance(value, int | np.integer) for value in item):
        return None
    __tracebackhide__ = True
    x, y, width, height = (int(value) for value in item)
    if width < 1 or height < 1:
        raise ValueError(f"mask = {item!r}: a rectangle is (x, y, width, height), of a pixel or more")
    return x, y, width, height
