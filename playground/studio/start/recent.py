"""The sketches that were opened last, each with its last picture, in the user's state folder.

``recent.json`` lists their files, the last first; pictures are files of their own beside it. What cannot be
read or written is left out: nothing else depends on it.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.errors import PlaygroundError
from playground.files import read_regular, write_file
from playground.json_text import read_json
from playground.paths import state_folder
from playground.studio.start.thumbnails import shrunk

_MOST = 12
_FORMAT = 1


@dataclass(frozen=True)
class RecentSketch:
    """A sketch that was opened, and its last picture where there is one."""

    path: Path
    title: str
    picture: Path | None


class Recent:
    """The list in a state folder, the user's unless another is named."""

    def __init__(self, folder: Path | None = None) -> None:
        self._folder = folder or state_folder()
        self._file = self._folder / "recent.json"

    def sketches(self) -> list[RecentSketch]:
        """Return those whose files are still there, the last one first."""
        return [
            RecentSketch(path, title, picture if (picture := self._picture(path)).is_file() else None)
            for path, title in self._read()
            if path.exists()
        ]

    def note(self, path: Path, title: str, pixels: NDArray[np.uint8] | None = None) -> None:
        """Put a sketch first; ``pixels``: its picture, (height, width, 3 or 4), top row first."""
        path = path.absolute()
        rows = [(path, title), *(row for row in self._read() if row[0] != path)]
        gone = rows[_MOST:]
        text = json.dumps(
            {"format": _FORMAT, "sketches": [{"path": str(p), "title": t} for p, t in rows[:_MOST]]}
        )
        with contextlib.suppress(OSError, PlaygroundError):
            self._folder.mkdir(parents=True, exist_ok=True)
            write_file(self._file, text)
            for old, _ in gone:
                self._picture(old).unlink(missing_ok=True)
            if pixels is not None:
                self._store(path, pixels)

    def _store(self, path: Path, pixels: NDArray[np.uint8]) -> None:
        from PIL import Image

        file = self._picture(path)
        file.parent.mkdir(parents=True, exist_ok=True)
        shrunk(Image.fromarray(np.ascontiguousarray(pixels[..., :3]))).save(file, quality=85)

    def _picture(self, path: Path) -> Path:
        name = hashlib.blake2b(str(path).encode(), digest_size=12).hexdigest()
        return self._folder / "recent" / f"{name}.jpg"

    def _read(self) -> list[tuple[Path, str]]:
        try:
            table = read_json(read_regular(self._file).decode())
            rows = table["sketches"] if table["format"] == _FORMAT else []
            return [(Path(row["path"]), str(row["title"])) for row in rows][:_MOST]
        except (OSError, ValueError, TypeError, KeyError, PlaygroundError):
            return []
