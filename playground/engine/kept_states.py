"""Keep some earlier states of loops that follow the time, so that it may go back.

A state is what a loop feeds back after some of its iterations; the loop goes on from the latest one
before those that it is to run. States are dense close to the present and ever sparser away from it: the
one that goes first is the one without which the longest run, measured by how far away it is, grows
least. So a jump costs a share of its distance, and steps backwards cost little: each run fills in the
states before its end. Results do not depend on what is kept.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import OrderedDict
from dataclasses import dataclass, field
from math import inf

from playground.engine.results import Pool, Result

MOST_STATES = 48  # of one loop
_MOST_KEYS = 2  # of one loop's path: two versions that are compared are drawn in turn

State = dict[str, Result]
"""What a loop feeds back, by the path of the step that computed it."""


@dataclass(eq=False)
class _Kept:
    """The states of one key, by iterations done."""

    now: int = 0  # the iterations that were wanted last
    numbers: list[int] = field(default_factory=list)  # ascending
    states: dict[int, State] = field(default_factory=dict)
    sizes: dict[int, int] = field(default_factory=dict)  # [bytes]
    bytes: int = 0

    def pop(self, number: int) -> State:
        """Take a state out."""
        del self.numbers[bisect_left(self.numbers, number)]
        self.bytes -= self.sizes.pop(number)
        return self.states.pop(number)

    def least(self) -> int:
        """Return the state that is missed least: see the module."""
        # A loop over places, for this is asked at every iteration.
        numbers, now = self.numbers, self.now
        ends, before, found, cost = (*numbers[1:], max(now, numbers[-1])), 0, numbers[0], inf
        for number, after in zip(numbers, ends, strict=True):
            own = (after - before) / (abs(now - number) + 1)
            if own < cost:
                found, cost = number, own
            before = number
        return found


class KeptStates:
    """The earlier states of loops, under a bound in bytes and in number."""

    def __init__(self, limit: int, pool: Pool) -> None:
        self.limit = limit  # [bytes]
        self._pool = pool
        self._kept: dict[str, OrderedDict[str, _Kept]] = {}  # by the loop's path, then by its key

    @property
    def bytes(self) -> int:
        """Bytes held."""
        return sum(kept.bytes for kept in self._every())

    def __len__(self) -> int:
        return sum(len(kept.numbers) for kept in self._every())

    def numbers(self, path: str, key: str) -> tuple[int, ...]:
        """Return after how many iterations there are states, ascending."""
        kept = self._kept[path].get(key) if path in self._kept else None
        return tuple(kept.numbers) if kept else ()

    def latest(self, path: str, key: str, most: int) -> int:
        """Return the most iterations, up to ``most``, after which there is a state; 0 for none."""
        kept = self._kept[path].get(key) if path in self._kept else None
        place = bisect_right(kept.numbers, most) if kept else 0
        return kept.numbers[place - 1] if kept and place else 0

    def is_due(self, path: str, key: str, number: int, now: int) -> bool:
        """Return whether to keep a state after some iterations, while a loop runs on to ``now``.

        All of a short run are, for there is room. Of a longer one, a state that lies closer to the one before
        than states will that are spread evenly in the logarithm of their distance from the end would go.
        """
        share = now ** (1 / MOST_STATES) - 1 if now > MOST_STATES else 0.0
        before = self.latest(path, key, number)
        return number > before and number - before >= share * (now - number)

    def take(self, path: str, key: str, number: int) -> State:
        """Hand over a state that there is; it is the caller's."""
        return self._kept[path][key].pop(number)

    def keep(self, path: str, key: str, number: int, state: State, now: int) -> None:
        """Take over a state after some iterations; ``now`` are those that are wanted.

        What is over the bounds goes, this one perhaps.
        """
        keys = self._kept.setdefault(path, OrderedDict())
        kept = keys.setdefault(key, _Kept())
        keys.move_to_end(key)
        while len(keys) > _MOST_KEYS:
            self._release(keys.popitem(last=False)[1])
        kept.now = now
        if number in kept.states:
            self._give(kept.pop(number))
        insort(kept.numbers, number)
        kept.states[number] = state
        kept.sizes[number] = sum(result.bytes for result in state.values())
        kept.bytes += kept.sizes[number]
        if len(kept.numbers) > MOST_STATES:
            self._give(kept.pop(kept.least()))
        while self.bytes > self.limit:
            self.thin()

    def thin(self) -> bool:
        """Drop the state that is missed least, of the loop whose states are largest; False: there is none."""
        kept = max(self._every(), key=lambda each: each.bytes, default=None)
        if kept is None or not kept.numbers:
            return False
        self._give(kept.pop(kept.least()))
        return True

    def retain(self, keys: set[str]) -> None:
        """Drop the states of all other keys."""
        for known in self._kept.values():
            for key in known.keys() - keys:
                self._release(known.pop(key))

    def clear(self) -> None:
        """Drop every state."""
        self.retain(set())
        self._kept.clear()

    def _every(self) -> list[_Kept]:
        return [kept for keys in self._kept.values() for kept in keys.values()]

    def _release(self, kept: _Kept) -> None:
        for state in kept.states.values():
            self._give(state)

    def _give(self, state: State) -> None:
        for result in state.values():
            self._pool.give(result)
