"""What of a beat is written: the strip below the picture, the board over it, the sliders' values.

Drawn by Pillow, without a window, so that the window and a film show the same. All sizes are those of a
screen of 1920 × 1080 pixels, and scaled with it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from PIL import Image, ImageDraw
from pygments.lexers.graphics import GLShaderLexer
from pygments.token import Comment, Keyword, Name, Number, Operator

from playground.course.talk.beat import Beat, Listing
from playground.course.talk.slide_text import (
    ACCENT,
    DIM,
    FIELD,
    INK,
    WARM,
    Face,
    Laid,
    Rgb,
    fitted,
    paint_text,
)
from playground.course.typeset import plain
from playground.memo import INTERFACE

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
_TEXT, _TITLE, _CODE = 50.0, 54.0, 40.0  # the largest letters
_FORMULA = 64.0
_SIDE, _ABOVE, _HEAD = 60.0, 16.0, 36.0
_GROUND: Rgb = (20, 22, 24)
_RAIL: Rgb = (92, 100, 106)
_BOARD_ALPHA = 244
_SPACING = 1.24  # of lines of code
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


@dataclass(frozen=True)
class Gauge:
    """A slider as it is shown: its number key, its name, its value and where in its range that is."""

    number: int
    name: str
    value: str
    share: float
    chosen: bool = False


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
    return fitted(words, (_TEXT * scale, MIN_LETTER_HEIGHT * scale), body_room(sizes))


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
    down = high / (len(lines) * _SPACING) * per_pixel
    letter = max(int(min(across, down, _CODE * scale * per_pixel)), 3)  # Pillow moves on by whole pixels
    return letter / per_pixel


def gauges_of(gauges: Sequence[Gauge], sizes: Sizes) -> Image.Image | None:
    """Return the sliders of a picture as plates one below the other; None where there are none."""
    if not gauges:
        return None
    scale = sizes.scale
    face, bold = Face("text", MIN_LETTER_HEIGHT * scale), Face("bold", MIN_LETTER_HEIGHT * scale)
    line, pad, bar = 50 * scale, 16 * scale, 220 * scale
    texts = [f"{gauge.name}  {gauge.value}" for gauge in gauges]
    wide = max(map(face.width, texts)) + bar + 4 * pad + bold.width("0")
    image = Image.new("RGBA", (round(wide), round(line * len(gauges))), (*_GROUND, 216))
    draw = ImageDraw.Draw(image)
    for row, (gauge, text) in enumerate(zip(gauges, texts, strict=True)):
        middle = (row + 0.5) * line
        ink = WARM if gauge.chosen else INK
        baseline = middle + face.size * 0.34
        paint_text(draw, str(gauge.number), (pad, baseline), bold, WARM if gauge.chosen else ACCENT)
        left = 2 * pad + bold.width("0")
        rail = (left, middle - 3 * scale, left + bar, middle + 3 * scale)
        draw.rounded_rectangle(rail, 3 * scale, _RAIL)
        end = left + bar * min(max(gauge.share, 0.0), 1.0)
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
    top = (high - len(lines) * size * _SPACING) / 2
    for number, line in enumerate(lines):
        baseline = top + (number + 0.78) * size * _SPACING
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
    text = plain(text)
    if face.width(text) <= room:
        return text
    while text and face.width(text + "…") > room:
        text = text[:-1].rstrip()
    return text + "…" if text else ""
