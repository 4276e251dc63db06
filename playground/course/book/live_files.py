"""Write what a book's pages run: scripts that a page adds when a reader starts a figure.

live.js, live.css   the runtime, once for all pages
glsl.js             shaders, kernels and what else all lessons share
data/LESSON.js      the sketches and blocks of a lesson, and bytes that are few
data/KEY.js         other bytes: what sources give, images

A page opened from disk may add scripts and fetch nothing. So data are scripts of one line, and each
holds gzip in base64.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from playground.course.book.live_blocks import block_data, lesson_data
from playground.course.book.live_scenes import Library, Scenes
from playground.course.library import LANGUAGES
from playground.course.model import Lesson, Named
from playground.course.tasks.sentences import task_labels
from playground.engine.engine import Engine
from playground.web.blobs import packed_json
from playground.web.bundle import read_bundle

BUNDLES = {"live.js": "book.js", "live.css": "book.css"}
"""File of a book → bundle of the runtime."""

MAX_INLINE_LETTERS = 4096
"""Letters of bytes that a lesson's own script holds, so that a book has no hundred small files."""


@dataclass(frozen=True)
class LiveBook:
    """What can be run of a book."""

    blocks: dict[str, frozenset[str]]  # lesson → names of its live blocks
    files: dict[str, str]  # by path in the book's folder


def live_book(lessons: Sequence[Lesson], engine: Engine | None = None) -> LiveBook:
    """Return what can be run of some lessons; raise ``PlaygroundError`` where the runtime is not built.

    ``engine`` draws what sources are made of; see ``Library``.
    """
    library = Library(engine)
    data = {lesson.name: lesson_data(lesson, library) for lesson in lessons}
    blocks = {name: frozenset(data["blocks"]) for name, data in data.items()}
    if not any(blocks.values()):
        return LiveBook(blocks, {})
    files = {name: read_bundle(bundle) for name, bundle in BUNDLES.items()}
    files |= dict(_scripts(data, library))
    return LiveBook(blocks, files)


def widget_page(block: Named, engine: Engine | None = None) -> str:
    """Return all that a notebook's widget needs to run one block, packed; "" for one that cannot be live.

    ``engine`` draws what sources are made of; see ``Library``.
    """
    library = Library(engine)
    scenes = Scenes(library)
    data = block_data(block, scenes)
    if data is None:
        return ""
    shared = {**library.data(), "blobs": library.shared.blobs.texts}
    return packed_json({"block": data, "sketches": scenes.sketches, "library": shared})


def _scripts(data: dict[str, dict[str, Any]], library: Library) -> Iterator[tuple[str, str]]:
    say = {language: _said_in_a_page(language) for language in LANGUAGES}
    yield "glsl.js", script("glsl", packed_json({**library.data(), "say": say}))
    texts = library.shared.blobs.texts
    few = {key for key, text in texts.items() if len(text) <= MAX_INLINE_LETTERS}
    for lesson, lesson_entry in data.items():
        blobs = {key: texts[key] for key in sorted(few & blobs_in(lesson_entry, library))}
        yield f"data/{lesson}.js", script(f"data/{lesson}", packed_json({**lesson_entry, "blobs": blobs}))
    for key in texts.keys() - few:
        yield f"data/{key}.js", script(f"data/{key}", texts[key])


def _said_in_a_page(language: str) -> dict[str, str]:
    """Return what work_words.js says of works; measures are taken elsewhere."""
    return {key: text for key, text in task_labels(language).items() if not key.startswith("measure_")}


def blobs_in(data: Any, library: Library) -> set[str]:
    """Return the keys of the bytes that a lesson's data name, by themselves or by an image."""
    if isinstance(data, dict):
        return set().union(*(blobs_in(of, library) for of in data.values()))
    if isinstance(data, list):
        return set().union(*(blobs_in(of, library) for of in data))
    if not isinstance(data, str):
        return set()
    image = library.shared.images.data.get(data)
    return {image["blob"]} if image else {data} & library.shared.blobs.texts.keys()


def script(name: str, text: str) -> str:
    """Return a script that holds a text without a quotation mark or a backslash, for book_data.js."""
    return f'(globalThis.bookData??={{}})["{name}"]="{text}";\n'
