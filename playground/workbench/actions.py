"""What a button or a key can ask for that is more than one call of the session."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from playground.errors import PlaygroundError, counted
from playground.paths import shown
from playground.sketch.model import Value
from playground.workbench.captures import Capturing
from playground.workbench.editors import Opener
from playground.workbench.edits import Edits
from playground.workbench.history import KEYFRAMES, History, State, applied, edits_of, state_of, steps_of
from playground.workbench.inspect.time_range import stepped, toggle_loop
from playground.workbench.inspect.toggles import See
from playground.workbench.interface_size import InterfaceSize
from playground.workbench.painting import Painting
from playground.workbench.problems import Problems
from playground.workbench.reload_stages import ReloadStage
from playground.workbench.session import Session
from playground.workbench.snapshot import save_new
from playground.workbench.text_file import Editing

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
    history: History = field(default_factory=History)
    keymap_shown: bool = False
    interface: InterfaceSize = field(default_factory=InterfaceSize)
    sign_held: Callable[[], str] = lambda: ""  # "+" or "-" where this keyboard's key for it is down
    full_screen: Callable[[], None] = lambda: None  # fills the screen, or no longer
    fills_screen: Callable[[], bool] = lambda: False
    dropped: list[Path] = field(default_factory=list)  # images that wait to be put somewhere
    searching: bool = False  # the panel is asked for its search
    offer: str = ""  # why the sketch cannot be saved: the panel offers a copy
    opening: str = ""  # the question to be asked next: "offer" or "dropped"
    capture: Capturing = field(default_factory=Capturing)
    held: bool = False  # a mouse button is down: what changes is one step
    problems: Problems = field(default_factory=Problems)
    opener: Opener = field(default_factory=Opener)  # starts the user's editor
    editing: list[Editing] = field(default_factory=list)  # files open in windows of our own
    copy_of: Callable[[Path], Editing | None] = lambda path: None  # what is drawn in place of a file
    leaving: bool = False  # the window is to close, and something is not saved: it is asked what to do
    awaits_field: int = 0  # turns in which a field is still about to take the keys: see ``field``
    typed_ahead: str = ""  # what was typed for it meanwhile
    reveal: str = ""  # the pass that the panel is to bring into sight
    toggle_lessons: Callable[[], None] = lambda: None  # shows the lessons, or no longer
    lesson_shown: Callable[[], bool] = lambda: False
    turn_page: Callable[[int], None] = lambda pages: None  # goes so many pages of a lesson on

    def __post_init__(self) -> None:
        self.painting = Painting(self.session, self.folder)
        self.see = See(self.session)

    def say(self, text: str) -> None:
        """Put a sentence on the screen; the same one again only stays longer."""
        self.notices = [n for n in self.notices if n.text != text][-4:]
        self.notices.append(Notice(text, self.now() + STAYS))

    def take_notes(self) -> None:
        """Put what the session has to say on the screen, and take away what has been read."""
        while self.session.notes:
            self.say(self.session.notes.popleft())
        while self.opener.notes:
            self.say(self.opener.notes.popleft())
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
        if self.session.view.map is not None:
            self.session.show(None)
            return
        refs = self.session.refs
        if refs:
            self.show(self.last_map if self.last_map in refs else refs[0])

    def show(self, ref: str | None) -> None:
        """Show a texture from above; None: the sketch's own view."""
        self.last_map = ref or self.last_map
        self.session.show(ref)

    def show_pass(self, name: str) -> None:
        """Bring the panel, and a pass in it into sight."""
        self.panel_shown, self.reveal = True, name

    def toggle_panel(self) -> None:
        """Hide the panel, or bring it back."""
        self.panel_shown = not self.panel_shown

    def search(self) -> None:
        """Bring the panel, and give its search the keys."""
        self.panel_shown = self.searching = True

    def toggle_keymap(self) -> None:
        """Show what every key does, or no longer."""
        self.keymap_shown = not self.keymap_shown

    def resize(self, by: int) -> None:
        """Draw text and panels larger, smaller, or with 0 as large as the screen says."""
        if by:
            self.interface.step(by)
        else:
            self.interface.choose(1.0)
        what = "text and panels at"
        self.notices = [notice for notice in self.notices if not notice.text.startswith(what)]
        self.say(f"{what} {self.interface.size:.0%}")

    def rewind(self) -> None:
        """Go back to time 0."""
        self.seek(0.0)

    def open(self, path: Path) -> None:
        """Open another sketch in this window; nothing of this one can be undone there."""
        try:
            self.session.open(path)
        except PlaygroundError as error:
            self.say(str(error))
            return
        self.history = History()

    # ── undo ─────────────────────────────────────────────────────────────────

    def look_back(self, held: bool) -> None:
        """Take in what this turn has changed, for undo; ``held``: a mouse button is down."""
        session, self.held = self.session, held
        if session.shown is not None:
            draft = session.shown
            self.history.look(draft.edits, session.view.steps, draft.file, held=held, now=self.now())

    def undo(self) -> None:
        """Take the last step back; with the brush in the hand, the last stroke."""
        if self.painting.on:
            canvas = self.painting.canvas
            if canvas is None or not canvas.can_undo:
                self.say("no stroke to take back; put the brush down (B) to undo values")
            else:
                self.painting.undo()
                self.say("took the last stroke back; put the brush down (B) to undo values")
            return
        self.look_back(False)
        if self.history.can_undo:
            self._take(self.history.undo())
        else:
            self.say("there is nothing to undo")

    def redo(self) -> None:
        """Do the step again that was taken back last; with the brush in the hand, the stroke."""
        if self.painting.on:
            canvas = self.painting.canvas
            if canvas is None or not canvas.can_redo:
                self.say("no stroke to paint again; put the brush down (B) to redo values")
            else:
                self.painting.redo()
                self.say("painted the stroke again; put the brush down (B) to redo values")
            return
        self.look_back(False)
        if self.history.can_redo:
            self._take(self.history.redo())
        else:
            self.say("there is nothing to do again")

    def go_to(self, done: int) -> None:
        """Undo or redo until so many steps are done."""
        self.look_back(False)
        done = min(max(done, 0), len(self.history.steps))
        while self.history.done > done:
            self._take(self.history.undo())
        while self.history.done < done:
            self._take(self.history.redo())

    def _take(self, changes: State) -> None:
        session = self.session
        if session.shown is None:
            return
        wanted = applied(state_of(self._asked(), session.view.steps), changes)
        keyframes = wanted.pop((KEYFRAMES, ""), None)
        if isinstance(keyframes, tuple):
            from playground.workbench.keyframe_edits import put_back  # it needs this module

            put_back(self, keyframes)
        time = wanted.pop(("time", ""), None)
        if isinstance(time, float):
            session.clock.time = time
        stops = steps_of(wanted)
        for path in {*session.view.steps, *stops}:
            session.stop_at(path, stops.get(path, -1))
        session.drafts.restore(edits_of(wanted))
        self.history.settle(session.shown.edits, session.view.steps)

    def _asked(self) -> Edits:
        """Return the edits of now, or those that an undo has asked for and that are still tried."""
        session = self.session
        assert session.shown is not None
        coming = session.drafts.coming if session.drafts.stage is not ReloadStage.FAILED else None
        return coming.edits if coming is not None else session.shown.edits

    def seek(self, time: float) -> None:
        """Go to a moment [s]."""
        before, self.session.clock.time = self.session.clock.time, max(time, 0.0)
        if before != self.session.clock.time:
            self.history.jump(before, self.session.clock.time, held=self.held, now=self.now())

    def step_time(self, frames: int) -> None:
        """Rest, and go so many frames on or back, where time shows."""
        if self.session.animated:
            self.session.clock.playing = False
            self.seek(stepped(self.session.clock.time, frames))

    def toggle_loop(self) -> None:
        """Have time go round, or no longer, where time shows."""
        if self.session.sketch is not None and self.session.animated:
            toggle_loop(self.session.sketch, self.session.clock)

    # ── many values at once ──────────────────────────────────────────────────

    def set_all(self, name: str, values: dict[str, Value]) -> None:
        """Set many parameters as one step, and say how many; locked ones stay."""
        draft = self.session.shown
        if draft is None:
            return
        locked = len(set(values) & set(draft.edits.locked))
        self.look_back(False)
        self.history.call(name)
        self.session.drafts.set_all(values)
        self.look_back(False)
        kept = f"; {counted(locked, 'locked parameter')} left alone" if locked else ""
        self.say(f"{name}: {counted(len(values) - locked, 'parameter')}{kept}")

    def apply_preset(self, name: str) -> None:
        """Set a preset's values, as one step."""
        sketch = self.session.sketch
        for preset in sketch.presets if sketch else ():
            if preset.name == name:
                self.set_all(f"Preset {name}", dict(preset.values))

    def reset_values(self) -> None:
        """Give all that is not locked back what the file says, as one step."""
        self.look_back(False)
        self.history.call("Reset values")
        self.session.reset_values()
        self.look_back(False)

    def reset(self, name: str, paths: list[str]) -> None:
        """Give some parameters back the file's values, as one step; locked ones stay."""
        draft = self.session.shown
        if draft is not None:
            self.look_back(False)
            self.history.call(f"Reset {name}")
            self.session.drafts.unset(*(path for path in paths if path not in draft.edits.locked))
            self.look_back(False)
