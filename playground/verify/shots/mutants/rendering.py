"""Mutants that the engine draws: their table, read, and a sketch broken as one says.

A mutant breaks texts, values, wiring, camera, samples. Nothing is written: edited texts are parsed in place
of the files', and what they declare takes the place of the kernels that were made of those files.
"""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError, ParameterError
from playground.memo import INTERFACE
from playground.paths import GLSL, shown
from playground.shader.expressions import follows_time
from playground.shader.reserved_names import PLAIN_UNIFORMS
from playground.shader.source import read_text
from playground.sketch.assign import resolve, value_of, values_of
from playground.sketch.model import (
    Camera,
    Graph,
    Kernel,
    PassSpec,
    Sketch,
    Technique,
    TexelKernel,
    kernels_of,
)
from playground.sketch.replace_technique import with_texts
from playground.sketch.wiring import input_names

# ── what a mutant is ─────────────────────────────────────────────────────────


Picture = NDArray[np.uint8]
"""A picture, (height, width, 4), top row first, sRGB and alpha."""


class DoesNotApply(Exception):
    """A mutant breaks something that a sketch does not have; the message says what."""


@dataclass(frozen=True)
class Edit:
    """A change of one text."""

    file: str  # in ``glsl/``, or "./x.glsl" in the sketch's folder
    find: str  # occurs there exactly once
    put: str


@dataclass(frozen=True, kw_only=True)
class SketchMutant:
    """A mutant that the engine draws: something is broken in the sketch."""

    name: str
    broke: str  # one message
    edits: tuple[Edit, ...] = ()
    values: tuple[tuple[str, object], ...] = ()  # parameter path → value
    plus: tuple[tuple[str, object], ...] = ()  # path of a parameter or "camera.…" → what is added
    times: tuple[tuple[str, float], ...] = ()  # likewise → what it is multiplied with
    wires: tuple[tuple[str, str], ...] = ()  # path of an input → the pass that it is wired to
    samples: int | None = None
    later: float = 0.0  # [s] it is drawn so much later
    steps: int = 0  # added to the iterations of what repeats
    shot: str = ""  # the shot that shows it, if the sketch has one of that name

    kind = "rendering"
    exempt = False


@dataclass(frozen=True)
class ImageMutant:
    """A mutant that is made of the finished picture: something is broken on its way out."""

    name: str
    broke: str  # one message
    change: Callable[[Picture], Picture]
    exempt: bool = False  # it is no defect: the same build must let it pass

    kind = "picture"
    later = 0.0
    shot = ""


Mutant = SketchMutant | ImageMutant


# ── the table ────────────────────────────────────────────────────────────────


TABLE = Path(__file__).with_name("rendering.toml")

_KEYS = {"name", "broke", "edit", "set", "plus", "times", "wire", "samples", "later", "steps", "shot"}


@INTERFACE.cached()
def rendering_mutants(table: Path = TABLE) -> tuple[SketchMutant, ...]:
    """Return the mutants of a table; raise ``DataError`` for a key or a name that is wrong in it."""
    with table.open("rb") as file:
        renderings = tuple(_mutant(entry, table) for entry in tomllib.load(file)["mutant"])
    names = [mutant.name for mutant in renderings]
    for name in names:
        if names.count(name) > 1:
            raise DataError(f"two mutants are called '{name}'", file=table)
    return renderings


def _mutant(entry: dict[str, Any], table: Path) -> SketchMutant:
    name = entry.get("name", "")
    if not name or not entry.get("broke", "").endswith("."):
        raise DataError(f"mutant '{name}': it needs a name, and a sentence as `broke`", file=table)
    if unknown := entry.keys() - _KEYS:
        raise DataError(f"mutant '{name}': no key '{min(unknown)}'; there are {sorted(_KEYS)}", file=table)
    mutant = SketchMutant(
        name=name,
        broke=entry["broke"],
        edits=tuple(Edit(edit["file"], edit["find"], edit["put"]) for edit in entry.get("edit", ())),
        values=tuple(entry.get("set", {}).items()),
        plus=tuple(entry.get("plus", {}).items()),
        times=tuple(entry.get("times", {}).items()),
        wires=tuple(entry.get("wire", {}).items()),
        samples=entry.get("samples"),
        later=entry.get("later", 0.0),
        steps=entry.get("steps", 0),
        shot=entry.get("shot", ""),
    )
    if mutant == SketchMutant(name=name, broke=mutant.broke, shot=mutant.shot):
        raise DataError(f"mutant '{name}' breaks nothing", file=table)
    return mutant


# ── breaking a sketch ────────────────────────────────────────────────────────


_CAMERA = "camera."


def broken(mutant: SketchMutant, sketch: Sketch) -> Sketch:
    """Return the sketch, as a shot shows it, with the mutant's defect.

    Raises ``DoesNotApply`` where the sketch lacks what it breaks, and ``DataError`` where
    a text that it edits is not there exactly once: then the mutant is out of date.
    """
    sketch = with_texts(sketch, edited_texts(mutant.edits, sketch, mutant.name))
    if mutant.later and not _reads_time(sketch.graph):
        raise DoesNotApply("nothing in the sketch changes with time")
    if mutant.steps:
        sketch = replace(sketch, graph=_with_steps(sketch.graph, mutant.steps))
    for path, source in mutant.wires:
        sketch = replace(sketch, graph=_rewired(sketch.graph, path, source, path))
    for path, factor in mutant.times:
        sketch = _changed(sketch, path, factor=factor)
    for path, more in mutant.plus:
        sketch = _changed(sketch, path, more=more)
    if mutant.values:
        try:
            sketch = sketch.with_values(dict(mutant.values))
        except ParameterError as error:
            raise DoesNotApply(str(error)) from None
    return sketch if mutant.samples is None else sketch.with_picture(samples=mutant.samples)


def edited_texts(edits: tuple[Edit, ...], sketch: Sketch, name: str) -> dict[str, str]:
    """Return the edited texts by their files' absolute paths."""
    used = {file for _, kernel in kernels_of(sketch.graph) for file in kernel.files}
    texts: dict[str, str] = {}
    for edit in edits:
        own = edit.file.startswith("./")
        path = ((Path(sketch.folder) if own else GLSL) / edit.file).resolve()
        if str(path) not in used:
            raise DoesNotApply(f"the sketch does not use {edit.file}")
        text = texts.get(str(path)) or read_text(path)
        count = text.count(edit.find)
        if count != 1:
            raise DataError(
                f"mutant '{name}': expected once, found {count} times: {edit.find.strip()}", file=shown(path)
            )
        texts[str(path)] = text.replace(edit.find, edit.put)
    return texts


def _rewired(technique: Technique, path: str, source: str, whole: str) -> Any:
    name, _, rest = path.partition(".")
    spec = technique.find(name) if isinstance(technique, Graph) else None
    if spec is None or not isinstance(technique, Graph):
        raise DoesNotApply(f"there is no input '{whole}'")
    if "." in rest:
        changed = replace(spec, technique=_rewired(spec.technique, rest, source, whole))
    elif rest not in input_names(spec.technique) or technique.find(source.partition(":")[0]) is None:
        raise DoesNotApply(f"there is no input '{whole}', or no pass '{source}'")
    else:
        changed = replace(spec, inputs=tuple((dict(spec.inputs) | {rest: source}).items()))
    passes = tuple(changed if p is spec else p for p in technique.passes)
    return replace(technique, passes=passes, complete=None)


def _reads_time(graph: Graph) -> bool:
    names = {"time", *PLAIN_UNIFORMS["time"]}
    repeats = [spec.repeat for spec in _passes(graph)]
    kernels = [kernel for _, kernel in kernels_of(graph)]
    repeats += [kernel.repeat for kernel in kernels]
    meanings = {meaning for kernel in kernels for _, meaning in kernel.usual}
    return (
        bool({"time", "frame", "frame_of_time"} & meanings)
        or any(kernel.reads(name) for kernel in kernels for name in names)
        or any(follows_time(text) for text in repeats)
    )


def _passes(graph: Graph) -> Iterator[PassSpec]:
    for spec in graph.passes:
        yield spec
        if isinstance(spec.technique, Graph):
            yield from _passes(spec.technique)


def _with_steps(graph: Graph, more: int) -> Graph:
    """Return the technique with another number of steps of all that repeats; a draw has none."""
    changed = _with_more_steps(graph, more)
    if changed == graph:
        raise DoesNotApply("nothing in the sketch repeats")
    assert isinstance(changed, Graph)
    return changed


def _with_more_steps(technique: Technique, more: int) -> Technique:
    if isinstance(technique, Kernel):
        if not isinstance(technique, TexelKernel) or technique.repeat == "1":
            return technique
        return replace(technique, repeat=f"({technique.repeat}) + {more}")
    passes = tuple(
        replace(
            spec,
            technique=_with_more_steps(spec.technique, more),
            repeat=f"({spec.repeat}) + {more}" if spec.repeat else "",
        )
        for spec in technique.passes
    )
    return technique if passes == technique.passes else replace(technique, passes=passes, complete=None)


def _changed(sketch: Sketch, path: str, factor: float = 1.0, more: object = 0.0) -> Sketch:
    """Return the sketch with a parameter, or one of the camera's numbers, times a factor and more."""
    if path.startswith(_CAMERA):
        name = path.removeprefix(_CAMERA)
        assert name in {field.name for field in fields(Camera)}
        camera: dict[str, Any] = {name: _sum(getattr(sketch.camera, name), factor, more)}
        return sketch.with_camera(replace(sketch.camera, **camera))
    try:
        parameter = resolve(sketch.graph, path)[0].parameter
    except ParameterError:
        raise DoesNotApply(f"there is no parameter '{path}'") from None
    after = _sum(value_of(sketch, path, values_of(sketch)), factor, more)
    if parameter.widget.kind == "direction" and isinstance(after, tuple):
        after = (after[0] % 360.0, *after[1:])
    try:
        return sketch.with_values({path: after})
    except ParameterError as error:
        raise DoesNotApply(str(error)) from None


def _sum(before: Any, factor: float, more: Any) -> Any:
    if not isinstance(before, tuple):
        return before * factor + more
    added = more if isinstance(more, list) else [more] * len(before)
    return tuple(number * factor + by for number, by in zip(before, added, strict=True))
