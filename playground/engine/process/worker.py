"""The parent's end of a worker: start a child process, send it requests, receive answers, kill it.

A thread talks to the process, so that no caller waits for one that hangs. Besides its answers
the process reports when it is ready, and what it is about to do: so it is known
what killed it.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import tempfile
import threading
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Self

from playground.engine.process import frames
from playground.engine.process.activity_clock import ActivityClock
from playground.engine.process.cpu_wait import longest, times_of
from playground.engine.process.crash_report import CrashReport
from playground.engine.process.kernel_pickle import Encoder
from playground.engine.process.messages import CANCEL, Answer, Progress, Ready, Setup

START_SECONDS = 120.0
"""[s] that starting Python and opening a context may take, on a busy machine with a cold shader cache."""

_GRACE = 60.0  # [s] that the parent has to end a request before the system does
_POLL = 0.05  # [s] between two looks at the clock
_PRINTED = 2**20  # characters that are stored of what was printed


@dataclass(frozen=True, kw_only=True)
class Launch:
    """How a child process is started."""

    handler: str  # the module that answers, with a function ``open_service``
    options: object = None  # for ``open_service``
    memory_bytes: int | None = None  # that it may take; None: as many as the machine has
    limit_seconds: float = 0.0  # after which the system ends a request, if its parent fails to; 0: never
    ends_with_parent: bool = True  # at once, where the system can; else with what it reports next
    environment: Mapping[str, str] = field(default_factory=dict)  # added to this process's
    folder: Path | None = None  # it works in; None: this process's
    on_answer: Callable[[], None] = lambda: (
        None
    )  # called, in another thread, when ``Worker.poll`` has an answer


class Closing:
    """What a ``with`` block closes at its end."""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> object:
        """End the processes that it has started."""
        raise NotImplementedError


class WorkerDied(Exception):
    """The process ended before it answered."""

    def __init__(self, report: CrashReport) -> None:
        super().__init__(report.ending)
        self.report = report


class WorkerTimeout(WorkerDied):
    """The process took too long, and was killed."""


class Worker(Closing):
    """One child process, and the thread that talks to it; takes one request at a time."""

    def __init__(self, launch: Launch) -> None:
        self.busy = False  # whether it was sent a request and has not answered
        self.progress: object = None  # what it reported last of the request
        self._ready: Ready | None = None
        self._not_a_frame = ""
        self._started = threading.Event()  # it is ready, or dead
        self._sent = self._cancelled = False
        self._cancelling = threading.Lock()
        # Simple queues: Ctrl-C in the midst of a call leaves no lock of theirs taken.
        self._requests: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()  # None: no more
        self._encoder = Encoder()
        self._on_answer = launch.on_answer
        self._answers: queue.SimpleQueue[Answer | None] = queue.SimpleQueue()  # None: it is dead
        self._output = _Output()
        life, self._life = os.pipe() if launch.ends_with_parent and sys.platform == "linux" else (-1, -1)
        try:
            # -P: what lies in the user's folder is no module of ours, even under the same name.
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", "playground.engine.process.child", launch.handler],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._output.file,
                env={**os.environ, "PYTHONPATH": _module_path(), **launch.environment},
                cwd=launch.folder,
                pass_fds=() if life < 0 else (life,),
                start_new_session=True,
            )
        except BaseException:
            self._release()
            raise
        finally:
            if life >= 0:
                os.close(life)
        self._clock = ActivityClock(lambda: times_of(self.pid))
        self._clock.begin("start")
        alarm = longest(launch.limit_seconds) + _GRACE if launch.limit_seconds else 0.0
        setup = Setup(launch.options, launch.memory_bytes, alarm, life)
        self._thread = threading.Thread(target=self._talk, args=[setup], daemon=True)
        self._thread.start()

    @property
    def pid(self) -> int:
        """The process's number."""
        return self._process.pid

    @property
    def runs(self) -> bool:
        """Whether the process lives."""
        return self._process.poll() is None

    @property
    def is_ready(self) -> bool:
        """Whether it has ever been ready."""
        return self._ready is not None

    @property
    def starting_seconds(self) -> float:
        """How long it has been starting [s]; 0 once it is ready."""
        return 0.0 if self.is_ready else self._clock.total

    @property
    def seconds(self) -> float:
        """How long it has worked on its request, from when it was ready for it [s].

        Processor time: what it waited for a processor does not count, but for a share.
        """
        return self._clock.total if self.is_ready else 0.0

    @property
    def activity_seconds(self) -> float:
        """How long what it reported last has taken, of its request, as ``seconds`` [s]."""
        return self._clock.seconds if self.is_ready else 0.0

    def submit(self, request: object) -> None:
        """Send a request; never waits."""
        self.busy, self.progress = True, None
        self._sent = self._cancelled = False
        try:
            # Here, not in the thread that sends: the caller may change what it holds meanwhile.
            self._requests.put(self._encoder.encode(request))
        except Exception as error:  # it cannot be pickled
            self._answers.put(Answer(error=error))

    def cancel(self) -> None:
        """Have the handler stop at its next report; never waits."""
        self._cancelled = True
        if self._sent:
            self._send_cancel()

    def poll(self, timeout: float = 0.0) -> Answer | None:
        """Return the answer to the request, once; None while there is none.

        Raises ``WorkerDied`` where the process ends before it answers.
        """
        try:
            answer = self._answers.get(timeout=timeout) if timeout else self._answers.get_nowait()
        except queue.Empty:
            return None
        if answer is None:
            raise WorkerDied(self._report_death())
        self.busy = False
        return answer

    def wait_until_ready(self, limit: float = START_SECONDS) -> object:
        """Return what the handler tells of itself, or raise the error that it met when it opened.

        Raises ``WorkerDied`` where the process ends, ``WorkerTimeout`` after ``limit`` seconds.
        """
        while not self._started.wait(_POLL):
            if self.starting_seconds > limit:
                raise WorkerTimeout(self.end(kill=True))
        if self._ready is None:
            raise WorkerDied(self._report_death())
        if self._ready.error is not None:
            raise self._ready.error
        return self._ready.info

    def ask(self, request: object, limit: float) -> object:
        """Send a request, wait for the answer, and return its value or raise its error.

        Raises ``WorkerDied`` where the process ends, ``WorkerTimeout`` after ``limit`` seconds.
        """
        self.wait_until_ready()
        try:
            self.submit(request)
            while (answer := self.poll(min(_POLL, limit))) is None:
                if self.seconds > limit:
                    raise WorkerTimeout(self.end(kill=True))
        except WorkerDied:
            raise
        except BaseException:  # Ctrl-C, or another's time limit: the answer must not be taken for the next
            self.end(kill=True)
            raise
        return answer.get()

    def printed(self) -> str:
        """Return what it has printed since this was last called."""
        return self._output.read()

    def close(self) -> CrashReport:
        """End the process, by itself if it has nothing to do."""
        return self.end()

    def end(self, *, kill: bool = False, patience: float = 5.0) -> CrashReport:
        """End the process and report how it ended.

        If it has nothing to do it may end by itself within ``patience`` seconds; else it is killed.
        """
        at_work = self._thread.is_alive() and (self.busy or not self.is_ready)
        self._requests.put(None)  # its input is closed, so it ends
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(0.0 if kill or at_work else patience)
        self._process.kill()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        self._thread.join(5.0)
        status, output = self._process.returncode, self._release()
        return CrashReport(status, output, self.progress, self._not_a_frame, was_ready=self.is_ready)

    def _release(self) -> str:
        """Close this end of the life pipe and the file of what was printed; return its rest."""
        if self._life >= 0:
            os.close(self._life)
            self._life = -1
        return self._output.close()

    def _report_death(self) -> CrashReport:
        """Report how the process ended, whose pipe is closed."""
        self._thread.join(5.0)
        return self.end(kill=bool(self._not_a_frame), patience=2.0)

    def _talk(self, setup: Setup) -> None:
        requests, answers = self._process.stdin, self._process.stdout
        assert requests is not None and answers is not None
        # Its pipes are closed here, where they are used: closing waits for a reader.
        try:
            with contextlib.suppress(OSError), answers:
                try:
                    frames.write(requests, pickle.dumps(setup))
                    ready = _receive(answers)
                    assert isinstance(ready, Ready)
                    self._clock.clear()
                    self._ready = ready
                    self._started.set()
                    self._serve(requests, answers)
                except frames.NotAFrame as error:
                    self._not_a_frame = str(error)
                except (OSError, EOFError):
                    pass
                with contextlib.suppress(OSError):
                    requests.close()
        finally:  # a caller that waits gets an answer, even if something went wrong here
            self._answers.put(None)
            self._started.set()
            self._on_answer()

    def _serve(self, requests: IO[bytes], answers: IO[bytes]) -> None:
        while (request := self._requests.get()) is not None:
            self._clock.begin(None)
            frames.write(requests, request)
            self._sent = True
            if self._cancelled:
                self._send_cancel()
            while isinstance(message := _receive(answers), Progress):
                self._clock.begin(message.value)
                self.progress = message.value
            assert isinstance(message, Answer)
            self._clock.clear()
            self._answers.put(message)
            self._on_answer()

    def _send_cancel(self) -> None:
        assert self._process.stdin is not None
        # A pipe that is closed has no one to stop.
        with self._cancelling, contextlib.suppress(OSError, ValueError):
            frames.write(self._process.stdin, CANCEL)


class Replaceable:
    """One worker at a time: where it is gone another takes its place, warm if it is a spare."""

    def __init__(self, launch: Launch) -> None:
        self.launch = launch
        self.worker: Worker | None = None
        self.spare: Worker | None = None
        self.started = 0  # how many processes there were
        self._printed = ""  # by those that are gone

    def start(self) -> Worker:
        """Return the worker; start one, or take the spare, where there is none that runs."""
        if self.worker is None or not self.worker.runs:
            self.end()
            spare, self.spare = self.spare, None
            if spare is not None and not spare.runs:
                spare.end()
                spare = None
            self.worker = self._new() if spare is None else spare
        return self.worker

    def start_spare(self) -> None:
        """Start the process that is to take over."""
        if self.spare is None:
            self.spare = self._new()

    def replace(self) -> Worker:
        """Kill the worker and return the one that takes its place."""
        self.end(kill=True)
        return self.start()

    def end(self, *, kill: bool = False, patience: float = 5.0) -> CrashReport | None:
        """End the worker, as ``Worker.end`` does; the spare stays."""
        worker, self.worker = self.worker, None
        if worker is None:
            return None
        report = worker.end(kill=kill, patience=patience)
        self._printed = (self._printed + report.output)[-_PRINTED:]
        return report

    def printed(self) -> str:
        """Return what the workers have printed since this was last called."""
        printed, self._printed = self._printed + (self.worker.printed() if self.worker else ""), ""
        return printed

    def close(self, *, patience: float = 5.0) -> CrashReport | None:
        """End the worker and the spare."""
        spare, self.spare = self.spare, None
        if spare is not None:
            spare.end(kill=True)
        return self.end(patience=patience)

    def _new(self) -> Worker:
        self.started += 1
        return Worker(self.launch)


class _Output:
    """What a process prints, in a file that is gone with it."""

    def __init__(self) -> None:
        self.file = tempfile.TemporaryFile()
        self._begin = 0

    def read(self) -> str:
        """Return what was printed since this was last called; nothing where a file has one position only."""
        if self.file.closed or not hasattr(os, "pread"):
            return ""
        # By a position of its own: the process writes on at the file's, which it shares.
        data = os.pread(self.file.fileno(), 2**20, self._begin)
        self._begin += len(data)
        return data.decode("utf-8", "replace")

    def close(self) -> str:
        """Return what was printed since ``read`` was last called, and remove the file; once."""
        if self.file.closed:
            return ""
        with self.file:
            self.file.seek(self._begin)
            return self.file.read().decode("utf-8", "replace")


def _receive(stream: IO[bytes]) -> Ready | Progress | Answer:
    data = frames.read(stream)
    try:
        message: object = pickle.loads(data)
    except Exception as error:  # a pickle that is damaged raises anything at all
        raise frames.NotAFrame(str(error)) from error
    if not isinstance(message, Ready | Progress | Answer):
        raise frames.NotAFrame(f"a message of type {type(message).__name__}")
    return message


def _module_path() -> str:
    """Return PYTHONPATH for a child that finds this package, and what it needs, as this process does."""
    package = str(Path(__file__).resolve().parents[3])
    return os.pathsep.join([package, *(path for path in sys.path if path)])
