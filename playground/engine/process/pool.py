"""A pool of worker processes: send requests, get an ``Outcome`` of each, whatever it does to its process.

It has the interface of ``concurrent.futures.Executor``, but for the function, which is the handler's:
``submit`` takes a request and returns a future. A request that takes too long or too much memory, hangs, or
crashes the driver costs its process, which is replaced; what came of it is an outcome like any other. A
future's result is raised only where no process can be started at all (``OSError``).

Each process has a thread here that talks to it, so that no caller waits for one that hangs; another thread
looks at the clock. Limits are processor time (see ``times_of``). A cluster's pool needs ``submit`` and
``shutdown`` alone: its workers may each have a pool of one process, and give back its outcome.
"""

from __future__ import annotations

import contextlib
import math
import queue
import threading
import time
from collections.abc import Iterable, Iterator, Mapping
from concurrent.futures import CancelledError, Executor, Future
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, Self

from playground.engine.process.child import ChildProcess, Outcome, ProcessDied, max_wall_seconds
from playground.engine.process.worker import Cancelled, UnexpectedError
from playground.errors import SandboxCrash

OPEN = object()
"""The request to start, if it does not run; the answer is what the handler tells of itself."""

CANCEL_SECONDS = 10.0
"""[s] that a request may take to stop once it is cancelled."""

_GRACE = 60.0  # [s] that the parent has to end a request before the system does
_POLL = 0.05  # [s] between two looks at the clock
PATIENCE = 1.0  # [s] that a process with nothing to do may take to end by itself
_MAX_LOST = 3  # processes that may die before a request has begun
_SUSPICIOUS = 0.3  # [s] after which a spare is started for a process that has not answered
_FATAL = (SandboxCrash, MemoryError, UnexpectedError)  # after which a process is of no more use


@dataclass(frozen=True, kw_only=True)
class Limits:
    """What a process, and a request, may take."""

    seconds: float = math.inf  # [s] of processor time, each activity that the handler reports
    total_seconds: float = math.inf  # [s] of processor time, a request
    longer: Mapping[object, float] = field(default_factory=dict)  # [s] instead, for some activities
    start_seconds: float = 120.0  # [s] to start Python and open a context, with a cold shader cache
    memory_bytes: int | None = None  # None: as many as the machine has
    requests: float = math.inf  # that a process answers before another takes its place
    crashes: int = 1  # of a request: it is tried again, in a new process, until it has caused so many


class Task(Future[Outcome]):
    """A request that was submitted: a future that may also be stopped while it runs."""

    def __init__(self, request: object, limit: float) -> None:
        super().__init__()
        self.request, self.limit = request, limit
        self.progress: Any = None  # what the handler reported last
        self.begun = False  # in the process that it was sent to last
        self.stop_at = math.inf  # as time.monotonic: when it is killed, for it was cancelled
        self.slot: _Slot | None = None  # where it runs

    @property
    def seconds(self) -> float:
        """How long it has run so far [s], from when its process was ready for it: of processor time."""
        process = self.slot.process if self.slot is not None else None
        return process.clock.total if process is not None else 0.0

    def cancel(self, grace: float = CANCEL_SECONDS) -> bool:
        """Withdraw the request; one that runs stops at its next report, or is killed after ``grace`` seconds.

        Its outcome is a refusal by ``Cancelled``, unless it is done before. Return whether it stops.
        """
        if super().cancel():
            return True
        self.stop_at = min(self.stop_at, time.monotonic() + max(grace, 0.0))
        if (slot := self.slot) is not None:
            slot.cancel(self)
        return not self.done()

    def wait(self, timeout: float) -> bool:
        """Wait for the outcome, no longer than ``timeout`` seconds; return whether it is there."""
        with contextlib.suppress(TimeoutError, CancelledError):
            self.exception(timeout)
        return self.done()

    def result(self, timeout: float | None = None) -> Outcome:
        """Return the outcome; raise ``TimeoutError`` where it is not there in time."""
        while timeout is None and not self.wait(_POLL):
            pass  # in slices: on Windows Ctrl-C is seen only between two of them
        try:
            return super().result(timeout)
        except CancelledError:  # before it ran
            return Outcome("refused", error=Cancelled())


class Pool(Executor):
    """Processes that answer by one handler; they start when they are needed.

    Use it with ``with``, or call ``shutdown``; a request after that starts them again.
    """

    def __init__(
        self,
        handler: str,
        limits: Limits = Limits(),
        *,
        options: object = None,
        workers: int = 1,
        spare: bool = False,
        ends_with_parent: bool = True,
        environment: Mapping[str, str] | None = None,
        folder: Path | None = None,
    ) -> None:
        """Make it; nothing starts.

        ``handler`` is the module that answers, with a function ``open_service`` that is given ``options``.
        With a ``spare``, another process is kept warm as soon as one takes long or has died. A process ends
        with its parent at once, where the system can do that; else with what it reports next.
        ``environment`` is added to this process's; ``folder`` is where the processes work.
        """
        setup = options, limits.memory_bytes
        self._new_process = partial(ChildProcess, handler, setup, environment or {}, folder, ends_with_parent)
        self.limits, self._workers, self._keeps_spare = limits, workers, spare
        self.started = 0  # how many processes there were
        self.died = False  # whether one died of a request
        self._lock = threading.Lock()
        self._slots: list[_Slot] = []
        # Simple queues: Ctrl-C in the midst of a call leaves no lock of theirs taken.
        self._tasks: queue.SimpleQueue[Task | None] = queue.SimpleQueue()  # None: no more
        self._spare: ChildProcess | None = None

    def submit(self, request: object, /, *, seconds: float | None = None) -> Task:  # type: ignore[override]
        """Have a request answered, each of its activities within its own ``seconds``; never waits."""
        task = Task(request, self.limits.seconds if seconds is None else seconds)
        with self._lock:
            if not self._slots:
                working = threading.Event()
                self._slots = [_Slot(self, self._tasks, working) for _ in range(self._workers)]
                threading.Thread(target=_watch, args=[self._slots, working], daemon=True).start()
            self._tasks.put(task)
        return task

    def run(self, request: object, *, seconds: float | None = None) -> Outcome:
        """Return what comes of a request; one that is interrupted, as by Ctrl-C, is killed."""
        task = self.submit(request, seconds=seconds)
        try:
            return task.result()
        except BaseException:
            task.cancel(0.0)
            raise

    def map(self, requests: Iterable[object]) -> Iterator[Outcome]:  # type: ignore[override]
        """Yield the outcome of each request, in their order."""
        tasks = [self.submit(request) for request in requests]
        try:
            for task in tasks:
                yield task.result()
        finally:
            for task in tasks:
                task.cancel(0.0)

    def renew(self) -> None:
        """Have the next requests meet fresh processes."""
        for slot in self._slots:
            if slot.process is not None:
                slot.process.requests = math.inf

    @property
    def pids(self) -> list[int]:
        """The numbers of the processes, the spare's last."""
        processes = [*(slot.process for slot in self._slots), self._spare]
        return [process.pid for process in processes if process is not None]

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End the processes once they have answered; with ``cancel_futures`` at once, whatever they do."""
        with self._lock:
            tasks, self._tasks = self._tasks, queue.SimpleQueue()
            slots, self._slots = self._slots, []
            spare, self._spare = self._spare, None
        if cancel_futures:
            with contextlib.suppress(queue.Empty):
                while (task := tasks.get_nowait()) is not None:
                    task.cancel()
            for slot in slots:
                slot.close()
        for _ in slots:
            tasks.put(None)
        if spare is not None:
            spare.end(0.0)
        while wait and any(slot.is_alive() for slot in slots):
            for slot in slots:
                slot.join(_POLL)

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        self.shutdown(cancel_futures=kind is not None)

    def take_process(self) -> ChildProcess:
        """Return a new process, or the spare, for a slot."""
        with self._lock:
            spare, self._spare = self._spare, None
            if spare is not None and spare.runs:
                return spare
            self.started += 1
        if spare is not None:
            spare.end(0.0)
        return self._new_process()

    def warm_spare(self) -> None:
        """Start the process that is to take over, if there is none."""
        with self._lock, contextlib.suppress(OSError):
            if self._keeps_spare and self._spare is None and self._slots:
                self._spare = self._new_process()
                self.started += 1


class PoolOwner:
    """What draws by a pool of its own: use it with ``with``, or call ``close()``."""

    _pool: Pool
    _newest: Task | None = None  # until its outcome is taken

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """End the processes, whatever they do; the next request starts others."""
        self._newest = None
        self._pool.shutdown(cancel_futures=True)

    @property
    def pids(self) -> list[int]:
        """The numbers of its processes, the spare's last."""
        return self._pool.pids

    @property
    def busy(self) -> bool:
        """Whether the newest request waits for its outcome to be taken."""
        return self._newest is not None

    def _replace(self, request: object, patience: float, seconds: float | None = None) -> Task:
        """Submit the newest request; the one before is given up once it has run ``patience`` seconds."""
        if self._newest is not None:
            self._newest.cancel(patience - self._newest.seconds)
        self._newest = self._pool.submit(request, seconds=seconds)
        return self._newest

    def _take(self) -> Task | None:
        """Return the newest request, once, when it is done."""
        if self._newest is None or not self._newest.done():
            return None
        task, self._newest = self._newest, None
        return task


def _watch(slots: list[_Slot], working: threading.Event) -> None:
    """Look at the clock while a slot is at work."""
    while not all(slot.ended for slot in slots):
        working.wait()
        working.clear()
        time.sleep(_POLL)
        if any([slot.check() for slot in slots]):
            working.set()


class _Slot(threading.Thread):
    """One process at a time, and the thread that talks to it."""

    def __init__(self, pool: Pool, tasks: queue.SimpleQueue[Task | None], working: threading.Event) -> None:
        super().__init__(name="pool", daemon=True)
        self.process: ChildProcess | None = None
        self.ended = False
        self._pool, self._tasks = pool, tasks
        self._working = working  # set by what has a limit, which is then looked at
        self._task: Task | None = None  # that the process is at
        self._closed = False
        self._lock = threading.Lock()  # of the process's beginning and end, and of what it is at
        self.start()

    def run(self) -> None:
        while (task := self._tasks.get()) is not None:
            if task.set_running_or_notify_cancel():
                try:
                    task.set_result(self._outcome(task))
                except BaseException as error:  # no process can be started, or a bug of ours
                    task.set_exception(error)
            del task  # it may hold much
        self._end(PATIENCE)
        self.ended = True
        self._working.set()  # so that the thread that looks at the clock ends

    def _outcome(self, task: Task) -> Outcome:
        lost = crashes = 0  # processes: before the request began, by it
        while True:
            task.begun, task.progress = False, None
            try:
                outcome = self._asked(task)
            except ProcessDied:
                outcome = self._death(task)
            task.slot = None
            if outcome.kind in ("answer", "refused"):
                return outcome
            self._end(0.0)
            crashes, lost = crashes + task.begun, lost + (not task.begun)
            if outcome.kind == "hang" or crashes >= self._pool.limits.crashes or lost >= _MAX_LOST:
                if outcome.started:  # another is warm by the time that it is needed
                    self._pool.died = True
                    with contextlib.suppress(ProcessDied, OSError):
                        self._process()
                return outcome

    def _asked(self, task: Task) -> Outcome:
        """Send a request to the process, and return what comes back."""
        process, limits = self._ready_process(), self._pool.limits
        assert process.ready is not None
        info, error = process.ready.value, process.ready.error
        if error is not None:
            return Outcome("refused", None, error, False)
        if task.request is OPEN:
            return Outcome("answer", info, info=info)
        longest = max(task.limit, *limits.longer.values(), 0.0)
        alarm = max_wall_seconds(longest) + _GRACE if math.isfinite(longest) else 0.0
        try:
            data = process.encoder.encode((alarm, task.request))
        except Exception as error:  # it cannot be pickled
            return Outcome("refused", error=error)
        with self._lock:
            if self._closed or task.stop_at < math.inf:
                return Outcome("refused", error=Cancelled())
            process.clock.begin(None)
            process.requests += 1
            self._task, task.slot = task, self
        self._working.set()
        process.send(data)
        process.encoder.sent()
        while (message := process.receive()).kind != "answer":
            if message.kind == "progress":
                process.clock.begin(message.value)
                task.progress = message.value
                continue
            with self._lock:
                task.begun = True
                if task.stop_at < math.inf:
                    process.cancel()
        with self._lock:
            seconds, self._task = process.clock.total, None
            process.clock.clear()
        kind: Literal["answer", "refused", "crash"] = "answer" if message.error is None else "refused"
        kind = "crash" if isinstance(message.error, _FATAL) else kind
        return Outcome(
            kind, message.value, message.error, True, info, task.progress, seconds, printed=process.printed()
        )

    def _death(self, task: Task) -> Outcome:
        """Return what the end of the process means for the task."""
        process = self.process
        seconds, limit = (process.clock.total, process.exceeded) if process is not None else (0.0, 0.0)
        outcome = replace(self._end(PATIENCE), seconds=seconds, progress=task.progress)
        if self._closed or task.stop_at < math.inf:
            return replace(outcome, kind="refused", error=Cancelled())
        if limit and (task.begun or not outcome.started):
            return replace(outcome, kind="hang", limit=limit)
        return outcome

    def _ready_process(self) -> ChildProcess:
        """Return the process, once it is ready; start one where there is none that runs."""
        process = self.process
        if process is not None and (process.requests >= self._pool.limits.requests or not process.runs):
            self._end(PATIENCE)
        process = self._process()
        if process.ready is None:
            process.clock.begin("start")
            self._working.set()
            process.ready = process.receive()
            process.clock.clear()
        return process

    def _process(self) -> ChildProcess:
        with self._lock:
            if self._closed:
                raise ProcessDied
            if self.process is None:
                self.process = self._pool.take_process()
            return self.process

    def _end(self, patience: float) -> Outcome:
        with self._lock:
            process, self.process, self._task = self.process, None, None
        return process.end(patience) if process is not None else Outcome("crash")

    # ── from other threads ───────────────────────────────────────────────────

    def check(self) -> bool:
        """Kill a process that takes too long; return whether the slot is at work."""
        limits = self._pool.limits
        with self._lock:
            process, task = self.process, self._task
            if process is None or not (spent := process.clock.total):
                return False
            own, total = limits.start_seconds, math.inf
            if task is not None:
                own, total = limits.longer.get(task.progress, task.limit), limits.total_seconds
            exceeded = total if spent > total else 0.0
            if spent > own and process.clock.seconds > own:
                exceeded = own
            if exceeded or (task is not None and time.monotonic() > task.stop_at):
                process.kill(exceeded)
        if spent > _SUSPICIOUS and task is not None:
            self._pool.warm_spare()
        return True

    def cancel(self, task: Task) -> None:
        """Have a task's handler stop, if it has begun; else it is told so when it begins."""
        with self._lock:
            if self._task is task and task.begun and self.process is not None:
                self.process.cancel()

    def close(self) -> None:
        """Give up what is at work; the thread ends with it."""
        with self._lock:
            self._closed = True
            if self.process is not None and (self.process.ready is None or self._task is not None):
                self.process.kill(0.0)
