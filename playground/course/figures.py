"""The thesis's figures that show a result, and the pictures at the heads of lessons: shots and captions."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from playground.course.library import HERE, LANGUAGES
from playground.course.model import Scene
from playground.course.scenes import STATE, Sketches, read_scene
from playground.memo import INTERFACE
from playground.shader.parameter import write
from playground.sketch.assign import resolve, value_of, values_of
from playground.sketch.find import shipped_sketches
from playground.sketch.model import Sketch
from playground.sketch.toml_table import TomlFile

_SHOT = re.compile(r"figure-(\d+)-(\d+)(?:-([a-z]))?")


@dataclass(frozen=True)
class FigurePicture:
    """One picture of a figure."""

    sketch: str
    shot: str
    scene: Scene
    parameters: tuple[tuple[str, str], ...]  # path → value, of all that a file sets

    @property
    def command(self) -> str:
        """The command that makes it."""
        return f"playground render {self.sketch} --shot {self.shot}"


@dataclass(frozen=True)
class ThesisFigure:
    """A figure of the thesis, and the pictures that show what it showed."""

    number: str  # "1.14"
    captions: dict[str, str]  # by language
    pictures: tuple[FigurePicture, ...]  # none for a diagram of a formula
    diagram: bool = False

    @property
    def chapter(self) -> str:
        """Its chapter."""
        return self.number.partition(".")[0]


def thesis_figures() -> list[ThesisFigure]:
    """Return every figure of the thesis, in order, with its pictures; raise as loading sketches does."""
    with (HERE / "figures.toml").open("rb") as handle:
        table = tomllib.load(handle)
    shots = _shots()
    return [
        ThesisFigure(
            number,
            {key: value for key, value in row.items() if key != "diagram"},
            tuple(drawn for _, drawn in sorted(shots.get(number, []), key=lambda pair: pair[0])),
            bool(row.get("diagram")),
        )
        for number, row in table.items()
    ]


def _shots() -> dict[str, list[tuple[str, FigurePicture]]]:
    sketches = Sketches()
    shots: dict[str, list[tuple[str, FigurePicture]]] = {}
    for name in shipped_sketches():
        sketch = sketches.load(name)
        for shot in sketch.shots:
            match = _SHOT.fullmatch(shot.name)
            if match is None:
                continue
            made = sketch.for_shot(shot)
            scene = Scene(
                made, shot.size, shot.time, shot.steps, shot.name, shot.preset, shot.values, plain=True
            )
            drawn = FigurePicture(name, shot.name, scene, _parameters(sketch, made))
            shots.setdefault(f"{match[1]}.{match[2]}", []).append((f"{match[3] or ''} {name}", drawn))
    return shots


def _parameters(file: Sketch, made: Sketch) -> tuple[tuple[str, str], ...]:
    """List what a sketch sets of its passes, and its shot over that; the view's looks aside."""
    paths = [
        f"{spec.name}.{path}" for spec in file.graph.passes if spec.name != "view" for path, _ in spec.values
    ]
    paths += [path for path, _ in made.overrides if path not in paths]
    leaves = values_of(made)
    rows = [("size", " × ".join(map(str, made.terrain.size)))] if made.terrain.size else []
    for path in paths:
        parameter = resolve(made.graph, path)[0].parameter
        rows.append((path, write(parameter, value_of(made, path, leaves))))
    return tuple(rows)


FILE = HERE / "heroes.toml"
"""Tables by the names of lessons: the keys of a picture, and ``alt`` in each language."""

HERO = (1067, 427)
"""Pixels of a hero on a page."""


@dataclass(frozen=True)
class Hero:
    """A picture at a lesson's head."""

    scene: Scene
    alt: Mapping[str, str]  # what it shows, by language


def hero_sketches(path: Path = FILE) -> dict[str, str]:
    """Return the sketch of each lesson's hero, by lesson."""
    return {lesson: str(table.get("sketch", "")) for lesson, table in _file(path).table.items()}


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
