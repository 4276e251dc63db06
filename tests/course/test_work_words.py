"""A page of the book says of a work what the window, a notebook and a report say of it."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from playground.course.library import LANGUAGES, labels
from playground.course.model import Check
from playground.course.tasks import Wanted, compare, sentence_of

from ..publish.web.node import MISSING, Node

pytestmark = pytest.mark.skipif(bool(MISSING), reason=MISSING)


@pytest.fixture(scope="module")
def node() -> Iterator[Node]:
    with Node() as result:
        yield result


def said_in_a_page(node: Node, check: Check, outcome: dict[str, Any], language: str) -> str:
    page = {
        "hidden": check.hidden,
        "tolerance": check.tolerance,
        "said": [] if check.hidden else [[path, str(value)] for path, value in check.at],
    }
    if check.of:
        page["of"] = {"path": check.of, "output": check.of, "name": check.of}
    sentence = node.call(
        "work_check.js", "sentence", outcome, page, dict(labels("tasks", language)), language == "fr"
    )
    assert isinstance(sentence, str)
    return sentence


def both(node: Node, check: Check, mine: Any, expected: Any) -> list[tuple[str, str]]:
    """Return what Python and the page say of two textures or pictures, by language."""
    if check.of:
        result = compare(check, Wanted(texture=mine), Wanted(texture=expected))
        value = [
            {"size": mine.shape[1::-1], "channels": 1, "data": mine.ravel().astype(np.float32)}
            for mine in (mine, expected)
        ]
        outcome = node.call("work_check.js", "compareTextures", *value, {"tolerance": check.tolerance})
    else:
        result = compare(check, Wanted(picture=mine), Wanted(picture=expected))
        value = [
            {
                "size": mine.shape[1::-1],
                "data": np.dstack([mine, np.full_like(mine[..., :1], 255)])[::-1].ravel(),
            }
            for mine in (mine, expected)
        ]
        outcome = node.call("work_check.js", "comparePictures", *value, {"tolerance": check.tolerance})
    assert outcome["passed"] == result.passed
    return [
        (sentence_of(result, language).replace("`", ""), said_in_a_page(node, check, outcome, language))
        for language in LANGUAGES
    ]


PLACES = (slice(0, 8), slice(8, 16), slice(16, 24), slice(0, 24))


@pytest.mark.parametrize("rows", PLACES)
@pytest.mark.parametrize("columns", PLACES)
def test_where_and_by_how_much(node: Node, rows: slice, columns: slice):
    random = np.random.default_rng(0)
    expected = random.random((24, 25), dtype=np.float32)
    mine = expected.copy()
    mine[rows, columns] += 0.25
    texture = Check(tolerance=0.002, at=(("height.seed", 4), ("height.roughness", 0.3)), of="height")
    for python, page in both(node, texture, mine, expected):
        assert page == python
    levels = (200.0 * expected[..., None] * np.ones(3)).astype(np.uint8)
    changed = levels.copy()
    changed[rows, columns] += 40
    for hidden in (False, True):
        for python, page in both(node, Check(tolerance=0.01, hidden=hidden), changed, levels):
            assert page == python


def test_a_picture_begins_at_the_top_and_a_texture_in_the_south(node: Node):
    expected = np.zeros((24, 24), np.float32)
    mine = expected.copy()
    mine[:8, 16:] = 1.0
    ((_, said), _) = both(node, Check(tolerance=0.1, of="height"), mine, expected)
    assert "in the south-east" in said
    levels = np.zeros((24, 24, 3), np.uint8)
    changed = levels.copy()
    changed[:8, 16:] = 99
    ((_, said), _) = both(node, Check(), changed, levels)
    assert "at the upper right" in said


def test_what_is_right_or_is_no_number_or_of_another_size(node: Node):
    expected = np.linspace(0.0, 1.0, 35, dtype=np.float32).reshape(5, 7)
    check = Check(tolerance=0.002, of="height")
    broken = expected.copy()
    broken[2, 3] = np.nan
    for mine in (
        expected,
        broken,
        np.where(expected > 0.5, np.inf, expected),
        expected[:4],
        expected + 0.00301,
    ):
        for python, page in both(node, check, mine, expected):
            assert page == python


def test_what_cannot_be_drawn_is_said_as_it_is(node: Node):
    outcome = {"passed": False, "difference": 0.0, "mistake": "the kernel has no parameter 'a'."}
    said = said_in_a_page(node, Check(hidden=True), outcome, "fr")
    assert said.startswith(labels("tasks", "fr")["hidden"]) and said.endswith(
        ": the kernel has no parameter 'a'."
    )
