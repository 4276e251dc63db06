"""Cut an offending line so that it fits, with its column in sight."""

from __future__ import annotations

from pathlib import Path

_BEFORE = 0.6  # share of the room that may lie before the column


def cut(line: str, column: int, room: int) -> tuple[str, int]:
    """Return (the line without its indentation, cut to ``room`` characters; where its column is, from 0).

    ``column`` counts from 1; with 0 there is none, and -1 comes back. Tabs become four spaces.
    """
    whole = line.rstrip().expandtabs(4)
    indent = len(whole) - len(whole.lstrip())
    text = whole[indent:]
    mark = max(len(line[: column - 1].expandtabs(4)) - indent, 0) if column else -1
    room = max(room, 8)
    if len(text) <= room:
        return text, mark
    start = 0
    if mark > room * _BEFORE:
        start = min(mark - int(room * _BEFORE), len(text) - room + 1)
        text, mark = "…" + text[start + 1 :], mark - start
    if len(text) > room:
        text = text[: room - 1] + "…"
    return text, mark


def short_place(place: str, folder: str) -> str:
    """Return "file:line:column" with the file named from a folder, if it lies in there."""
    name, colon, rest = place.partition(":") if not place[1:3] == ":\\" else (place, "", "")
    path = Path.cwd() / name
    if folder and path.is_relative_to(folder):
        return path.relative_to(folder).as_posix() + colon + rest
    return place
