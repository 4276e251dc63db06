"""Remember what a session shows while it is worked on, so that the next one starts from there.

A change is written once half a second has passed without another, so that a slider
costs one write and not a hundred; time that runs by itself is written every few
seconds. A session works without it: where nothing can be written, one notice says so.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from playground.errors import PlaygroundError, SandboxError
from playground.paths import program, state_folder
from playground.sketch.find import find
from playground.sketch.map_sketch import Map
from playground.studio.compare.compare import Compare
from playground.studio.edits.edits import Draft, FileValue, file_values
from playground.studio.edits.memory import Memory, Remembered
from playground.studio.language import tr
from playground.studio.session import Session

QUIET = 0.5  # [s] without another change after which a change is written
TIME = 5.0  # [s] after which a change of time alone is written


def memory_of(sketch: Path, folder: Path | None = None) -> Memory:
    """Return the memory of a sketch, in the user's state folder unless another is named."""
    return Memory(sketch, folder or state_folder() / "sessions")


class Autosave:
    """Remembers what one session shows."""

    def __init__(
        self,
        session: Session,
        memory: Memory,
        remembered: Remembered | None = None,
        now: Callable[[], float] = time.monotonic,
        *,
        compare: Compare | None = None,
    ) -> None:
        self.session = session
        self._memory = memory
        self._path = session.path  # the sketch that ``_memory`` is of
        self._opened: Path | None = None  # the sketch that was opened last with what is remembered of it
        self._now = now
        self.compare = compare  # what is compared with the session
        self._written: Remembered | None = None
        self.latest: Remembered | None = None  # what was shown at the last ``look``
        self._changed_at = 0.0
        self._written_at = now()
        self._is_reported = False
        self._recalled = False  # what is shown was set in an earlier session
        self._in_file: tuple[Draft | None, tuple[tuple[str, FileValue], ...]] = (None, ())
        self._compared = Remembered().compared
        session.before_switch = self._take_last_edits
        self._recall(remembered or Remembered())

    @property
    def waits(self) -> bool:
        """Whether something is still to be written."""
        return self.latest != self._written or self._compared is not None

    def open(self, sketch: Path) -> None:
        """Open another sketch with what is remembered of it; the one that is shown is only read again.

        Until the other is shown, edits are remembered of this one. Raises as ``Session.open``.
        """
        session, path = self.session, find(sketch).absolute()
        self.write()
        if self.latest is not None and path == self._path:
            if session.drafts.opening:  # A is that of the other
                is_on = self.compare is not None and self.compare.on
                self._compared = None if is_on else self.latest.compared
            session.stay()
            return
        remembered, complaint = Memory(path, self._memory.path.parent).read()
        session.open(path, start=remembered.start)
        session.notes.extend(filter(None, [complaint]))
        self._opened = path
        self._recall(remembered)

    def look(self, window: tuple[int, int], at: tuple[int, int] | None = None) -> None:
        """Take in what the session shows now, and write it if it is time to.

        ``window``: width and height, ``at``: where its upper left corner is, in the screen's units.
        """
        session, now = self.session, self._now()
        if session.shown is None or session.drafts.opening:
            if self._recalled and isinstance(session.error, SandboxError):
                session.notes.append(
                    tr("{program} live --fresh opens it without your edits", program=program())
                )
                self._recalled = False
            if session.shown is None or self.latest is None:
                return
            remembered = replace(self.latest, **self._drawn_of(session.shown))
        else:
            if session.path != self._path:
                self._switch()
            self._recalled = False
            if self._compared is not None and (self.compare is None or self.compare.recall(self._compared)):
                self._compared = None
            remembered = self._snapshot(session.shown, window, at)
        if self.latest is None or replace(remembered, time=self.latest.time) != self.latest:
            self._changed_at = now
        self.latest = remembered
        is_moment = (
            self._written is not None and replace(remembered, time=self._written.time) == self._written
        )
        rested = now - self._changed_at >= QUIET
        if remembered != self._written and rested and (not is_moment or now - self._written_at >= TIME):
            self.write()

    def write(self) -> None:
        """Write what was shown last, unless another window remembers this sketch."""
        if self.latest is None or self.latest == self._written:
            return
        self._written_at = self._now()
        try:
            if not self._memory.claim():
                self._report(tr("another window has this sketch open, and remembers it; this one does not"))
                return
            self._memory.write(self.latest)
        except PlaygroundError as error:
            self._report(tr("your edits cannot be remembered: {error}", error=error))
            return
        self._written = self.latest

    def pause(self) -> None:
        """Write what is still to be written, and remember nothing until this or another sketch is shown."""
        self.write()
        self.latest = self._written = None

    def close(self) -> None:
        """Write what is still to be written, and let other windows remember."""
        self.write()
        self._memory.close()

    def _take_last_edits(self) -> None:
        """Take in what was edited since the last ``look``: another sketch is shown from now on."""
        if self.latest is not None and self.session.shown is not None:
            self.latest = replace(self.latest, **self._drawn_of(self.session.shown))

    def _switch(self) -> None:
        """Remember another sketch from now on: the one that is shown."""
        self.close()
        path = self.session.path
        self._memory, self._path = Memory(path, self._memory.path.parent), path
        self.latest, self._written, self._is_reported = None, None, False
        if path != self._opened:  # it was opened without what is remembered of it
            self._compared = None

    def _recall(self, remembered: Remembered) -> None:
        """Have the session show what is remembered besides the edits."""
        session, clock = self.session, self.session.clock
        self._compared = remembered.compared  # A of the last session, until it is there again
        self._recalled = not remembered.is_default
        clock.time, clock.playing, clock.speed = remembered.time, remembered.playing, remembered.speed
        if remembered.loop is not None:
            clock.set_loop(*remembered.loop)
        session.restore_view(
            dict(remembered.steps),
            Map(remembered.map, remembered.map_values) if remembered.map else None,
            remembered.kept,
        )

    def _drawn_of(self, draft: Draft) -> dict[str, Any]:
        """Return the fields of ``Remembered`` that hold a draft's edits, the map and the stopped repeats."""
        view = self.session.view
        shown = view.map if view.map is not None and view.map.is_remembered else None
        if self._in_file[0] is not draft:
            paths = [path for path, _ in draft.edits.values]
            self._in_file = draft, tuple(file_values(draft.base, paths).items())
        camera = draft.file.camera if draft.edits.camera is not None else None
        return {
            "edits": draft.edits,
            "in_file": self._in_file[1],
            "camera_in_file": camera,
            "map": shown.ref if shown else "",
            "map_values": shown.values if shown else (),
            "steps": tuple(sorted(view.steps.items())),
            "kept": view.kept,
        }

    def _snapshot(self, draft: Draft, window: tuple[int, int], at: tuple[int, int] | None) -> Remembered:
        session, clock = self.session, self.session.clock
        return Remembered(
            time=clock.time if session.animated else 0.0,
            playing=clock.playing,
            speed=clock.speed,
            window=window,
            at=at,
            loop=clock.loop,
            compared=self._compared or (self.compare.remembered() if self.compare is not None else None),
            **self._drawn_of(draft),
        )

    def _report(self, message: str) -> None:
        if not self._is_reported:
            self._is_reported = True
            self.session.notes.append(message)
