"""Fail a test at its end for all the pictures of it that differ, or for none that was checked.

A check of a picture does not end its test, so that one run shows all that differ. Where the test
then ends well, or is skipped, it fails for them; where something is raised in it, that is shown,
with a note of them. What is found after the test itself, as in a fixture's clean-up, is an error there.
A test that ends well and has checked nothing fails, too: it would pass whatever is drawn.
"""

from __future__ import annotations

from collections.abc import Generator

import pytest

from playground.verify.shots.plugin_constants import FIXTURE, UNCHECKED

_NOTHING_CHECKED = (
    "this test takes `shot` and checks nothing: expected shot.check(…) or shot.animation(…); "
    "a test without a reference draws with playground.render"
)
_CHECKS: pytest.StashKey[bool] = pytest.StashKey()  # whether there was one; there once a test has the fixture
_ENDED_WELL: pytest.StashKey[bool] = pytest.StashKey()
_FAILURES: pytest.StashKey[list[str]] = pytest.StashKey()


def add_failure(node: pytest.Item, message: str) -> None:
    """Record that a picture of a test failed."""
    node.stash.setdefault(_FAILURES, []).append(message)


def expect_check(node: pytest.Item) -> None:
    """Begin a test that is to check something."""
    node.stash[_CHECKS] = False


def add_check(node: pytest.Item) -> None:
    """Record that a test has checked something."""
    node.stash[_CHECKS] = True


def fail_for_what_is_left(node: pytest.Item) -> None:
    """Fail now for the pictures that no one has been told of, or for none where the test ended well."""
    message = _told(node)
    if not message and node.stash.get(_ENDED_WELL, False) and not node.stash[_CHECKS]:
        message = _NOTHING_CHECKED
    if message:
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
    if not item.stash.get(_CHECKS, True) and not _may_be_checked_later(item):
        item.user_properties.append((UNCHECKED, ""))
        pytest.fail(_NOTHING_CHECKED, pytrace=False)
    item.stash[_ENDED_WELL] = True


def _may_be_checked_later(item: pytest.Item) -> bool:
    """Return whether another fixture of a test takes ``shot``: its clean-up may check a picture."""
    fixtures = getattr(item, "_fixtureinfo", None)
    definitions = fixtures.name2fixturedefs if fixtures is not None else {}
    return any(FIXTURE in each.argnames for several in definitions.values() for each in several)


def _told(node: pytest.Item) -> str:
    """Return the failures of a test, which are then told; "" for none."""
    failures = node.stash.get(_FAILURES, [])
    node.stash[_FAILURES] = []
    return "\n\n".join([f"{len(failures)} pictures of this test fail:", *failures][len(failures) < 2 :])
