"""One Node process for each module of tests."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from . import node as processes


@pytest.fixture(scope="module")
def node() -> Iterator[processes.Node]:
    """Give a Node process that calls the runtime's modules."""
    if processes.MISSING:
        pytest.skip(processes.MISSING)
    with processes.Node() as found:
        yield found
