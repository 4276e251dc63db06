"""Make a list of shader passes of a sketch's plan, or say what of it cannot leave.

Each step of a repeat is a pass; a kernel with several outputs is a pass for each that is read, since
a pass elsewhere has one target. Sizes are told by planning the sketch for two pictures: a side that
is the picture's in both is the picture's, one that stays is a number.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from playground.engine.plan import LoopStep, Plan, PlanNode, PlanRequest, Step, needed, sources_of
from playground.engine.planner import make_plan
from playground.errors import Diagnostic, PlaygroundError, SketchError
from playground.publish.shader_export.declarations import declarations_of
from playground.shader import expressions
from playground.shader.reserved_names import GLSL_WORDS, NEUTRAL, SIZES
from playground.shader.wrap import previous_name
from playground.sketch.flat import Fed, Ref, Source
from playground.sketch.model import (
    ComputeVariant,
    CpuSource,
    Draw,
    ForeignShader,
    Input,
    Kernel,
    Output,
    PlainCompute,
    PlainFragment,
    Sketch,
    TexelKernel,
)
from playground.sketch.wiring import initial_names

PROBES = ((640, 360), (484, 272))
"""Pictures that a sketch is planned for: no side, nor a simple part of one, is another's."""

FRAMES = "frames"
MAX_PASSES = 64
CAMERA = ("clip_from_world", "world_from_clip", "eye")
_INSTEAD = "; --texture PASS exports one texture"


@dataclass(frozen=True)
class Wire:
    """What an input reads."""

    name: str = ""  # a pass; "" where nothing is wired
    is_before: bool = False  # what it gave in the frame before
    first: str = ""  # in the first frame, instead of that: a pass; "" for zeros


NOTHING = Wire()


@dataclass(frozen=True)
class ShaderPass:
    """One pass of the exported shader: it gives one texture, or the picture."""

    name: str  # an identifier that no other pass has
    step: Step
    output: Output
    size: tuple[int | None, int | None]  # None: the picture's side
    inputs: tuple[tuple[Input, Wire], ...]  # what each reads
    previous: tuple[tuple[Output, Wire], ...] = ()  # likewise of each output of the step before
    iteration: int = 0
    iterations: int = 1
    until: int = 1
    shows: str = ""  # of the picture: "", or what it shows of a texture: height, colour or numbers
    by_frames: bool = False  # it runs once a frame: its iteration is the frame's number
    copies: Wire = NOTHING  # not its kernel's: it is a copy, so that later passes read what was before

    @property
    def wires(self) -> tuple[Wire, ...]:
        """All that it reads."""
        return (*(wire for _, wire in self.inputs), *(wire for _, wire in self.previous), self.copies)


@dataclass(frozen=True)
class ExportPlan:
    """What leaves of a sketch."""

    sketch: Sketch  # with the terrain's size of the first probe where it follows the picture's
    plan: Plan
    passes: tuple[ShaderPass, ...]  # in order; the last is the picture
    follows: bool  # the terrain has the picture's size
    picture: str  # the pass that is the picture, or that the picture shows

    @property
    def is_shown(self) -> bool:
        """Whether the picture is a pass more, that shows one of another size, or one that is read."""
        last = self.passes[-1]
        read = {wire.name for pass_ in self.passes for wire in pass_.wires}
        return last.name != self.picture or last.size != (None, None) or last.name in read


def export_plan(sketch: Sketch, texture: str, kind: str, time: float) -> ExportPlan:
    """Return the passes of a sketch's picture, or of one texture shown as ``kind``.

    The terrain has the picture's size where every kernel takes any size. Raises ``SketchError`` with a
    sentence for each thing that cannot leave.
    """
    follows = True
    try:
        plans = [plan_of(sketch.with_values({"size": size}), size, time) for size in PROBES]
    except PlaygroundError:
        follows = False
        plans = [plan_of(sketch, size, time) for size in PROBES]
    ref = plans[0].flat.ref(texture, sketch.name) if texture else plans[0].picture
    made = _Passes(plans, ref, kind if texture else "")
    passes = made.all()
    if made.refused:
        raise SketchError(diagnostics=[Diagnostic(item, file=sketch.name) for item in made.refused])
    return ExportPlan(plans[0].sketch if follows else sketch, plans[0], passes, follows, made.made[ref].name)


def plan_of(sketch: Sketch, size: tuple[int, int], time: float) -> Plan:
    """Plan a sketch in its plain forms, which every fragment shader can run."""
    return make_plan(sketch, PlanRequest(frame_size=size, time=time, interpolated=False))


class _Passes:
    def __init__(self, plans: list[Plan], ref: Ref, shows: str) -> None:
        self.plan, self.other = plans
        self.ref = ref
        self.shows = shows
        self.refused: dict[str, None] = {}
        self.passes: list[ShaderPass] = []
        self.made: dict[Ref, Wire] = {}  # texture → the pass that gives it
        self.fed: dict[Fed, Wire] = {}  # what a loop feeds back → the pass that gives it
        self.nodes = needed(self.plan.nodes, ref)
        self.read_refs = set(self._read())

    def _read(self) -> Iterator[Ref]:
        yield self.ref
        for node in self.nodes:
            if isinstance(node, LoopStep):
                yield from (ref for _, _, ref in node.feedback)
            yield from (source for source in sources_of(node) if isinstance(source, Ref))

    def all(self) -> tuple[ShaderPass, ...]:
        for node in self.nodes:
            reason = self._reason(node)
            if reason:
                hint = "" if self.shows or self.refused else _INSTEAD
                self.refused[reason + hint] = None
            elif isinstance(node, Step):
                self._add(node)
            else:
                self._add_loop(node)
        if len(self.passes) > MAX_PASSES:
            self.refused[f"{len(self.passes)} passes with their steps; {MAX_PASSES} is the most"] = None
        return tuple(self.passes)

    def _reason(self, node: PlanNode) -> str:
        """Return why a node cannot leave, in a message; "" where it can."""
        who = f"pass '{node.path}'"
        if isinstance(node, LoopStep):
            if node.spec.repeat.strip() != FRAMES:
                return (
                    f"{who} repeats passes ({node.spec.repeat}), which these formats have not; once a frame"
                    f' (repeat = "{FRAMES}") would do'
                )
            if len(node.bodies) > 1:
                return f"{who} has other sizes or counts in each step, which these formats have not"
            if any(isinstance(inside, LoopStep) for inside in node.body):
                return f"{who} is a loop in a loop, which these formats have not"
            return next(filter(None, map(self._reason, node.body)), "")
        kernel = node.kernel
        twin = self.other.step(node.path)
        assert twin is not None  # the plans are of one sketch
        if isinstance(kernel, Draw):
            return f"{who} draws a mesh ({kernel.mesh}), which these formats have not"
        if isinstance(kernel, CpuSource):
            return f"{who} is a source ({kernel.registry}), which a processor computes"
        if isinstance(kernel, PlainCompute | ComputeVariant):
            return f"{who} is a compute shader, which these formats have not"
        if isinstance(kernel, PlainFragment) and (reason := reason_to_stay(kernel)):
            return f"{who} {reason}"
        camera = [name for name in CAMERA if kernel.reads(name)]
        if camera:
            return f"{who} reads the camera ({', '.join(camera)}), which these formats have not"
        if node.repeat != twin.repeat:
            return (
                f"{who} takes {node.repeat} steps for a picture of {_times(PROBES[0])}, "
                f"and {twin.repeat} for one of {_times(PROBES[1])}; they cannot be written as passes"
            )
        if node.repeat < 1:
            return f"{who} takes no step, so there is nothing to write"
        if None is (size := self._size(node)) or 0 in size:
            return (
                f"{who} has a size that depends on the picture's, {_times(node.size)} for {_times(PROBES[0])}"
            )
        return ""

    def _size(self, step: Step) -> tuple[int | None, int | None] | None:
        twin = self.other.step(step.path)
        assert twin is not None
        numbers: list[int | None] = []
        for axis in (0, 1):
            a, b = step.size[axis], twin.size[axis]
            if (a, b) == (PROBES[0][axis], PROBES[1][axis]):
                numbers.append(None)
            elif a == b:
                numbers.append(a)
            else:
                return None
        return numbers[0], numbers[1]

    def _add_loop(self, node: LoopStep) -> None:
        """Add passes that run once a frame and read what was there in the frame before.

        A buffer that is written already in this frame no longer holds that: who reads it later reads a copy.
        """
        steps = [inside for inside in node.body if isinstance(inside, Step)]
        order = [step.path for step in steps]
        for name, first, ref in node.feedback:
            source = Fed(node.path, name)
            readers = [step for step in steps if source in dict(step.inputs).values()]
            writer = next(step for step in steps if step.path == ref.path)
            output = next(o for o in writer.kernel.outputs if o.name == ref.output)
            outputs = [o for o in writer.kernel.outputs if Ref(writer.path, o.name) in self.read_refs]
            later = self._name(writer, output, "", len(outputs) > 1)
            start = self._name_of(first).name
            is_late = any(order.index(step.path) > order.index(writer.path) for step in readers)
            # Of a step with several outputs, each is a pass of its own, and the first comes first.
            is_late |= len(outputs) > 1 and outputs[-1].name != output.name and writer in readers
            handed = start and any(_hands_on(step, source) for step in readers)
            wire = Wire(later, True, start)
            if is_late or handed:
                size = self._size(writer)
                assert size is not None
                copy = self._free(writer, output, "_before", len(outputs) > 1)
                self.passes.append(ShaderPass(copy, writer, output, size, (), by_frames=True, copies=wire))
                wire = Wire(copy)
            self.fed[source] = wire
        for step in steps:
            self._add(step, by_frames=True)

    def _add(self, step: Step, *, by_frames: bool = False) -> None:
        kernel = step.kernel
        size = self._size(step)
        assert size is not None
        wired = dict(step.inputs)
        inputs = tuple((i, self._name_of(wired.get(i.name))) for i in kernel.inputs)
        starts = {output: self._name_of(wired.get(name)) for name, output in initial_names(kernel).items()}
        at_once = max(self._at_once(step), 1)
        outputs = [o for o in kernel.outputs if Ref(step.path, o.name) in self.read_refs]
        read = [o for o in kernel.outputs if kernel.reads(previous_name(kernel, o))]
        before = {o.name: starts.get(o.name, NOTHING) for o in kernel.outputs}
        iteration = 0
        while iteration < step.repeat:
            until = min(iteration + at_once, step.repeat)
            is_last = until == step.repeat
            now = {}
            for output in outputs if is_last else (read or outputs[:0]):
                name = self._free(step, output, f"_{iteration}" if not is_last else "", len(outputs) > 1)
                is_picture = is_last and Ref(step.path, output.name) == self.ref
                self.passes.append(
                    ShaderPass(
                        name,
                        step,
                        output,
                        size,
                        inputs,
                        tuple((o, before[o.name]) for o in read),
                        iteration,
                        step.total,
                        until,
                        self.shows if is_picture else "",
                        by_frames and kernel.repeat == "1",
                    )
                )
                now[output.name] = Wire(name)
                if is_last:
                    self.made[Ref(step.path, output.name)] = Wire(name)
            before |= now
            iteration = until

    def _name_of(self, source: Source | None) -> Wire:
        if isinstance(source, Fed):
            return self.fed[source]
        return self.made.get(source, NOTHING) if source is not None else NOTHING

    def _at_once(self, step: Step) -> int:
        """Return how many steps one pass may take: however they are grouped, they give the same."""
        kernel = step.kernel
        if not isinstance(kernel, TexelKernel) or kernel.at_once == "1":
            return 1
        numbers = {"size.x": step.size[0], "size.y": step.size[1]}
        numbers |= {k: v for k, v in step.values.items() if isinstance(v, int | float)}  # type: ignore[misc]
        return expressions.evaluate(kernel.at_once, numbers)

    def _free(self, step: Step, output: Output, more: str, several: bool) -> str:
        name = self._name(step, output, more, several)
        while name in GLSL_WORDS or name in [other.name for other in self.passes]:
            name += "_"
        return name

    def _name(self, step: Step, output: Output, more: str, several: bool) -> str:
        return step.path.replace(".", "_") + (f"_{output.name}" if several else "") + more


def _hands_on(step: Step, source: Source) -> bool:
    """Return whether a step does more with an input than to fetch single texels of it."""
    names = {name for name, read in step.inputs if read == source and not name.startswith("initial")}
    uses = (use for each in declarations_of(step.kernel.source.lines) for n in names for use in each.uses(n))
    return any(use.function not in ("texelFetch", "textureSize") for use in uses)


def _times(size: tuple[int, int]) -> str:
    return f"{size[0]} x {size[1]}"


# ── what shaders of other tools are given ──────────────────────────────────────


_COMPONENTS = {"float": 1, "int": 1, "uint": 1, "bool": 1}
MOUSE = ("mouse", "hover", "drag", "hover_share")


def reason_to_stay(kernel: Kernel) -> str:
    """Return what of another tool's shader cannot leave, as the end of a message; "" if all of it can."""
    name = Path(kernel.path).name
    if isinstance(kernel, ForeignShader) and (kernel.helpers or kernel.vertex_source):
        return f"is {name}, whose own tool gives it functions or a vertex shader that others have not"
    shaped = [i.name for i in kernel.inputs if i.shape or i.sampling.flip or i.sampling.decode]
    if shaped:
        return f"reads {', '.join(shaped)} in a way that these formats have not"
    if kernel.file_parameters:
        return f"reads image files as they are encoded ({', '.join(p.name for p in kernel.file_parameters)})"
    if "k_frag_data" in kernel.source.names:
        return "writes several pictures (gl_FragData)"
    odd = [name for name, meaning in kernel.usual if not _is_known(meaning)]
    return f"reads {', '.join(odd)}, which these formats have not" if odd else ""


def _is_known(meaning: str) -> bool:
    meanings = ("time", "resolution", "delta", "frame", "frame_of_time", "date", *MOUSE)
    return meaning in meanings or meaning in NEUTRAL or meaning.startswith(SIZES)


def neutral(kind: str, values: tuple[float, ...]) -> str:
    """Return constant numbers as a type has them, zeros for those that are missing."""
    if kind.startswith("mat"):
        return f"{kind}(1.0)"
    count = _COMPONENTS.get(kind) or int(kind[-1])
    numbers = [*values, 0.0, 0.0, 0.0, 0.0][:count]
    if kind in ("int", "uint", "bool"):
        return f"{kind}({int(numbers[0])})"
    listed = ", ".join(map(repr, map(float, numbers)))
    return listed if kind == "float" else f"{kind}({listed})"


def fitted(expression: str, components: int) -> Callable[[str], str]:
    """Return a function that makes of a float or a vector what a type takes of it."""

    def of(kind: str) -> str:
        count = _COMPONENTS.get(kind) or int(kind[-1])
        if components == 1:
            return expression if kind in ("float", "vec1") else f"{kind}({expression})"
        if count <= components:
            part = f"({expression}).{'xyzw'[:count]}"
        else:
            part = f"vec{count}({expression}{', 0.0' * (count - components)})"
        return part if kind == "float" or kind.startswith("vec") else f"{kind}({part})"

    return of


def given_by(size: str, time: str, frame: str, mouse: str) -> dict[str, Callable[[str], str]]:
    """Return what gives each meaning as a type, of expressions that a format has; ``mouse`` may be ""."""
    expressions = {
        "time": fitted(time, 1),
        "resolution": fitted(f"vec3(vec2({size}), 1.0)", 3),
        "delta": fitted("(1.0 / 60.0)", 1),
        "frame": fitted(f"float({frame})", 1),
        "frame_of_time": fitted(f"float({frame})", 1),
    }
    if mouse:
        expressions |= {"drag": fitted(mouse, 4), "mouse": fitted(mouse, 4), "hover": fitted(mouse, 4)}
        expressions["hover_share"] = fitted(f"({mouse}.xy / vec2({size}))", 2)
    return expressions
