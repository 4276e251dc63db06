"""Spread the many cases of one test over two runs: a quarter of them every day, the others in the slow run.

Where one function is called with many parameters, as for every size, seed and method, what is wrong with
the code is wrong in most of its cases. Which are for every day goes by the test's name, not by its place:
neighbours differ in the parameter that changes fastest, and every fourth of them could be all of one value.
"""

from __future__ import annotations

import zlib
from collections import defaultdict
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
MANY = 2  # cases of a function that are all for every day
SHARE = 4  # of more, one in so many


class Spread:
    """Marks cases as slow, of those that are not yet, before markers are looked at."""

    @pytest.hookimpl(tryfirst=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Mark what is left to the slow run; the first case of a function never is."""
        cases = defaultdict(list)
        for item in items:
            if item.path.is_relative_to(TESTS) and item.get_closest_marker("slow") is None:
                cases[item.nodeid.partition("[")[0]].append(item)
        for found in cases.values():
            if len(found) > MANY:
                for item in found[1:]:
                    if zlib.crc32(item.nodeid.encode()) % SHARE:
                        item.add_marker("slow")
