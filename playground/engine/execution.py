"""Run the passes of one plan in order: cached results are taken, stale ones computed, loops iterate.

What an iteration of a loop computes belongs to the loop until its next iteration is done; all else
belongs to the cache. A pass inside a loop that does not change with it runs once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext

from playground.engine.cache import Cache, Cached
from playground.engine.cache_keys import Keys
from playground.engine.plan import LoopIteration, LoopStep, Plan, PlanNode, Step, walk
from playground.engine.replay import Replay, replay_of
from playground.engine.results import UNWIRED, Result, Wired, started
from playground.engine.runner import Runner
from playground.engine.unfinished import Deadline
from playground.shader.expressions import follows_time
from playground.sketch.flat import Fed, Ref, Source
from playground.sketch.model import Draw, ForeignShader, TexelKernel

Compute = Callable[[Step, Mapping[str, Wired], LoopIteration | None, Result | None], Result]
"""Runs a step: its inputs, where it is in the loops around it, the same step after fewer to go on from."""

Timed = Callable[[str, str], AbstractContextManager[None]]
"""Measures what the step or the loop of that path and that key takes."""

_REPLAYED_FROM = 2  # the iteration from which on a loop's run as the one before: what is fed back is its own


class Execution:
    """One frame's run over a plan."""

    def __init__(
        self,
        keys: Keys,
        cache: Cache,
        runner: Runner,
        compute: Compute,
        driver_for: Callable[[Step], str],
    ) -> None:
        self.keys = keys
        self.cache = cache
        self.runner = runner
        self.compute = compute
        self.driver_for = driver_for
        self.timed: Timed | None = None
        self.deadline: Deadline | None = None  # of loops that follow the time
        # Called with steps of a loop and how often they ran since; None: each is computed by itself.
        self.replayed: Callable[[Sequence[Step], int], None] | None = None
        self.ended: Callable[[Step, Result], None] | None = None  # called with each step that was computed
        self.last_uses: Mapping[str, Sequence[Step]] = {}  # what to drop once a node has run, by its path
        self.results: dict[str, Result] = {}  # by the step's path; valid until the next frame
        self._done: set[int] = set()  # identities of nodes that change with no loop, and have run
        self._fed_from: dict[Fed, tuple[Step, str]] = {}  # the output that a loop feeds back
        self._changing_in: dict[int, list[PlanNode]] = {}  # by the identity of a loop's body
        self._zeros: dict[Fed, Result] = {}  # what is fed back before a loop's first iteration

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
        found = self.results.get(step.path)
        own = self.keys.steps[step.path]
        for key in {own.result, own.computed}:
            self.cache.drop(key)
        for path in [path for path, result in self.results.items() if result is found]:
            del self.results[path]

    def _run_once(self, node: PlanNode) -> None:
        """Run a node that changes with no loop, unless it has run for this frame."""
        if id(node) in self._done:
            return
        self._done.add(id(node))
        if isinstance(node, LoopStep):
            self._run_cached_loop(node)
            return
        found = self._unchanged_draw(node) if isinstance(node.kernel, Draw) and not node.repeat else None
        if found is None:
            cached = self.cache.get(self.keys.result(node.path))
            found = cached.result if cached else self._stale_result(node)
        self.results[node.path] = found

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
        found = self.runner.kernels.drawn_own("fill_between.frag", raw, **step.between.uniforms)
        self.cache.put(self.keys.result(step.path), Cached({step.path: found}))
        return found

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
            found = self.cache.take(before)
        else:
            with self.timed(step.path, key) if self.timed else nullcontext():
                found = self.compute(step, inputs, None, earlier)
            if self.ended is not None:
                self.ended(step, found)
        self.cache.put(key, Cached({step.path: found}))
        if read:
            self.cache.note_read(step.path, read, key)
        if goes_on:
            self.cache.note_progress(step.path, unfinished, key, step.repeat)
        return found

    def _read(self, step: Step, inputs: Mapping[str, Wired]) -> str:
        """Return all that a step's textures depend on, where its key may change without that; "" elsewhere.

        Of an input of which it reads single texels, as of a daylight the day of the year, these are all. Only
        on a software renderer, which reads them back anyway: there they are uniforms.
        """
        by_texels, software = self.keys.steps[step.path].by_texels, self.runner.software
        if not by_texels or software is None:
            return ""
        texels = software.texels_read(step.kernel, inputs)
        return "" if texels is None else f"{by_texels} {texels}"  # where 0 is not -0

    def _earlier(self, step: Step, unfinished: str) -> Result | None:
        """Return the same step after fewer iterations: what is cached, or a copy where a pass reads that."""
        key = self.cache.earlier(step.path, unfinished, step.repeat)
        if not key:
            return None
        if all(known.computed != key for known in self.keys.steps.values()):
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
        key = self.keys.loops[loop.path]
        state = self.cache.get(key)
        if state is None:
            state = Cached({})
            self.cache.put(key, state)
        taken = self._go_back(loop, state)
        with self.timed(loop.path, key) if self.timed and state.iterations < loop.repeat else nullcontext():
            try:
                self._run_loop(loop, state, {}, {})
            except BaseException:
                if taken and state.iterations == taken:  # it is what is fed back only
                    self._set_aside(loop, state)
                raise
        self.cache.grew(key)

    def _go_back(self, loop: LoopStep, state: Cached) -> int:
        """Set a loop back where it is too far, or on to a later state that was kept.

        Return the iterations of what was taken from the kept states, 0 for nothing.
        """
        if state.iterations == loop.repeat:
            return 0
        key, states = self.keys.loops[loop.path], self.cache.states
        latest = states.latest(loop.path, key, loop.repeat - 1)
        if latest <= state.iterations < loop.repeat:
            return 0
        self._set_aside(loop, state)
        if latest:
            state.results, state.iterations = states.take(loop.path, key, latest), latest
        return latest

    def _set_aside(self, loop: LoopStep, state: Cached) -> None:
        """Keep what a state of a loop that follows the time feeds back, release the rest, and empty it."""
        if state.iterations and follows_time(loop.spec.repeat):
            paths = {ref.path for _, _, ref in loop.feedback} & state.results.keys()
            fed = {path: state.results.pop(path) for path in paths}
            key = self.keys.loops[loop.path]
            self.cache.states.keep(loop.path, key, state.iterations, fed, loop.repeat)
        state.release_to(self.runner.pool)
        state.iterations = 0

    def _run_loop(
        self,
        loop: LoopStep,
        state: Cached,
        around: Mapping[Fed, Wired],
        owned: dict[str, Result],
        frame: int | None = None,
    ) -> None:
        """Run a loop's iterations after ``state``, which each replaces.

        What changes with a loop around it only goes into ``owned``; ``frame`` is that of the loop around
        it that counts frames.
        """
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
            state.results = self._initial(loop, self._changing(loop, 0), fed)
        self.results |= state.results
        first_run = state.iterations
        for iteration in range(first_run, loop.repeat):
            if iteration > 0:
                for name, _, ref in loop.feedback:
                    fed[Fed(loop.path, name)] = self._wired(ref, fed)
            if iteration == max(first_run + 1, _REPLAYED_FROM) and (replay := self._replay_of(loop, fed)):
                self._replay(replay, loop, state, first_run, frame)
                return
            computed: dict[str, Result] = {}
            try:
                for node in self._changing(loop, iteration):
                    self._run_inside(node, fed, _at(loop, iteration, frame), computed)
            except BaseException:
                Cached(computed).release_to(self.runner.pool)
                raise
            finally:
                for name, _, _ in loop.feedback:
                    if zeros := self._zeros.pop(Fed(loop.path, name), None):
                        self.runner.pool.give(zeros)
            if self._is_kept(loop, state.iterations):
                self._set_aside(loop, state)
            else:
                state.release_to(self.runner.pool)
            state.results, state.iterations = computed, iteration + 1
            self.results |= computed
            self._check_deadline(loop, iteration + 1, first_run)

    def _check_deadline(self, loop: LoopStep, done: int, first_run: int) -> None:
        """Stop a loop that follows the time where the deadline has passed."""
        if self.deadline is not None and self._keeps_states(loop):
            self.deadline.check(done - first_run, done, loop.repeat)

    def _keeps_states(self, loop: LoopStep) -> bool:
        """Return whether states of a loop are kept: it follows the time, and changes with no other loop."""
        return follows_time(loop.spec.repeat) and not self.keys.changes[id(loop)]

    def _is_kept(self, loop: LoopStep, iterations: int) -> bool:
        """Return whether the state of a loop after so many iterations is kept while it goes on."""
        if not iterations or not self._keeps_states(loop):
            return False
        return self.cache.states.is_due(loop.path, self.keys.loops[loop.path], iterations, loop.repeat)

    def _replay_of(self, loop: LoopStep, fed: Mapping[Fed, Wired]) -> Replay | None:
        """Return what runs a loop's next iterations as its last one ran, if they do."""
        runner = self.runner
        if self.replayed is None or runner.before_step is not None or runner.pool.clears:
            return None
        nodes = self._changing(loop, 0)
        return replay_of(
            loop, nodes, lambda source: self._wired(source, fed), runner.kernels, self.driver_for
        )

    def _replay(
        self, replay: Replay, loop: LoopStep, state: Cached, first_run: int, frame: int | None
    ) -> None:
        """Run the rest of a loop's iterations: two sets of textures change places."""
        pool, steps, first = self.runner.pool, replay.steps, state.iterations
        before, now = [state.results[step.path] for step in steps], list[Result]()
        fed = {ref.path for _, _, ref in loop.feedback}
        try:
            for step in steps:
                now.append(pool.take(step.size, step.kernel.outputs))
            with self.runner.kernels.filling:
                for iteration in range(first, loop.repeat):
                    replay.run(_at(loop, iteration, frame), before, now)
                    before, now, state.iterations = now, before, iteration + 1
                    if self._is_kept(loop, iteration):
                        kept: dict[str, Result] = {}
                        for place, step in enumerate(steps):
                            if step.path in fed:
                                kept[step.path] = now[place]
                                now[place] = pool.take(step.size, step.kernel.outputs)
                        key = self.keys.loops[loop.path]
                        self.cache.states.keep(loop.path, key, iteration, kept, loop.repeat)
                    self._check_deadline(loop, iteration + 1, first_run)
        finally:
            state.results = {step.path: result for step, result in zip(steps, before, strict=True)}
            self.results |= state.results
            for result in now:
                pool.give(result)
            if self.replayed is not None:
                self.replayed(steps, state.iterations - first)

    def _changing(self, loop: LoopStep, iteration: int) -> list[PlanNode]:
        """Return what an iteration of a loop computes anew."""
        body = loop.body_of(iteration)
        if id(body) not in self._changing_in:
            found = [node for node in body if loop.path in self.keys.changes[id(node)]]
            self._changing_in[id(body)] = found
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
            state = Cached({})
            self._run_loop(node, state, fed, owned, iteration.frame)
            owned |= state.results
        else:
            inputs = {name: self._input(node, name, source, fed) for name, source in node.inputs}
            owned[node.path] = self.results[node.path] = self.compute(node, inputs, iteration, None)

    def _input(self, step: Step, name: str, source: Source | None, fed: Mapping[Fed, Wired]) -> Wired:
        """Return what an input reads; of what is fed back, before the first iteration, perhaps zeros.

        Zeros of the size of what is fed back are for other tools' shaders, and for an input that says so.
        """
        found = self._wired(source, fed)
        if found.texture is not None or not isinstance(source, Fed):
            return found
        declared = next((each for each in step.kernel.inputs if each.name == name), None)
        if declared is None or not (isinstance(step.kernel, ForeignShader) or declared.fallback == "zero"):
            return found
        origin, output = self._fed_from[source]
        if source not in self._zeros:
            self._zeros[source] = self.runner.kernels.empty(origin)
        zeros = self._zeros[source]
        return Wired(zeros, zeros.textures[output], output)

    def _initial(
        self, loop: LoopStep, changing: list[PlanNode], fed: Mapping[Fed, Wired]
    ) -> dict[str, Result]:
        """Return what a loop gives before its first iteration: what that would read, else zeros."""
        found = {step.path: self.runner.kernels.empty(step) for step in walk(tuple(changing))}
        for name, _, ref in loop.feedback:
            texture = fed[Fed(loop.path, name)].texture
            if texture is not None and ref.path in found:
                self.runner.kernels.copy_texture(found[ref.path].textures[ref.output], texture)
        return found


def _at(loop: LoopStep, iteration: int, frame: int | None) -> LoopIteration:
    """Return where a loop's steps are in one of its iterations; ``frame`` as ``_run_loop`` takes it."""
    return LoopIteration(iteration, loop.whole, iteration if loop.counts_frames else frame)


def would_run(keys: Keys, cache: Cache, nodes: Iterable[PlanNode], plan: Plan) -> list[str]:
    """Return the paths of the steps that running some nodes of a plan would run: those not in the cache."""
    steps = {step.path: step for step in plan.walk()}
    found: list[str] = []
    for node in nodes:
        if isinstance(node, LoopStep):
            if not cache.holds(keys.loops[node.path], node.repeat):
                found += [step.path for step in walk((node,))]
        elif keys.result(node.path) not in cache and not _draws_nothing(node, steps):
            found.append(node.path)
    return found


def _draws_nothing(step: Step, steps: Mapping[str, Step]) -> bool:
    """Return whether an earlier draw's result will be taken for a step's: see ``Execution``."""
    start = dict(step.inputs).get("initial")
    earlier = steps.get(start.path) if isinstance(start, Ref) else None
    if not isinstance(step.kernel, Draw) or step.repeat or earlier is None:
        return False
    return isinstance(earlier.kernel, Draw) and earlier.size == step.size
