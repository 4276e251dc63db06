"""Save a picture under a name that nothing has yet."""

from __future__ import annotations

import re
from itertools import count
from pathlib import Path

from playground.engine.frame import Frame
from playground.errors import DataError
from playground.paths import shown


def save_new(frame: Frame, folder: Path, name: str) -> Path:
    """Write a PNG ``name.png``, or ``name-2.png`` and so on, never over another file; return its path.

    Raises ``DataError`` where the folder cannot be written to.
    """
    stem = re.sub(r"[^\w.-]+", "-", name).strip("-.") or "picture"
    for number in count(1):
        path = folder / (f"{stem}.png" if number == 1 else f"{stem}-{number}.png")
        try:
            path.touch(exist_ok=False)  # the name is ours from here on
        except FileExistsError:
            continue
        except OSError as error:
            raise DataError(f"no picture can be saved here: {error.strerror}", file=shown(folder)) from None
        try:
            return frame.save(path, {"sketch": frame.sketch, "time": f"{frame.time:g}"})
        except BaseException:
            path.unlink(missing_ok=True)
            raise
    raise AssertionError("count() ends")
