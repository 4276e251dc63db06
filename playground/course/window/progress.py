"""What is remembered of lessons from one start to the next: where each was left, and what was done for tasks.

One small JSON file in the user's state folder, written whole or not at all. Without it, or
where it cannot be read, lessons begin at their beginning; the window keeps the damaged file.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

from playground.errors import PlaygroundError
from playground.files import read_regular, write_file
from playground.json_text import read_json
from playground.paths import state_folder
from playground.sketch.model import Value
from playground.studio.edits.memory import set_aside
from playground.studio.language import tr

FORMAT = 1
WIDTH = 420.0
"""Of the panel at first, in units of scale 1."""
MIN_WIDTH, MAX_WIDTH = 300.0, 760.0
_MAX_BYTES = 2**24  # [bytes]
_UNREADABLE = OSError, ValueError, TypeError, KeyError, AttributeError, ArithmeticError


@dataclass
class Attempt:
    """What a student has done for a task that checks itself."""

    text: str = ""  # of its kernel; "": its starter
    values: dict[str, Value] = field(default_factory=dict)  # of its sliders, by path
    before: tuple[str, dict[str, Value]] | None = None  # text and values before it was begun again
    points: float = 0.0  # the most it had
    of: int = 0  # points that can be had
    score: float = 0.0  # of a challenge: the best, 0..100


@dataclass
class Progress:
    """The lesson, page and panel of a reader."""

    lesson: str = ""  # the one read last
    language: str = ""  # "": as the system says
    shown: bool = True  # the panel is on the screen
    width: float = WIDTH  # of the panel, in units of scale 1
    sections: dict[str, int] = field(default_factory=dict)  # the section each lesson was left at
    done: list[str] = field(default_factory=list)  # lessons that were read to their end
    attempts: dict[str, Attempt] = field(default_factory=dict)  # by "lesson/task"


def progress_file(folder: Path | None = None) -> Path:
    """Return where it is remembered, in the user's state folder unless another is named."""
    return (folder or state_folder()) / "lessons.json"


def read_progress(path: Path) -> Progress:
    """Return what is remembered; the beginning where nothing can be read. The file stays as it is."""
    try:
        return _whole(path)
    except _UNREADABLE:
        return Progress()


def open_progress(path: Path) -> tuple[Progress, str]:
    """Return what is remembered, to be written again, and a message if the file cannot be used.

    It is then set aside: what a student wrote may still be in it.
    """
    try:
        return _whole(path), ""
    except FileNotFoundError:
        return Progress(), ""
    except _UNREADABLE as error:
        return Progress(), set_aside(path, tr("what was remembered of lessons"), error)


def write_progress(progress: Progress, path: Path) -> str:
    """Write it; return a message where that cannot be done, else nothing."""
    table = asdict(replace(progress, attempts=_done(progress.attempts)))
    text = json.dumps({"format": FORMAT, **table}, indent=1, ensure_ascii=False)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        write_file(path, text.encode("utf-8", "surrogatepass"))
    except (OSError, PlaygroundError) as error:
        return tr("where you are in the lessons cannot be remembered: {error}", error=error)
    return ""


def _done(attempts: dict[str, Attempt]) -> dict[str, Attempt]:
    """Return the attempts at which something was done."""
    return {task: attempt for task, attempt in attempts.items() if attempt != Attempt()}


def _whole(path: Path) -> Progress:
    if path.stat().st_size > _MAX_BYTES:
        raise ValueError(f"it is larger than {_MAX_BYTES // 2**20} MiB")
    return _read(read_json(read_regular(path).decode()))


def _read(table: Any) -> Progress:
    if table["format"] != FORMAT:
        raise ValueError(f"its format is {table['format']!r}; expected {FORMAT}")
    width = float(table["width"])
    return Progress(
        str(table["lesson"]),
        str(table["language"]),
        bool(table["shown"]),
        min(max(width, MIN_WIDTH), MAX_WIDTH) if width == width else WIDTH,
        {str(name): max(int(at), 0) for name, at in table["sections"].items()},
        [str(name) for name in table["done"]],
        dict(_attempts(table.get("attempts", {}))),
    )


def _attempts(table: Any) -> Iterator[tuple[str, Attempt]]:
    """Yield the attempts that can be read: a damaged one takes no other with it."""
    for name, attempt in table.items():
        with suppress(ValueError, TypeError, KeyError, AttributeError, IndexError):
            yield str(name), _attempt(attempt)


def _attempt(table: Any) -> Attempt:
    before = table["before"]
    points, score = (float(table[key]) for key in ("points", "score"))
    return Attempt(
        str(table["text"]),
        _values(table["values"]),
        None if before is None else (str(before[0]), _values(before[1])),
        points if points == points else 0.0,
        int(table["of"]),
        score if score == score else 0.0,
    )


def _values(table: Any) -> dict[str, Value]:
    return {str(path): tuple(v) if isinstance(v, list) else v for path, v in table.items()}
