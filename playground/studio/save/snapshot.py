"""Save a picture under a name that nothing has yet."""

from __future__ import annotations

import re
from pathlib import Path

from playground.engine.frame import Frame
from playground.files import new_name


def save_new(frame: Frame, folder: Path, name: str) -> Path:
    """Write a PNG ``name.png``, or ``name-2.png`` and so on, never over another file; return its path.

    Raises ``DataError`` where the folder cannot be written to.
    """
    stem = re.sub(r"[^\w.-]+", "-", name).strip("-.") or "picture"
    with new_name(folder / f"{stem}.png") as path:
        return frame.save(path, {"sketch": frame.sketch, "time": f"{frame.time:g}"})
