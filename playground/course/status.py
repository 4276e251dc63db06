"""Find the state of a translation: missing, unmarked, stale, or current."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from playground.course.document import Document, read_document
from playground.course.library import lesson_file
from playground.course.translate import stale
from playground.errors import counted


@dataclass(frozen=True)
class Status:
    """The state of a translation."""

    name: str
    language: str
    state: str  # missing | unmarked | stale | current
    changed: tuple[int, ...] = ()  # lines of the English file
    added: tuple[int, ...] = ()
    removed: int = 0  # blocks

    @property
    def sentences(self) -> list[str]:
        """What there is to do, in English."""
        sentences_found = []
        if self.state == "unmarked":
            sentences_found.append(f"playground lesson translated {self.name} --lang {self.language}")
        for change, lines in (("changed", self.changed), ("new", self.added)):
            if lines:
                sentences_found.append(
                    f"{change}: line{'s' if len(lines) > 1 else ''} {', '.join(map(str, lines))}"
                )
        if self.removed:
            sentences_found.append(f"{counted(self.removed, 'block')} of it no longer in English")
        return sentences_found

    def as_json(self) -> dict[str, Any]:
        """Return it as JSON takes it."""
        return {
            "lesson": self.name,
            "language": self.language,
            "state": self.state,
            "changed_lines": list(self.changed),
            "new_lines": list(self.added),
            "removed_blocks": self.removed,
        }


def status_of(name: str, language: str) -> Status:
    """Return the state of a translation; raise ``SketchError`` for one that cannot be read."""
    path = lesson_file(name, language)
    if not path.is_file():
        return Status(name, language, "missing")
    english, other = read_document(lesson_file(name)), read_document(path)
    if not other.front.table.get("source"):
        return Status(name, language, "unmarked")
    lost = stale(english, other)
    if not lost.any:
        return Status(name, language, "current")
    return Status(
        name, language, "stale", _lines(english, lost.changed), _lines(english, lost.added), lost.removed
    )


def _lines(english: Document, indices: Sequence[int]) -> tuple[int, ...]:
    """Return the lines of blocks; the first index is that of title and goal."""
    return tuple(english.pieces[index - 1].line if index else 1 for index in indices)
