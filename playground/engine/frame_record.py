"""Record what the last frame was made from, what it gave and what its making took."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from typing import Protocol

from playground.engine.cache_keys import Keys, StepKey
from playground.engine.plan import Plan
from playground.engine.results import Result
from playground.engine.runner import Runner


@dataclass
class FrameRecord:
    """One frame; before the first there is no plan."""

    plan: Plan | None = None
    keys: Keys = field(default_factory=Keys)
    before: Keys = field(default_factory=Keys)  # of the frame before, whatever it was of
    results: Mapping[str, Result] = field(default_factory=dict)  # by path; valid until the next frame
    ran: list[str] = field(default_factory=list)  # paths of the passes that ran, in order
    iterations: Counter[str] = field(default_factory=Counter)  # of each pass that ran, by path
    texels: int = 0  # computed
    times: dict[str, float] = field(default_factory=dict)  # [ms] of each pass that ran, while profiling
    triangles: int = 0  # drawn; of what is cached, none

    def reasons(self, path: str) -> tuple[str, ...]:
        """Return why a step ran again: what of its key is another than in the frame before, by name.

        See ``StepKey.difference``; ("the pass",) where that frame had none of this path, nothing where the
        key is the same: its textures had been dropped.
        """
        return _reasons(self.keys.steps[path], self.before.steps.get(path))

    def plus(self, before: FrameRecord) -> FrameRecord:
        """Return the record with the counts of an earlier drawing of the same frame added."""
        return replace(
            self,
            ran=[*before.ran, *(path for path in self.ran if path not in before.ran)],
            iterations=before.iterations + self.iterations,
            texels=before.texels + self.texels,
            times={p: before.times.get(p, 0.0) + self.times.get(p, 0.0) for p in before.times | self.times},
            triangles=before.triangles + self.triangles,
        )

    def counted_as(self, other: FrameRecord) -> FrameRecord:
        """Return the record with the counts of another frame, and why passes ran for it."""
        return replace(
            self,
            before=other.before,
            ran=other.ran,
            iterations=other.iterations,
            texels=other.texels,
            times=other.times,
            triangles=other.triangles,
        )


def _reasons(key: StepKey, before: StepKey | None) -> tuple[str, ...]:
    return ("the pass",) if before is None else key.difference(before)


def why(key: StepKey, before: StepKey | None) -> str:
    """Return as text why a step ran that had another key, or none, in the frame before."""
    return ", ".join(_reasons(key, before)) or "its textures were dropped"


class FrameSource(Protocol):
    """What draws frames, as far as those need it that look at the last one."""

    @property
    def record(self) -> FrameRecord:
        """The last frame's."""

    @property
    def runner(self) -> Runner:
        """What runs the passes, with its context and its pool of textures."""

    def borrowed(self) -> AbstractContextManager[None]:
        """Lend the context, made current."""

    def recall(self, plan: Plan) -> None:
        """Make an earlier frame the last one again."""
