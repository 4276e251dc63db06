"""Run a loop's iterations again as the last one ran, without working anything out anew.

Where each iteration of a loop draws the same kernels once, all that differs is the iteration's number and
which textures are read: those of the iteration before. So two sets of textures change places, what each
pass binds is written down once, and an iteration goes through that list. What does otherwise has no
``Replay`` and runs as its first iterations did: what repeats, draws or is a loop itself inside the loop, has
a size of its own in some iteration, or mipmaps of what the loop makes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from playground.engine.kernels import Kernels
from playground.engine.plan import LoopIteration, LoopStep, PlanNode, Step
from playground.engine.programs import Program
from playground.engine.results import Result, Wired
from playground.shader.expressions import FRAME_RATE
from playground.sketch.flat import Fed, Ref, Source
from playground.sketch.model import TexelKernel

if TYPE_CHECKING:
    import moderngl


class _Made(NamedTuple):
    """A texture that the loop itself makes, on a unit."""

    unit: int
    sampler: moderngl.Sampler
    is_before: bool  # of the iteration before, not of this one
    place: int  # of the pass that makes it
    output: str


@dataclass(frozen=True, slots=True)
class _Pass:
    """What one pass binds in each iteration."""

    program: Program
    is_clocked: bool  # the time is that of the frame that the loop is at
    whole: int  # iterations of the loop
    fixed: tuple[tuple[int, moderngl.Texture, moderngl.Sampler], ...]  # on units, the same in each iteration
    made: tuple[_Made, ...]
    driver: str


class Replay:
    """What runs a loop's iterations."""

    def __init__(self, kernels: Kernels, steps: Sequence[Step], passes: Sequence[_Pass]) -> None:
        self.steps = steps
        self._kernels = kernels
        self._passes = passes

    def run(self, at: LoopIteration, before: Sequence[Result], now: Sequence[Result]) -> None:
        """Run an iteration: it reads results of the one ``before`` it, and writes ``now``, one of each pass.

        It is called within the kernels' ``filling``.
        """
        use, number = self._kernels.binder.use, at.number
        for one, target in zip(self._passes, now, strict=True):
            for unit, texture, sampler in one.fixed:
                use(unit, texture, sampler)
            for unit, sampler, is_before, place, output in one.made:
                use(unit, (before if is_before else now)[place].textures[output], sampler)
            program = one.program
            program.set("iteration", number)
            program.set("iterations", one.whole)
            program.set("until", number + 1)
            if one.is_clocked and at.frame is not None:
                program.set("time", at.frame / FRAME_RATE)
            self._kernels.write(program, one.driver, target)


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
    places = {step.path: place for place, step in enumerate(steps)}
    fed = {Fed(loop.path, name): ref for name, _, ref in loop.feedback}
    passes: list[_Pass] = []
    for step in steps:
        made: dict[str, tuple[bool, int, str]] = {}
        for name, source in step.inputs:
            ref = fed.get(source, source) if isinstance(source, Fed) else source
            if isinstance(ref, Ref) and ref.path in places:
                made[name] = ref is not source, places[ref.path], ref.output
        inputs = {name: wired(source) for name, source in step.inputs}
        found = _pass_of(step, loop.whole, inputs, made, kernels, driver_for(step))
        if found is None:
            return None
        passes.append(found)
    return Replay(kernels, steps, passes)


def _pass_of(
    step: Step,
    whole: int,
    inputs: Mapping[str, Wired],
    made: Mapping[str, tuple[bool, int, str]],
    kernels: Kernels,
    driver: str,
) -> _Pass | None:
    """Return what a step that has just run binds, its inputs that the loop makes being ``made``."""
    kernel, binder = step.kernel, kernels.binder
    if not isinstance(kernel, TexelKernel) or not kernel.runs_once or step.repeat != 1:
        return None
    found = kernels.bound_for(step, driver, inputs)
    if found is None:
        return None
    program, bound = found
    fixed: list[tuple[int, moderngl.Texture, moderngl.Sampler]] = []
    changing: list[_Made] = []
    for declared, unit, sampler in bound.units:
        if declared.name not in made:
            fixed.append((unit, binder.wired(declared, inputs), sampler))
        elif declared.sampling.mipmap:
            return None
        else:
            changing.append(_Made(unit, sampler, *made[declared.name]))
    return _Pass(program, "time" in kernel.given, whole, tuple(fixed), tuple(changing), driver)
