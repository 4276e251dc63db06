"""Run the passes of one plan in order: what is cached is taken, what is stale is made, loops iterate.

What an iteration of a loop makes belongs to the loop until its next iteration is done; all else
belongs to the cache. A pass inside a loop that does not change with it runs once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from contextlib import AbstractContextManager, nullcontext

from playground.engine.cache import Cache, Cached
from playground.engine.cache_keys import Keys
from playground.engine.plan import LoopStep, Plan, PlanNode, Step, walk
from playground.engine.results import UNWIRED, Result, Wired
from playground.engine.runner import Runner
from playground.sketch.expressions import names_in
from playground.sketch.flat import Fed, Ref, Source

Turn = tuple[int, int]
"""An iteration of a loop, and its iterations in all."""

Make = Callable[[Step, Mapping[str, Wired], Turn | None, Result | None], Result]
"""Runs a step: its inputs, the iteration of the loop around it, the same step after fewer to go on from."""


Timed = Callable[[str, str], AbstractContextManager[None]]
"""Measures what the step or the loop of that path and that key takes."""


class Execution:
    """One frame's run over a plan."""

    def __init__(
        self,
        keys: Keys,
        cache: Cache,
        runner: Runner,
        make: Make,
        stopped: Mapping[str, int],
    ) -> None:
        self.keys = keys
        self.cache = cache
        self.runner = runner
        self.make = make
        self.stopped = stopped  # repeats that are stopped early, by path
        self.timed: Timed = lambda path, key: nullcontext()
        self.results: dict[str, Result] = {}  # by the step's path; good until the next frame
        self._settled: set[int] = set()  # identities of nodes that change with no loop, and have run

    def run(self, nodes: Iterable[PlanNode]) -> None:
        """Run nodes in order: those that change with no loop, and loops from their first iteration on."""
        for node in nodes:
            if not self.keys.changes(node):
                self._run(node, {}, None, {})
            elif isinstance(node, LoopStep):
                self.run(node.body)

    def _run(
        self, node: PlanNode, fed: Mapping[Fed, Wired], turn: Turn | None, owned: dict[str, Result]
    ) -> None:
        """Run a node; what the cache does not keep goes into ``owned``."""
        passing = bool(self.keys.changes(node))
        if not passing:
            if id(node) in self._settled:
                return
            self._settled.add(id(node))
        if isinstance(node, LoopStep):
            if passing:
                state = Cached({})
                self._loop(node, state, fed, owned)
                owned |= state.results
            else:
                self._kept_loop(node)
        elif passing:
            owned[node.path] = self.make(node, self._inputs(node, fed), turn, None)
            self.results[node.path] = owned[node.path]
        else:
            self.results[node.path] = self._stood_for(node) or self._kept(node)

    def _stood_for(self, step: Step) -> Result | None:
        """Return the earlier draw that stands for one that draws nothing over it, samples and depth too."""
        start = self._read(dict(step.inputs).get("initial"), {})
        if step.kernel.kind != "draw" or step.repeat or start.result is None or start.texture is None:
            return None
        if start.result.surface is None or start.result.size != step.size:
            return None
        textures = {step.kernel.outputs[0].name: start.texture}
        return Result(step.size, step.kernel.outputs, textures, surface=start.result.surface)

    def _kept(self, step: Step) -> Result:
        """Return a step's result as it is shown, from the cache or made if it is stale."""
        key = self.keys.steps[step.path]
        if step.between is None:
            return self._raw(step, key)
        kept = self.cache.get(key)
        if kept is None:
            raw = self._raw(step, self.keys.raw[step.path])
            kept = Cached({step.path: self.runner.filled(raw, step.between)})
            self.cache.put(key, kept)
        return next(iter(kept.results.values()))

    def _raw(self, step: Step, key: str) -> Result:
        """Return what a step has computed, from the cache or made if it is stale."""
        unfinished = self.keys.unfinished[step.path]
        kept = self.cache.get(key)
        if kept is None:
            goes_on = step.path in self.stopped or "time" in names_in(step.kernel.repeat)
            earlier = self.cache.take_earlier(step.path, unfinished, step.repeat) if goes_on else None
            with self.timed(step.path, key):
                kept = Cached({step.path: self.make(step, self._inputs(step, {}), None, earlier)})
            self.cache.put(key, kept)
            if goes_on:
                self.cache.note_turn(step.path, unfinished, key, step.repeat)
        return next(iter(kept.results.values()))

    def _inputs(self, step: Step, fed: Mapping[Fed, Wired]) -> dict[str, Wired]:
        return {name: self._read(source, fed) for name, source in step.inputs}

    def _read(self, source: Source | None, fed: Mapping[Fed, Wired]) -> Wired:
        if source is None:
            return UNWIRED
        if isinstance(source, Fed):
            return fed[source]
        result = self.results[source.path]
        return Wired(result, result.textures[source.output], source.output)

    # ── loops ────────────────────────────────────────────────────────────────

    def _kept_loop(self, loop: LoopStep) -> None:
        """Run a loop from the iteration that is kept, or from the start where that lies further on."""
        key = self.keys.loops[loop.path]
        state = self.cache.get(key)
        if state is None or state.turn > loop.repeat:
            state = Cached({})
            self.cache.put(key, state)
        with self.timed(loop.path, key) if state.turn < loop.repeat else nullcontext():
            self._loop(loop, state, {}, {})
        self.cache.grew(key)

    def _loop(
        self, loop: LoopStep, state: Cached, around: Mapping[Fed, Wired], owned: dict[str, Result]
    ) -> None:
        """Run a loop's iterations after ``state``, which each replaces; what stays over them is ``owned``."""
        self.run(loop.body)
        fed = dict(around)
        for name, first, _ in loop.feedback:
            fed[Fed(loop.path, name)] = self._read(first, around)
        changing = []
        for node in loop.body:
            if loop.path in self.keys.changes(node):
                changing.append(node)
            else:
                self._run(node, around, None, owned)
        if loop.repeat == 0 and not state.results:
            state.results = self._unturned(loop, changing, fed)
        self.results |= state.results
        for turn in range(state.turn, loop.repeat):
            if turn > 0:
                for name, _, ref in loop.feedback:
                    fed[Fed(loop.path, name)] = self._read(ref, fed)
            made: dict[str, Result] = {}
            try:
                for node in changing:
                    self._run(node, fed, (turn, loop.whole), made)
            except BaseException:
                Cached(made).let_go(self.runner.pool)
                raise
            Cached(state.results).let_go(self.runner.pool)
            state.results, state.turn = made, turn + 1
            self.results |= made

    def _unturned(
        self, loop: LoopStep, changing: list[PlanNode], fed: Mapping[Fed, Wired]
    ) -> dict[str, Result]:
        """Return what a loop gives before its first iteration: what that would read, else zeros."""
        found = {step.path: self.runner.empty(step) for step in walk(tuple(changing))}
        for name, _, ref in loop.feedback:
            texture = fed[Fed(loop.path, name)].texture
            if texture is not None and ref.path in found:
                self.runner.copy(found[ref.path].textures[ref.output], texture)
        return found


def would_run(keys: Keys, cache: Cache, nodes: Iterable[PlanNode], plan: Plan) -> list[str]:
    """Return the paths of the steps that running some nodes of a plan would run: those not in the cache."""
    wanted = tuple(nodes)
    steps = {step.path: step for step in plan.walk()}
    found: list[str] = []
    for node in wanted:
        if isinstance(node, LoopStep):
            if not cache.holds(keys.loops[node.path], node.repeat):
                found += [step.path for step in walk((node,))]
        elif keys.steps[node.path] not in cache and not _draws_nothing(node, steps):
            found.append(node.path)
    return found


def _draws_nothing(step: Step, steps: Mapping[str, Step]) -> bool:
    """Return whether an earlier draw will stand for a step: see ``Execution``."""
    start = dict(step.inputs).get("initial")
    earlier = steps.get(start.path) if isinstance(start, Ref) else None
    if step.kernel.kind != "draw" or step.repeat or earlier is None:
        return False
    return earlier.kernel.kind == "draw" and earlier.size == step.size
