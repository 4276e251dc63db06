"""Read calls as they are written in a ``//!`` annotation or in the brackets of a ``#pragma``.

``slider(0, 1) step(0.01) The tooltip`` becomes calls with their arguments, and a tooltip.
Which calls there are, and what their arguments mean, is known elsewhere.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass

from playground.errors import ShaderError, nearest
from playground.sketch.source import Line

_ARGUMENT = re.compile(r'\s*(?:(\w+)\s*=\s*)?("(?:[^"\\]|\\.)*"|[^,()"]+)\s*(,|$)')
_WORD = re.compile(r"\s*([A-Za-z_]\w*)(\s*\()?")
_STRING = re.compile(r'"(?:[^"\\]|\\.)*"')

Argument = tuple[str, str]
"""A name, "" where there is none, and a text."""


@dataclass(frozen=True, slots=True)
class Note:
    """The text of one annotation, and the lines that it is on."""

    text: str
    lines: tuple[tuple[int, Line], ...]  # where in the text each line's part begins, and that line

    def line_at(self, position: int) -> Line:
        """Return the line that a position of the text is on."""
        return next(line for start, line in reversed(self.lines) if start <= position)

    def error(self, message: str, word: str, position: int) -> ShaderError:
        """Return an error that points at a word of the note, at or before a position."""
        line = self.line_at(position)
        return line.error(message, line.text.find(word) + 1)


def note_at(lines: Sequence[Line], index: int) -> Note:
    """Return the annotation that begins on a line, with the lines after it that hold ``//!`` alone."""
    text, found = "", list[tuple[int, Line]]()
    for line in lines[index:]:
        goes_on = not line.code and line.file == lines[index].file and line.chain == lines[index].chain
        if not line.comment.startswith("!") or (found and not goes_on):
            break
        text += " " if found else ""
        found.append((len(text), line))
        text += line.comment[1:].strip()
    return Note(text, tuple(found) or ((0, lines[index]),))


def arguments(text: str, line: Line) -> list[Argument]:
    """Split the text in brackets at its commas; texts lose their quotes. Raises ``ShaderError``."""
    found: list[Argument] = []
    position, end = 0, len(text.rstrip())
    while position < end:
        match = _ARGUMENT.match(text, position, end)
        if not match or not match.group(2).strip():
            rest = text[position:end].strip()
            raise line.error(f"cannot read '{rest}'; expected values separated by commas, text in quotes")
        raw = match.group(2).strip()
        if raw.startswith('"'):
            raw = re.sub(r"\\(.)", r"\1", raw[1:-1])
        found.append((match.group(1) or "", raw))
        position = match.end()
    return found


def calls(note: Note, words: Collection[str], bare: Collection[str]) -> tuple[dict[str, list[str]], str]:
    """Return (the calls of a note with their arguments, the tooltip that follows them).

    ``words`` may be called; those of ``bare`` need no brackets as the first word.
    Raises ``ShaderError`` for a word in brackets that is nearly one of ``words``.
    """
    found: dict[str, list[str]] = {}
    position = 0
    while match := _WORD.match(note.text, position):
        word, opens, start = match.group(1), bool(match.group(2)), match.start(1)
        if word not in words:
            hint = nearest(word, words) if opens else ""
            if opens and (position == 0 or "did you mean" in hint):
                raise note.error(f"no widget '{word}'{hint}", word, start)
            break
        if not opens:
            if position or word not in bare:
                break
            found[word] = []
            position = match.end()
            continue
        if word in found:
            raise note.error(f"'{word}' appears twice", word, start)
        end = _closing(note.text, match.end())
        if end < 0:
            raise note.error(f"'{word}(' is not closed", word, start)
        pairs = arguments(note.text[match.end() : end], note.line_at(start))
        for name, _ in pairs:
            if name:
                raise note.error(f"{word}() takes no '{name} ='", word, start)
        found[word] = [value for _, value in pairs]
        position = end + 1
    return found, note.text[position:].strip()


def _closing(text: str, position: int) -> int:
    """Return where a bracket closes, brackets in quotes apart; -1 if it does not."""
    while position < len(text):
        if text[position] == ")":
            return position
        string = _STRING.match(text, position)
        position = string.end() if string else position + 1
    return -1
