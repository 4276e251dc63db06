"""Find submissions of the same text: white space and comments aside, and what was handed out left out."""

from __future__ import annotations

from collections.abc import Mapping

from playground.course.handout.normalised import normalised


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
