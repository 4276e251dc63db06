"""Judge many works side by side in worker processes; what stops one costs nobody else anything.

A work that takes too long, by the processor's time that it has had, ends with its process, and so does one
that crashes it or takes all memory. A process that died is replaced. A crash counts only if it happens again
in a new process: what went wrong there may be what an earlier work has left behind.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Generic, TypeVar

from playground.engine.context import ContextInfo
from playground.engine.process.messages import UnexpectedError
from playground.engine.process.worker import START_SECONDS, Closing, Launch, Replaceable, WorkerDied
from playground.errors import PlaygroundError, SandboxCrash, SandboxTimeout
from playground.lessons.grading.handler import JUDGING, Options, Request
from playground.lessons.grading.marks import Mark
from playground.lessons.translatable import Said

Key = TypeVar("Key")

WORKERS = 2
"""Processes side by side."""

LIMIT = 10.0
"""[s] of a processor that judging one work may take, where the model answer is not slow itself."""

TIMES_ANSWER = 10.0
"""A work may take so many times as long as the model answer, if that is more."""

MEMORY = 4 * 2**30
"""[bytes] that a process may take."""

_HANDLER = "playground.lessons.grading.handler"
_POLL = 0.02  # [s]
_STARTS = 2  # so many in a row may fail before none is tried any more
_ANSWER = 300.0  # [s] that drawing a model answer may take, which is not the student's time
_MOST_WORKS = 80  # of a process: a driver never forgets a shader


@dataclass(frozen=True)
class Stopped:
    """What ended the process that judged a work."""

    took_too_long: bool = False
    cause: str = ""  # of a crash


Outcome = Mark | Stopped


@dataclass
class _Slot(Generic[Key]):
    """One process, and the work that it judges."""

    workers: Replaceable
    key: Key | None = None
    request: Request | None = None
    repeated: bool = False
    judged: int = 0  # works by this process
    failed_starts: int = 0


@dataclass(frozen=True)
class _Item(Generic[Key]):
    key: Key
    request: Request
    repeated: bool = field(default=False)


class Judges(Closing):
    """Worker processes that judge; use it with ``with``, or call ``close()``."""

    def __init__(
        self, options: Options, workers: int = WORKERS, limit: float = LIMIT, memory_bytes: int = MEMORY
    ) -> None:
        self._limit = limit
        self._limits: dict[str, float] = {}  # [s] by exercise
        self.renderer = ""  # what draws, once something was judged
        launch = Launch(
            handler=_HANDLER,
            options=options,
            memory_bytes=memory_bytes,
            limit_seconds=2 * _ANSWER,
            # Processes side by side: each draws on a processor of its own.
            environment={"LP_NUM_THREADS": "1"} if workers > 1 else {},
        )
        self._slots: list[_Slot[object]] = [_Slot(Replaceable(launch)) for _ in range(workers)]

    def judge_all(self, requests: Iterable[tuple[object, Request]]) -> Iterator[tuple[object, Outcome]]:
        """Yield what comes of each request, with its key, as they are done.

        Raises ``PlaygroundError`` where it is nobody's work: no renderer, a model answer that fails.
        """
        waiting = deque(_Item(key, request) for key, request in requests)
        while waiting or any(slot.request is not None for slot in self._slots):
            for slot in self._slots:
                if slot.request is None and waiting:
                    self._begin(slot, waiting.popleft())
                found = self._poll(slot) if slot.request is not None else None
                if found is None:
                    continue
                item = _Item(slot.key, slot.request, slot.repeated)  # type: ignore[arg-type]
                slot.key = slot.request = None
                if isinstance(found, Stopped) and not found.took_too_long and not item.repeated:
                    waiting.appendleft(_Item(item.key, item.request, True))
                else:
                    yield item.key, found

    def limit_of(self, exercise: str) -> float:
        """Return how long judging a work of an exercise may take [s]."""
        return self._limits.get(exercise, self._limit)

    def close(self) -> None:
        """End the processes."""
        for slot in self._slots:
            slot.workers.close(patience=1.0)

    def _begin(self, slot: _Slot[object], item: _Item[object]) -> None:
        if slot.judged >= _MOST_WORKS:
            slot.workers.end()
        worker = slot.workers.worker
        if worker is None or not worker.runs:
            slot.judged = 0
        slot.key, slot.request, slot.repeated = item.key, item.request, item.repeated
        slot.judged += 1
        slot.workers.start().submit(item.request)

    def _poll(self, slot: _Slot[object]) -> Outcome | None:
        worker = slot.workers.worker
        assert worker is not None and slot.request is not None
        try:
            answer = worker.poll(_POLL / len(self._slots))
        except WorkerDied as died:
            slot.workers.end(kill=True)
            if not died.report.was_ready:
                self._start_again(slot, died.report.ending + died.report.last_lines)
                return None
            return Stopped(cause=died.report.cause())
        if answer is None:
            if worker.starting_seconds > START_SECONDS:
                slot.workers.end(kill=True)
                self._start_again(slot, f"was not ready after {START_SECONDS:g} s")
                return None
            limit = self.limit_of(slot.request.exercise) if worker.progress == JUDGING else _ANSWER
            if worker.activity_seconds < limit:
                return None
            slot.workers.end(kill=True)
            if worker.progress != JUDGING:
                raise SandboxTimeout(f"the answer of {slot.request.exercise} took more than {limit:g} s")
            return Stopped(took_too_long=True)
        slot.failed_starts = 0
        info = worker.wait_until_ready()
        assert isinstance(info, ContextInfo)
        self.renderer = info.renderer
        if isinstance(answer.error, SandboxCrash | MemoryError | UnexpectedError):
            slot.workers.end(kill=True)
            return Stopped(cause=_cause(answer.error))
        if isinstance(answer.error, PlaygroundError):
            raise answer.error
        found = answer.get()
        assert isinstance(found, Mark)
        if slot.request.text is None:
            # By its own clock, as the limit is kept: on a busy machine the wall's would give much more.
            longest = min(max(self._limit, TIMES_ANSWER * worker.seconds), _ANSWER)
            self._limits[slot.request.exercise] = float(round(longest))
        return found

    def _start_again(self, slot: _Slot[object], how: str) -> None:
        """Start another process for the same work; raise ``SandboxCrash`` where none starts."""
        slot.failed_starts += 1
        if slot.failed_starts >= _STARTS:
            raise SandboxCrash(f"the process that judges {how}")
        assert slot.request is not None
        slot.workers.start().submit(slot.request)


def _cause(error: Exception) -> str:
    if isinstance(error, MemoryError):
        return Said("ran out of memory")
    if isinstance(error, SandboxCrash):
        return error.diagnostics[0].message
    return Said("could not be judged: {why}", why=error.args[0])
