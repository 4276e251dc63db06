"""Delta debugging gives a part that passes and of which no item can be spared, for any test."""

from __future__ import annotations

import random
from itertools import combinations

from playground.verify.reduce.search import ddmin

from ...cases import each


def passing(n, test):
    """Return every subset of range(n) that passes, the slow way."""
    return [set(s) for k in range(n + 1) for s in combinations(range(n), k) if test(list(s))]


def needs(*cores):
    """Return a test that passes where one of some sets is whole."""
    return lambda some: any(core <= set(some) for core in cores)


def assert_one_minimal(left, test):
    assert test(left)
    for index in range(len(left)):
        assert not test(left[:index] + left[index + 1 :]), f"{left[index]} can be spared"


@each("seed", range(40))
def test_of_one_core_it_finds_just_that(seed):
    """Where all that passes holds one set, that set is the smallest: brute force says the same."""
    rng = random.Random(seed)
    n = rng.randint(1, 10)
    core = set(rng.sample(range(n), rng.randint(0, n)))
    test = needs(core)
    assert set(ddmin(range(n), test)) == core == min(passing(n, test), key=len)


@each("seed", range(60))
def test_for_any_test_no_item_can_be_spared(seed):
    """Also where the test knows no order: a list may fail though a part of it passes."""
    rng = random.Random(seed)
    n = rng.randint(1, 9)
    good = {frozenset(c for c in range(n) if rng.random() < 0.5) for _ in range(12)} | {frozenset(range(n))}

    def test(some):
        return frozenset(some) in good

    left = ddmin(range(n), test)
    assert set(left) in passing(n, test)
    assert_one_minimal(left, test)


def test_of_several_cores_it_finds_one_and_keeps_the_order():
    test = needs({2, 5, 11}, {3, 7})
    left = ddmin(range(16), test)
    assert set(left) in ({2, 5, 11}, {3, 7})
    assert left == sorted(left)
    assert_one_minimal(left, test)


def test_equal_items_are_items_each():
    assert ddmin("abcabc", lambda some: some.count("b") >= 2) == ["b", "b"]


def test_one_item_among_many_takes_few_tries():
    """Halving: some 2 log2(n) tries for one item of n."""
    tries = []

    def test(some):
        tries.append(len(some))
        return 700 in some

    assert ddmin(range(1024), test) == [700]
    assert len(tries) < 45


def test_it_tries_the_same_each_time():
    def run():
        results = []
        ddmin(range(20), lambda some: results.append(tuple(some)) or {4, 17} <= set(some))
        return results

    assert run() == run()
