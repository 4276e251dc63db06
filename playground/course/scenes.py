"""Read the pictures of a lesson, a sketch and what a block sets of it; list them, draw them; quote shaders.

A shader is quoted by a named anchor: the lines between ``// anchor: name`` and ``// end: name``; a
deliberate bug with the lines around it.
"""

from __future__ import annotations

import re
import textwrap
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from playground.course import model
from playground.course.library import decimal
from playground.course.model import Break, Scene, Slider
from playground.errors import PlaygroundError, SketchError, nearest
from playground.memo import INTERFACE
from playground.paths import GLSL, SKETCHES
from playground.shader.parameter import spell, write
from playground.shader.source import read_text
from playground.sketch.assign import resolve
from playground.sketch.find import shipped_sketches
from playground.sketch.flat import leaves_of
from playground.sketch.flatten import flatten
from playground.sketch.load import load_with
from playground.sketch.map_sketch import Map
from playground.sketch.model import MAX_SIDE, Shot, Sketch, Value, kernels_of
from playground.sketch.replace_technique import with_texts
from playground.sketch.techniques import Techniques
from playground.sketch.toml_sketch import read_camera, read_set, read_steps
from playground.sketch.toml_table import TomlFile
from playground.sketch.toml_text import KeyPath

if TYPE_CHECKING:
    from playground.engine.engine import Engine
    from playground.engine.frame import Frame


def spelled_value(slider: Slider, value: Value, language: str) -> str:
    """Return a value of a slider's parameter: menu choices by name, numbers with their unit.

    A direction is "135°, 25°": azimuth and elevation. In French, whose numbers have a comma, a
    semicolon stands between the numbers of other vectors: "0,5 ; 2".
    """
    parameter = resolve(slider.scenes[0].sketch.graph, slider.parameter)[0].parameter
    kind = parameter.widget.kind
    text = write(parameter, value)
    if kind in ("menu", "file") or isinstance(value, str):
        return text
    degrees = kind in ("angle", "direction") or parameter.unit in ("°", "degrees")
    parts = [decimal(part, language) for part in text.split(",")]
    if degrees:
        return ", ".join(f"{part}°" for part in parts)
    joined = ("\u00a0; " if language == "fr" else ", ").join(parts)
    return f"{joined}\u202f{parameter.unit}" if parameter.unit else joined


def spelled_at(scene: Scene, path: str, value: Value) -> str:
    """Return a value of a parameter as the command line takes it."""
    if "." not in path:
        return str(value)
    return write(resolve(scene.sketch.graph, path)[0].parameter, value)


STATE = ("sketch", "shot", "preset", "set", "steps", "camera", "time", "pixels", "view", "range")
"""The keys that describe a picture."""

PICTURE = (640, 360)
"""Pixels of a picture by itself."""

FRAME = (480, 270)
"""Pixels of one picture of a series."""


@dataclass
class Sketches:
    """Sketches that have been loaded, so that a lesson reads each of its shaders once."""

    techniques: Techniques = field(default_factory=Techniques)
    loaded: dict[str, Sketch] = field(default_factory=dict)

    def load(self, name: str) -> Sketch:
        """Return a shipped sketch by name; raise as ``playground.sketch.load.load`` does."""
        if name not in self.loaded:
            self.loaded[name] = load_with(self.techniques, SKETCHES / f"{name}.toml")
        return self.loaded[name]


def read_scene(
    file: TomlFile,
    table: Mapping[str, Any],
    key_path: KeyPath,
    sketches: Sketches,
    pixels: tuple[int, int] = PICTURE,
    under: Mapping[str, Any] | None = None,
    texts: Mapping[str, str] | None = None,
) -> Scene:
    """Return the picture that a table's keys of ``STATE`` describe; its own override those of ``under``.

    ``set`` and ``steps`` of both are joined. ``texts``, by absolute path, replace those of the sketch's
    shaders, none of whose fast variants runs then. Raises ``SketchError`` at the key that is wrong.
    """
    whole = _joined(file, table, key_path, under or {})
    sketch = _sketch(file, whole, key_path, sketches)
    if texts:
        sketch = with_texts(sketch, texts).plainly()
    shot = _shot(file, whole, key_path, sketch)
    preset = file.take(whole, "preset", str, "", *key_path)
    values = read_set(file, sketch, whole, key_path, "this picture")
    steps = dict(shot.steps) | dict(read_steps(file, sketch, whole, key_path))
    for_shot = sketch.for_shot(shot)
    with located(file, *key_path, "preset" if preset else "set"):
        made = for_shot.with_preset(preset) if preset else for_shot
        made = replace(made.with_values(dict(values)), warnings=(*made.warnings, *file.warnings))
    if "camera" in whole:
        made = made.with_camera(read_camera(file, whole, for_shot.camera, key_path))
    view = file.take(whole, "view", str, "", *key_path)
    if view:
        made = _from_above(file, whole, key_path, made)
    elif "range" in whole:
        raise file.error("range: there is no view, whose lowest and highest value it is", *key_path, "range")
    scene = Scene(
        sketch=made,
        pixels=_pixels(file, whole, key_path, shot.size if shot.name else pixels),
        time=file.take(whole, "time", float, shot.time, *key_path),
        steps=tuple(steps.items()),
        shot=shot.name,
        preset=preset,
        values=values,
        view=view,
        plain=bool(shot.name) and not texts and whole.keys() <= {"sketch", "shot"},
    )
    _check_steps(file, key_path, scene)
    return scene


def _joined(
    file: TomlFile, table: Mapping[str, Any], key_path: KeyPath, under: Mapping[str, Any]
) -> dict[str, Any]:
    """Return the keys of both tables; ``set`` and ``steps`` hold those of both, the table's own first."""
    whole = dict(under) | dict(table)
    for key in ("set", "steps"):
        if key in under and key in table:
            whole[key] = file.take(under, key, dict, {}) | file.take(table, key, dict, {}, *key_path)
    return whole


@contextmanager
def located(file: TomlFile, *key_path: str | int) -> Iterator[None]:
    """Give an error inside the place of a key in a file."""
    try:
        yield
    except PlaygroundError as error:
        raise file.error(error.diagnostics[0].message, *key_path) from None


def _check_steps(file: TomlFile, key_path: KeyPath, scene: Scene) -> None:
    """Raise ``SketchError`` where a pass cannot be stopped at the iteration that is named."""
    from playground.engine.plan import PlanRequest
    from playground.engine.planner import make_plan  # it needs what is loaded by then only

    if scene.steps:
        with located(file, *key_path, "steps"):
            request = PlanRequest(frame_size=scene.pixels, time=scene.time, steps=dict(scene.steps))
            make_plan(scene.sketch, request)


BOTH = -1
"""The place of a comparison where two pictures are shown at once, with a line between them."""


def comparable(first: Scene, second: Scene) -> bool:
    """Return whether a line can part them: one sketch shows both, at one time and from one place."""
    left, other = (
        (scene.sketch.file, scene.time, scene.view, scene.sketch.camera) for scene in (first, second)
    )
    return left == other


def with_steps(scene: Scene, steps: Mapping[str, int]) -> Scene:
    """Return the picture with repeated passes stopped after so many iterations."""
    return replace(scene, steps=tuple({**dict(scene.steps), **steps}.items()), plain=False)


def with_value(scene: Scene, path: str, value: Value) -> Scene:
    """Return the picture with one more parameter set."""
    values = (*(v for v in scene.values if v[0] != path), (path, value))
    return replace(scene, sketch=scene.sketch.with_values({path: value}), values=values, plain=False)


def _sketch(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath, sketches: Sketches) -> Sketch:
    name = file.take(table, "sketch", str, "", *key_path)
    if name not in shipped_sketches():
        hint = nearest(name, shipped_sketches())
        raise file.error(
            f"sketch = {spell(name)}: a lesson shows a sketch that ships{hint}", *key_path, "sketch"
        )
    return sketches.load(name)


def _shot(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath, sketch: Sketch) -> Shot:
    name = file.take(table, "shot", str, "", *key_path)
    if not name:
        return Shot("")
    with located(file, *key_path, "shot"):
        return sketch.shot(name)


def _pixels(
    file: TomlFile, table: Mapping[str, Any], key_path: KeyPath, default: tuple[int, int]
) -> tuple[int, int]:
    pixels = file.take(table, "pixels", list, list(default), *key_path)
    if len(pixels) != 2 or not all(type(v) is int and 16 <= v <= MAX_SIDE for v in pixels):
        raise file.error(f"pixels = {spell(pixels)}: expected [width, height], from 16", *key_path, "pixels")
    return pixels[0], pixels[1]


def _range(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath) -> tuple[float, float]:
    text = file.take(table, "range", list, [0.0, 1.0], *key_path)
    if len(text) != 2 or not all(type(v) in (int, float) for v in text) or text[0] >= text[1]:
        raise file.error(f"range = {spell(text)}: expected [lowest, highest]", *key_path, "range")
    return float(text[0]), float(text[1])


def _from_above(file: TomlFile, table: Mapping[str, Any], key_path: KeyPath, sketch: Sketch) -> Sketch:
    ref = table["view"]
    flat = flatten(sketch)
    with located(file, *key_path, "view"):
        texture = flat.ref(ref, sketch.name)
    kernels = {leaf.path: leaf.kernel for leaf in leaves_of(flat.nodes)}
    output = next(o for o in kernels[texture.path].outputs if o.name == texture.output)
    lowest, highest = _range(file, table, key_path)
    shown = _map(ref).with_value("lowest", lowest).with_value("highest", highest)
    return shown.with_value("channel", 0 if output.components > 2 else 1).of(sketch)


@INTERFACE.cached()
def _map(ref: str) -> Map:
    return Map(ref)


SMALL = 3
"""How many times smaller, each way, the pictures are that tests compare."""


@dataclass(frozen=True)
class Picture:
    """One picture of a lesson."""

    name: str  # in the lesson: "land", "smoothing-3", "fault-broken"
    scene: model.Scene
    alt: str = ""

    @property
    def shot(self) -> Shot:
        """The picture as a shot of its sketch, which is set already."""
        scene = self.scene
        return Shot(self.name, scene.pixels, scene.time, steps=scene.steps)

    def smaller(self, times: int = SMALL) -> Picture:
        """Return the same picture with fewer pixels."""
        width, height = self.scene.pixels
        pixels = (max(width // times, 16), max(height // times, 16))
        return replace(self, scene=replace(self.scene, pixels=pixels))


def pictures_of(lesson: model.Lesson) -> list[Picture]:
    """List all pictures of a lesson, in its order."""
    return [picture for block in lesson.blocks for picture in pictures_in(block)]


def pictures_in(block: model.Block) -> Iterator[Picture]:
    """Yield the pictures of a block: of a series each, of a bug the correct one and the broken one."""
    yield from PICTURES[type(block)](block)


def _none(_: model.Block) -> Iterator[Picture]:
    yield from ()


def _single(block: model.Figure | model.Exercise | model.Challenge) -> Iterator[Picture]:
    if block.scene:
        yield Picture(block.name, block.scene, block.alt)


def _series(block: model.Steps | model.Slider | model.Compare) -> Iterator[Picture]:
    for index, scene in enumerate(block.scenes):
        yield Picture(f"{block.name}-{index}", scene, block.alt)


def _correct_and_broken(block: model.Break) -> Iterator[Picture]:
    if block.scene:
        yield Picture(block.name, block.scene)
        yield Picture(f"{block.name}-broken", broken(block), block.alt)


PICTURES: dict[type[model.Block], Callable[[Any], Iterator[Picture]]] = {
    model.Prose: _none,
    model.Figure: _single,
    model.Steps: _series,
    model.Slider: _series,
    model.Compare: _series,
    model.Code: _none,
    model.Trace: _none,
    model.Break: _correct_and_broken,
    model.Question: _none,
    model.Exercise: _single,
    model.Challenge: _single,
    model.Measure: _none,
}
"""What yields the pictures of each kind of block."""


def broken(block: model.Break) -> model.Scene:
    """Return the picture of a block with its bug in it.

    Raises ``SketchError`` where what the bug replaces is not there exactly once, or where
    the sketch does not use the file; ``ShaderError`` where no kernel is left.
    """
    assert block.scene is not None
    path = str((GLSL / block.file).resolve())
    sketch = block.scene.sketch
    if path not in {file for _, kernel in kernels_of(sketch.graph) for file in kernel.files}:
        raise _break_error(block, f"sketch {sketch.name} does not use {block.file}")
    return replace(block.scene, sketch=with_texts(sketch, {path: with_bug(block)}).plainly(), plain=False)


def with_bug(block: model.Break, text: str | None = None) -> str:
    """Return the text of a block's file with its bug; ``text`` replaces what is in the file."""
    text = read_text(GLSL / block.file) if text is None else text
    count = text.count(block.find)
    if not block.find or count != 1:
        raise _break_error(block, f"find: expected once in {block.file}, found {count} times")
    if block.find == block.put:
        raise _break_error(block, "find and put are the same")
    return text.replace(block.find, block.put)


def draw(engine: Engine, scene: model.Scene) -> Frame:
    """Draw a picture; raise as ``Engine.render`` does."""
    return engine.render(scene.sketch, size=scene.pixels, time=scene.time, steps=dict(scene.steps))


def _break_error(block: model.Break, message: str) -> SketchError:
    return SketchError(f"break '{block.name}': {message}", line=block.line)


_MARK = re.compile(r"^\s*//\s*(anchor|end):\s*(\S+)\s*$")


@dataclass(frozen=True, slots=True)
class Excerpt:
    """Lines of a shader."""

    file: str  # in glsl/
    line: int  # of the first of them, from 1
    text: str  # without the indentation that all have
    numbers: tuple[int, ...] = ()  # of its lines, from 1: the marks of other anchors are left out

    @property
    def lines(self) -> list[tuple[int, str]]:
        """Its lines with their numbers in the file."""
        return list(zip(self.numbers, self.text.split("\n"), strict=True))


def excerpt(file: str, anchor: str, text: str | None = None) -> Excerpt:
    """Return what an anchor marks in a file of ``glsl/``; the marks of other anchors are left out.

    ``text`` replaces what is in the file. Raises ``SketchError`` where there is no such
    anchor, or where it has no end.
    """
    excerpts = anchors(file, read_text(GLSL / file) if text is None else text)
    if anchor not in excerpts:
        hint = nearest(anchor, excerpts) or "; it has none"
        raise SketchError(f"no anchor '{anchor}'{hint}", file=GLSL / file)
    return excerpts[anchor]


def anchors(file: str, text: str) -> dict[str, Excerpt]:
    """Return what each anchor of a text marks, by name."""
    open_at: dict[str, int] = {}
    excerpts: dict[str, Excerpt] = {}
    lines = text.split("\n")
    for number, line in enumerate(lines, 1):
        mark = _MARK.match(line)
        if mark is None:
            continue
        word, name = mark.groups()
        if word == "anchor":
            if name in open_at or name in excerpts:
                raise SketchError(f"a second anchor '{name}'", file=GLSL / file, line=number)
            open_at[name] = number
        elif name not in open_at:
            raise SketchError(f"anchor '{name}' ends before it begins", file=GLSL / file, line=number)
        else:
            first = open_at.pop(name)
            inside = [n for n in range(first, number - 1) if not _MARK.match(lines[n])]
            while inside and not lines[inside[0]].strip():
                inside.pop(0)
            while inside and not lines[inside[-1]].strip():
                inside.pop()
            marked = textwrap.dedent("\n".join(lines[n].rstrip() for n in inside))
            excerpts[name] = Excerpt(file, first + 1, marked, tuple(n + 1 for n in inside))
    for name, number in open_at.items():
        raise SketchError(f"anchor '{name}' has no end", file=GLSL / file, line=number)
    return excerpts


CONTEXT = 4
"""Lines that are shown before and after those that differ."""

_MARKS = ("// anchor:", "// end:")


@dataclass(frozen=True, slots=True)
class BugRegion:
    """The lines around a bug, without the indentation that all have and the marks of anchors."""

    correct: str  # without the bug
    broken: str  # with the bug
    before: str  # the file's text above them
    after: str  # and below
    indent: str

    def with_lines(self, lines: str) -> str:
        """Return the file's text with other lines in place of these."""
        moved = [f"{self.indent}{line}" if line.strip() else "" for line in lines.strip("\n").split("\n")]
        return "\n".join(part for part in (self.before, *moved, self.after))


def bug_region(block: Break) -> BugRegion:
    """Return the lines around a bug; raise as ``with_bug``."""
    text = read_text(GLSL / block.file)
    broken = with_bug(block, text)
    lines, broken_lines = text.split("\n"), broken.split("\n")
    start = text[: text.index(block.find)].count("\n")
    first = max(start - CONTEXT, 0)
    last = min(start + block.find.count("\n") + CONTEXT, len(lines) - 1) + 1
    while first < start and not lines[first].strip():
        first += 1
    shown = lines[first:last]
    shown_broken = broken_lines[first : len(broken_lines) - (len(lines) - last)]
    common = min((len(x) - len(x.lstrip()) for x in (*shown, *shown_broken) if x.strip()), default=0)
    return BugRegion(
        correct=_dedented(shown, common),
        broken=_dedented(shown_broken, common),
        before="\n".join(lines[:first]),
        after="\n".join(lines[last:]),
        indent=" " * common,
    )


def _dedented(lines: list[str], by: int) -> str:
    text = "\n".join(line[by:] for line in lines if not line.strip().startswith(_MARKS))
    return text.rstrip()
