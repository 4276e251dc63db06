"""Judge double clicks by when the buttons went down, not by the frames in which they are drawn.

imgui spreads the presses and releases of one moment over several frames and compares the times of the
frames: where a picture takes 0.4 s, no two clicks are ever a double one. GLFW reports that a button
went down only when it is polled, after the frame before has ended. So an event came after the last
poll; one that comes while the window sleeps is reported at once. Two clicks are a double click if
they can have been one.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable

APART = 0.3
"""[s] that the clicks of a double click are apart at most."""
_AT_ONCE = 0.004  # [s] from the beginning of a wait: what came before it is reported by then
_NEVER, _ALWAYS = 0.0, 1e3  # [s] what imgui is to take for the longest time between the two


class Clicks:
    """Records presses of the left button; ``before_poll`` and ``after_poll`` surround each wait."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self._now = now
        self._poll_end = self._poll_start = now()
        self._pressed: float | None = None  # the latest that the last press can have been
        self._doubles: deque[bool] = deque()  # presses that imgui has not come to, oldest first

    def before_poll(self) -> None:
        """Record when GLFW is about to be polled for events."""
        self._poll_start = self._now()

    def after_poll(self) -> None:
        """Record when it has reported all events."""
        self._poll_end = self._now()

    def press(self) -> None:
        """Record a press of the button."""
        now = self._now()
        waited_for = now - self._poll_start > _AT_ONCE
        earliest = now if waited_for else self._poll_end
        self._doubles.append(self._pressed is not None and earliest - self._pressed < APART)
        self._pressed = now

    def double_click_time(self) -> float:
        """Return the longest time between two clicks [s] that imgui uses in its next frame."""
        if not self._doubles:
            return APART
        return _ALWAYS if self._doubles[0] else _NEVER

    def handled(self) -> None:
        """Forget the oldest press, which imgui has handled."""
        if self._doubles:
            self._doubles.popleft()
