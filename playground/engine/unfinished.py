"""Work that goes on over several pictures, so that a window can answer meanwhile.

A long run of passes stops between two of them, a loop that follows the time between two iterations: the next
picture goes on. What a source makes of other passes is worked out in a thread. Such a work has the key of its
step: while that is asked for again and again it goes on, and where another is asked for in its place it is
cancelled. It may take seconds, and says how far it is.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

from numpy.typing import NDArray

from playground.engine.process.worker import Cancelled

_EVERY = 4  # iterations between two looks at the clock, for which the graphics card is waited for


class Unfinished(Exception):
    """A loop was stopped by an engine's ``patience``: nothing is wrong, the next frame goes on."""

    def __init__(self, done: int, total: int) -> None:
        super().__init__(f"{done} of {total} iterations have run")
        self.done = done
        self.total = total


class PassesUnfinished(Exception):
    """A picture was stopped between two passes by an engine's ``piece``: the next goes on."""


class Interruption:
    """When a picture stops before it is done; ``finish`` waits for the graphics card, before a clock is read.

    Between two passes where ``over`` says that time is, though one runs at least; between two iterations of a
    loop that follows the time ``seconds`` after the picture was begun. With None never.
    """

    def __init__(
        self, finish: Callable[[], None], over: Callable[[], bool] | None, seconds: float | None
    ) -> None:
        self._finish = finish
        self._over = over
        self._end = None if seconds is None else time.perf_counter() + seconds
        self._ran = False

    def before_pass(self) -> None:
        """Raise ``PassesUnfinished`` where time is over and another pass ran."""
        if self._over is not None and self._ran:
            self._finish()
            if self._over():
                raise PassesUnfinished
        self._ran = True

    def after_iteration(self, ran: int, done: int, total: int) -> None:
        """Raise ``Unfinished`` where time is over and iterations are left; ``ran`` are those of this run."""
        if self._end is None or done >= total or ran % _EVERY:
            return
        self._finish()
        if time.perf_counter() > self._end:
            raise Unfinished(done, total)


Arrays = Mapping[str, NDArray[Any]]
Report = Callable[[int, int], None]
"""Takes how many parts are done, and of how many; raises ``Cancelled`` where the work is to stop."""

Task = Callable[[Report], Arrays]
_WAIT = 0.03  # [s] that one picture waits for a work


class SourceUnfinished(Unfinished):
    """A source is still at work; the next frame asks again."""

    def __init__(self, path: str, done: int, total: int) -> None:
        super().__init__(done, total)
        self.path = path

    def __str__(self) -> str:
        return f"{self.path} is being made, {self.done} of {self.total}: try again when it is there"


class SourceWorks:
    """The works of one engine, one for each step."""

    def __init__(self) -> None:
        self.waits = True  # for each work to end; else ``SourceUnfinished`` is raised meanwhile
        self.idle = False  # nothing is worked out at all: where only shaders are tried
        self.on_progress: Callable[[str, int, int], None] = lambda path, done, total: None
        self.took: dict[str, float] = {}  # [s] that the last work in a thread took, by the step's path
        self._works: dict[str, _Work] = {}  # likewise
        self._ending: dict[str, _Work] = {}  # likewise, those that were cancelled: they may go on for a while

    @property
    def at_work(self) -> bool:
        """Whether a work has begun that was not asked for since it ended."""
        return bool(self._works)

    def made(self, path: str, key: str, task: Callable[[], Task]) -> Arrays:
        """Return what a step's work gives, or raise what it raises.

        ``task`` is called where it has to begin, which is not before the step's cancelled work has ended. A
        step without a key, as in a loop, is waited for.
        """
        work = self._works.get(path)
        if work is not None and work.key != key:
            self._cancel(path)
            work = None
        if work is None:
            if self.waits or not key:
                return task()(lambda done, total: self.on_progress(path, done, total))
            ending = self._ending.get(path)
            if ending is not None and not ending.ended.wait(_WAIT):
                raise SourceUnfinished(path, 0, ending.progress[1])
            self._ending.pop(path, None)
            work = self._works[path] = _Work(key, task())
        while not work.ended.wait(_WAIT):
            if not self.waits:
                raise SourceUnfinished(path, *work.progress)
            self.on_progress(path, *work.progress)
        del self._works[path]
        self.took[path] = work.seconds
        return work.result()

    def keep(self, key_of: Callable[[str], str]) -> None:
        """Cancel all works but those of these keys; ``key_of`` returns that of the step of a path."""
        for path in [path for path, work in self._works.items() if key_of(path) != work.key]:
            self._cancel(path)

    def _cancel(self, path: str) -> None:
        work = self._ending[path] = self._works.pop(path)
        work.cancel()


class _Work:
    """One task in a thread."""

    def __init__(self, key: str, task: Task) -> None:
        self.key = key
        self.progress = (0, 1)
        self.seconds = 0.0  # that it took
        self.ended = threading.Event()
        self._task = task
        self._cancelled = False
        self._found: Arrays = {}
        self._error: BaseException | None = None
        # A daemon: a process that ends does not wait for it.
        threading.Thread(target=self._run, name="source", daemon=True).start()

    def cancel(self) -> None:
        """Have it stop at its next report."""
        self._cancelled = True

    def result(self) -> Arrays:
        """Return what it found, or raise what it raised."""
        if self._error is not None:
            raise self._error
        return self._found

    def _report(self, done: int, total: int) -> None:
        if self._cancelled:
            raise Cancelled
        self.progress = done, total

    def _run(self) -> None:
        start = time.perf_counter()
        try:
            self._found = self._task(self._report)
        except BaseException as error:
            self._error = error
        finally:
            self.seconds = time.perf_counter() - start
            self.ended.set()
