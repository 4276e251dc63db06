"""Choose how a software renderer reads texels sooner in the text of a step."""

from __future__ import annotations

from collections.abc import Mapping

from playground.engine.binder import are_of_own_size
from playground.engine.plan import Step
from playground.engine.results import Wired
from playground.gpu.nearest_texels import reads_nearest
from playground.sketch.reserved_names import LEVEL_0, OWN_SIZE, PLACE


def quicker_reads(step: Step, inputs: Mapping[str, Wired]) -> list[str]:
    """Return what a kernel's text is compiled with by the fragment driver: see ``gpu.quicker``."""
    found: list[str] = []
    if reads_nearest(step.kernel):
        found += [LEVEL_0, OWN_SIZE] if are_of_own_size(step, inputs) else [LEVEL_0]
    if step.window is None and step.size == step.whole_size and not step.kernel.stride:
        found.append(PLACE)
    return found
