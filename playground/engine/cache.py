"""Cache the results of passes, under a bound in bytes and in number; the least recently used goes first."""

from __future__ import annotations

from collections import OrderedDict

from playground.engine.loops import KeptStates
from playground.engine.results import Cached, Pool, Result

# Results of any size: a driver spends memory on each texture besides its texels, so that thousands
# of small ones, one for each save of a small sketch, would grow past any bound in bytes.
MAX_ENTRIES = 512
# Of one pass or loop: whoever drags a slider or types a text leaves a version behind with every picture, and
# comes back to none of them. Their textures are used again: to make one costs as much as to fill it
# (1025 x 1025: 2 ms).
VERSIONS = 4
_SHARE_OF_STATES = 4  # a quarter of the bytes may be earlier states of loops that follow the time


class Cache:
    """The results of passes, by key; what the frame being drawn uses is never dropped."""

    def __init__(self, limit: int, pool: Pool) -> None:
        self.limit = limit  # [bytes]
        # [bytes] that may be held while a frame is drawn: what the last one used stays until its textures are
        # used again, or else a terrain of which one frame needs more than the limit would make them all anew.
        self._bound = limit
        self.versions = VERSIONS  # kept of one pass or loop; more where many are drawn in turn
        self.states = KeptStates(limit // _SHARE_OF_STATES, pool)
        self._pool = pool
        pool.make_room = self.make_room
        self._cached: OrderedDict[str, Cached] = OrderedDict()
        self._in_use: set[str] = set()
        self._stale: set[str] = set()  # not used since the last ``turn_over``
        self._may_grow: set[str] = set()  # used since they were weighed
        self._sizes: dict[str, int] = {}  # [bytes] of what is cached, when last weighed
        self._total = 0  # their sum
        self.hits = 0  # results that were taken from here
        self._latest: dict[str, tuple[str, str, int]] = {}
        self._read: dict[str, tuple[str, str]] = {}  # see ``note_read``
        # Of each pass by its path and its size, of each loop by its path: see ``Cached``.
        self._versions: dict[tuple[str, tuple[int, int] | None], OrderedDict[str, None]] = {}

    @property
    def bytes(self) -> int:
        """Bytes held."""
        self._weigh_used()
        return self._total + self.states.bytes

    def __len__(self) -> int:
        return len(self._cached)

    def __contains__(self, key: str) -> bool:
        return key in self._cached

    def holds(self, key: str, iterations: int) -> bool:
        """Return whether a loop is cached after so many iterations."""
        cached = self._cached.get(key)
        return cached is not None and cached.iterations == iterations

    def begin(self) -> None:
        """Begin a frame: nothing is in use yet."""
        self._weigh_used()
        self._bound = self.limit
        if self._total > self.limit:
            self._bound = max(self.limit, sum([self._sizes.get(key, 0) for key in self._in_use]))
        self._in_use.clear()

    def end(self) -> None:
        """End a frame: what it used is weighed, and what is over the bounds goes."""
        self._weigh_used()
        self._bound = self.limit
        self.trim()

    def get(self, key: str) -> Cached | None:
        """Return what is cached and mark it as used; None if there is nothing."""
        cached = self._cached.get(key)
        if cached is not None:
            self.hits += 1
            self._cached.move_to_end(key)
            self._in_use.add(key)
            self._stale.discard(key)
            self._may_grow.add(key)
            if cached.versions is not None:
                cached.versions.move_to_end(key)
        return cached

    def peek(self, key: str) -> Cached | None:
        """Return what is cached, without marking it as used."""
        return self._cached.get(key)

    def put(self, key: str, cached: Cached, loop: str = "") -> Cached:
        """Cache something, used by the current frame, and return it; what is over the bounds goes.

        ``loop``: the path of the loop whose results these are, or will be.
        """
        if key in self._cached:
            self.drop(key)
        self._cached[key] = cached
        self._in_use.add(key)
        self._stale.discard(key)
        self._may_grow.add(key)
        self.weigh(key)
        of = (loop, None) if loop else (next(iter(cached.results)), cached.result.size)
        versions = cached.versions = self._versions.setdefault(of, OrderedDict())
        versions[key] = None
        for old in [old for old in versions if old not in self._in_use][
            : max(len(versions) - self.versions, 0)
        ]:
            self.drop(old)
        self.trim()
        return cached

    def grew(self, key: str) -> None:
        """Weigh what has grown; what is over the bounds goes."""
        self.weigh(key)
        self.trim()

    def note_progress(self, path: str, unfinished: str, key: str, iterations: int) -> None:
        """Remember how far a pass that may go on has come."""
        self._latest[path] = (unfinished, key, iterations)

    def earlier(self, path: str, unfinished: str, iterations: int) -> str:
        """Return the key of the same pass after fewer iterations; "" where nothing is cached of it."""
        step_key, key, before = self._latest.get(path, ("", "", 0))
        return key if step_key == unfinished and before < iterations and key in self._cached else ""

    def note_read(self, path: str, read: str, key: str) -> None:
        """Remember what a pass has read that has this key."""
        self._read[path] = (read, key)

    def with_same_read(self, path: str, read: str) -> str:
        """Return the key of the same pass where it read the same; "" where nothing is cached of it."""
        read_key, key = self._read.get(path, ("", ""))
        return key if read_key == read and key in self._cached and key not in self._in_use else ""

    def take(self, key: str) -> Result:
        """Hand over the result of a pass to the caller, and forget it."""
        cached = self._cached.pop(key)
        result = cached.result
        if cached.versions is not None:
            del cached.versions[key]
        self._in_use.discard(key)
        self.weigh(key)
        return result

    def drop(self, key: str) -> None:
        """Forget something."""
        cached = self._cached.pop(key, None)
        self._in_use.discard(key)
        self.weigh(key)
        if cached is not None:
            if cached.versions is not None:
                del cached.versions[key]
            cached.release_to(self._pool)

    def drop_unused(self) -> None:
        """Drop what the current frame does not use."""
        for key in [key for key in self._cached if key not in self._in_use]:
            self.drop(key)
        self.states.retain(self._in_use)

    def turn_over(self) -> None:
        """Drop what was not used since the last call; called when a frame has shown another sketch.

        So the results of two sketches stay, for whoever goes back and forth between them, and not of all that
        were opened.
        """
        for key in self._stale:
            self.drop(key)
        self._stale = set(self._cached) - self._in_use
        self.states.retain(set(self._cached))

    def trim(self) -> None:
        """Drop what was used least recently, then earlier states, until the bounds hold.

        What is in use stays.
        """
        if self._holds():
            return
        for key in [key for key in self._cached if key not in self._in_use]:
            self.drop(key)
            if self._holds():
                return
        while not self._holds() and self.states.thin():
            pass

    def make_room(self, more: int) -> None:
        """Drop what was used least recently until so many bytes more are within the bound.

        Its textures can be used again for what is made: that is quicker than to drop it afterwards, and never
        needs the memory of both.
        """
        for key in [key for key in self._cached if key not in self._in_use]:
            if self._holds(more):
                return
            self.drop(key)

    def _holds(self, more: int = 0) -> bool:
        return self._total + self.states.bytes + more <= self._bound and len(self._cached) <= MAX_ENTRIES

    def clear(self) -> None:
        """Drop everything."""
        for cached in self._cached.values():
            cached.release_to(self._pool)
        self.states.clear()
        self._cached.clear()
        self._in_use.clear()
        self._may_grow.clear()
        self._sizes.clear()
        self._total = 0
        self._latest.clear()
        self._read.clear()
        self._versions.clear()

    def _weigh_used(self) -> None:
        """Weigh what was used since the last time: mipmaps may have been made."""
        for key in self._may_grow:
            self.weigh(key)
        self._may_grow.clear()

    def weigh(self, key: str) -> None:
        """Add what one key holds now to the total."""
        cached = self._cached.get(key)
        now, before = cached.bytes if cached is not None else 0, self._sizes.get(key, 0)
        if now == before:
            return
        self._total += now - before
        if now:
            self._sizes[key] = now
        else:
            del self._sizes[key]
