"""The ground that a painted change is added to: what the pass that reads the change has as its height."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.engine.plan import Plan
from playground.sketch.flat import Ref
from playground.workbench.session import Session


def ground_ref(plan: Plan, step: str) -> Ref | None:
    """Return the height under what a step gives, by its path; None: it changes no height.

    It is that of the pass that reads the step, before the change: its input ``height``.
    """
    for reader in plan.walk():
        inputs = dict(reader.inputs)
        height = inputs.get("height")
        reads = any(isinstance(source, Ref) and source.path == step for source in inputs.values())
        if reads and isinstance(height, Ref) and height.path != step:
            return height
    return None


def ground_of(session: Session, step: str) -> NDArray[np.float32] | None:
    """Return the heights (ny, nx) [m] under what a step gives; None: it changes no height."""
    plan = session.plan
    ref = ground_ref(plan, step) if plan is not None else None
    if plan is None or ref is None or plan.terrain.relief is None:
        return None
    values = session.read_values(str(ref))
    return None if values is None else values * np.float32(plan.terrain.relief)
