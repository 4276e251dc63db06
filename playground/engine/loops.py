"""Own the textures of a loop: those of its last iteration, those being written, and some earlier ones.

``LoopState`` is what a running loop has. ``KeptStates`` are earlier states of loops that follow the time, so
that it may go back: what a loop feeds back after some of its iterations; the loop goes on from the latest one
before those that it is to run. States are dense close to the present and ever sparser away from it: the one
that goes first is the one without which the longest run, measured by how far away it is, grows least. So a
jump costs a share of its distance, and steps backwards cost little: each run fills in the states before its
end. Results do not depend on what is kept.

``Replay`` runs a loop's iterations again as the last one ran, without working anything out again. Where each
iteration draws the same kernels once, all that differs is the iteration's number and which textures are read:
those of the iteration before. So two sets of textures change places, what each pass binds is written down
once, and an iteration goes through that list. What does otherwise has no ``Replay`` and runs as its first
iterations did: what repeats, draws or is a loop itself inside the loop, has a size of its own in some
iteration, or mipmaps of what the loop makes.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right, insort
from collections import OrderedDict
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from math import inf
from typing import TYPE_CHECKING, NamedTuple

from playground.engine.kernels import Kernels
from playground.engine.plan import LoopIteration, LoopStep, PlanNode, Step
from playground.engine.programs import Program
from playground.engine.results import Cached, Pool, Result, Wired
from playground.shader.expressions import FRAME_RATE
from playground.sketch.flat import Fed, Ref, Source
from playground.sketch.model import TexelKernel

if TYPE_CHECKING:
    import moderngl


MAX_STATES = 48  # of one loop
_MAX_KEYS = 2  # of one loop's path: two versions that are compared are drawn in turn

State = dict[str, Result]
"""What a loop feeds back, by the path of the step that computed it."""


class LoopState:
    """The textures of a loop while it runs, from the iteration that is ``cached`` on.

    Within the context it goes through its iterations. ``key`` is the loop's, where its textures stay cached
    afterwards; without one they are released when an iteration fails, and ``take`` hands them over when all
    have run. ``kept`` are the states of a loop that follows the time.
    """

    def __init__(
        self, loop: LoopStep, cached: Cached, pool: Pool, key: str = "", kept: KeptStates | None = None
    ) -> None:
        self.loop = loop
        self.zeros: dict[str, Result] = {}  # what is fed back before the first iteration, by its name
        self.started_at = 0  # iterations that were done when the context was entered
        self._cached = cached
        self._pool = pool
        self._key = key
        self._kept = kept
        self._taken = False  # what it started from is what is fed back only
        self._fed = {ref.path for _, _, ref in loop.feedback}

    @property
    def results(self) -> dict[str, Result]:
        """The textures after its last iteration, by the path of the step."""
        return self._cached.results

    @property
    def iterations(self) -> int:
        """How many are done."""
        return self._cached.iterations

    @property
    def follows_time(self) -> bool:
        """Whether earlier states are kept, and it may stop unfinished."""
        return self._kept is not None

    def __enter__(self) -> LoopState:
        self._go_back()
        self.started_at = self.iterations
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is not None and not self._key:
            self._cached.release_to(self._pool)
        elif kind is not None and self._taken and self.iterations == self.started_at:
            self._set_aside()

    def start(self, results: dict[str, Result]) -> None:
        """Take what the loop gives before its first iteration, where none runs."""
        self._cached.results = results

    def take(self) -> dict[str, Result]:
        """Hand over the textures; they are the caller's."""
        results, self._cached.results = self._cached.results, {}
        return results

    @contextmanager
    def iteration(self) -> Iterator[dict[str, Result]]:
        """Collect what the next iteration computes, by path: unless it fails, it replaces the last one's."""
        computed: dict[str, Result] = {}
        try:
            yield computed
        except BaseException:
            _give(self._pool, computed)
            raise
        finally:
            _give(self._pool, self.zeros)
            self.zeros.clear()
        done = self.iterations
        if self._is_due(done):
            self._set_aside()
        else:
            self._cached.release_to(self._pool)
        self._cached.results, self._cached.iterations = computed, done + 1

    def replay(self, replay: Replay, frame: int | None, after_each: Callable[[], None]) -> None:
        """Run the rest of the iterations: two sets of textures change places.

        ``frame`` is that of the loop around it that counts frames; ``after_each`` may stop it: by raising.
        """
        loop, pool, cached, steps = self.loop, self._pool, self._cached, replay.steps
        before, now = [cached.results[step.path] for step in steps], list[Result]()
        try:
            for step in steps:
                now.append(pool.take(step.size, step.kernel.outputs))
            with replay.filling:
                for number in range(cached.iterations, loop.repeat):
                    replay.run(iteration_of(loop, number, frame), before, now)
                    before, now, cached.iterations = now, before, number + 1
                    if self._is_due(number):
                        kept: State = {}
                        for index, step in enumerate(steps):
                            if step.path in self._fed:
                                kept[step.path] = now[index]
                                now[index] = pool.take(step.size, step.kernel.outputs)
                        self._keep(number, kept)
                    after_each()
        finally:
            cached.results = {step.path: result for step, result in zip(steps, before, strict=True)}
            for result in now:
                pool.give(result)

    def _go_back(self) -> None:
        """Set the loop back where it is too far, or on to a later state that was kept."""
        done, total = self.iterations, self.loop.repeat
        if done == total or not self._key:
            return
        latest = self._kept.latest(self.loop.path, self._key, total - 1) if self._kept is not None else 0
        if latest <= done < total:
            return
        self._set_aside()
        if self._kept is not None and latest:
            self._cached.results = self._kept.take(self.loop.path, self._key, latest)
            self._cached.iterations, self._taken = latest, True

    def _set_aside(self) -> None:
        """Keep what is fed back of a loop that follows the time, release the rest, and begin again."""
        if self.iterations and self._kept is not None:
            paths = self._fed & self.results.keys()
            self._keep(self.iterations, {path: self.results.pop(path) for path in paths})
        self._cached.release_to(self._pool)
        self._cached.iterations = 0

    def _is_due(self, done: int) -> bool:
        """Return whether the state after some iterations is kept while the loop goes on."""
        if not done or self._kept is None:
            return False
        return self._kept.is_due(self.loop.path, self._key, done, self.loop.repeat)

    def _keep(self, done: int, state: State) -> None:
        assert self._kept is not None
        self._kept.keep(self.loop.path, self._key, done, state, self.loop.repeat)


def iteration_of(loop: LoopStep, number: int, frame: int | None) -> LoopIteration:
    """Return where a loop's steps are in one of its iterations.

    ``frame`` is that of the loop around it that counts frames.
    """
    return LoopIteration(number, loop.total, number if loop.counts_frames else frame)


def _give(pool: Pool, results: Mapping[str, Result]) -> None:
    for result in results.values():
        pool.give(result)


@dataclass(eq=False)
class _Kept:
    """The states of one key, by iterations done."""

    now: int = 0  # the iterations that were wanted last
    numbers: list[int] = field(default_factory=list)  # ascending
    states: dict[int, State] = field(default_factory=dict)
    sizes: dict[int, int] = field(default_factory=dict)  # [bytes]
    bytes: int = 0

    def pop(self, number: int) -> State:
        """Take a state out."""
        del self.numbers[bisect_left(self.numbers, number)]
        self.bytes -= self.sizes.pop(number)
        return self.states.pop(number)

    def least(self) -> int:
        """Return the state that is missed least: see the module."""
        # A loop over places, for this is asked at every iteration.
        numbers, now = self.numbers, self.now
        ends, before, result, cost = (*numbers[1:], max(now, numbers[-1])), 0, numbers[0], inf
        for number, after in zip(numbers, ends, strict=True):
            own = (after - before) / (abs(now - number) + 1)
            if own < cost:
                result, cost = number, own
            before = number
        return result


class KeptStates:
    """The earlier states of loops, under a bound in bytes and in number."""

    def __init__(self, limit: int, pool: Pool) -> None:
        self.limit = limit  # [bytes]
        self._pool = pool
        self._kept: dict[str, OrderedDict[str, _Kept]] = {}  # by the loop's path, then by its key

    @property
    def bytes(self) -> int:
        """Bytes held."""
        return sum(kept.bytes for kept in self._every())

    def __len__(self) -> int:
        return sum(len(kept.numbers) for kept in self._every())

    def numbers(self, path: str, key: str) -> tuple[int, ...]:
        """Return after how many iterations there are states, ascending."""
        kept = self._kept[path].get(key) if path in self._kept else None
        return tuple(kept.numbers) if kept else ()

    def latest(self, path: str, key: str, most: int) -> int:
        """Return the most iterations, up to ``most``, after which there is a state; 0 for none."""
        kept = self._kept[path].get(key) if path in self._kept else None
        index = bisect_right(kept.numbers, most) if kept else 0
        return kept.numbers[index - 1] if kept and index else 0

    def is_due(self, path: str, key: str, number: int, now: int) -> bool:
        """Return whether to keep a state after some iterations, while a loop runs on to ``now``.

        All of a short run are, for there is room. Of a longer one, a state that lies closer to the one before
        than states will that are spread evenly in the logarithm of their distance from the end would go.
        """
        share = now ** (1 / MAX_STATES) - 1 if now > MAX_STATES else 0.0
        before = self.latest(path, key, number)
        return number > before and number - before >= share * (now - number)

    def peek(self, path: str, key: str, number: int) -> State:
        """Return a state that there is; it stays."""
        return self._kept[path][key].states[number]

    def take(self, path: str, key: str, number: int) -> State:
        """Hand over a state that there is; it is the caller's."""
        return self._kept[path][key].pop(number)

    def keep(self, path: str, key: str, number: int, state: State, now: int) -> None:
        """Take over a state after some iterations; ``now`` are those that are wanted.

        What is over the bounds goes, this one perhaps.
        """
        keys = self._kept.setdefault(path, OrderedDict())
        kept = keys.setdefault(key, _Kept())
        keys.move_to_end(key)
        while len(keys) > _MAX_KEYS:
            self._release(keys.popitem(last=False)[1])
        kept.now = now
        if number in kept.states:
            self._give(kept.pop(number))
        insort(kept.numbers, number)
        kept.states[number] = state
        kept.sizes[number] = sum(result.bytes for result in state.values())
        kept.bytes += kept.sizes[number]
        if len(kept.numbers) > MAX_STATES:
            self._give(kept.pop(kept.least()))
        while self.bytes > self.limit:
            self.thin()

    def thin(self) -> bool:
        """Drop the state that is missed least, of the loop whose states are largest; False: there is none."""
        kept = max(self._every(), key=lambda each: each.bytes, default=None)
        if kept is None or not kept.numbers:
            return False
        self._give(kept.pop(kept.least()))
        return True

    def retain(self, keys: set[str]) -> None:
        """Drop the states of all other keys."""
        for kept in self._kept.values():
            for key in kept.keys() - keys:
                self._release(kept.pop(key))

    def clear(self) -> None:
        """Drop every state."""
        self.retain(set())
        self._kept.clear()

    def _every(self) -> list[_Kept]:
        return [kept for keys in self._kept.values() for kept in keys.values()]

    def _release(self, kept: _Kept) -> None:
        for state in kept.states.values():
            self._give(state)

    def _give(self, state: State) -> None:
        for result in state.values():
            self._pool.give(result)


class _Made(NamedTuple):
    """A texture that the loop itself makes, on a unit."""

    unit: int
    sampler: moderngl.Sampler
    is_before: bool  # of the iteration before, not of this one
    pass_index: int  # of the pass that makes it
    output: str


@dataclass(frozen=True, slots=True)
class _Pass:
    """What one pass binds in each iteration."""

    program: Program
    is_clocked: bool  # the time is that of the frame that the loop is at
    total: int  # iterations of the loop
    fixed: tuple[tuple[int, moderngl.Texture, moderngl.Sampler], ...]  # on units, the same in each iteration
    made: tuple[_Made, ...]
    driver: str


class Replay:
    """What runs a loop's iterations."""

    def __init__(self, kernels: Kernels, steps: Sequence[Step], passes: Sequence[_Pass]) -> None:
        self.steps = steps
        self.filling = kernels.tuning.filling  # iterations run within it
        self._kernels = kernels
        self._passes = passes

    def run(self, at: LoopIteration, before: Sequence[Result], now: Sequence[Result]) -> None:
        """Run an iteration: it reads ``before``, the results of the last, and writes ``now``, one a pass."""
        use, number = self._kernels.binder.use, at.number
        for bound_pass, target in zip(self._passes, now, strict=True):
            for unit, texture, sampler in bound_pass.fixed:
                use(unit, texture, sampler)
            for unit, sampler, is_before, index, output in bound_pass.made:
                use(unit, (before if is_before else now)[index].textures[output], sampler)
            program = bound_pass.program
            program.set("iteration", number)
            program.set("iterations", bound_pass.total)
            program.set("until", number + 1)
            if bound_pass.is_clocked and at.frame is not None:
                program.set("time", at.frame / FRAME_RATE)
            self._kernels.write(program, bound_pass.driver, target)


def replay_of(
    loop: LoopStep,
    nodes: Sequence[PlanNode],
    wired: Callable[[Source | None], Wired],
    kernels: Kernels,
    driver_for: Callable[[Step], str],
) -> Replay | None:
    """Return what runs the next iterations of a loop as the last one ran; None where they may differ.

    ``nodes`` are what each iteration computes, ``wired`` gives what is wired in the next one. They have
    just run.
    """
    steps = [node for node in nodes if isinstance(node, Step)]
    if len(loop.bodies) > 1 or len(steps) < len(nodes):
        return None
    places = {step.path: index for index, step in enumerate(steps)}
    fed = {Fed(loop.path, name): ref for name, _, ref in loop.feedback}
    passes: list[_Pass] = []
    for step in steps:
        made: dict[str, tuple[bool, int, str]] = {}
        for name, source in step.inputs:
            ref = fed.get(source, source) if isinstance(source, Fed) else source
            if isinstance(ref, Ref) and ref.path in places:
                made[name] = ref is not source, places[ref.path], ref.output
        inputs = {name: wired(source) for name, source in step.inputs}
        bound_pass = _pass_of(step, loop.total, inputs, made, kernels, driver_for(step))
        if bound_pass is None:
            return None
        passes.append(bound_pass)
    return Replay(kernels, steps, passes)


def _pass_of(
    step: Step,
    total: int,
    inputs: Mapping[str, Wired],
    made: Mapping[str, tuple[bool, int, str]],
    kernels: Kernels,
    driver: str,
) -> _Pass | None:
    """Return what a step that has just run binds, its inputs that the loop makes being ``made``."""
    kernel, binder = step.kernel, kernels.binder
    if not isinstance(kernel, TexelKernel) or not kernel.runs_once or step.repeat != 1:
        return None
    result = kernels.bound_for(step, driver, inputs)
    if result is None:
        return None
    program, bound = result
    fixed: list[tuple[int, moderngl.Texture, moderngl.Sampler]] = []
    changing: list[_Made] = []
    for declared, unit, sampler in bound.units:
        if declared.name not in made:
            fixed.append((unit, binder.wired(declared, inputs), sampler))
        elif declared.sampling.mipmap:
            return None
        else:
            changing.append(_Made(unit, sampler, *made[declared.name]))
    return _Pass(program, "time" in kernel.engine_uniforms, total, tuple(fixed), tuple(changing), driver)
