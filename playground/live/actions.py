"""What a button or a key can ask for that is more than one call of the session."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import PlaygroundError
from playground.live.painting import Painting
from playground.live.pictures import save_new
from playground.live.session import Session
from playground.paths import shown

STAYS = 6.0
"""[s] that a notice stays on the screen."""


@dataclass
class Notice:
    """A sentence on the screen for a while."""

    text: str
    until: float  # by the clock of ``Actions``


@dataclass
class Actions:
    """The session, and what is on the screen besides it."""

    session: Session
    quit: Callable[[], None]
    folder: Path = field(default_factory=Path.cwd)  # where pictures go
    now: Callable[[], float] = time.perf_counter
    panel_shown: bool = True
    notices: list[Notice] = field(default_factory=list)
    last_map: str = ""  # what M shows
    saved: Path | None = None  # the last picture

    def __post_init__(self) -> None:
        self.painting = Painting(self.session, self.folder)

    def say(self, text: str) -> None:
        """Put a sentence on the screen; the same one again only stays longer."""
        self.notices = [n for n in self.notices if n.text != text][-4:]
        self.notices.append(Notice(text, self.now() + STAYS))

    def take_notes(self) -> None:
        """Put what the session has to say on the screen, and take away what has been read."""
        while self.session.notes:
            self.say(self.session.notes.popleft())
        self.notices = [n for n in self.notices if n.until > self.now()]

    def save_picture(self) -> None:
        """Save the picture as a PNG that is new in the current folder, and say where."""
        frame = self.session.read()
        if frame is None:
            self.say("there is no picture to save yet")
            return
        try:
            self.saved = save_new(frame, self.folder, frame.sketch)
        except PlaygroundError as error:
            self.say(str(error))
            return
        width, height = frame.size
        self.say(f"saved {shown(self.saved)}, {width} x {height} pixels, in {self.folder}")

    def toggle_map(self) -> None:
        """Go between the sketch's own view and the map last looked at, at first of the first texture."""
        if self.session.map is not None:
            self.session.show(None)
            return
        refs = self.session.refs
        if refs:
            self.show(self.last_map if self.last_map in refs else refs[0])

    def show(self, ref: str | None) -> None:
        """Show a texture from above; None: the sketch's own view."""
        self.last_map = ref or self.last_map
        self.session.show(ref)

    def toggle_panel(self) -> None:
        """Hide the panel, or bring it back."""
        self.panel_shown = not self.panel_shown

    def rewind(self) -> None:
        """Go back to time 0."""
        self.session.clock.rewind()
