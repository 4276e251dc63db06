"""Make the standard streams usable: closed ones, and those whose encoding lacks what is printed.

What an encoding lacks is spelled in ASCII, as "->". A stream that was closed before the start
discards everything, and so does one whose reader has closed the pipe, after ``flush_or_discard``.
"""

from __future__ import annotations

import codecs
import io
import os
import sys
import unicodedata
from typing import TextIO

_SPELLED = "playground.spelled"  # the name of the error handler of encodings
_ASCII = {
    **{"→": "->", "←": "<-", "↔": "<->", "⇒": "=>", "…": "...", "×": "x", "·": "-", "•": "*", "−": "-"},
    **{"–": "-", "—": "-", "‘": "'", "’": "'", "“": '"', "”": '"'},
    **{"°": " deg", "±": "+-", "≤": "<=", "≥": ">="},
}


class Nowhere(io.TextIOWrapper):
    """The replacement of a standard stream that was closed."""

    def __init__(self, number: int) -> None:
        super().__init__(os.fdopen(number, "rb" if number == 0 else "wb", closefd=False), "utf-8", "replace")


def open_streams() -> None:
    """Replace standard streams that are closed, and have all spell what their encoding lacks."""
    for number, name in enumerate(("stdin", "stdout", "stderr")):
        if getattr(sys, name) is None:
            _hold(number)
            setattr(sys, name, Nowhere(number))
    codecs.register_error(_SPELLED, spelled)
    for stream in (sys.stdout, sys.stderr):
        is_strict = getattr(stream, "errors", "") in ("strict", "surrogateescape", "backslashreplace")
        if is_strict and isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors=_SPELLED)


def _hold(number: int) -> None:
    """Open a closed file number to nowhere: a file that got it would be printed into."""
    try:
        os.fstat(number)
    except OSError:
        nowhere = os.open(os.devnull, os.O_RDWR)
        if nowhere != number:
            os.dup2(nowhere, number)
            os.close(nowhere)


def spelled(error: UnicodeError) -> tuple[str | bytes, int]:
    """Spell a character that an encoding lacks in ASCII; bytes of a file's name stay what they are.

    The signature and the tuple are those of an error handler of ``codecs``.
    """
    if not isinstance(error, UnicodeEncodeError):
        raise error
    character, after = error.object[error.start], error.start + 1
    if "\udc80" <= character <= "\udcff":  # a byte of a name that is no text (PEP 383)
        return bytes([ord(character) - 0xDC00]), after
    plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode("ascii")
    escaped = character.encode("ascii", "backslashreplace").decode("ascii")
    return _ASCII.get(character) or plain or escaped, after


def flush_or_discard(stream: TextIO) -> None:
    """Write what a stream still holds; where its reader is gone, discard that and what follows."""
    try:
        stream.flush()
    except (OSError, ValueError):
        nowhere = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nowhere, stream.fileno())
        os.close(nowhere)
