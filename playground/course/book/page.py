"""The pages of the book: each lesson's, the contents, and the thesis's figures."""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from playground._version import __version__
from playground.course.book.html import Anchor, LessonContext, block_html, image, line, open_command
from playground.course.document import plain
from playground.course.figures import FigurePicture, ThesisFigure
from playground.course.glossary import Term, alphabetical, linked_term, terms_of
from playground.course.library import LANGUAGES, THESIS, Labels, parts
from playground.course.model import Lesson, Section
from playground.markup import Markup, document, joined, tag

FIGURES = "figures"
"""The name of the gallery's page."""

POLICY = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; font-src 'self'"
"""What a page may load: files of the book. Of pages opened from disk, browsers take those for 'self'."""

GLOSSARY = "glossary"
"""The name of the page of terms."""


@dataclass(frozen=True)
class Book:
    """What every page of the book in one language shares."""

    language: str
    label: Labels
    lessons: tuple[Lesson, ...]  # in their order
    languages: tuple[str, ...]  # that are built
    renderer: str  # that drew the pictures
    gallery: bool = True  # whether the thesis's figures are among the pages

    def anchor(self, link: str) -> dict[str, str]:
        """Return the attributes of a lesson's link: its address in the book, and what a term means.

        There are none for a lesson that is not in the book: its link is text.
        """
        kind, _, what = link.partition(":")
        if kind == "lesson":
            return {"href": f"{what}.html"} if any(what == lesson.name for lesson in self.lessons) else {}
        if kind == "thesis":  # its text is not ours to give; the figures of that chapter are here
            chapter = f"{FIGURES}.html#chapter-{what.partition('.')[0]}"
            return {"href": chapter if self.gallery else "#thesis-title"}
        if kind == "sketch":
            return {"href": "#play"}
        if term := linked_term(link):
            href = f"{GLOSSARY}.html#{term.key}"
            return {"href": href, "class_": "term", "data_means": term.definition(self.language)}
        return {"href": link}


def lesson_page(book: Book, lesson: Lesson, setting: LessonContext, hero: Markup | None = None) -> str:
    """Return the page of a lesson, with a picture at its head."""
    body: list[Markup] = []
    first = hero is None
    for number, section in enumerate(lesson.sections):
        inside = []
        for block in section.blocks:
            inside.append(block_html(block, setting, first=first))
            first = first and "<img" not in inside[-1]
        if not section.title:
            body.append(joined(*inside))
            continue
        title = section_id(number, section)
        heading = tag("h2", setting.line(section.title), id=title)
        body.append(tag("section", heading, *inside, aria_labelledby=title))
    label = book.label
    if setting.at_end:
        heading = tag("h2", label("answers"), id="answers-title")
        body.append(
            tag("section", heading, *setting.at_end, class_="answers", aria_labelledby="answers-title")
        )
    minutes = label("minutes", reading=lesson.minutes, exercises=lesson.exercise_minutes)
    kicker = f"{label('lesson')} {lesson.number} · {minutes}"
    head = tag(
        "header",
        _pager(book, lesson, "above"),
        tag("p", kicker, class_="kicker"),
        tag("h1", lesson.title),
        tag("p", tag("b", label("goal")), label("colon"), setting.line(lesson.goal), class_="goal"),
        tag("p", label("stale"), class_="stale") if lesson.stale else None,
        tag("figure", hero, class_="hero") if hero else None,
    )
    ending = (_play(book, lesson), _references(book, lesson, setting.anchor), _pager(book, lesson, "below"))
    runs = lesson.name if setting.live else None
    side = _contents_of(book, lesson, setting)
    return _page(book, lesson.title, lesson.name, joined(head, *body, *ending), runs=runs, side=side)


def section_id(number: int, section: Section) -> str:
    """Return the id of a lesson's section, by its place among them."""
    return f"s{number}-{slug(plain(section.title))}"


def _contents_of(book: Book, lesson: Lesson, setting: LessonContext) -> Markup:
    """Return the list of a page's sections, to stand at its side."""
    sections = [
        (section_id(number, section), line(section.title, lambda link: {}))
        for number, section in enumerate(lesson.sections)
        if section.title
    ]
    if setting.at_end:
        sections.append(("answers-title", joined(book.label("answers"))))
    sections += [("play-title", joined(book.label("play"))), ("thesis-title", joined(book.label("thesis")))]
    rows = [tag("li", tag("a", title, href=f"#{anchor}")) for anchor, title in sections]
    title = book.label("on_this_page")
    inside = tag("details", tag("summary", title), tag("ol", *rows))
    return tag("nav", inside, class_="toc", aria_label=title)


def contents_page(book: Book, covers: Mapping[str, Markup]) -> str:
    """Return the page with the lessons, part by part; ``covers`` are their pictures."""
    label, shown = book.label, []
    by_name = {lesson.name: lesson for lesson in book.lessons}
    for number, part in enumerate(parts(), 1):
        cards = [_card(book, by_name.pop(name), covers[name]) for name in part.lessons if name in by_name]
        if cards:
            title, anchor = part.titles[book.language], f"part-{number}"
            heading = tag("h2", title, id=anchor)
            shown.append(tag("section", heading, tag("ol", *cards, class_="cards"), aria_labelledby=anchor))
    if by_name:  # lessons whose texts are elsewhere
        cards = [_card(book, lesson, covers[name]) for name, lesson in by_name.items()]
        shown.append(tag("ol", *cards, class_="cards"))
    figures = tag("a", label("figures"), href=f"{FIGURES}.html")
    body = joined(
        tag("header", tag("h1", label("book")), tag("p", label("book_goal"), class_="goal")),
        *shown,
        tag("p", figures, Markup(" — "), label("figures_goal"), class_="more") if book.gallery else None,
        tag("p", label("source", thesis=THESIS), class_="more"),
    )
    return _page(book, label("book"), "index", body, wide=True)


def _card(book: Book, lesson: Lesson, cover: Markup) -> Markup:
    name = tag("span", f"{lesson.number}. {lesson.title}", class_="name")
    link = tag("a", cover, name, href=f"{lesson.name}.html")
    minutes = book.label("minutes", reading=lesson.minutes, exercises=lesson.exercise_minutes)
    return tag("li", link, tag("p", line(lesson.goal, book.anchor)), tag("p", minutes, class_="kicker"))


def gallery_page(book: Book, body: Markup) -> str:
    """Return the page of the thesis's figures."""
    head = tag(
        "header",
        tag("h1", book.label("figures")),
        tag("p", book.label("figures_goal"), class_="goal"),
        tag("p", book.label("source", thesis=THESIS)),
    )
    return _page(book, book.label("figures"), FIGURES, joined(head, body), wide=True)


def glossary_page(book: Book) -> str:
    """Return the page of terms: what each means, and which lessons use it."""
    users: dict[str, list[Lesson]] = {}
    for lesson in book.lessons:
        for term in terms_of(lesson):
            users.setdefault(term.key, []).append(lesson)
    rows = [row for term in alphabetical(book.language) for row in _term(book, term, users.get(term.key, []))]
    title, goal = book.label("glossary"), tag("p", book.label("glossary_goal"), class_="goal")
    body = joined(tag("header", tag("h1", title), goal), tag("dl", *rows, class_="glossary"))
    return _page(book, title, GLOSSARY, body)


def _term(book: Book, term: Term, users: Sequence[Lesson]) -> tuple[Markup, Markup]:
    """Return a term and its definition, as entries of a list of definitions."""
    label = book.label
    name, *synonyms = term.names[book.language]
    translations = tag("i", ", ".join(term.names["en" if book.language == "fr" else "fr"]))
    notes: list[tuple[str, list[str | Markup]]] = [(label("other_language"), [translations])]
    if synonyms:
        notes.insert(0, (label("also"), [", ".join(synonyms)]))
    if users:
        links = [(", ", tag("a", lesson.title, href=f"{lesson.name}.html")) for lesson in users]
        notes.append((label("in_lessons"), [part for pair in links for part in pair][1:]))
    lines = [tag("small", about, label("colon"), *inside) for about, inside in notes]
    return tag("dt", name, id=term.key), tag("dd", tag("p", term.meaning[book.language]), *lines)


def cover_page(books: Sequence[Book], hero: Markup) -> str:
    """Return the page above the languages: what the book is, and a way into each."""
    first = books[0]
    body = tag(
        "main",
        tag("figure", hero, class_="hero"),
        tag("div", _way_in(first, "h1"), *(_way_in(book, "h2") for book in books[1:]), class_="languages"),
        tag("p", first.label("source", thesis=THESIS), class_="more"),
        class_="cover",
    )
    return _document(first.language, first.label("book"), tag("body", body), folder="")


def _way_in(book: Book, heading: str) -> Markup:
    """Return a language on the cover: title, parts, and the link to the contents."""
    label, front = book.label, f"{book.language}/index.html"
    rows = []
    for number, part in enumerate(parts(), 1):
        if titles := [lesson.title for lesson in book.lessons if lesson.name in part.lessons]:
            inside = part.titles[book.language], tag("small", " · ".join(titles))
            rows.append(tag("li", tag("a", *inside, href=f"{front}#part-{number}")))
    return tag(
        "section",
        tag(heading, label("book")),
        tag("p", label("book_goal"), class_="goal"),
        tag("p", tag("a", label("enter"), href=front, hreflang=book.language, class_="enter")),
        tag("ul", *rows) if rows else None,
        lang=book.language,
    )


def slug(text: str) -> str:
    """Return a text as it may be in an address: small letters, digits and -."""
    letters = unicodedata.normalize("NFKD", text).encode("ascii", "ignore").decode().lower()
    return re.sub(r"[^a-z0-9]+", "-", letters).strip("-")


def _document(language: str, title: str, body: Markup, folder: str = "../") -> str:
    head = joined(
        tag("meta", name="color-scheme", content="light dark"),
        tag("link", rel="stylesheet", href=f"{folder}book.css"),
        tag("script", src=f"{folder}book.js", defer=True),
    )
    return document(language, title, body, policy=POLICY, head=head)


def _page(
    book: Book,
    title: str,
    name: str,
    body: Markup,
    *,
    wide: bool = False,
    runs: str | None = None,
    side: Markup | None = None,
) -> str:
    label = book.label
    others = [
        tag("a", LANGUAGES[code], href=f"../{code}/{name}.html", lang=code, hreflang=code)
        for code in book.languages
        if code != book.language
    ]
    top = tag(
        "nav",
        tag("a", label("contents"), href="index.html"),
        tag("a", label("figures"), href=f"{FIGURES}.html") if book.gallery else None,
        tag("a", label("glossary"), href=f"{GLOSSARY}.html"),
        *others,
        tag("button", label("search"), type="button", id="search", hidden=True),
        tag("button", label("theme"), type="button", id="theme", hidden=True),
        class_="top",
        aria_label=label("contents"),
    )
    scripted = ["backward", "forward", "run", "stop", "side", "over", "copy", "copied", "theme"]
    scripted += ["live", "live_goal", "search", "search_hint", "found_none", "found", "close", "answers"]
    main = tag("main", body, id="main", class_="wide" if wide else None)
    page = tag(
        "body",
        tag("a", label("skip"), href="#main", class_="skip"),
        top,
        tag("div", side, main, class_="sheet with-side" if side else "sheet"),
        tag("footer", tag("p", label("made_by", version=__version__, renderer=book.renderer))),
        data_lesson=runs,
        **{f"data_{key}": label[key] for key in scripted},
    )
    whole_title = f"{title} — {label('book')}" if name != "index" else title
    return _document(book.language, whole_title, page)


def _play(book: Book, lesson: Lesson) -> Markup:
    return tag(
        "section",
        tag("h2", book.label("play"), id="play-title"),
        tag("p", book.label("play_goal")),
        command_line(f"playground live {lesson.sketch}"),
        tag("p", f"{book.label('try_it')}{book.label('colon')}"),
        command_line(open_command(lesson)),
        id="play",
        aria_labelledby="play-title",
    )


def command_line(command: str) -> Markup:
    """Return a command, to be copied."""
    return tag("pre", tag("code", command), class_="command", tabindex=0)


def _references(book: Book, lesson: Lesson, anchor: Anchor) -> Markup:
    label = book.label
    listed: list[str | Markup] = []
    for number in lesson.thesis:
        listed += [", ", tag("a", label("section", n=number), **anchor(f"thesis:{number}"))]
    return tag(
        "section",
        tag("h2", label("thesis"), id="thesis-title"),
        tag("p", tag("span", THESIS), label("colon"), *listed[1:], "."),
        tag("h2", label("papers")),
        tag("ul", *(tag("li", paper_html(paper)) for paper in lesson.papers)),
        aria_labelledby="thesis-title",
        class_="references",
    )


def paper_html(paper: str) -> Markup:
    """Return a paper with its address as a link."""
    text, _, link = paper.partition("https://")
    return joined(text, tag("a", f"https://{link}", href=f"https://{link}") if link else None)


def _pager(book: Book, lesson: Lesson, where: str) -> Markup:
    """Return the links to the lessons before and after; they stand above a lesson and below it."""
    index = book.lessons.index(lesson)
    before = book.lessons[index - 1] if index else None
    after = book.lessons[index + 1] if index + 1 < len(book.lessons) else None
    return tag(
        "nav",
        tag("a", f"← {before.title}", href=f"{before.name}.html", rel="prev") if before else None,
        tag("a", f"{after.title} →", href=f"{after.name}.html", rel="next") if after else None,
        class_="pager",
        aria_label=f"{book.label('previous')}, {book.label('next')} ({book.label(where)})",
    )


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
    # The caption describes what the thesis shows; this identifies the picture.
    alt = f"{number}, {picture.sketch}: {picture.scene.sketch.title}"
    shown = image(source(picture), alt, picture.scene.pixels, lazy=True)
    rows = (each for row in picture.parameters for each in (tag("dt", row[0]), tag("dd", row[1])))
    parameters = tag("details", tag("summary", book.label("parameters")), tag("dl", *rows))
    return tag("figure", shown, parameters, command_line(picture.command))
