"""Build the book: one folder that needs no network.

index.html          the cover, from which one chooses a language
en/, fr/            a page for each lesson, the contents, the glossary, the thesis's figures
pictures/           all pictures, for all languages
book.css, book.js, find.js, fonts/
en/words.js …       what is searched
live.js, data/ …     what runs where a reader starts a figure: see live_files.py
book.json           the files that were written, so that the next build removes what is no more
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from playground.course.book.blocks import LessonContext, picture_image
from playground.course.book.gallery import gallery_html
from playground.course.book.images import Album, is_blank, of_picture
from playground.course.book.live_files import LiveBook, live_book
from playground.course.book.page import (
    FIGURES,
    GLOSSARY,
    Book,
    contents_page,
    cover_page,
    gallery_page,
    glossary_page,
    hero_image,
    lesson_page,
)
from playground.course.book.search import Entry, glossary_entries, lesson_entries, words_script
from playground.course.figure_renders import Picture, pictures_of
from playground.course.figures import FigurePicture, Hero, ThesisFigure, hero_of, thesis_figures
from playground.course.library import interface_labels
from playground.course.measuring import Number, numbers_of
from playground.course.model import Lesson
from playground.course.scenes import Sketches
from playground.engine.context import context_info
from playground.engine.engine import Engine
from playground.errors import DataError
from playground.files import write_file
from playground.json_text import read_json
from playground.markup import Markup

MANIFEST = "book.json"
PICTURES = "pictures"
FONTS = tuple(f"fonts/{path.name}" for path in sorted((Path(__file__).parent / "fonts").glob("*.[wt]*")))
"""The book's fonts, and their licences."""
_HERE = Path(__file__).resolve().parent


@dataclass
class Build:
    """What a build is made of; nothing is drawn yet."""

    folder: Path
    lessons: dict[str, tuple[Lesson, ...]]  # by language, each in order
    figures: list[ThesisFigure]
    album: Album
    files: dict[str, dict[str, str]]  # lesson → picture → file
    gallery: dict[tuple[str, str], str]  # sketch, shot → file
    heroes: dict[str, tuple[str, Hero]]  # lesson → file, hero
    answers: str = "inline"  # one of ``blocks.ANSWERS``

    @property
    def names(self) -> list[str]:
        """The pictures that are to be drawn."""
        return list(self.album.scenes)


def prepare(
    folder: Path, lessons: Mapping[str, Sequence[Lesson]], *, gallery: bool = True, answers: str = "inline"
) -> Build:
    """Return what is to be built into a folder, that is empty, new, or a book already.

    Raises ``DataError`` for a folder with other things in it.
    """
    if folder.exists() and not (folder / MANIFEST).is_file():
        if not folder.is_dir() or any(folder.iterdir()):
            raise DataError(
                "there is something here that is no book; name a new or empty folder", file=folder
            )
    album = Album(folder / PICTURES)
    one_language = next(iter(lessons.values()))
    heroes, sketches = {}, Sketches()
    for lesson in one_language:
        if hero := hero_of(lesson.name, sketches):
            heroes[lesson.name] = album.add(f"{lesson.name}-hero", hero.scene), hero
    files = {lesson.name: album.add_lesson(lesson) for lesson in one_language}
    figures = thesis_figures() if gallery else []
    shown = [drawn for figure in figures for drawn in figure.pictures]
    of_shots = {(d.sketch, d.shot): album.add(f"{d.sketch}-{d.shot}", d.scene) for d in shown}
    return Build(
        folder,
        {k: tuple(v) for k, v in lessons.items()},
        figures,
        album,
        files,
        of_shots,
        heroes,
        answers=answers,
    )


def write_book(build: Build, engine: Engine, advance: Callable[[], None] = lambda: None) -> Path:
    """Draw every picture, compute every number, write every page; return the front page.

    Raises as drawing does; what has been written so far stays, and the next build goes over it.
    """
    _begin(build.folder)
    build.album.draw(engine, build.names, advance)
    numbers = {lesson.name: numbers_of(engine, lesson) for lesson in next(iter(build.lessons.values()))}
    live = live_book(next(iter(build.lessons.values())), engine)
    info = context_info(engine.ctx)
    written = [f"{PICTURES}/{name}" for name in build.names]
    books = [
        Book(
            language=language,
            label=interface_labels(language),
            lessons=lessons,
            languages=tuple(build.lessons),
            renderer=info.renderer,
            gallery=bool(build.figures),
        )
        for language, lessons in build.lessons.items()
    ]
    for book in books:
        for name, text in _pages(build, book, numbers, live):
            _write(build.folder / book.language / name, text.encode())
            written.append(f"{book.language}/{name}")
    _write(
        build.folder / "index.html", cover_page(books, _cover(build, books[0].lessons[0], PICTURES)).encode()
    )
    for name in ("book.css", "book.js", "find.js", *FONTS):
        _write(build.folder / name, (_HERE / name).read_bytes())
        written.append(name)
    for name, text in live.files.items():
        _write(build.folder / name, text.encode())
        written.append(name)
    _forget(build.folder, [*written, "index.html"])
    return build.folder / "index.html"


def _pages(
    build: Build, book: Book, numbers: dict[str, dict[str, Number]], live: LiveBook
) -> Iterator[tuple[str, str]]:
    covers: dict[str, Markup] = {}
    entries: list[Entry] = []
    for lesson in book.lessons:
        files = build.files[lesson.name]
        source = of_picture(files, f"../{PICTURES}")
        runs = live.blocks[lesson.name]

        def blank(picture: Picture, files: dict[str, str] = files) -> bool:
            return is_blank(build.album.folder / files[picture.name])

        setting = LessonContext(
            lesson, book.label, numbers[lesson.name], source, book.anchor, runs, blank, build.answers
        )
        entries += lesson_entries(lesson, setting)
        hero = None
        if hero_picture := build.heroes.get(lesson.name):
            file, item = hero_picture
            hero = hero_image(f"../{PICTURES}/{file}", item.alt[lesson.language])
        covers[lesson.name] = _cover(build, lesson, f"../{PICTURES}", lazy=True)
        yield f"{lesson.name}.html", lesson_page(book, lesson, setting, hero)
    yield "index.html", contents_page(book, covers)
    yield f"{GLOSSARY}.html", glossary_page(book)
    yield "words.js", words_script([*entries, *glossary_entries(book)])
    if build.figures:

        def address(drawn: FigurePicture) -> str:
            return f"../{PICTURES}/{build.gallery[drawn.sketch, drawn.shot]}"

        yield f"{FIGURES}.html", gallery_page(book, gallery_html(book, build.figures, address))


def _cover(build: Build, lesson: Lesson, folder: str, *, lazy: bool = False) -> Markup:
    """Return a lesson's hero, or else its first picture, without a text: its title is next to it."""
    if hero_picture := build.heroes.get(lesson.name):
        return hero_image(f"{folder}/{hero_picture[0]}", "", lazy=lazy)
    picture = pictures_of(lesson)[0]
    source = of_picture(build.files[lesson.name], folder)(picture)
    return picture_image(picture, source, "", lazy=lazy)


def _write(path: Path, data: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    write_file(path, data)


def _begin(folder: Path) -> None:
    """Mark a folder as a book, so that a build that was stopped can begin again."""
    if not (folder / MANIFEST).is_file():
        _write(folder / MANIFEST, b'{"files": []}\n')


def _forget(folder: Path, written: list[str]) -> None:
    """Remove what an earlier build wrote and this one did not, and list what this one wrote."""
    manifest = folder / MANIFEST
    try:
        before = [str(name) for name in read_json(manifest.read_text(encoding="utf-8"))["files"]]
    except (ValueError, KeyError, TypeError):  # somebody has written into it
        before = []
    current = set(written)
    for name in before:
        path = folder / name
        if name not in current and ".." not in Path(name).parts and not Path(name).is_absolute():
            path.unlink(missing_ok=True)
    _write(manifest, (json.dumps({"files": sorted(current)}, indent=1) + "\n").encode())
