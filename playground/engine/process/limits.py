"""Bound a worker process from inside: its memory, and its life once its parent is gone."""

from __future__ import annotations

import os
import select
import signal
import sys


def limit_memory(memory_bytes: int | None) -> None:
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


def end_after(seconds: float) -> None:
    """Have the system end this process, should its parent fail to; 0: no more."""
    if hasattr(signal, "setitimer"):
        signal.setitimer(signal.ITIMER_REAL, seconds)  # SIGALRM ends even a draw that hangs


def end_with_parent(life: int) -> None:
    """Have Linux end this process when its parent is gone, even in the middle of a draw.

    ``life`` is the end of a pipe that is never written to. When its other end closes, Linux
    sends SIGIO, which ends a process that has no handler for it; elsewhere it is ignored.
    """
    import fcntl

    fcntl.fcntl(life, fcntl.F_SETOWN, os.getpid())
    fcntl.fcntl(life, fcntl.F_SETFL, fcntl.fcntl(life, fcntl.F_GETFL) | os.O_ASYNC)
    if select.select([life], [], [], 0)[0]:  # it was gone before that
        sys.exit(1)
