"""Remember what was computed, by key, under a bound: the one kind of cache of the package.

A ``Memo`` holds values by key; each has a weight, and once all of them weigh more than the bound, the least
recently used goes. ``Memo.cached`` remembers what a function returns, by the function and its arguments.
Functions of one concern share a memo: the memos below are all that outlive a call, besides those that an
engine has of its own (programs, meshes, textures of files). ``report`` lists every memo with what it holds,
``clear`` empties those below: results are the same afterwards, only later.

Arguments are compared by equality, or by identity where that is asked for: sketches, techniques and plans
are frozen and large, and a slider makes a new sketch around the same graph. An entry keeps such arguments
alive, so that their identity is not given to another object.
"""

from __future__ import annotations

import weakref
from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from functools import wraps
from threading import RLock
from typing import Any, Generic, NamedTuple, ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")
K = TypeVar("K", bound=Hashable)
V = TypeVar("V")

_memos: weakref.WeakSet[Memo[Any, Any]] = weakref.WeakSet()
_memos_lock = RLock()
_missing: Any = object()


class _Entry(NamedTuple):
    value: Any
    weight: int
    held: tuple[Any, ...]  # kept alive: the key names them by identity


class Usage(NamedTuple):
    """What one memo holds."""

    name: str
    entries: int
    weight: int  # of the entries together
    bound: int  # which the weight does not exceed, but for a single entry or pinned ones
    unit: str  # of weight and bound


class Memo(Generic[K, V]):
    """Values by key, the least recently used dropped above ``bound``; safe to share between threads.

    ``unit`` says what weights count: entries of weight 1, or bytes. The entry added last always stays.
    ``dropped`` is called with the key and value of each entry that goes, to release it; an entry for which
    ``pinned`` returns true stays above the bound.
    """

    def __init__(
        self,
        name: str,
        bound: int,
        unit: str = "entries",
        *,
        dropped: Callable[[K, V], None] | None = None,
        pinned: Callable[[K, V], bool] | None = None,
    ) -> None:
        self.name = name
        self.bound = bound
        self.unit = unit
        self.weight = 0  # of all entries
        # Below half of the bound nothing will go soon, and the order of use is not worth the time to note it.
        self._half_full = False
        self._dropped = dropped
        self._pinned = pinned
        self._entries: OrderedDict[Any, _Entry] = OrderedDict()  # the least recently used first
        self._lock = RLock()
        with _memos_lock:
            _memos.add(self)

    def __len__(self) -> int:
        return len(self._entries)

    def __contains__(self, key: K) -> bool:
        return key in self._entries

    def __iter__(self) -> Iterator[K]:
        with self._lock:  # to list the keys calls their ``__hash__``, which lets other threads run
            return iter(list(self._entries))

    def values(self) -> list[V]:
        """Return every value, the least recently used first."""
        with self._lock:
            return [entry.value for entry in self._entries.values()]

    def get(self, key: K, default: Any = None) -> Any:
        """Return the value of a key and mark it as used; ``default`` where there is none."""
        with self._lock:
            entry = self._entries.get(key)
            if entry is None:
                return default
            self._entries.move_to_end(key)
            return entry.value

    def put(self, key: K, value: V, weight: int = 1, *held: Any) -> V:
        """Set the value of a key, and return it; ``held`` is kept alive as long as the entry."""
        with self._lock:
            self.drop(key)
            self._entries[key] = _Entry(value, weight, held)
            self.weight += weight
            self._half_full = 2 * self.weight > self.bound
            if self.weight > self.bound:
                self._trim(key)
        return value

    def drop(self, key: K) -> None:
        """Drop the entry of a key, if there is one."""
        with self._lock:
            entry = self._entries.pop(key, None)
            if entry is not None:
                self.weight -= entry.weight
                if self._dropped is not None:
                    self._dropped(key, entry.value)

    def clear(self) -> None:
        """Drop every entry."""
        for key in self:
            self.drop(key)

    def _trim(self, newest: K) -> None:
        """Drop entries until the bound holds, the least recently used first."""
        while self.weight > self.bound:
            oldest = next((key for key in self._entries if key != newest and not self._is_pinned(key)), None)
            if oldest is None:
                return
            self.drop(oldest)

    def _is_pinned(self, key: K) -> bool:
        return self._pinned is not None and self._pinned(key, self._entries[key].value)

    # ── functions ────────────────────────────────────────────────────────────

    def cached(
        self, *, identities: int = 0, weight: int | Callable[[Any], int] = 1
    ) -> Callable[[Callable[P, R]], Callable[P, R]]:
        """Return a decorator that remembers what a function returns; what it raises is not remembered.

        The first ``identities`` arguments are compared by identity, the others by equality. ``weight`` is
        that of each value, or works it out. Two threads may compute the same value: both get the first.
        A hit costs 0.3 us.
        """

        def decorate(function: Callable[P, R]) -> Callable[P, R]:
            look_up = self._entries.get

            @wraps(function)
            def call(*args: P.args, **kwargs: P.kwargs) -> R:
                key: tuple[Any, ...] = function, args
                if identities:
                    key = function, *map(id, args[:identities]), args[identities:]
                if kwargs:
                    key = *key, tuple(sorted(kwargs.items()))
                entry = look_up(key)
                if entry is not None:
                    if self._half_full:
                        self.get(key)  # type: ignore
                    return entry[0]  # type: ignore[no-any-return]
                value = function(*args, **kwargs)
                with self._lock:
                    if (first := look_up(key)) is not None:
                        return first[0]  # type: ignore[no-any-return]
                    weighs = weight if isinstance(weight, int) else weight(value)
                    return self.put(key, value, weighs, *args[:identities])  # type: ignore

            return call

        return decorate

    def drop_of(self, function: Callable[..., Any]) -> None:
        """Drop what a function that is ``cached`` here has returned."""
        for key in self._keys_of(function):
            self.drop(key)

    def count_of(self, function: Callable[..., Any]) -> int:
        """Return how many values of a function that is ``cached`` here are remembered."""
        return len(self._keys_of(function))

    def _keys_of(self, function: Callable[..., Any]) -> list[Any]:
        inner = function.__wrapped__  # type: ignore[attr-defined]
        return [key for key in self if isinstance(key, tuple) and key and key[0] is inner]


TEXTS: Memo[Any, Any] = Memo("texts", 16384)
"""What a text alone says: its lines, tokens, declarations, tables; expressions and their numbers."""
FILES: Memo[Any, Any] = Memo("files", 16384)
"""What files say, by path and content, or checked against the file: parsed kernels, sizes, hashes.

A mosaic may have 4096 sources."""
GRAPHS: Memo[Any, Any] = Memo("graphs", 8192)
"""What follows from a kernel, technique or sketch, by its identity. A flattened graph weighs 256."""
PLANS: Memo[Any, Any] = Memo("plans", 48)
"""Plans, and what follows from their passes alone, by identity. Few: plans hold arrays."""
SOURCES: Memo[Any, Any] = Memo("sources", 2**30, "bytes")
"""Arrays read from files, or made by sources of data."""
INTERFACE: Memo[Any, Any] = Memo("interface", 2048)
"""What windows, pages and reports show again: typeset texts, labels, sections of panels."""


def report() -> list[Usage]:
    """Return what every memo holds, by name."""
    with _memos_lock:
        memos = list(_memos)
    return sorted([Usage(m.name, len(m), m.weight, m.bound, m.unit) for m in memos])


def clear() -> None:
    """Drop what is remembered in the memos of this module: what is asked for again is computed again.

    An engine's own (programs, meshes, textures) are left alone: they go with its context.
    """
    for memo in (TEXTS, FILES, GRAPHS, PLANS, SOURCES, INTERFACE):
        memo.clear()


def bytes_held(value: object) -> int:
    """Return the bytes of the arrays in a value, in its items and fields, for its weight; 4096 at least."""
    return max(_array_bytes(value), 4096)


def _array_bytes(value: object) -> int:
    size = getattr(value, "nbytes", None)
    if isinstance(size, int):
        return size
    if isinstance(value, Mapping):
        return sum(map(_array_bytes, value.values()))
    if isinstance(value, tuple | list):
        return sum(map(_array_bytes, value))
    return sum([_array_bytes(getattr(value, f.name)) for f in fields(value)]) if is_dataclass(value) else 0


class PickledByFields:
    """Base of a dataclass whose pickle holds its fields alone: cached properties are computed again.

    The pickle of a whole ``__dict__`` raises ``RuntimeError`` where a cached property is added to it
    meanwhile: a sketch is sent to a process by one thread while another draws it.
    """

    __slots__ = ()

    def __getstate__(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in fields(self)}  # type: ignore[arg-type]
