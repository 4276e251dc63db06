"""Formulas as pictures: LaTeX set by MicroTeX with the Latin Modern font, both of which imgui_bundle brings.

A formula is set once for each size and colour, and cached as a texture. One that MicroTeX
cannot read has none: it is written as its source then.
"""

from __future__ import annotations

import os
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import imgui_bundle
import numpy as np
from imgui_bundle import imgui_microtex as microtex
from numpy.typing import NDArray

if TYPE_CHECKING:
    import moderngl

_PROBE = "a+b"  # what MicroTeX looks at through a locale
_MAX_TEXTURES = 300
"""Textures that are cached; beyond, all are released and made again where they are visible."""


@dataclass(frozen=True)
class TypesetFormula:
    """A formula's picture."""

    pixels: NDArray[np.uint8]  # (height, width, 4), top row first; straight alpha
    baseline: int  # rows from the top


@dataclass
class Formulas:
    """The textures of one context."""

    ctx: moderngl.Context

    def __post_init__(self) -> None:
        self._known: dict[tuple[str, int, int, bool], tuple[moderngl.Texture, int] | None] = {}

    def get(
        self, latex: str, size: float, colour: int, *, display: bool
    ) -> tuple[moderngl.Texture, int] | None:
        """Return a formula's texture, top row first, and its baseline [pixels from the top].

        ``size`` of its font [pixels]; ``colour`` as imgui packs it. None for one that cannot be set.
        """
        key = (latex, round(size), colour, display)
        if key not in self._known:
            if len(self._known) >= _MAX_TEXTURES:
                self.release()
            formula = set_formula(latex, round(size), colour, display=display)
            self._known[key] = None if formula is None else (self._texture(formula.pixels), formula.baseline)
        return self._known[key]

    def release(self) -> None:
        """Release all textures."""
        cached, self._known = self._known, {}
        for formula in cached.values():
            if formula is not None:
                formula[0].release()

    def _texture(self, pixels: NDArray[np.uint8]) -> moderngl.Texture:
        height, width, _ = pixels.shape
        texture = self.ctx.texture((width, height), 4, np.ascontiguousarray(pixels).tobytes(), alignment=1)
        texture.filter = (self.ctx.LINEAR, self.ctx.LINEAR)
        texture.repeat_x = texture.repeat_y = False
        return texture


def set_formula(latex: str, size: int, colour: int, *, display: bool) -> TypesetFormula | None:
    """Return a formula's picture; None for one that MicroTeX cannot read.

    ``size`` of its font [pixels]; ``colour`` as imgui packs it.
    """
    if not can_set():
        return None
    style = microtex.TexStyle.display if display else microtex.TexStyle.text
    try:
        made = microtex.render(latex, float(size), colour, style)
    except Exception:  # nanobind's RuntimeError, for any exception of MicroTeX
        return None
    return _cut(TypesetFormula(made.pixels_as_array().copy(), made.baseline_y))


def _cut(setting: TypesetFormula) -> TypesetFormula:
    """Return a picture without the empty rows and columns around it."""
    seen = setting.pixels[..., 3] > 0
    rows, columns = np.flatnonzero(seen.any(axis=1)), np.flatnonzero(seen.any(axis=0))
    if not rows.size:
        return setting
    top, left = int(rows[0]), int(columns[0])
    return TypesetFormula(setting.pixels[top : rows[-1] + 1, left : columns[-1] + 1], setting.baseline - top)


@cache
def can_set() -> bool:
    """Return whether formulas can be set here; begins to, on the first call."""
    folder = Path(imgui_bundle.__file__).parent / "assets" / "fonts" / "latex"
    try:
        microtex.init(str(folder / "latinmodern-math.clm1"), str(folder / "latinmodern-math.otf"))
    except Exception:
        return False
    if _proves_good():
        return True
    with _as_american():
        return _proves_good()


def _proves_good() -> bool:
    try:
        microtex.render(_PROBE, 10.0)
    except Exception:
        return False
    return True


@contextmanager
def _as_american() -> Iterator[None]:
    """Provide a locale en_US.UTF-8 to the C library, which MicroTeX requires by that name.

    On Linux it is only there where somebody has made it. The plain one of Unicode has the same
    character classes; MicroTeX looks it up once.
    """
    locales = Path("/usr/lib/locale")
    plain = next((p for p in (locales / "C.utf8", locales / "C.UTF-8") if p.is_dir()), None)
    if not sys.platform.startswith("linux") or plain is None:
        yield
        return
    before = os.environ.get("LOCPATH")
    with tempfile.TemporaryDirectory() as folder:
        Path(folder, "en_US.UTF-8").symlink_to(plain)
        os.environ["LOCPATH"] = folder
        try:
            yield
        finally:
            if before is None:
                del os.environ["LOCPATH"]
            else:
                os.environ["LOCPATH"] = before
