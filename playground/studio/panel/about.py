"""What a sketch is about, in its own words: the comment that its file begins with."""

from __future__ import annotations

import re
from pathlib import Path

from playground.data.content_hash import content_hash
from playground.errors import PlaygroundError
from playground.files import read_regular
from playground.memo import FILES
from playground.sketch.model import Sketch

_MAX_BYTES = 2**20  # of a file that is read for its comment
_OWN_NAME = re.compile(r"^[\w.-]+\.\w+\s+(--|–|-|:)\s+")  # "terrain.glsl -- hills"
_LEGAL = re.compile(r"\b(copyright|SPDX-|licen[sc]ed? under)", re.IGNORECASE)
_SENTENCE_END = re.compile(r"(?<=[.!?])\s+(?=[A-ZÀ-Þ])")


def about(sketch: Sketch) -> list[str]:
    """Return the paragraphs of the comment that a sketch's file begins with, without its title.

    There are none where it begins with no comment, or cannot be read.
    """
    path = Path(sketch.file)
    try:
        return _about_at(path, content_hash(path), sketch.title)
    except (OSError, PlaygroundError):
        return []


@FILES.cached()
def _about_at(path: Path, _: str, title: str) -> list[str]:
    if path.stat().st_size > _MAX_BYTES:
        return []
    text = read_regular(path).decode("utf-8-sig", "replace")
    return paragraphs_of(text, title, is_toml=path.suffix == ".toml")


def paragraphs_of(text: str, title: str = "", *, is_toml: bool = False) -> list[str]:
    """Return the paragraphs of the comment that a text begins with: prose alone.

    The file's own name before it goes, and so do a sentence that is the title and who holds which rights.
    """
    paragraphs: list[list[str]] = [[]]
    for line in _toml_comment(text) if is_toml else _shader_comment(text):
        if any(letter.isalnum() for letter in line):
            paragraphs[-1].append(line.strip(" \t*"))
        elif paragraphs[-1]:
            paragraphs.append([])
    result = []
    for lines in paragraphs:
        prose = _OWN_NAME.sub("", " ".join(lines))
        if prose[:1] in ("", "{") or _LEGAL.search(prose):
            continue
        first, *rest = _SENTENCE_END.split(prose)
        if title.casefold().startswith(first.rstrip(".").casefold()):
            prose = " ".join(rest)
        if prose:
            result.append(prose[:1].upper() + prose[1:])
    return result


def _toml_comment(text: str) -> list[str]:
    lines = []
    for line in text.lstrip().splitlines():
        if not line.startswith("#"):
            break
        lines.append(line[1:])
    return lines


def _shader_comment(text: str) -> list[str]:
    lines: list[str] = []
    inside = False
    for raw in text.lstrip().splitlines():
        line = raw.strip()
        if not inside and line.startswith("//"):
            lines.append(line.lstrip("/"))
        elif inside or line.startswith("/*"):
            line = line.removeprefix("/*") if not inside else line
            before, end, after = line.partition("*/")
            lines.append(before)
            inside = not end
            if after.strip():
                break
        elif line and not line.startswith("#version"):
            break
        else:
            lines.append("")
    return lines
