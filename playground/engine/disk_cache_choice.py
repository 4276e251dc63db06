"""Choose what a frame takes from the disk cache, and what is worth caching there.

The camera, the window's size and the time change a sketch's last passes all the time; what
they read of the terrain stays. Where that meets is the frontier: of the passes that stay, those
that are read by one that does not. A reopened sketch takes the frontier from the disk, and
the passes behind it are not run at all.

Of a pass that stays, two times are compared: what it took to compute, with what it depends on computed
or read, and what it would take to read it. It is read where that saves enough.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType

from playground.engine.cache import Cached
from playground.engine.cache_keys import Keys
from playground.engine.plan import (
    LoopStep,
    Plan,
    PlanNode,
    Step,
    every_node,
    needed,
    sources_of,
    walk,
)
from playground.engine.results import Result
from playground.engine.textures import bytes_of
from playground.memo import PLANS, Memo
from playground.shader.expressions import follows_time
from playground.shader.reserved_names import OF_THE_TERRAIN
from playground.sketch.flat import Ref
from playground.sketch.model import PlainShader

_PASSING = ("time", "clip_from_world", "world_from_clip", "eye")  # given names that change while one looks


def passing(plan: Plan, painted: Collection[Path] = ()) -> frozenset[str]:
    """Return the paths of the steps and loops of a plan that are never cached on disk.

    What reads the time, the camera or the mouse, has a texel for each pixel of the picture, is
    stopped before its last iteration or gone on from by a later draw, or reads a file that is
    ``painted`` in this process, which no other one knows by its version; and each that reads such a one.
    """
    return _passing(plan.nodes, plan.frame_size, plan.continued, frozenset(painted))


@PLANS.cached(identities=1)
def _passing(
    nodes: tuple[PlanNode, ...],
    frame_size: tuple[int, int],
    continued: frozenset[str],
    painted: frozenset[Path],
) -> frozenset[str]:
    """Return what ``passing`` does, worked out once for the frames that have the same passes."""
    found: set[str] = set()
    for node in nodes:
        reads = {source.path for source in sources_of(node) if isinstance(source, Ref)}
        steps = list(walk((node,)))
        loops = [loop for loop in every_node((node,)) if isinstance(loop, LoopStep)]
        own = any(_passes(step, frame_size, continued) or _reads_one(step, painted) for step in steps)
        if own or reads & found or any(_stops(loop) for loop in loops):
            found |= {node.path, *(step.path for step in steps)}
    return frozenset(found)


def _reads_one(step: Step, files: Collection[Path]) -> bool:
    named = (step.values[p.name] for p in step.kernel.parameters if p.widget.kind == "file")
    return bool(files) and any(Path(str(value)) in files for value in named)


def _stops(loop: LoopStep) -> bool:
    return follows_time(loop.spec.repeat) or loop.repeat != loop.whole


def _passes(step: Step, frame_size: tuple[int, int], continued: Collection[str]) -> bool:
    kernel = step.kernel
    if (
        isinstance(kernel, PlainShader)
        or not set(kernel.depends) <= set(OF_THE_TERRAIN)
        or step.path in continued
        or step.window is not None
    ):
        return True
    if step.size == frame_size or step.repeat != step.whole:
        return True
    if follows_time(kernel.repeat):
        return True
    return any(kernel.reads(name) for name in _PASSING)


@dataclass(frozen=True)
class Chosen:
    """How a frame is made."""

    nodes: list[PlanNode]  # to be run, in order
    taken: dict[str, Result]  # by the step's path: cached in memory, or read
    skipped: frozenset[str]  # steps that are neither, since nothing that runs reads them


def choose(
    keys: Keys,
    nodes: Iterable[PlanNode],
    ref: Ref,
    held: Callable[[str], Cached | None],
    read: Callable[[Step], bool],
    *,
    skips: bool,
) -> Chosen:
    """Choose how to make a texture; ``nodes`` are what it needs, in order.

    ``held(key)`` is what is cached in memory. ``read(step)`` puts a step's textures there from the disk
    cache, and says whether it could. ``skips``: what nothing that runs reads is left out.
    """
    known = list(nodes)
    wanted = {ref.path} if skips else {step.path for step in walk(tuple(known))}
    run: list[PlanNode] = []
    taken: dict[str, Result] = {}
    skipped: set[str] = set()
    for node in reversed(known):
        here = _in_memory(node, keys, held)
        if here is None:
            inside = {step.path: step for step in walk((node,))}
            # Of a loop that was read, each step that others read is cached by itself.
            missing = [
                step for path, step in inside.items() if path in wanted and not held(keys.result(path))
            ]
            if all(read(step) for step in missing):
                here = {path: found for path in inside if (found := _alone(held(keys.result(path))))}
                skipped |= inside.keys() - here.keys() - {step.path for step in missing}
        if here is not None:
            taken |= here
            continue
        run.append(node)
        wanted |= {source.path for source in sources_of(node) if isinstance(source, Ref)}
    return Chosen(run[::-1], taken, frozenset(skipped))


def _in_memory(node: PlanNode, keys: Keys, held: Callable[[str], Cached | None]) -> dict[str, Result] | None:
    """Return what is cached in memory of a node, by the step's path; None where it has to be run, or read."""
    if isinstance(node, Step):
        found = _alone(held(keys.result(node.path)))
        return None if found is None else {node.path: found}
    cached = held(keys.loops[node.path])
    if cached is None or cached.iterations != node.repeat or not cached.results:
        return None
    together = dict(cached.results)
    for inside in every_node(node.body):
        if not keys.changes[id(inside)]:
            together |= _in_memory(inside, keys, held) or {}
    return together


def _alone(cached: Cached | None) -> Result | None:
    return None if cached is None else next(iter(cached.results.values()), None)


# ── what is worth caching ────────────────────────────────────────────────────


@dataclass(frozen=True)
class Worth:
    """A step whose textures are worth caching on disk."""

    path: str
    key: str
    cost: float  # [ms] that it took to make, with all that it reads


def worth_caching(
    plan: Plan,
    keys: Keys,
    ref: Ref,
    passes: frozenset[str],
    costs: Memo[str, float],
    read_time: Callable[[int], float],
    floor: float,
    more: Mapping[str, float] = MappingProxyType({}),
) -> list[Worth]:
    """Return the steps of a texture's frame that are worth caching: those of the frontier that cost enough.

    ``passes``: as ``passing`` returns them. ``costs`` [ms] of what ran, by the key of the step or the
    loop; ``read_time(bytes)`` [ms]. To read must save at least ``floor`` [ms].
    ``more`` [ms] is what else steps cost that are computed in another process, by path.
    """
    nodes = needed(plan.nodes, ref)
    home = {step.path: number for number, node in enumerate(nodes) for step in walk((node,))}
    sources = [_sources(node, number, home) for number, node in enumerate(nodes)]
    others = {ref.path}.union(*sources)
    steps = {step.path: step for step in walk(tuple(nodes))}
    to_read = {path: read_time(bytes_in(step)) for path, step in steps.items()}
    # What must be run or read to have a node by running it, each with its time, by what and which.
    ways: list[dict[tuple[bool, str], float]] = []
    wholes: list[dict[str, float]] = []  # what was run for a node, nothing read, each with its time
    is_read: list[bool] = []
    for number, node in enumerate(nodes):
        key = keys.loops[node.path] if isinstance(node, LoopStep) else keys.result(node.path)
        whole = {key: costs.get(key, 0.0)}
        way = {(True, key): whole[key] + max(more.get(step.path, 0.0) for step in walk((node,)))}
        for path in sources[number]:
            before = home[path]
            whole |= wholes[before]
            way |= {(False, path): to_read[path]} if is_read[before] else ways[before]
        ways.append(way)
        wholes.append(whole)
        mine = sum(to_read[step.path] for step in walk((node,)) if step.path in others)
        stays = not any(step.path in passes for step in walk((node,)))
        is_read.append(stays and sum(way.values()) - mine >= floor)
    found: list[Worth] = []
    wanted = {ref.path}
    for number in reversed(range(len(nodes))):
        read_here = [step.path for step in walk((nodes[number],)) if step.path in wanted]
        if read_here and is_read[number]:
            cost = sum(wholes[number].values())
            found += [Worth(path, keys.result(path), cost) for path in read_here]
        elif read_here:
            wanted |= sources[number]
    return found[::-1]


def bytes_in(step: Step) -> int:
    """Return the bytes of a step's textures."""
    return sum(bytes_of(step.size, output.format) for output in step.kernel.outputs)


def _sources(node: PlanNode, number: int, home: Mapping[str, int]) -> set[str]:
    """Return the steps of other nodes that a node reads."""
    read = {source.path for source in sources_of(node) if isinstance(source, Ref)}
    return {path for path in read if home[path] != number}
