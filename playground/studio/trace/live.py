"""Tell editors which texel is traced, so that they show its values beside the code."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path

from playground.engine.trace.live_texel import LiveTexel, write_live_texel
from playground.studio.trace.tracing import Tracing

_SECONDS = 0.5  # between two texels, while the mouse moves


class LiveTexelFile:
    """The file of the texel that is traced; without a ``file`` nothing is written."""

    def __init__(self, tracing: Tracing, file: Path | None, now: Callable[[], float]) -> None:
        self._tracing, self._file, self._now = tracing, file, now
        self._written: LiveTexel | None = None
        self._free_at = 0.0

    @property
    def patience(self) -> float:
        """How long nothing needs to be written [s]."""
        if self._file is None or self._texel() == self._written:
            return math.inf
        return max(self._free_at - self._now(), 0.0)

    def update(self) -> None:
        """Write the texel, if it is another one, or remove the file once nothing is traced."""
        if self._file is not None and self.patience == 0.0:
            self._written = self._texel()
            self._free_at = self._now() + _SECONDS
            write_live_texel(self._written, self._file)

    def close(self) -> None:
        """Remove the file, if this window has written it."""
        if self._file is not None and self._written is not None:
            self._written = None
            write_live_texel(None, self._file)

    def _texel(self) -> LiveTexel | None:
        tracing, session = self._tracing, self._tracing.session
        if not tracing.on or tracing.view is None or session.sketch is None or session.plan is None:
            return None
        trace, plan, side = tracing.view.trace, session.plan, session.sketch.terrain.size
        return LiveTexel(
            sketch=str(session.path.absolute()),
            path=trace.step,
            texel=trace.texel,
            iteration=tracing.choice.iteration,
            size=plan.frame_size,
            time=plan.time,
            values=(*((("size", side),) if side is not None else ()), *session.sketch.overrides),
        )
