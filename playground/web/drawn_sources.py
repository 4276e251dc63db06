"""Draw what a source with inputs makes, on a context of its own: a page has no other way to its texels."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Step
from playground.gpu.context import open_context
from playground.sketch.model import Sketch


def drawn(
    sketch: Sketch, step: Step, *, frame: tuple[int, int], time: float, steps: Mapping[str, int]
) -> dict[str, NDArray[Any]]:
    """Return the texels of a source, by its outputs' names; raises as ``Engine.read`` does."""
    with Engine(open_context(), owns_context=True, notice=silent) as engine:
        at: dict[str, Any] = {"size": frame, "time": time, "steps": steps}
        return {o.name: engine.read(sketch, f"{step.path}:{o.name}", **at) for o in step.kernel.outputs}
