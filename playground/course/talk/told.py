"""What the page of notes is notified of a beat, as JSON holds it; texts as HTML."""

from __future__ import annotations

from typing import Any

from playground.course.book.html import code_block, prose
from playground.course.language import labels
from playground.course.talk.beat import Beat
from playground.course.talk.presenter import Presenter
from playground.course.typeset import plain

_LABELS = ("notes", "following", "over", "pause", "go_on", "reset", "back", "next", "black", "lost")


def notes_message(presenter: Presenter, beat: Beat, following: Beat | None, language: str) -> dict[str, Any]:
    """Return what is on, with the beat's and the next one's texts; numbers are in them already."""
    clock, say = presenter.clock, labels("talk", language)
    return {
        "on": presenter.on,
        "language": language,
        "labels": {key: say[key] for key in _LABELS},
        "lesson": presenter.lesson.title if presenter.lesson else "",
        "at": presenter.at + 1,
        "count": len(presenter.beats),
        "heading": plain(beat.heading),
        "label": beat.label,
        "notes": html_of(beat),
        "aside": _html(beat.aside),
        "coming": _coming(following),
        "blank": presenter.blank,
        "elapsed": round(clock.elapsed, 1),
        "running": clock.running,
    }


def html_of(beat: Beat) -> str:
    """Return all that is notified of a beat, and what stands over its picture, as HTML."""
    parts = []
    if beat.choices and beat.board:
        parts.append(_html(beat.board))
    parts.append(_html(beat.notes or beat.shown))
    if beat.code is not None:
        parts.append(str(code_block(beat.code.text, beat.code.file or "code")))
    return "".join(parts)


def _coming(beat: Beat | None) -> str:
    if beat is None:
        return ""
    label = f"**{beat.label}.** " if beat.label else ""
    file = beat.code.file if beat.code is not None else ""
    return _html(f"{label}{beat.shown or beat.board or file}")


def _html(words: str) -> str:
    return str(prose(words, lambda to: {"class": "term"})) if words else ""
