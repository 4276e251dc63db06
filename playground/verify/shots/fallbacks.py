"""The table of whose references replace which renderer's, where that has none of its own.

    [tool.pytest.ini_options]
    shots_fallbacks = [
        "apple-* = llvmpipe",                 # by structure: real defects show, roundings do not
        "nvidia-a100 = nvidia-h200, pixels",  # as strictly as another build of the same renderer
    ]

Each line names renderers, as the folders of references are named (``*`` and ``?`` stand for any
letters), then the renderer whose references are taken, then how strictly: ``structure`` unless it
says ``pixels``. Of several lines for a renderer the first counts whose references are there.
A renderer that the table names may draw shots in place of the expected one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fnmatch import fnmatchcase

STRUCTURE, PIXELS = "structure", "pixels"


@dataclass(frozen=True, slots=True)
class Fallback:
    """One line of the table."""

    renderers: str  # a slug, or a pattern of slugs
    references: str  # slug of the renderer whose references stand in
    strictness: str  # `STRUCTURE` or `PIXELS`

    def __str__(self) -> str:
        return f"{self.renderers} = {self.references}, {self.strictness}"


def read_fallbacks(lines: Iterable[str]) -> tuple[Fallback, ...]:
    """Read the table; raise ``ValueError``, with a message, for a line that is not one of it."""
    fallbacks = []
    for line in lines:
        renderers, equals, rest = (part.strip() for part in line.partition("="))
        references, comma, strictness = (part.strip() for part in rest.partition(","))
        strictness = strictness if comma else STRUCTURE
        if not (equals and renderers and references):
            raise ValueError(f"{line!r}: expected 'RENDERER = RENDERER', as in 'apple-m1 = llvmpipe'")
        if strictness not in (STRUCTURE, PIXELS):
            raise ValueError(f"{line!r}: how strictly is {STRUCTURE} or {PIXELS}, not {strictness!r}")
        if any(letter in "*?[" for letter in references):
            raise ValueError(f"{line!r}: one renderer's references stand in; {references!r} is a pattern")
        if fnmatchcase(references, renderers):
            raise ValueError(f"{line!r}: a renderer's references do not stand in for its own")
        fallbacks.append(Fallback(renderers, references, strictness))
    return tuple(fallbacks)


def fallbacks_of(table: Iterable[Fallback], renderer: str) -> list[Fallback]:
    """Return the lines of the table for a renderer, a slug, in their order."""
    return [fallback for fallback in table if fnmatchcase(renderer, fallback.renderers)]


def fallback_for(
    table: Iterable[Fallback], renderer: str, has_references: Callable[[str], bool]
) -> Fallback | None:
    """Return the line that a renderer without references of its own is compared by.

    ``has_references`` says whether there are a renderer's. The first line where there are any; the
    first of all where there are none; None where the table does not name the renderer.
    """
    lines = fallbacks_of(table, renderer)
    return next((line for line in lines if has_references(line.references)), next(iter(lines), None))
