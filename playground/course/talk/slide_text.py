"""Markdown on a slide: laid out once, measured, and painted on an image by Pillow; its fonts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import imgui_bundle
from PIL import Image, ImageDraw, ImageFont

from playground.course.model import Markdown
from playground.course.typeset import FORMULA_SIZE, Extent, Layout, Placed, Run, Spacing, laid_out, written
from playground.course.window.formulas import set_formula
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


Rgb = tuple[int, int, int]
"""A display-encoded colour, 0..255."""

INK, DIM, ACCENT, WARM = (232, 236, 239), (158, 168, 174), (142, 205, 142), (244, 196, 112)
FIELD = (44, 48, 52)

_SPACING = Spacing(
    gap=0.42,
    close=0.16,
    leading=0.16,
    indent=1.1,
    mark=None,
    cell=1.2,
    above_rule=0.15,
    below_rule=0.25,
    rule=1 / 16,
    code=0.0,
)
"""In sizes of letters."""


@dataclass(frozen=True)
class Laid:
    """A text that is laid out: how much room it takes, and what paints it."""

    layout: Layout
    size: float  # of its letters [pixels]
    ink: Rgb

    @property
    def width(self) -> float:
        """Its width [pixels]."""
        return self.layout.width

    @property
    def height(self) -> float:
        """Its height [pixels]."""
        return self.layout.height

    def paint(self, image: Image.Image, x: float, y: float) -> None:
        """Paint it on an RGBA image, its upper left corner at a pixel."""
        draw = ImageDraw.Draw(image)
        for piece in self.layout.pieces:
            left, top = x + piece.x, y + piece.y
            if piece.box is not None:
                wide, high, what = piece.box
                high, rgb = max(high, 1.0), DIM if what == "rule" else FIELD
                draw.rounded_rectangle((left, top, left + wide, top + high), high / 6, (*rgb, 255))
            elif piece.line is not None:
                for placed_run in piece.line.runs:
                    _paint_run(image, draw, placed_run, left, top + piece.line.ascent, piece.size, self.ink)


@INTERFACE.cached(weight=16)
def _laid(words: Markdown, size: float, width: float, ink: Rgb) -> Laid:
    """Lay out a text of a size [pixels] in a width [pixels]."""
    layout = laid_out(words, size, width, _SPACING.scaled(size), lambda run, size: _extent(run, size, ink))
    return Laid(layout, size, ink)


def fitted(words: Markdown, sizes: tuple[float, float], room: tuple[float, float], ink: Rgb = INK) -> Laid:
    """Lay out a text in a room (width, height) [pixels], as large as it fits, between two sizes.

    The smallest size where even that is too large: whoever asks sees it by the height.
    """
    largest, least = sizes
    step = max((largest - least) / 8, 0.25)
    size = largest
    while True:
        texts = _laid(words, round(size, 2), room[0], ink)
        if (texts.height <= room[1] and texts.width <= room[0] + 1) or size <= least:
            return texts
        size = max(size - step, least)


def _extent(run: Run, size: float, ink: Rgb) -> Extent:
    """Return how much room a run takes [pixels]."""
    if run.formula:
        formula = _formula(run, size, ink)
        if formula is not None:
            picture, baseline = formula
            return Extent(picture.width, baseline, picture.height - baseline)
    face = Face(_style(run), size)
    pad = 2 * _pad(size) if run.code and not run.alone and run.text.strip() else 0.0
    return Extent(face.width(written(run.text)) + pad, face.ascent, face.descent)


def _paint_run(
    image: Image.Image,
    draw: ImageDraw.ImageDraw,
    placed_run: Placed,
    x: float,
    baseline: float,
    size: float,
    ink: Rgb,
) -> None:
    run, extent = placed_run.run, placed_run.extent
    left = x + placed_run.x
    if run.formula:
        formula = _formula(run, size, ink)
        if formula is not None:
            image.alpha_composite(formula[0], (max(round(left), 0), max(round(baseline - formula[1]), 0)))
            return
    text = written(run.text)
    if run.code and not run.alone and text.strip():
        corners = (left, baseline - extent.ascent * 0.92, left + extent.width, baseline + extent.descent)
        draw.rounded_rectangle(corners, size / 8, (*FIELD, 255))
        left += _pad(size)
    paint_text(draw, text, (left, baseline), Face(_style(run), size), ink)


def paint_text(
    draw: ImageDraw.ImageDraw, text: str, position: tuple[float, float], face: Face, ink: Rgb
) -> None:
    """Write one line of text from a place on its baseline [pixels]."""
    x, baseline = position
    for font, part in face.pieces(text):
        draw.text((x, baseline), part, (*ink, 255), font, anchor="ls")
        x += font.getlength(part)


@INTERFACE.cached()
def _formula_of(latex: str, size: int, ink: Rgb, display: bool) -> tuple[Image.Image, float] | None:
    red, green, blue = ink
    typeset_formula = set_formula(latex, size, 255 << 24 | blue << 16 | green << 8 | red, display=display)
    return (
        None
        if typeset_formula is None
        else (Image.fromarray(typeset_formula.pixels, "RGBA"), float(typeset_formula.baseline))
    )


def _formula(run: Run, size: float, ink: Rgb) -> tuple[Image.Image, float] | None:
    return _formula_of(run.text, round(size * FORMULA_SIZE), ink, run.alone)


def _style(run: Run) -> str:
    if run.code or run.formula:
        return "code"
    return "bold" if run.bold or run.link.startswith("term:") else "italic" if run.italic else "text"


def _pad(size: float) -> float:
    return size * 0.18
