"""Choose what is written otherwise in the text of a step because a software renderer is quicker so."""

from __future__ import annotations

from collections.abc import Mapping

from playground.engine.binder import are_of_own_size
from playground.engine.choices import quicker_choices
from playground.engine.plan import Step
from playground.engine.results import Wired
from playground.shader.reserved_names import OWN_SIZE, PLACE
from playground.shader.wrap import FRAGMENT


def quicker_texts(step: Step, inputs: Mapping[str, Wired], driver: str) -> list[str]:
    """Return the choices for a step: see ``gpu.choices.QUICKER``. None changes what it computes."""
    found = quicker_choices(step.kernel)
    if found and (step.window is not None or step.size != step.whole_size):
        found -= {OWN_SIZE, PLACE}
    if PLACE in found and driver != FRAGMENT:
        found -= {PLACE}
    if OWN_SIZE in found and not are_of_own_size(step, inputs):
        found -= {OWN_SIZE}
    return sorted(found)
