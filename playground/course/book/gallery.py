"""The page of the thesis's figures: each with its caption, our picture, its parameters and its command."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from playground.course.book.html import line
from playground.course.book.page import Book, command_line
from playground.course.figures import FigurePicture, ThesisFigure
from playground.markup import Markup, joined, tag

Source = Callable[[FigurePicture], str]
"""Gives the address of a picture."""


def gallery_html(book: Book, figures: Sequence[ThesisFigure], source: Source) -> Markup:
    """Return all figures that show a result, chapter by chapter."""
    parts = []
    for chapter in dict.fromkeys(figure.chapter for figure in figures):
        title = f"chapter-{chapter}"
        shown = [figure for figure in figures if figure.chapter == chapter and figure.pictures]
        heading = tag("h2", f"{book.label('chapter')} {chapter}", id=title)
        items = tag("ul", *(_figure(book, figure, source) for figure in shown), class_="gallery")
        parts.append(tag("section", heading, items, aria_labelledby=title))
    left_out = [
        tag("li", f"{book.label('figure', n=figure.number)}{book.label('colon')}", _caption(book, figure))
        for figure in figures
        if not figure.pictures
    ]
    if left_out:
        parts.append(tag("section", tag("h2", book.label("diagrams")), tag("ul", *left_out)))
    return joined(*parts)


def _figure(book: Book, figure: ThesisFigure, source: Source) -> Markup:
    number = book.label("figure", n=figure.number)
    return tag(
        "li",
        tag("h3", f"{number}. ", _caption(book, figure)),
        *(_picture(book, number, picture, source) for picture in figure.pictures),
        id=f"figure-{figure.number.replace('.', '-')}",
    )


def _caption(book: Book, figure: ThesisFigure) -> Markup:
    return line(figure.captions[book.language], book.anchor)


def _picture(book: Book, number: str, picture: FigurePicture, source: Source) -> Markup:
    width, height = picture.scene.pixels
    image = tag(
        "img",
        src=source(picture),
        # The caption describes what the thesis shows; this identifies the picture.
        alt=f"{number}, {picture.sketch}: {picture.scene.sketch.title}",
        width=width,
        height=height,
        loading="lazy",
        decoding="async",
    )
    rows = (each for row in picture.parameters for each in (tag("dt", row[0]), tag("dd", row[1])))
    parameters = tag("details", tag("summary", book.label("parameters")), tag("dl", *rows))
    return tag("figure", image, parameters, command_line(picture.command))
