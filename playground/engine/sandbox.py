"""Try a changed sketch in a child process first, so that what kills the driver kills only the child.

A draw that hangs cannot be interrupted inside its own process, and some texts crash the
compiler. The child keeps its own headless context warm, draws one small frame, and is
killed when it takes too long or too much memory. Parent and child share the driver's
shader cache, so what the child compiled compiles at once for the parent.

The limit on time is for each pass, in all its turns: whichever exceeds it is named. A sketch of
many slow passes is tried to its end.

A child that died is replaced at once, and one that takes suspiciously long has a spare
beside it, warm by the time that it is needed. Whoever hands over something newer does
not wait for a child that hangs: it is killed, and the spare takes its place.

The limit on memory is the system's own (``RLIMIT_DATA``), which holds on Linux; where
there is none, on macOS and Windows, only the limit on time stands.
"""

from __future__ import annotations

import queue
import time
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType

from playground.engine.sandbox_process import Process
from playground.errors import PlaygroundError, TrialCrash, TrialTimeout
from playground.sketch.model import Sketch

LIMIT_SECONDS = 10.0
LIMIT_BYTES = 4 * 2**30
_START = 60.0  # [s] that a child may take to start Python and open a context
_SUSPICIOUS = 0.3  # [s] after which a spare is started beside a child that is still at it
_IMPATIENT = 0.5  # [s] after which a child is killed for something newer
_MODULE = "playground.engine.sandbox_child"


@dataclass(frozen=True)
class TrySketch:
    """Draw one small frame of a sketch, by each driver named."""

    sketch: Sketch
    size: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]
    drivers: tuple[str, ...] = ("auto",)
    refuses: str = ""  # numbers that are not finite: "any", "all" of a texture, or "": none are looked for


@dataclass(frozen=True)
class TryLibrary:
    """Compile a library file alone, as a fragment and as a compute shader."""

    path: str
    folder: str


Request = TrySketch | TryLibrary


@dataclass(frozen=True)
class TrialReport:
    """How a trial ended."""

    ok: bool
    error: PlaygroundError | None = None
    skipped: tuple[str, ...] = ()  # what could not be tried here, as "compute"
    seconds: float = 0.0


class Trial:
    """A warm child process that tries sketches.

    Use it with ``with``, or call ``close()``. ``run`` waits for an answer; ``submit`` and
    ``poll`` do not, and only the newest request is answered.
    """

    def __init__(
        self,
        *,
        limit_seconds: float = LIMIT_SECONDS,
        memory_bytes: int = LIMIT_BYTES,
        software: bool = False,
        device: int | None = None,
    ) -> None:
        self.limit_seconds = limit_seconds
        self.memory_bytes = memory_bytes
        renderer = "software" if software else "any"
        self._arguments = [
            str(memory_bytes),
            renderer,
            "" if device is None else str(device),
            str(limit_seconds + _START),
        ]
        self._child: Process[TrialReport] | None = None
        self._spare: Process[TrialReport] | None = None
        self._given: Request | None = None  # what the child works on, while that is the newest
        self._waiting: Request | None = None  # the newest, while the child still works on an older one
        self._again = False  # what the child works on was handed to one before, which died of something else

    def __enter__(self) -> Trial:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def busy(self) -> bool:
        """Whether a request waits for its answer."""
        return self._given is not None or self._waiting is not None

    def start(self) -> None:
        """Start the child, so that it is warm when it is needed; does nothing if it runs."""
        if self._child is None or not self._child.runs:
            self._replace()

    def run(self, request: Request) -> TrialReport:
        """Try something and wait for the answer, no longer than the limit."""
        self.submit(request)
        while (report := self._answer(wait=0.05)) is None:
            pass
        return report

    def submit(self, request: Request) -> None:
        """Hand a request to the child; an earlier one that is still open will not be answered.

        Never waits: a child that hangs reads nothing, so it is handed one request at a time.
        """
        if self._child is not None and self._child.busy and self._child.runs:
            self._waiting, self._given = request, None
            return
        self._hand_over(request)

    def poll(self) -> TrialReport | None:
        """Return the answer to the newest request, once; None while there is none."""
        return self._answer(wait=0.0)

    def close(self) -> None:
        """End the child."""
        self._waiting = self._given = None
        if self._child is not None:
            self._child.ask_to_end()
        for process in (self._child, self._spare):
            if process is not None:
                process.kill()
        self._child = self._spare = None

    def _hand_over(self, request: Request, *, again: bool = False) -> None:
        self.start()
        assert self._child is not None
        self._waiting, self._given, self._again = None, request, again
        self._child.hand_over(request)

    def _answer(self, wait: float) -> TrialReport | None:
        child = self._child
        if child is None or not child.busy:
            return None
        try:
            report = child.answers.get(timeout=wait) if wait else child.answers.get_nowait()
        except queue.Empty:
            return self._mind(child)
        if report is None:
            return self._bury(child)
        child.busy = False
        if isinstance(report.error, TrialCrash):  # it lost its context, and is of no more use
            self._replace()
        return self._told(report)

    def _mind(self, child: Process[TrialReport]) -> TrialReport | None:
        """See to a child that is still at it."""
        starting = 0.0 if child.is_ready else time.monotonic() - child.started
        if starting > _START:
            self._drop()
            message = f"the trial's process was not ready after {_START:g} s, so nothing could be tried"
            return self._told(TrialReport(False, TrialTimeout(message), seconds=starting))
        spent = child.seconds
        if spent > _SUSPICIOUS and self._spare is None:
            self._spare = Process(_MODULE, self._arguments)
        if self._waiting is not None and spent > _IMPATIENT:
            self._replace()
            self._hand_over(self._waiting)
            return None
        limit = self.limit_seconds
        if child.pass_seconds < limit:
            return None
        what, file = (child.doing.subject, Path(child.doing.file)) if child.doing else ("the trial", "")
        by = f" by the {child.doing.driver} driver" if child.doing and child.doing.driver else ""
        self._replace()
        message = (
            f"{what} took longer than {limit:g} s{by} in the trial and was stopped; is there an endless loop?"
        )
        return self._told(TrialReport(False, TrialTimeout(message, file=file), seconds=limit))

    def _bury(self, child: Process[TrialReport]) -> TrialReport | None:
        """See to a child that died over a request."""
        spent, doing, was_ready = child.seconds, child.doing, child.is_ready
        cause = child.cause_of_death()
        if not was_ready:
            self._drop()
            message = f"the trial's process could not be started: it {cause}"
            return self._told(TrialReport(False, TrialCrash(message), seconds=spent))
        self._replace()
        if doing is None and self._given is not None and not self._again:
            # It had not begun: something else killed it, perhaps while it was idle.
            self._hand_over(self._given, again=True)
            return None
        what, file = (doing.subject, Path(doing.file)) if doing else ("this", "")
        return self._told(TrialReport(False, TrialCrash(f"{what} {cause}", file=file), seconds=spent))

    def _told(self, report: TrialReport) -> TrialReport | None:
        """Return an answer if it is the newest request's; else hand over the one that waits."""
        if self._given is not None:
            self._given = None
            return report
        if self._waiting is not None:
            self._hand_over(self._waiting)
        return None

    def _replace(self) -> None:
        """Put the spare, or a new child, in the child's place."""
        spare, self._spare = self._spare, None
        self._drop()
        self._child = spare if spare is not None and spare.runs else Process(_MODULE, self._arguments)
        if spare is not None and self._child is not spare:
            spare.kill()

    def _drop(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            child.kill()
