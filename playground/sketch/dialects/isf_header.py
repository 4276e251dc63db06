"""Read the JSON comment that an ISF shader begins with, and know where in the file each thing stands.

Authors write it by hand: tabs in texts, commas after the last item, comments and numbers as ``.5`` are read.
"""

from __future__ import annotations

import json
import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Any

from playground.errors import Diagnostic, ShaderError, nearest
from playground.json_text import long_number
from playground.paths import shown
from playground.sketch.source import Line, SourceText

_BEGIN = re.compile(r"(?:\s|//[^\n]*\n)*/\*\s*(?=\{)")
_LENIENT = re.compile(
    r'(?P<text>"(?:[^"\\]|\\.)*")'
    r"|(?P<comment>//[^\n]*)"
    r"|(?P<comma>,)(?=(?:\s|//[^\n]*)*[}\]])"
    r"|(?P<number>(?<![\w.])[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)",
    re.DOTALL,
)
_TRUE = ("true", "yes", "on", "1")


@dataclass(frozen=True)
class Header:
    """What an ISF shader says of itself."""

    table: Mapping[str, Any]
    text: str  # of the file, up to the header's end
    lines: tuple[Line, ...]  # of the file, without those of its includes

    def line_of(self, word: str, after: str = "") -> Line:
        """Return the line of a key or a text in quotes, the first ``after`` another; else the first line."""
        start = self.text.find(f'"{after}"') if after else 0
        place = self.text.find(f'"{word}"', max(start, 0))
        return self.lines[self.text.count("\n", 0, place)] if place >= 0 else self.lines[0]

    def line_of_input(self, name: str) -> Line:
        """Return the line that names an input, an image or a buffer."""
        found = re.search(rf'"(?:NAME|TARGET)"\s*:\s*"{re.escape(name)}"', self.text)
        return self.lines[self.text.count("\n", 0, found.end())] if found else self.line_of(name)

    def items(self, key: str, *, named: bool = False) -> list[dict[str, Any]]:
        """Return the objects that a key lists; where they may be ``named``, of an object its values too.

        Raises ``ShaderError`` for anything else.
        """
        found = self.table.get(key) or []
        if named and isinstance(found, Mapping):
            found = [
                {"NAME": name, **(value if isinstance(value, Mapping) else {"PATH": value})}
                for name, value in found.items()
            ]
        if named and isinstance(found, list):
            found = [{"NAME": one} if isinstance(one, str) else one for one in found]
        if not isinstance(found, list) or not all(isinstance(one, Mapping) for one in found):
            raise self.line_of(key).error(f"{key}: expected a list of objects, as [{{…}}, {{…}}]")
        return [dict(one) for one in found]

    def text_of(self, key: str) -> str:
        """Return a text of the header on one line, "" where there is none."""
        found = self.table.get(key)
        return " ".join(found.split()) if isinstance(found, str) else ""

    def unknown(self, found: Collection[str], known: Collection[str], what: str) -> Diagnostic | None:
        """Return a warning of keys that mean nothing, with the nearest of the ``known`` ones."""
        strange = [key for key in found if key not in known]
        if not strange:
            return None
        hint = nearest(strange[0].upper(), known)
        hint = hint if "did you mean" in hint else ""
        message = f"{', '.join(strange)} of {what} means nothing here, and is left out{hint}"
        return self.line_of(strange[0]).diagnostic(message, severity="warning")


def read_header(source: SourceText) -> Header:
    """Return the header of a shader; raise ``ShaderError`` at the line and column of a mistake in it."""
    lines = tuple(line for line in source.lines if not line.chain)
    whole = "\n".join(line.text for line in lines).removeprefix("\ufeff")
    begin = _BEGIN.match(whole)
    end = whole.find("*/")
    if begin is None or end < 0:
        message = "an ISF shader begins with its description, a comment that holds JSON, as /*{ … }*/"
        raise lines[0].error(message)
    text = whole[:end]
    start = begin.end()
    lenient = text[:start] + _LENIENT.sub(_strict, text[start:])
    try:
        table, _ = json.JSONDecoder(strict=False).raw_decode(lenient, start)
    except (ValueError, RecursionError) as error:
        raise _wrong(error, lenient, lines) from None
    return Header(table, text, lines)


def is_true(value: object) -> bool:
    """Return whether a flag is set: true, a number above 0, "true"."""
    if isinstance(value, str):
        return value.strip().lower() in _TRUE
    return isinstance(value, int | float) and value > 0


def number_of(value: object) -> float | None:
    """Return a number, also one that is written as a text; None for anything else."""
    try:
        found = float(value) if isinstance(value, int | float | str) else None
    except (ValueError, OverflowError):
        return None
    return found if found is not None and abs(found) < 1e30 else None


def numbers_of(value: object, count: int) -> tuple[float, ...] | None:
    """Return so many numbers of a list; None for anything else."""
    if not isinstance(value, list) or len(value) < count:
        return None
    found = [number_of(one) for one in value[:count]]
    return tuple(one for one in found if one is not None) if None not in found else None


def _strict(found: re.Match[str]) -> str:
    """Return what JSON has in place of what authors write, in the same columns where there is room."""
    word = found.group()
    if found.group("comment") or found.group("comma"):
        return " " * len(word)
    if not found.group("number"):
        return word
    sign, rest = ("-" if word[0] == "-" else ""), word.lstrip("+-")
    whole, point, after = rest.partition(".")
    if point and not after[:1].isdigit():
        after = f"0{after}"
    return f"{sign}{whole.lstrip('0') or '0'}{point}{after}"


def _wrong(error: ValueError | RecursionError, text: str, lines: tuple[Line, ...]) -> ShaderError:
    if isinstance(error, RecursionError):
        return lines[0].error("the description nests too deeply to be read")
    if not isinstance(error, json.JSONDecodeError):
        message, _, at = long_number(text, error)
        line = lines[text.count("\n", 0, at)]
        return ShaderError(f"the description holds {message}", file=shown(line.file), line=line.number)
    at = min(error.pos, len(text.rstrip()))
    line = lines[text.count("\n", 0, at)]
    found = text[at : at + 1]
    what = f"found '{found}'" if found.strip() else "it ends here"
    message = f"the description is not JSON: {error.msg[:1].lower()}{error.msg[1:]}, {what}"
    return line.error(message, at - (text.rfind("\n", 0, at) + 1) + 1)
