"""Set a file of what is remembered aside where it cannot be read, before a new one takes its place."""

from __future__ import annotations

from pathlib import Path

from playground.errors import PlaygroundError
from playground.files import new_name


def set_aside(path: Path, what: str, error: Exception) -> str:
    """Rename a file to ``NAME.unread.json``, numbered where that is taken; return a message that reports it.

    ``what`` was remembered in it, as the sentence begins; ``error`` is why it cannot be read.
    """
    why = f" ({error})" if str(error) else ""
    try:
        with new_name(path.with_suffix(".unread.json")) as aside:
            path.replace(aside)
    except (OSError, PlaygroundError):
        return f"{what} cannot be read and cannot be set aside: {path}{why}"
    return f"{what} cannot be read; it is kept in {aside}{why}"
