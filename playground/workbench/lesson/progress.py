"""What is remembered of lessons from one start to the next: where each was left, and how the panel stood.

One small JSON file in the user's state folder, written whole or not at all. Without it, or
where it cannot be read, lessons begin at their beginning.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from playground.errors import PlaygroundError
from playground.folders import state_folder
from playground.images.files import replacing
from playground.json_text import read_json

FORMAT = 1
WIDTH = 420.0
"""Of the panel at first, in units of scale 1."""
NARROWEST, WIDEST = 300.0, 760.0
_LARGEST = 2**20  # [bytes]


@dataclass
class Progress:
    """The lesson, page and panel of a reader."""

    lesson: str = ""  # the one read last
    language: str = ""  # "": as the system says
    shown: bool = True  # the panel is on the screen
    width: float = WIDTH  # of the panel, in units of scale 1
    sections: dict[str, int] = field(default_factory=dict)  # the section each lesson was left at
    done: list[str] = field(default_factory=list)  # lessons that were read to their end


def progress_file(folder: Path | None = None) -> Path:
    """Return where it is remembered, in the user's state folder unless another is named."""
    return (folder or state_folder()) / "lessons.json"


def read_progress(path: Path) -> Progress:
    """Return what is remembered; the beginning where nothing can be read."""
    try:
        if path.stat().st_size > _LARGEST:
            return Progress()
        return _read(read_json(path.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return Progress()


def write_progress(progress: Progress, path: Path) -> str:
    """Write it; return a sentence where that cannot be done, else nothing."""
    text = json.dumps({"format": FORMAT, **asdict(progress)}, indent=1, ensure_ascii=False)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with replacing(path) as file:
            file.write(text.encode("utf-8", "surrogatepass"))
    except (OSError, PlaygroundError) as error:
        return f"where you are in the lessons cannot be remembered: {error}"
    return ""


def _read(table: Any) -> Progress:
    if table["format"] != FORMAT:
        raise ValueError
    width = float(table["width"])
    return Progress(
        str(table["lesson"]),
        str(table["language"]),
        bool(table["shown"]),
        min(max(width, NARROWEST), WIDEST) if width == width else WIDTH,
        {str(name): max(int(at), 0) for name, at in table["sections"].items()},
        [str(name) for name in table["done"]],
    )
