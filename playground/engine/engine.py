"""Run a sketch on a context, and only what is stale.

A pass runs again when its key changes: its text without comments, its values, its
inputs' keys, its size, its driver, and whatever else of the frame its text names. So
moving the sun lights the land anew and leaves the land alone.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.files import content_hash
from playground.engine.frame import Frame
from playground.engine.plan import Plan, PlanNode, Step, Turns, make_plan, walk
from playground.engine.results import Cache, Result
from playground.engine.runner import Runner
from playground.errors import ContextError, SketchError
from playground.gpu.context import ContextInfo, context_info
from playground.gpu.textures import read_texture
from playground.gpu.timers import Timer
from playground.gpu.wrap import COMPUTE, FRAGMENT
from playground.sketch.flatten import Fed, Ref, Source
from playground.sketch.model import Kernel, Sketch

if TYPE_CHECKING:
    import moderngl

CACHE_BYTES = 768 * 2**20
DRIVERS = ("auto", FRAGMENT, COMPUTE)


class Engine:
    """Runs sketches on one context; keeps textures between frames.

    The context is the caller's, unless ``owns_context``. ``driver`` is "fragment",
    "compute", or "auto": compute for what gains by it (visits and companions) where
    there is compute, fragment for the rest.
    """

    def __init__(
        self,
        ctx: moderngl.Context,
        *,
        driver: str = "auto",
        cache_bytes: int = CACHE_BYTES,
        owns_context: bool = False,
    ) -> None:
        if driver not in DRIVERS:
            raise ContextError(f"driver '{driver}': expected one of {', '.join(DRIVERS)}")
        self.ctx = ctx
        self.info: ContextInfo = context_info(ctx)
        if driver == COMPUTE and not self.info.compute:
            code = self.info.version_code
            raise ContextError(f"this context is OpenGL {code // 100}.{code % 100 // 10}; compute needs 4.3")
        self.driver = driver
        self.runs: Counter[str] = Counter()  # how often each pass ran, by path
        self.ran: list[str] = []  # what ran for the last frame, in order
        self.texels = 0  # computed for the last frame
        self.profiling = False
        self.times: dict[str, float] = {}  # [ms] of each pass that ran in the last frame, while profiling
        self.cache = Cache(cache_bytes)
        self.runner = Runner(ctx, self.info)
        self._timer: Timer | None = None
        self._owns_context = owns_context
        self._frame_results: dict[str, Result] = {}
        self._plan: Plan | None = None

    @property
    def clock(self) -> str:
        """Which clock the times come from."""
        return self._timer_of().clock

    @property
    def plan(self) -> Plan | None:
        """The plan of the last frame."""
        return self._plan

    def __enter__(self) -> Engine:
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Give back every texture and program, and the context if it is the engine's own."""
        self.cache.clear()
        self.runner.release()
        if self._owns_context:
            self.ctx.release()

    def plan_for(
        self,
        sketch: Sketch,
        size: tuple[int, int],
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> Plan:
        """Make a sketch concrete for this engine's context and driver."""
        compute = self.info.compute and self.driver != FRAGMENT
        return make_plan(sketch, frame_size=size, time=time, compute=compute, steps=steps)

    def render(
        self,
        sketch: Sketch,
        *,
        size: tuple[int, int] = (1280, 720),
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> Frame:
        """Return the sketch's picture.

        ``size`` in pixels, ``time`` in seconds; ``steps`` stops repeated passes after so
        many turns, by path. Raises ``PlaygroundError`` for any mistake in the sketch.
        """
        texture = self.draw(sketch, size=size, time=time, steps=steps)
        values = read_texture(texture)
        if values.ndim == 2:
            values = np.repeat(values[..., None], 3, axis=2)
        if values.shape[2] < 4:
            shape = (*values.shape[:2], 4 - values.shape[2])
            fill = np.zeros(shape, np.float32)
            fill[..., -1] = 1.0
            values = np.concatenate([values, fill], axis=2)
        finite = np.nan_to_num(values, nan=0.0, posinf=1.0, neginf=0.0)
        picture = np.round(np.clip(finite, 0, 1) * 255).astype(np.uint8)
        return Frame(picture[::-1].copy(), sketch.name, time)

    def draw(
        self,
        sketch: Sketch,
        *,
        size: tuple[int, int],
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> moderngl.Texture:
        """Draw the sketch's picture and return its texture, which lives until the next frame."""
        plan = self.plan_for(sketch, size, time, steps)
        view = plan.flat.outputs["view"]
        return self._texture(plan, next(iter(view.values())))

    def texture(
        self,
        sketch: Sketch,
        ref: str,
        *,
        size: tuple[int, int] = (1280, 720),
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> moderngl.Texture:
        """Return the texture of ``pass[.inner…][:output]``, running only what it needs; it lives until the next frame."""
        plan = self.plan_for(sketch, size, time, steps)
        return self._texture(plan, plan.flat.ref(ref, sketch.name))

    def read(
        self,
        sketch: Sketch,
        ref: str,
        *,
        size: tuple[int, int] = (1280, 720),
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> NDArray[np.float32]:
        """Return the values of ``pass[.inner…][:output]``.

        float32, (ny, nx) or (ny, nx, components), row 0 in the south; heights are 0..1
        (times ``relief`` for metres), colours and light linear.
        """
        return read_texture(self.texture(sketch, ref, size=size, time=time, steps=steps))

    def steps(
        self, sketch: Sketch, path: str, *, size: tuple[int, int] = (1280, 720), time: float = 0.0
    ) -> Iterator[tuple[int, NDArray[np.float32]]]:
        """Yield (turns done, values) of a repeated pass, from before its first turn to after its last."""
        plan = self.plan_for(sketch, size, time)
        step = plan.step(path)
        repeat = step.repeat if step else next((n.repeat for n in plan.nodes if n.path == path), None)
        if repeat is None:
            raise SketchError(f"no pass '{path}' in sketch {sketch.name} that repeats")
        for turn in range(repeat + 1):
            yield turn, self.read(sketch, path, size=size, time=time, steps={path: turn})

    # ── running ──────────────────────────────────────────────────────────────

    def _texture(self, plan: Plan, ref: Ref) -> moderngl.Texture:
        self._plan = plan
        self.ran, self.texels, self.times = [], 0, {}
        self.cache.begin()
        self.runner.begin(plan)
        self._frame_results = results = {}
        fed: dict[Fed, tuple[str, moderngl.Texture | None]] = {}
        for node in _needed(plan.nodes, ref):
            self._run(node, plan, results, fed)
        self.cache.trim()
        return results[ref.path].textures[ref.output]

    def _run(
        self,
        node: PlanNode,
        plan: Plan,
        results: dict[str, Result],
        fed: dict[Fed, tuple[str, moderngl.Texture | None]],
    ) -> None:
        if isinstance(node, Turns):
            self._run_loop(node, plan, results, fed)
            return
        start = dict(node.inputs).get("initial")
        if node.kernel.kind == "draw" and node.repeat == 0 and isinstance(start, Ref):
            origin = results[start.path]
            if origin.surface is not None and origin.size == node.size:
                # It draws nothing over the earlier draw, so that one stands for it, samples and depth too.
                textures = {node.kernel.outputs[0].name: origin.textures[start.output]}
                results[node.path] = replace(origin, textures=textures, bytes=0, mipmapped=set())
                return
        key = self._key(node, plan, results, fed)
        result = self.cache.get(key)
        if result is None:
            result = self._make(node, plan, key, results, fed)
            self.cache.put(result)
        results[node.path] = result

    def _make(
        self,
        step: Step,
        plan: Plan,
        key: str,
        results: Mapping[str, Result],
        fed: Mapping[Fed, tuple[str, moderngl.Texture | None]],
        turn: tuple[int, int] | None = None,
    ) -> Result:
        kernel, driver = self._form(step)
        inputs = {name: self._input(source, results, fed) for name, source in step.inputs}
        whole = replace_kernel(step, kernel)
        if self.profiling:
            with self._timer_of().measure(self.times, step.path):
                result = self.runner.run(whole, plan, driver, inputs, key, turn)
        else:
            result = self.runner.run(whole, plan, driver, inputs, key, turn)
        self.runs[step.path] += 1
        self.ran.append(step.path)
        self.texels += step.size[0] * step.size[1] * max(step.repeat, 1)
        return result

    def _input(
        self,
        source: Source | None,
        results: Mapping[str, Result],
        fed: Mapping[Fed, tuple[str, moderngl.Texture | None]],
    ) -> tuple[Result | None, moderngl.Texture | None, str]:
        """Return (the result it is part of, the texture, the output's name)."""
        if source is None:
            return None, None, ""
        if isinstance(source, Fed):
            return None, fed[source][1], ""
        result = results[source.path]
        return result, result.textures[source.output], source.output

    def _form(self, step: Step) -> tuple[Kernel, str]:
        """Choose which form of a kernel runs, and by which driver."""
        kernel = step.kernel
        if kernel.kind in ("compute", "plain_compute"):
            if not self.info.compute:
                code = self.info.version_code
                message = f"'{kernel.name}' is a compute shader; this context is OpenGL {code // 100}.{code % 100 // 10}"
                raise ContextError(f"{message}, and compute needs 4.3")
            return kernel, COMPUTE
        if kernel.kind != "kernel" or not self.info.compute or self.driver == FRAGMENT:
            return kernel, FRAGMENT
        if kernel.companion is not None and step.path not in (self._plan.steps if self._plan else {}):
            return kernel.companion, COMPUTE
        if self.driver == COMPUTE or kernel.visits:
            return kernel, COMPUTE
        return kernel, FRAGMENT

    def _key(
        self,
        step: Step,
        plan: Plan,
        results: Mapping[str, Result],
        fed: Mapping[Fed, tuple[str, moderngl.Texture | None]],
    ) -> str:
        kernel, driver = self._form(step)
        parts: list[Any] = [kernel.kind, kernel.source.canonical, driver, step.size, step.repeat]
        parts += [kernel.outputs, kernel.registry, kernel.blend, kernel.depth, kernel.visits, kernel.groups, kernel.local]
        parts += [kernel.buffers, kernel.inputs]
        for parameter in kernel.parameters:
            value = step.values[parameter.name]
            if parameter.widget.kind == "file":
                parts.append((parameter.name, parameter.sampling, content_hash(Path(str(value)))))
            elif kernel.kind in ("source", "draw") or kernel.reads(parameter.name):
                parts.append((parameter.name, value))
        for name, source in step.inputs:
            if source is None:
                parts.append((name, None))
            elif isinstance(source, Fed):
                parts.append((name, fed[source][0]))
            else:
                parts.append((name, results[source.path].key, source.output))
        parts += [(name, value) for name, value in self.runner.given_for(kernel, step, plan).items()]
        if kernel.kind.startswith("plain"):
            parts.append(plan.time)
        if kernel.kind == "draw":
            parts.append(plan.sketch.samples)
        return _digest(parts)

    # ── loops ────────────────────────────────────────────────────────────────

    def _run_loop(
        self,
        loop: Turns,
        plan: Plan,
        results: dict[str, Result],
        fed: dict[Fed, tuple[str, moderngl.Texture | None]],
    ) -> None:
        """Run the turns of a loop, going on from the turn that is kept where that is the same loop."""
        state: dict[Fed, tuple[str, moderngl.Texture | None]] = dict(fed)
        for name, first, _ in loop.feedback:
            if isinstance(first, Ref):
                origin = results[first.path]
                state[Fed(loop.path, name)] = (f"{origin.key}:{first.output}", origin.textures[first.output])
            else:
                state[Fed(loop.path, name)] = fed[first] if first is not None else ("nothing", None)
        steps = {s.path: s for s in walk(loop.body)}
        changing = _changing(loop)
        fixed = [n for n in loop.body if isinstance(n, Step) and n.path not in changing]
        for node in fixed:
            self._run(node, plan, results, state)
        key = self._loop_key(loop, plan, results, state, changing)
        kept = {path: self.cache.take(f"{key}:{path}") for path in changing}
        done = max((r.turn for r in kept.values() if r is not None), default=0)
        going_on = all(r is not None and r.turn == done for r in kept.values()) and 0 < done <= loop.repeat
        current: dict[str, Result] = {}
        if going_on:
            current = {path: r for path, r in kept.items() if r is not None}
        else:
            done = 0
            for stale in kept.values():
                if stale is not None:
                    stale.release()
        for turn in range(done, max(loop.repeat, 1)):
            if turn > 0:
                for name, _, output in loop.feedback:
                    source = current.get(output.path) or results[output.path]
                    state[Fed(loop.path, name)] = (f"{key}:{turn}:{name}", source.textures[output.output])
            made: dict[str, Result] = {}
            scope = {**results}
            for node in loop.body:
                if isinstance(node, Turns):
                    self._run_loop(node, plan, scope, state)
                elif node.path in changing:
                    made[node.path] = self._make(node, plan, "", scope, state, (turn, loop.repeat))
                    made[node.path].key = f"{key}:{turn}:{node.path}"
                    scope[node.path] = made[node.path]
            for path, result in scope.items():
                if path not in results and path not in made and path not in steps:
                    made[path] = result
            for old in current.values():
                old.release()
            current = made
            results |= {p: r for p, r in scope.items() if p not in made}
        for path, result in current.items():
            result.turn = max(loop.repeat, 1)
            result.key = f"{key}:{path}"
            self.cache.put(result)
            # What reads it must know how many turns made it.
            results[path] = _renamed(result, f"{key}:{path}:{loop.repeat}")

    def _loop_key(
        self,
        loop: Turns,
        plan: Plan,
        results: Mapping[str, Result],
        state: Mapping[Fed, tuple[str, moderngl.Texture | None]],
        changing: set[str],
    ) -> str:
        parts: list[Any] = [loop.path]
        known = dict(results)
        for step in walk(loop.body):
            if step.path in changing:
                stand_in = Result(f"turn:{step.path}", step.size, {}, 0)
                known[step.path] = stand_in
        for step in walk(loop.body):
            if step.path in changing:
                inner = {Fed(s.loop, s.name): state.get(s, ("inner", None)) for _, s in step.inputs if isinstance(s, Fed)}
                parts.append(self._key(step, plan, known, inner))
                if step.kernel.reads("iterations"):
                    parts.append(loop.repeat)
        return _digest(parts)

    def _timer_of(self) -> Timer:
        if self._timer is None:
            self._timer = Timer(self.ctx, software=self.info.software)
        return self._timer


def replace_kernel(step: Step, kernel: Kernel) -> Step:
    """Return a step that runs another form of its kernel."""
    return step if kernel is step.kernel else replace(step, kernel=kernel)


def _renamed(result: Result, key: str) -> Result:
    return Result(key, result.size, result.textures, 0, result.surface, result.mipmapped, result.turn)


def _digest(parts: object) -> str:
    return hashlib.blake2b(repr(parts).encode(), digest_size=16).hexdigest()


def _needed(nodes: tuple[PlanNode, ...], ref: Ref) -> list[PlanNode]:
    """Return the nodes that a texture depends on, in order."""
    wanted = {ref.path}
    kept: list[PlanNode] = []
    for node in reversed(nodes):
        inside = {step.path for step in walk((node,))}
        if not inside & wanted:
            continue
        kept.append(node)
        wanted |= _sources(node)
    return kept[::-1]


def _sources(node: PlanNode) -> set[str]:
    found = {s.path for step in walk((node,)) for _, s in step.inputs if isinstance(s, Ref)}
    if isinstance(node, Turns):
        found |= {first.path for _, first, _ in node.feedback if isinstance(first, Ref)}
        for inner in node.body:
            found |= _sources(inner)
    return found


def _changing(loop: Turns) -> set[str]:
    """Return the paths of the steps whose result may differ from turn to turn."""
    found: set[str] = set()
    for step in walk(loop.body):
        reads = {s.path for _, s in step.inputs if isinstance(s, Ref)}
        feeds = any(isinstance(s, Fed) for _, s in step.inputs)
        counts = step.repeat == 1 and step.kernel.reads("iteration")
        if feeds or counts or reads & found:
            found.add(step.path)
    return found
