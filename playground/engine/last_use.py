"""Tell after which pass of a frame a texture is read no more, for a frame that no other will follow."""

from __future__ import annotations

from collections.abc import Sequence

from playground.engine.cache_keys import Keys
from playground.engine.plan import LoopStep, Plan, PlanNode, Step, sources_of, walk
from playground.sketch.flat import Ref
from playground.sketch.model import Draw


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
    found: dict[str, list[Step]] = {}
    for path, step in last.values():
        found.setdefault(path, []).append(step)
    return found


def _read(node: PlanNode) -> set[str]:
    versions = [inside for body in node.bodies for inside in walk(body)] if isinstance(node, LoopStep) else []
    every = [node, *versions]
    return {source.path for one in every for source in sources_of(one) if isinstance(source, Ref)}
