"""What of the interface is shown: panel, key map, search; how it looks; a field about to open.

Size, colours, language and layout are remembered in one small JSON file in the user's state folder, the same
for every sketch. Where it cannot be read or written they are those of the screen and the system, and nothing
else is lost.
"""

from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import PlaygroundError
from playground.files import read_regular, write_file
from playground.json_text import read_json
from playground.paths import state_folder
from playground.studio.language import numeral, tr
from playground.studio.notices import Notices

if TYPE_CHECKING:
    from playground.studio.theme import Theme

SIZES = (0.6, 0.7, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0)
"""What the keys go through; 1 is as large as the screen says."""

HINTS = {"?": "all keys", "O": "new, open, examples", "Ctrl+E": "code beside the picture"}
"""What the line at the picture's bottom names until one has used it, key → what for."""

FORMAT = 1
_MAX_BYTES = 2**16  # [bytes]
_MAX_SIZE = 1e4  # of a pane


@dataclass
class Preferences:
    """How the interface looks, and where that is remembered."""

    size: float = 1.0
    is_light: bool = False
    language: str = ""  # "": the system's
    is_in_feet: bool = False  # lengths of the terrain, else in metres
    panes: dict[str, float] = field(default_factory=dict)  # what ``Panes`` remembers, by name
    shows_readout: bool = True  # frames a second in the picture's corner
    used_keys: tuple[str, ...] = ()  # of ``HINTS``
    file: Path | None = None  # None: nowhere

    def step(self, by: int) -> None:
        """Go to the next larger size, or with -1 to the next smaller one; at the ends it stays."""
        nearest = min(range(len(SIZES)), key=lambda at: abs(SIZES[at] - self.size))
        self.choose(size=SIZES[min(max(nearest + by, 0), len(SIZES) - 1)])

    @property
    def hints(self) -> list[str]:
        """The keys of ``HINTS`` that have not been used yet."""
        return [key for key in HINTS if key not in self.used_keys]

    def use_key(self, name: str) -> None:
        """Take a key out of the hints."""
        if name in self.hints:
            self.choose(used_keys=(*self.used_keys, name))

    def choose(self, **changes: object) -> None:
        """Set some of the fields, and remember them where that can be done."""
        if all(getattr(self, name) == value for name, value in changes.items()):
            return
        for name, value in changes.items():
            setattr(self, name, value)
        if self.file is None:
            return
        remembered = {name: getattr(self, name) for name in _REMEMBERED}
        with contextlib.suppress(OSError, PlaygroundError):
            self.file.parent.mkdir(parents=True, exist_ok=True)
            write_file(self.file, json.dumps({"format": FORMAT, **remembered}))


_REMEMBERED = ("size", "is_light", "language", "is_in_feet", "panes", "shows_readout", "used_keys")


def remembered_preferences(folder: Path | None = None) -> Preferences:
    """Return what was chosen last, in the user's state folder unless another is named.

    A field that the file does not have, or has with another type, is as delivered.
    """
    file = (folder or state_folder()) / "interface.json"
    preferences = Preferences(file=file)
    try:
        if file.stat().st_size > _MAX_BYTES:
            return preferences
        table = read_json(read_regular(file).decode())
        if not isinstance(table, dict) or table.get("format") != FORMAT:
            return preferences
    except (OSError, ValueError, PlaygroundError):
        return preferences
    if table.get("size") in SIZES:
        preferences.size = float(table["size"])
    for name in ("is_light", "language", "is_in_feet", "shows_readout"):
        if isinstance(table.get(name), type(getattr(preferences, name))):
            setattr(preferences, name, table[name])
    used = table.get("used_keys")
    preferences.used_keys = tuple(key for key in HINTS if isinstance(used, list) and key in used)
    panes = table.get("panes")
    if isinstance(panes, dict):
        preferences.panes = {name: float(v) for name, v in panes.items() if _is_size(v)}
    return preferences


def _is_size(value: object) -> bool:
    return isinstance(value, int | float) and abs(value) <= _MAX_SIZE  # no NaN, nor what no float holds


@dataclass(frozen=True)
class Tab:
    """One tab of the strip; ``draw`` draws it in the current window."""

    name: str  # by which it is opened and remembered
    title: str  # in English; ``tr`` translates it
    draw: Callable[[Theme], None]
    badge: Callable[[], str] = lambda: ""  # behind its title, as "(1)"


@dataclass
class Panes:
    """The code pane and the strip below the picture: whether they are open, and how large."""

    preferences: Preferences
    selects: str = ""  # the tab that the strip is to show
    tab: str = ""  # the one that it showed last
    has_code: bool = False  # there is something to show in the code pane
    is_narrow: bool = False  # the window: the code takes the picture's place
    stretches: tuple[str, int] = ("", 0)  # the pane that keys make larger, by so many steps

    def is_open(self, name: str, *, narrow: bool) -> bool:
        """Return whether "code" or "strip" is open; as delivered they are, but in a narrow window."""
        chosen = self.preferences.panes.get(name)
        return not narrow if chosen is None else bool(chosen)

    @property
    def code_is_open(self) -> bool:
        """Whether the code pane is seen."""
        return self.has_code and self.is_open("code", narrow=self.is_narrow)

    def show_code(self, shown: bool = True) -> None:
        """Open the code pane, or close it."""
        self.remember("code", float(shown))

    def show_strip(self, tab: str = "", shown: bool = True) -> None:
        """Open the strip at a tab, or close it."""
        self.remember("strip", float(shown))
        self.selects = tab or self.selects

    def toggle_strip(self, tab: str) -> None:
        """Open the strip at a tab, or close it where it shows that one."""
        self.show_strip(tab, shown=not self.shows(tab))

    def shows(self, tab: str) -> bool:
        """Return whether the strip is open at a tab."""
        return self.tab == tab and self.is_open("strip", narrow=self.is_narrow)

    def take_steps(self, pane: str) -> int:
        """Return by how many steps keys make a pane larger since the last call; less than 0: smaller."""
        name, steps = self.stretches
        if name != pane:
            return 0
        self.stretches = "", 0
        return steps

    def fraction(self, name: str, otherwise: float) -> float:
        """Return the part of the window that a pane takes, or the width of one that keeps its own."""
        return self.preferences.panes.get(name, otherwise)

    def remember(self, name: str, value: float) -> None:
        """Remember a choice."""
        self.preferences.choose(panes={**self.preferences.panes, name: value})


@dataclass
class TypedAhead:
    """What is typed while a field that was opened has not taken the keys yet."""

    frames: int = 0  # in which that field may still take them
    text: str = ""


@dataclass
class KeyFocus:
    """Where the keyboard's focus is, and was."""

    tabbed: int = 0  # Tab was pressed in the frame before: 1, with Shift -1
    item: int = 0  # imgui's number of the control that had the focus then
    pane: str = ""  # that it is in
    enters: str = ""  # the pane that gets it in the next frame
    goal: int = 0  # at which of its controls; 0: the first
    inits: str = ""  # the pane whose first control is being looked for
    firsts: dict[str, int] = field(default_factory=dict)  # pane → its first control
    lasts: dict[str, int] = field(default_factory=dict)  # pane → the control from which Tab left it
    popups: int = 0  # that were open at the end of the frame before
    was_always: bool = False  # it was on without having been asked for, as on the start page


@dataclass
class PictureCursor:
    """A cursor over the picture that keys move: it takes the mouse's place, and its left button."""

    on: bool = False
    at: tuple[float, float] = (0.5, 0.5)  # fractions of the picture, from its upper left
    area: tuple[float, float, float, float] = (0.0, 0.0, 1.0, 1.0)  # of the picture, in the window's units
    texels: tuple[int, int] = (1, 1)  # that it goes through, around the picture's middle
    spacing: float = 1.0  # [the window's units] between two of them
    latched: bool = False  # the button stays down until it is let go
    pressed: bool = False  # the button is to be down
    shift: bool = False  # it was pressed together with Shift
    is_down: bool = False  # for imgui it is
    mouse: tuple[float, float] | None = None  # where the mouse itself was when the cursor came

    @property
    def position(self) -> tuple[float, float]:
        """Its place in the window."""
        x, y, wide, high = self.area
        return x + self.at[0] * wide, y + self.at[1] * high

    def step(self, across: int, down: int) -> None:
        """Go so many texels to the right and down, to the middle of one; it stays in the picture."""

        def moved(at: float, extent: float, count: int, by: int) -> float:
            texel = math.floor((at - 0.5) * extent / self.spacing + count / 2) + by
            return (min(max(texel, 0), count - 1) + 0.5 - count / 2) * self.spacing / extent + 0.5

        _, _, wide, high = self.area
        self.at = (
            moved(self.at[0], wide, self.texels[0], across),
            moved(self.at[1], high, self.texels[1], down),
        )

    def toggle(self) -> None:
        """Take the mouse's place, or give it back."""
        was_on = self.on
        self.leave()
        self.on = not was_on

    def leave(self) -> None:
        """Let the button go, and give its place back to the mouse."""
        self.on = self.latched = self.pressed = False


@dataclass
class Interface:
    """What of one window's interface is shown."""

    panel_shown: bool = True
    keymap_shown: bool = False
    keymap_search: str = ""
    settings_asked: bool = False  # the menu of settings is to open
    searching: bool = False  # the search of the panel, or of the key map, is to get the keys
    reveal: str = ""  # the pass that the panel is to scroll to
    preferences: Preferences = field(default_factory=Preferences)
    ahead: TypedAhead = field(default_factory=TypedAhead)
    focus: KeyFocus = field(default_factory=KeyFocus)
    cursor: PictureCursor = field(default_factory=PictureCursor)

    def show_pass(self, name: str) -> None:
        """Show the panel, scrolled to a pass."""
        self.panel_shown, self.reveal = True, name

    def toggle_panel(self) -> None:
        """Hide the panel, or show it again."""
        self.panel_shown = not self.panel_shown

    def search(self) -> None:
        """Give a search the keys: the key map's while that is open, else the panel's, which is shown."""
        self.panel_shown, self.searching = self.panel_shown or not self.keymap_shown, True

    def ask_settings(self) -> None:
        """Open the menu of the window's settings, in the panel where no start page is shown."""
        self.panel_shown = self.settings_asked = True

    def toggle_keymap(self) -> None:
        """Show what every key does, or no longer."""
        self.keymap_shown, self.keymap_search = not self.keymap_shown, ""


def resize(preferences: Preferences, by: int, notices: Notices) -> None:
    """Draw text and panels larger, smaller, or with 0 as large as the screen says; say how large."""
    if by:
        preferences.step(by)
    else:
        preferences.choose(size=1.0)
    what = tr("text and panels at")
    notices.drop(what)
    notices.say(f"{what} {numeral(preferences.size, '.0%')}")


@dataclass
class WindowControls:
    """What the interface asks of the window that it is in."""

    quit: Callable[[], None]
    toggle_full: Callable[[], None] = lambda: None  # fills the screen, or no longer
    is_full: Callable[[], bool] = lambda: False
    sign_held: Callable[[], str] = lambda: ""  # "+" or "-" where this keyboard's key for it is down
