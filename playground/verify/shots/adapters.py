"""Take a picture from whatever holds one: an array, an image, a framebuffer, a window, a figure.

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
"""

from __future__ import annotations

import io
import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.context import ContextInfo
from playground.errors import DataError

if TYPE_CHECKING:
    import moderngl

_NUMBERS = {"f1": np.uint8, "f2": np.float16, "f4": np.float32, "nu1": np.uint8, "nu2": np.uint16}
"""What moderngl calls its kinds of number that have a picture's meaning, as NumPy has them."""


@dataclass(frozen=True, eq=False)
class Taken:
    """The numbers of a picture, and what is known of what drew it."""

    values: NDArray[Any]  # (height, width), or with 1 to 4 channels; top row first, of any dtype
    context: moderngl.Context | None = None  # that drew it
    tool: ContextInfo | None = None  # that drew it without OpenGL
    fonts: str = ""  # the files of the fonts in it, as "DejaVuSans.ttf"


def taken(thing: object) -> Taken:
    """Return the picture that a thing holds; raise ``DataError`` for what holds none."""
    for adapter in ADAPTERS:
        taken_picture = adapter(thing)
        if taken_picture is not None:
            return taken_picture
    raise AssertionError("the last adapter gives an array or raises")


def _of_moderngl(thing: Any) -> Taken | None:
    if not _is_a(thing, "moderngl"):
        return None
    if hasattr(thing, "color_attachments"):
        _make_current(thing.ctx)
        return Taken(_framebuffer(thing), thing.ctx)
    if not all(hasattr(thing, name) for name in ("read", "components", "dtype")):
        return None
    if getattr(thing, "samples", 0):
        raise DataError("a texture of several samples has no pixels to read: give its framebuffer")
    _make_current(thing.ctx)
    return Taken(_pixels(thing.read(alignment=1), thing.size, thing.components, thing.dtype), thing.ctx)


def _of_moderngl_window(thing: Any) -> Taken | None:
    if not _is_a(thing, "moderngl_window"):
        return None
    window = getattr(thing, "wnd", thing)
    if not hasattr(window, "fbo"):
        return None
    _make_current(window.ctx)
    return Taken(_framebuffer(window.fbo), window.ctx)


def _of_matplotlib(thing: Any) -> Taken | None:
    figure = getattr(thing, "figure", thing)
    savefig = getattr(thing, "savefig", None) or getattr(figure, "savefig", None)
    if not callable(savefig):
        return None
    import PIL.Image

    file = io.BytesIO()
    savefig(file, format="png", dpi="figure")  # by Agg, whatever shows the figure
    with PIL.Image.open(file) as image:
        pixels = np.array(image.convert("RGBA"))
    return Taken(pixels, tool=_matplotlib(), fonts=_fonts(figure))


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


def _of_pillow(thing: Any) -> Taken | None:
    if not _is_a(thing, "PIL"):
        return None
    if thing.mode in ("F", "I") or thing.mode.startswith("I;16"):
        return Taken(np.array(thing))
    return Taken(np.array(thing.convert("RGBA")))


def _of_vispy(thing: Any) -> Taken | None:
    return Taken(np.asarray(thing.render())) if _is_a(thing, "vispy") and hasattr(thing, "render") else None


def _of_snapshots(thing: Any) -> Taken | None:
    if callable(getattr(thing, "snapshot", None)):
        return Taken(np.asarray(thing.snapshot()))
    offscreen = _is_a(thing, "rendercanvas", "wgpu") and callable(getattr(thing, "draw", None))
    return Taken(np.asarray(thing.draw())) if offscreen else None


def _of_rgba(thing: Any) -> Taken | None:
    return Taken(np.asarray(thing.to_rgba())) if callable(getattr(thing, "to_rgba", None)) else None


def _of_arrays(thing: Any) -> Taken | None:
    try:
        array = np.asarray(thing)
    except (TypeError, ValueError):  # lists of several lengths
        array = np.asarray(None)
    if array.dtype == object:
        raise DataError(
            f"there is no picture in a {type(thing).__name__}: expected a frame, an array, an image, "
            "a framebuffer, a window or a figure"
        )
    return Taken(array)


ADAPTERS: tuple[Callable[[Any], Taken | None], ...] = (
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
