"""Draw candidates in a worker process, which is replaced when it crashes or hangs: answers, both."""

from __future__ import annotations

from collections.abc import Mapping

from playground.engine.context import ContextInfo
from playground.engine.process.worker import Closing, Launch, Replaceable, Worker, WorkerDied, WorkerTimeout
from playground.engine.sandbox import LIMIT_BYTES
from playground.errors import ContextError, SandboxCrash
from playground.reduce.draw_handler import DrawResult, DrawTask

LIMIT = 10.0
"""[s] What one candidate may take before it counts as one that hangs."""

_FIRST_EXTRA = (
    60.0  # [s] more for a process's first answer: it compiles every pass and draws them at full size
)


class CandidateProcess(Closing):
    """Draws candidates in a process of its own, with an environment of its own.

    Mesa's shader cache is off there: a text that crashes the compiler must meet the compiler.
    Use it with ``with``, or call ``close()``.
    """

    def __init__(
        self,
        *,
        software: bool = False,
        device: int | None = None,
        environment: Mapping[str, str] | None = None,
        limit: float = LIMIT,
    ) -> None:
        self.limit = limit  # [s]
        self._environment = {"MESA_SHADER_CACHE_DISABLE": "true", **(environment or {})}
        self._workers = Replaceable(
            Launch(
                handler="playground.reduce.draw_handler",
                options=(software, device),
                memory_bytes=LIMIT_BYTES,
                limit_seconds=limit + _FIRST_EXTRA,
                environment=self._environment,
            )
        )
        self._dies = False  # a candidate has ended a process
        self._warm = False  # the process has answered before

    @property
    def info(self) -> ContextInfo:
        """What draws; raises ``ContextError`` where there is no such renderer."""
        info = self._start().wait_until_ready()
        assert isinstance(info, ContextInfo)
        return info

    @property
    def started(self) -> int:
        """How many processes there were."""
        return self._workers.started

    def draw(self, task: DrawTask) -> DrawResult:
        """Draw, and return what came of it; a crash and a hang are results too."""
        worker = self._start()
        # Where candidates die, a process answers seldom more than once: then the limit is the limit.
        extra = 0.0 if self._warm or self._dies else _FIRST_EXTRA
        try:
            result = worker.ask(task, self.limit + extra)
        except WorkerDied as died:
            self._dies = True
            self.renew()
            if isinstance(died, WorkerTimeout):
                return DrawResult("hang", details=f"it took more than {self.limit:g} s and was stopped")
            return DrawResult("crash", details=f"the process {died.report.ending}")
        assert isinstance(result, DrawResult)
        self._warm = True
        return result

    def renew(self) -> None:
        """End the process, so that the next candidate meets a fresh one."""
        self._warm = False
        self._workers.end(patience=0.5)

    def close(self) -> None:
        """End the process; the next task starts another."""
        self._warm = False
        self._workers.close(patience=0.5)

    def _start(self) -> Worker:
        worker = self._workers.start()
        if self._dies:  # the next is made ready while this one draws
            self._workers.start_spare()
        try:
            worker.wait_until_ready()
        except ContextError:
            self.close()
            raise
        except WorkerDied as died:
            self.close()
            wanted = " ".join(f"{name}={value}" for name, value in self._environment.items())
            message = f"no context could be opened: the process {died.report.ending} ({wanted})"
            raise (SandboxCrash if died.report.signal_name else ContextError)(message) from None
        return worker
