"""The stages that a saved sketch goes through before it is shown, and who tries it."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from playground.engine.trial import TrialReport, TrySketch
from playground.errors import PlaygroundError

log = logging.getLogger("playground.live")


class Tester(Protocol):
    """What tries a sketch where it can do no harm: ``engine.trial.Trial``, or a test's stand-in."""

    def submit(self, request: TrySketch) -> None:
        """Hand over a sketch."""

    def poll(self) -> TrialReport | None:
        """Return the answer to the newest request, once."""


class Stage(Enum):
    """How far the coming draft has got."""

    NONE = "nothing is coming"
    TRIAL = "tried in the child"
    DRAW = "to be drawn"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class Reload:
    """How a save came to be a picture."""

    seconds: float  # from reading the files to the picture
    trial: float  # [s] of it in the trial child


def explained(error: Exception) -> PlaygroundError:
    """Return an error that a person can be shown; the session outlives its own faults as well."""
    if isinstance(error, PlaygroundError):
        return error
    log.exception("the playground itself failed")
    return PlaygroundError(f"a fault of the playground itself, {type(error).__name__}: {error}")
