"""Find submissions of the same text: white space and comments aside, and what was handed out left out."""

from __future__ import annotations

import re
from collections.abc import Mapping

_COMMENT = re.compile(r"//(?:\\\n|[^\n])*|/\*.*?(?:\*/|\Z)", re.DOTALL)
_TOKEN = re.compile(r"\w+|[^\w\s]")


def normalised(text: str) -> str:
    """Return a text as its tokens, without comments and without how it is laid out."""
    return " ".join(_TOKEN.findall(_COMMENT.sub(" ", text)))


def alike(texts: Mapping[str, str], handed_out: str) -> dict[str, tuple[str, ...]]:
    """Return for each student those who handed in the same text; what was handed out is no text of theirs."""
    groups: dict[str, list[str]] = {}
    for student, text in texts.items():
        groups.setdefault(normalised(text), []).append(student)
    for nobodys in ("", normalised(handed_out)):
        groups.pop(nobodys, None)
    return {
        student: tuple(other for other in group if other != student)
        for group in groups.values()
        if len(group) > 1
        for student in group
    }
