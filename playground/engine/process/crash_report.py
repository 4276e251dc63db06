"""Report how a worker process ended: its signal or status, and what it printed last."""

from __future__ import annotations

import signal
from dataclasses import dataclass

_LINES = 12  # of what it printed, at the most
_WINDOWS = {0xC0000005: "an access violation", 0xC00000FD: "a stack overflow", 0xC0000409: "an abort"}
_CRASHES = ("SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT", "SIGTRAP", *_WINDOWS.values())
_NO_MEMORY = ("out of memory", "bad_alloc", "memoryerror", "cannot allocate")


@dataclass(frozen=True)
class CrashReport:
    """How a process ended."""

    status: int | None  # as in ``subprocess``: negative for a signal; None: not known
    output: str = ""  # what it printed and was not read yet
    progress: object = None  # what it reported last of its request
    not_a_frame: str = ""  # what it sent instead of a message
    was_ready: bool = True  # whether it had started

    @property
    def signal_name(self) -> str:
        """The signal, as "SIGSEGV", or what ended it on Windows; "" if it ended by itself."""
        if self.status is None or self.status >= 0:
            return _WINDOWS.get(self.status or 0, "")
        try:
            return signal.Signals(-self.status).name
        except ValueError:
            return f"signal {-self.status}"

    @property
    def ending(self) -> str:
        """How it ended, as what a sentence says of a process."""
        if self.not_a_frame:
            return f"sent what is no answer: {self.not_a_frame}"
        if self.signal_name:
            return f"was ended by {self.signal_name}"
        return "died" if self.status is None else f"ended with status {self.status}"

    def cause(self, where: str = "") -> str:
        """Say what killed it and, if it printed anything, the last line; ``where`` as " in the sandbox"."""
        last = self.output.strip().split("\n")[-1].strip()
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
    def last_lines(self) -> str:
        """The end of what it printed, as further lines of a message."""
        lines = [line.rstrip() for line in self.output.splitlines() if line.strip()][-_LINES:]
        return "".join(f"\n    | {line}" for line in lines)
