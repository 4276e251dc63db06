"""Draw what a source with inputs makes: a page has no other way to its texels."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from typing import Any

from numpy.typing import NDArray

from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.plan import Step
from playground.gpu.context import open_context
from playground.sketch.model import Sketch


def drawn(
    engine: Engine | None,
    sketch: Sketch,
    step: Step,
    *,
    frame: tuple[int, int],
    time: float,
    steps: Mapping[str, int],
) -> dict[str, NDArray[Any]]:
    """Return the texels of a source, by its outputs' names; raises as ``Engine.read`` does.

    Without an engine one is opened, on a context of its own.
    """
    at: dict[str, Any] = {"size": frame, "time": time, "steps": steps}
    with nullcontext(engine) if engine is not None else _opened() as used:
        return {o.name: used.read(sketch, f"{step.path}:{o.name}", **at) for o in step.kernel.outputs}


def _opened() -> Engine:
    return Engine(open_context(), owns_context=True, notice=silent)
