"""Hand requests of other threads to the thread that draws: they are done between two frames."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any

from playground.errors import PlaygroundError

MAX_WAITING = 1024
"""Requests that may wait."""
BUDGET = 0.008
"""[s] that a frame spends on requests; one that takes longer is done alone."""


class Busy(PlaygroundError):
    """More is asked than the window can do."""


class Calls:
    """A queue of functions that the drawing thread runs; ``wake`` ends its sleep."""

    def __init__(self, wake: Callable[[], None] = lambda: None) -> None:
        self.wake = wake
        self._lock = threading.Lock()
        self._waiting: deque[tuple[Callable[[], Any], Future[Any]]] = deque()
        self._closed = False

    def __len__(self) -> int:
        return len(self._waiting)

    def ask(self, function: Callable[[], Any]) -> Future[Any]:
        """Have a function run between two frames; return its answer to come. For any thread.

        Raises ``Busy`` where too many wait, or the window is closed.
        """
        future: Future[Any] = Future()
        with self._lock:
            if self._closed:
                raise Busy("the window is closed")
            if len(self._waiting) >= MAX_WAITING:
                raise Busy(f"more than {MAX_WAITING} requests wait for the window")
            first = not self._waiting
            self._waiting.append((function, future))
        if first:
            self.wake()
        return future

    def run(self, budget: float = BUDGET) -> bool:
        """Run what waits, for about ``budget`` [s]; return whether anything ran. For the drawing thread."""
        end, count = time.perf_counter() + budget, 0
        while self._waiting and (not count or time.perf_counter() < end):
            count += 1
            with self._lock:
                function, future = self._waiting.popleft()
            if not future.set_running_or_notify_cancel():
                continue
            try:
                future.set_result(function())
            except BaseException as error:
                future.set_exception(error)
                if not isinstance(error, Exception):
                    raise
        return bool(count)

    def close(self) -> None:
        """Take no more requests, and refuse those that wait."""
        with self._lock:
            self._closed = True
            waiting, self._waiting = self._waiting, deque()
        for _, future in waiting:
            if future.set_running_or_notify_cancel():
                future.set_exception(Busy("the window is closed"))
