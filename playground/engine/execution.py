"""Run the passes of one plan in order: cached results are taken, stale ones computed, loops iterate.

What ran, what it gave and what it took is the frame's ``FrameRecord``.

What an iteration of a loop computes belongs to the loop until its next iteration is done; all else
belongs to the cache. A pass inside a loop that does not change with it runs once.
"""

from __future__ import annotations

import logging
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace
from typing import Protocol

from playground.engine.cache import Cache
from playground.engine.cache_keys import Keys, StepKey
from playground.engine.gl_calls import Timer
from playground.engine.loops import LoopState, Replay, iteration_of, replay_of
from playground.engine.plan import LoopIteration, LoopStep, Plan, PlanNode, Step, sources_of, walk
from playground.engine.results import UNWIRED, Cached, Pool, Result, Wired, started
from playground.engine.runner import Runner
from playground.engine.unfinished import Interruption
from playground.errors import OpenGLFault
from playground.shader.expressions import follows_time
from playground.sketch.flat import Fed, Ref, Source
from playground.sketch.model import Draw, ForeignShader, TexelKernel

_log = logging.getLogger(__name__)

Timed = Callable[[str, str], AbstractContextManager[None]]
"""Measures what the step or the loop of that path and that key takes."""

_REPLAYED_FROM = 2  # the iteration from which on a loop's run as the one before: what is fed back is its own


@dataclass
class FrameRecord:
    """One frame; before the first there is no plan."""

    plan: Plan | None = None
    keys: Keys = field(default_factory=Keys)
    before: Keys = field(default_factory=Keys)  # of the frame before, whatever it was of
    results: Mapping[str, Result] = field(default_factory=dict)  # by path; valid until the next frame
    ran: list[str] = field(default_factory=list)  # paths of the passes that ran, in order
    iterations: Counter[str] = field(default_factory=Counter)  # of each pass that ran, by path
    texels: int = 0  # computed
    times: dict[str, float] = field(default_factory=dict)  # [ms] of each pass that ran, while profiling
    triangles: int = 0  # drawn; of what is cached, none

    def count(self, step: Step, iterations: int, triangles: int) -> None:
        """Count a run of a step."""
        self.ran.append(step.path)
        self.iterations[step.path] += iterations
        self.texels += step.size[0] * step.size[1] * max(iterations, 1)
        self.triangles += triangles

    def count_replayed(self, steps: Sequence[Step], times: int) -> None:
        """Count the iterations of a loop, each of which ran some steps once."""
        for step in steps:
            self.iterations[step.path] += times
            self.texels += step.size[0] * step.size[1] * times
        self.ran += [step.path for step in steps] * times

    def reasons(self, path: str) -> tuple[str, ...]:
        """Return why a step ran again: what of its key is another than in the frame before, by name.

        See ``StepKey.difference``; ("the pass",) where that frame had none of this path, nothing where the
        key is the same: its textures had been dropped.
        """
        return _reasons(self.keys.steps[path], self.before.steps.get(path))

    def plus(self, before: FrameRecord) -> FrameRecord:
        """Return the record with the counts of an earlier drawing of the same frame added."""
        return replace(
            self,
            ran=[*before.ran, *(path for path in self.ran if path not in before.ran)],
            iterations=before.iterations + self.iterations,
            texels=before.texels + self.texels,
            times={p: before.times.get(p, 0.0) + self.times.get(p, 0.0) for p in before.times | self.times},
            triangles=before.triangles + self.triangles,
        )

    def counted_as(self, other: FrameRecord) -> FrameRecord:
        """Return the record with the counts of another frame, and why passes ran for it."""
        return replace(
            self,
            before=other.before,
            ran=other.ran,
            iterations=other.iterations,
            texels=other.texels,
            times=other.times,
            triangles=other.triangles,
        )


def _reasons(key: StepKey, before: StepKey | None) -> tuple[str, ...]:
    return ("the pass",) if before is None else key.difference(before)


def why(key: StepKey, before: StepKey | None) -> str:
    """Return as text why a step ran that had another key, or none, in the frame before."""
    return ", ".join(_reasons(key, before)) or "its textures were dropped"


class FrameSource(Protocol):
    """What draws frames, as far as those need it that look at the last one."""

    @property
    def record(self) -> FrameRecord:
        """The last frame's."""

    @property
    def runner(self) -> Runner:
        """What runs the passes, with its context and its pool of textures."""

    def borrowed(self) -> AbstractContextManager[None]:
        """Lend the context, made current."""

    def recall(self, plan: Plan) -> None:
        """Make an earlier frame the last one again."""


class Execution:
    """One frame's run over a plan; what ran goes into its ``record``.

    ``interruption`` may stop it. With a ``timer`` the time of each pass is measured.
    """

    def __init__(
        self,
        record: FrameRecord,
        cache: Cache,
        runner: Runner,
        *,
        interruption: Interruption,
        timer: Timer | None = None,
    ) -> None:
        self.record = record
        self.keys = record.keys
        self.cache = cache
        self.runner = runner
        self.interruption = interruption
        self.timer = timer
        self.timed: Timed | None = None
        self.ended: Callable[[Step, Result], None] | None = None  # called with each step that was computed
        self.last_uses: Mapping[str, Sequence[Step]] = {}  # what to drop once a node has run, by its path
        self.results: dict[str, Result] = {}  # by the step's path; valid until the next frame
        self._done: set[int] = set()  # identities of nodes that change with no loop, and have run
        self._fed_from: dict[Fed, tuple[Step, str]] = {}  # the output that a loop feeds back
        self._changing_in: dict[int, list[PlanNode]] = {}  # by the identity of a loop's body
        self._states: dict[str, LoopState] = {}  # of the loops that run, by their paths

    def run(self, nodes: Iterable[PlanNode]) -> None:
        """Run nodes in order: those that change with no loop, and loops from their first iteration on."""
        for node in nodes:
            if not self.keys.changes[id(node)]:
                self._run_once(node)
                for step in self.last_uses.get(node.path, ()):
                    self._drop(step)
            elif isinstance(node, LoopStep):
                self.run(node.body)

    def _drop(self, step: Step) -> None:
        """Drop the textures of a step, and what else has the same ones."""
        dropped = self.results.get(step.path)
        own = self.keys.steps[step.path]
        for key in {own.result, own.computed}:
            self.cache.drop(key)
        for path in [path for path, result in self.results.items() if result is dropped]:
            del self.results[path]

    def _run_once(self, node: PlanNode) -> None:
        """Run a node that changes with no loop, unless it has run for this frame."""
        if id(node) in self._done:
            return
        self._done.add(id(node))
        if isinstance(node, LoopStep):
            self._run_cached_loop(node)
            return
        result = self._unchanged_draw(node) if isinstance(node.kernel, Draw) and not node.repeat else None
        if result is None:
            cached = self.cache.get(self.keys.result(node.path))
            result = cached.result if cached else self._stale_result(node)
        self.results[node.path] = result

    def _unchanged_draw(self, step: Step) -> Result | None:
        """Return the earlier draw's result for a step that draws nothing over it, samples and depth too."""
        start = self._wired(dict(step.inputs).get("initial"), {})
        if start.result is None or start.texture is None:
            return None
        if start.result.surface is None or start.result.size != step.size:
            return None
        textures = started(step.kernel.outputs, start)
        if len(textures) < len(step.kernel.outputs):
            return None
        return Result(step.size, step.kernel.outputs, textures, surface=start.result.surface)

    def _stale_result(self, step: Step) -> Result:
        """Compute a step whose result is not cached, and cache it; of a stopped step, interpolated."""
        if step.between is None:
            return self._computed(step)
        cached = self.cache.get(self.keys.computed(step.path))
        raw = cached.result if cached else self._computed(step)
        result = self.runner.kernels.run_utility_shader("fill_between.frag", raw, **step.between.uniforms)
        self.cache.put(self.keys.result(step.path), Cached({step.path: result}))
        return result

    def _computed(self, step: Step) -> Result:
        """Run a step, from where its earlier iterations are cached, and cache its result."""
        own = self.keys.steps[step.path]
        key, unfinished = own.computed, own.unfinished
        goes_on = isinstance(step.kernel, TexelKernel) and step.kernel.repeat != "1"
        earlier = self._earlier(step, unfinished) if goes_on else None
        inputs = {name: self._wired(source, {}) for name, source in step.inputs}
        read = self._read(step, inputs)
        before = self.cache.with_same_read(step.path, read) if read else ""
        if before:
            result = self.cache.take(before)
        else:
            with self.timed(step.path, key) if self.timed else nullcontext():
                result = self._run_step(step, inputs, None, earlier)
            if self.ended is not None:
                self.ended(step, result)
        self.cache.put(key, Cached({step.path: result}))
        if read:
            self.cache.note_read(step.path, read, key)
        if goes_on:
            self.cache.note_progress(step.path, unfinished, key, step.repeat)
        return result

    def _run_step(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        around: LoopIteration | None,
        start: Result | None,
    ) -> Result:
        """Run a step, and record that and how it ran; arguments as those of ``Runner.run``."""
        if around is None:
            self.interruption.before_pass()
        record, runner, first = self.record, self.runner, (start.settled or start.iterations) if start else 0
        continued = record.plan is not None and step.path in record.plan.continued
        objects, drawn = runner.pool.made + runner.programs.compiled, runner.draws.drawn
        key = "" if around is not None else self.keys.computed(step.path)
        with self.timer.measure(record.times, step.path) if self.timer else nullcontext():
            result = runner.run(step, inputs, around=around, start=start, keeps_surface=continued, key=key)
        if objects != runner.pool.made + runner.programs.compiled:
            # What has run without an error before will do so again, and a query waits for the driver.
            error = runner.ctx.error
            if error != "GL_NO_ERROR":
                raise OpenGLFault(f"pass '{step.path}': OpenGL reports {error}")
        record.count(step, max((result.settled or step.repeat) - first, 0), runner.draws.drawn - drawn)
        if around is None and _log.isEnabledFor(logging.DEBUG):
            reasons = why(record.keys.steps[step.path], record.before.steps.get(step.path))
            _log.debug("ran %s: %s", step.path, reasons)
        return result

    def _read(self, step: Step, inputs: Mapping[str, Wired]) -> str:
        """Return all that a step's textures depend on, where its key may change without that; "" elsewhere.

        Of an input of which it reads single texels, as of a daylight the day of the year, these are all. Only
        where they are read back anyway: see ``Tuning``.
        """
        by_texels = self.keys.steps[step.path].by_texels
        if not by_texels:
            return ""
        texels = self.runner.tuning.texels_read(step.kernel, inputs)
        return "" if texels is None else f"{by_texels} {texels}"  # where 0 is not -0

    def _earlier(self, step: Step, unfinished: str) -> Result | None:
        """Return the same step after fewer iterations: what is cached, or a copy where a pass reads that."""
        key = self.cache.earlier(step.path, unfinished, step.repeat)
        if not key:
            return None
        if all(step.computed != key for step in self.keys.steps.values()):
            return self.cache.take(key)
        cached = self.cache.get(key)
        assert cached is not None
        return self.runner.kernels.copied(cached.result)

    def _wired(self, source: Source | None, fed: Mapping[Fed, Wired]) -> Wired:
        if source is None:
            return UNWIRED
        if isinstance(source, Fed):
            return fed[source]
        result = self.results[source.path]
        return Wired(result, result.textures[source.output], source.output)

    # ── loops ────────────────────────────────────────────────────────────────

    def _run_cached_loop(self, loop: LoopStep) -> None:
        """Run a loop from the iteration that is cached, or from an earlier one where that lies further on."""
        key, cache = self.keys.loops[loop.path], self.cache
        cached = cache.get(key) or cache.put(key, Cached({}), loop.path)
        kept = cache.states if follows_time(loop.spec.repeat) else None
        with LoopState(loop, cached, self.runner.pool, key, kept) as state:
            is_stale = state.iterations < loop.repeat
            with self.timed(loop.path, key) if self.timed and is_stale else nullcontext():
                self._run_loop(state, {}, {})
        cache.grew(key)

    def _run_loop(
        self,
        state: LoopState,
        around: Mapping[Fed, Wired],
        owned: dict[str, Result],
        frame: int | None = None,
    ) -> None:
        """Run a loop's iterations after those of ``state``.

        What changes with a loop around it only goes into ``owned``; ``frame`` is that of the loop around
        it that counts frames.
        """
        loop = state.loop
        self._states[loop.path] = state
        self.run(loop.body)
        fed, steps = dict(around), {step.path: step for step in walk(loop.body_of(0))}
        for name, first, ref in loop.feedback:
            own = Fed(loop.path, name)
            fed[own] = self._wired(first, around)
            outer = self._fed_from.get(first) if isinstance(first, Fed) else None
            self._fed_from[own] = outer or (steps[ref.path], ref.output)
        for node in loop.body_of(0):
            if loop.path not in self.keys.changes[id(node)]:
                self._run_inside(node, around, LoopIteration(frame=frame), owned)
        if loop.repeat == 0 and not state.results:
            state.start(self._initial(loop, self._changing(loop, 0), fed))
        self.results |= state.results
        for iteration in range(state.iterations, loop.repeat):
            if iteration > 0:
                for name, _, ref in loop.feedback:
                    fed[Fed(loop.path, name)] = self._wired(ref, fed)
            is_steady = iteration == max(state.started_at + 1, _REPLAYED_FROM)
            if is_steady and (replay := self._replay_of(loop, fed)):
                self._replay(replay, state, frame)
                return
            with state.iteration() as computed:
                for node in self._changing(loop, iteration):
                    self._run_inside(node, fed, iteration_of(loop, iteration, frame), computed)
            self.results |= state.results
            self._after_iteration(state)

    def _after_iteration(self, state: LoopState) -> None:
        """Stop a loop that follows the time where that is over."""
        if state.follows_time:
            done = state.iterations
            self.interruption.after_iteration(done - state.started_at, done, state.loop.repeat)

    def _replay_of(self, loop: LoopStep, fed: Mapping[Fed, Wired]) -> Replay | None:
        """Return what runs a loop's next iterations as its last one ran, if they do."""
        runner = self.runner
        if self.timer is not None or runner.before_step is not None or runner.pool.clears:
            return None
        nodes = self._changing(loop, 0)
        return replay_of(
            loop, nodes, lambda source: self._wired(source, fed), runner.kernels, runner.driver_for
        )

    def _replay(self, replay: Replay, state: LoopState, frame: int | None) -> None:
        first = state.iterations
        try:
            state.replay(replay, frame, lambda: self._after_iteration(state))
        finally:
            self.results |= state.results
            self.record.count_replayed(replay.steps, state.iterations - first)

    def _changing(self, loop: LoopStep, iteration: int) -> list[PlanNode]:
        """Return what an iteration of a loop computes again."""
        body = loop.body_of(iteration)
        if id(body) not in self._changing_in:
            changing = [node for node in body if loop.path in self.keys.changes[id(node)]]
            self._changing_in[id(body)] = changing
        return self._changing_in[id(body)]

    def _run_inside(
        self,
        node: PlanNode,
        fed: Mapping[Fed, Wired],
        iteration: LoopIteration,
        owned: dict[str, Result],
    ) -> None:
        """Run a node of a loop's body; what the cache does not hold goes into ``owned``."""
        if not self.keys.changes[id(node)]:
            self._run_once(node)
        elif isinstance(node, LoopStep):
            with LoopState(node, Cached({}), self.runner.pool) as state:
                self._run_loop(state, fed, owned, iteration.frame)
                owned |= state.take()
        else:
            inputs = {name: self._input(node, name, source, fed) for name, source in node.inputs}
            owned[node.path] = self.results[node.path] = self._run_step(node, inputs, iteration, None)

    def _input(self, step: Step, name: str, source: Source | None, fed: Mapping[Fed, Wired]) -> Wired:
        """Return what an input reads; of what is fed back, before the first iteration, perhaps zeros.

        Zeros of the size of what is fed back are for other tools' shaders, and for inputs that ask for zeros.
        """
        wired = self._wired(source, fed)
        if wired.texture is not None or not isinstance(source, Fed):
            return wired
        declared = next((each for each in step.kernel.inputs if each.name == name), None)
        if declared is None or not (isinstance(step.kernel, ForeignShader) or declared.fallback == "zero"):
            return wired
        origin, output = self._fed_from[source]
        kept = self._states[source.loop].zeros
        zeros = kept[source.name] = kept.get(source.name) or self.runner.kernels.empty(origin)
        return Wired(zeros, zeros.textures[output], output)

    def _initial(
        self, loop: LoopStep, changing: list[PlanNode], fed: Mapping[Fed, Wired]
    ) -> dict[str, Result]:
        """Return what a loop gives before its first iteration: what that would read, else zeros."""
        results = {step.path: self.runner.kernels.empty(step) for step in walk(tuple(changing))}
        for name, _, ref in loop.feedback:
            texture = fed[Fed(loop.path, name)].texture
            if texture is not None and ref.path in results:
                self.runner.kernels.copy_texture(results[ref.path].textures[ref.output], texture)
        return results


class Visited(Exception):
    """The run that was looked for has come, and the rest need not."""


class Search(Execution):
    """Runs the loops around one step again, to one run of the step.

    The outermost begins with the latest state of it that is kept, if there is one. Nothing goes into the
    cache or a frame's record. ``results`` are those of the frame's steps that change with no loop, ``visit``
    is called with the step, its inputs and where it is in the loops; its textures are the loops', which
    release them.
    """

    def __init__(
        self,
        plan: Plan,
        keys: Keys,
        cache: Cache,
        runner: Runner,
        results: Mapping[str, Result],
        visit: Callable[[Step, Mapping[str, Wired], LoopIteration | None], None],
    ) -> None:
        interruption = Interruption(runner.ctx.finish, None, None)
        super().__init__(FrameRecord(plan, keys), cache, runner, interruption=interruption)
        self.results = dict(results)
        self._done = {node for node, loops in keys.changes.items() if not loops}
        self._visit = visit
        self._target: tuple[str, dict[str, int]] = ("", {})

    def find(self, path: str, loops: Sequence[LoopStep], iterations: Sequence[int]) -> bool:
        """Visit the run of a step in some iteration of each loop around it, the outermost first.

        Return whether there was one.
        """
        self._target = path, {loop.path: number for loop, number in zip(loops, iterations, strict=True)}
        loop, states = loops[0], self.cache.states
        key = self.keys.loops.get(loop.path, "")
        done = states.latest(loop.path, key, iterations[0])
        kept = states.peek(loop.path, key, done) if done else {}
        copies = {path: self.runner.kernels.copied(result) for path, result in kept.items()}
        try:
            with LoopState(loop, Cached(copies, done), self.runner.pool) as state:
                self._run_loop(state, {}, {})
                _give(self.runner.pool, state.take())
        except Visited:
            return True
        return False

    def _run_step(
        self,
        step: Step,
        inputs: Mapping[str, Wired],
        around: LoopIteration | None,
        start: Result | None,
    ) -> Result:
        path, iterations = self._target
        states = self._states
        if step.path == path and all(states[loop].iterations == n for loop, n in iterations.items()):
            self._visit(step, inputs, around)
            raise Visited
        return super()._run_step(step, inputs, around, start)

    def _replay_of(self, loop: LoopStep, fed: Mapping[Fed, Wired]) -> Replay | None:
        return None  # each run of each step is looked at


def _give(pool: Pool, results: Mapping[str, Result]) -> None:
    for result in {id(result): result for result in results.values()}.values():
        pool.give(result)


def would_run(keys: Keys, cache: Cache, nodes: Iterable[PlanNode], plan: Plan) -> list[str]:
    """Return the paths of the steps that running some nodes of a plan would run: those not in the cache."""
    steps = {step.path: step for step in plan.walk()}
    paths: list[str] = []
    for node in nodes:
        if isinstance(node, LoopStep):
            if not cache.holds(keys.loops[node.path], node.repeat):
                paths += [step.path for step in walk((node,))]
        elif keys.result(node.path) not in cache and not _draws_nothing(node, steps):
            paths.append(node.path)
    return paths


def _draws_nothing(step: Step, steps: Mapping[str, Step]) -> bool:
    """Return whether an earlier draw's result will be taken for a step's: see ``Execution``."""
    start = dict(step.inputs).get("initial")
    earlier = steps.get(start.path) if isinstance(start, Ref) else None
    if not isinstance(step.kernel, Draw) or step.repeat or earlier is None:
        return False
    return isinstance(earlier.kernel, Draw) and earlier.size == step.size


def last_uses(plan: Plan, nodes: Sequence[PlanNode], keys: Keys, ref: Ref) -> dict[str, list[Step]]:
    """Return which steps are read no more once a node has run, by the node's path.

    ``nodes`` are run in order, for the texture ``ref``. Steps of loops are left out, as are draws, which may
    share textures, and what draws read: the terrain under the eye is looked at after the frame.
    """
    draws = [step for step in plan.walk() if isinstance(step.kernel, Draw)]
    stays = {ref.path}.union(*(_read(draw) for draw in draws))
    own = {node.path: node for node in nodes if isinstance(node, Step)}
    # Steps of one key have the same textures.
    kept = {keys.result(path) for path in stays if path in keys.steps}
    last: dict[str, tuple[str, Step]] = {}  # by key: the node that reads it last, and a step of it
    for node in nodes:
        for path in {*_read(node), *({node.path} & own.keys())}:
            step = own.get(path)
            if step is not None and not isinstance(step.kernel, Draw) and keys.result(path) not in kept:
                last[keys.result(path)] = node.path, step
    steps: dict[str, list[Step]] = {}
    for path, step in last.values():
        steps.setdefault(path, []).append(step)
    return steps


def _read(node: PlanNode) -> set[str]:
    versions = [inside for body in node.bodies for inside in walk(body)] if isinstance(node, LoopStep) else []
    every = [node, *versions]
    return {source.path for step in every for source in sources_of(step) if isinstance(source, Ref)}
