"""A memo remembers what was computed, under its bound, and drops what was used least recently."""

from __future__ import annotations

import gc
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
import pytest

from playground import memo
from playground.memo import Memo, bytes_held


class Thing:
    """Equal to every other of its kind."""

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Thing)

    def __hash__(self) -> int:
        return 1


@pytest.mark.parametrize("seed", range(20))
def test_the_least_recently_used_goes_above_the_bound(seed):
    rng = np.random.default_rng(seed)
    puts, bound = rng.integers((0, 1), (10, 8), (60, 2)).tolist(), int(rng.integers(1, 21))
    result, order = Memo("test", bound), list[tuple[int, int]]()  # by the age of their use
    for key, weight in puts:
        if key in [existing for existing, _ in order]:
            assert result.get(key) == key
            order.append(order.pop([existing for existing, _ in order].index(key)))
            continue
        result.put(key, key, weight)
        order.append((key, weight))
        while sum(w for _, w in order) > bound and len(order) > 1:
            order.pop(0)
        assert list(result) == [existing for existing, _ in order]
        assert result.weight == sum(w for _, w in order)


def test_a_function_is_computed_once_for_equal_arguments():
    calls, kept = [], Memo("test", 4)

    @kept.cached()
    def double(number: int, *, plus: int = 0) -> int:
        calls.append(number)
        return 2 * number + plus

    assert [double(1), double(1), double(1, plus=1), double(1, plus=1)] == [2, 2, 3, 3]
    assert calls == [1, 1]
    kept.drop_of(double)
    assert kept.count_of(double) == 0 and double(1) == 2 and len(calls) == 3


def test_what_a_function_raises_is_not_remembered():
    calls, kept = [], Memo("test", 4)

    @kept.cached()
    def fail(number: int) -> int:
        calls.append(number)
        raise ValueError

    for _ in range(2):
        with pytest.raises(ValueError):
            fail(1)
    assert len(calls) == 2 and not len(kept)


def test_arguments_by_identity_live_as_long_as_the_entry():
    kept, first, other = Memo("test", 8), Thing(), Thing()

    @kept.cached(identities=1)
    def same(thing: Thing, name: str) -> int:
        return id(thing)

    assert same(first, "a") == id(first) != same(other, "a") == id(other)
    alive = weakref.ref(first)
    del first
    gc.collect()
    assert alive() is not None
    kept.clear()
    gc.collect()
    assert alive() is None


def test_what_is_dropped_is_released_and_what_is_pinned_stays():
    released, pinned = [], {0}
    kept = Memo("test", 2, dropped=lambda key, _: released.append(key), pinned=lambda key, _: key in pinned)
    for key in range(5):
        kept.put(key, key)
    assert list(kept) == [0, 4] and released == [1, 2, 3]
    kept.put(4, "another")
    kept.clear()
    assert released == [1, 2, 3, 4, 0, 4] and kept.weight == 0


def test_the_entry_added_last_stays_whatever_it_weighs():
    kept = Memo("test", 10, "bytes")
    kept.put("small", 1, 5)
    kept.put("large", 2, 100)
    assert list(kept) == ["large"]


def test_threads_share_a_memo():
    kept = Memo("test", 50)

    @kept.cached()
    def thing(number: int) -> object:
        return object()

    def ask(start: int) -> int:
        return sum(thing((start * n) % 97) is not None for n in range(2000))

    with ThreadPoolExecutor(4) as pool:
        assert list(pool.map(ask, range(1, 5))) == [2000] * 4
    assert len(kept) <= 50 and kept.weight == len(kept)


def test_keys_are_listed_while_another_thread_adds_one():
    kept, threads = Memo("test", 8), list[threading.Thread]()

    class Key:
        """Its hash lets another thread run."""

        def __hash__(self) -> int:
            if adds:
                threads.append(threading.Thread(target=kept.put, args=(adds.pop(), 0)))
                threads[-1].start()
                threads[-1].join(0.1)
            return 1

    adds: list[str] = []
    keys = [Key(), Key()]
    for key in keys:
        kept.put(key, 0)
    adds.append("another")
    assert list(kept) == keys
    for thread in threads:
        thread.join()
    assert list(kept) == [*keys, "another"]


def test_memos_are_reported_while_another_thread_makes_one():
    made: list[Memo[int, int]] = []

    def make() -> None:
        made.append(Memo("another", 1))

    class Slow(Memo[int, int]):
        """Its length lets another thread run."""

        def __len__(self) -> int:
            if not made:
                thread = threading.Thread(target=make)
                thread.start()
                thread.join()
            return 0

    slow = Slow("slow", 1)
    assert slow.name in {usage.name for usage in memo.report()} and made


def test_the_report_names_every_memo_and_clear_empties_them():
    memo.TEXTS.put("test", 1)
    usage = {each.name: each for each in memo.report()}
    assert usage["texts"].entries >= 1 and usage["texts"].bound == memo.TEXTS.bound
    assert {"texts", "files", "graphs", "plans", "sources", "interface"} <= usage.keys()
    memo.clear()
    assert not len(memo.TEXTS)


def test_the_bytes_of_arrays_are_counted_in_items_and_fields():
    @dataclass
    class Read:
        heights: np.ndarray
        more: dict[str, list[np.ndarray]]
        name: str = "a"

    large = np.zeros((100, 100), np.float32)
    assert bytes_held(Read(large, {"a": [large, large]})) == 3 * 40_000
    assert bytes_held("text") == 4096
