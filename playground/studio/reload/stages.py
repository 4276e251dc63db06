"""The stages that a saved sketch goes through before it is shown, how it is checked, and its errors."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import Protocol

from playground.engine.sandbox import SandboxReport, TrySketch
from playground.errors import ContextError, PlaygroundError, SketchError
from playground.files import irregularity
from playground.paths import shown
from playground.sketch.model import Sketch

log = logging.getLogger("playground.studio")


class Sandbox(Protocol):
    """What draws a sketch in a process of its own first: ``engine.sandbox.Sandbox``, or a fake in a test."""

    def submit(self, request: TrySketch) -> object:
        """Submit a sketch; it replaces the one before."""

    def poll(self) -> SandboxReport | None:
        """Return the answer to the newest request, once."""


class ReloadStage(Enum):
    """How far the coming draft has got."""

    NONE = "nothing is coming"
    SANDBOX = "checked in the sandbox"
    DRAW = "to be drawn"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class Reload:
    """How long a save took to become a picture."""

    seconds: float  # from reading the files to the picture
    sandbox: float  # [s] of it in the sandbox


def explained(error: Exception, sketch: Path) -> PlaygroundError:
    """Return an error that a person can be shown, each of its diagnostics with a file.

    One that names no file gets the sketch's own. A bug of the playground itself is an error too,
    and the session outlives it.
    """
    if not isinstance(error, PlaygroundError):
        log.error("the playground itself failed", exc_info=error)
        message = f"a bug of the playground itself, {type(error).__name__}: {error}"
        return PlaygroundError(message, file=sketch)
    if all(diagnostic.file for diagnostic in error.diagnostics):
        return error
    file = shown(sketch)
    diagnostics = [d if d.file else replace(d, file=file) for d in error.diagnostics]
    return type(error)(diagnostics=diagnostics)


def refusal(report: SandboxReport) -> PlaygroundError | None:
    """Return why a sketch must not be drawn, by the sandbox's answer; None where it may be.

    Without a context the sandbox can check nothing; this process may well have what it takes.
    """
    if report.ok or isinstance(report.error, ContextError):
        return None
    return report.error or PlaygroundError("the sandbox failed without saying why")


def missing_file_error(sketch: Path) -> SketchError | None:
    """Return the error for a sketch whose file has vanished; None while it is there."""
    if sketch.is_file():
        return None
    if what := irregularity(sketch):
        return SketchError(what, file=sketch)
    where = "from" if sketch.parent.is_dir() else "with its folder"
    ways = "moved, renamed or deleted; put it back, or drop another sketch on the window"
    return SketchError(f"the file is gone {where} {sketch.parent}: {ways}", file=sketch)


class DrawnState(Protocol):
    """What has been drawn already: it needs no sandbox."""

    def needs_drawing(self, sketch: Sketch) -> bool:
        """Say whether the driver would get anything that it has not drawn already."""

    def reads_new_data(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with."""


@dataclass(frozen=True, kw_only=True)
class Checks:
    """Where and how a draft is checked before it is drawn."""

    driver: str
    variants: tuple[str, ...] = ()  # kinds of fast variants that can run
    sandbox: Sandbox | None = None
    now: Callable[[], float] = time.perf_counter  # [s] of any clock
    sketch_time: Callable[[], float] = lambda: 0.0  # [s] at which the sandbox draws
