"""Choose what is written otherwise in the text of a step because a software renderer is quicker so."""

from __future__ import annotations

from collections.abc import Mapping

from playground.engine.binder import are_of_own_size
from playground.engine.plan import Step
from playground.engine.results import Wired
from playground.gpu.choices import has_quick_fetches, may_have_own_size, may_have_place
from playground.gpu.wrap import FRAGMENT
from playground.sketch.reserved_names import NEAREST, OWN_SIZE, PLACE


def quicker_texts(step: Step, inputs: Mapping[str, Wired], driver: str) -> list[str]:
    """Return the choices for a step: see ``gpu.choices.QUICKER``. None changes what it computes."""
    kernel = step.kernel
    found: list[str] = []
    is_whole = step.window is None and step.size == step.whole_size
    if has_quick_fetches(kernel):
        found.append(NEAREST)
    if is_whole and may_have_own_size(kernel) and are_of_own_size(step, inputs):
        found.append(OWN_SIZE)
    if is_whole and driver == FRAGMENT and may_have_place(kernel):
        found.append(PLACE)
    return found
