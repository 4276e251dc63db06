"""Where and how a draft is checked before it is drawn, and what has been drawn already."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from playground.sketch.model import Sketch
from playground.studio.reload.reload_stages import Sandbox


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
