"""Undo and redo on a session: steps are recorded at the end of each frame, and applied back to it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from playground.studio.clock import stepped, toggle_loop
from playground.studio.edits.edits import Edits
from playground.studio.edits.history import (
    TEXT,
    History,
    Key,
    State,
    TextChange,
    Typed,
    changes_between,
    steps_of,
)
from playground.studio.language import tr
from playground.studio.notices import Notices
from playground.studio.paint.painting import Painting
from playground.studio.reload.stages import ReloadStage
from playground.studio.save.sketch_file import SketchFile, contents_of
from playground.studio.session import Session


@dataclass
class Undo:
    """The history of one session: one for each sketch that is opened in it."""

    session: Session
    notices: Notices
    painting: Painting
    file: SketchFile
    _history: History = field(default_factory=History)
    _next: tuple[Path, History] | None = None  # of a sketch that is being opened
    held: bool = False  # a mouse button is down: what changes is one step
    seen: Callable[[], Typed | None] = lambda: None  # the text that is seen in the code pane

    @property
    def history(self) -> History:
        """The steps of the sketch that is shown."""
        if self._next is not None and not self.session.drafts.opening:
            path, history = self._next
            self._next = None
            if path == self.session.path:  # else another was opened in its place
                self._history = history
        return self._history

    @property
    def opened(self) -> History:
        """The steps of the sketch that is open; it may not be shown yet."""
        history = self.history
        return self._next[1] if self._next is not None else history

    def begin(self, history: History) -> None:
        """Go on with the history of the sketch that was opened last, as soon as that is shown."""
        self._next = self.session.path, history

    def record(self, *, held: bool = False) -> None:
        """Record what has changed since the last call; ``held``: a mouse button is down."""
        session, self.held = self.session, held
        if session.shown is not None:
            edits, drafts, now = session.shown.edits, session.drafts, self.notices.now()
            steps, read = session.view.steps, drafts.read_changes
            is_idle = drafts.stage in (ReloadStage.NONE, ReloadStage.FAILED)
            self.history.look(edits, steps, drafts.reads, held=held, now=now, read=read, is_idle=is_idle)

    @contextmanager
    def step(self, name: str) -> Iterator[None]:
        """Record what the block changes as one step with a name; none where it changes nothing."""
        self.record()
        self.history.call(name)
        try:
            yield
        finally:
            self.record()
            self.history.call("")

    def write(self, name: str, act: Callable[[], None], path: Path, edits: Edits | None = None) -> bool:
        """Write a file by ``act`` and replace the edits, as one step; return whether that worked.

        Where it is refused, a notice says why, or a copy is offered.
        """
        key: Key = (TEXT, str(path))
        draft, before, after = self.session.shown, dict[Key, object](), dict[Key, object]()

        def write() -> None:
            before[key] = contents_of(path)
            act()
            after[key] = contents_of(path)

        self.record()
        if not self.file.write(write):
            return False
        if edits is not None and draft is not None and edits != draft.edits:
            old, new = changes_between(draft.edits, edits)
            before, after = before | old, after | new
            self.session.drafts.restore_with_save(edits)
        if before != after:
            self.history.record(before, after, name, now=self.notices.now())
        self.settle()
        return True

    def undo(self) -> None:
        """Undo the last step; while painting, the last stroke."""
        layer = self.painting.layer
        if self.painting.on and (layer is None or not layer.can_undo):
            self.notices.say(tr("no stroke to take back; put the brush down (B) to undo values"))
        elif self.painting.on:
            self.painting.undo()
            self.notices.say(tr("took the last stroke back; put the brush down (B) to undo values"))
        else:
            self.go(-1, self.seen())

    def redo(self) -> None:
        """Redo the step that was undone last; while painting, the stroke."""
        layer = self.painting.layer
        if self.painting.on and (layer is None or not layer.can_redo):
            self.notices.say(tr("no stroke to paint again; put the brush down (B) to redo values"))
        elif self.painting.on:
            self.painting.redo()
            self.notices.say(tr("painted the stroke again; put the brush down (B) to redo values"))
        else:
            self.go(1, self.seen())

    def go(self, by: int, text: Typed | None) -> None:
        """Undo (-1) or redo (1) what came last of the steps and of what was typed in a text.

        What was undone before anything later was done is not done again.
        """
        self.record()
        history = self.history
        steps, typed = history.time(by), text.time(by) if text is not None else None
        if by > 0 and text is not None:
            steps = steps if steps is not None and steps >= (text.time(-1) or 0.0) else None
            typed = typed if typed is not None and typed >= (history.time(-1) or 0.0) else None
        if text is not None and typed is not None and (steps is None or (typed - steps) * by < 0):
            text.go(by)
        elif steps is not None:
            self.go_to(history.done + by)
        else:
            self.notices.say(tr("nothing to undo") if by < 0 else tr("nothing to redo"))

    @property
    def can_undo(self) -> bool:
        """Whether there is anything to undo: a step, or what was typed in the text that is seen."""
        return self.history.can_undo or self._can_go(-1)

    @property
    def can_redo(self) -> bool:
        """Whether there is anything to redo."""
        return self.history.can_redo or self._can_go(1)

    def _can_go(self, by: int) -> bool:
        text = self.seen()
        return text is not None and text.time(by) is not None

    def go_to(self, done: int) -> None:
        """Undo or redo until so many steps are done, or one of them is refused."""
        self.record()
        history = self.history
        while history.done != done and history.go(1 if done > history.done else -1, self._apply):
            self.settle()

    def perform(self, before: State, after: State, name: str) -> bool:
        """Set what a step changes, and record it as one; return False, with a notice, where it is refused."""
        self.record()
        history = self.history
        history.record(before, after, name, now=self.notices.now())
        history.done -= 1
        done = history.go(1, self._apply)
        if not done:
            del history.steps[history.done :]
        self.settle()
        return done

    def settle(self) -> None:
        """Take in the state of the session without a step."""
        if self.session.shown is not None:
            self.history.settle(self.session.shown.edits, self.session.view.steps)

    def _apply(self, changes: State) -> bool:
        """Set what a step changed; return False, with a notice, where that is refused."""
        session, time = self.session, changes.get(("time", ""))
        texts = {Path(path): c for (_, path), c in changes.items() if isinstance(c, TextChange)}
        if session.shown is None or (texts and not self.file.change_texts(texts)):
            return False
        if not session.drafts.apply(changes):
            return False
        if isinstance(time, float):
            session.clock.time = time
        for path, step in steps_of(changes).items():
            session.view.stop_at(path, step)
        return True

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
