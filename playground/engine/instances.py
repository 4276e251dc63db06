"""Work out how often a draw draws its mesh, where a texture may say so.

OpenGL 3.3 and WebGL2 take no counts from textures, so the texel that an expression names is read back
from the graphics card, once each time that it is computed: what depends on it waits for it there.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING
from weakref import WeakKeyDictionary

import numpy as np

from playground.engine.kernels import Job
from playground.engine.lod import CHOOSERS
from playground.engine.results import Result, Wired
from playground.shader import expressions
from playground.shader.expressions import ExpressionError, Number
from playground.sketch.model import Draw, Kernel, Technique

if TYPE_CHECKING:
    import moderngl

MOST = 2**20
"""Instances that one draw may have."""
_COMPONENTS = "xyzw"


class Texels:
    """The first texels of results: those in the south-west corner, each read once."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._known: WeakKeyDictionary[Result, dict[str, tuple[float, ...]]] = WeakKeyDictionary()

    def of(self, result: Result, output: str) -> tuple[float, ...]:
        """Return the components of the first texel of an output."""
        known = self._known.setdefault(result, {})
        if output not in known:
            known[output] = self._read(result, output)
        return known[output]

    def _read(self, result: Result, output: str) -> tuple[float, ...]:
        index = [each.name for each in result.outputs].index(output)
        parts = result.outputs[index].components
        read = result.framebuffer(self.ctx).read(
            (0, 0, 1, 1), parts, attachment=index, alignment=1, dtype="f4"
        )
        return tuple(np.frombuffer(read, np.float32).tolist())


def instances_of(job: Job, texels: Texels) -> int:
    """Return how often a step's mesh is drawn; 1 where its header does not say.

    Raises ``SketchError`` where that is not a whole number from 0 to ``MOST``.
    """
    step, kernel = job.step, job.step.kernel
    if not isinstance(kernel, Draw) or not kernel.instances:
        return 1
    if kernel.mesh in CHOOSERS:
        mesh = f"mesh '{kernel.mesh}' is drawn once for each of its tiles"
        raise kernel.error(f"{mesh}; it takes no instances")
    numbers = job.numbers()

    def number(name: str) -> Number:
        return numbers[name] if name in numbers else _component(job, name, texels)

    try:
        found = expressions.evaluate(kernel.instances, number)
    except ExpressionError as error:
        raise step.spec.error(f"pass '{step.path}': instances {error}") from None
    if not 0 <= found <= MOST:
        raise step.spec.error(f"pass '{step.path}': instances = {found}; 0 to {MOST} were expected")
    return found


def counts_instances(technique: Technique, name: str) -> bool:
    """Return whether the first texel of an input of a technique says how often a draw in it is drawn."""
    if isinstance(technique, Kernel):
        if not isinstance(technique, Draw):
            return False
        named = (read.rpartition(".") for read in expressions.names_in(technique.instances or "0"))
        return any(declared == name and component in _COMPONENTS for declared, _, component in named)
    targets = (
        target.partition(".") for each in technique.inputs if each.name == name for target in each.targets
    )
    inside = ((technique.find(head), rest) for head, _, rest in targets)
    return any(spec is not None and counts_instances(spec.technique, rest) for spec, rest in inside)


def _component(job: Job, name: str, texels: Texels) -> Number:
    """Return a component of an input's first texel, of a name as ``list.x``."""
    declared, _, component = name.partition(".")
    wired, step = job.inputs.get(declared, Wired()), job.step
    if wired.result is None:
        raise ExpressionError(f"names '{declared}', to which nothing is wired")
    found = texels.of(wired.result, wired.output)
    index = _COMPONENTS.index(component)
    if index >= len(found):
        form = next(o.format for o in wired.result.outputs if o.name == wired.output)
        raise ExpressionError(f"names '{name}': '{declared}' has no component {component}; it is {form}")
    if not math.isfinite(found[index]):
        raise step.spec.error(
            f"pass '{step.path}': instances: '{declared}' holds {found[index]}; a number was expected"
        )
    return int(found[index]) if found[index].is_integer() else found[index]
