"""Make what a student edits: a sketch that begins as an exercise does, and its kernel in the same folder.

The sketch is the shipped one with the exercise's values and camera, without its shots and presets. Where
the student writes a kernel, the techniques around it are in the folder too, each naming the next; what the
student leaves alone is used from ``glsl/``.
"""

from __future__ import annotations

import re
import tempfile
import tomllib
from dataclasses import dataclass, replace
from pathlib import Path

from playground.course.handout.exercise_files import Assignment
from playground.course.tasks.work import path_of
from playground.errors import DataError, PlaygroundError
from playground.files import reason, write_file
from playground.paths import GLSL, SKETCHES
from playground.shader.header import parse_kernel
from playground.shader.source import read_source, read_text
from playground.sketch.load import load
from playground.sketch.model import Graph, Sketch, Technique
from playground.sketch.save import save, save_copy
from playground.sketch.toml_text import KeyPath, drop, put, text_of

_HEADER = re.compile(r"^\s*\[\[?\s*([A-Za-z_-]+)")
_LEFT_OUT = ("shot", "preset", "keyframe")
_INCLUDE = re.compile(r'^(\s*#\s*include\s+")([^"]+)(")', re.MULTILINE)
_NOT_IN_A_NAME = re.compile(r"[^A-Za-z0-9_]")


def student_files(assignment: Assignment) -> dict[str, bytes]:
    """Return the files of an exercise's folder by their names in it.

    Raises ``PlaygroundError`` where no such sketch can be made.
    """
    scene = assignment.task.begin
    assert scene is not None
    with tempfile.TemporaryDirectory(prefix="handout-") as scratch:
        try:
            shipped = load(SKETCHES / f"{scene.sketch.name}.toml")
            first = save_copy(shipped, shipped, Path(scratch))
            text = _without_moments(read_text(first), assignment)
            first.unlink()
            path = first.with_name(assignment.sketch_file)
            write_file(path, text)
            if assignment.task.file:
                _put_kernel(assignment, path)
            _drop_view_settings(path, scene.sketch)
            sketch = load(path)
            save(sketch, _as_begun(sketch, scene.sketch))
            load(path)
            return {
                file.relative_to(path.parent).as_posix(): file.read_bytes()
                for file in sorted(path.parent.rglob("*"))
                if file.is_file()
            }
        except OSError as error:
            raise DataError(f"{assignment.name}: no folder could be made for it: {reason(error)}") from None


def _without_moments(text: str, assignment: Assignment) -> str:
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
    title = assignment.title
    whole = "\n".join([f"# {title}", *kept]).rstrip() + "\n"
    return put(whole, (), "title", text_of(title))


def _drop_view_settings(path: Path, begin: Sketch) -> None:
    """Take out of a student's sketch what it sets of a view that the exercise does not set."""
    view, text = begin.graph.find("view"), read_text(path)
    set_there = tomllib.loads(text).get("view", {}).get("set", {})
    for key in set_there.keys() - dict(view.values if view else ()).keys():
        text = drop(text, ("view", "set"), key)
    write_file(path, text)


def _as_begun(sketch: Sketch, begin: Sketch) -> Sketch:
    """Return a student's sketch with the values, the view and the camera that the exercise begins with."""
    edited = sketch
    if (view := begin.graph.find("view")) != sketch.graph.find("view") and view is not None:
        passes = tuple(view if spec.name == "view" else spec for spec in sketch.graph.passes)
        edited = replace(edited, graph=replace(sketch.graph, passes=passes))
    for path, value in begin.overrides:
        try:
            edited = edited.with_values({path: value})
        except PlaygroundError:
            continue  # of the model answer's kernel, not of what the student begins with
    return edited.with_camera(begin.camera)


def _put_kernel(assignment: Assignment, sketch_file: Path) -> None:
    """Write the starter into the folder and have the sketch use it, through the techniques around it."""
    folder, kernel = sketch_file.parent, path_of(assignment.task)
    starter = _includes_from_library(assignment.starter, kernel)
    write_file(folder / f"{assignment.name}.glsl", starter)
    own = _OwnKernel(
        kernel, assignment.name, folder, _parameters(read_text(kernel), kernel) - _parameters(starter, kernel)
    )
    graph, text = load(sketch_file).graph, read_text(sketch_file)
    text, gone = _using(own, text, graph, of_sketch=True)
    main = tomllib.loads(text).get("main", [])
    if there := [path for path in main if path not in gone]:
        text = put(text, (), "main", f"[{', '.join(map(text_of, there))}]")
    elif main:
        text = drop(text, (), "main")
    write_file(sketch_file, text)


@dataclass(frozen=True)
class _OwnKernel:
    """A student's kernel, in the place of one that ships."""

    shipped: Path
    name: str  # of its file, and of those of the techniques around it
    folder: Path
    lacks: set[str]  # parameters of the shipped one


def _using(own: _OwnKernel, text: str, graph: Graph, *, of_sketch: bool = False) -> tuple[str, set[str]]:
    """Return a graph's TOML with the student's kernel in it, and the paths of parameters that are gone.

    Techniques of several passes on the way to the kernel are written into the folder.
    """
    gone: set[str] = set()
    number = 0
    for spec in graph.passes:
        is_view = of_sketch and spec.name == "view"
        key_path: KeyPath = ("view",) if is_view else ("pass", number)
        number += not is_view
        if not _leads_to(spec.technique, own.shipped):
            if not of_sketch and spec.use.startswith("./"):
                text = put(text, key_path, "use", text_of(_from_library(spec.use, Path(graph.path))))
            continue
        lost = own.lacks
        use = own.name
        if isinstance(spec.technique, Graph):
            use, lost = _own_technique(own, spec.technique)
        text = put(text, key_path, "use", text_of(f"./{use}"))
        for key, _ in spec.values:
            if key in lost:
                text = drop(text, (*key_path, "set"), key)
        gone |= {f"{spec.name}.{path}" for path in lost}
    return text, gone


def _own_technique(own: _OwnKernel, technique: Graph) -> tuple[str, set[str]]:
    """Write a technique of several passes, with the student's kernel; return its name and what is gone."""
    source = Path(technique.path)
    name = f"{own.name}-{_NOT_IN_A_NAME.sub('_', source.stem)}"
    text, gone = _using(own, read_text(source), technique)
    for exported, path in tomllib.loads(text).get("parameters", {}).items():
        inner = path if isinstance(path, list) else [path]
        there = [text_of(each) for each in inner if each not in gone]
        if there and len(there) < len(inner):
            text = put(text, ("parameters",), exported, f"[{', '.join(there)}]")
        elif not there:
            text = drop(text, ("parameters",), exported)
            gone.add(exported)
    write_file(own.folder / f"{name}.toml", text)
    return name, gone


def _parameters(text: str, kernel: Path) -> set[str]:
    """Return the parameters that a text in the place of a kernel declares."""
    kernel_read = parse_kernel(kernel.stem, read_source(kernel, (GLSL,), {str(kernel): text}))
    return {parameter.name for parameter in kernel_read.parameters} if kernel_read else set()


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
