"""End as on Ctrl-C for the system's signals: half-written files are removed, a film is shortened."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

# Sent by a shutdown, a closed terminal, Ctrl-\, the system at a limit on processor time, and batch systems
# before they kill; on Windows, of these only the first, and Ctrl-Break.
_ASKING = ("SIGTERM", "SIGHUP", "SIGQUIT", "SIGXCPU", "SIGUSR1", "SIGUSR2", "SIGBREAK")


@contextmanager
def ended_by_signals() -> Iterator[list[int]]:
    """Raise ``KeyboardInterrupt`` in the block on a signal to end; yields the signals that came.

    Does nothing outside the main thread, and leaves alone a signal that is ignored, as by nohup.
    """
    came: list[int] = []

    def end(number: int, frame: FrameType | None) -> None:
        came.append(number)
        raise KeyboardInterrupt

    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in (getattr(signal, name) for name in _ASKING if hasattr(signal, name)):
            if signal.getsignal(number) == signal.SIG_DFL:
                before[number] = signal.signal(number, end)
    try:
        yield came
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
