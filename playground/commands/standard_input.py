"""A sketch called "-": a shader's text from standard input, or for the window from the clipboard."""

from __future__ import annotations

import sys
from collections.abc import Callable
from pathlib import Path

from playground.errors import DataError, ParameterError, PlaygroundError
from playground.paths import current_folder, shown
from playground.terminal import note

NAME = "-"


def kept(sketch: str, command: str, clipboard: Callable[[], str] | None = None) -> str:
    """Return what to open: ``sketch`` itself, or for "-" the new file that a shader's text is kept in.

    The text is standard input's; where that is a terminal, it is what ``clipboard`` gives. Raises
    ``ParameterError`` where there is neither, and as ``keep_text``.
    """
    if sketch != NAME:
        return sketch
    from playground.sketch.pasted import keep_text

    name = "standard input"
    if not sys.stdin.isatty():
        text = _read()
    elif clipboard is not None:
        name, text = "the clipboard", clipboard()
    else:
        message = (
            f"- reads a shader's text, and standard input is the terminal: playground {command} - < x.frag"
        )
        raise ParameterError(message)
    try:
        path = keep_text(text, current_folder())
    except PlaygroundError as error:
        raise type(error)(f"{name}: {error.diagnostics[0].message}") from None
    note(f"the text of {name} is kept as {shown(path)}")
    return str(path)


def kept_path(path: Path, command: str) -> Path:
    """Return a path to read: itself, or for "-" that of the file that standard input is kept in."""
    return Path(kept(str(path), command))


def _read() -> str:
    from playground.sketch.pasted import MAX_PASTED_BYTES

    data = sys.stdin.buffer.read(MAX_PASTED_BYTES + 1)
    if len(data) > MAX_PASTED_BYTES:
        raise DataError(
            f"standard input is larger than {MAX_PASTED_BYTES // 2**20} MiB; a shader's text was expected"
        )
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise DataError("standard input is no UTF-8 text; a shader's text was expected") from None
