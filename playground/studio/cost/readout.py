"""What the corner of the picture says: frames a second, resolution, milliseconds of a picture."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

from playground.studio.language import numeral, tr
from playground.studio.session import Session

_SPAN = 1.0  # [s] over which frames are counted


class Readout:
    """Follows the pictures of one session."""

    def __init__(self, session: Session, now: Callable[[], float]) -> None:
        self._session = session
        self._now = now
        self._draws = session.draws
        self._times: deque[float] = deque()  # when the pictures of the last second were drawn
        self.milliseconds = 0.0  # that the last picture took

    def take(self, seconds: float) -> None:
        """Take in a frame of the window that took ``seconds`` for its picture, where it drew one.

        Where passes are timed, as on a software renderer or while the costs are shown, their sum counts
        instead: elsewhere the graphics card goes on after the frame.
        """
        session, now = self._session, self._now()
        if session.draws != self._draws:
            self._draws = session.draws
            self._times.append(now)
            engine = session.engine
            is_timed = engine.info.software or engine.options.profiling
            timed = sum(engine.record.times.values()) if is_timed else 0.0
            self.milliseconds = timed or seconds * 1e3
        while self._times and self._times[0] <= now - _SPAN:
            self._times.popleft()

    @property
    def frames(self) -> int:
        """Pictures that were drawn in the last second; 0 while nothing changes."""
        now = self._now()
        return sum(time > now - _SPAN for time in self._times)

    @property
    def waits(self) -> bool:
        """Whether the count goes on changing by itself."""
        return bool(self._times)

    def text(self) -> str:
        """Return "60 fps   1280 × 720   3.2 ms"; "" before the first picture."""
        texture = self._session.picture.texture
        if texture is None:
            return ""
        wide, high = texture.size
        size = f"{wide} × {high}"
        if self._session.is_preview:
            across, down = self._session.picture.drawn_size
            size = f"{across} × {down} → {size}" if (across, down) != (wide, high) else size
        rate = tr("{count} fps", count=self.frames) if self.frames else tr("at rest")
        digits = 1 if self.milliseconds < 10 else 0
        return f"{rate}   {size}   {numeral(self.milliseconds, f'.{digits}f')} ms"
