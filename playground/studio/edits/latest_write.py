"""Write a file on a thread, so that no frame waits: of what is given meanwhile, the newest alone.

The thread is no daemon: Python's own end waits until what was given is written.
"""

from __future__ import annotations

import threading
from collections.abc import Callable

from playground.errors import DataError, PlaygroundError


def _nothing() -> None:
    pass


class LatestWrite:
    """Writes one file, one state after another; a state that is replaced before its turn is left out."""

    def __init__(self, ended: Callable[[], None] = _nothing) -> None:
        self.ended = ended  # called on the thread after each write, before ``wait`` returns; raises nothing
        self.writes = 0  # that have ended, well or not
        self.error: PlaygroundError | None = None  # of the last one
        self._condition = threading.Condition()
        self._next: Callable[[], None] | None = None
        self._works = False

    @property
    def pending(self) -> bool:
        """Whether something is being written, or waits for that."""
        return self._works

    def give(self, write: Callable[[], None]) -> None:
        """Have a state written soon, in place of one that waits. ``write`` raises what goes wrong."""
        with self._condition:
            self._next = write
            if self._works:
                return
            self._works = True
        try:
            threading.Thread(target=self._work, name="writing an image").start()
        except RuntimeError:  # the system has no thread left, or Python is ending
            self._work()

    def wait(self) -> None:
        """Wait until all that was given is written; raise the error of the last write."""
        with self._condition:
            self._condition.wait_for(lambda: not self._works)
        if self.error is not None:
            raise self.error

    def _work(self) -> None:
        while True:
            with self._condition:
                write, self._next = self._next, None
                if write is None:
                    self._works = False
                    self._condition.notify_all()
                    return
            error: PlaygroundError | None = None
            try:
                write()
            except PlaygroundError as caught:
                error = caught
            except Exception as caught:
                error = DataError(f"an image could not be written: {caught}")
            self.error = error
            self.writes += 1
            self.ended()
