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

from playground.engine.process.child import Outcome
from playground.engine.process.pool import OPEN, Limits, Pool, PoolOwner, Task
from playground.engine.process.worker import summary_of
from playground.errors import DataError, PlaygroundError, SandboxCrash, SandboxTimeout
from playground.sketch.assign import values_of
from playground.sketch.files import find_file
from playground.sketch.model import Sketch
from playground.sketch.traits import traits_of

LIMIT_SECONDS = 10.0
LIMIT_BYTES = 4 * 2**30
_HANDLER = "playground.engine.sandbox_handler"
_START = 60.0  # [s] that a worker may take to start Python and open a context
_IMPATIENT = 0.5  # [s] after which a worker is killed for something newer
_SLOW_READ = 2**24  # [bytes/s] of a large data file: a quarter of what deflate takes
_LARGE = 2**26  # [bytes] above which a data file is given that time besides
_MAX_READ = 120.0  # [s]


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


@dataclass(frozen=True)
class TryTrace:
    """Trace one texel of a pass in a small frame of a sketch.

    Driver and sandbox share the cache of shaders on disk: the window's own trace compiles sooner then.
    """

    sketch: Sketch
    path: str  # of the pass, as the frame has it
    function: str | None = None  # as ``Engine.trace`` takes it
    size: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]


Request = TrySketch | TryLibrary | TryTrace


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
        """What it is, as a message's subject."""
        return f"pass '{self.path}'" if self.path else "this file"


def reading_seconds(request: Request) -> float:
    """Return how long a request may take to read its large data files, besides all else [s]."""
    if not isinstance(request, TrySketch | TryTrace):
        return 0.0
    files = traits_of(request.sketch).files
    values = values_of(request.sketch) if files else {}
    size = 0
    for path, parameter in files:
        with suppress(DataError, OSError):  # what is missing is the plan's to report
            file = find_file(str(values[path]), request.sketch.folder, parameter.file, path)
            own = file.stat().st_size
            size += own if own > _LARGE else 0
    return min(size / _SLOW_READ, _MAX_READ)


class Sandbox(PoolOwner):
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
        limits = Limits(memory_bytes=memory_bytes, start_seconds=_START)
        self._pool = Pool(_HANDLER, limits, options=(software, device), spare=True)

    def start(self) -> None:
        """Start the worker, so that it is warm when it is needed; does nothing if it runs."""
        self._pool.submit(OPEN)

    def run(self, request: Request) -> SandboxReport:
        """Try something and wait for the answer, no longer than the limit.

        What ``while_waiting`` raises leaves the request unanswered: the next one replaces it.
        """
        task = self.submit(request)
        while not task.wait(0.05):
            self.while_waiting()
        report = self.poll()
        assert report is not None
        return report

    def submit(self, request: Request) -> Task:
        """Send a request to the worker; an earlier one that is still open will not be answered."""
        limit = self.limit_seconds + reading_seconds(request)
        task = self._replace(request, _IMPATIENT, limit)
        task.add_done_callback(lambda done: self.on_answer() if done is self._newest else None)
        return task

    def poll(self) -> SandboxReport | None:
        """Return the answer to the newest request, once; None while there is none."""
        task = self._take()
        if task is None:
            return None
        outcome = task.result()
        if outcome.kind == "answer":
            assert isinstance(outcome.value, SandboxReport)
            return replace(outcome.value, seconds=outcome.seconds)
        return SandboxReport(False, _error_of(outcome), seconds=outcome.seconds)


def _error_of(outcome: Outcome) -> PlaygroundError:
    if not outcome.started or outcome.error is not None:
        error = outcome.failure("the sandbox")
        if isinstance(error, PlaygroundError):
            return error
        return PlaygroundError(f"the sandbox failed: {summary_of(error)}")
    at = outcome.progress
    assert at is None or isinstance(at, Activity)
    file = Path(at.file) if at else ""
    if outcome.kind == "crash":
        return SandboxCrash(f"{at.subject if at else 'this'} {outcome.cause(' in the sandbox')}", file=file)
    by = f" by the {at.driver} driver" if at and at.driver else ""
    message = (
        f"{at.subject if at else 'the request'} took longer than {outcome.limit:g} s{by} in the sandbox, in"
        " processor time, and was stopped: it is slow, or a loop does not end"
    )
    return SandboxTimeout(message, file=file)
