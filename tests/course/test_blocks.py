"""Each kind of block of a lesson is in every table by which a medium shows it: none vanishes silently."""

from __future__ import annotations

from typing import get_type_hints

from playground.course import scenes
from playground.course.book import html, live
from playground.course.fences import READERS
from playground.course.model import Named, Prose, block_classes
from playground.course.notebook import build
from playground.course.read import BLOCK_SECONDS, TASKS
from playground.course.talk import beats
from playground.course.window import panel

TABLES = {
    "book": html.WRITERS,
    "live page": live.LIVE,
    "window": panel.DRAWN,
    "notebook": build.WRITERS,
    "talk": beats.BEATS,
    "pictures": scenes.PICTURES,
}


def test_the_kinds_are_prose_and_what_fences_are_read_as() -> None:
    kinds = block_classes()
    assert len(kinds) == len(set(kinds)) == len(READERS) + 1
    assert set(kinds) == {Prose, *block_classes(Named)}
    assert {get_type_hints(read)["return"] for read in READERS.values()} == set(block_classes(Named))


def test_each_kind_of_block_is_in_each_table() -> None:
    missing = {name: set(block_classes()) - set(table) for name, table in TABLES.items()}
    missing["live page"].remove(Prose)  # it is text on every page
    assert not any(missing.values()), missing


def test_each_kind_of_block_takes_its_time() -> None:
    assert {*BLOCK_SECONDS, *TASKS} == READERS.keys()
    assert not BLOCK_SECONDS.keys() & set(TASKS)
