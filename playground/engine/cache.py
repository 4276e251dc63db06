"""Keep what passes made, under a bound in bytes and in number; what was used least recently goes first."""

from __future__ import annotations

from collections import OrderedDict
from dataclasses import dataclass

from playground.engine.results import Pool, Result

# Results kept, whatever their size: a driver spends memory on each texture beside its texels, so
# that thousands of small ones, one for each save of a small sketch, would grow past any bound in bytes.
MOST = 512


@dataclass(eq=False)
class Cached:
    """The results of one pass, or of all passes of a loop after some iteration."""

    results: dict[str, Result]  # by the pass's path
    turn: int = 0  # iterations done, of a loop

    @property
    def bytes(self) -> int:
        """Bytes held."""
        return sum([result.bytes for result in self.results.values()])

    def let_go(self, pool: Pool) -> None:
        """Give the textures to a pool."""
        for result in self.results.values():
            pool.give(result)
        self.results = {}


class Cache:
    """What passes made, by key; what the frame being drawn uses is never dropped."""

    def __init__(self, limit: int, pool: Pool) -> None:
        self.limit = limit  # [bytes]
        self._pool = pool
        self._kept: OrderedDict[str, Cached] = OrderedDict()
        self._in_use: set[str] = set()
        self._may_grow: set[str] = set()  # used since they were weighed
        self._sizes: dict[str, int] = {}  # [bytes] of what is kept, as it was when last looked at
        self._total = 0  # their sum
        self._latest: dict[str, tuple[str, str, int]] = {}

    @property
    def bytes(self) -> int:
        """Bytes held."""
        self._weigh_used()
        return self._total

    def __len__(self) -> int:
        return len(self._kept)

    def __contains__(self, key: str) -> bool:
        return key in self._kept

    def holds(self, key: str, turn: int) -> bool:
        """Return whether a loop is cached after that iteration."""
        kept = self._kept.get(key)
        return kept is not None and kept.turn == turn

    def begin(self) -> None:
        """Begin a frame: nothing is in use yet."""
        self._weigh_used()
        self._in_use.clear()

    def end(self) -> None:
        """End a frame: what it used is weighed, and what is over the bounds goes."""
        self._weigh_used()
        self.trim()

    def get(self, key: str) -> Cached | None:
        """Return what is kept and mark it as used; None if there is nothing."""
        kept = self._kept.get(key)
        if kept is None:
            return None
        self._kept.move_to_end(key)
        self._use(key)
        return kept

    def peek(self, key: str) -> Cached | None:
        """Return what is kept, as if nobody had looked."""
        return self._kept.get(key)

    def put(self, key: str, kept: Cached) -> None:
        """Keep something, used by the current frame; what is over the bound goes."""
        self.drop(key)
        self._kept[key] = kept
        self._use(key)
        self.grew(key)

    def grew(self, key: str) -> None:
        """Weigh what has grown; what is over the bounds goes."""
        self._weigh(key)
        self.trim()

    def note_turn(self, path: str, unfinished: str, key: str, turn: int) -> None:
        """Remember how far a pass that may go on has come."""
        self._latest[path] = (unfinished, key, turn)

    def take_earlier(self, path: str, unfinished: str, turn: int) -> Result | None:
        """Hand over the same pass after fewer iterations to the caller, if this frame does not use it."""
        known, key, before = self._latest.get(path, ("", "", 0))
        if known != unfinished or before >= turn or key in self._in_use or key not in self._kept:
            return None
        (result,) = self._kept.pop(key).results.values()
        self._weigh(key)
        return result

    def drop(self, key: str) -> None:
        """Forget something."""
        kept = self._kept.pop(key, None)
        self._in_use.discard(key)
        self._weigh(key)
        if kept is not None:
            kept.let_go(self._pool)

    def drop_unused(self) -> None:
        """Drop whatever the current frame does not use."""
        for key in [key for key in self._kept if key not in self._in_use]:
            self.drop(key)

    def trim(self) -> None:
        """Drop what was used least recently until the bounds hold or all that is left is in use."""
        if self._total <= self.limit and len(self._kept) <= MOST:
            return
        for key in [key for key in self._kept if key not in self._in_use]:
            self.drop(key)
            if self._total <= self.limit and len(self._kept) <= MOST:
                return

    def clear(self) -> None:
        """Drop everything."""
        for kept in self._kept.values():
            kept.let_go(self._pool)
        self._kept.clear()
        self._in_use.clear()
        self._may_grow.clear()
        self._sizes.clear()
        self._total = 0
        self._latest.clear()

    def _use(self, key: str) -> None:
        self._in_use.add(key)
        self._may_grow.add(key)

    def _weigh_used(self) -> None:
        """Weigh what was used since the last time: mipmaps may have been made."""
        for key in self._may_grow:
            self._weigh(key)
        self._may_grow.clear()

    def _weigh(self, key: str) -> None:
        """Take in what one key holds now."""
        kept = self._kept.get(key)
        now = kept.bytes if kept is not None else 0
        self._total += now - self._sizes.pop(key, 0)
        if now:
            self._sizes[key] = now
