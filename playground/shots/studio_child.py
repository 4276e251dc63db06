"""The studio's child process: opens a context, draws what it is handed, answers.

Run by ``studio`` only, as ``python -m playground.shots.studio_child RENDERER SECONDS LIFE``.

A message is a mark, a length and a pickle. The mark tells an answer from whatever a driver,
or a library that it loads, may print; what is printed goes to the standard error anyway.
"""

from __future__ import annotations

import os
import pickle
import select
import signal
import struct
import sys
import traceback
from typing import TYPE_CHECKING, BinaryIO

from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.errors import ContextError, PlaygroundError
from playground.gpu.context import context_info, open_context
from playground.shots.suite import ShotCase, take

if TYPE_CHECKING:
    import moderngl

_MARK = b"\0shots\r\n"
_HEAD = struct.Struct("<8sQ")
_LONGEST = 2**33  # [bytes] of a message: a picture of 16384 x 16384 has 2**30
_SPARE = 30.0  # [s] that the parent has to end this process before the system does


class Rubbish(Exception):
    """What was read is no message."""


def send(stream: BinaryIO, message: object) -> None:
    """Write one message."""
    data = pickle.dumps(message)
    stream.write(_HEAD.pack(_MARK, len(data)))
    stream.write(data)
    stream.flush()


def receive(stream: BinaryIO) -> object:
    """Read one message; raise ``EOFError`` at the end, ``Rubbish`` for what is none."""
    head = stream.read(_HEAD.size)
    if not head:
        raise EOFError
    if not head.startswith(_MARK[: len(head)]):
        raise Rubbish(repr(head))
    if len(head) < _HEAD.size:
        raise EOFError
    _, length = _HEAD.unpack(head)
    if length > _LONGEST:
        raise Rubbish(f"a message of {length} bytes")
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    try:
        return pickle.loads(data)
    except Exception as error:  # a pickle that is damaged raises anything at all
        raise Rubbish(str(error)) from error


def main() -> None:
    """Answer every case with a frame, or with the exception that came instead, until the input ends."""
    renderer, limit, life = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
    questions, answers = sys.stdin.buffer, os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # some drivers print to standard output: that may not get between the answers
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    if life >= 0:
        _end_with_the_parent(life)
    _limit_memory()
    try:
        context = _open(renderer)
    except PlaygroundError as error:
        send(answers, error)
        return
    with Engine(context, owns_context=True, notice=silent) as engine:
        send(answers, context_info(context))
        while True:
            try:
                case = receive(questions)
            except (EOFError, Rubbish):
                return
            assert isinstance(case, ShotCase)
            _end_yourself_after(limit + _SPARE)
            answer = _answer(engine, case)
            _end_yourself_after(0.0)
            send(answers, answer)


def _answer(engine: Engine, case: ShotCase) -> object:
    try:
        return take(engine, case)
    except PlaygroundError as error:
        return error
    except MemoryError:
        return ContextError(f"drawing {case} ran out of memory")
    except Exception:  # a mistake in the playground: its traceback must cross over too
        return RuntimeError(f"in the child process:\n{traceback.format_exc()}")


def _open(renderer: str) -> moderngl.Context:
    """Open the context: "software", "any", or "either", the first where it is to be had."""
    if renderer == "any":
        return open_context()
    try:
        return open_context(software=True)
    except ContextError:
        if renderer != "either":
            raise
    return open_context()


def _end_with_the_parent(life: int) -> None:
    """Have Linux end this process when the parent is gone, even in the middle of a draw.

    ``life`` is the end of a pipe into which nobody writes. When its other end closes, Linux
    sends SIGIO, which ends a process that has asked for nothing else; elsewhere it is ignored.
    """
    import fcntl

    fcntl.fcntl(life, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(life, fcntl.F_SETFL, fcntl.fcntl(life, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([life], [], [], 0)[0]:  # it was gone before that
        sys.exit(1)


def _end_yourself_after(seconds: float) -> None:
    """Have the system end this process, should the parent fail to; 0: no more."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds)  # SIGALRM ends even a draw that hangs


def _limit_memory() -> None:
    """Take no more memory than the machine has: this process is to fail, not the machine."""
    try:
        import resource

        whole = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        # Data, not addresses: a graphics card's driver reserves far more of those than it uses.
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        if hard == resource.RLIM_INFINITY or whole < hard:
            resource.setrlimit(resource.RLIMIT_DATA, (whole, hard))
    except (ImportError, ValueError, OSError):  # Windows; a system that does not say, or does not let
        pass


if __name__ == "__main__":
    main()
