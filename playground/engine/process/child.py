"""The child's end of a worker: answer requests by a handler until the parent closes the pipe.

Run by ``process.worker`` only, as ``python -m playground.engine.process.child MODULE``. The module is
the handler: its function ``open_service`` takes a ``Parent`` and the options, and returns a
``Service``. An error of our family crosses to the parent whole, any other as text.
"""

from __future__ import annotations

import importlib
import os
import pickle
import queue
import signal
import sys
import threading
import time
import traceback
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import IO, Any

from playground.engine.process import frames
from playground.engine.process.kernel_pickle import Decoder
from playground.engine.process.limits import end_after, end_with_parent, limit_memory
from playground.engine.process.messages import (
    CANCEL,
    Answer,
    Cancelled,
    Progress,
    Ready,
    Setup,
    UnexpectedError,
)
from playground.errors import PlaygroundError


@dataclass(frozen=True)
class Service:
    """A handler that is ready."""

    answer: Callable[[Any], object]  # a request's answer; may raise
    info: object = None  # what the parent learns when the handler is ready


class Parent:
    """The parent as its child sees it: sends requests, may cancel them, receives progress and answers."""

    def __init__(self, requests: IO[bytes], answers: IO[bytes], alarm_seconds: float) -> None:
        self._requests, self._answers = requests, answers
        self._alarm = alarm_seconds
        self._cancelled = threading.Event()
        self._received: queue.Queue[bytes | None] = queue.Queue()  # None: the parent closed the pipe

    def report(self, progress: object) -> None:
        """Send what is about to be done, or how far it is; raise ``Cancelled`` if it is to stop."""
        if self._cancelled.is_set():
            raise Cancelled
        end_after(self._alarm)
        try:
            self._send(Progress(progress))
        except OSError:  # the parent is gone
            raise Cancelled from None

    def serve(self, open_service: Callable[[Parent, Any], Service], setup: Setup) -> None:
        """Answer requests until the parent closes the pipe, or is gone."""
        # A thread, so that a cancellation is seen amid a request.
        threading.Thread(target=self._receive, daemon=True).start()
        answer: Callable[[Any], object]
        try:
            service = open_service(self, setup.options)
            ready, answer = Ready(service.info), service.answer
        except PlaygroundError as error:
            ready, answer = Ready(error=error), _refusal(error)
        limit_memory(setup.memory_bytes)
        try:
            self._send(ready)
            for request in self._each_request():
                end_after(self._alarm)
                found = _answered(answer, request)
                end_after(0.0)
                self._send(found)
        except OSError:  # the parent is gone
            return

    def _each_request(self) -> Iterator[object]:
        decoder = Decoder()
        while (data := self._received.get()) is not None:
            yield decoder.decode(data)

    def _receive(self) -> None:
        try:
            while True:
                data = frames.read(self._requests)
                if data == CANCEL:
                    self._cancelled.set()
                else:
                    self._cancelled.clear()  # that was meant for the request before
                    self._received.put(data)
        except (EOFError, OSError, frames.NotAFrame):
            self._cancelled.set()
            self._received.put(None)

    def _send(self, message: object) -> None:
        frames.write(self._answers, pickle.dumps(message))


def _answered(answer: Callable[[Any], object], request: object) -> Answer:
    start = time.perf_counter()
    error: Exception
    try:
        return Answer(answer(request), seconds=time.perf_counter() - start)
    except (PlaygroundError, Cancelled, MemoryError) as raised:
        error = raised
    except Exception as raised:  # a bug of ours, or of a library
        error = UnexpectedError(f"{type(raised).__name__}: {raised}", traceback.format_exc())
    return Answer(error=error, seconds=time.perf_counter() - start)


def _refusal(error: PlaygroundError) -> Callable[[object], object]:
    def answer(request: object) -> object:
        raise error

    return answer


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
        setup: Setup = pickle.loads(frames.read(requests))
    except EOFError:
        return
    if setup.life >= 0:
        end_with_parent(setup.life)
    open_service = importlib.import_module(sys.argv[1]).open_service
    Parent(requests, answers, setup.alarm_seconds).serve(open_service, setup)


if __name__ == "__main__":
    main()
