"""A ModernGL shader playground for terrain.

    import playground

    sketch = playground.load("jacksboro")                    # a shipped sketch, or a path
    with playground.headless() as engine:                    # EGL: no display, no GPU needed
        frame = engine.render(sketch, size=(1280, 720))      # shows itself in a notebook
        frame.save("land.png")
        height = engine.read(sketch, "height")               # float32, row 0 in the south
        evening = sketch.with_values({"light.sun": (250.0, 12.0)})
        for turn, values in engine.steps(other, "height"):   # a repeated kernel, turn by turn
            ...

A sketch is a frozen value; setting a parameter makes a new one. Importing this opens
nothing: each name below is imported when it is first used.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground._version import __version__

if TYPE_CHECKING:
    from playground.api import headless, parameters, render
    from playground.engine.engine import Engine
    from playground.engine.frame import Frame
    from playground.errors import (
        ContextError,
        DataError,
        ParameterError,
        PlaygroundError,
        ShaderError,
        SketchError,
        TrialCrash,
        TrialError,
        TrialTimeout,
    )
    from playground.sketch.load import load, shipped_sketches, shipped_techniques
    from playground.sketch.model import Camera, Parameter, Shot, Sketch

_HOMES = {
    "headless": "playground.api",
    "render": "playground.api",
    "parameters": "playground.api",
    "Engine": "playground.engine.engine",
    "Frame": "playground.engine.frame",
    "load": "playground.sketch.load",
    "shipped_sketches": "playground.sketch.load",
    "shipped_techniques": "playground.sketch.load",
    "Camera": "playground.sketch.model",
    "Parameter": "playground.sketch.model",
    "Shot": "playground.sketch.model",
    "Sketch": "playground.sketch.model",
    "PlaygroundError": "playground.errors",
    "SketchError": "playground.errors",
    "ParameterError": "playground.errors",
    "ShaderError": "playground.errors",
    "DataError": "playground.errors",
    "ContextError": "playground.errors",
    "TrialError": "playground.errors",
    "TrialTimeout": "playground.errors",
    "TrialCrash": "playground.errors",
}

__all__ = [
    "Camera",
    "ContextError",
    "DataError",
    "Engine",
    "Frame",
    "Parameter",
    "ParameterError",
    "PlaygroundError",
    "ShaderError",
    "Shot",
    "Sketch",
    "SketchError",
    "TrialCrash",
    "TrialError",
    "TrialTimeout",
    "__version__",
    "headless",
    "load",
    "parameters",
    "render",
    "shipped_sketches",
    "shipped_techniques",
]


def __getattr__(name: str) -> object:
    if name in _HOMES:
        import importlib

        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'playground' has no attribute '{name}'")


def __dir__() -> list[str]:
    return __all__
