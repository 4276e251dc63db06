"""Why each pass ran when it ran last: what of its key was another than in the frame before."""

from __future__ import annotations

from playground.engine.cache_keys import StepKey
from playground.engine.execution import FrameRecord, why

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
            f"{'Last' if path == node else f'{path[len(node) + 1 :]} last'} ran: {why(*self._latest[path])}"
            for path in inside[:_MAX_LINES]
        ]
        more = len(inside) - len(lines)
        return "\n".join([*lines, f"and {more} more"] if more else lines)
