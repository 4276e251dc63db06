"""Keep a shader's text that came without a file: from the clipboard, or from standard input.

It becomes a new file, named by the title that it begins with, its ending by its dialect. No file is
written over, and the same text is kept once.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import suppress
from itertools import count
from pathlib import Path

from playground.allowed_files import TEXTS
from playground.errors import DataError, SketchError
from playground.files import partial_file, read_regular
from playground.paths import state_folder
from playground.shader.dialect import dialects

MAX_PASTED_BYTES = 4 * 2**20
"""Bytes that a text may have."""

_UNTITLED = "pasted"
_COMMENT = re.compile(r"\s*(?://+|/\*+)[ \t*=-]*(?:[\w.-]+\.\w+ --[ \t]*)?([^\n*]*)")
_OF_EXPORT = re.compile(r'"info"\s*:\s*\{[^{}]*?"name"\s*:\s*"([^"\\]*)"', re.DOTALL)
_TITLE = re.compile(r"\w[\w' ,:!?&+-]{0,48}\w[.!?]?")
_NO_TITLE = re.compile(
    r"licen[sc]e|copyright|created|author|rights reserved|shadertoy|version|\bby\b|precision", re.I
)
_COMPUTE = re.compile(r"^\s*#version.*\blocal_size_x\b", re.DOTALL)


def keep_text(text: str, folder: Path) -> Path:
    """Write a shader's text as a new file and return its path.

    The file is in ``folder``, or where that cannot be written to, in the user's own folder of the
    playground. Raises ``SketchError`` for a text with nothing to run, and ``DataError`` for what is no
    text, for one of more than ``MAX_PASTED_BYTES`` bytes, and where nothing can be written.
    """
    text = text.removeprefix("\ufeff").replace("\r\n", "\n")
    if not text.strip():
        raise SketchError("there is no text to open; a shader's text was expected")
    if "\0" in text:
        raise DataError("this is no text; a shader's text was expected")
    data = text.encode("utf-8", "replace")
    if len(data) > MAX_PASTED_BYTES:
        raise DataError(
            f"the text is larger than {MAX_PASTED_BYTES // 2**20} MiB; a shader's text was expected"
        )
    dialect = dialects().name_of(text)
    if not dialect:
        raise SketchError("nothing to run: no main, mainImage or #pragma kernel in the text")
    if dialect not in dialects().names:
        raise SketchError("the text is Shadertoy's sound, VR or cube map alone, which is not drawn")
    ending = ".comp" if _COMPUTE.match(text) else dialects().ending(dialect)
    name = _named(text)
    with suppress(OSError):
        return _kept(data, folder, name, ending)
    own = state_folder() / "pasted"
    try:
        own.mkdir(parents=True, exist_ok=True)
        return _kept(data, own, name, ending)
    except OSError as error:
        raise DataError(f"the text cannot be kept: {error.strerror or error}", file=folder) from None


def _kept(data: bytes, folder: Path, name: str, ending: str) -> Path:
    """Write the data under the first name that is free, or find it under one before."""
    for stem in _stems(name):
        path = folder / f"{stem}{ending}"
        if any(os.path.lexists(folder / f"{stem}{other}") for other in (*TEXTS, *dialects().endings)):
            if path.is_file() and path.stat().st_size == len(data) and read_regular(path) == data:
                return path
            continue
        with partial_file(path) as partial:
            partial.handle.write(data)
            partial.handle.flush()
            try:
                path.touch(exist_ok=False)  # the name is this text's from here on
            except FileExistsError:
                continue
            try:
                partial.rename(path)
            except BaseException:
                path.unlink(missing_ok=True)
                raise
        return path
    raise AssertionError


def _stems(name: str) -> Iterator[str]:
    if name:
        yield name
        yield from (f"{name}_{number}" for number in count(2))
    yield from (f"{_UNTITLED}_{number}" for number in count(1))


def _named(text: str) -> str:
    """Return a file's name from the title that a text begins with; "" where that is none."""
    paths = _OF_EXPORT.search(text) or _COMMENT.match(text)
    title = paths.group(1).strip() if paths else ""
    if not _TITLE.fullmatch(title) or _NO_TITLE.search(title):
        return ""
    return re.sub(r"\W+", "_", title.lower()).strip("_")[:40].rstrip("_")
