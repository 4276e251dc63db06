"""The page of the thesis's figures: each with its caption, our picture, its parameters and its command."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from playground.lessons.book.html import line
from playground.lessons.book.page import Book, command_line
from playground.lessons.figures import Drawn, ThesisFigure
from playground.markup import Markup, joined, tag


def gallery_html(book: Book, figures: Sequence[ThesisFigure], source: Callable[[Drawn], str]) -> Markup:
    """Return all figures that show a result, chapter by chapter; ``source`` gives a picture's address."""
    parts = []
    for chapter in dict.fromkeys(figure.chapter for figure in figures):
        title = f"chapter-{chapter}"
        items = [
            _figure(book, figure, source)
            for figure in figures
            if figure.chapter == chapter and figure.pictures
        ]
        parts.append(
            tag(
                "section",
                tag("h2", f"{book.word('chapter')} {chapter}", id=title),
                tag("ul", *items, class_="gallery"),
                aria_labelledby=title,
            )
        )
    left_out = [
        tag(
            "li",
            f"{book.word('figure', n=figure.number)}{book.word('colon')}",
            line(figure.captions[book.language], book.address),
        )
        for figure in figures
        if not figure.pictures
    ]
    if left_out:
        parts.append(tag("section", tag("h2", book.word("diagrams")), tag("ul", *left_out)))
    return joined(*parts)


def _figure(book: Book, figure: ThesisFigure, source: Callable[[Drawn], str]) -> Markup:
    number = book.word("figure", n=figure.number)
    caption = line(figure.captions[book.language], book.address)
    images = [
        tag(
            "figure",
            tag(
                "img",
                src=source(drawn),
                # The caption, beside it, says what the thesis shows; this says which picture it is.
                alt=f"{number}, {drawn.sketch}: {drawn.scene.sketch.title}",
                width=drawn.scene.pixels[0],
                height=drawn.scene.pixels[1],
                loading="lazy",
                decoding="async",
            ),
            tag(
                "details",
                tag("summary", book.word("parameters")),
                tag(
                    "dl",
                    *(each for row in drawn.parameters for each in (tag("dt", row[0]), tag("dd", row[1]))),
                ),
            ),
            command_line(drawn.command),
        )
        for drawn in figure.pictures
    ]
    return tag(
        "li",
        tag("h3", f"{number}. ", caption),
        *images,
        id=f"figure-{figure.number.replace('.', '-')}",
    )
