"""What of a beat is written: the strip below the picture, the board over it, the sliders' values.

Drawn by Pillow, without a window, so that the window and a film show the same. All sizes are those of a
screen of 1920 × 1080 pixels, and scaled with it.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import imgui_bundle
from PIL import Image, ImageDraw, ImageFont
from pygments.lexers.graphics import GLShaderLexer
from pygments.token import Comment, Keyword, Name, Number, Operator

from playground.course.model import Markdown
from playground.course.talk.beats import Beat, Listing
from playground.course.talk.presenter import Row
from playground.course.typeset import (
    FORMULA_SIZE,
    Extent,
    Layout,
    Placed,
    Run,
    Spacing,
    label_text,
    laid_out,
    set_formula,
    written,
)
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
        laid = _laid(words, round(size, 2), room[0], ink)
        if (laid.height <= room[1] and laid.width <= room[0] + 1) or size <= least:
            return laid
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


_PLAIN: Rgb = (226, 230, 233)
_COLOURS: tuple[tuple[object, Rgb], ...] = (
    (Comment.Preproc, (220, 170, 220)),
    (Comment, (140, 160, 150)),
    (Keyword, (126, 186, 240)),
    (Number, (244, 196, 112)),
    (Operator, (190, 198, 204)),
    (Name.Builtin, (126, 220, 200)),
)


@INTERFACE.cached(weight=16)
def coloured(code: str) -> tuple[tuple[tuple[str, Rgb], ...], ...]:
    """Return the lines of a shader, each as its parts with their colours, 0..255."""
    lines: list[list[tuple[str, Rgb]]] = [[]]
    for kind, text in GLShaderLexer(stripnl=False, ensurenl=False).get_tokens(code):
        ink = next((rgb for group, rgb in _COLOURS if kind in group), _PLAIN)  # type: ignore[operator]
        for number, part in enumerate(text.split("\n")):
            if number:
                lines.append([])
            if part:
                lines[-1].append((part, ink))
    return tuple(tuple(line) for line in lines)


MIN_LETTER_HEIGHT = 28.0
"""The smallest letters, on a screen of 1080 lines [pixels]."""

_TALL, _WIDE = 1080.0, 1920.0
_STRIP = 252.0
_TEXT_SIZE, _TITLE, _CODE_SIZE = 50.0, 54.0, 40.0  # the largest letters
_FORMULA = 64.0
_SIDE, _ABOVE, _HEAD = 60.0, 16.0, 36.0
_GROUND: Rgb = (20, 22, 24)
_RAIL: Rgb = (92, 100, 106)
_BOARD_ALPHA = 244
_LINE_SPACING = 1.24  # of lines of code
_NUMBERS = 3.2  # columns that the numbers of lines take


@dataclass(frozen=True)
class Sizes:
    """Where things are on a screen, by its pixels."""

    width: int
    height: int

    @property
    def scale(self) -> float:
        """How much larger than on a screen of 1920 × 1080 pixels."""
        return max(min(self.width / _WIDE, self.height / _TALL), 0.2)

    @property
    def strip(self) -> int:
        """Height of the strip [pixels]."""
        return round(_STRIP * self.scale)

    @property
    def picture(self) -> tuple[int, int]:
        """Width and height of the picture above the strip [pixels]."""
        return self.width, max(self.height - self.strip, 1)


def strip_of(beat: Beat, position: tuple[int, int], sizes: Sizes) -> Image.Image:
    """Return the strip of a beat, (width, strip) pixels, opaque; ``position``: which of how many, from 1."""
    image = Image.new("RGBA", (sizes.width, sizes.strip), (*_GROUND, 255))
    draw, scale = ImageDraw.Draw(image), sizes.scale
    side = _SIDE * scale
    draw.rectangle((0, 0, sizes.width, max(3 * scale, 1)), (*FIELD, 255))
    done = position[0] / max(position[1], 1)
    draw.rectangle((0, 0, sizes.width * done, max(3 * scale, 1)), (*ACCENT, 255))
    bold, small = Face("bold", MIN_LETTER_HEIGHT * scale), Face("text", MIN_LETTER_HEIGHT * scale)
    baseline = (_ABOVE + 26) * scale
    counter = f"{position[0]} / {position[1]}"
    right = sizes.width - side - small.width(counter)
    paint_text(draw, counter, (right, baseline), small, DIM)
    x = side
    if beat.label:
        paint_text(draw, beat.label, (x, baseline), bold, WARM)
        x += bold.width(beat.label) + 22 * scale
    if beat.kind != "title":
        heading = _shortened(beat.heading, bold, right - x - 30 * scale)
        paint_text(draw, heading, (x, baseline), bold, ACCENT)
    body = body_of(beat, sizes)
    if body is not None:
        body.paint(image, side, (_ABOVE + _HEAD + 6) * scale)
    return image


def body_of(beat: Beat, sizes: Sizes) -> Laid | None:
    """Lay out what the strip says; None where it says nothing."""
    scale = sizes.scale
    words = f"# {beat.heading}\n\n{beat.shown}" if beat.kind == "title" else beat.shown
    if not words:
        return None
    return fitted(words, (_TEXT_SIZE * scale, MIN_LETTER_HEIGHT * scale), body_room(sizes))


def body_room(sizes: Sizes) -> tuple[float, float]:
    """Return the width and height that the strip has for text [pixels]."""
    scale = sizes.scale
    return sizes.width - 2 * _SIDE * scale, (_STRIP - _ABOVE - _HEAD - 6 - 14) * scale


def board_of(beat: Beat, sizes: Sizes) -> Image.Image | None:
    """Return what is over the picture, as large as the picture; None where nothing is."""
    if not beat.has_board and len(beat.names) < 2 and not beat.formula:
        return None
    width, height = sizes.picture
    if beat.has_board:
        image = Image.new("RGBA", (width, height), (*_GROUND, _BOARD_ALPHA))
        if beat.code is not None:
            _code(image, beat.code, sizes)
        else:
            board_text(beat, sizes).paint(image, *_centred(board_text(beat, sizes), sizes))
        return image
    image = Image.new("RGBA", (width, height), (0, 0, 0, 0))
    if len(beat.names) == 2:
        _plate(image, beat.names[0], sizes, 0.0)
        _plate(image, beat.names[1], sizes, 1.0)
    if beat.formula:
        _plate(image, beat.formula, sizes, 0.5, _FORMULA)
    return image


def board_text(beat: Beat, sizes: Sizes) -> Laid:
    """Lay out what the board says: a text, and choices, the right one marked where it is known."""
    words = beat.board
    for number, choice in enumerate(beat.choices):
        letter = chr(ord("A") + number)
        mark = f"**{letter}**  {choice}"
        if beat.right >= 0:
            mark = f"**{letter}  {choice}  ✓**" if number == beat.right else f"{letter}  {choice}"
        words += f"\n\n{mark}"
    scale = sizes.scale
    return fitted(words, (_TITLE * scale, MIN_LETTER_HEIGHT * scale), _board_room(sizes))


def code_size(code: Listing, sizes: Sizes) -> float:
    """Return a listing's letter height [pixels], as large as fits; maybe below ``MIN_LETTER_HEIGHT``."""
    scale = sizes.scale
    wide, high = _board_room(sizes)
    lines = code.text.split("\n")
    columns = max(map(len, lines)) + _NUMBERS + 1
    per_pixel = Face("code", 100.0).width("m") / 100.0
    across = wide / columns
    down = high / (len(lines) * _LINE_SPACING) * per_pixel
    letter = max(int(min(across, down, _CODE_SIZE * scale * per_pixel)), 3)  # Pillow moves on by whole pixels
    return letter / per_pixel


def gauges_of(rows: Sequence[Row], chosen: int, sizes: Sizes) -> Image.Image | None:
    """Return sliders as plates one below the other, one of them chosen; None where there are none."""
    if not rows:
        return None
    scale = sizes.scale
    face, bold = Face("text", MIN_LETTER_HEIGHT * scale), Face("bold", MIN_LETTER_HEIGHT * scale)
    line, pad, bar = 50 * scale, 16 * scale, 220 * scale
    texts = [f"{row.title}  {row.text}" for row in rows]
    wide = max(map(face.width, texts)) + bar + 4 * pad + bold.width("0")
    image = Image.new("RGBA", (round(wide), round(line * len(rows))), (*_GROUND, 216))
    draw = ImageDraw.Draw(image)
    for number, (row, text) in enumerate(zip(rows, texts, strict=True)):
        middle = (number + 0.5) * line
        ink = WARM if number == chosen else INK
        baseline = middle + face.size * 0.34
        paint_text(draw, str(number + 1), (pad, baseline), bold, WARM if number == chosen else ACCENT)
        left = 2 * pad + bold.width("0")
        rail = (left, middle - 3 * scale, left + bar, middle + 3 * scale)
        draw.rounded_rectangle(rail, 3 * scale, _RAIL)
        end = left + bar * min(max(row.share, 0.0), 1.0)
        draw.rounded_rectangle((left, middle - 3 * scale, end, middle + 3 * scale), 3 * scale, ink)
        draw.ellipse((end - 9 * scale, middle - 9 * scale, end + 9 * scale, middle + 9 * scale), ink)
        paint_text(draw, text, (left + bar + pad, baseline), face, ink)
    return image


def plate_of(text: str, sizes: Sizes) -> Image.Image | None:
    """Return a sentence on a plate; None for none."""
    if not text:
        return None
    scale = sizes.scale
    face, pad = Face("text", MIN_LETTER_HEIGHT * scale), 14 * scale
    image = Image.new("RGBA", (round(face.width(text) + 2 * pad), round(52 * scale)), (*_GROUND, 232))
    paint_text(ImageDraw.Draw(image), text, (pad, 36 * scale), face, WARM)
    return image


@INTERFACE.cached(weight=64)
def help_of(rows: tuple[tuple[str, str], ...], sizes: Sizes) -> Image.Image:
    """Return the keys of a presentation and their meanings, as large as the picture."""
    image = Image.new("RGBA", sizes.picture, (*_GROUND, 250))
    draw, scale = ImageDraw.Draw(image), sizes.scale
    wide, high = sizes.picture
    line = min(high / (len(rows) + 1.5), 54 * scale)
    face, bold = (
        Face("text", min(MIN_LETTER_HEIGHT * scale, line * 0.72)),
        Face("bold", min(MIN_LETTER_HEIGHT * scale, line * 0.72)),
    )
    column = max(bold.width(keys) for keys, _ in rows) + 40 * scale
    whole = column + max(face.width(meaning) for _, meaning in rows)
    left, top = max((wide - whole) / 2, 20 * scale), (high - line * len(rows)) / 2
    for number, (keys, meaning) in enumerate(rows):
        baseline = top + (number + 0.75) * line
        paint_text(draw, keys, (left, baseline), bold, WARM)
        paint_text(draw, meaning, (left + column, baseline), face, INK)
    return image


def _code(image: Image.Image, code: Listing, sizes: Sizes) -> None:
    size = code_size(code, sizes)
    face, draw = Face("code", size), ImageDraw.Draw(image)
    letter = face.width("m")
    lines = coloured(code.text)
    wide, high = sizes.picture
    columns = max(map(len, code.text.split("\n"))) + (_NUMBERS + 1 if code.line else 0)
    left = max((wide - columns * letter) / 2, _SIDE * sizes.scale)
    top = (high - len(lines) * size * _LINE_SPACING) / 2
    for number, line in enumerate(lines):
        baseline = top + (number + 0.78) * size * _LINE_SPACING
        x = left
        if code.line:
            mark = str(code.line + number)
            paint_text(draw, mark, (x + (_NUMBERS - len(mark)) * letter, baseline), face, DIM)
            x += (_NUMBERS + 1) * letter
        for text, ink in line:
            paint_text(draw, text, (x, baseline), face, ink)
            x += len(text) * letter


def _plate(image: Image.Image, text: str, sizes: Sizes, side: float, largest: float = 36.0) -> None:
    """Write a name or a formula at the picture's lower edge: left at 0, in the middle at ½, right at 1."""
    scale, (wide, high) = sizes.scale, sizes.picture
    room = wide * (0.9 if side == 0.5 else 0.45)
    laid = fitted(text, (largest * scale, MIN_LETTER_HEIGHT * scale), (room, high * 0.6))
    pad = (14 if side != 0.5 else 30) * scale
    box_wide, box_high = laid.width + 2 * pad, laid.height + pad
    left = 24 * scale + side * (wide - 48 * scale - box_wide)
    top = high - 24 * scale - box_high
    draw = ImageDraw.Draw(image)
    draw.rounded_rectangle((left, top, left + box_wide, top + box_high), 8 * scale, (*_GROUND, 226))
    laid.paint(image, left + pad, top + pad / 2)


def _board_room(sizes: Sizes) -> tuple[float, float]:
    wide, high = sizes.picture
    return wide - 2 * _SIDE * sizes.scale, high - 50 * sizes.scale


def _centred(laid: Laid, sizes: Sizes) -> tuple[float, float]:
    wide, high = sizes.picture
    left = max((wide - laid.width) / 2, _SIDE * sizes.scale)
    return left, max((high - laid.height) / 2, 0.0)


def _shortened(text: str, face: Face, room: float) -> str:
    """Return a text in a room [pixels], its end left out where it is too long."""
    text = label_text(text)
    if face.width(text) <= room:
        return text
    while text and face.width(text + "…") > room:
        text = text[:-1].rstrip()
    return text + "…" if text else ""
