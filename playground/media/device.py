"""A device that delivers by itself, in a thread of its own; a frame takes what there is when it begins."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event, Thread
from typing import Any

from playground.errors import PlaygroundError
from playground.images.files import reason

_PATIENCE = 2.0  # [s] that a device may take to stop


class Device:
    """Something that is opened and listened to; ``listen`` runs until it ends or is stopped.

    ``listen(deliver, stop)`` calls ``deliver(something)`` whenever something came. What it raises is the
    ``problem``: why nothing comes any more.
    """

    def __init__(self, listen: Callable[[Callable[[Any], None], Event], None]) -> None:
        self.problem = ""
        self.now: Any = None  # what a frame takes; None: nothing came yet
        self._came: Any = None
        self._known = ""  # the problem when the last frame began
        self._stop = Event()
        self._thread = Thread(target=self._run, args=(listen,), daemon=True)
        self._thread.start()

    def latch(self) -> bool:
        """Begin a frame: take what came; return whether it, or the problem, is new."""
        before, self.now = (self.now, self._known), self._came
        self._known = self.problem
        return self.now is not before[0] or self._known != before[1]

    def close(self) -> None:
        """Stop it."""
        self._stop.set()
        self._thread.join(_PATIENCE)

    def _run(self, listen: Callable[[Callable[[Any], None], Event], None]) -> None:
        try:
            listen(self._deliver, self._stop)
            if not self._stop.is_set():
                self.problem = "it ended"
        except PlaygroundError as error:
            self.problem = error.diagnostics[0].message
        except Exception as error:  # libraries of devices raise what they like
            self.problem = reason(error)

    def _deliver(self, something: Any) -> None:
        self._came = something
