"""Build a sketch of one technique alone, with placeholders for what it reads.

Nothing else is in it, so that a mistake elsewhere cannot pass for one of the technique's own.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from playground.data.values import write_values
from playground.engine.draws import counts_instances
from playground.paths import shown
from playground.shader.own_shaders import own_shader
from playground.shader.source import Line, SourceText
from playground.sketch.assign import values_of
from playground.sketch.model import (
    Draw,
    Graph,
    Input,
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


def shown_alone(
    technique: Technique, subject: str, passes: Iterable[PassSpec], folder: Path, line: int = 0
) -> Sketch:
    """Return a sketch of some passes and one, named ``subject``, of a technique, which it shows.

    ``folder`` is where its files are, ``line`` that of the technique's file that errors name.
    """
    own = PassSpec(subject, subject, technique, file=shown(technique.path), line=line)
    view = PassSpec("view", "a copy", _COPY, inputs=(("shown", subject),))
    graph = Graph(subject, technique.path, (*passes, own, view))
    return Sketch(Path(technique.path).stem, technique.path, str(folder), graph)


def with_pictures(sketch: Sketch, picture: Path) -> Sketch:
    """Return a sketch whose files that nothing names are a picture, made where it is not there yet."""
    unnamed = _unnamed_files(sketch)
    if unnamed and not picture.exists():
        ramp = np.linspace(0.0, 1.0, 33, dtype=np.float32)
        write_values(picture, np.sqrt(np.outer(ramp, ramp)))
    return sketch.with_values({path: str(picture) for path in unnamed})


def free_name(name: str, technique: Technique) -> str:
    """Return a name for the pass of a technique that none of its inputs has."""
    taken = {declared.name for declared in technique.inputs} | {"view"}
    while name in taken:
        name += "_"
    return name


def _unnamed_files(sketch: Sketch) -> list[str]:
    values = values_of(sketch)
    return [
        f"{path}.{parameter.name}"
        for path, kernel in kernels_of(sketch.graph)
        for parameter in kernel.parameters
        if parameter.widget.kind == "file" and not values[f"{path}.{parameter.name}"]
    ]


def text_of(code: str) -> SourceText:
    """Return code that is in no file as a kernel's text."""
    lines = code.strip().split("\n")
    return SourceText("", tuple(Line(line, line, "", "", number) for number, line in enumerate(lines, 1)))


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
_COPY = TexelKernel(
    name="a copy",
    source=text_of(own_shader("placeholder_view.glsl")),
    outputs=(Output("frame", "rgba16f"),),
    inputs=(Input("shown"),),
)
