"""Define what a parent and its worker process exchange, each message pickled in a frame of its own.

    parent                          child
    Setup                    ──▶
                             ◀──    Ready
    request                  ──▶
                             ◀──    Progress, as often as the handler reports
    CANCEL, if it must stop  ──▶
                             ◀──    Answer

The parent closes the pipe to end the child. A pickle is only ever read from our own parent or child.
"""

from __future__ import annotations

from dataclasses import dataclass

CANCEL = b""
"""The frame that cancels the request at work."""


@dataclass(frozen=True)
class Setup:
    """What a child is started with."""

    options: object  # for its handler
    memory_bytes: int | None  # that it may take; None: as many as the machine has
    alarm_seconds: float  # after which the system ends it, if its parent does not; 0: never
    life: int  # file number of a pipe that the parent holds open while it lives; -1: none


@dataclass(frozen=True)
class Ready:
    """The handler has what it needs, or the error that it met: then each answer is that error."""

    info: object = None  # what the handler tells of itself
    error: Exception | None = None


@dataclass(frozen=True)
class Progress:
    """What the handler is about to do, or how far it is."""

    value: object


@dataclass(frozen=True)
class Answer:
    """What came of a request: a value, or the error that was raised instead."""

    value: object = None
    error: Exception | None = None
    seconds: float = 0.0  # that the handler took

    def get(self) -> object:
        """Return the value, or raise the error."""
        if self.error is not None:
            raise self.error
        return self.value


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
