"""How large text, margins and panels are drawn, by the user's wish: over the screen's own scale, remembered.

One small JSON file in the user's state folder, the same for every sketch. Where it cannot be
read or written, the size is that of the screen, and nothing else is lost.
"""

from __future__ import annotations

import contextlib
import json
from dataclasses import dataclass
from pathlib import Path

from playground.errors import PlaygroundError
from playground.folders import state_folder
from playground.images.files import replacing

SIZES = (0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0)
"""What the keys go through; 1 is as large as the screen says."""

FORMAT = 1
_LARGEST = 2**16  # [bytes]


@dataclass
class InterfaceSize:
    """The size of the moment, and where it is remembered."""

    size: float = 1.0
    file: Path | None = None  # None: nowhere

    def step(self, by: int) -> None:
        """Go to the next larger size, or with -1 to the next smaller one; at the ends it stays."""
        nearest = min(range(len(SIZES)), key=lambda at: abs(SIZES[at] - self.size))
        self.choose(SIZES[min(max(nearest + by, 0), len(SIZES) - 1)])

    def choose(self, size: float) -> None:
        """Take a size, and remember it where that can be done."""
        if size == self.size:
            return
        self.size = size
        if self.file is None:
            return
        text = json.dumps({"format": FORMAT, "size": size})
        with contextlib.suppress(OSError, PlaygroundError):
            self.file.parent.mkdir(parents=True, exist_ok=True)
            with replacing(self.file) as file:
                file.write(text.encode())


def remembered_size(folder: Path | None = None) -> InterfaceSize:
    """Return the size that was chosen last, in the user's state folder unless another is named."""
    file = (folder or state_folder()) / "interface.json"
    try:
        if file.stat().st_size > _LARGEST:
            return InterfaceSize(file=file)
        table = json.loads(file.read_text(encoding="utf-8"))
        size = float(table["size"]) if table["format"] == FORMAT else 1.0
    except (OSError, ValueError, TypeError, KeyError, OverflowError, RecursionError):
        return InterfaceSize(file=file)
    return InterfaceSize(size if size in SIZES else 1.0, file)
