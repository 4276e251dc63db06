"""Find the camera and the sun of a sketch, for other tools' shaders that ask for them."""

from __future__ import annotations

from playground.engine.camera import unit_vector
from playground.engine.plan import Plan
from playground.shader.reserved_names import NEUTRAL
from playground.sketch.model import Draw

MEANINGS = frozenset({"camera", "light"})
"""What ``scene_of`` knows."""

_SUN = "sun"


def scene_of(plan: Plan) -> dict[str, tuple[float, ...]]:
    """Return the camera's place [m] and the unit vector towards the sun, both east, north and up.

    A sketch without a draw has no camera, one without a direction among its parameters no sun; of several
    that which is called ``sun`` counts. What there is not has a neutral value.
    """
    neutral, steps = NEUTRAL["forward"], plan.walk()
    directions = [
        (parameter.name != _SUN, step.values[parameter.name])
        for step in steps
        for parameter in step.kernel.parameters
        if parameter.widget.kind == "direction"
    ]
    sun = min(directions, key=lambda found: found[0])[1] if directions else None
    return {
        "camera": plan.eye.position if any(isinstance(s.kernel, Draw) for s in steps) else neutral,
        "light": unit_vector(sun) if isinstance(sun, tuple) else neutral,
    }
