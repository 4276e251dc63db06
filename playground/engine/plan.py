"""What to run for one frame: a request, and the plan that ``planner`` makes for it, its passes in order."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from numbers import Integral, Real
from pathlib import Path
from typing import NamedTuple

from playground.engine.camera import Eye
from playground.engine.lattice import Between
from playground.engine.source_kinds import Terrain
from playground.errors import DataError, ParameterError, SketchError
from playground.memo import PLANS
from playground.paths import shown
from playground.shader.expressions import counts_frames
from playground.sketch.flat import Flat, Ref, Source, leaves_of
from playground.sketch.model import MAX_SIDE, Draw, Kernel, PassSpec, Shot, Sketch, TexelKernel, Value
from playground.sketch.wiring import input_names


@dataclass(frozen=True, slots=True)
class PlanRequest:
    """What a plan is made for, besides the sketch.

    ``variants`` are the kinds of fast variants that may replace techniques, but not those around the pass
    that is ``wanted`` itself; ``steps`` stops repeated passes early, by path (that of a technique will do
    where one pass inside it repeats), and no later than they end unless their number changes with time or
    keyframes. What a stopped pass has not computed is ``interpolated`` in pictures and not in what is
    ``wanted``, unless given (see ``lattice``).
    """

    frame_size: tuple[int, int]  # [pixels] at most ``largest`` a side
    time: float = 0.0  # [s]
    variants: Collection[str] = ()
    steps: Mapping[str, int] = field(default_factory=dict)
    ref: str = ""  # a texture, ``pass[.inner…][:output]``; "" for the picture
    interpolated: bool | None = None
    largest: int = MAX_SIDE
    canonical: str = ""  # path of a leaf that no fast variant replaces, nor a technique around it
    exaggeration: float = 1.0  # how many times higher than it is the terrain is shown

    @property
    def fills(self) -> bool:
        """Whether what a stopped pass has not computed is interpolated."""
        return not self.ref if self.interpolated is None else self.interpolated

    def steps_of(self, path: str, total: int) -> int:
        """Return how many of a repeat's iterations run."""
        return min(self.steps.get(path, total), total)


class LoopIteration(NamedTuple):
    """Where a step is in the loops around it."""

    number: int = 0  # of the innermost loop's iteration, from 0
    total: int = 0  # its iterations in all; 0: the step does not change with it
    frame: int | None = None  # of the innermost loop that counts frames


@dataclass(frozen=True, slots=True)
class Window:
    """A part of a picture, counted in pixels from the whole's lower left corner."""

    origin: tuple[int, int]
    size: tuple[int, int]
    full_size: tuple[int, int]


@dataclass(frozen=True, slots=True)
class Step:
    """A leaf pass made concrete."""

    path: str
    kernel: Kernel
    values: Mapping[str, Value]  # files as absolute paths
    inputs: tuple[tuple[str, Source | None], ...]
    size: tuple[int, int]
    repeat: int  # iterations to run
    total: int  # iterations in all; more than ``repeat`` where it is stopped early
    spec: PassSpec
    window: Window | None = None  # of the picture, that its textures hold; None: they hold all
    between: Between | None = None  # how the texels that it knows are joined; None: it shows what it has

    @property
    def full_size(self) -> tuple[int, int]:
        """Texels of what its textures are a window of; their own size where they are none."""
        return self.window.full_size if self.window else self.size


@dataclass(frozen=True, slots=True)
class LoopStep:
    """A loop made concrete."""

    path: str
    repeat: int  # iterations to run
    total: int  # iterations in all
    bodies: tuple[tuple[Step | LoopStep, ...], ...]  # of each iteration; one where all are the same
    feedback: tuple[tuple[str, Source | None, Ref], ...]
    spec: PassSpec

    @property
    def body(self) -> tuple[Step | LoopStep, ...]:
        """What the last iteration runs."""
        return self.body_of(max(self.repeat - 1, 0))

    def body_of(self, iteration: int) -> tuple[Step | LoopStep, ...]:
        """Return what an iteration runs: nodes of the same paths in each, of other sizes and counts."""
        return self.bodies[iteration if len(self.bodies) > 1 else 0]

    @property
    def counts_frames(self) -> bool:
        """Whether each iteration is a frame, 1/60 s after the one before."""
        return counts_frames(self.spec.repeat)


PlanNode = Step | LoopStep


@dataclass(frozen=True, slots=True)
class PlanBasis:
    """What a plan depends on: of the same graph, it holds as long as this says the same."""

    values: Mapping[str, Mapping[str, Value]]  # of each leaf, by its path
    named: frozenset[str]  # paths of the values that a size or a count names
    by_time: bool  # one of them names the time
    pictures: Mapping[Path, tuple[int, int]]  # files whose sizes one of them names
    refusals: Mapping[str, str]  # why a fast variant does not take its size: a message, by its technique
    own: Mapping[str, tuple[int, int]]  # texels that sources have by themselves, by the path of the leaf


@dataclass(frozen=True)
class Plan:
    """What to run for one frame."""

    sketch: Sketch
    nodes: tuple[PlanNode, ...]
    flat: Flat
    terrain: Terrain  # every field known
    eye: Eye
    frame_size: tuple[int, int]
    time: float
    basis: PlanBasis = field(repr=False, compare=False)
    steps: Mapping[str, int] = field(default_factory=dict)
    interpolated: bool = False  # what stopped passes have not reached is filled
    lacking: tuple[str, ...] = ()  # a message for each technique that does without its fast variant
    exaggeration: float = 1.0  # how many times higher than it is the terrain is shown

    @property
    def shown_relief(self) -> float | None:
        """Metres from height 0 to 1 in the picture; in the data it is the terrain's."""
        relief = self.terrain.relief
        return None if relief is None else relief * self.exaggeration

    def walk(self) -> list[Step]:
        """Return every step, those inside loops included."""
        return list(_steps(self.nodes))

    @cached_property
    def picture(self) -> Ref:
        """The texture that is the picture."""
        return next(iter(self.flat.outputs["view"].values()))

    @property
    def draws(self) -> tuple[Step, ...]:
        """The steps that draw meshes, those inside loops included."""
        return _draws(self.nodes)

    @property
    def continued(self) -> frozenset[str]:
        """The paths of the draws that a later draw goes on from, with their samples and depth."""
        return _continued(self.nodes)

    def step(self, path: str) -> Step | None:
        """Return the step of that path, if there is one."""
        return next((s for s in self.walk() if s.path == path), None)

    def node(self, path: str) -> PlanNode | None:
        """Return the step or the loop of that path; the loop where it is both."""
        return next((node for node in every_node(self.nodes) if node.path == path), None)


def walk(nodes: tuple[PlanNode, ...]) -> list[Step]:
    """Return every step of some nodes, those of loops' last iterations included."""
    steps: list[Step] = []
    for node in nodes:
        if isinstance(node, LoopStep):
            steps += walk(node.body)
        else:
            steps.append(node)
    return steps


@PLANS.cached(identities=1)
def _steps(nodes: tuple[PlanNode, ...]) -> tuple[Step, ...]:
    """Return every step of a plan's nodes, worked out once for them: most frames have those of the last."""
    return tuple(walk(nodes))


@PLANS.cached(identities=1)
def _draws(nodes: tuple[PlanNode, ...]) -> tuple[Step, ...]:
    return tuple([step for step in _steps(nodes) if isinstance(step.kernel, Draw)])


@PLANS.cached(identities=1)
def _continued(nodes: tuple[PlanNode, ...]) -> frozenset[str]:
    draws = _draws(nodes)
    over = {step.path: step.kernel.over for step in draws if isinstance(step.kernel, Draw)}
    sources = [s for step in draws for name, s in step.inputs if name in ("initial", over[step.path])]
    return frozenset([source.path for source in sources if isinstance(source, Ref)])


def every_node(nodes: tuple[PlanNode, ...]) -> list[PlanNode]:
    """Return every step and loop of some nodes, a loop before what its last iteration runs."""
    result: list[PlanNode] = []
    for node in nodes:
        result.append(node)
        if isinstance(node, LoopStep):
            result += every_node(node.body)
    return result


def every_version(nodes: tuple[PlanNode, ...]) -> list[PlanNode]:
    """Return every step and loop of some nodes, of a loop those of each iteration that has its own."""
    result: list[PlanNode] = []
    for node in nodes:
        result.append(node)
        if isinstance(node, LoopStep):
            for body in {id(body): body for body in node.bodies}.values():
                result += every_version(body)
    return result


def most_iterations(nodes: tuple[PlanNode, ...]) -> dict[str, int]:
    """Return the iterations in all of every repeated kernel and loop, by path; what draws is left out.

    Of one whose number follows the iteration of a loop around it, the largest.
    """
    every = every_version(nodes)
    loops = {node.path for node in every if isinstance(node, LoopStep)}
    counts: dict[str, int] = {}
    for node in every:
        if isinstance(node, Step):
            # Of a loop of one kernel, the loop is what counts, not the kernel in it.
            if not isinstance(node.kernel, TexelKernel) or node.kernel.repeat == "1" or node.path in loops:
                continue
        counts[node.path] = max(node.total, counts.get(node.path, 0))
    return counts


@PLANS.cached(identities=1)
def needed(nodes: tuple[PlanNode, ...], ref: Ref) -> tuple[PlanNode, ...]:
    """Return the nodes that a texture depends on, in order."""
    paths = {ref.path}
    result: list[PlanNode] = []
    for node in reversed(nodes):
        inside = [node] if isinstance(node, Step) else walk(node.body)
        if not paths.isdisjoint([step.path for step in inside]):
            result.append(node)
            paths.update([source.path for source in sources_of(node) if isinstance(source, Ref)])
    return tuple(result[::-1])


def sources_of(node: PlanNode) -> list[Source]:
    """Return what a node reads, what the passes of a loop read from each other included."""
    if isinstance(node, Step):
        return [source for _, source in node.inputs if source is not None]
    sources = [first for _, first, _ in node.feedback if first is not None]
    for inside in node.body:
        sources += sources_of(inside)
    return sources


# ── checks of a caller's arguments ───────────────────────────────────────────


def checked_pixels(size: object, largest: int) -> tuple[int, int]:
    """Return width and height of a picture; raise ``ParameterError`` unless 1..``largest`` a side."""
    sides = tuple(size) if isinstance(size, Iterable) and not isinstance(size, str) else ()
    if len(sides) != 2 or not all([isinstance(n, Integral) and not isinstance(n, bool) for n in sides]):
        raise ParameterError(f"size {size!r}: expected two whole numbers, width and height in pixels")
    width, height = int(sides[0]), int(sides[1])
    if not (1 <= width <= largest and 1 <= height <= largest):
        raise ParameterError(f"a picture of {width} x {height} pixels; 1 to {largest} a side were expected")
    return width, height


def checked_seconds(time: object) -> float:
    """Return a finite number of seconds, or raise ``ParameterError``."""
    if not isinstance(time, Real) or isinstance(time, bool) or not math.isfinite(time):
        raise ParameterError(f"time {time!r}: expected a number of seconds")
    return float(time)


def checked_steps(path: str, count: object) -> int:
    """Return after how many steps a repeat stops, or raise ``ParameterError``."""
    if not isinstance(count, Integral) or isinstance(count, bool) or count < 0:
        raise ParameterError(f"steps: '{path}' stops after {count!r} steps; expected a whole number from 0")
    return int(count)


def drawn_size(sketch: Sketch, size: tuple[int, int], largest: int = MAX_SIDE) -> tuple[int, int]:
    """Return the pixels in which a picture of a size is drawn; raise ``ParameterError`` for too many.

    ``largest``: the most that a side may be drawn with.
    """
    times = sketch.picture.supersample
    width, height = checked_pixels(size, largest // times)
    return width * times, height * times


def error_at(error: DataError, sketch: Sketch, spec: PassSpec) -> DataError:
    """Return an error of a data file at the pass that names it, the file in the sentence.

    Where an override set the file, or it was opened itself, the sketch's text is right, and the error
    stays as it is.
    """
    overridden = any(
        path.partition(".")[0] == spec.name and isinstance(value, str) for path, value in sketch.overrides
    )
    if overridden or not spec.file or all(d.file == spec.file for d in error.diagnostics):
        return error
    message = "; ".join(f"{d.location}: {d.message}" if d.location else d.message for d in error.diagnostics)
    return DataError(message, file=spec.file, line=spec.line)


@contextmanager
def located_at(sketch: Sketch, shot: Shot) -> Iterator[None]:
    """Place an error in what a shot sets, as its steps, at the shot's line."""
    try:
        yield
    except ParameterError as error:
        first = error.diagnostics[0]
        if first.file or not shot.line:
            raise
        message = f"shot '{shot.name}': {first.message}"
        raise SketchError(message, file=shown(sketch.file), line=shot.line) from None


def view_input(plan: Plan, name: str) -> str:
    """Return the texture that the view takes as its input ``name``; "" if there is none.

    It is what the view is wired to, else what an unwired input of that name would take. A view
    that has no such input shows none of that name, but a pass that is named so is returned.
    """
    flat = plan.flat
    view = plan.sketch.graph.passes[-1]
    wired = flat.wires.get("view", {}).get(name)
    for leaf in leaves_of(flat.nodes):
        if leaf.path == "view":
            wired = dict(leaf.inputs).get(name, wired)
    if isinstance(wired, Ref):
        named = [
            f"{path}:{output}"
            for path, outputs in sorted(flat.outputs.items(), key=lambda item: item[0].count("."))
            for output, ref in outputs.items()
            if ref == wired
        ]
        return named[0]
    passes = [spec.name for spec in reversed(plan.sketch.graph.passes) if spec.name != "view"]
    if name in passes:
        return f"{name}:{name}" if name in flat.outputs[name] else name
    if view.name == "view" and name not in input_names(view.technique):
        return ""
    return next((f"{path}:{name}" for path in passes if name in flat.outputs[path]), "")


def view_height(plan: Plan) -> str:
    """Return the terrain's heights: those that the view shows, else the latest there are; "" without any."""
    text = view_input(plan, "height")
    passes = [spec.name for spec in reversed(plan.sketch.graph.passes) if spec.name != "view"]
    return text or next((f"{path}:height" for path in passes if "height" in plan.flat.outputs[path]), "")
