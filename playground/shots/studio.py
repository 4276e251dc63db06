"""A child process with an OpenGL context of its own, which draws shots one after the other.

A draw that hangs cannot be interrupted inside its process, some drivers crash, and asking
Mesa for its software renderer changes the environment of a whole process. So pictures are
taken in a child: it is stopped when it takes too long, replaced when it dies, and its end
is told in words, with what it printed. The next picture is drawn all the same.

Nothing of it is left behind: the child ends with its input, so when the parent is gone (on
Linux even in the middle of a draw), and where the system has alarms some time after its limit.
`multiprocessing` would run the parent's main script once more in the child.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import threading
from pathlib import Path
from typing import BinaryIO, cast

from playground.errors import ContextError, PlaygroundError, TrialCrash, TrialTimeout
from playground.gpu.context import ContextInfo
from playground.shots.studio_child import Rubbish, receive, send
from playground.shots.suite import ShotCase, Taken

LIMIT = 120.0
"""[s] A picture may take that long: far beyond any shot on a slow machine with a cold shader cache."""

_START = 120.0  # [s] that starting Python and opening a context may take at least
_STARTS = 2  # so many in a row may fail before none is tried any more
_LINES = 12  # of what a child printed before it died

CHILD = "playground.shots.studio_child"


class Studio:
    """Takes pictures in a child process, which starts with the first and is replaced when it dies.

    ``limit`` is seconds a picture. ``renderer`` is "software" for Mesa's on the processor,
    "any" for what OpenGL gives by itself, "either" for the first that there is.
    Use it with ``with``, or call ``close()``.
    """

    def __init__(self, limit: float = LIMIT, renderer: str = "software") -> None:
        self.limit = limit  # [s] a picture
        self._wanted = renderer
        self._child: _Child | None = None
        self._renderer: ContextInfo | None = None
        self._refusal: PlaygroundError | None = None
        self._failed_starts = 0
        self._said = ""

    def __enter__(self) -> Studio:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def renderer(self) -> ContextInfo:
        """What draws the pictures.

        Raises ``ContextError`` where there is no such renderer, ``TrialCrash`` or
        ``TrialTimeout`` where the child does not come so far.
        """
        self._start()
        assert self._renderer is not None
        return self._renderer

    @property
    def process(self) -> int | None:
        """The child's number; None while there is none."""
        return self._child.process.pid if self._child else None

    def said(self) -> str:
        """Return, once, what the child printed."""
        said, self._said = self._said + (self._child.said() if self._child else ""), ""
        return said

    def take(self, case: ShotCase) -> Taken:
        """Draw one shot in the child.

        Raises what `playground.shots.suite.take` raises, ``TrialCrash`` where the child died,
        ``TrialTimeout`` where it took too long.
        """
        frame = self._ask(self._start(), f"drawing {case}", self.limit, case)
        assert isinstance(frame, Taken)
        return frame

    def close(self) -> None:
        """End the child; the next picture starts another."""
        child, self._child = self._child, None
        if child is not None:
            self._said += child.end()

    def _start(self) -> _Child:
        if self._refusal is not None:
            raise self._refusal
        if self._child is not None and self._child.process.poll() is not None:
            self.close()  # it died while it had nothing to do: no picture's fault
        if self._child is None:
            try:
                self._child = _Child(self._wanted, self.limit)
                doing = "starting the process that draws"
                info = self._ask(self._child, doing, max(self.limit, _START))
            except ContextError as error:
                self._refusal = error
                self.close()
                raise
            except PlaygroundError as error:
                self._failed_starts += 1
                if self._failed_starts == _STARTS:
                    self._refusal = error
                raise
            assert isinstance(info, ContextInfo)
            self._renderer = info
            self._failed_starts = 0
        return self._child

    def _ask(self, child: _Child, doing: str, limit: float, case: ShotCase | None = None) -> object:
        late = threading.Event()

        def stop() -> None:
            late.set()
            child.process.kill()

        timer = threading.Timer(limit, stop)
        timer.start()
        try:
            if case is not None:
                send(child.questions, case)
            answer = receive(child.answers)
        except (EOFError, OSError, Rubbish) as error:
            timer.cancel()
            timer.join()
            self._child = None
            how = child.end(kill=isinstance(error, Rubbish))
            if late.is_set():
                message = f"{doing} took more than {limit:g} s and was stopped{_quoted(how)}"
                raise TrialTimeout(message) from None
            if isinstance(error, Rubbish):
                raise TrialCrash(f"{doing} gave an answer that is none: {error}{_quoted(how)}") from None
            ended = _ended(child.process.returncode)
            raise TrialCrash(f"{doing} crashed: the process {ended}{_quoted(how)}") from None
        except BaseException:  # Ctrl-C, or a time limit of others: what it still answers, nobody asked
            self._child = None
            child.end(kill=True)
            raise
        finally:
            timer.cancel()
            timer.join()
        if late.is_set():  # it answered at the last moment, and was killed all the same
            self.close()
        if isinstance(answer, BaseException):
            raise answer
        return answer


class _Child:
    """The process, its pipes, and what it prints."""

    def __init__(self, renderer: str, limit: float) -> None:
        self._printed = tempfile.TemporaryFile()  # closed in `end`
        self._read = 0
        life, self._held = os.pipe() if sys.platform == "linux" else (-1, -1)
        # The child finds the same playground as this process, however that was found.
        where = os.pathsep.join(p or str(Path.cwd()) for p in sys.path)
        try:
            self.process = subprocess.Popen(
                [sys.executable, "-P", "-m", CHILD, renderer, str(limit), str(life)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._printed,
                env={**os.environ, "PYTHONPATH": where},
                pass_fds=() if life < 0 else (life,),
            )
        finally:
            if life >= 0:
                os.close(life)
        self.questions = cast("BinaryIO", self.process.stdin)
        self.answers = cast("BinaryIO", self.process.stdout)

    def said(self) -> str:
        """Return what it has printed since this was asked last."""
        # By its own place: the child writes on at the file's, which the two of them share.
        data = os.pread(self._printed.fileno(), 2**20, self._read) if hasattr(os, "pread") else b""
        self._read += len(data)
        return data.decode("utf-8", "replace")

    def end(self, kill: bool = False) -> str:
        """End it, by itself if it does so soon; return what it printed."""
        if kill:
            self.process.kill()
        try:
            self.questions.close()  # it ends at the end of its input
        except OSError:
            pass  # it is gone already
        try:
            self.process.wait(5)
        except subprocess.TimeoutExpired:
            self.process.kill()
            self.process.wait()
        self.answers.close()
        if self._held >= 0:
            os.close(self._held)
        if hasattr(os, "pread"):
            said = self.said()
        else:
            self._printed.seek(0)
            said = self._printed.read().decode("utf-8", "replace")
        self._printed.close()
        return said


def _ended(status: int) -> str:
    """Say how a process ended."""
    if status >= 0:
        return f"ended with status {status}"
    try:
        return f"was ended by {signal.Signals(-status).name}"
    except ValueError:
        return f"was ended by signal {-status}"


def _quoted(printed: str) -> str:
    """Return the end of what was printed, as further lines of a message."""
    lines = [line.rstrip() for line in printed.splitlines() if line.strip()][-_LINES:]
    return "".join(f"\n    | {line}" for line in lines)
