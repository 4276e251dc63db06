"""The fonts that slides are written with, by Pillow: those of the window, which imgui_bundle brings."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import imgui_bundle
from PIL import ImageFont

from playground.memo import INTERFACE

_FONTS = Path(imgui_bundle.__file__).parent / "assets" / "fonts"
_SYMBOLS = _FONTS / "latex" / "latinmodern-math.otf"
_CODE = _FONTS / "Inconsolata-Medium.ttf"
_TEXT = _FONTS / "Roboto" / "Roboto-Regular.ttf"
_FILES = {
    "text": (_TEXT, _SYMBOLS, _CODE),
    "bold": (_FONTS / "Roboto" / "Roboto-Bold.ttf", _SYMBOLS, _CODE),
    "italic": (_FONTS / "Roboto" / "Roboto-RegularItalic.ttf", _SYMBOLS, _CODE),
    "code": (_CODE, _TEXT, _SYMBOLS),
}
_NOTHING = chr(0x10FFFD)  # no font has it: what stands for a glyph that is missing


@dataclass(frozen=True)
class Face:
    """One style at one size; a letter that its font lacks is taken from the next."""

    style: str  # text | bold | italic | code
    size: float  # [pixels]

    @property
    def ascent(self) -> float:
        """Height of a line above the baseline [pixels]."""
        return float(_font(self.style, 0, self.size).getmetrics()[0])

    @property
    def descent(self) -> float:
        """Depth of a line below the baseline [pixels]."""
        return float(_font(self.style, 0, self.size).getmetrics()[1])

    def width(self, text: str) -> float:
        """Return how wide a text is [pixels]."""
        return sum(font.getlength(piece) for font, piece in self.pieces(text))

    def pieces(self, text: str) -> Iterator[tuple[ImageFont.FreeTypeFont, str]]:
        """Yield the parts of a text, each with the font that has its letters."""
        for number, letters in groupby(text, lambda letter: _font_number(self.style, letter)):
            yield _font(self.style, number, self.size), "".join(letters)


@INTERFACE.cached()
def _font(style: str, number: int, size: float) -> ImageFont.FreeTypeFont:
    return ImageFont.truetype(str(_FILES[style][number]), size, layout_engine=ImageFont.Layout.BASIC)


@INTERFACE.cached()
def _font_number(style: str, letter: str) -> int:
    """Return which of a style's fonts has a letter; the first where none has it."""
    if letter.isspace():
        return 0
    for number in range(len(_FILES[style])):
        font = _font(style, number, 24.0)
        if bytes(font.getmask(letter)) != bytes(font.getmask(_NOTHING)):
            return number
    return 0
