"""Draw a shader of another tool, and say what its sketch has."""

from __future__ import annotations

import numpy as np

from playground.engine.plan import PlanRequest
from playground.engine.plan_warnings import source_warnings
from playground.engine.planner import make_plan
from playground.sketch.load import load
from playground.sketch.model import ForeignShader, Sketch, kernels_of
from playground.sketch.warnings import warnings_of_sketch

SIZE = (32, 18)


def drawn(engine, sketch, time=0.0, size=SIZE, **values):
    """Return a picture of a sketch or a file, with values by path."""
    sketch = sketch if isinstance(sketch, Sketch) else load(sketch)
    return engine.render(sketch.with_values(values), size=size, time=time).array


def first_texel(engine, sketch, time=0.0, size=(4, 4), **values):
    """Return the four channels at the north-west."""
    return drawn(engine, sketch, time, size, **values)[0, 0].astype(int)


def colours(picture):
    """Return the number of colours."""
    return len(np.unique(picture[..., :3].reshape(-1, 3), axis=0))


def shader_of(path):
    """Return the technique that a file is."""
    return load(path).graph.find("view").technique


def kernels(path):
    """Return the kernels of another tool that a file becomes."""
    return [kernel for _, kernel in kernels_of(shader_of(path)) if isinstance(kernel, ForeignShader)]


def notes(sketch, size=SIZE):
    """Return the warnings of a sketch and of its sources."""
    plan = make_plan(sketch, PlanRequest(frame_size=size))
    return [*warnings_of_sketch(sketch), *source_warnings(plan)]


def ramp(size=SIZE):
    """Return the place of each pixel, from 0 to 1, east and north, north on top."""
    width, height = size
    return np.dstack(np.meshgrid((np.arange(width) + 0.5) / width, (np.arange(height)[::-1] + 0.5) / height))
