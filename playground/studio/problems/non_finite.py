"""Search the picture for numbers that are not finite while nothing changes, one pass a frame.

Nothing is searched while a mouse button is held or until the picture has rested for a moment. A
picture that goes on changing with time is searched now and then: that takes one part in fifty of
the time at most.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import replace

from playground.engine.non_finite import NotFinite
from playground.errors import PlaygroundError
from playground.studio.language import counted, tr
from playground.studio.session import Session

REST = 0.4  # [s] without a new picture before one is looked at
_SELDOM = 2.0  # [s] between looks at a picture that moves
_SHARE = 50  # the part of the time that they may take


class FiniteWatch:
    """What was found in the picture, and the look that is under way."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self.non_finite: tuple[
            NotFinite, ...
        ] = ()  # of each pass that makes such numbers, in the order they ran
        self.looks = 0  # passes looked at so far
        self._now = now
        self._picture: tuple[object, int] = (None, -1)  # the engine, and how many pictures it had drawn
        self._since = 0.0  # when that picture was first seen
        self._going: Iterator[NotFinite | None] | None = None
        self._done = True
        self._coming: list[NotFinite] = []
        self._of: object = None  # the sketch that the last whole look was of
        self._spent = 0.0  # [s] of this look
        self._next = 0.0  # when a picture that moves may be looked at again

    @property
    def patience(self) -> float | None:
        """How long nothing needs to be done [s]; None where nothing is waited for."""
        if self._done:
            return None
        return 0.0 if self._going is not None else REST / 2

    def update(self, session: Session, *, held: bool) -> None:
        """Look at one pass more, if it is time to; ``held``: a mouse button is down."""
        now = self._now()
        if session.shown is None or session.plan is None:
            return
        picture = (session.engine, session.draws)
        moving = session.animated and session.clock.playing
        if picture != self._picture:
            if not moving or self._picture[0] is not session.engine:
                self._going = None
            self._picture, self._done = picture, False
            self._since = now
        if self._done or held or session.is_preview or session.drafts.testing or session.awaits_data:
            return
        if now < self._next if moving else self._going is None and now - self._since < REST:
            return
        try:
            self._look(session, to_the_end=moving)
        except PlaygroundError:  # it is reported where the sketch is drawn
            self._going, self._done = None, True

    def _look(self, session: Session, *, to_the_end: bool) -> None:
        start = self._now()
        engine = session.engine
        assert session.plan is not None
        if self._going is None:
            if engine.record.plan is not session.plan:  # a texture was read since
                engine.recall(session.plan)
            self._going, self._coming, self._spent = engine.not_finite_by_pass(), [], 0.0
        for number in self._going:
            self.looks += 1
            if number is not None:
                self._coming.append(number)
            if not to_the_end:
                self._spent += self._now() - start
                return
        self._going, self._done = None, True
        if engine.record.plan is session.plan:
            self._take(session)
        self._next = self._now() + max(_SELDOM, _SHARE * (self._spent + self._now() - start))

    def _take(self, session: Session) -> None:
        """Take what was found; of passes that a map does not need, what was found before stays."""
        assert session.plan is not None
        earlier: list[NotFinite] = []
        if session.view.map is not None and self._of is session.sketch:
            ran = (step.path for step in session.plan.walk() if step.path in session.engine.record.results)
            there = {session.view.map.own_path(path) for path in ran}
            earlier = [f for f in self.non_finite if f.path not in there]
        self._of = session.sketch
        coming = self._coming
        if session.view.map is not None:
            pairs = [(f, session.view.map.own_path(f.path)) for f in coming]
            coming = [replace(f, path=path) for f, path in pairs if path]
        self.non_finite = (*coming, *earlier)


def summary(not_finite: tuple[NotFinite, ...]) -> str:
    """Return what was found as a message: the first, and of how many."""
    first = not_finite[0]
    x, y = first.texel
    output = (
        tr(", output '{name}',", name=first.output) if first.output != first.path.rpartition(".")[2] else ""
    )
    text = tr(
        "pass '{path}'{output} makes {value} at texel ({x}, {y}), {texels}",
        path=first.path,
        output=output,
        value=first.value,
        x=x,
        y=y,
        texels=counted(first.count, "texel"),
    )
    return text + (tr("; first of {count} passes", count=len(not_finite)) if len(not_finite) > 1 else "")
