"""Show the lines around a mistake with their numbers, cut so that they fit, the column visible."""

from __future__ import annotations

from playground.paths import current_folder

_BEFORE = 0.6  # share of the room that may lie before the column


def numbered(lines: list[tuple[int, str]], wrong: int, column: int, room: int) -> tuple[list[str], int]:
    """Return (lines of a file as rows, a mark below the wrong one's column; which row is wrong, from 0).

    ``lines`` are (number, text); ``wrong`` is a number, ``column`` counts from 1, 0 where it is
    unknown; rows have about ``room`` characters. What all lines are indented by goes, tabs become
    four spaces, and long lines are moved to the left together until the column is visible.
    """
    digits = len(str(lines[-1][0]))
    texts = {number: text.rstrip().expandtabs(4) for number, text in lines}
    indent = min((len(text) - len(text.lstrip()) for text in texts.values() if text), default=0)
    raw = dict(lines).get(wrong, "")
    mark = max(len(raw[: column - 1].expandtabs(4)) - indent, 0) if column else -1
    room = max(room - digits - 3, 8)
    longest = max(len(text) for text in texts.values()) - indent
    shift = 0
    if mark > room * _BEFORE and longest > room:
        shift = min(mark - int(room * _BEFORE), longest - room + 1)
    rows: list[str] = []
    at = 0
    for number, whole in texts.items():
        text = whole[indent:]
        if shift and text:
            text = f"…{text[shift + 1 :]}"
        if len(text) > room:
            text = f"{text[: room - 1]}…"
        if number == wrong:
            at = len(rows)
        rows.append(f"{number:>{digits}} | {text}".rstrip())
        if number == wrong and mark >= 0:
            rows.append(f"{' ' * digits} | {' ' * (mark - shift)}^")
    return rows, at


def short_place(location: str, folder: str) -> str:
    """Return "file:line:column" with the file named from a folder, if it lies in there."""
    name, colon, rest = location.partition(":") if not location[1:3] == ":\\" else (location, "", "")
    path = current_folder() / name
    if folder and path.is_relative_to(folder):
        return path.relative_to(folder).as_posix() + colon + rest
    return location
