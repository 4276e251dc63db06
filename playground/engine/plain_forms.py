"""Report where a technique runs in its plain form, though there is a fast variant: once for each."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable

from playground.errors import PlainFormWarning
from playground.sketch.model import VARIANTS, Sketch
from playground.sketch.variants import unverified


def warn(sentence: str) -> None:
    """Warn, as Python does."""
    warnings.warn(sentence, PlainFormWarning, stacklevel=2)


def silent(sentence: str) -> None:
    """Report nothing: the caller does."""


class PlainForms:
    """Calls ``notice`` for each fast variant that does not run.

    ``compute`` and ``draws`` say whether there are compute shaders, and whether variants replace draws.
    """

    def __init__(self, notice: Callable[[str], None], *, compute: bool, draws: bool) -> None:
        self.notice = notice
        lacking = {"compute": not compute, "draws": not draws}
        self.kinds = tuple(kind for kind in VARIANTS if not lacking.get(kind))
        # Those that may run where a pixel has several samples, or a picture is drawn in parts.
        self.kinds_without_draws = tuple(kind for kind in self.kinds if kind != "draws")
        self._reported: set[str] = set()

    def report(self, sketch: Sketch, lacking: Iterable[str] = ()) -> None:
        """Report what is new of a sketch that is drawn; ``lacking`` are sentences of its plan."""
        kinds = self.kinds if sketch.picture.samples == 1 else self.kinds_without_draws
        for sentence in (*map(str, unverified(sketch, kinds)), *lacking):
            if sentence not in self._reported:
                self._reported.add(sentence)
                self.notice(sentence)
