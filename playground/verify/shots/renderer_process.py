"""Render shots in a worker process with an OpenGL context of its own, one after the other.

A render that takes too long is stopped, and a process that dies is replaced; the error says how
it ended, with what it printed. The next shot is rendered all the same.
"""

from __future__ import annotations

from functools import partial

from playground.engine.context import ContextInfo
from playground.engine.engine import open_engine
from playground.engine.plain_forms import silent
from playground.engine.process.pool import OPEN, Limits, Pool, PoolOwner
from playground.engine.process.worker import Parent, Service
from playground.errors import ContextError
from playground.verify.shots.suite import RenderedShot, ShotCase, render_shot

LIMIT = 120.0
"""[s] A render may take that long: far beyond any shot on a slow machine with a cold shader cache."""

HANDLER = __name__


class RendererProcess(PoolOwner):
    """Renders shots in a worker, which starts with the first and is replaced when it dies.

    ``limit`` is seconds a render. ``renderer`` is "software" for Mesa's software renderer,
    "any" for what OpenGL gives by itself, "either" for the first that there is.
    Use it with ``with``, or call ``close()``.
    """

    def __init__(self, limit: float = LIMIT, renderer: str = "software") -> None:
        self.limit = limit  # [s] a render
        self._pool = Pool(HANDLER, Limits(start_seconds=max(limit, 120.0)), options=renderer)
        self._refusal: Exception | None = None  # no process is started any more
        self._printed = ""

    @property
    def renderer(self) -> ContextInfo:
        """What renders the shots.

        Raises ``ContextError`` where there is no such renderer, ``SandboxCrash`` or
        ``SandboxTimeout`` where the worker does not start.
        """
        info = self._ask(OPEN)
        assert isinstance(info, ContextInfo)
        return info

    @property
    def process(self) -> int | None:
        """The worker's process number; None while there is none."""
        return next(iter(self._pool.pids), None)

    def printed(self) -> str:
        """Return, once, what the worker printed."""
        printed, self._printed = self._printed, ""
        return printed

    def render(self, case: ShotCase) -> RenderedShot:
        """Render one shot in the worker.

        Raises what `playground.verify.shots.suite.take` raises, ``SandboxCrash`` where the worker died,
        ``SandboxTimeout`` where it took too long.
        """
        frame = self._ask(case, f"drawing {case}")
        assert isinstance(frame, RenderedShot)
        return frame

    def _ask(self, request: object, what: str = "") -> object:
        if self._refusal is not None:
            raise self._refusal
        outcome = self._pool.run(request, seconds=self.limit)
        self._printed += outcome.printed
        if not outcome.started:
            self._refusal = outcome.failure(what)
            self.close()
        return outcome.get(what)


# ── in the worker ────────────────────────────────────────────────────────────


def open_service(parent: Parent, renderer: str) -> Service:
    """Open a context and an engine on it: "software", "any", or "either", the first where it is to be had."""
    try:
        engine = open_engine(software=renderer != "any", notice=silent)
    except ContextError:
        if renderer != "either":
            raise
        engine = open_engine(notice=silent)
    return Service(partial(render_shot, engine), engine.info)
