"""Undo and redo on a session: steps are recorded at the end of each frame, and applied back to it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

from playground.workbench.edits import Edits
from playground.workbench.history import KEYFRAMES, History, State, applied, edits_of, state_of, steps_of
from playground.workbench.inspect.time_range import stepped, toggle_loop
from playground.workbench.notices import Notices
from playground.workbench.painting import Painting
from playground.workbench.reload_stages import ReloadStage
from playground.workbench.session import Session
from playground.workbench.sketch_file import SketchFile


@dataclass
class Undo:
    """The history of one session."""

    session: Session
    notices: Notices
    painting: Painting
    file: SketchFile
    history: History = field(default_factory=History)
    held: bool = False  # a mouse button is down: what changes is one step

    def record(self, *, held: bool = False) -> None:
        """Record what has changed since the last call; ``held``: a mouse button is down."""
        session, self.held = self.session, held
        if session.shown is not None:
            draft, now = session.shown, self.notices.now()
            self.history.look(draft.edits, session.view.steps, draft.file, held=held, now=now)

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Record what the block changes as one step with a name; none where it changes nothing."""
        self.record()
        self.history.call(name)
        yield
        self.record()
        self.history.call("")

    def undo(self) -> None:
        """Undo the last step; while painting, the last stroke."""
        if self.painting.on:
            canvas = self.painting.canvas
            if canvas is None or not canvas.can_undo:
                self.notices.say("no stroke to take back; put the brush down (B) to undo values")
            else:
                self.painting.undo()
                self.notices.say("took the last stroke back; put the brush down (B) to undo values")
            return
        self.record()
        if self.history.can_undo:
            self._apply(self.history.undo())
        else:
            self.notices.say("there is nothing to undo")

    def redo(self) -> None:
        """Redo the step that was undone last; while painting, the stroke."""
        if self.painting.on:
            canvas = self.painting.canvas
            if canvas is None or not canvas.can_redo:
                self.notices.say("no stroke to paint again; put the brush down (B) to redo values")
            else:
                self.painting.redo()
                self.notices.say("painted the stroke again; put the brush down (B) to redo values")
            return
        self.record()
        if self.history.can_redo:
            self._apply(self.history.redo())
        else:
            self.notices.say("there is nothing to do again")

    def go_to(self, done: int) -> None:
        """Undo or redo until so many steps are done."""
        self.record()
        done = min(max(done, 0), len(self.history.steps))
        while self.history.done > done:
            self._apply(self.history.undo())
        while self.history.done < done:
            self._apply(self.history.redo())

    def settle(self) -> None:
        """Take the state of the session for granted: it is no step."""
        if self.session.shown is not None:
            self.history.settle(self.session.shown.edits, self.session.view.steps)

    def _apply(self, changes: State) -> None:
        session = self.session
        if session.shown is None:
            return
        wanted = applied(state_of(self._latest(), session.view.steps), changes)
        keyframes = wanted.pop((KEYFRAMES, ""), None)
        if isinstance(keyframes, tuple):
            self.file.write_keyframes(keyframes)
        time = wanted.pop(("time", ""), None)
        if isinstance(time, float):
            session.clock.time = time
        stops = steps_of(wanted)
        for path in {*session.view.steps, *stops}:
            session.stop_at(path, stops.get(path, -1))
        session.drafts.restore(edits_of(wanted))
        self.settle()

    def _latest(self) -> Edits:
        """Return the present edits, or those that an undo has set and that are still checked."""
        session = self.session
        assert session.shown is not None
        coming = session.drafts.coming if session.drafts.stage is not ReloadStage.FAILED else None
        return coming.edits if coming is not None else session.shown.edits

    # ── time ─────────────────────────────────────────────────────────────────

    def seek(self, time: float) -> None:
        """Go to a moment [s]."""
        clock = self.session.clock
        before, clock.time = clock.time, max(time, 0.0)
        if before != clock.time:
            self.history.jump(before, clock.time, held=self.held, now=self.notices.now())

    def step_time(self, frames: int) -> None:
        """Pause, and go so many frames forward or back, in a sketch that moves."""
        if self.session.animated:
            self.session.clock.playing = False
            self.seek(stepped(self.session.clock.time, frames))

    def toggle_loop(self) -> None:
        """Loop time, or no longer, in a sketch that moves."""
        if self.session.sketch is not None and self.session.animated:
            toggle_loop(self.session.sketch, self.session.clock)
