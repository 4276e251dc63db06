"""Make what a student edits: a sketch that begins as an exercise does, and its kernel in the same folder.

The sketch is the shipped one with the exercise's values and camera, without its shots and presets. Where
the student writes a kernel, the techniques around it are in the folder too, each naming the next; what the
student leaves alone is used from ``glsl/``.
"""

from __future__ import annotations

import re
import tempfile
from dataclasses import replace
from pathlib import Path

from playground.errors import DataError, PlaygroundError, SketchError
from playground.images.files import reason
from playground.lessons.handout.exercise_files import Assignment
from playground.lessons.tasks.texts import path_of, starter_text
from playground.paths import GLSL, SKETCHES
from playground.sketch.load import load
from playground.sketch.model import Graph, Sketch, Technique
from playground.sketch.save import save, save_copy
from playground.sketch.source import read_text
from playground.sketch.toml_edit import put, text_of
from playground.sketch.toml_places import Place

_HEADER = re.compile(r"^\s*\[\[?\s*([A-Za-z_-]+)")
_LEFT_OUT = ("shot", "preset", "keyframe")
_INCLUDE = re.compile(r'^(\s*#\s*include\s+")([^"]+)(")', re.MULTILINE)
_NOT_IN_A_NAME = re.compile(r"[^A-Za-z0-9_]")


def student_files(one: Assignment) -> dict[str, bytes]:
    """Return the files of an exercise's folder by their names in it.

    Raises ``PlaygroundError`` where no such sketch can be made.
    """
    scene = one.exercise.begin
    assert scene is not None
    with tempfile.TemporaryDirectory(prefix="handout-") as scratch:
        try:
            shipped = load(SKETCHES / f"{scene.sketch.name}.toml")
            first = save_copy(shipped, shipped, Path(scratch))
            text = _without_moments(_read(first), one)
            first.unlink()
            path = first.with_name(one.sketch_file)
            path.write_text(text, encoding="utf-8", newline="\n")
            if one.exercise.file:
                _put_kernel(one, path)
            sketch = load(path)
            save(sketch, _as_begun(sketch, scene.sketch))
            load(path)
            return {
                file.relative_to(path.parent).as_posix(): file.read_bytes()
                for file in sorted(path.parent.rglob("*"))
                if file.is_file()
            }
        except OSError as error:
            raise DataError(f"{one.name}: no folder could be made for it: {reason(error)}") from None


def _read(path: Path) -> str:
    return read_text(path)


def _without_moments(text: str, one: Assignment) -> str:
    """Return a sketch's text without its shots, presets and keyframes, under a heading of its own."""
    kept: list[str] = []
    waiting: list[str] = []  # comments and blank lines, which belong to the table after them
    inside = False
    for line in text.split("\n"):
        if not line.strip() or line.lstrip().startswith("#"):
            waiting.append(line)
            continue
        header = _HEADER.match(line)
        if header:
            inside = header[1] in _LEFT_OUT
        if not inside:
            kept += [*waiting, line]
        waiting = []
    while kept and (not kept[0].strip() or kept[0].lstrip().startswith("#")):
        kept.pop(0)  # what the shipped sketch says of itself
    title = f"{one.lesson.title}, {one.number}"
    whole = "\n".join([f"# {title}", *kept]).rstrip() + "\n"
    return put(whole, (), "title", text_of(title))


def _as_begun(sketch: Sketch, begin: Sketch) -> Sketch:
    """Return a student's sketch with the values, the view and the camera that the exercise begins with."""
    found = sketch
    if (view := begin.graph.find("view")) != sketch.graph.find("view") and view is not None:
        passes = tuple(view if spec.name == "view" else spec for spec in sketch.graph.passes)
        found = replace(found, graph=replace(sketch.graph, passes=passes))
    for path, value in begin.overrides:
        try:
            found = found.with_values({path: value})
        except PlaygroundError:
            continue  # of the model answer's kernel, not of what the student begins with
    return found.with_camera(begin.camera)


def _put_kernel(one: Assignment, sketch_file: Path) -> None:
    """Write the starter into the folder and have the sketch use it, through the techniques around it."""
    folder, kernel = sketch_file.parent, path_of(one.exercise)
    starter = _includes_from_library(starter_text(one.exercise), kernel)
    (folder / f"{one.name}.glsl").write_text(starter, encoding="utf-8", newline="\n")
    sketch = load(sketch_file)
    text = _read(sketch_file)
    for place, use in _replaced_uses(sketch.graph, kernel, one.name, folder):
        text = put(text, place, "use", text_of(use))
    sketch_file.write_text(text, encoding="utf-8", newline="\n")


def _replaced_uses(graph: Graph, kernel: Path, name: str, folder: Path) -> list[tuple[Place, str]]:
    """Return what each pass that leads to a kernel must use instead, with its place in the graph's TOML.

    Techniques of several passes on the way are written into the folder, with their own uses replaced.
    """
    found: list[tuple[Place, str]] = []
    number = 0
    for spec in graph.passes:
        place: Place = (
            ("view",) if spec.name == "view" and Path(graph.path).parent == folder else ("pass", number)
        )
        number += place != ("view",)
        if not _leads_to(spec.technique, kernel):
            continue
        if isinstance(spec.technique, Graph):
            found.append((place, f"./{_own_technique(spec.technique, kernel, name, folder)}"))
        else:
            found.append((place, f"./{name}"))
    if not found:
        raise SketchError(f"{name}: no pass uses {kernel.name}")
    return found


def _own_technique(technique: Graph, kernel: Path, name: str, folder: Path) -> str:
    """Write a technique of several passes into the folder, using the student's kernel; return its name."""
    source = Path(technique.path)
    own = f"{name}-{_NOT_IN_A_NAME.sub('_', source.stem)}"
    target = folder / f"{own}.toml"
    text = _read(source)
    replaced = dict(_replaced_uses(technique, kernel, name, folder))
    for number, spec in enumerate(technique.passes):
        place: Place = ("pass", number)
        use = replaced.get(place) or _from_library(spec.use, source)
        if use != spec.use:
            text = put(text, place, "use", text_of(use))
    target.write_text(text, encoding="utf-8", newline="\n")
    return own


def _from_library(use: str, source: Path) -> str:
    """Return a technique as any folder may name it; ``./x`` is next to the file that uses it."""
    if not use.startswith("./"):
        return use
    return (source.parent / use[2:]).resolve().relative_to(GLSL.resolve()).as_posix()


def _leads_to(technique: Technique, kernel: Path) -> bool:
    if isinstance(technique, Graph):
        return any(_leads_to(spec.technique, kernel) for spec in technique.passes)
    return Path(technique.path).resolve() == kernel


def _includes_from_library(text: str, kernel: Path) -> str:
    """Return a starter whose includes are named from ``glsl/``, where they were next to the kernel."""

    def named(match: re.Match[str]) -> str:
        file = (kernel.parent / match[2]).resolve()
        if not file.is_file() or not file.is_relative_to(GLSL.resolve()):
            return match[0]
        return f"{match[1]}{file.relative_to(GLSL.resolve()).as_posix()}{match[3]}"

    return _INCLUDE.sub(named, text)
