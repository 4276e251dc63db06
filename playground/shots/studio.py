"""A child process that takes shots on the software renderer.

Asking Mesa for its software renderer changes the environment of a whole process, must be
done before the first context, and leaves another context current. A session that also
tests on a GPU can afford none of that, so the pictures are taken in a process of their own.
A driver that crashes or hangs then takes a picture with it, and not the session.

It talks over the child's standard input and output, in pickles. `multiprocessing` would
run the parent's main script once more in the child.
"""

from __future__ import annotations

import os
import pickle
import subprocess
import sys
import threading
import traceback
from pathlib import Path
from typing import BinaryIO

from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import ContextError, PlaygroundError, TrialCrash, TrialTimeout
from playground.gpu.context import ContextInfo, context_info, open_context
from playground.shots.suite import ShotCase, take

LIMIT = 120.0
"""[s] A picture may take that long: far beyond any shot on a slow machine with a cold shader cache."""


class Studio:
    """Takes pictures in a child process, which starts with the first and is replaced when it dies.

    Use it with ``with``, or call ``close()``.
    """

    def __init__(self, limit: float = LIMIT) -> None:
        self.limit = limit  # [s] a picture
        self._process: subprocess.Popen[bytes] | None = None
        self._renderer: ContextInfo | None = None
        self._refusal: ContextError | None = None

    def __enter__(self) -> Studio:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def renderer(self) -> ContextInfo:
        """What draws the pictures; raises ``ContextError`` where there is no software renderer."""
        self._start()
        assert self._renderer is not None
        return self._renderer

    def take(self, case: ShotCase) -> Frame:
        """Draw one shot in the child.

        Raises what `playground.shots.suite.take` raises, ``TrialCrash`` where the child died,
        ``TrialTimeout`` where it took too long.
        """
        frame = self._ask(self._start(), f"drawing {case}", case)
        assert isinstance(frame, Frame)
        return frame

    def close(self) -> None:
        """End the child; the next picture starts another."""
        process, self._process = self._process, None
        if process is None:
            return
        assert process.stdin and process.stdout
        try:
            process.stdin.close()  # the child ends at the end of its input
        except OSError:
            pass  # it is gone already
        try:
            process.wait(5)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()

    def _start(self) -> subprocess.Popen[bytes]:
        if self._refusal is not None:
            raise self._refusal
        if self._process is None:
            # The child finds the same playground as this process, however that was found.
            where = os.pathsep.join(p or str(Path.cwd()) for p in sys.path)
            self._process = subprocess.Popen(
                [sys.executable, "-P", "-m", __name__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                env={**os.environ, "PYTHONPATH": where},
            )
            try:
                renderer = self._ask(self._process, "opening the software renderer")
            except ContextError as error:
                self._refusal = error
                self.close()
                raise
            assert isinstance(renderer, ContextInfo)
            self._renderer = renderer
        return self._process

    def _ask(self, process: subprocess.Popen[bytes], doing: str, case: ShotCase | None = None) -> object:
        assert process.stdin and process.stdout
        late = threading.Event()

        def stop() -> None:
            late.set()
            process.kill()

        timer = threading.Timer(self.limit, stop)
        timer.start()
        try:
            if case is not None:
                pickle.dump(case, process.stdin)
                process.stdin.flush()
            answer: object = pickle.load(process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            self.close()
            if late.is_set():
                raise TrialTimeout(f"{doing} took more than {self.limit:g} s and was stopped") from None
            raise TrialCrash(f"the process {doing} died, with status {process.returncode}") from None
        finally:
            timer.cancel()
            timer.join()
        if isinstance(answer, BaseException):
            raise answer
        return answer


def _serve(questions: BinaryIO, answers: BinaryIO) -> None:
    """Answer every case with a frame, or with the exception that came instead, until the input ends."""

    def answer(value: object) -> None:
        pickle.dump(value, answers)
        answers.flush()

    try:
        context = open_context(software=True)
    except PlaygroundError as error:
        answer(error)
        return
    with Engine(context, owns_context=True) as engine:
        answer(context_info(context))
        while True:
            try:
                case = pickle.load(questions)
            except EOFError:
                return
            try:
                answer(take(engine, case))
            except PlaygroundError as error:
                answer(error)
            except Exception:  # a mistake in the playground: its traceback must cross over too
                answer(RuntimeError(f"in the child process:\n{traceback.format_exc()}"))


if __name__ == "__main__":
    # Some drivers print to standard output; that may not get between the answers.
    with os.fdopen(os.dup(1), "wb") as private:
        os.dup2(2, 1)
        _serve(sys.stdin.buffer, private)
