"""Typeset Markdown: runs of one style each, broken into lines, laid out part below part; set formulas.

Layout needs no font and no device: whoever paints gives the extents of runs, and paints the pieces; the
window's panel by imgui (``window.page``), slides by Pillow (``talk.slide``). Formulas are set by MicroTeX
with the Latin Modern font, both of which imgui_bundle brings; one that MicroTeX cannot read is written as
its source.
"""

from __future__ import annotations

import os
import re
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import imgui_bundle
import numpy as np
from imgui_bundle import imgui_microtex as microtex
from markdown_it.token import Token
from numpy.typing import NDArray

from playground.course.document import parser, plain
from playground.memo import INTERFACE


@dataclass(frozen=True)
class Run:
    """Something of one style in a line."""

    text: str
    bold: bool = False
    italic: bool = False
    code: bool = False
    formula: bool = False  # ``text`` is LaTeX
    link: str = ""
    breaks: bool = False  # a line ends here
    alone: bool = False  # it is on lines of its own: code, a formula


Runs = tuple[Run, ...]

INSTEAD = str.maketrans({"\u202f": "\u00a0", "⅓": "1/3", "⅔": "2/3"})
"""Replacements for characters that the text's font lacks."""


@dataclass(frozen=True)
class TextBlock:
    """A part of a text that is on lines of its own."""

    kind: str  # paragraph | heading | formula | code | table | rule
    runs: Runs = ()
    level: int = 0  # of a heading, from 1
    indent: int = 0  # lists and quotes that it is in
    mark: str = ""  # of a list's item: "•" or "2."
    rows: tuple[tuple[Runs, ...], ...] = ()  # of a table; the first is its head
    numbers: tuple[bool, ...] = ()  # of a table: which columns are aligned right
    close: bool = False  # it follows closely on the part before, as items of a list do


@INTERFACE.cached()
def parts_of(words: str) -> tuple[TextBlock, ...]:
    """Return the parts of a text."""
    return tuple(_parts(parser().parse(words)))


def written(text: str) -> str:
    """Return a text as the font can show it."""
    return text.translate(INSTEAD)


def label_text(words: str) -> str:
    """Return a text without its marks, on one line, as the font can show it."""
    return written(plain(words))


def _parts(tokens: list[Token]) -> Iterator[TextBlock]:
    lists: list[int | None] = []  # the next number of each list that is open; None: of one with dots
    quotes, mark, tight = 0, "", False
    at = 0
    while at < len(tokens):
        token = tokens[at]
        indent = len(lists) + quotes
        if token.type in ("bullet_list_open", "ordered_list_open"):
            start = int(token.attrs.get("start", 1))
            lists.append(None if token.type == "bullet_list_open" else start)
            tight = False
        elif token.type in ("bullet_list_close", "ordered_list_close"):
            lists.pop()
            tight = False
        elif token.type == "list_item_open":
            number = lists[-1]
            mark = "•" if number is None else f"{number}."
            lists[-1] = None if number is None else number + 1
        elif token.type in ("blockquote_open", "blockquote_close"):
            quotes += 1 if token.type == "blockquote_open" else -1
        elif token.type == "inline":
            opener = tokens[at - 1]
            heading = opener.type == "heading_open"
            level = int(opener.tag[1]) if heading else 0
            runs = runs_of(token)
            yield TextBlock("heading" if heading else "paragraph", runs, level, indent, mark, close=tight)
            tight, mark = bool(lists), ""
        elif token.type == "math_block":
            yield TextBlock("formula", (Run(token.content.strip(), formula=True, alone=True),), indent=indent)
        elif token.type in ("fence", "code_block"):
            yield TextBlock("code", (Run(token.content.rstrip("\n"), code=True, alone=True),), indent=indent)
        elif token.type == "hr":
            yield TextBlock("rule")
        elif token.type == "table_open":
            end = next(n for n in range(at, len(tokens)) if tokens[n].type == "table_close")
            yield _table(tokens[at:end], indent)
            at = end
        at += 1


def _table(tokens: list[Token], indent: int) -> TextBlock:
    rows: list[list[Runs]] = []
    numbers: list[bool] = []
    for at, token in enumerate(tokens):
        if token.type == "tr_open":
            rows.append([])
        elif token.type in ("th_open", "td_open"):
            runs = runs_of(tokens[at + 1])
            if token.type == "th_open":
                numbers.append("right" in str(token.attrs.get("style", "")))
                runs = tuple(replace(run, bold=True) for run in runs)
            rows[-1].append(runs)
    return TextBlock("table", indent=indent, rows=tuple(map(tuple, rows)), numbers=tuple(numbers))


def runs_of(inline: Token) -> Runs:
    """Return the runs of an inline token."""
    runs: list[Run] = []
    style = Run("")
    for token in inline.children or []:
        if token.type in ("strong_open", "strong_close"):
            style = replace(style, bold=token.nesting == 1)
        elif token.type in ("em_open", "em_close"):
            style = replace(style, italic=token.nesting == 1)
        elif token.type == "link_open":
            style = replace(style, link=str(token.attrs["href"]))
        elif token.type == "link_close":
            style = replace(style, link="")
        elif token.type == "code_inline":
            runs.append(replace(style, text=token.content, code=True))
        elif token.type.startswith("math_"):
            runs.append(replace(style, text=token.content, formula=True))
        elif token.type == "hardbreak":
            runs.append(Run("", breaks=True))
        elif token.type == "softbreak":
            runs.append(replace(style, text=" "))
        elif token.content:
            term = style.link.startswith("term:")  # a term of the field is in bold where it first appears
            runs.append(replace(style, text=token.content, bold=style.bold or term))
    return tuple(runs)


_WHOLE = 28
"""Letters of code in a text that are not parted."""
_WORDS = re.compile(r"[ \n]+|[^ \n]+")  # a no-break space does not part words


@dataclass(frozen=True)
class Extent:
    """How much room something takes, in the window's units."""

    width: float
    ascent: float  # above the baseline
    descent: float  # below it


@dataclass(frozen=True)
class Placed:
    """A run on a line."""

    run: Run
    x: float
    extent: Extent


@dataclass(frozen=True)
class Line:
    """A line of runs."""

    runs: tuple[Placed, ...]
    ascent: float
    descent: float

    @property
    def width(self) -> float:
        """The right end of the last run."""
        return max((p.x + p.extent.width for p in self.runs), default=0.0)


Ruler = Callable[[Run], Extent]


def broken(runs: Runs, width: float, ruler: Ruler) -> tuple[Line, ...]:
    """Break runs into lines of at most a width; what is wider by itself is broken inside."""
    line: list[Placed] = []
    lines: list[Line] = []
    x = 0.0

    def end() -> None:
        nonlocal line, x
        while line and line[-1].run.text == " ":
            line.pop()
        lines.append(_joined(line, ruler))
        line, x = [], 0.0

    for cluster in _clusters(runs):
        if cluster[0].breaks:
            end()
            continue
        extents = [ruler(run) for run in cluster]
        wide = sum(extent.width for extent in extents)
        blank = cluster[0].text == " " and not cluster[0].formula
        if blank and not line:
            continue
        if line and not blank and x + wide > width:
            end()
        for run, extent in zip(cluster, extents, strict=True):
            for piece, size in _fitting(run, extent, width, ruler) if wide > width else ((run, extent),):
                if line and wide > width and x + size.width > width:
                    end()
                line.append(Placed(piece, x, size))
                x += size.width
    if line:
        end()
    return tuple(lines)


def _clusters(runs: Runs) -> list[list[Run]]:
    """Return what may not be separated: words with all that touches them, and the blanks between."""
    clusters: list[list[Run]] = []
    glued = False
    for run in runs:
        if run.breaks:
            clusters.append([run])
            glued = False
            continue
        whole = run.formula or (run.code and not run.alone and len(run.text) <= _WHOLE)
        pieces = [run.text] if whole else _WORDS.findall(run.text)
        for piece in pieces:
            if not whole and not piece.strip(" \n"):
                clusters.append([replace(run, text=" ")])
                glued = False
            elif glued:
                clusters[-1].append(replace(run, text=piece))
            else:
                clusters.append([replace(run, text=piece)])
                glued = True
    return clusters


def _fitting(run: Run, extent: Extent, width: float, ruler: Ruler) -> list[tuple[Run, Extent]]:
    """Return a run in pieces that are no wider than a line."""
    if run.formula or extent.width <= width or len(run.text) < 2:
        return [(run, extent)]
    most = max(int(len(run.text) * width / extent.width), 1)
    pieces = [replace(run, text=run.text[at : at + most]) for at in range(0, len(run.text), most)]
    return [(piece, ruler(piece)) for piece in pieces]


def _joined(line: list[Placed], ruler: Ruler) -> Line:
    """Return a line, neighbours in one style as one run."""
    placed: list[Placed] = []
    for each in line:
        last = placed[-1] if placed else None
        if (
            last is not None
            and not each.run.formula
            and replace(last.run, text="") == replace(each.run, text="")
        ):
            width = last.extent.width + each.extent.width
            run = replace(last.run, text=last.run.text + each.run.text)
            placed[-1] = Placed(run, last.x, replace(last.extent, width=width))
        else:
            placed.append(each)
    plain = ruler(Run(""))
    ascent = max([plain.ascent, *(p.extent.ascent for p in placed)])
    descent = max([plain.descent, *(p.extent.descent for p in placed)])
    return Line(tuple(placed), ascent, descent)


@dataclass(frozen=True)
class Spacing:
    """Room in a layout, in the units of the one who paints it."""

    gap: float  # between parts
    close: float  # between parts that follow closely, as items of a list do
    leading: float  # between lines
    indent: float  # of a list or a quote
    mark: float | None  # between an item's mark and its text; None: the mark begins at the indentation
    cell: float  # between the columns of a table
    above_rule: float  # between a row of a table and the rule below it
    below_rule: float
    rule: float  # thickness of a rule
    code: float  # around a block of code, on a ground
    least: float = 0.0  # width that an indented part has at least
    headings: tuple[float, ...] = ()  # how much larger letters are, by level from 1
    centres: bool = False  # formulas on lines of their own are in the middle

    def scaled(self, factor: float) -> Spacing:
        """Return it in other units; letters of headings grow with the size that they are given."""
        lengths: dict[str, Any] = {k: v * factor for k, v in vars(self).items() if isinstance(v, float)}
        return replace(self, **lengths)


@dataclass(frozen=True)
class Piece:
    """A line in its place, or a rectangle."""

    x: float
    y: float  # of its top
    size: float  # of its letters
    line: Line | None = None
    box: tuple[float, float, str] | None = None  # width, height; what it is: rule | faint rule | ground


@dataclass(frozen=True)
class Layout:
    """A text that is laid out: how much room it takes, and what is to be painted, in order."""

    width: float
    height: float
    pieces: tuple[Piece, ...] = field(repr=False, default=())


FORMULA_SIZE = 1.12
"""Of a formula's letters: Latin Modern's are smaller than those of a text of the same size."""

Extents = Callable[[Run, float], Extent]
"""The extent of a run in letters of a size."""


def laid_out(words: str, size: float, width: float, spacing: Spacing, extents: Extents) -> Layout:
    """Lay out a text in letters of a size, in a width."""
    setter = _Typesetter(size, width, spacing, extents)
    for number, part in enumerate(parts_of(words)):
        if number:
            setter.y += spacing.close if part.close else spacing.gap
        setter.add(part)
    rights = (p.x + (p.line.width if p.line else p.box[0] if p.box else 0.0) for p in setter.pieces)
    return Layout(max(rights, default=0.0), setter.y, tuple(setter.pieces))


@dataclass
class _Typesetter:
    """Puts the parts of a text one below the other; ``y`` is where the last one ends."""

    size: float
    width: float
    spacing: Spacing
    extents: Extents
    y: float = 0.0
    pieces: list[Piece] = field(default_factory=list)

    def add(self, part: TextBlock) -> None:
        """Put a part below those before it."""
        left = part.indent * self.spacing.indent
        room = max(self.width - left, self.spacing.least)
        if part.kind == "rule":
            self._box(0, self.width, self.spacing.rule, "rule")
            self.y += self.spacing.rule
        elif part.kind == "table":
            self._table(part, left, room)
        elif part.kind == "code":
            self._code(part, left, room)
        else:
            self._paragraph(part, left, room)

    def _paragraph(self, part: TextBlock, left: float, room: float) -> None:
        runs, size, spacing = part.runs, self.size, self.spacing
        if part.kind == "heading":
            size += spacing.headings[part.level - 1] if part.level <= len(spacing.headings) else 0.0
            runs = tuple(replace(run, bold=True) for run in runs)
        lines = self._lines(runs, room, size)
        if part.mark and lines:
            mark = self._lines((Run(part.mark),), room, size)[0]
            left_edge = left - (spacing.indent if spacing.mark is None else mark.width + spacing.mark)
            self.pieces.append(Piece(left_edge, self.y + lines[0].ascent - mark.ascent, size, mark))
        for line in lines:
            centred = spacing.centres and part.kind == "formula"
            x = left + max(room - line.width, 0.0) / 2 if centred else left
            self.pieces.append(Piece(x, self.y, size, line))
            self.y += line.ascent + line.descent + spacing.leading
        self.y -= spacing.leading if lines else 0.0

    def _code(self, part: TextBlock, left: float, room: float) -> None:
        pad, at, top = self.spacing.code, len(self.pieces), self.y
        self.y += pad
        for text in part.runs[0].text.split("\n"):
            # Blanks at the start of a line of code are its indentation.
            run = Run(text.replace(" ", "\u00a0"), code=True, alone=True)
            lines = self._lines((run,), room - 2 * pad, self.size)
            for line in lines:
                self.pieces.append(Piece(left + pad, self.y, self.size, line))
                self.y += line.ascent + line.descent
            if not lines:
                self.y += self.extents(Run("", code=True), self.size).ascent
        self.y += pad
        self.pieces.insert(at, Piece(left, top, self.size, box=(room, self.y - top, "ground")))

    def _table(self, part: TextBlock, left: float, room: float) -> None:
        gap, count = self.spacing.cell, max(map(len, part.rows), default=0)
        target = [0.0] * count
        for row in part.rows:
            for column, cell in enumerate(row):
                lines = self._lines(cell, 1e6, self.size)
                target[column] = max([target[column], *(line.width for line in lines)])
        gaps = gap * max(count - 1, 0)
        widths = _shared(target, room - gaps)
        for number, row in enumerate(part.rows):
            x, bottom = left, self.y
            for column, cell in enumerate(row):
                down = self.y
                for line in self._lines(cell, widths[column] + 1, self.size):
                    shift = widths[column] - line.width if part.numbers[column] else 0.0
                    self.pieces.append(Piece(x + shift, down, self.size, line))
                    down += line.ascent + line.descent
                bottom = max(bottom, down)
                x += widths[column] + gap
            self.y = bottom + self.spacing.above_rule
            self._box(left, sum(widths) + gaps, self.spacing.rule, "rule" if number == 0 else "faint rule")
            self.y += self.spacing.below_rule

    def _lines(self, runs: Runs, room: float, size: float) -> tuple[Line, ...]:
        return broken(runs, room, lambda run: self.extents(run, size))

    def _box(self, x: float, wide: float, high: float, what: str) -> None:
        self.pieces.append(Piece(x, self.y, self.size, box=(wide, high, what)))


def _shared(values: list[float], room: float) -> list[float]:
    """Return the widths of columns: what they want where there is room, else narrow ones whole."""
    if sum(values) <= room:
        return values
    widths, left = list(values), room
    open_columns = sorted(range(len(values)), key=lambda column: values[column])
    for number, column in enumerate(open_columns):
        share = left / (len(open_columns) - number)
        widths[column] = min(values[column], share)
        left -= widths[column]
    return widths


_PROBE = "a+b"  # what MicroTeX looks at through a locale


@dataclass(frozen=True)
class TypesetFormula:
    """A formula's picture."""

    pixels: NDArray[np.uint8]  # (height, width, 4), top row first; straight alpha
    baseline: int  # rows from the top


@INTERFACE.cached(weight=32)
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
