"""Describe the tasks of a lesson that a browser can check: see ``PageCheck`` in work_check.js.

A page has the answers in its data, and the values that a reader is not shown: it is for practice. What
counts is judged by ``tasks.judge``, where no student can look.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from playground.course import model
from playground.course.book.live_scenes import Library, Scenes
from playground.course.scenes import spelled_at
from playground.course.tasks.work import answer_text, path_of, starter_text, wanted_scene
from playground.errors import PlaygroundError
from playground.shader.source import read_text
from playground.sketch.flatten import flatten

LiveData = dict[str, Any]

_ROWS = 6
"""Parameters of a kernel that a reader may drag while writing it, at most."""


def task_data(task: model.Exercise | model.Challenge, scenes: Scenes) -> LiveData | None:
    """Return a task for a page: its answer, where one begins, what is checked; None where no page can.

    Raises ``PlaygroundError`` as ``Scenes.setting`` does.
    """
    assert task.scene is not None and task.begin is not None
    with _shipped(task, scenes.library):
        solution, begin = scenes.setting(task.scene), scenes.setting(task.begin)
        if begin["sketch"] != solution["sketch"] or "data" in {**begin, **solution}:
            return None
        data: LiveData = {"scenes": [solution], "begin": begin, "rows": _rows(task, scenes, solution)}
        if task.file:
            data |= {"file": task.file, "starter": starter_text(task), "answer": answer_text(task)}
        if isinstance(task, model.Challenge):
            return data | {"kind": "challenge", "goal": task.goal}
        checks = [_check(task, check, scenes, solution) for check in task.checks]
    held = [check for check in checks if check]
    return data | {"kind": "exercise", "checks": held, "elsewhere": len(checks) - len(held)}


@contextmanager
def _shipped(task: model.Task, library: Library) -> Iterator[None]:
    """Let a task's kernel have the answer's text within; for all other pages it is that of its file."""
    try:
        yield
    finally:
        if task.file:
            texts, path = library.shared.texts, path_of(task)
            texts.files[texts.name_of(path)] = read_text(path)


def _rows(task: model.Task, scenes: Scenes, solution: dict[str, Any]) -> list[str]:
    if task.sliders or not task.file:
        return list(task.sliders)
    assert task.scene is not None
    path = str(path_of(task))
    nodes = {leaf.path for leaf in flatten(task.scene.sketch).leaves if path in leaf.kernel.files}
    shown = scenes.sketches[solution["sketch"]]["shown"]
    return [row["path"] for row in shown if row["pass"] in {node.partition(".")[0] for node in nodes}][:_ROWS]


def _check(
    task: model.Exercise, check: model.Check, scenes: Scenes, solution: dict[str, Any]
) -> LiveData | None:
    """Return a check; None for one that no page can do: a measure, another size, what a source makes."""
    if check.measure is not None:
        return None
    try:
        setting = scenes.setting(wanted_scene(task, check.at))
    except PlaygroundError:
        return None
    unlike = ("sketch", "terrain", "data")
    if any(setting.get(key) != solution.get(key) for key in unlike):
        return None
    assert task.scene is not None
    at: dict[str, Any] = {}
    values = {**scenes.sketches[setting["sketch"]]["values"], **setting.get("values", {})}
    for path, _ in check.at:
        row = scenes.row(setting, path)
        for leaf in row["targets"] if row else [path]:
            at[leaf] = values[leaf]
    said = [[path, spelled_at(task.scene, path, value)] for path, value in check.at]
    data: LiveData = {"hidden": check.hidden, "tolerance": check.tolerance, "at": at}
    data["said"] = [] if check.hidden else said
    if check.of:
        ref = flatten(task.scene.sketch).ref(check.of, task.scene.sketch.name)
        data["of"] = {"path": ref.path, "output": ref.output, "name": check.of}
    return data
