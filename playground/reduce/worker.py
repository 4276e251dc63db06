"""A child process that looks at candidates, and is replaced when it crashes or hangs."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
import threading
from collections.abc import Iterator, Mapping
from pathlib import Path

from playground.engine.sandbox import LIMIT_BYTES
from playground.engine.sandbox_process import receive, send
from playground.errors import ContextError, PlaygroundError, TrialCrash
from playground.gpu.context import ContextInfo
from playground.reduce.child import Seen, Task

LIMIT = 10.0
"""[s] What one candidate may take before it counts as one that hangs."""

_FIRST_EXTRA = (
    60.0  # [s] more for a process's first answer: it compiles every pass and draws them at full size
)
_OPENING = 120.0  # [s] for Python and a context, on a busy machine


class Worker:
    """Draws what it is asked for in a process of its own, with an environment of its own.

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
        self.started = 0  # how many processes there were
        renderer = "software" if software else "any"
        number = "" if device is None else str(device)
        self._arguments = [str(LIMIT_BYTES), renderer, number, str(limit + 2 * _FIRST_EXTRA)]
        self._environment = {"MESA_SHADER_CACHE_DISABLE": "true", **(environment or {})}
        self._process: subprocess.Popen[bytes] | None = None
        self._spare: subprocess.Popen[bytes] | None = None  # starting, from the first death on
        self._dies = False
        self._warm = False  # the process has answered before
        self._info: ContextInfo | None = None

    def __enter__(self) -> Worker:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def info(self) -> ContextInfo:
        """What draws; raises ``ContextError`` where there is no such renderer."""
        self._start()
        assert self._info is not None
        return self._info

    def look(self, task: Task) -> Seen:
        """Draw, and return what came of it; a crash and a hang are answers too."""
        process = self._start()
        assert process.stdin is not None and process.stdout is not None
        late = threading.Event()
        answer: object = None
        # Where candidates die, a process answers seldom more than once: then the limit is the limit.
        extra = 0.0 if self._warm or self._dies else _FIRST_EXTRA
        with _killed_after(process, self.limit + extra, late), contextlib.suppress(OSError):
            send(process.stdin, task)
            answer = receive(process.stdout)
        if isinstance(answer, Seen):
            self._warm = True
            return answer
        process.kill()
        code = process.wait()
        self._end_process()
        self._dies = True
        if late.is_set():
            return Seen("hang", told=f"it took more than {self.limit:g} s and was stopped")
        how = f"was killed by signal {-code}" if code < 0 else f"ended with status {code}"
        return Seen("crash", told=f"the process {how}")

    def renew(self) -> None:
        """End the process, so that the next candidate meets a fresh one."""
        self._end_process()

    def close(self) -> None:
        """End the process; the next task starts another."""
        self._end_process()
        self._process, self._spare = self._spare, None
        self._end_process()

    def _end_process(self) -> None:
        process, self._process = self._process, None
        self._warm = False
        if process is None:
            return
        assert process.stdin is not None and process.stdout is not None
        with contextlib.suppress(OSError):
            process.stdin.close()  # it ends at the end of its input
        with contextlib.suppress(subprocess.TimeoutExpired):
            process.wait(0.5)
        process.kill()
        process.wait()
        process.stdout.close()

    def _start(self) -> subprocess.Popen[bytes]:
        if self._process is not None:
            return self._process
        process, self._spare = self._spare or self._open(), None
        self._process = process
        if self._dies:  # the next is made ready while this one draws
            self._spare = self._open()
        assert process.stdout is not None
        with _killed_after(process, _OPENING, threading.Event()):
            info = receive(process.stdout)
        if isinstance(info, ContextInfo):
            self._info = info
            return process
        code = process.wait()
        self.close()
        if isinstance(info, PlaygroundError):
            raise info
        asked = " ".join(f"{name}={value}" for name, value in self._environment.items())
        message = f"no context could be opened: the process ended with status {code} ({asked})"
        raise ContextError(message) if code >= 0 else TrialCrash(message)

    def _open(self) -> subprocess.Popen[bytes]:
        self.started += 1
        where = os.pathsep.join(p or str(Path.cwd()) for p in sys.path)
        return subprocess.Popen(
            [sys.executable, "-P", "-m", "playground.reduce.child", *self._arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,  # a driver's own words; what it says of a text comes back as an answer
            env={**os.environ, "PYTHONPATH": where, **self._environment},
            start_new_session=True,
        )


@contextlib.contextmanager
def _killed_after(process: subprocess.Popen[bytes], seconds: float, late: threading.Event) -> Iterator[None]:
    def stop() -> None:
        late.set()
        process.kill()

    timer = threading.Timer(seconds, stop)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
