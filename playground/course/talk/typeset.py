"""Markdown with formulas, set by Pillow: laid out once, measured, and painted on an image; its fonts."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from itertools import groupby
from pathlib import Path

import imgui_bundle
from PIL import Image, ImageDraw, ImageFont

from playground.course.model import Markdown
from playground.course.window.formulas import set_formula
from playground.course.window.line_breaking import Extent, Line, Placed, broken
from playground.course.window.markdown_runs import Run, Runs, TextBlock, parts_of, written
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

_FORMULA = 1.12  # Latin Modern's letters are smaller than those of a text of one size
_LEADING, _GAP = 0.16, 0.42  # between lines and between parts, in sizes
_INDENT, _CELL = 1.1, 1.2


@dataclass(frozen=True)
class _Piece:
    x: float
    y: float  # of the line's top
    line: Line | None = None
    face_size: float = 0.0
    ink: Rgb = INK
    box: tuple[float, float, Rgb] | None = None  # width, height


@dataclass(frozen=True)
class Laid:
    """A text that is laid out: how much room it takes, and what paints it."""

    width: float
    height: float
    size: float  # of its letters [pixels]
    pieces: tuple[_Piece, ...] = field(repr=False, default=())

    def paint(self, image: Image.Image, x: float, y: float) -> None:
        """Paint it on an RGBA image, its upper left corner at a pixel."""
        draw = ImageDraw.Draw(image)
        for piece in self.pieces:
            left, top = x + piece.x, y + piece.y
            if piece.box is not None:
                wide, high, rgb = piece.box
                draw.rounded_rectangle((left, top, left + wide, top + high), high / 6, (*rgb, 255))
            elif piece.line is not None:
                for placed_run in piece.line.runs:
                    _paint_run(image, draw, placed_run, left, top + piece.line.ascent, piece)


@INTERFACE.cached(weight=16)
def laid_out(words: Markdown, size: float, width: float, ink: Rgb = INK) -> Laid:
    """Lay out a text of a size [pixels] in a width [pixels]."""
    setter = _Setter(size, width, ink)
    for number, part in enumerate(parts_of(words)):
        if number:
            setter.y += size * (_LEADING if part.close else _GAP)
        setter.add(part)
    right = max((p.x + (p.line.width if p.line else 0.0) for p in setter.pieces), default=0.0)
    return Laid(right, setter.y, size, tuple(setter.pieces))


def fitted(words: Markdown, sizes: tuple[float, float], room: tuple[float, float], ink: Rgb = INK) -> Laid:
    """Lay out a text in a room (width, height) [pixels], as large as it fits, between two sizes.

    The smallest size where even that is too large: whoever asks sees it by the height.
    """
    largest, least = sizes
    step = max((largest - least) / 8, 0.25)
    size = largest
    while True:
        texts = laid_out(words, round(size, 2), room[0], ink)
        if (texts.height <= room[1] and texts.width <= room[0] + 1) or size <= least:
            return texts
        size = max(size - step, least)


class _Setter:
    def __init__(self, size: float, width: float, ink: Rgb) -> None:
        self.size, self.width, self.ink = size, width, ink
        self.y = 0.0
        self.pieces: list[_Piece] = []

    def add(self, part: TextBlock) -> None:
        """Add a part below those before."""
        indent = part.indent * _INDENT * self.size
        if part.kind == "rule":
            return
        if part.kind == "table":
            self._table(part)
            return
        if part.kind == "code":
            runs_of_lines = [Run(text.replace(" ", "\u00a0"), code=True, alone=True)
                             for text in part.runs[0].text.split("\n")]  # fmt: skip
            for run in runs_of_lines:
                self._lines((run,), indent)
            return
        runs = tuple(replace(run, bold=True) for run in part.runs) if part.kind == "heading" else part.runs
        if part.mark:
            mark = broken((Run(part.mark),), 1e6, self.extent)[0]
            self.pieces.append(_Piece(indent - _INDENT * self.size, self.y, mark, self.size, self.ink))
        self._lines(runs, indent)

    def _lines(self, runs: Runs, left: float) -> None:
        for number, line in enumerate(broken(runs, self.width - left, self.extent)):
            self.y += self.size * _LEADING if number else 0.0
            self.pieces.append(_Piece(left, self.y, line, self.size, self.ink))
            self.y += line.ascent + line.descent

    def _table(self, part: TextBlock) -> None:
        gap, count = _CELL * self.size, max(map(len, part.rows), default=0)
        target = [0.0] * count
        for row in part.rows:
            for column, cell in enumerate(row):
                widths = [line.width for line in broken(cell, 1e6, self.extent)]
                target[column] = max([target[column], *widths])
        room = self.width - gap * max(count - 1, 0)
        shrink = min(room / max(sum(target), 1.0), 1.0)
        widths = [wide * shrink for wide in target]
        for number, row in enumerate(part.rows):
            x, bottom = 0.0, self.y
            for column, cell in enumerate(row):
                down = self.y
                for line in broken(cell, widths[column] + 1, self.extent):
                    shift = widths[column] - line.width if part.numbers[column] else 0.0
                    self.pieces.append(_Piece(x + shift, down, line, self.size, self.ink))
                    down += line.ascent + line.descent
                bottom = max(bottom, down)
                x += widths[column] + gap
            self.y = bottom + self.size * 0.15
            wide = sum(widths) + gap * max(count - 1, 0)
            rgb = DIM if number == 0 else FIELD
            self.pieces.append(_Piece(0.0, self.y, box=(wide, max(self.size / 16, 1.0), rgb)))
            self.y += self.size * 0.25

    def extent(self, run: Run) -> Extent:
        """Return how much room a run takes."""
        if run.formula:
            formula = _formula(run, self.size, self.ink)
            if formula is not None:
                picture, baseline = formula
                return Extent(picture.width, baseline, picture.height - baseline)
        face = Face(_style(run), self.size)
        pad = 2 * _pad(self.size) if run.code and not run.alone and run.text.strip() else 0.0
        return Extent(face.width(written(run.text)) + pad, face.ascent, face.descent)


def _paint_run(
    image: Image.Image,
    draw: ImageDraw.ImageDraw,
    placed_run: Placed,
    x: float,
    baseline: float,
    piece: _Piece,
) -> None:
    run, extent, size = placed_run.run, placed_run.extent, piece.face_size
    left = x + placed_run.x
    if run.formula:
        formula = _formula(run, size, piece.ink)
        if formula is not None:
            image.alpha_composite(formula[0], (max(round(left), 0), max(round(baseline - formula[1]), 0)))
            return
    text = written(run.text)
    if run.code and not run.alone and text.strip():
        corners = (left, baseline - extent.ascent * 0.92, left + extent.width, baseline + extent.descent)
        draw.rounded_rectangle(corners, size / 8, (*FIELD, 255))
        left += _pad(size)
    paint_text(draw, text, (left, baseline), Face(_style(run), size), piece.ink)


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
    return _formula_of(run.text, round(size * _FORMULA), ink, run.alone)


def _style(run: Run) -> str:
    if run.code or run.formula:
        return "code"
    return "bold" if run.bold or run.link.startswith("term:") else "italic" if run.italic else "text"


def _pad(size: float) -> float:
    return size * 0.18
