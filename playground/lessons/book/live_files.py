"""Write what a book's pages run: scripts that a page adds when a reader starts a figure.

live.js, live.css   the runtime, once for all pages
glsl.js             shaders, kernels and what else all lessons share
data/LESSON.js      the sketches and blocks of a lesson
data/KEY.js         bytes: what sources give, images

A page opened from disk may add scripts and fetch nothing. So data are scripts of one line, and each
holds gzip in base64.
"""

from __future__ import annotations

import base64
import gzip
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from playground.lessons.book.live_blocks import lesson_data
from playground.lessons.book.live_scenes import Library
from playground.lessons.model import Lesson
from playground.web.bundle import read_bundle

BUNDLES = {"live.js": "book.js", "live.css": "book.css"}
"""File of a book → bundle of the runtime."""


@dataclass(frozen=True)
class LiveBook:
    """What can be run of a book."""

    blocks: dict[str, frozenset[str]]  # lesson → names of its live blocks
    files: dict[str, str]  # by path in the book's folder


def live_book(lessons: Sequence[Lesson]) -> LiveBook:
    """Return what can be run of some lessons; raise ``PlaygroundError`` where the runtime is not built."""
    library = Library()
    data = {lesson.name: lesson_data(lesson, library) for lesson in lessons}
    blocks = {name: frozenset(found["blocks"]) for name, found in data.items()}
    if not any(blocks.values()):
        return LiveBook(blocks, {})
    files = {name: read_bundle(bundle) for name, bundle in BUNDLES.items()}
    files |= dict(_scripts(data, library))
    return LiveBook(blocks, files)


def _scripts(data: dict[str, dict[str, Any]], library: Library) -> Iterator[tuple[str, str]]:
    yield "glsl.js", script("glsl", packed(library.data()))
    for lesson, found in data.items():
        yield f"data/{lesson}.js", script(f"data/{lesson}", packed(found))
    for key, text in library.shared.blobs.texts.items():
        yield f"data/{key}.js", script(f"data/{key}", text)


def packed(data: Any) -> str:
    """Return data as JSON, gzip in base64; the same data give the same text."""
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False)
    return base64.b64encode(gzip.compress(text.encode(), compresslevel=9, mtime=0)).decode("ascii")


def script(name: str, text: str) -> str:
    """Return a script that holds a text without a quotation mark or a backslash, for book_data.js."""
    return f'(globalThis.bookData??={{}})["{name}"]="{text}";\n'
