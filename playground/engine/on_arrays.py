"""Run a technique on arrays instead of on a sketch's passes: for Python users, and tools that work on arrays.

The arrays become textures of passes that never run, each under a number of its own, so that no texture
computed of other arrays is taken for one of these. What depends on them leaves the cache afterwards;
programs, spare textures and the plan stay, so that the next run of the same shape costs little.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.engine.cache_keys import Keys
from playground.engine.plan import LoopStep, Plan, every_version, sources_of, walk
from playground.engine.plan_warnings import PlanWarnings
from playground.engine.results import Cached
from playground.engine.textures import read_texture, write_texture
from playground.engine.unfinished import SourceWorks
from playground.errors import ParameterError, nearest
from playground.paths import GLSL, shown
from playground.shader.own_shaders import own_shader
from playground.shader.source import Line, SourceText
from playground.sketch.flat import Ref
from playground.sketch.model import (
    Graph,
    Input,
    Kernel,
    Output,
    Parameter,
    PassSpec,
    Sketch,
    Technique,
    TexelKernel,
)
from playground.sketch.techniques import read_technique
from playground.sketch.wiring import initial_names, input_names, is_optional, output_names

if TYPE_CHECKING:
    from playground.engine.engine import Engine

_NUMBER = "number"
_TEXT = "float kernel(ivec2 texel) { return float(number + number); }"
_FORMATS = {1: "r32f", 2: "rg32f", 4: "rgba32f"}
_numbers = count(1)  # of arrays, in this process
_Shape = tuple[int, ...]


class OnArrays:
    """Runs one technique on arrays, by one engine.

    ``use`` is the technique, or its name as a pass of a sketch has it, of the library. Raises
    ``SketchError`` where there is none.
    """

    def __init__(self, engine: Engine, use: Technique | str) -> None:
        self.engine = engine
        self.technique = read_technique(use, GLSL, GLSL) if isinstance(use, str) else use
        self.name = free_name("technique", self.technique)
        self._sketches: dict[tuple[tuple[str, _Shape], ...], Sketch] = {}

    def run(
        self,
        arrays: Mapping[str, NDArray[np.float32]],
        *,
        spacing: tuple[float, float],
        relief: float,
        base_elevation: float = 0.0,
        values: Mapping[str, object] | None = None,
        steps: Mapping[str, int] | None = None,
        outputs: tuple[str, ...] = (),
        time: float = 0.0,
    ) -> dict[str, NDArray[np.float32]]:
        """Return the technique's outputs, or some of them, float32, (ny, nx) or (ny, nx, components).

        ``arrays`` are its inputs, of such shapes, row 0 in the south; the first one's is the terrain's, with
        ``spacing`` [m] from texel to texel along x and y and ``relief`` [m] from height 0 to 1. ``values``
        sets its parameters, by path inside it; ``steps`` stops its repeats early, "" being its own. What
        the engine drew last stays its last frame. Raises ``PlaygroundError`` for any mistake.
        """
        inputs = {name: np.ascontiguousarray(array, np.float32) for name, array in arrays.items()}
        names = outputs or output_names(self.technique)
        self._check(inputs, names)
        sketch = self._sketch(inputs)
        ny, nx = next(iter(inputs.values())).shape[:2] if inputs else (1, 1)
        numbers = {f"{name}.{_NUMBER}": next(_numbers) for name in inputs}
        sketch = sketch.with_values(
            {
                "size": (nx, ny),
                "extent": (spacing[0] * max(nx - 1, 1), spacing[1] * max(ny - 1, 1)),
                "relief": relief,
                "base_elevation": base_elevation,
                **numbers,
                **{f"{self.name}.{path}": value for path, value in (values or {}).items()},
            }
        )
        stops = {f"{self.name}.{path}".rstrip("."): number for path, number in (steps or {}).items()}
        arrays_out: dict[str, NDArray[np.float32]] = {}
        with self._apart():
            plan = self.engine.plan(sketch, (nx, ny), time, stops, interpolated=False)
            keys = self.engine.keys_of(plan)
            try:
                for name, array in inputs.items():
                    self._put(plan, keys.result(name), name, array)
                for output in names:
                    ref = plan.flat.ref(f"{self.name}:{output}", sketch.name)
                    arrays_out[output] = read_texture(self.engine.texture_of(plan, ref))
            finally:
                self._forget(plan, keys, set(inputs))
        return arrays_out

    def _check(self, inputs: Mapping[str, NDArray[np.float32]], outputs: tuple[str, ...]) -> None:
        technique = self.technique
        expected = list(input_names(technique))
        if isinstance(technique, Kernel):
            expected += [name for name in initial_names(technique) if name not in expected]
        for name, array in inputs.items():
            if name not in expected:
                raise ParameterError(f"{technique.name} has no input '{name}'{nearest(name, expected)}")
            if 0 in array.shape or array.ndim not in (2, 3) or _channels(array.shape) not in _FORMATS:
                message = f"an array of shape {array.shape}; (ny, nx) or (ny, nx, 1, 2 or 4) was expected"
                raise ParameterError(f"{name}: {message}")
        for name in expected:
            if name not in inputs and not is_optional(technique, name):
                raise ParameterError(f"{technique.name} needs an array for its input '{name}'")
        for name in outputs:
            if name not in output_names(technique):
                hint = nearest(name, output_names(technique))
                raise ParameterError(f"{technique.name} has no output '{name}'{hint}")

    def _sketch(self, inputs: Mapping[str, NDArray[np.float32]]) -> Sketch:
        """Return the sketch for arrays of some shapes: the same object for the same."""
        key = tuple((name, array.shape) for name, array in inputs.items())
        if key not in self._sketches:
            passes = [_array_pass(name, array.shape) for name, array in inputs.items()]
            folder = Path(self.technique.path).parent
            self._sketches[key] = shown_alone(self.technique, self.name, passes, folder)
        return self._sketches[key]

    @contextmanager
    def _apart(self) -> Iterator[None]:
        """Leave the engine's last frame, counts and sources at work as they are, and its disk cache alone.

        All is waited for, whatever the engine's patience.
        """
        engine, runner, options = self.engine, self.engine.runner, self.engine.options
        works, patience, runner.works, options.patience = runner.works, options.patience, SourceWorks(), None
        record, runs, disk, warnings = engine.record, engine.runs.copy(), engine.disk_caching, engine.warnings
        engine.disk_caching, engine.warnings = None, PlanWarnings()
        try:
            yield
        finally:
            runner.works, options.patience = works, patience
            engine.record, engine.disk_caching, engine.warnings = record, disk, warnings
            engine.runs.clear()
            engine.runs.update(runs)

    def _put(self, plan: Plan, key: str, name: str, array: NDArray[np.float32]) -> None:
        """Put an array in the cache as what its pass computed."""
        step = plan.step(name)
        assert step is not None
        with self.engine.borrowed():
            result = self.engine.runner.pool.take(step.size, step.kernel.outputs)
            write_texture(result.textures[name], array)
        self.engine.cache.put(key, Cached({name: result}))

    def _forget(self, plan: Plan, keys: Keys, changed: set[str]) -> None:
        """Drop what was computed of the arrays; ``changed`` are their passes."""
        cache = self.engine.cache
        for node in plan.nodes:
            read = {source.path for source in sources_of(node) if isinstance(source, Ref)}
            if node.path not in changed and not read & changed:
                continue
            changed |= {step.path for step in walk((node,))}
            for inside in every_version((node,)):
                if isinstance(inside, LoopStep):
                    cache.drop(keys.loops[inside.path])
                else:
                    cache.drop(keys.computed(inside.path))
                    cache.drop(keys.result(inside.path))


def _array_pass(name: str, shape: _Shape) -> PassSpec:
    """Return the pass that stands for an array: a kernel that never runs."""
    kernel = TexelKernel(
        name="an array",
        source=text_of(_TEXT),
        outputs=(Output(name, _FORMATS[_channels(shape)]),),
        parameters=(Parameter(_NUMBER, "uint", 0),),
    )
    return PassSpec(name, "an array", kernel, size=(str(shape[1]), str(shape[0])))


def _channels(shape: _Shape) -> int:
    return shape[2] if len(shape) == 3 else 1


def shown_alone(
    technique: Technique, subject: str, passes: Iterable[PassSpec], folder: Path, line: int = 0
) -> Sketch:
    """Return a sketch of some passes and one, named ``subject``, of a technique, which it shows.

    ``folder`` is where its files are, ``line`` that of the technique's file that errors name.
    """
    own = PassSpec(subject, subject, technique, file=shown(technique.path), line=line)
    view = PassSpec("view", "a copy", _COPY, inputs=(("shown", subject),))
    graph = Graph(subject, technique.path, (*passes, own, view))
    return Sketch(Path(technique.path).stem, technique.path, str(folder), graph)


def free_name(name: str, technique: Technique) -> str:
    """Return a name for the pass of a technique that none of its inputs has."""
    taken = {declared.name for declared in technique.inputs} | {"view"}
    while name in taken:
        name += "_"
    return name


def text_of(code: str) -> SourceText:
    """Return code that is in no file as a kernel's text."""
    lines = code.strip().split("\n")
    return SourceText("", tuple(Line(line, line, "", "", number) for number, line in enumerate(lines, 1)))


_COPY = TexelKernel(
    name="a copy",
    source=text_of(own_shader("placeholder_view.glsl")),
    outputs=(Output("frame", "rgba16f"),),
    inputs=(Input("shown"),),
)
