"""Write a hand-out as a zip: a page, a README, and for each exercise a folder that the window opens.

    week3/README.txt             what to do, and what to hand in
    week3/exercises.html         the exercises, without answers
    week3/LESSON-EXERCISE/       what the student edits: see ``student_sketch``
    week3/….whl                  the playground itself, if a wheel is given
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
from playground.course.handout.exercise_files import Assignment, assignments_of
from playground.course.handout.labels import handout_labels
from playground.course.handout.page import handout_page
from playground.course.handout.student_sketch import student_files
from playground.course.measuring import numbers_of
from playground.course.model import Lesson, Task
from playground.engine.engine import Engine
from playground.errors import DataError, SketchError
from playground.extras import DISTRIBUTION
from playground.files import checked_file, reading, replacing
from playground.sketch.find import FORMAT, MANIFEST

_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip can say
_PLAIN_FILE = 0o100644 << 16
_UNIX = 3
_WHEEL_NAME = DISTRIBUTION.replace("-", "_")
_WHEEL = re.compile(rf"{_WHEEL_NAME}-[^-]+(-\d[^-]*)?(-[^-]+){{3}}\.whl")
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
    install: str = "",
    wheel: Path | None = None,
    advance: Callable[[], None] = lambda: None,
) -> list[Assignment]:
    """Write the zip, whole or not at all, and return the exercises with points that are in it.

    ``install`` is how students install the playground, for their README. ``wheel`` goes into the zip.
    Raises ``SketchError`` where none of the lessons has an exercise that checks itself, ``DataError`` for
    what is no wheel of the playground, and as drawing does.
    """
    packed = {} if wheel is None else {wheel.name: read_wheel(wheel)}
    assignments = assignments_of(lessons)
    if not assignments:
        names = ", ".join(lesson.name for lesson in lessons)
        raise SketchError(f"{names}: no exercise here checks itself, so there is no file to hand in")
    top = _NOT_IN_A_NAME.sub("-", path.stem).strip("-. ") or "handout"
    numbers = {
        lesson.name: numbers_of(engine, lesson) if _names_numbers(lesson) else {} for lesson in lessons
    }
    files = {f"{top}/{name}": data for name, data in packed.items()}
    files[f"{top}/README.txt"] = _readme(lessons, assignments, install, "".join(packed)).encode()
    for assignment in assignments:
        for name, data in student_files(assignment).items():
            files[f"{top}/{assignment.name}/{name}"] = data
    page = handout_page(lessons, assignments, numbers, engine, hints=hints, advance=advance)
    files[f"{top}/exercises.html"] = page.encode()
    first = assignments[0]
    manifest = {
        "format": FORMAT,
        "sketch": f"{top}/{first.name}/{first.sketch_file}",
        "version": __version__,
        "shipped": sorted({assignment.task.file for assignment in assignments if assignment.task.file}),
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


def read_wheel(path: Path) -> bytes:
    """Return the bytes of a wheel of the playground; raise ``DataError`` for another file."""
    checked_file(path)
    if not _WHEEL.fullmatch(path.name):
        example = f"{_WHEEL_NAME}-{__version__}-py3-none-any.whl"
        raise DataError(f"is not named as a wheel of the playground, such as {example}", file=path)
    metadata = f"{'-'.join(path.name.split('-')[:2])}.dist-info/METADATA"
    with reading(path) as handle, zipfile.ZipFile(handle) as archive:
        archive.getinfo(metadata)
        handle.seek(0)
        return handle.read()


def _readme(lessons: Sequence[Lesson], assignments: Sequence[Assignment], install: str, wheel: str) -> str:
    label = handout_labels(lessons[0].language)
    lines = install.strip().splitlines()
    if not lines:
        lines = label("install_wheel", wheel=wheel).strip().splitlines() if wheel else [label("install_open")]
    elif wheel:
        lines.append(label("wheel_here", wheel=wheel))
    title = f"{label['title']}{label['colon']}{', '.join(lesson.title for lesson in lessons)}"
    return (
        label(
            "readme",
            title=title,
            install="\n".join([lines[0], *(f"   {line.strip()}".rstrip() for line in lines[1:])]),
            commands="\n".join(f"   playground live {assignment.opens}" for assignment in assignments),
            files="\n".join(f"   {assignment.name}/{assignment.file}" for assignment in assignments),
        ).strip()
        + "\n"
    )


def _entry(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name, _DATE)
    entry.create_system, entry.external_attr = _UNIX, _PLAIN_FILE
    entry.compress_type = zipfile.ZIP_DEFLATED
    return entry
