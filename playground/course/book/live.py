"""What of lessons a browser can run: sketches, scenes, blocks, tasks as data, and scripts that hold it.

The data is that of ``LiveBlock`` in book_data.js.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any

from playground.course import model
from playground.course.library import LANGUAGES, labels
from playground.course.model import Lesson, Named, Scene
from playground.course.scenes import bug_region, spelled_at
from playground.course.tasks import answer_text, path_of, starter_text, wanted_scene
from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.publish.web.blobs import packed_json
from playground.publish.web.bundle import read_bundle
from playground.publish.web.plan import sketch_data
from playground.publish.web.shared_data import SharedData
from playground.shader.source import read_text
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch

SET = ("terrain", "camera", "frame", "time", "steps")
"""What a setting has as a whole where it differs; of values, rows and texels it has those that differ."""


@dataclass
class Library:
    """What all lessons of a book share: texts, kernels, images, bytes, and who draws some of these."""

    engine: Engine | None = None  # as of ``sketch_data``
    shared: SharedData = field(default_factory=SharedData)
    kernels: list[Any] = field(default_factory=list)
    _numbers: dict[str, int] = field(default_factory=dict)  # a kernel as text → its number

    def number(self, kernel: Any) -> int:
        """Return the number of a kernel in the book."""
        text = json.dumps(kernel)
        if text not in self._numbers:
            self._numbers[text] = len(self.kernels)
            self.kernels.append(kernel)
        return self._numbers[text]

    def data(self) -> dict[str, Any]:
        """Return what every page of the book reads: see ``Shared`` in schema.js, without the blobs.

        Only shaders are among the files: a book has no version of a sketch to download.
        """
        shared = self.shared.data()
        del shared["blobs"]
        read = {kernel["file"] for kernel in self.kernels}
        read |= {stage["file"] for kernel in self.kernels for stage in stages_of(kernel) if "file" in stage}
        for name in (names := list(read)):  # it grows: what a file includes is read as well
            news = set(shared["includes"].get(name, {}).values()) - read
            read |= news
            names += sorted(news)
        for table in (shared["files"], shared["includes"]):
            for name in set(table) - read:
                del table[name]
        return {**shared, "kernels": self.kernels}


def stages_of(kernel: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the stages of a kernel, as a page has it."""
    return [kernel["vertex"], kernel["fragment"]]


@dataclass
class Scenes:
    """The sketches of one lesson."""

    library: Library
    sketches: list[dict[str, Any]] = field(default_factory=list)
    _numbers: dict[str, int] = field(default_factory=dict)  # a sketch's outline as text → its number
    _known: dict[tuple[object, ...], dict[str, Any]] = field(default_factory=dict)

    def setting(self, scene: Scene) -> dict[str, Any]:
        """Return the setting of a scene; raise ``PlaygroundError`` for what no page can run."""
        key = (scene.sketch, scene.pixels, scene.time, scene.steps)
        if key not in self._known:
            sketch = replace(scene.sketch, presets=(), shots=())  # a figure offers none
            steps = dict(scene.steps)
            at: dict[str, Any] = {"frame": scene.pixels, "time": scene.time, "steps": steps}
            data = sketch_data(sketch, self.library.shared, **at, engine=self.library.engine)
            self._known[key] = self._written(data)
        return self._known[key]

    def row(self, setting: dict[str, Any], path: str) -> dict[str, Any] | None:
        """Return the panel's row of a parameter; None where the panel has none."""
        rows = self.sketches[setting["sketch"]]["shown"]
        return next((row for row in rows if row["path"] == path), None)

    def value(self, setting: dict[str, Any], path: str) -> Any:
        """Return what a row shows in a setting."""
        row = self.row(setting, path)
        return setting.get("shown", {}).get(path, row["value"] if row else None)

    def _written(self, sketch: dict[str, Any]) -> dict[str, Any]:
        sketch["kernels"] = [self.library.number(kernel) for kernel in sketch["kernels"]]
        outline = _outline(sketch)
        if outline not in self._numbers:
            self._numbers[outline] = len(self.sketches)
            self.sketches.append(sketch)
        number = self._numbers[outline]
        base = self.sketches[number]
        data: dict[str, Any] = {"sketch": number}
        data |= {name: sketch[name] for name in SET if sketch[name] != base[name]}
        differing = {
            "values": _differing(sketch["values"], base["values"]),
            "shown": _differing(_values_of_rows(sketch), _values_of_rows(base)),
            "data": _differing(_texels(sketch["nodes"]), _texels(base["nodes"])),
        }
        return data | {name: table for name, table in differing.items() if table}


def _outline(sketch: dict[str, Any]) -> str:
    """Return what scenes of one sketch have in common, as text."""
    rows = [{name: of for name, of in row.items() if name != "value"} for row in sketch["shown"]]
    common = {name: of for name, of in sketch.items() if name not in (*SET, "values", "shown")}
    common["nodes"] = [_without_texels(node) for node in sketch["nodes"]]
    return json.dumps([common, rows, sorted(sketch["values"]), sketch["terrain"]["locked"]])


def _without_texels(node: dict[str, Any]) -> dict[str, Any]:
    return {name: of for name, of in node.items() if name != "data"}


def _texels(nodes: list[dict[str, Any]]) -> dict[str, Any]:
    """Return what sources give, by path; a source is never inside a loop."""
    return {node["path"]: node["data"] for node in nodes if "data" in node}


def _values_of_rows(sketch: dict[str, Any]) -> dict[str, Any]:
    return {row["path"]: row["value"] for row in sketch["shown"]}


def _differing(values: dict[str, Any], base: dict[str, Any]) -> dict[str, Any]:
    return {path: value for path, value in values.items() if value != base[path]}


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
        data: LiveData = {"scenes": [solution], "begin": begin, "rows": _task_rows(task, scenes, solution)}
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


def _task_rows(task: model.Task, scenes: Scenes, solution: dict[str, Any]) -> list[str]:
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
        return LIVE[type(block)](block, scenes)
    except PlaygroundError:
        return None


def _still(block: model.Named, scenes: Scenes) -> None:
    """Return nothing: the block is text, or stays the picture that it is."""


def _figure(block: model.Figure, scenes: Scenes) -> LiveData | None:
    if block.scene is None:
        return None
    return {"kind": "figure", "scenes": [scenes.setting(block.scene)], "rows": list(block.sliders)}


def _compare(block: model.Compare, scenes: Scenes) -> LiveData:
    return {"kind": "compare", "scenes": [scenes.setting(scene) for scene in block.scenes]}


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


def _break(block: model.Break, scenes: Scenes) -> LiveData | None:
    """Give the correct scene, and the lines that hold the bug."""
    if block.scene is None:
        return None
    region = bug_region(block)
    first = region.before.count("\n") + 1 if region.before else 0
    return {
        "kind": "break",
        "scenes": [scenes.setting(block.scene)],
        "file": block.file,
        "first": first,  # lines of the file before those that are shown
        "rest": region.after.count("\n") + 1 if region.after else 0,  # and after them
        "indent": len(region.indent),
        "broken": region.broken,
    }


def _exercise(block: model.Exercise, scenes: Scenes) -> LiveData | None:
    """Give what judges it; else the solution's scene and the one to begin from, unless they are the same."""
    if block.checks or block.scene is None:
        return task_data(block, scenes) if block.checks else None
    scene = block.scene
    solution = scenes.setting(scene)
    begin = scenes.setting(replace(scene, sketch=beginning(scene)))
    paths = [path for path, _ in scene.values if "." in path]
    if begin == solution or begin["sketch"] != solution["sketch"] or "data" in {**begin, **solution}:
        return None
    rows = [row["path"] for row in scenes.sketches[solution["sketch"]]["shown"] if row["main"]]
    rows = list(dict.fromkeys([*paths, *rows]))
    return {"kind": "exercise", "scenes": [solution], "begin": begin, "rows": rows}


LIVE: dict[type[model.Named], Callable[[Any, Scenes], LiveData | None]] = {
    model.Figure: _figure,
    model.Steps: _steps,
    model.Slider: _slider,
    model.Compare: _compare,
    model.Code: _still,
    model.Trace: _still,
    model.Break: _break,
    model.Question: _still,
    model.Exercise: _exercise,
    model.Challenge: task_data,
    model.Measure: _still,
}
"""What gives a page the data of each kind of block."""


def beginning(scene: model.Scene) -> Sketch:
    """Return an exercise's sketch as it is before anything is set for the solution."""
    sketch = replace(scene.sketch, overrides=())
    if scene.shot:
        sketch = sketch.for_shot(sketch.shot(scene.shot))
    return sketch.with_camera(scene.sketch.camera)


BUNDLES = {"live.js": "book.js", "live.css": "book.css"}
"""File of a book → bundle of the runtime."""

MAX_INLINE_LETTERS = 4096
"""Letters of bytes that a lesson's own script holds, so that a book has no hundred small files."""


@dataclass(frozen=True)
class LiveBook:
    """What can be run of a book."""

    blocks: dict[str, frozenset[str]]  # lesson → names of its live blocks
    files: dict[str, str]  # by path in the book's folder


def live_book(lessons: Sequence[Lesson], engine: Engine | None = None) -> LiveBook:
    """Return what can be run of some lessons; raise ``PlaygroundError`` where the runtime is not built.

    ``engine`` draws what sources are made of; see ``Library``.
    """
    library = Library(engine)
    data = {lesson.name: lesson_data(lesson, library) for lesson in lessons}
    blocks = {name: frozenset(data["blocks"]) for name, data in data.items()}
    if not any(blocks.values()):
        return LiveBook(blocks, {})
    files = {name: read_bundle(bundle) for name, bundle in BUNDLES.items()}
    files |= dict(_scripts(data, library))
    return LiveBook(blocks, files)


def widget_page(block: Named, engine: Engine | None = None) -> str:
    """Return all that a notebook's widget needs to run one block, packed; "" for one that cannot be live.

    ``engine`` draws what sources are made of; see ``Library``.
    """
    library = Library(engine)
    scenes = Scenes(library)
    data = block_data(block, scenes)
    if data is None:
        return ""
    shared = {**library.data(), "blobs": library.shared.blobs.texts}
    return packed_json({"block": data, "sketches": scenes.sketches, "library": shared})


def _scripts(data: dict[str, dict[str, Any]], library: Library) -> Iterator[tuple[str, str]]:
    say = {language: _said_in_a_page(language) for language in LANGUAGES}
    yield "glsl.js", script("glsl", packed_json({**library.data(), "say": say}))
    texts = library.shared.blobs.texts
    few = {key for key, text in texts.items() if len(text) <= MAX_INLINE_LETTERS}
    for lesson, lesson_entry in data.items():
        blobs = {key: texts[key] for key in sorted(few & blobs_in(lesson_entry, library))}
        yield f"data/{lesson}.js", script(f"data/{lesson}", packed_json({**lesson_entry, "blobs": blobs}))
    for key in texts.keys() - few:
        yield f"data/{key}.js", script(f"data/{key}", texts[key])


def _said_in_a_page(language: str) -> dict[str, str]:
    """Return what work_check.js says of works; measures are taken elsewhere."""
    return {key: text for key, text in labels("tasks", language).items() if not key.startswith("measure_")}


def blobs_in(data: Any, library: Library) -> set[str]:
    """Return the keys of the bytes that a lesson's data name, by themselves or by an image."""
    if isinstance(data, dict):
        return set().union(*(blobs_in(of, library) for of in data.values()))
    if isinstance(data, list):
        return set().union(*(blobs_in(of, library) for of in data))
    if not isinstance(data, str):
        return set()
    image = library.shared.images.data.get(data)
    return {image["blob"]} if image else {data} & library.shared.blobs.texts.keys()


def script(name: str, text: str) -> str:
    """Return a script that holds a text without a quotation mark or a backslash, for book_data.js."""
    return f'(globalThis.bookData??={{}})["{name}"]="{text}";\n'
