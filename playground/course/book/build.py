"""Build the book: one folder that needs no network.

index.html          the cover, from which one chooses a language
en/, fr/            a page for each lesson, the contents, the glossary, the thesis's figures
pictures/           all pictures, for all languages
book.css, book.js, find.js, fonts/
en/words.js …       what is searched
live.js, data/ …     what runs where a reader starts a figure: see ``live``
book.json           the files that were written, so that the next build removes what is no more
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from playground.course import model
from playground.course.book.html import LessonContext, image
from playground.course.book.live import LiveBook, live_book
from playground.course.book.page import (
    FIGURES,
    GLOSSARY,
    Book,
    contents_page,
    cover_page,
    gallery_html,
    gallery_page,
    glossary_page,
    lesson_page,
    section_id,
)
from playground.course.document import plain
from playground.course.figures import HERO, FigurePicture, Hero, ThesisFigure, hero_of, thesis_figures
from playground.course.glossary import alphabetical
from playground.course.library import labels
from playground.course.model import Lesson, Scene
from playground.course.scenes import Picture, Sketches, draw, pictures_of
from playground.course.traces import Results, results_of
from playground.engine.context import context_info
from playground.engine.engine import Engine
from playground.errors import DataError
from playground.files import replacing, write_file
from playground.json_text import read_json
from playground.markup import Markup

QUALITY = 79
"""Of WebP: noise in a texture costs most, and errors in it are least visible."""

EFFORT = 50
"""Of lossless WebP, where quality only means time: more made nothing smaller."""

SHARPER = 1.5
"""Pixels drawn for each of a page's, each way: screens have more than one."""


BLACK = 32.0
"""Level of 255 that nine tenths of a picture lie below, where there is nothing but black to see."""

MAX_DIAGRAM_COLOURS = 2048
"""Colours that a diagram has at most; terrain has tens of thousands."""


@dataclass
class Album:
    """The pictures of a book: their files, and what each shows; equal pictures share a file."""

    folder: Path
    scenes: dict[str, Scene] = field(default_factory=dict)  # file name → what it shows
    files: dict[str, str] = field(default_factory=dict)  # picture → file name
    _known: dict[tuple[object, ...], str] = field(default_factory=dict)

    def add(self, name: str, scene: Scene) -> None:
        """Note a picture by its name; the same picture under another name has one file."""
        key = (scene.sketch, scene.pixels, scene.time, scene.steps)
        self.files[name] = file = self._known.setdefault(key, f"{name}.webp")
        self.scenes.setdefault(file, scene)

    def draw(self, engine: Engine, names: Iterable[str], advance: Callable[[], None]) -> None:
        """Draw some of the pictures; raise as ``Engine.render`` does."""
        self.folder.mkdir(parents=True, exist_ok=True)
        before: Future[None] | None = None
        with ThreadPoolExecutor(1) as aside:  # a picture is stored while the next is drawn
            for name in names:
                frame = draw(engine, larger(self.scenes[name]))
                if before:
                    before.result()
                    advance()
                before = aside.submit(store, self.folder / name, frame.array)
            if before:
                before.result()
                advance()


def store(path: Path, picture: NDArray[np.uint8]) -> None:
    """Write a picture as WebP: a diagram without loss, terrain nearly so."""
    exact = is_diagram(picture)
    with replacing(path) as handle:
        image = Image.fromarray(picture).convert("RGB")
        if exact:
            image.save(handle, "WEBP", quality=EFFORT, method=2, lossless=True)
        else:
            image.save(handle, "WEBP", quality=QUALITY, method=4)


def is_diagram(picture: NDArray[np.uint8]) -> bool:
    """Whether a picture has few colours: compression damages its thin lines, which terrain tolerates."""
    colours = picture[..., :3].astype(np.uint32) @ np.array([1, 256, 65536], np.uint32)
    return np.unique(colours).size <= MAX_DIAGRAM_COLOURS


def is_blank(path: Path) -> bool:
    """Whether a stored picture is as good as black, seen from as far as a stamp."""
    with Image.open(path) as image:
        small = image.convert("L").resize((64, 36), Image.Resampling.BOX)
    return float(np.percentile(np.asarray(small), 90)) < BLACK


def larger(scene: Scene) -> Scene:
    """Return a picture with the pixels that the book draws."""
    width, height = scene.pixels
    return replace(scene, pixels=(round(width * SHARPER), round(height * SHARPER)))


Entry = tuple[str, str, str, str]
"""An address in the book, the title of its page, of its section, and its text."""

_HIDDEN = {"answer", "fix", "hint", "solution"}
"""Fields of blocks that are folded away: a search does not give them away."""


def lesson_entries(lesson: model.Lesson, setting: LessonContext) -> Iterator[Entry]:
    """Yield the sections of a lesson; what stands before the first is its page."""
    for number, section in enumerate(lesson.sections):
        texts = [setting.filled(text) for block in section.blocks for text in _texts(block)]
        if not number:
            yield f"{lesson.name}.html", lesson.title, "", _words(lesson.goal, *texts)
            continue
        address = f"{lesson.name}.html#{section_id(number, section)}"
        yield address, lesson.title, _words(section.title), _words(*texts)


def glossary_entries(book: Book) -> Iterator[Entry]:
    """Yield the terms, by all their names in the language of the book."""
    for term in alphabetical(book.language):
        names = ", ".join(term.names[book.language])
        yield f"{GLOSSARY}.html#{term.key}", book.label("glossary"), names, term.meaning[book.language]


def words_script(entries: list[Entry]) -> str:
    """Return the script that gives find.js its texts."""
    return f"globalThis.bookWords={json.dumps(entries, ensure_ascii=False, separators=(',', ':'))};\n"


def _texts(block: model.Block) -> Iterator[str]:
    if isinstance(block, model.Prose) and block.kind == "formula":
        return
    for each in model.translated_fields(type(block)):
        if each.name not in _HIDDEN and each.name != "alt":
            value = getattr(block, each.name)
            yield from value if isinstance(value, tuple) else (value,)


def _words(*texts: str) -> str:
    """Return Markdown as its words, code too; of formulas those within a line, signs by their names."""
    words = (plain(text, lambda latex: re.sub(r"[\\{}]", "", latex)) for text in texts)
    return " ".join(" ".join(words).split())


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
    heroes: dict[str, Hero]  # by lesson
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
            heroes[lesson.name] = hero
            album.add(f"{lesson.name}-hero", hero.scene)
    for lesson in one_language:
        for picture in pictures_of(lesson):
            album.add(f"{lesson.name}-{picture.name}", picture.scene)
    figures = thesis_figures() if gallery else []
    for drawn in (drawn for figure in figures for drawn in figure.pictures):
        album.add(f"{drawn.sketch}-{drawn.shot}", drawn.scene)
    ordered = {language: tuple(of_language) for language, of_language in lessons.items()}
    return Build(folder, ordered, figures, album, heroes, answers)


def write_book(build: Build, engine: Engine, advance: Callable[[], None] = lambda: None) -> Path:
    """Draw every picture, compute every number, write every page; return the front page.

    Raises as drawing does; what has been written so far stays, and the next build goes over it.
    """
    _begin(build.folder)
    build.album.draw(engine, build.names, advance)
    one_language = next(iter(build.lessons.values()))
    results = {lesson.name: results_of(engine, lesson) for lesson in one_language}
    live = live_book(one_language, engine)
    books = [
        Book(
            language=language,
            label=labels("book", language),
            lessons=lessons,
            languages=tuple(build.lessons),
            renderer=context_info(engine.ctx).renderer,
            gallery=bool(build.figures),
        )
        for language, lessons in build.lessons.items()
    ]
    texts = {
        f"{book.language}/{name}": text for book in books for name, text in _pages(build, book, results, live)
    }
    texts["index.html"] = cover_page(books, _cover(build, one_language[0], PICTURES))
    files = {name: text.encode() for name, text in (texts | live.files).items()}
    files |= {name: (_HERE / name).read_bytes() for name in ("book.css", "book.js", "find.js", *FONTS)}
    for name, data in files.items():
        _write(build.folder / name, data)
    _forget(build.folder, [*files, *(f"{PICTURES}/{name}" for name in build.names)])
    return build.folder / "index.html"


def _pages(
    build: Build, book: Book, results: Mapping[str, Results], live: LiveBook
) -> Iterator[tuple[str, str]]:
    covers: dict[str, Markup] = {}
    entries: list[Entry] = []
    folder, album = f"../{PICTURES}", build.album
    for lesson in book.lessons:
        setting = _setting(build, book, lesson, results[lesson.name], live)
        entries += lesson_entries(lesson, setting)
        hero = build.heroes.get(lesson.name)
        shown = _cover(build, lesson, folder, alt=hero.alt[lesson.language]) if hero else None
        covers[lesson.name] = _cover(build, lesson, folder, lazy=True)
        yield f"{lesson.name}.html", lesson_page(book, lesson, setting, shown)
    yield "index.html", contents_page(book, covers)
    yield f"{GLOSSARY}.html", glossary_page(book)
    yield "words.js", words_script([*entries, *glossary_entries(book)])
    if build.figures:

        def address(drawn: FigurePicture) -> str:
            return f"{folder}/{album.files[f'{drawn.sketch}-{drawn.shot}']}"

        yield f"{FIGURES}.html", gallery_page(book, gallery_html(book, build.figures, address))


def _setting(build: Build, book: Book, lesson: Lesson, results: Results, live: LiveBook) -> LessonContext:
    """Return what the blocks of a lesson are written with."""
    album = build.album

    def file_of(picture: Picture) -> str:
        return album.files[f"{lesson.name}-{picture.name}"]

    return LessonContext(
        lesson,
        book.label,
        results,
        lambda picture: f"../{PICTURES}/{file_of(picture)}",
        book.anchor,
        live.blocks[lesson.name],
        lambda picture: is_blank(album.folder / file_of(picture)),
        build.answers,
    )


def _cover(build: Build, lesson: Lesson, folder: str, *, alt: str = "", lazy: bool = False) -> Markup:
    """Return a lesson's hero, or else its first picture; without a text where its title is next to it."""
    hero = lesson.name in build.heroes
    first = None if hero else pictures_of(lesson)[0]
    name, size = ("hero", HERO) if first is None else (first.name, first.scene.pixels)
    return image(f"{folder}/{build.album.files[f'{lesson.name}-{name}']}", alt, size, lazy=lazy)


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
