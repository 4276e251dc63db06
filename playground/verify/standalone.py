"""Build a sketch of one technique alone, with placeholders for what it reads.

Nothing else is in it, so that a mistake elsewhere cannot pass for one of the technique's own.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from playground.data.values import write_values
from playground.engine.draws import counts_instances
from playground.engine.on_arrays import shown_alone, text_of
from playground.shader.own_shaders import own_shader
from playground.sketch.assign import values_of
from playground.sketch.model import (
    Draw,
    Kernel,
    Output,
    Parameter,
    PassSpec,
    Sketch,
    Technique,
    TexelKernel,
    kernels_of,
)

SEED = "seed"
"""The placeholders' parameter: which terrain."""


def standalone_sketch(
    technique: Technique, subject: str, folder: Path, picture: Path, *, seed: int = 0
) -> Sketch:
    """Return a sketch that shows a technique, its pass named ``subject``, its inputs wired to placeholders.

    ``folder`` is where its files are; ``picture`` is the file of parameters that name none.
    """
    inputs = technique.needs_inputs if isinstance(technique, Kernel) else [e.name for e in technique.inputs]
    line = technique.pragma.number if isinstance(technique, Kernel) and technique.pragma else 0
    over = technique.over if isinstance(technique, Draw) else ""
    passes = [
        PassSpec(name, "a placeholder", _DRAWN)
        if name == over
        else PassSpec(name, "a placeholder", _COUNT)
        if counts_instances(technique, name)
        else PassSpec(name, "a placeholder", _TERRAIN, values=((SEED, seed),))
        for name in inputs
    ]
    return with_pictures(shown_alone(technique, subject, passes, folder, line), picture)


def with_pictures(sketch: Sketch, picture: Path) -> Sketch:
    """Return a sketch whose files that nothing names are a picture, made where it is not there yet."""
    unnamed = _unnamed_files(sketch)
    if unnamed and not picture.exists():
        ramp = np.linspace(0.0, 1.0, 33, dtype=np.float32)
        write_values(picture, np.sqrt(np.outer(ramp, ramp)))
    return sketch.with_values({path: str(picture) for path in unnamed})


def _unnamed_files(sketch: Sketch) -> list[str]:
    values = values_of(sketch)
    return [
        f"{path}.{parameter.name}"
        for path, kernel in kernels_of(sketch.graph)
        for parameter in kernel.parameters
        if parameter.widget.kind == "file" and not values[f"{path}.{parameter.name}"]
    ]


_TERRAIN = TexelKernel(
    name="a placeholder",
    source=text_of(own_shader("placeholder_terrain.glsl")),
    outputs=(Output("value", "rgba32f"),),
    parameters=(Parameter(SEED, "uint", 0),),
)
_DRAWN = Draw(
    name="a placeholder",
    source=text_of(own_shader("placeholder_draw.glsl")),
    outputs=(Output("value", "rgba32f"),),
    mesh="sheet",
    samples=1,
)
_COUNT = TexelKernel(
    name="a placeholder",
    source=text_of(own_shader("placeholder_count.glsl")),
    outputs=(Output("value", "rgba32f"),),
)
