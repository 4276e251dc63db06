"""What of the interface is shown: panel, key map, search; how large it is drawn; a field about to open.

The size is remembered in one small JSON file in the user's state folder, the same for every sketch.
Where it cannot be read or written, the size is that of the screen, and nothing else is lost.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import PlaygroundError
from playground.files import read_regular, write_file
from playground.json_text import read_json
from playground.paths import state_folder
from playground.studio.notices import Notices

SIZES = (0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0)
"""What the keys go through; 1 is as large as the screen says."""

FORMAT = 1
_MAX_BYTES = 2**16  # [bytes]


@dataclass
class InterfaceSize:
    """The current size, and where it is remembered."""

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
            write_file(self.file, text)


def remembered_size(folder: Path | None = None) -> InterfaceSize:
    """Return the size that was chosen last, in the user's state folder unless another is named."""
    file = (folder or state_folder()) / "interface.json"
    try:
        if file.stat().st_size > _MAX_BYTES:
            return InterfaceSize(file=file)
        table = read_json(read_regular(file).decode())
        size = float(table["size"]) if table["format"] == FORMAT else 1.0
    except (OSError, ValueError, TypeError, KeyError, OverflowError):
        return InterfaceSize(file=file)
    return InterfaceSize(size if size in SIZES else 1.0, file)


@dataclass
class TypedAhead:
    """What is typed while a field that was opened has not taken the keys yet."""

    frames: int = 0  # in which that field may still take them
    text: str = ""


@dataclass
class Interface:
    """What of one window's interface is shown."""

    panel_shown: bool = True
    keymap_shown: bool = False
    searching: bool = False  # the panel is to give its search the keys
    reveal: str = ""  # the pass that the panel is to scroll to
    size: InterfaceSize = field(default_factory=InterfaceSize)
    ahead: TypedAhead = field(default_factory=TypedAhead)

    def show_pass(self, name: str) -> None:
        """Show the panel, scrolled to a pass."""
        self.panel_shown, self.reveal = True, name

    def toggle_panel(self) -> None:
        """Hide the panel, or show it again."""
        self.panel_shown = not self.panel_shown

    def search(self) -> None:
        """Show the panel, and give its search the keys."""
        self.panel_shown = self.searching = True

    def toggle_keymap(self) -> None:
        """Show what every key does, or no longer."""
        self.keymap_shown = not self.keymap_shown


def resize(size: InterfaceSize, by: int, notices: Notices) -> None:
    """Draw text and panels larger, smaller, or with 0 as large as the screen says; say how large."""
    if by:
        size.step(by)
    else:
        size.choose(1.0)
    what = "text and panels at"
    notices.drop(what)
    notices.say(f"{what} {size.size:.0%}")


@dataclass
class WindowControls:
    """What the interface asks of the window that it is in."""

    quit: Callable[[], None]
    toggle_full: Callable[[], None] = lambda: None  # fills the screen, or no longer
    is_full: Callable[[], bool] = lambda: False
    sign_held: Callable[[], str] = lambda: ""  # "+" or "-" where this keyboard's key for it is down
