"""The pages of the book: each lesson's, and the contents."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from playground._version import __version__
from playground.lessons.book.blocks import Setting, block_html, open_command
from playground.lessons.book.html import Address, line, plain
from playground.lessons.library import LANGUAGES, THESIS
from playground.lessons.model import Lesson
from playground.markup import Markup, joined, tag

FIGURES = "figures"
"""The name of the gallery's page."""


@dataclass(frozen=True)
class Book:
    """What every page of the book in one language knows."""

    language: str
    words: Mapping[str, str]
    lessons: tuple[Lesson, ...]  # in their order
    languages: tuple[str, ...]  # that are built
    renderer: str  # that drew the pictures
    gallery: bool = True  # whether the thesis's figures are among the pages

    def word(self, key: str, **values: object) -> str:
        """Return a word of the interface."""
        return self.words[key].format(**values)

    def address(self, link: str) -> str:
        """Return where a link of a lesson leads to in the book."""
        kind, _, what = link.partition(":")
        if kind == "lesson":
            return f"{what}.html"
        if kind == "thesis":  # its text is not ours to give; the figures of that chapter are here
            return f"{FIGURES}.html#chapter-{what.partition('.')[0]}" if self.gallery else "#thesis-title"
        if kind == "sketch":
            return "#play"
        return link


def lesson_page(book: Book, lesson: Lesson, setting: Setting) -> str:
    """Return the page of a lesson."""
    address = setting.address
    body: list[Markup] = []
    first = True
    for number, section in enumerate(lesson.sections):
        inside = []
        for block in section.blocks:
            inside.append(block_html(block, setting, first=first))
            first = first and "<img" not in inside[-1]
        if not section.title:
            body.append(joined(*inside))
            continue
        title = f"s{number}-{slug(plain(section.title))}"
        heading = tag("h2", setting.line(section.title), id=title)
        body.append(tag("section", heading, *inside, aria_labelledby=title))
    head = tag(
        "header",
        tag(
            "p",
            f"{book.word('lesson')} {lesson.number} · {book.word('minutes', n=lesson.minutes)}",
            class_="kicker",
        ),
        tag("h1", lesson.title),
        tag("p", tag("b", book.word("goal")), book.word("colon"), setting.line(lesson.goal), class_="goal"),
        tag("p", book.word("stale"), class_="stale") if lesson.stale else None,
    )
    return _page(
        book,
        lesson.title,
        lesson.name,
        joined(
            head, *body, _play(book, lesson, setting), _references(book, lesson, address), _turn(book, lesson)
        ),
    )


def contents_page(book: Book, covers: Mapping[str, Markup]) -> str:
    """Return the page with the list of lessons; ``covers`` are their first pictures."""
    rows = [
        tag(
            "li",
            tag(
                "a",
                covers[lesson.name],
                tag("span", f"{lesson.number}. {lesson.title}", class_="name"),
                href=f"{lesson.name}.html",
            ),
            tag("p", line(lesson.goal, book.address)),
        )
        for lesson in book.lessons
    ]
    body = joined(
        tag("header", tag("h1", book.word("book")), tag("p", book.word("book_goal"), class_="goal")),
        tag("ol", *rows, class_="cards"),
        tag(
            "p",
            tag("a", book.word("figures"), href=f"{FIGURES}.html"),
            Markup(" — "),
            book.word("figures_goal"),
        )
        if book.gallery
        else None,
        tag("p", book.word("source", thesis=THESIS)),
    )
    return _page(book, book.word("book"), "index", body)


def gallery_page(book: Book, body: Markup) -> str:
    """Return the page of the thesis's figures."""
    head = tag(
        "header",
        tag("h1", book.word("figures")),
        tag("p", book.word("figures_goal"), class_="goal"),
        tag("p", book.word("source", thesis=THESIS)),
    )
    return _page(book, book.word("figures"), FIGURES, joined(head, body), wide=True)


def door_page(languages: Sequence[str], titles: Mapping[str, str]) -> str:
    """Return the page above the languages, from which one chooses."""
    links = [
        tag(
            "li",
            tag(
                "a", f"{LANGUAGES[code]}: {titles[code]}", href=f"{code}/index.html", lang=code, hreflang=code
            ),
        )
        for code in languages
    ]
    head = joined(
        Markup('<meta charset="utf-8">'),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("title", titles[languages[0]]),
        tag("meta", name="color-scheme", content="light dark"),
        tag("link", rel="stylesheet", href="book.css"),
        tag("script", src="book.js", defer=True),
    )
    body = tag("main", tag("h1", titles[languages[0]]), tag("ul", *links))
    return f"<!doctype html>\n{tag('html', tag('head', head), tag('body', body), lang=languages[0])}\n"


def slug(text: str) -> str:
    """Return a text as it may stand in an address: small letters, digits and -."""
    letters = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", letters).strip("-")


def _page(book: Book, title: str, name: str, body: Markup, *, wide: bool = False) -> str:
    others = [
        tag("a", LANGUAGES[code], href=f"../{code}/{name}.html", lang=code, hreflang=code)
        for code in book.languages
        if code != book.language
    ]
    names = ("backward", "forward", "run", "stop", "side", "over", "copy", "copied", "theme")
    head = joined(
        Markup('<meta charset="utf-8">'),
        tag("meta", name="viewport", content="width=device-width, initial-scale=1"),
        tag("meta", name="color-scheme", content="light dark"),
        tag("title", f"{title} — {book.word('book')}" if name != "index" else title),
        tag("link", rel="stylesheet", href="../book.css"),
        tag("script", src="../book.js", defer=True),
    )
    top = tag(
        "nav",
        tag("a", book.word("contents"), href="index.html"),
        tag("a", book.word("figures"), href=f"{FIGURES}.html") if book.gallery else None,
        *others,
        tag("button", book.word("theme"), type="button", id="theme", hidden=True),
        class_="top",
        aria_label=book.word("contents"),
    )
    made = book.word("made_by", version=__version__, renderer=book.renderer)
    page = tag(
        "body",
        tag("a", book.word("skip"), href="#main", class_="skip"),
        top,
        tag("main", body, id="main", class_="wide" if wide else None),
        tag("footer", tag("p", made)),
        **{f"data_{key}": book.words[key] for key in names},
    )
    return f"<!doctype html>\n{tag('html', tag('head', head), page, lang=book.language)}\n"


def _play(book: Book, lesson: Lesson, setting: Setting) -> Markup:
    return tag(
        "section",
        tag("h2", book.word("play"), id="play-title"),
        tag("p", book.word("play_goal")),
        command_line(f"playground live {lesson.sketch}"),
        tag("p", f"{book.word('try_it')}{book.word('colon')}"),
        command_line(open_command(lesson)),
        id="play",
        aria_labelledby="play-title",
    )


def command_line(command: str) -> Markup:
    """Return a command, to be copied."""
    return tag("pre", tag("code", command), class_="command", tabindex=0)


def _references(book: Book, lesson: Lesson, address: Address) -> Markup:
    sections = [
        tag("a", book.word("section", n=number), href=address(f"thesis:{number}")) for number in lesson.thesis
    ]
    listed = joined(*(part for each in sections for part in (each, Markup(", "))))
    return tag(
        "section",
        tag("h2", book.word("thesis"), id="thesis-title"),
        tag("p", tag("span", THESIS), book.word("colon"), Markup(listed.removesuffix(", ")), Markup(".")),
        tag("h2", book.word("papers")),
        tag("ul", *(tag("li", paper_html(paper)) for paper in lesson.papers)),
        aria_labelledby="thesis-title",
        class_="references",
    )


def paper_html(paper: str) -> Markup:
    """Return a paper with its address as a link."""
    text, _, link = paper.partition("https://")
    if not link:
        return joined(paper)
    return joined(text, tag("a", f"https://{link}", href=f"https://{link}"))


def _turn(book: Book, lesson: Lesson) -> Markup:
    place = book.lessons.index(lesson)
    before = book.lessons[place - 1] if place else None
    after = book.lessons[place + 1] if place + 1 < len(book.lessons) else None
    return tag(
        "nav",
        tag("a", f"← {before.title}", href=f"{before.name}.html", rel="prev") if before else None,
        tag("a", f"{after.title} →", href=f"{after.name}.html", rel="next") if after else None,
        class_="turn",
        aria_label=f"{book.word('previous')}, {book.word('next')}",
    )
