"""The worker process's end of a pool: its messages, its limits, and the loop that answers by a handler.

Each message is a pickle in a frame of its own; a pickle is only ever read from our own parent or child.

    parent                          child
    options, memory, life    ──▶
                             ◀──    "ready"
    alarm, request           ──▶
                             ◀──    "begun"
                             ◀──    "progress", as often as the handler reports
    CANCEL, if it must stop  ──▶
                             ◀──    "answer"

Options are for the handler; memory is what the child may take in bytes, None for as much as the machine
has; life is the number of a pipe that the parent holds open while it lives, where there is one. The alarm is
in how many seconds the system ends the child, should its parent fail to; 0 for never.

The parent closes the pipe to end the child. The handler is a module: its function ``open_service`` takes a
``Parent`` and the pool's options, and returns a ``Service``. An error of our family crosses to the parent
whole, any other as text.
"""

from __future__ import annotations

import importlib
import io
import itertools
import os
import pickle
import queue
import select
import signal
import struct
import sys
import threading
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import IO, Any, Literal, NamedTuple

from playground.engine.heap import trim_heap
from playground.errors import PlaygroundError
from playground.shader.kernel import Kernel

CANCEL = b""
"""The frame that cancels the request at work."""

_MARK = b"\0frame\r\n"  # tells a frame from what a driver, or a library, may write into the pipe
_HEAD = struct.Struct("<8sQ")  # the mark, the length
_MAX_FRAME = 2**33  # [bytes]: an image of 16384 x 16384 has 2**30


# ── messages ─────────────────────────────────────────────────────────────────


class Message(NamedTuple):
    """What the child sends."""

    kind: Literal["ready", "begun", "progress", "answer"]
    value: Any = (
        None  # what the handler tells of itself; what it is about to do, or how far it is; the answer
    )
    error: Exception | None = None  # that it raised instead; where that is in opening, it takes no requests


class Cancelled(Exception):
    """The request was cancelled."""


class UnexpectedError(RuntimeError):
    """A bug in a handler, as text, for its exception may not cross to the parent.

    ``args`` are "Type: message", and the traceback.
    """

    def __str__(self) -> str:
        return f"in the child process:\n{self.args[1]}"


def summary_of(error: Exception | None) -> str:
    """Return an error's type and message, of an ``UnexpectedError`` those that the child met."""
    return str(error.args[0]) if isinstance(error, UnexpectedError) else f"{type(error).__name__}: {error}"


class NotAFrame(Exception):
    """What was read is no frame."""


def write_frame(stream: IO[bytes], data: bytes) -> None:
    """Write one frame."""
    stream.write(_HEAD.pack(_MARK, len(data)))
    stream.write(data)
    stream.flush()


def read_frame(stream: IO[bytes]) -> bytes:
    """Read one frame; raise ``EOFError`` at the end, even amid a frame, ``NotAFrame`` for anything else."""
    head = stream.read(_HEAD.size)
    if not head:
        raise EOFError
    if not head.startswith(_MARK[: len(head)]):
        raise NotAFrame(repr(head))
    if len(head) < _HEAD.size:
        raise EOFError
    _, length = _HEAD.unpack(head)
    if length > _MAX_FRAME:
        raise NotAFrame(f"a frame of {length} bytes")
    data = stream.read(length)
    if len(data) < length:
        raise EOFError
    return data


class Encoder:
    """Pickles requests so that each kernel is sent once; one ``Decoder`` reads all its messages, in order.

    A sketch is mostly its kernels' texts, and a save changes one of them. Both ends keep the
    kernels of the last message and no others, so that a name replaces the rest; the process,
    which receives the same objects again, need not parse their texts again.
    """

    def __init__(self) -> None:
        self.known: dict[int, tuple[str, Kernel]] = {}  # by identity: held, so that it stays its own
        self._encoded = self.known  # of the last message, which may not have been sent
        self._names = itertools.count()

    def encode(self, message: object) -> bytes:
        """Return a message as bytes; call ``sent`` once the other end has got them."""
        stream = io.BytesIO()
        pickler = _Pickler(stream, self.known, self._names)
        pickler.dump(message)
        self._encoded = pickler.used
        return pickle.dumps(pickler.news, pickle.HIGHEST_PROTOCOL) + stream.getvalue()

    def sent(self) -> None:
        """Note that the last message was sent: its kernels are known at the other end."""
        self.known = self._encoded


class Decoder:
    """The child's end of an ``Encoder``."""

    def __init__(self) -> None:
        self.known: dict[str, Kernel] = {}

    def decode(self, data: bytes) -> Any:
        """Return the message that an ``Encoder`` wrote."""
        stream = io.BytesIO(data)
        unpickler = _Unpickler(stream, self.known | pickle.load(stream))
        message = unpickler.load()
        self.known = unpickler.used
        return message


class _Pickler(pickle.Pickler):
    def __init__(
        self, stream: io.BytesIO, known: dict[int, tuple[str, Kernel]], names: Iterator[int]
    ) -> None:
        super().__init__(stream, pickle.HIGHEST_PROTOCOL)
        self.known, self._names = known, names
        self.used: dict[int, tuple[str, Kernel]] = {}
        self.news: dict[str, Kernel] = {}

    def persistent_id(self, thing: object) -> str | None:
        if not isinstance(thing, Kernel):
            return None
        named = self.known.get(id(thing)) or self.used.get(id(thing))
        if named is None:
            named = str(next(self._names)), thing
            self.news[named[0]] = thing
        self.used[id(thing)] = named
        return named[0]


class _Unpickler(pickle.Unpickler):
    def __init__(self, stream: io.BytesIO, kernels: dict[str, Kernel]) -> None:
        super().__init__(stream)
        self.known = kernels
        self.used: dict[str, Kernel] = {}

    def persistent_load(self, name: Any) -> Kernel:
        kernel = self.used[name] = self.known[name]
        return kernel


# ── the child ────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class Service:
    """A handler that is ready."""

    answer: Callable[[Any], object]  # a request's answer; may raise
    info: object = None  # what the parent learns when the handler is ready


class Parent:
    """The parent as its child sees it: sends requests, may cancel them, receives progress and answers."""

    def __init__(self, requests: IO[bytes], answers: IO[bytes]) -> None:
        self._requests, self._answers = requests, answers
        self._alarm = 0.0  # [s] after which the system ends what is at work, if the parent does not
        self._cancelled = threading.Event()
        self._received: queue.Queue[bytes | None] = queue.Queue()  # None: the parent closed the pipe

    def report(self, progress: object) -> None:
        """Send what is about to be done, or how far it is; raise ``Cancelled`` if it is to stop."""
        if self._cancelled.is_set():
            raise Cancelled
        _end_after(self._alarm)
        try:
            self._send(Message("progress", progress))
        except OSError:  # the parent is gone
            raise Cancelled from None

    def serve(
        self, open_service: Callable[[Parent, Any], Service], options: object, memory_bytes: int | None
    ) -> None:
        """Answer requests until the parent closes the pipe, or is gone."""
        # A thread, so that a cancellation is seen amid a request.
        threading.Thread(target=self._receive, daemon=True).start()
        try:
            service = open_service(self, options)
            ready = Message("ready", service.info)
        except PlaygroundError as error:
            ready = Message("ready", error=error)
        _limit_memory(memory_bytes)
        decoder = Decoder()
        try:
            self._send(ready)
            while (data := self._received.get()) is not None:
                self._send(Message("begun"))
                self._alarm, request = decoder.decode(data)
                _end_after(self._alarm)
                answer = _answered(service.answer, request)
                _end_after(0.0)
                self._send(answer)
                if self._received.empty():
                    trim_heap()
        except OSError:  # the parent is gone
            return

    def _receive(self) -> None:
        try:
            while True:
                data = read_frame(self._requests)
                if data == CANCEL:
                    self._cancelled.set()
                else:
                    self._cancelled.clear()  # that was meant for the request before
                    self._received.put(data)
        except (EOFError, OSError, NotAFrame):
            self._cancelled.set()
            self._received.put(None)

    def _send(self, message: Message) -> None:
        write_frame(self._answers, pickle.dumps(message, pickle.HIGHEST_PROTOCOL))


def _answered(answer: Callable[[Any], object], request: object) -> Message:
    try:
        return Message("answer", answer(request))
    except (PlaygroundError, Cancelled, MemoryError) as error:
        return Message("answer", error=error)
    except Exception as error:  # a bug of ours, or of a library
        text = traceback.format_exc()
        return Message("answer", error=UnexpectedError(f"{type(error).__name__}: {error}", text))


def _limit_memory(memory_bytes: int | None) -> None:
    """Take no more memory than that; None: than the machine has, so that this process fails before it does.

    The limit is the system's own (``RLIMIT_DATA``), which holds on Linux; macOS and Windows have none.
    """
    try:
        import resource

        if memory_bytes is None:
            memory_bytes = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        # Data, not address space: a graphics card's driver reserves far more addresses than it uses.
        _, hard = resource.getrlimit(resource.RLIMIT_DATA)
        if hard == resource.RLIM_INFINITY or memory_bytes < hard:
            resource.setrlimit(resource.RLIMIT_DATA, (memory_bytes, memory_bytes))
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # it may crash often, and no core file is read
    except (ImportError, ValueError, OSError):  # Windows; a system that does not say, or does not let
        pass


def _end_after(seconds: float) -> None:
    """Have the system end this process, should its parent fail to; 0: no more."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds)  # SIGALRM ends even a draw that hangs


def _end_with_parent(life: int) -> None:
    """Have Linux end this process when its parent is gone, even in the middle of a draw.

    ``life`` is the end of a pipe that is never written to. When its other end closes, Linux
    sends SIGIO, which ends a process that has no handler for it; elsewhere it is ignored.
    """
    import fcntl

    fcntl.fcntl(life, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(life, fcntl.F_SETFL, fcntl.fcntl(life, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([life], [], [], 0)[0]:  # it was gone before that
        sys.exit(1)


def main() -> None:
    """Serve the parent by the module that it names."""
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    # What a driver or a program that is started here prints or reads must not get between the frames.
    os.dup2(2, 1)
    nowhere = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nowhere, 0)
    os.close(nowhere)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's
    try:
        options, memory_bytes, *life = pickle.loads(read_frame(requests))
    except EOFError:
        return
    if life:
        _end_with_parent(*life)
    open_service = importlib.import_module(sys.argv[1]).open_service
    Parent(requests, answers).serve(open_service, options, memory_bytes)
