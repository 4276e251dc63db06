"""Try a changed sketch in a worker process first, so that what kills the driver kills only that.

The worker keeps its own headless context warm, draws one small frame, and is killed when it
takes too long or too much memory. Parent and worker share the driver's shader cache, so what
the worker compiled compiles at once for the parent.

The limit is on processor time, for each pass, in all its steps: whichever exceeds it is named. A sketch of
many slow passes is tried to its end, and one with large data files has the time to read them besides.

A worker that died is replaced at once, and one that takes suspiciously long has a spare,
warm by the time that it is needed. A newer request does not wait for a
worker that hangs: that is killed, and the spare takes its place.
"""

from __future__ import annotations

from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path

from playground.engine.files import find_file
from playground.engine.process.crash_report import CrashReport
from playground.engine.process.messages import Answer, summary_of
from playground.engine.process.worker import Closing, Launch, Replaceable, Worker, WorkerDied
from playground.errors import DataError, PlaygroundError, SandboxCrash, SandboxTimeout
from playground.sketch.assign import values_of
from playground.sketch.model import Sketch
from playground.sketch.traits import traits_of

LIMIT_SECONDS = 10.0
LIMIT_BYTES = 4 * 2**30
_START = 60.0  # [s] that a worker may take to start Python and open a context
_SUSPICIOUS = 0.3  # [s] after which a spare is started for a worker that has not answered
_IMPATIENT = 0.5  # [s] after which a worker is killed for something newer
_MAX_TRIES = 3  # of a request whose worker is killed before it has begun
_HANDLER = "playground.engine.sandbox_handler"
_SLOW_READ = 2**24  # [bytes/s] of a large data file: a quarter of what deflate takes
_LARGE = 2**26  # [bytes] above which a data file is given that time besides
_LONGEST_READ = 120.0  # [s]


@dataclass(frozen=True)
class TrySketch:
    """Draw one small frame of a sketch, by each driver named.

    Where a sketch has state and its ``time`` needs more frames than run in a moment, an earlier one is drawn.
    """

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
    unsaved: tuple[tuple[Path, str], ...] = ()  # texts in place of what files hold, by absolute path


Request = TrySketch | TryLibrary


@dataclass(frozen=True)
class SandboxReport:
    """What came of a request."""

    ok: bool
    error: PlaygroundError | None = None
    skipped: tuple[str, ...] = ()  # what could not be tried here, as "compute"
    seconds: float = 0.0


@dataclass(frozen=True)
class Activity:
    """What the worker is about to do."""

    path: str  # of the pass; empty for a file alone
    file: str  # absolute path of its text
    driver: str = field(default="", kw_only=True)  # where the request names several

    @property
    def subject(self) -> str:
        """What it is, as a sentence's subject."""
        return f"pass '{self.path}'" if self.path else "this file"


def reading_seconds(request: Request) -> float:
    """Return how long a request may take to read its large data files, besides all else [s]."""
    if not isinstance(request, TrySketch):
        return 0.0
    files = traits_of(request.sketch).files
    values = values_of(request.sketch) if files else {}
    size = 0
    for path, parameter in files:
        with suppress(DataError, OSError):  # what is missing is the plan's to report
            file = find_file(str(values[path]), request.sketch.folder, parameter.file, path)
            own = file.stat().st_size
            size += own if own > _LARGE else 0
    return min(size / _SLOW_READ, _LONGEST_READ)


class Sandbox(Closing):
    """A warm worker process that tries sketches.

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
        self.on_answer: Callable[[], None] = lambda: None  # called, in another thread, when ``poll`` has news
        self.while_waiting: Callable[[], None] = lambda: None  # called while ``run`` waits; may raise
        self.limit_seconds = limit_seconds
        self._workers = Replaceable(
            Launch(
                handler=_HANDLER,
                options=(software, device),
                memory_bytes=memory_bytes,
                limit_seconds=limit_seconds + _LONGEST_READ,
                on_answer=lambda: self.on_answer(),
            )
        )
        self._current: Request | None = None  # what the worker is at, while that is the newest
        self._waiting: Request | None = None  # the newest, while the worker is still at an older one
        self._reading = 0.0  # [s] that its large data files may take besides
        self._tries = 0  # how many workers were sent what it is at; those before died of something else

    @property
    def busy(self) -> bool:
        """Whether a request waits for its answer."""
        return self._current is not None or self._waiting is not None

    def start(self) -> None:
        """Start the worker, so that it is warm when it is needed; does nothing if it runs."""
        self._workers.start()

    def run(self, request: Request) -> SandboxReport:
        """Try something and wait for the answer, no longer than the limit.

        What ``while_waiting`` raises leaves the request unanswered: the next one replaces it.
        """
        self.submit(request)
        while (report := self._report(timeout=0.05)) is None:
            self.while_waiting()
        return report

    def submit(self, request: Request) -> None:
        """Send a request to the worker; an earlier one that is still open will not be answered.

        Never waits: a worker that hangs reads nothing, so it is sent one request at a time.
        """
        worker = self._workers.worker
        if worker is not None and worker.busy and worker.runs:
            self._waiting, self._current = request, None
        else:
            self._send(request)

    def poll(self) -> SandboxReport | None:
        """Return the answer to the newest request, once; None while there is none."""
        return self._report(timeout=0.0)

    def close(self) -> None:
        """End the worker."""
        self._waiting = self._current = None
        self._workers.close(patience=1.0)

    def _send(self, request: Request, *, tries: int = 1) -> None:
        self._waiting, self._current, self._tries = None, request, tries
        self._reading = reading_seconds(request)
        self._workers.start().submit(request)

    def _report(self, timeout: float) -> SandboxReport | None:
        worker = self._workers.worker
        if worker is None or not worker.busy:
            return None
        try:
            answer = worker.poll(timeout)
        except WorkerDied as died:
            return self._crashed(worker, died.report)
        if answer is None:
            return self._check_time(worker)
        report = _report_of(answer)
        if isinstance(report.error, SandboxCrash):  # it lost its context, and is of no more use
            self._workers.replace()
        return self._newest(report)

    def _check_time(self, worker: Worker) -> SandboxReport | None:
        """Start a spare for a worker that takes long, and kill the worker where it takes too long."""
        starting, spent, limit = worker.starting_seconds, worker.seconds, self.limit_seconds + self._reading
        if starting > _START:
            self._workers.end(kill=True)
            message = f"the sandbox's process was not ready after {_START:g} s, so nothing could be tried"
            return self._newest(SandboxReport(False, SandboxTimeout(message), seconds=starting))
        if spent > _SUSPICIOUS:
            self._workers.start_spare()
        if self._waiting is not None and spent > _IMPATIENT:
            self._workers.replace()
            self._send(self._waiting)
            return None
        if worker.activity_seconds < limit:
            return None
        what, file, driver = _doing(worker.progress, "the request")
        by = f" by the {driver} driver" if driver else ""
        self._workers.replace()
        message = (
            f"{what} took longer than {limit:g} s{by} in the sandbox, in processor time, and was stopped:"
            " it is slow, or a loop does not end"
        )
        return self._newest(SandboxReport(False, SandboxTimeout(message, file=file), seconds=limit))

    def _crashed(self, worker: Worker, report: CrashReport) -> SandboxReport | None:
        """Replace a worker that died over a request, and report it."""
        spent, cause = worker.seconds, report.cause(" in the sandbox")
        self._workers.end(kill=True)
        if report.progress is None and self._current is not None and self._tries < _MAX_TRIES:
            # It had not begun: something else killed it, perhaps while it was idle or starting.
            self._send(self._current, tries=self._tries + 1)
            return None
        if not report.was_ready:
            message = f"the sandbox's process could not be started: it {cause}"
            return self._newest(SandboxReport(False, SandboxCrash(message), seconds=spent))
        self._workers.start()
        what, file, _ = _doing(report.progress, "this")
        return self._newest(SandboxReport(False, SandboxCrash(f"{what} {cause}", file=file), seconds=spent))

    def _newest(self, report: SandboxReport) -> SandboxReport | None:
        """Return a report if it is the newest request's; else send the request that waits."""
        if self._current is not None:
            self._current = None
            return report
        if self._waiting is not None:
            self._send(self._waiting)
        return None


def _doing(progress: object, otherwise: str) -> tuple[str, str | Path, str]:
    """Return what a worker was at as a sentence's subject, its file and its driver."""
    if isinstance(progress, Activity):
        return progress.subject, Path(progress.file), progress.driver
    return otherwise, "", ""


def _report_of(answer: Answer) -> SandboxReport:
    if isinstance(answer.value, SandboxReport):
        return replace(answer.value, seconds=answer.seconds)
    error = answer.error
    if isinstance(error, MemoryError):
        error = PlaygroundError("the sandbox ran out of memory")
    elif not isinstance(error, PlaygroundError):
        error = PlaygroundError(f"the sandbox failed: {summary_of(error)}")
    return SandboxReport(False, error, seconds=answer.seconds)
