"""A child process as its parent has it: its pipes, what it prints, its end, and what came of a request."""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, Literal

from playground.engine.process.worker import CANCEL, Encoder, Message, read_frame, write_frame
from playground.errors import SandboxCrash, SandboxTimeout

_MAX_LINES = 12  # of what a process printed last
_WINDOWS = {0xC0000005: "an access violation", 0xC00000FD: "a stack overflow", 0xC0000409: "an abort"}
_CRASHES = ("SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT", "SIGTRAP", *_WINDOWS.values())
_MAIN = "from playground.engine.process.worker import main; main()"
_NO_MEMORY = ("out of memory", "bad_alloc", "memoryerror", "cannot allocate")


@dataclass(frozen=True)
class Outcome:
    """What came of a request.

    "refused": the handler, or its opening, raised an error. "crash": the process ended, or is of no more use,
    and ``error`` says why. "hang": it passed a limit and was killed.
    """

    kind: Literal["answer", "refused", "crash", "hang"]
    value: Any = None  # of an answer
    error: Exception | None = None
    started: bool = True  # whether the handler had opened
    info: Any = None  # what it told of itself then
    progress: Any = None  # what was reported last
    seconds: float = 0.0  # of processor time that it took
    limit: float = 0.0  # [s] that a hang passed
    printed: str = ""  # since the outcome before
    status: int | None = None  # of the process, as in ``subprocess``: negative for a signal; None: not known
    not_a_frame: str = ""  # what it sent instead of a message

    def get(self, what: str) -> Any:
        """Return the answer; raise ``failure`` where there is none."""
        if self.kind == "answer":
            return self.value
        raise self.failure(what)

    def failure(self, what: str) -> Exception:
        """Return the error, ``SandboxCrash`` or ``SandboxTimeout`` where the process had no time to say any.

        ``what`` is the request as a subject: "drawing hills/noon".
        """
        if not self.started:
            what = "starting the process that draws"
        if isinstance(self.error, MemoryError):
            return SandboxCrash(f"{what} ran out of memory")
        if self.error is not None:
            return self.error
        if self.kind == "hang":
            return SandboxTimeout(f"{what} took more than {self.limit:g} s and was stopped{self._last_lines}")
        how = self.ending if self.not_a_frame else f"crashed: the process {self.ending}"
        return SandboxCrash(f"{what} {how}{self._last_lines}")

    @property
    def signal_name(self) -> str:
        """The signal that ended the process, as "SIGSEGV", or its like on Windows; "" for none."""
        if self.status is None or self.status >= 0:
            return _WINDOWS.get(self.status or 0, "")
        try:
            return signal.Signals(-self.status).name
        except ValueError:
            return f"signal {-self.status}"

    @property
    def ending(self) -> str:
        """How the process ended, as what a message says of it."""
        if self.not_a_frame:
            return f"sent an invalid answer: {self.not_a_frame}"
        if self.signal_name:
            return f"was ended by {self.signal_name}"
        return "died" if self.status is None else f"ended with status {self.status}"

    def cause(self, where: str = "") -> str:
        """Say what killed it and, if it printed anything, the last line; ``where`` as " in the sandbox"."""
        last = self.printed.strip().split("\n")[-1].strip()
        how = self.signal_name or ("died" if not self.status else f"ended with status {self.status}")
        detail = f"{how}; its last output: {last}" if last else how
        if any(sign in last.lower() for sign in _NO_MEMORY):
            return f"ran out of memory{where} ({detail})"
        if how in _CRASHES:
            return f"crashed the driver or its compiler{where} ({detail})"
        if how == "SIGKILL":
            return f"was killed by the system{where} (SIGKILL); did memory run out?"
        return f"ended its process{where}: the driver or its compiler gave up, or memory ran out ({detail})"

    @property
    def _last_lines(self) -> str:
        lines = [line.rstrip() for line in self.printed.splitlines() if line.strip()][-_MAX_LINES:]
        return "".join(f"\n    | {line}" for line in lines)


class ProcessDied(Exception):
    """The process has ended, or is as good as dead."""


class ChildProcess:
    """One child process, and its pipes."""

    def __init__(
        self,
        handler: str,
        setup: tuple[object, int | None],
        environment: Mapping[str, str],
        folder: Path | None,
        ends_with_parent: bool,
    ) -> None:
        self.encoder = Encoder()
        self.ready: Message | None = None
        self.requests = 0.0  # that it was sent
        self.exceeded = 0.0  # [s] the limit for which it was killed
        self._not_a_frame = ""  # what it sent instead of a message
        self._output = tempfile.TemporaryFile()
        self._read = 0  # bytes of that
        # Name by name: another thread may delete a variable meanwhile.
        own = {name: value for name in os.environ if (value := os.environ.get(name)) is not None}
        pipe = os.pipe() if ends_with_parent and sys.platform == "linux" else ()
        try:
            # -P: what lies in the user's folder is no module of ours, even under the same name.
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-c", _MAIN, handler],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._output,
                env={**own, "PYTHONPATH": _module_path(), **environment},
                cwd=folder,
                pass_fds=pipe[:1],
                start_new_session=True,
            )
        except BaseException:
            self._output.close()
            for end in pipe[1:]:
                os.close(end)
            raise
        finally:
            for end in pipe[:1]:
                os.close(end)
        self._life = pipe[1:]
        assert self._process.stdin is not None and self._process.stdout is not None
        self._requests, self._answers = self._process.stdin, self._process.stdout
        self.pid = self._process.pid
        self.clock = ActivityClock(partial(times_of, self.pid))  # of what it is at; else cleared
        with contextlib.suppress(ProcessDied):  # which is found when it is asked
            self.send(pickle.dumps((*setup, *pipe[:1])))

    @property
    def runs(self) -> bool:
        """Whether the process lives."""
        return self._process.poll() is None

    def send(self, data: bytes) -> None:
        """Send a request; raise ``ProcessDied`` where the process has ended."""
        try:
            write_frame(self._requests, data)
        except OSError:
            raise ProcessDied from None

    def cancel(self) -> None:
        """Send that the request at work is to stop."""
        with contextlib.suppress(ProcessDied):
            self.send(CANCEL)

    def receive(self) -> Message:
        """Return the next message; raise ``ProcessDied`` at the end."""
        try:
            message: object = pickle.loads(read_frame(self._answers))
            if isinstance(message, Message):
                return message
            self._not_a_frame = f"a message of type {type(message).__name__}"
        except (OSError, EOFError):
            pass
        except Exception as error:  # no frame; and a pickle that is damaged raises anything at all
            self._not_a_frame = str(error)
        raise ProcessDied

    def printed(self) -> str:
        """Return what was printed since this was last called; nothing where a file has one position only."""
        if not hasattr(os, "pread"):
            return ""
        # By a position of its own: the process writes on at the file's, which it shares.
        data = os.pread(self._output.fileno(), 2**20, self._read)
        self._read += len(data)
        return data.decode("utf-8", "replace")

    def kill(self, limit: float) -> None:
        """Kill the process, from another thread, for it has passed a limit [s]; 0: for another reason."""
        self.exceeded = limit
        self._process.kill()

    def end(self, patience: float) -> Outcome:
        """End the process, by itself within ``patience`` seconds, else by force; return how it ended."""
        with contextlib.suppress(OSError):
            self._requests.close()  # so it ends
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(0.0 if self._not_a_frame else patience)
        self._process.kill()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        self._answers.close()
        for end in self._life:
            os.close(end)
        with self._output:
            self._output.seek(self._read)
            printed = self._output.read().decode("utf-8", "replace")
        return Outcome(
            "crash",
            started=self.ready is not None,
            printed=printed,
            status=self._process.returncode,
            not_a_frame=self._not_a_frame,
        )


def _module_path() -> str:
    """Return PYTHONPATH for a child that finds this package, and what it needs, as this process does."""
    package = str(Path(__file__).resolve().parents[3])
    return os.pathsep.join([package, *(path for path in sys.path if path)])


# ── processor time ───────────────────────────────────────────────────────────


_MAX_SLOWDOWN = 8.0  # times longer that something may take on a busy machine
_SHORT = 0.05  # [s] an activity so short is measured by the clock: to read the times takes a millisecond
_FRESH = 0.25  # [s] for which times that were read may be taken for those at an activity's beginning

Times = dict[str, tuple[int, int]]
"""Nanoseconds that each thread of a process has run, and has waited for a processor, since it began."""


def times_of(pid: int) -> Times:
    """Return the times of each thread so far; nothing where the system does not count.

    On a machine with ten things to do, a draw of a second takes five. Linux counts, for each thread, the time
    that it ran and the time that it was ready to run and did not (``/proc/PID/task/*/schedstat``: nanoseconds
    run, nanoseconds waited, times). Other systems do not, so there all time that passes counts.
    """
    times: Times = {}
    try:
        tasks = list(Path(f"/proc/{pid}/task").iterdir())
    except OSError:
        return times
    for task in tasks:
        try:
            ran, waited, *_ = map(int, (task / "schedstat").read_text("ascii").split())
        except (OSError, ValueError):
            continue  # it has ended meanwhile, or this system does not count
        times[task.name] = ran, waited
    return times


def worked(passed: float, before: Times, now: Times) -> float:
    """Return the seconds of those that passed in which a process worked.

    Of threads that work side by side, as a renderer's, the busiest one's time counts. Where no thread ran
    or waited for a processor, a graphics card or a disk may have worked for it, so that counts, too. So does
    a fraction of all that passed: what never ends must be stopped on the busiest machine.
    """
    none = (0, 0)
    spent = [[a - b for a, b in zip(now[name], before.get(name, none), strict=True)] for name in now]
    busiest = max((ran for ran, _ in spent), default=0) * 1e-9
    idle = passed - sum(ran + waited for ran, waited in spent) * 1e-9
    return min(max(busiest + max(idle, 0.0), passed / _MAX_SLOWDOWN), passed)


def max_wall_seconds(work: float) -> float:
    """Return the seconds that may pass, at the most, while a process works for so many."""
    return work * _MAX_SLOWDOWN if sys.platform == "linux" else work


@dataclass(frozen=True, slots=True)
class _Current:
    """The activity at work."""

    activity: Hashable
    began: float  # as time.monotonic
    times: Times  # when it began, or shortly before
    earlier: float  # [s] that it took in its steps before
    before: float  # [s] of all that was done before this step


class ActivityClock:
    """Measures each activity of a process, in all its steps; one thread sets it, others may read it.

    A process reports what it is about to do; what it did before has ended then. A reader reads ``_current``
    once, which holds all that it needs and is replaced whole.
    """

    def __init__(self, times: Callable[[], Times]) -> None:
        self._times_now = times
        self._times: Times = {}
        self._read_at = -_FRESH
        self._spent: dict[Hashable, float] = {}  # [s] of each activity, the current one left out
        self._current: _Current | None = None

    def clear(self) -> None:
        """Forget all: nothing is being done."""
        self._spent, self._current = {}, None

    def begin(self, activity: Hashable) -> None:
        """Begin an activity, or continue it; the one before has ended."""
        before = 0.0
        if self._current is not None:
            passed = self._passed(self._current)
            before = self._current.before + passed
            self._spent[self._current.activity] = self._current.earlier + passed
        now = time.monotonic()
        if now - self._read_at > _FRESH:
            self._times, self._read_at = self._times_now(), now
        self._current = _Current(activity, now, self._times, self._spent.get(activity, 0.0), before)

    def _passed(self, current: _Current) -> float:
        """Return how long the step at work has taken so far [s]."""
        passed = time.monotonic() - current.began
        return worked(passed, current.times, self._times_now()) if passed >= _SHORT else passed

    @property
    def seconds(self) -> float:
        """How long the current activity has taken so far, in all its steps [s]; 0 while there is none."""
        current = self._current
        return 0.0 if current is None else current.earlier + self._passed(current)

    @property
    def total(self) -> float:
        """How long all activities together have taken [s]."""
        current = self._current
        return 0.0 if current is None else current.before + self._passed(current)
