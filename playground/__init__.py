"""A ModernGL shader playground for terrain.

    import playground

    sketch = playground.load("jacksboro")                    # a shipped sketch, or a path
    with playground.headless() as engine:                    # EGL: no display, no GPU needed
        frame = engine.render(sketch, size=(1280, 720))      # shows itself in a notebook
        frame.save("terrain.png")
        height = engine.read(sketch, "height")               # float32, row 0 in the south
        evening = sketch.with_values({"light.sun": (250.0, 12.0)})
        square = playground.load("diamond_square")
        for step, values in engine.steps(square, "height"):  # a repeated kernel, step by step
            ...

A sketch is a frozen value; setting a parameter makes a new one. Importing this opens
nothing: each name below is imported when it is first used.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from playground._version import __version__

if TYPE_CHECKING:  # the same once more, for tools that read types and run nothing
    from playground.api import headless as headless
    from playground.api import parameters as parameters
    from playground.api import render as render
    from playground.api import trace as trace
    from playground.engine.engine import Engine as Engine
    from playground.engine.frame import Frame as Frame
    from playground.engine.trace.model import Trace as Trace
    from playground.errors import ContextError as ContextError
    from playground.errors import DataError as DataError
    from playground.errors import ParameterError as ParameterError
    from playground.errors import PlainFormWarning as PlainFormWarning
    from playground.errors import PlaygroundError as PlaygroundError
    from playground.errors import PlaygroundWarning as PlaygroundWarning
    from playground.errors import SandboxCrash as SandboxCrash
    from playground.errors import SandboxError as SandboxError
    from playground.errors import SandboxTimeout as SandboxTimeout
    from playground.errors import ShaderError as ShaderError
    from playground.errors import SketchError as SketchError
    from playground.publish.export import export as export
    from playground.publish.large import write_large as write_large
    from playground.publish.notebook.show import compare as compare
    from playground.publish.notebook.show import widget as widget
    from playground.publish.series import render_sequence as render_sequence
    from playground.publish.series import render_sweep as render_sweep
    from playground.publish.sweep_data import sweep as sweep
    from playground.publish.video import render_video as render_video
    from playground.shader.parameter import Parameter as Parameter
    from playground.sketch.find import shipped_sketches as shipped_sketches
    from playground.sketch.load import load as load
    from playground.sketch.model import Camera as Camera
    from playground.sketch.model import Shot as Shot
    from playground.sketch.model import Sketch as Sketch
    from playground.sketch.techniques import shipped_techniques as shipped_techniques

_NAMES = {
    "playground.api": "headless render parameters trace",
    "playground.publish.export": "export",
    "playground.publish.large": "write_large",
    "playground.publish.series": "render_sequence render_sweep",
    "playground.publish.sweep_data": "sweep",
    "playground.publish.video": "render_video",
    "playground.engine.engine": "Engine",
    "playground.engine.frame": "Frame",
    "playground.engine.trace.model": "Trace",
    "playground.errors": "ContextError DataError ParameterError PlainFormWarning PlaygroundError "
    "PlaygroundWarning SandboxCrash SandboxError SandboxTimeout ShaderError SketchError",
    "playground.publish.notebook.show": "compare widget",
    "playground.sketch.find": "shipped_sketches",
    "playground.sketch.load": "load",
    "playground.sketch.model": "Camera Shot Sketch",
    "playground.shader.parameter": "Parameter",
    "playground.sketch.techniques": "shipped_techniques",
}
_HERE = {path.stem for path in Path(__file__).parent.iterdir()}  # a room may have been removed (rooms.py)
_HOMES = {
    name: home for home, names in _NAMES.items() if home.split(".")[1] in _HERE for name in names.split()
}

__all__ = [*_HOMES, "__version__"]


def __getattr__(name: str) -> object:
    import importlib

    if name in _HOMES:
        return getattr(importlib.import_module(_HOMES[name]), name)
    raise AttributeError(f"module 'playground' has no attribute '{name}'")


def __dir__() -> list[str]:
    return __all__
