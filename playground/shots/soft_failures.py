"""Fail a test at its end for all the pictures of it that differ, whatever else came of it.

A check of a picture does not end its test, so that one run shows all that differ. Where the test
then ends well, or is skipped, it fails for them; where something is raised in it, that is shown,
with a note of them. What is found after the test itself, as in a fixture's clean-up, is an error there.
"""

from __future__ import annotations

from collections.abc import Generator

import pytest

_FAILURES: pytest.StashKey[list[str]] = pytest.StashKey()


def add_failure(node: pytest.Item, message: str) -> None:
    """Record that a picture of a test failed."""
    node.stash.setdefault(_FAILURES, []).append(message)


def fail_for_what_is_left(node: pytest.Item) -> None:
    """Fail now for the pictures that no one has been told of."""
    if message := _told(node):
        pytest.fail(message, pytrace=False)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_call(item: pytest.Item) -> Generator[None, None, None]:
    """Run the test, then fail it for its pictures."""
    skipped = ""
    try:
        yield
    except pytest.skip.Exception as reason:
        if not item.stash.get(_FAILURES, []):
            raise
        skipped = f"\n\nthen the test was skipped: {reason}"
    except Exception as error:
        if message := _told(item):
            error.add_note(f"\nBefore that:\n{message}")
        raise
    except pytest.fail.Exception as failed:
        if message := _told(item):
            failed.msg = f"{failed.msg}\n\nBefore that:\n{message}"
        raise
    if message := _told(item):
        pytest.fail(message + skipped, pytrace=False)


def _told(node: pytest.Item) -> str:
    """Return the failures of a test, which are then told; "" for none."""
    failures = node.stash.get(_FAILURES, [])
    node.stash[_FAILURES] = []
    return "\n\n".join([f"{len(failures)} pictures of this test fail:", *failures][len(failures) < 2 :])
