"""Write down a sketch so that a browser can plan and run it: see ``Sketch`` in schema.js.

The plan of the engine is written, its steps with their sizes and counts: numbers, and formulas where a page
has a control that changes them. Fast variants that need no compute shaders run, as they do in an engine of
the fragment driver.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from functools import partial
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from playground.allowed_files import is_elevation
from playground.engine.engine import Engine
from playground.engine.plan import Plan, PlanRequest, Step, view_height
from playground.engine.planner import extent_follows_size, make_plan
from playground.engine.sources import source_kind
from playground.paths import GLSL, shown
from playground.publish.web.fixed_values import FixedValues, made_by
from playground.publish.web.formulas import PassFormulas
from playground.publish.web.kernels import Kernels
from playground.publish.web.parameter_data import parameters_data, presets_data, row, rules_data, tracks_data
from playground.publish.web.shared_data import SharedData
from playground.publish.web.sources import source_data
from playground.shader.expressions import counts_frames, follows_time
from playground.shader.source import read_text
from playground.sketch.assign import Shown, values_of
from playground.sketch.files import find_file
from playground.sketch.flat import Fed, Leaf, Loop, Node, Source
from playground.sketch.load import elevation_text
from playground.sketch.map_sketch import map_kernel, refs_of
from playground.sketch.model import DEFAULT_PICTURE, CpuSource, PlainShader, Sketch, Value
from playground.sketch.traits import is_animated

FORMAT = 1
KINDS = ("passes",)
"""The kinds of fast variants that run in a page."""


def sketch_data(
    sketch: Sketch,
    shared: SharedData,
    *,
    frame: tuple[int, int] = DEFAULT_PICTURE,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    engine: Engine | None = None,
    traces: bool = False,
) -> dict[str, Any]:
    """Return a sketch as data; what several have in common goes into ``shared``.

    ``frame`` in pixels, ``time`` in seconds, ``steps`` stops repeats early, by path. ``engine``
    draws what sources are made of, and has it in its cache for the next sketch. ``traces`` adds
    the traced texts of kernels. Raises
    ``PlaygroundError`` for any mistake in the sketch, and for what no page can run; ``TypeError`` where a
    source is made of textures and there is no engine.
    """
    plan = make_plan(
        sketch, PlanRequest(frame_size=frame, time=time, variants=KINDS, steps=steps or {}, interpolated=True)
    )
    return _Writing(sketch, plan, shared, engine, traces).data()


class _Writing:
    """One sketch being written."""

    def __init__(
        self, sketch: Sketch, plan: Plan, shared: SharedData, engine: Engine | None, traces: bool
    ) -> None:
        self.sketch = sketch
        self.plan = plan
        self.flat = plan.flat
        self.shared = shared
        self.engine = engine
        self.kernels = Kernels(shared.texts, sketch.folder, traces=traces)
        self.leaves = {leaf.path: leaf for leaf in self.flat.leaves}
        self.steps = {step.path: step for step in plan.walk()}
        self.values = {path: step.values for path, step in self.steps.items()}
        self.formulas = PassFormulas(plan)
        self.fixed = FixedValues(plan)
        self.notes: list[str] = []

    def data(self) -> dict[str, Any]:
        """Return the whole sketch."""
        sketch, plan, terrain = self.sketch, self.plan, self.plan.terrain
        lacking = [sentence.partition(": see ")[0] for sentence in plan.lacking]  # files are not in a page
        nodes = [self._node(node) for node in self.flat.nodes]
        constants = values_of(sketch) | self._constants()
        values = {path: self.written(path, value) for path, value in constants.items()}
        rows = parameters_data(sketch, values, self.fixed.of_parameter)
        presets, preset_notes = presets_data(sketch, rows, self.written)
        tracks, track_notes = tracks_data(sketch, self.fixed.of_parameter, self.written)
        return {
            "format": FORMAT,
            "name": sketch.name,
            "title": sketch.title,
            "file": self._file(),
            "frame": list(plan.frame_size),
            "time": plan.time,
            "steps": dict(plan.steps),
            "samples": sketch.picture.samples,
            "aboveGround": sketch.picture.above_ground,
            "terrain": {
                "size": list(terrain.size or ()),
                "extent": list(terrain.extent or ()),
                "relief": terrain.relief,
                "base_elevation": terrain.base_elevation,
                "locked": self.fixed.of_terrain(),
                "lockedMetres": self.fixed.of_metres(),
                "extentFollows": extent_follows_size(sketch, self.flat, self.values),
            },
            "camera": asdict(sketch.camera),
            "picture": _ref(plan.picture),
            "kernels": self.kernels.data,
            "nodes": nodes,
            "passes": self._passes(),
            "named": sorted(self.formulas.named),
            "namesTime": self.formulas.names_time,
            "continued": sorted(plan.continued),
            "values": values,
            "shown": rows,
            "presets": presets,
            "tracks": tracks,
            "duration": sketch.duration,
            "moves": is_animated(sketch),
            "rules": rules_data(self.flat),
            "textures": self._textures(),
            "map": self._map(),
            "choices": [],
            "notes": [*lacking, *self.notes, *self.fixed.notes(), *preset_notes, *track_notes],
        }

    def written(self, path: str, value: Value) -> Any:
        """Return the value of a leaf parameter as a page has it: of an image file its key."""
        leaf = self.leaves.get(path.rpartition(".")[0])
        parameter = leaf.kernel.parameter(path.rpartition(".")[2]) if leaf else None
        if parameter is None or parameter.widget.kind != "file":
            return Path(value).name if isinstance(value, str) else value
        assert leaf is not None
        if isinstance(leaf.kernel, CpuSource):
            return Path(str(value)).name
        file = Path(str(self.steps[leaf.path].values[parameter.name]))
        if value != self.flat.values[path]:
            file = find_file(str(value), self.flat.folder, parameter.file, path)
        plain = isinstance(leaf.kernel, PlainShader)
        return self.shared.images.add(file, encoded=plain and not parameter.sampling.decode)

    def _constants(self) -> dict[str, Value]:
        """Return the values of fast variants' own passes that are their own."""
        shape = self.flat.shape
        return {path: value for path, value in shape.constants.items() if path not in shape.copied}

    def _file(self) -> str:
        path = Path(self.sketch.file)
        if is_elevation(path):  # as it would be saved next to the file
            text = elevation_text(path, path.name)
            return self.shared.texts.add_file(str(path.with_suffix(".toml")), text, self.sketch.folder)
        text = read_text(path, any_encoding=True)
        return self.shared.texts.add_file(self.sketch.file, text, self.sketch.folder)

    def _node(self, node: Node) -> dict[str, Any]:
        if isinstance(node, Loop):
            return {
                "path": node.path,
                "loop": True,
                "countsFrames": counts_frames(node.repeat),
                "followsTime": follows_time(node.repeat),
                "counting": node.path in self.formulas.counting,
                "body": [self._node(inside) for inside in node.body],
                "feedback": [[name, _source(first), _ref(ref)] for name, first, ref in node.feedback],
            }
        return self._leaf(node)

    def _leaf(self, leaf: Leaf) -> dict[str, Any]:
        copied = self.flat.shape.copied
        paths = {name: copied.get(path, path) for name, path in self.flat.shape.paths[leaf.path]}
        self.formulas.note_counts(leaf.kernel, paths)
        data: dict[str, Any] = {
            "path": leaf.path,
            "kernel": self.kernels.add(leaf.kernel),
            "inputs": [[name, _source(source)] for name, source in leaf.inputs],
            "values": paths,
            "size": self.formulas.size_of(leaf.path),
        }
        if isinstance(leaf.kernel, CpuSource):
            step = self.steps[leaf.path]
            made = source_data(step, made_by(leaf), self.shared.blobs, partial(self._drawn, step))
            data["inputs"] = []  # what it was made of is not drawn again
            self.notes.append(made.note)
            data["data"] = made.textures
            recording = source_kind(leaf.kernel.registry).recording
            if recording is not None:
                data["clock"] = {what: paths[name] for what, name in recording.clock.items()}
        return data

    def _drawn(self, step: Step) -> dict[str, NDArray[Any]]:
        """Return the texels of a source with inputs: a page has no other way to them."""
        if self.engine is None:
            raise TypeError(f"{step.path} is made of textures, which only an engine draws")
        plan = self.plan
        at: dict[str, Any] = {"size": plan.frame_size, "time": plan.time, "steps": plan.steps}
        outputs = [output.name for output in step.kernel.outputs]
        return {name: self.engine.read(self.sketch, f"{step.path}:{name}", **at) for name in outputs}

    def _passes(self) -> dict[str, dict[str, Any]]:
        """Return what a plan works out of every pass at every level: its size, and of a loop its repeat."""
        passes = {}
        for path, spec in self.flat.specs.items():
            data: dict[str, Any] = {"where": self._place(spec.file, spec.line)}
            if self.formulas.size_of(path) == path:
                data["size"] = self.formulas.sides(path)
            if spec.repeat:
                data["repeat"] = self.formulas.repeat(path)
            if locked := self.fixed.of_steps(path):
                data["locked"] = locked
            passes[path] = data
        return passes

    def _place(self, file: str, line: int) -> str:
        """Return where a pass is written, without where that lies on a disk."""
        path = Path(file) if Path(file).is_absolute() else None
        if path is not None and path.is_relative_to(GLSL):
            file = shown(path)
        return f"{file if path is None or path.is_relative_to(GLSL) else path.name}:{line}"

    def _textures(self) -> list[dict[str, Any]]:
        height = view_height(self.plan)
        textures = []
        for ref in refs_of(self.flat):
            path, _, output = ref.partition(":")
            label = path if path.rpartition(".")[2] == output else ref
            is_height = bool(height) and self.flat.ref(ref, "") == self.flat.ref(height, "")
            textures.append({"ref": ref, **_ref(self.flat.ref(ref, "")), "label": label, "height": is_height})
        return textures

    def _map(self) -> dict[str, Any]:
        kernel = map_kernel()
        values = {p.name: p.default for p in kernel.parameters}
        rows = [row(Shown(f"map.{p.name}", p, True), p.default, (p.name,)) for p in kernel.parameters]
        return {
            "kernel": self.kernels.add(kernel),
            "input": kernel.inputs[0].name,
            "values": values,
            "shown": rows,
            "size": self.formulas.size_of("view"),
        }


def _ref(ref: Any) -> dict[str, str]:
    return {"path": ref.path, "output": ref.output}


def _source(source: Source | None) -> dict[str, str] | None:
    if source is None:
        return None
    return {"loop": source.loop, "name": source.name} if isinstance(source, Fed) else _ref(source)
