"""Describe the blocks of a lesson that a browser can run: see ``LiveBlock`` in book_data.js."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from playground.course import model
from playground.course.book.live_scenes import Library, Scenes
from playground.course.book.live_tasks import task_data
from playground.course.excerpt import bug_region
from playground.errors import PlaygroundError
from playground.sketch.model import Sketch

LiveData = dict[str, Any]


def lesson_data(lesson: model.Lesson, library: Library) -> LiveData:
    """Return the live blocks of a lesson by name, and the sketches of their scenes.

    A block that no page can run is not among them: it stays the picture that it is.
    """
    scenes = Scenes(library)
    blocks = {}
    for block in lesson.blocks:
        if isinstance(block, model.Named) and (data := block_data(block, scenes)):
            blocks[block.name] = data
    return {"sketches": scenes.sketches, "blocks": blocks}


def block_data(block: model.Named, scenes: Scenes) -> LiveData | None:
    """Return what a block is in a page, if it can be live there."""
    try:
        return _data(block, scenes)
    except PlaygroundError:
        return None


def _data(block: model.Named, scenes: Scenes) -> LiveData | None:
    if isinstance(block, model.Figure) and block.scene:
        return {"kind": "figure", "scenes": [scenes.setting(block.scene)], "rows": list(block.sliders)}
    if isinstance(block, model.Steps):
        return _steps(block, scenes)
    if isinstance(block, model.Slider):
        return _slider(block, scenes)
    if isinstance(block, model.Compare):
        return {"kind": "compare", "scenes": [scenes.setting(scene) for scene in block.scenes]}
    if isinstance(block, model.Break) and block.scene:
        return _break(block, block.scene, scenes)
    if isinstance(block, model.Challenge) or (isinstance(block, model.Exercise) and block.checks):
        return task_data(block, scenes)
    if isinstance(block, model.Exercise) and block.scene:
        return _exercise(block.scene, scenes)
    return None


def _steps(block: model.Steps, scenes: Scenes) -> LiveData | None:
    """Stop together: any iteration between those that are shown; nothing where that changes no page."""
    setting = scenes.setting(block.scenes[-1])
    for path, picture in scenes.sketches[setting["sketch"]]["passes"].items():
        if "locked" in picture and any(f"{path}.".startswith(f"{stopped}.") for stopped in block.passes):
            return None
    return {
        "kind": "steps",
        "scenes": [setting],
        "passes": list(block.passes),
        "iterations": list(block.iterations),
    }


def _slider(block: model.Slider, scenes: Scenes) -> LiveData:
    """Sweep between the listed values, or go from one to the next where there is nothing between."""
    settings = [scenes.setting(scene) for scene in block.scenes]
    data: LiveData = {"kind": "slider", "scenes": settings}
    numbers = {setting["sketch"] for setting in settings}
    row = scenes.row(settings[0], block.parameter) if len(numbers) == 1 else None
    if row and not row["locked"] and row["type"] in _NUMBERS and row["widget"] not in ("menu", "file"):
        data |= {"row": block.parameter, "values": [scenes.value(s, block.parameter) for s in settings]}
    return data


_NUMBERS = ("int", "uint", "float", "vec2", "vec3", "vec4")
"""The types of parameters between whose values there are others."""


def _break(block: model.Break, scene: model.Scene, scenes: Scenes) -> LiveData:
    """Give the correct scene, and the lines that hold the bug."""
    region = bug_region(block)
    first = region.before.count("\n") + 1 if region.before else 0
    return {
        "kind": "break",
        "scenes": [scenes.setting(scene)],
        "file": block.file,
        "first": first,  # lines of the file before those that are shown
        "rest": region.after.count("\n") + 1 if region.after else 0,  # and after them
        "indent": len(region.indent),
        "broken": region.broken,
    }


def _exercise(scene: model.Scene, scenes: Scenes) -> LiveData | None:
    """Give the solution's scene, and the one to begin from; nothing where that is the same."""
    solution = scenes.setting(scene)
    begin = scenes.setting(replace(scene, sketch=beginning(scene)))
    paths = [path for path, _ in scene.values if "." in path]
    if begin == solution or begin["sketch"] != solution["sketch"] or "data" in {**begin, **solution}:
        return None
    rows = [row["path"] for row in scenes.sketches[solution["sketch"]]["shown"] if row["main"]]
    rows = list(dict.fromkeys([*paths, *rows]))
    return {"kind": "exercise", "scenes": [solution], "begin": begin, "rows": rows}


def beginning(scene: model.Scene) -> Sketch:
    """Return an exercise's sketch as it is before anything is set for the solution."""
    sketch = replace(scene.sketch, overrides=())
    if scene.shot:
        sketch = sketch.for_shot(sketch.shot(scene.shot))
    return sketch.with_camera(scene.sketch.camera)
