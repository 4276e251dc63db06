"""Trace steps of an engine's frames: draw what records behind the picture, and compare its texel.

A traced shader is bound as the step's own is, with its uniforms, textures and samplers, by the fragment
driver; loops around it run again up to the iteration. Nothing that is drawn afterwards changes.

A first trace compiles: some 100 ms, and seconds for large texts where all functions are recorded. Another
texel of the same step and iteration takes 1 to 2 ms. ``Tracer.request`` is what will be compiled, for the
sandbox to try before: what a user writes may kill the driver or never end, and a text that the sandbox has
compiled compiles sooner here.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field, replace
from numbers import Integral
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from playground.engine.cache import Cache
from playground.engine.execution import FrameRecord, Search
from playground.engine.kernels import usual_of, vertices_of
from playground.engine.plan import LoopIteration, LoopStep, Plan, PlanNode, Step
from playground.engine.programs import Program
from playground.engine.results import Result, Wired
from playground.engine.runner import Runner
from playground.engine.textures import drain, floats_in, make_framebuffer, release_framebuffer, split_format
from playground.engine.trace.capture import Capture
from playground.engine.trace.html import trace_html
from playground.engine.trace.instrument import ALL, Traced, functions_of, instrument
from playground.engine.trace.model import MAX_EVENTS, Leaf, Trace, rebuild
from playground.engine.tuning import Stage
from playground.errors import ParameterError, ShaderError, SketchError, nearest
from playground.memo import GRAPHS, Memo
from playground.shader.own_shaders import TRIANGLE
from playground.shader.source import SourceText
from playground.shader.wrap import FRAGMENT, ShaderStage, Wrapped
from playground.sketch.flat import Fed, Ref
from playground.sketch.flatten import flatten
from playground.sketch.model import CpuSource, Draw, Kernel, PlainFragment, Sketch, TexelKernel

if TYPE_CHECKING:
    import moderngl

_TRACED = (TexelKernel, PlainFragment, Draw)
_RECORDING = ("rgba32ui", "rgba32ui")
"""Formats of the two outputs that record."""
_MAX_PROGRAMS = 32
_MAX_TARGETS = 6  # sizes and formats
_FIRST_SIDE = 16  # of a target whose number of events nobody knows
_MAX_SIDE = 512


@dataclass(eq=False)
class _Run:
    """One run of a step: all that its shader is bound to, ready to be run again for any texel."""

    step: Step
    inputs: Mapping[str, Wired]
    uniforms: Mapping[str, Any]
    around: LoopIteration | None
    usual: Mapping[str, tuple[float, ...]]
    iteration: tuple[int, ...]  # of the loops and the repeat
    own_iteration: int = 0  # of the step's repeat
    state: Mapping[str, moderngl.Texture] = field(default_factory=dict)  # of the iteration before
    result: Result | None = None  # what it gave in the picture; None: nothing has that
    depth: moderngl.Renderbuffer | None = None  # that a draw left
    owned: list[Result] = field(default_factory=list)  # textures that are its own

    @property
    def driver(self) -> str:
        """By what it runs: a mesh is drawn, all else by fragments over the whole target."""
        return "draw" if isinstance(self.step.kernel, Draw) else FRAGMENT


class _Latest(NamedTuple):
    """The run of the last trace, and what it is of."""

    plan: Plan
    record: FrameRecord
    frame: int  # as programs count frames: textures stay until the next one
    run: _Run


@dataclass(eq=False)
class _Compiled:
    """A traced shader, compiled."""

    traced: Traced
    program: Program
    count: int = 0  # leaves of the last run


class TracedFrames(Protocol):
    """What draws the frames whose steps are traced."""

    @property
    def record(self) -> FrameRecord:
        """The last frame's."""

    @property
    def cache(self) -> Cache:
        """The results of passes."""

    @property
    def runner(self) -> Runner:
        """What runs the passes."""

    def borrowed(self) -> AbstractContextManager[None]:
        """Lend the context, made current."""

    def supposing(self, plan: Plan) -> AbstractContextManager[None]:
        """Suppose that a plan were being drawn."""

    def plan(
        self,
        sketch: Sketch,
        size: tuple[int, int],
        time: float = ...,
        steps: Mapping[str, int] | None = ...,
        ref: str = ...,
        *,
        canonical: str = ...,
    ) -> Plan:
        """Make a sketch concrete."""

    def run_apart(self, plan: Plan, refs: Sequence[Ref]) -> FrameRecord:
        """Run what some textures of a plan need apart from the frames."""


class Tracer:
    """Traces the steps of one renderer's frames, and keeps compiled texts and the last step's run."""

    def __init__(self, renderer: TracedFrames) -> None:
        self._renderer = renderer
        self._ctx = renderer.runner.ctx
        self._programs: Memo[tuple[str, str], _Compiled] = Memo(
            "traced programs", _MAX_PROGRAMS, dropped=lambda _, compiled: compiled.program.release()
        )
        self._capture = Capture(self._ctx)
        self._latest: _Latest | None = None
        self._asked: tuple[object, ...] = ()  # what the latest plan was made for
        self._targets: dict[tuple[tuple[str, ...], int], _Target] = {}

    def release(self) -> None:
        """Release programs and textures."""
        self._forget_run()
        self._capture.release()
        self._programs.clear()
        for target in self._targets.values():
            target.release()
        self._targets.clear()

    def plan(
        self,
        sketch: Sketch,
        path: str,
        size: tuple[int, int],
        time: float,
        steps: Mapping[str, int] | None = None,
    ) -> Plan:
        """Return the plan by which a pass is traced, in its canonical form: the last frame's where it has it.

        ``size`` in pixels, supersampling included, ``time`` in seconds, ``steps`` as in ``Engine.render``.
        Raises ``SketchError`` for a path that is no pass, with the nearest.
        """
        flat, last = flatten(sketch), self._renderer.record.plan
        is_canonical = path.partition(":")[0] in flat.outputs
        leaf = flat.ref(path, sketch.name).path if is_canonical else ""
        if last is not None and (last.frame_size, last.time, last.steps) == (size, time, steps or {}):
            now = sketch.at(time)
            step = last.step(leaf or path.partition(":")[0])
            has_kernel = step is not None and isinstance(step.kernel, _TRACED) and step.window is None
            # The eye may have been raised over the terrain.
            if has_kernel and last.sketch in (now, now.with_camera(last.sketch.camera)):
                return last
        asked = sketch, path, size, time, steps or {}
        frame = self._renderer.runner.programs.frame
        if self._latest is not None and self._asked == asked and self._latest.frame == frame:
            return self._latest.plan
        self._asked = asked
        plan = self._renderer.plan(sketch, size, time, steps, path, canonical=leaf)
        found = plan.step(_ref(plan, path).path)
        if found is not None and isinstance(found.kernel, Draw) and sketch.picture.samples != 1:
            return self.plan(sketch.with_picture(samples=1), path, size, time, steps)
        return plan

    def trace(
        self,
        plan: Plan,
        path: str,
        texel: tuple[int, int],
        iteration: int | Sequence[int] | None = None,
        function: str | None = None,
        limit: int = MAX_EVENTS,
    ) -> Trace:
        """Return what one texel's run of a step of a plan recorded; see ``Engine.trace``."""
        ref = _ref(plan, path)
        step, loops = self._step(plan, ref)
        if not isinstance(limit, Integral) or isinstance(limit, bool) or limit < 1:
            raise ParameterError(f"limit {limit!r}: expected a whole number of values from 1")
        renderer = self._renderer
        with renderer.supposing(plan), renderer.borrowed():
            try:
                run = self._run_of(plan, step, loops, ref, iteration)
                texel = _checked_texel(run, texel, step.size)
                renderer.runner.disable_draw_state()
                return self._traced(run, texel, function, limit)
            finally:
                drain(self._ctx)

    # ── what is traced ───────────────────────────────────────────────────────

    def _step(self, plan: Plan, ref: Ref) -> tuple[Step, tuple[LoopStep, ...]]:
        """Return a step of a plan and the loops around it, outermost first."""
        found = _with_loops(plan.nodes, ref.path, {})
        if found is None:
            raise SketchError(f"pass '{ref.path}' does not run in sketch {plan.sketch.name}")
        step, _ = found
        kernel = step.kernel
        if isinstance(kernel, _TRACED):
            return found
        source = isinstance(kernel, CpuSource)
        reason = "a source, which the processor makes" if source else "a compute shader"
        traceable = [s.path for s in plan.walk() if isinstance(s.kernel, _TRACED)]
        hint = nearest(ref.path, traceable)
        raise SketchError(f"pass '{ref.path}' is {reason}: no fragment shader to trace{hint}")

    def _run_of(
        self,
        plan: Plan,
        step: Step,
        loops: tuple[LoopStep, ...],
        ref: Ref,
        iteration: int | Sequence[int] | None,
    ) -> _Run:
        """Return the run of a step in an iteration: that of the last trace where it is the same."""
        renderer = self._renderer
        # Outside of loops its inputs are enough: its texel alone is drawn.
        sources = [source for _, source in step.inputs if isinstance(source, Ref)]
        record = self._record_of(plan, [ref] if loops else sources)
        has_repeat = step.kernel.repeat != "1"
        names = [loop.path for loop in loops if loop.path in record.keys.changes[id(step)]]
        repeated = names + [""] * has_repeat
        last = _iterations(plan, step, repeated, [None] * len(repeated))
        numbers = _iterations(plan, step, repeated, _asked_iterations(step, last, iteration))
        at = tuple(numbers.values())
        step, loops = _with_loops(plan.nodes, step.path, numbers) or (step, loops)
        changing = [loop for loop in loops if loop.path in names]
        latest = self._latest
        if latest is not None and latest.plan is plan and latest.record is record:
            if (latest.run.step.path, latest.run.iteration) == (step.path, at):
                return latest.run
        self._forget_run()
        runner = renderer.runner
        results = dict(record.results)
        visited: list[_Run] = []

        def visit(step: Step, inputs: Mapping[str, Wired], around: LoopIteration | None) -> None:
            frame = around.frame if around is not None else None
            owned: list[Result] = []
            own = {id(result) for result in results.values()}
            copies: dict[int, Result] = {}

            def kept(wired: Wired) -> Wired:
                if wired.result is None or id(wired.result) in own:
                    return wired
                if id(wired.result) not in copies:
                    copies[id(wired.result)] = runner.kernels.copied(wired.result)
                    owned.append(copies[id(wired.result)])
                copy = copies[id(wired.result)]
                return Wired(copy, copy.textures[wired.output], wired.output)

            inputs = {name: kept(wired) for name, wired in inputs.items()}
            uniforms = runner.given_for(step, frame)
            usual = dict(usual_of(step.kernel, runner.frame_uniforms(step, frame)))
            visited.append(_Run(step, inputs, uniforms, around, usual, at, owned=owned))

        if changing:
            search = Search(plan, record.keys, renderer.cache, runner, results, visit)
            search.find(step.path, changing, at[: len(changing)])
        else:
            inputs = {name: _wired(source, results) for name, source in step.inputs}
            visit(step, inputs, None)
        run = visited[0]
        self._latest = _Latest(plan, record, runner.programs.frame, run)
        if isinstance(step.kernel, Draw):
            self._draw(run, at[-1] if has_repeat else 0)
        elif has_repeat:
            self._go_to_iteration(run, at[-1])
        if numbers == last and runner.driver_for(step) == FRAGMENT and run.depth is None:
            run.result = results.get(step.path)
        return run

    def _draw(self, run: _Run, iteration: int) -> None:
        """Draw a run's mesh, up to one of its own iterations, with one sample a pixel, and keep its depth."""
        runner, step = self._renderer.runner, run.step
        run.own_iteration = iteration
        part = replace(step, repeat=iteration + 1)
        result = runner.draws.run(part, run.inputs, run.uniforms, run.around, 1, keeps_surface=False)
        run.owned.append(result)
        assert result.target is not None, "what has one sample a pixel draws on its own textures"
        run.result, run.depth = result, result.target.depth

    def _record_of(self, plan: Plan, refs: Sequence[Ref]) -> FrameRecord:
        """Return the record of a frame of a plan that has the results of some textures."""
        renderer = self._renderer
        last = renderer.record
        if last.plan is plan and all(ref.path in last.results for ref in refs):
            return last
        latest = self._latest
        if latest is not None and latest.plan is plan:
            has_all = all(ref.path in latest.record.results for ref in refs)
            if has_all and latest.frame == renderer.runner.programs.frame:
                return latest.record
        record = renderer.run_apart(plan, refs)
        renderer.runner.set_frame(plan)
        return record

    def _go_to_iteration(self, run: _Run, iteration: int) -> None:
        """Give a run of a kernel that repeats the state before one of its iterations."""
        kernels, step = self._renderer.runner.kernels, run.step
        assert isinstance(step.kernel, TexelKernel)
        at_once = kernels.at_once(step)
        first = iteration - iteration % at_once
        run.own_iteration = first
        if first == 0:
            run.state = kernels.initial(step, run.inputs)
            return
        part = replace(step, repeat=first)
        start = kernels.run(part, FRAGMENT, run.inputs, run.uniforms, run.around, None)
        run.owned.append(start)
        run.state = dict(start.textures)

    def _forget_run(self) -> None:
        if self._latest is not None:
            for result in self._latest.run.owned:
                self._renderer.runner.pool.give(result)
            self._latest = None

    # ── drawing ──────────────────────────────────────────────────────────────

    def _traced(self, run: _Run, texel: tuple[int, int], function: str | None, limit: int) -> Trace:
        wrapped, traced = self._instrumented(run, function)
        compiled = self._compiled(traced)
        varyings, depth_test = self._varyings(run, wrapped, traced, texel)
        real = self._real_texel(run, texel, depth_test)
        # What binds may copy, and bind again what is bound: that must be alive.
        formats = tuple([output.format for output in run.step.kernel.outputs])
        self._target(formats, _FIRST_SIDE).framebuffer.use()
        self._bind(compiled.program, run)
        for name, value in varyings.items():
            if name in compiled.program.uniforms:
                compiled.program.write(name, value)
        leaves, own, count, is_gone = self._recorded(run, compiled, texel, limit)
        calls, events = rebuild(traced.places, traced.structs, leaves)
        names = [output.name for output in run.step.kernel.outputs]
        return Trace(
            step=run.step.path,
            texel=texel,
            iteration=run.iteration,
            outputs={} if is_gone else _values(names, formats, own),
            texel_values=_values(names, formats, real),
            is_exact=is_gone or own == real,
            calls=calls,
            events=events,
            is_complete=len(leaves) == count,
            count=count,
            functions=traced.functions,
            others=traced.others,
            files=_files(wrapped.stages["fragment"].source),
            is_discarded=is_gone,
            as_html=trace_html,
        )

    def _stage(self, run: _Run) -> Stage:
        """Return how a run's step runs on this renderer."""
        if isinstance(run.step.kernel, PlainFragment):
            return Stage()
        tuning = self._renderer.runner.tuning
        return tuning.stage(run.step, run.inputs, run.driver, in_loop=run.around is not None)

    def _instrumented(self, run: _Run, function: str | None) -> tuple[Wrapped, Traced]:
        kernel, programs = run.step.kernel, self._renderer.runner.programs
        wrapped = programs.wrapped(kernel, run.driver, self._stage(run).choices)
        stage = wrapped.stages["fragment"]
        has_mesh = isinstance(kernel, Draw) or vertices_of(kernel) > 3
        try:
            return wrapped, _instrumented(stage, function or "", has_mesh)
        except KeyError:
            names = functions_of(stage)
            hint = nearest(str(function), names) or f"; expected '{ALL}' or one of {', '.join(names)}"
            message = f"pass '{run.step.path}' has no function '{function}'{hint}"
            raise ParameterError(message) from None

    def _varyings(
        self, run: _Run, wrapped: Wrapped, traced: Traced, texel: tuple[int, int]
    ) -> tuple[dict[str, Any], str]:
        """Return the uniforms that stand for what the vertex stage hands a texel's fragment.

        Also the depth test by which that fragment is found. Raises ``ParameterError`` where none is drawn.
        """
        if not traced.varyings and not traced.has_mesh:
            return {}, ""
        step, draws = run.step, self._renderer.runner.draws
        kernel = step.kernel

        def draw(depth: str) -> dict[str, Any] | None:
            def drawn(program: Program) -> None:
                if isinstance(kernel, Draw):
                    at = run.around, run.own_iteration
                    draws.draw_again(program, step, run.inputs, run.uniforms, *at, depth)
                else:
                    self._bind(program, run)
                    program.fill(vertices_of(kernel))

            return self._capture.uniforms(wrapped, traced, texel, step.size, run.depth, drawn)

        ways = [""]
        if isinstance(kernel, Draw) and (kernel.over or kernel.depth != "none"):
            # The fragment that is seen, else one that the shader discards in front of it.
            ways = [">"] if kernel.over else ["==", "<="]
        for way in ways:
            uniforms = draw(way)
            if uniforms is not None:
                return uniforms, way
        raise ParameterError(f"texel {texel} of '{step.path}': nothing is drawn there")

    def _compiled(self, traced: Traced) -> _Compiled:
        key = _vertex_of(traced), traced.text
        compiled: _Compiled | None = self._programs.get(key)
        if compiled is None:
            compiled = self._programs.put(key, _Compiled(traced, _program(self._ctx, *key)))
        return compiled

    def _bind(self, program: Program, run: _Run) -> None:
        """Set all that a run's shader reads."""
        runner, step = self._renderer.runner, run.step
        kernel, kernels = step.kernel, runner.kernels
        if isinstance(kernel, PlainFragment):
            kernels.bind_plain(program, step, run.inputs, run.uniforms, run.around, run.usual)
            return
        unit = kernels.binder.bind(program, step, run.uniforms, run.inputs, self._stage(run))
        if not isinstance(kernel, TexelKernel):
            program.count(kernel.repeat, run.own_iteration, step.total, run.around)
            return
        kernels.binder.previous(kernels.binder.previous_units(program, kernel, unit), run.state)
        # Of those that run at once, as many as there are up to the one that is traced.
        at_once = run.iteration[-1] - run.own_iteration + 1 if kernel.repeat != "1" else 1
        program.count(kernel.repeat, run.own_iteration, step.total, run.around, at_once)
        program.set("k_previous_shift", 0)
        program.set("k_shift", 0)

    def _real_texel(self, run: _Run, texel: tuple[int, int], depth_test: str) -> list[bytes]:
        """Return the bytes of a texel in each output, as the untraced shader gives it, unblended."""
        ctx, runner, step = self._ctx, self._renderer.runner, run.step
        kernel = step.kernel
        is_blended = isinstance(kernel, Draw) and kernel.blend != "none"
        if run.result is not None and not is_blended:
            return _read_texel(run.result.framebuffer(ctx), kernel, texel)
        program = runner.programs.get(kernel, run.driver, self._stage(run).choices)
        result = runner.pool.take(step.size, kernel.outputs)
        textures = [result.textures[output.name] for output in kernel.outputs]
        framebuffer = make_framebuffer(ctx, textures, run.depth)
        try:
            framebuffer.use()
            framebuffer.scissor = (texel[0] & ~1, texel[1] & ~1, 2, 2)
            framebuffer.depth_mask = False
            framebuffer.clear()
            if isinstance(kernel, Draw):
                at = run.around, run.own_iteration
                runner.draws.draw_again(program, step, run.inputs, run.uniforms, *at, depth_test)
            else:
                self._bind(program, run)
                program.fill(vertices_of(kernel))
            return _read_texel(framebuffer, kernel, texel)
        finally:
            release_framebuffer(framebuffer)
            runner.pool.give(result)

    def _recorded(
        self, run: _Run, compiled: _Compiled, texel: tuple[int, int], limit: int
    ) -> tuple[list[Leaf], list[bytes], int, bool]:
        """Return the leaves of a run, the bytes of its outputs, how many leaves it has, whether it ended."""
        traced, program = compiled.traced, compiled.program
        formats = tuple([output.format for output in run.step.kernel.outputs])
        leaves: list[Leaf] = []
        expected = min(max(compiled.count, 1), limit)
        while True:
            side = _FIRST_SIDE
            while side * side < expected - len(leaves) and side < _MAX_SIDE:
                side *= 2
            target = self._target(formats, side * (2 if traced.quads else 1))
            target.framebuffer.use()
            program.set("k_trace_texel", texel)
            program.set("k_trace_width", side)
            program.set("k_trace_from", len(leaves))
            program.fill()
            bits, what, own = target.read(texel if traced.quads else None)
            count, is_gone = int(what[0, 2]), bool(what[0, 3])
            size = min(side * side, count - len(leaves), limit - len(leaves))
            leaves += [
                Leaf(place, code, tuple(bit))
                for (place, code, _, _), bit in zip(what[:size].tolist(), bits[:size].tolist(), strict=True)
            ]
            compiled.count = count
            if len(leaves) >= min(count, limit):
                return leaves, own, count, is_gone
            expected = min(count, limit)
            if len(leaves) < _MAX_SIDE * _MAX_SIDE:
                leaves.clear()  # a larger target has them all

    def _target(self, formats: tuple[str, ...], side: int) -> _Target:
        key = formats, side
        target = self._targets.pop(key, None) or _Target(self._ctx, formats, side)
        self._targets[key] = target
        while len(self._targets) > _MAX_TARGETS:
            self._targets.pop(next(iter(self._targets))).release()
        return target


def _program(ctx: moderngl.Context, vertex: str, fragment: str) -> Program:
    import moderngl

    try:
        return Program(ctx, ctx.program(vertex_shader=vertex, fragment_shader=fragment))
    except moderngl.Error as error:
        log = " ".join(str(error).split())
        raise ShaderError(f"the driver refuses the text that records this shader: {log}") from None
    finally:
        drain(ctx)


class _Target:
    """What a traced shader draws to: its own outputs, and two of the recording's."""

    def __init__(self, ctx: moderngl.Context, formats: tuple[str, ...], side: int) -> None:
        self.side = side
        self.formats = [split_format(form) for form in formats]
        kinds = [*self.formats, *((4, "u4") for _ in _RECORDING)]
        self.textures = [ctx.texture((side, side), parts, dtype=dtype) for parts, dtype in kinds]
        self.framebuffer = make_framebuffer(ctx, self.textures)

    def read(self, quad: tuple[int, int] | None) -> tuple[NDArray[Any], NDArray[Any], list[bytes]]:
        """Return bits and kinds of the leaves, and the outputs' bytes.

        ``quad``: the texel whose lane of each quad is read.
        """
        count = len(self.formats)
        arrays = []
        for index in (count, count + 1):
            data = self.framebuffer.read(components=4, attachment=index, alignment=1, dtype="u4")
            array = np.frombuffer(data, np.uint32).reshape(self.side, self.side, 4)
            if quad is not None:
                array = array[quad[1] & 1 :: 2, quad[0] & 1 :: 2]
            arrays.append(array.reshape(-1, 4))
        x, y = (quad[0] & 1, quad[1] & 1) if quad is not None else (0, 0)
        own = [
            self.framebuffer.read((x, y, 1, 1), parts, attachment=index, alignment=1, dtype=dtype)
            for index, (parts, dtype) in enumerate(self.formats)
        ]
        return arrays[0], arrays[1], own

    def release(self) -> None:
        """Release its framebuffer and textures."""
        release_framebuffer(self.framebuffer)
        for texture in self.textures:
            texture.release()


@GRAPHS.cached(identities=1)
def _instrumented(stage: ShaderStage, functions: str, has_mesh: bool) -> Traced:
    return instrument(stage, functions, has_mesh=has_mesh)


def _vertex_of(traced: Traced) -> str:
    """Return the vertex shader that a traced fragment shader is drawn with, of its version."""
    version = traced.text.partition("\n")[0]
    return TRIANGLE.replace("#version 330", version)


def _with_loops(
    nodes: Sequence[PlanNode], path: str, numbers: Mapping[str, int]
) -> tuple[Step, tuple[LoopStep, ...]] | None:
    """Return a step and the loops around it, outermost first, in iterations by path, the last of others."""
    for node in nodes:
        if isinstance(node, LoopStep):
            body = node.body_of(numbers[node.path]) if node.path in numbers else node.body
            inside = _with_loops(body, path, numbers)
            if inside is not None:
                return inside[0], (node, *inside[1])
        elif node.path == path:
            return node, ()
    return None


def _ref(plan: Plan, path: str) -> Ref:
    """Return the texture that ``pass[.inner…][:output]`` names, one inside of a fast variant too."""
    name, _, output = path.partition(":")
    step = plan.step(name) if name not in plan.flat.outputs else None
    if step is None:
        return plan.flat.ref(path, plan.sketch.name)
    outputs = [each.name for each in step.kernel.outputs]
    if output and output not in outputs:
        raise SketchError(f"pass '{name}' has no output '{output}'{nearest(output, outputs)}")
    return Ref(name, output or outputs[0])


def _wired(source: Ref | Fed | None, results: Mapping[str, Result]) -> Wired:
    if not isinstance(source, Ref):
        return Wired()
    result = results[source.path]
    return Wired(result, result.textures[source.output], source.output)


def _checked_texel(run: _Run, texel: object, last_size: tuple[int, int]) -> tuple[int, int]:
    """Return a texel inside of a run's textures, or raise ``ParameterError``."""
    sides = tuple(texel) if isinstance(texel, Sequence) and not isinstance(texel, str) else ()
    if len(sides) != 2 or not all(isinstance(n, Integral) and not isinstance(n, bool) for n in sides):
        raise ParameterError(f"texel {texel!r}: expected two whole numbers, column and row")
    (x, y), (width, height) = (int(sides[0]), int(sides[1])), run.step.size
    if not (0 <= x < width and 0 <= y < height):
        number = ", ".join(map(str, run.iteration))
        when = f" in iteration {number}" if run.step.size != last_size else ""
        inside = f"0 to {width - 1} and 0 to {height - 1} were expected"
        raise ParameterError(
            f"texel ({x}, {y}) of '{run.step.path}', {width} x {height} texels{when}; {inside}"
        )
    return x, y


def _asked_iterations(
    step: Step, last: Mapping[str, int], iteration: int | Sequence[int] | None
) -> list[int | None]:
    """Return the number that is asked for of each loop and repeat, None for the last one."""
    if iteration is None:
        return [None] * len(last)
    numbers = tuple(iteration) if isinstance(iteration, Sequence) else (iteration,)
    is_whole = all(isinstance(n, Integral) and not isinstance(n, bool) for n in numbers)
    if not last and is_whole and set(numbers) <= {0}:
        return []
    if not is_whole or len(numbers) > len(last):
        counts = " x ".join(str(number + 1) for number in last.values())
        repeats = f"it has {counts} iterations" if last else "it runs once"
        raise ParameterError(f"iteration {iteration!r} of '{step.path}'; {repeats}")
    return [*[None] * (len(last) - len(numbers)), *map(int, numbers)]


def _iterations(plan: Plan, step: Step, names: Sequence[str], asked: Sequence[int | None]) -> dict[str, int]:
    """Return the iteration of each loop, by path, and of the step's own repeat: the last where none is asked.

    ``names``: the loops' paths, outermost first, and "" for the repeat; in each iteration those inside may
    have counts of their own.
    """
    numbers: dict[str, int] = {}
    for name, number in zip(names, asked, strict=True):
        step, loops = _with_loops(plan.nodes, step.path, numbers) or (step, ())
        count = next((loop.repeat for loop in loops if loop.path == name), step.repeat)
        if count < 1:
            raise ParameterError(f"pass '{step.path}' runs no iteration that could be traced")
        numbers[name] = count - 1 if number is None else number
        if not 0 <= numbers[name] < count:
            raise ParameterError(
                f"iteration {number} of '{step.path}', which has {count}; 0 to {count - 1} were expected"
            )
    return numbers


def _read_texel(framebuffer: moderngl.Framebuffer, kernel: Kernel, texel: tuple[int, int]) -> list[bytes]:
    kinds = [split_format(output.format) for output in kernel.outputs]
    return [
        framebuffer.read((*texel, 1, 1), parts, attachment=index, alignment=1, dtype=dtype)
        for index, (parts, dtype) in enumerate(kinds)
    ]


def _values(
    names: Sequence[str], formats: Sequence[str], texels: Sequence[bytes]
) -> dict[str, tuple[float, ...]]:
    """Return the numbers of a texel in each output."""
    pairs = zip(names, formats, texels, strict=True)
    return {name: tuple(floats_in(form, data).tolist()) for name, form, data in pairs}


@GRAPHS.cached(identities=1)
def _files(source: SourceText) -> dict[str, tuple[str, ...]]:
    """Return the lines of the author's files, by path, the kernel's own first."""
    lines: dict[str, dict[int, str]] = {source.path: {}}
    for line in source.lines:
        lines.setdefault(line.file, {})[line.number] = line.text
    return {
        path: tuple([numbered.get(n, "") for n in range(1, max(numbered, default=0) + 1)])
        for path, numbered in lines.items()
    }
