"""Render shots in a worker process with an OpenGL context of its own, one after the other.

A render that takes too long is stopped, and a process that dies is replaced; the error says how
it ended, with what it printed. The next shot is rendered all the same.
"""

from __future__ import annotations

from playground.engine.context import ContextInfo
from playground.engine.process.worker import (
    START_SECONDS,
    Closing,
    Launch,
    Replaceable,
    Worker,
    WorkerDied,
    WorkerTimeout,
)
from playground.errors import ContextError, PlaygroundError, SandboxCrash, SandboxTimeout
from playground.shots.suite import RenderedShot, ShotCase

LIMIT = 120.0
"""[s] A render may take that long: far beyond any shot on a slow machine with a cold shader cache."""

HANDLER = "playground.shots.render_handler"

_STARTS = 2  # so many in a row may fail before none is tried any more


class RendererProcess(Closing):
    """Renders shots in a worker, which starts with the first and is replaced when it dies.

    ``limit`` is seconds a render. ``renderer`` is "software" for Mesa's software renderer,
    "any" for what OpenGL gives by itself, "either" for the first that there is.
    Use it with ``with``, or call ``close()``.
    """

    def __init__(self, limit: float = LIMIT, renderer: str = "software") -> None:
        self.limit = limit  # [s] a render
        self._workers = Replaceable(Launch(handler=HANDLER, options=renderer, limit_seconds=limit))
        self._renderer: ContextInfo | None = None
        self._refusal: PlaygroundError | None = None
        self._failed_starts = 0

    @property
    def renderer(self) -> ContextInfo:
        """What renders the shots.

        Raises ``ContextError`` where there is no such renderer, ``SandboxCrash`` or
        ``SandboxTimeout`` where the worker does not start.
        """
        self._start()
        assert self._renderer is not None
        return self._renderer

    @property
    def process(self) -> int | None:
        """The worker's process number; None while there is none."""
        return self._workers.worker.pid if self._workers.worker else None

    def printed(self) -> str:
        """Return, once, what the worker printed."""
        return self._workers.printed()

    def render(self, case: ShotCase) -> RenderedShot:
        """Render one shot in the worker.

        Raises what `playground.shots.suite.take` raises, ``SandboxCrash`` where the worker died,
        ``SandboxTimeout`` where it took too long.
        """
        worker = self._start()
        try:
            frame = worker.ask(case, self.limit)
        except WorkerDied as died:
            raise self._stopped(died, f"drawing {case}", self.limit) from None
        except MemoryError:
            raise ContextError(f"drawing {case} ran out of memory") from None
        assert isinstance(frame, RenderedShot)
        return frame

    def close(self) -> None:
        """End the worker; the next shot starts another."""
        self._workers.close()

    def _start(self) -> Worker:
        if self._refusal is not None:
            raise self._refusal
        worker = self._workers.start()
        limit = max(self.limit, START_SECONDS)
        try:
            info = worker.wait_until_ready(limit)
        except ContextError as error:
            self._refusal = error
            self.close()
            raise
        except WorkerDied as died:
            stopped = self._stopped(died, "starting the process that draws", limit)
            self._failed_starts += 1
            if self._failed_starts == _STARTS:
                self._refusal = stopped
            raise stopped from None
        assert isinstance(info, ContextInfo)
        self._renderer, self._failed_starts = info, 0
        return worker

    def _stopped(self, died: WorkerDied, doing: str, limit: float) -> PlaygroundError:
        """Return the error for a worker that died, or was killed for its time."""
        self._workers.end()
        report = died.report
        if isinstance(died, WorkerTimeout):
            return SandboxTimeout(f"{doing} took more than {limit:g} s and was stopped{report.last_lines}")
        if report.not_a_frame:
            return SandboxCrash(f"{doing} {report.ending}{report.last_lines}")
        return SandboxCrash(f"{doing} crashed: the process {report.ending}{report.last_lines}")
