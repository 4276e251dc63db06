"""What pictures and passes cost, as it was measured; what a pass will cost at another size; why each ran."""

from __future__ import annotations

from collections import deque
from collections.abc import Mapping
from itertools import pairwise

from playground.engine.cache_keys import StepKey
from playground.engine.execution import FrameRecord, why
from playground.studio.language import tr

LENGTH = 240
"""Pictures that are recorded."""
Numbers = deque[float]
"""The last numbers of a series, oldest first."""


class Record:
    """The costs of the pictures since they were first shown."""

    def __init__(self, length: int = LENGTH) -> None:
        self._length = length
        self.clear()

    def clear(self) -> None:
        """Forget all of it."""
        self.pictures = 0
        self.passes: dict[str, Numbers] = {}  # [ms] by path
        self.whole = self._numbers()  # [ms] of all passes
        self.texels = self._numbers()
        self.triangles = self._numbers()

    def add(self, times: Mapping[str, float], texels: int, triangles: int) -> None:
        """Take in a picture; a pass that did not run for it cost nothing."""
        for path in times:
            self.passes.setdefault(path, self._numbers(self.pictures))
        for path, spent in self.passes.items():
            spent.append(times.get(path, 0.0))
        self.whole.append(sum(times.values()))
        self.texels.append(texels)
        self.triangles.append(triangles)
        self.pictures += 1
        self.passes = {path: spent for path, spent in self.passes.items() if path in times or any(spent)}

    def most_expensive(self, most: int) -> list[str]:
        """Return the passes that cost most, the most expensive first."""
        return sorted(self.passes, key=lambda path: -sum(self.passes[path]))[:most]

    def _numbers(self, zeros: int = 0) -> Numbers:
        return deque([0.0] * min(zeros, self._length), self._length)


_MAX_SIZES = 4  # sizes that are remembered of a pass: those of the latest measurements


class PassCosts:
    """What the passes of one sketch took [ms], by path and by their texels.

    The first measurement of a pass includes its compiler, so that the second takes its place. Of a size
    that was measured before, one below replaces it, and one above, when the machine may have been busy,
    is averaged with it.
    """

    def __init__(self) -> None:
        self._costs: dict[str, dict[int, float]] = {}
        self._first: set[str] = set()  # paths that ran once so far

    def take(self, sizes: Mapping[str, int], times: Mapping[str, float]) -> None:
        """Take what passes took [ms] that ran with so many texels, both by path."""
        for path, spent in times.items():
            texels = sizes[path]
            if path not in self._costs:
                self._costs[path] = {texels: spent}
                self._first.add(path)
                continue
            costs = self._costs[path]
            if path in self._first:
                self._first.remove(path)
                costs.clear()
            before = costs.pop(texels, spent)
            costs[texels] = min(spent, 0.5 * (before + spent))
            while len(costs) > _MAX_SIZES:
                del costs[next(iter(costs))]

    def expected(self, path: str, texels: int) -> float | None:
        """Return what a pass is expected to take with so many texels [ms]; None where it never ran.

        Between measured sizes, and beyond two of them, it is linear in texels; beyond one it is in
        proportion.
        """
        costs = self._costs.get(path)
        if not costs:
            return None
        sizes = sorted(costs)
        if len(sizes) == 1 or texels <= sizes[0]:
            return costs[sizes[0]] * texels / sizes[0]
        low, high = next(((a, b) for a, b in pairwise(sizes) if texels <= b), (sizes[-2], sizes[-1]))
        # No smaller size takes longer, unless the machine was busy.
        least = min(costs[low], costs[high])
        return least + (costs[high] - least) * (texels - low) / (high - low)

    def clear(self) -> None:
        """Forget all: another sketch is opened, whose passes may have the same paths."""
        self._costs.clear()
        self._first.clear()


_MAX_LINES = 6


class RunReasons:
    """The latest reason of each pass. Keys are only remembered; they are compared when somebody asks."""

    def __init__(self) -> None:
        self._latest: dict[str, tuple[StepKey, StepKey | None]] = {}  # by path: then, and in the frame before
        self._record: FrameRecord | None = None  # that was taken in last

    def add(self, record: FrameRecord) -> None:
        """Take in the last picture, once; what its sketch no longer has is forgotten."""
        if record is self._record:
            return
        self._record, steps, before = record, record.keys.steps, record.before.steps
        self._latest = {path: keys for path, keys in self._latest.items() if path in steps}
        self._latest |= {path: (steps[path], before.get(path)) for path in record.ran if path in steps}

    def text(self, node: str) -> str:
        """Return why a pass ran last, of a technique a line for each pass inside; "" where none ran yet."""
        inside = [path for path in self._latest if path == node or path.startswith(f"{node}.")]
        lines = [
            (
                tr("Last ran because of: {why}") if path == node else tr("{path} last ran because of: {why}")
            ).format(path=path[len(node) + 1 :], why=_in_words(why(*self._latest[path])))
            for path in inside[:_MAX_LINES]
        ]
        more = len(inside) - len(lines)
        return "\n".join([*lines, tr("and {more} more", more=more)] if more else lines)


_REASONS = (
    "the pass",
    "its textures were dropped",
    "iterations of its loop",
    "text",
    "driver",
    "size",
    "window",
    "repeat",
    "iterations",
    "continued",
    "between",
    "file",
    "value",
    "given",
    "input",
)
"""How the engine's reasons are called, before the names in them."""


def _in_words(reasons: str) -> str:
    """Return the engine's reasons in the language that is in use: "value amplitude", "input height"."""
    words = []
    for reason in reasons.split(", "):
        kind = next((kind for kind in _REASONS if f"{reason} ".startswith(f"{kind} ")), "")
        words.append(tr(kind) + reason.removeprefix(kind))
    return ", ".join(words)
