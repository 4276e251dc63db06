"""Write a hand-out as a zip: a page, a README, and for each exercise a folder that the window opens.

    week3/README.txt             what to do, and what to hand in
    week3/exercises.html         the exercises, without answers
    week3/LESSON-EXERCISE/       what the student edits: see ``student_sketch``
    pack.json                    which of them opens where the zip itself is opened

The same lessons give the same bytes, on the same renderer: names are sorted and dates fixed.
"""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Callable, Sequence
from pathlib import Path

from playground._version import __version__
from playground.engine.engine import Engine
from playground.errors import SketchError
from playground.images.files import replacing
from playground.lessons.handout.exercise_files import Assignment, assignments_of
from playground.lessons.handout.labels import handout_labels
from playground.lessons.handout.page import handout_page
from playground.lessons.handout.student_sketch import student_files
from playground.lessons.measuring import numbers_of
from playground.lessons.model import Lesson, Task
from playground.sketch.unpack import FORMAT, MANIFEST

_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip can say
_PLAIN_FILE = 0o100644 << 16
_UNIX = 3
_NOT_IN_A_NAME = re.compile(r"[^\w.-]+")


def count_tasks(lessons: Sequence[Lesson]) -> int:
    """Return how many tasks the page of these lessons has."""
    return sum(isinstance(block, Task) for lesson in lessons for block in lesson.blocks)


def write_handout(
    path: Path,
    lessons: Sequence[Lesson],
    engine: Engine,
    *,
    hints: bool = False,
    advance: Callable[[], None] = lambda: None,
) -> list[Assignment]:
    """Write the zip, whole or not at all, and return the exercises with points that are in it.

    Raises ``SketchError`` where none of the lessons has an exercise that checks itself, and as drawing does.
    """
    assignments = assignments_of(lessons)
    if not assignments:
        names = ", ".join(lesson.name for lesson in lessons)
        raise SketchError(f"{names}: no exercise here checks itself, so there is nothing to hand in")
    top = _NOT_IN_A_NAME.sub("-", path.stem).strip("-. ") or "handout"
    numbers = {
        lesson.name: numbers_of(engine, lesson) if _names_numbers(lesson) else {} for lesson in lessons
    }
    files = {f"{top}/README.txt": _readme(lessons, assignments, top).encode()}
    for one in assignments:
        for name, data in student_files(one).items():
            files[f"{top}/{one.name}/{name}"] = data
    page = handout_page(lessons, assignments, numbers, engine, hints=hints, advance=advance)
    files[f"{top}/exercises.html"] = page.encode()
    first = assignments[0]
    manifest = {
        "format": FORMAT,
        "sketch": f"{top}/{first.name}/{first.sketch_file}",
        "version": __version__,
        "shipped": sorted({one.task.file for one in assignments if one.task.file}),
    }
    files[MANIFEST] = (json.dumps(manifest, indent=1) + "\n").encode()
    with replacing(path) as handle, zipfile.ZipFile(handle, "w") as archive:
        for name in sorted(files):
            archive.writestr(_entry(name), files[name], zipfile.ZIP_DEFLATED, 9)
    return assignments


def _names_numbers(lesson: Lesson) -> bool:
    """Return whether a task's text names a measure, which then must be computed."""
    return any(
        "{{" in f"{block.ask}{block.hint}{getattr(block, 'alt', '')}"
        for block in lesson.blocks
        if isinstance(block, Task)
    )


def _readme(lessons: Sequence[Lesson], assignments: Sequence[Assignment], top: str) -> str:
    label = handout_labels(lessons[0].language)
    title = f"{label['title']}{label['colon']}{', '.join(lesson.title for lesson in lessons)}"
    return (
        label(
            "readme",
            title=title,
            commands="\n".join(f"   playground live {one.opens}" for one in assignments),
            files="\n".join(f"   {one.name}/{one.file}" for one in assignments),
        ).strip()
        + "\n"
    )


def _entry(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name, _DATE)
    entry.create_system, entry.external_attr = _UNIX, _PLAIN_FILE
    entry.compress_type = zipfile.ZIP_DEFLATED
    return entry
