"""The picture at each lesson's head: its matter in a light of its own. ``heroes.toml`` has them by lesson."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from playground.course.library import HERE, LANGUAGES
from playground.course.model import Scene
from playground.course.scenes import STATE, Sketches, read_scene
from playground.memo import INTERFACE
from playground.sketch.toml_table import TomlFile

FILE = HERE / "heroes.toml"
"""Tables by the names of lessons: the keys of a picture, and ``alt`` in each language."""

HERO = (1067, 427)
"""Pixels of a hero on a page."""


@dataclass(frozen=True)
class Hero:
    """A picture at a lesson's head."""

    scene: Scene
    alt: Mapping[str, str]  # what it shows, by language


def hero_names(path: Path = FILE) -> list[str]:
    """List the lessons that have a hero."""
    return list(_file(path).table)


def hero_of(lesson: str, sketches: Sketches | None = None, path: Path = FILE) -> Hero | None:
    """Return the hero of a lesson, None where it has none.

    Raises ``SketchError`` at what is wrong with it: a picture that cannot be, a language without its ``alt``.
    """
    file = _file(path)
    if lesson not in file.table:
        return None
    table = file.take(file.table, lesson, dict, {})
    file.only(table, (*STATE, "alt"), lesson)
    alt = file.take(table, "alt", dict, {}, lesson)
    file.only(alt, tuple(LANGUAGES), lesson, "alt")
    for code in LANGUAGES:
        if not file.take(alt, code, str, "", lesson, "alt").strip():
            raise file.error(f"a hero has an alt in '{code}'", lesson)
    state = {key: value for key, value in table.items() if key != "alt"}
    scene = read_scene(file, {"pixels": list(HERO), **state}, (lesson,), sketches or Sketches())
    return Hero(scene, alt)


@INTERFACE.cached()
def _file(path: Path) -> TomlFile:
    return TomlFile(path, path.parent)
