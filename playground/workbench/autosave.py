"""Have a session go on where it was left: what it shows is remembered as one goes.

A change is written once half a second has passed without another, so that a slider
costs one write and not a hundred; time that runs by itself is written every few
seconds. Nothing here is needed to go on: where it cannot be written, one gets one notice.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

from playground.errors import PlaygroundError, SandboxError
from playground.folders import state_folder
from playground.sketch.map_sketch import Map
from playground.workbench.edit_merge import FileValue, file_values
from playground.workbench.edits import Draft
from playground.workbench.inspect.compare import Compare
from playground.workbench.memory import Memory, Remembered
from playground.workbench.session import Session

QUIET = 0.5  # [s] without another change after which a change is written
TIME = 5.0  # [s] after which a change of time alone is written


def memory_of(sketch: Path, folder: Path | None = None) -> Memory:
    """Return the memory of a sketch, in the user's state folder unless another is named."""
    return Memory(sketch, folder or state_folder() / "sessions")


class Rememberer:
    """Remembers what one session shows."""

    def __init__(
        self,
        session: Session,
        memory: Memory,
        found: Remembered | None = None,
        now: Callable[[], float] = time.monotonic,
        *,
        compare: Compare | None = None,
    ) -> None:
        self.session = session
        self._memory = memory
        self._path = session.path
        self._now = now
        self.compare = compare  # what is compared with the session
        self._written: Remembered | None = None
        self._seen: Remembered | None = None
        self._seen_at = 0.0
        self._written_at = now()
        self._is_reported = False
        self._recalled = False  # what is shown was set in an earlier session
        self._in_file: tuple[Draft | None, tuple[tuple[str, FileValue], ...]] = (None, ())
        self._compared = Remembered().compared
        self._recall(found or Remembered())

    @property
    def waits(self) -> bool:
        """Whether something is still to be written."""
        return self._seen != self._written or self._compared is not None

    def open(self, sketch: Path) -> None:
        """Open another sketch in the session, with what is remembered of it."""
        self.close()
        self._memory = Memory(sketch, self._memory.path.parent)
        found, complaint = self._memory.read()
        session = self.session
        session.open(sketch, start=found.start)
        session.notes.extend(filter(None, [complaint]))
        self._path, self._seen, self._written, self._is_reported = session.path, None, None, False
        self._recall(found)

    def look(self, window: tuple[int, int], at: tuple[int, int] | None = None) -> None:
        """Take in what the session shows now, and write it if it is time to.

        ``window``: width and height, ``at``: where its upper left corner is, in the screen's units.
        """
        session, now = self.session, self._now()
        if session.path != self._path:  # another sketch was opened in this window
            self.close()
            self._memory, self._path = Memory(session.path, self._memory.path.parent), session.path
            self._seen = self._written = None
            self._is_reported, self._compared = False, None
        if session.shown is None or session.drafts.opening:
            if self._recalled and isinstance(session.error, SandboxError):
                session.notes.append("playground live --fresh opens it without your edits")
                self._recalled = False
            return
        self._recalled = False
        if self._compared is not None and (self.compare is None or self.compare.recall(self._compared)):
            self._compared = None
        found = self._snapshot(session.shown, window, at)
        if self._seen is None or replace(found, time=self._seen.time) != self._seen:
            self._seen_at = now
        self._seen = found
        is_moment = self._written is not None and replace(found, time=self._written.time) == self._written
        rested = now - self._seen_at >= QUIET
        if self._seen != self._written and rested and (not is_moment or now - self._written_at >= TIME):
            self.write()

    def write(self) -> None:
        """Write what was shown last, unless another window remembers this sketch."""
        if self._seen is None or self._seen == self._written:
            return
        self._written_at = self._now()
        try:
            if not self._memory.claim():
                self._report("another window has this sketch open, and remembers it; this one does not")
                return
            self._memory.write(self._seen)
        except PlaygroundError as error:
            self._report(f"your edits cannot be remembered: {error}")
            return
        self._written = self._seen

    def close(self) -> None:
        """Write what is still to be written, and let other windows remember."""
        self.write()
        self._memory.close()

    def _recall(self, found: Remembered) -> None:
        """Have the session show what is remembered beside what was edited."""
        session, clock = self.session, self.session.clock
        self._compared = found.compared  # A of the last session, until it is there again
        self._recalled = not found.is_nothing
        clock.time, clock.playing, clock.speed = found.time, found.playing, found.speed
        if found.loop is not None:
            clock.set_loop(*found.loop)
        session.restore_view(dict(found.steps), Map(found.map, found.map_values) if found.map else None)

    def _snapshot(self, draft: Draft, window: tuple[int, int], at: tuple[int, int] | None) -> Remembered:
        session = self.session
        if self._in_file[0] is not draft:
            paths = [path for path, _ in draft.edits.values]
            self._in_file = draft, tuple(file_values(draft.base, paths).items())
        return Remembered(
            draft.edits,
            self._in_file[1],
            session.clock.time if session.animated else 0.0,
            session.clock.playing,
            session.clock.speed,
            session.view.map.ref if session.view.map else "",
            session.view.map.values if session.view.map else (),
            tuple(sorted(session.view.steps.items())),
            window,
            at,
            draft.file.camera if draft.edits.camera is not None else None,
            session.clock.loop,
            self._compared or (self.compare.remembered() if self.compare is not None else None),
        )

    def _report(self, sentence: str) -> None:
        if not self._is_reported:
            self._is_reported = True
            self.session.notes.append(sentence)
