"""A sketch that shows one of its textures as a map from above, instead of its own view."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, ClassVar

from playground.paths import GLSL
from playground.shader.kernel import Export
from playground.sketch.flat import Flat
from playground.sketch.model import Graph, Kernel, PassSpec, Sketch, Value
from playground.sketch.techniques import read_technique
from playground.sketch.wiring import input_names

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

USE = "view/map"
_INNER = "seen"  # the name of the view inside the one that shows a texture of it


@dataclass(frozen=True)
class Map:
    """One texture of a sketch, and how it is shown from above."""

    ref: str  # "pass[.inner…]:output"
    values: tuple[tuple[str, Value], ...] = ()  # of view/map's parameters
    kernel: Kernel = field(default_factory=lambda: map_kernel(), compare=False)
    is_remembered: ClassVar[bool] = True  # the next window shows it as well

    @property
    def private_refs(self) -> tuple[str, ...]:
        """Textures that are there for this map alone, so that no other can show them."""
        return ()

    def base_of(self, sketch: Sketch) -> Sketch:
        """Return the sketch that has the texture."""
        return sketch

    def can_show(self, sketch: Sketch) -> bool | None:
        """Return whether a sketch has the texture; None where its plan says so."""
        return None

    def own_numbers(self, values: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return what of the texture's values, (ny, nx) or (ny, nx, components), its range is fitted to."""
        return values

    def of(self, sketch: Sketch) -> Sketch:
        """Return the sketch with this map for its view."""
        sketch = self.base_of(sketch)
        view = sketch.graph.find("view")
        if re.match(r"view\b", self.ref) and view is not None:
            return _within(sketch, view, self)
        spec = PassSpec("view", USE, self.kernel, inputs=(("shown", self.ref),), values=self.values)
        passes = (*(p for p in sketch.graph.passes if p.name != "view"), spec)
        return with_other_view(sketch, replace(sketch.graph, passes=passes))

    def own_path(self, path: str) -> str:
        """Return the sketch's own path of a pass that ran for this map; "" for the map's."""
        if path.partition(".")[0] != "view":
            return path
        inside = f"view.{_INNER}"
        return f"view{path.removeprefix(inside)}" if path.startswith(inside) else ""

    def with_value(self, name: str, value: Value) -> Map:
        """Return the map with one of its parameters set."""
        return replace(self, values=(*(v for v in self.values if v[0] != name), (name, value)))

    def value(self, name: str) -> Value:
        """Return the value of one of its parameters."""
        values = dict(self.values)
        parameter = self.kernel.parameter(name)
        return values[name] if name in values or parameter is None else parameter.default


def _within(sketch: Sketch, view: PassSpec, shown: Map) -> Sketch:
    """Return a sketch whose view is its own one, and after it a map of a texture in that.

    Both are passes of the view, so that each has the size that it has there.
    """
    names = dict.fromkeys((*input_names(view.technique), *(n for n, _ in view.inputs if "." not in n)))
    inputs = tuple((f"{_INNER}.{name}" if "." in name else name, ref) for name, ref in view.inputs)
    own = replace(view, name=_INNER, inputs=())
    of = PassSpec(
        "map", USE, shown.kernel, inputs=(("shown", f"{_INNER}{shown.ref[4:]}"),), values=shown.values
    )
    exports = tuple(Export(name, (f"{_INNER}.{name}",)) for name in names)
    both = Graph(USE, view.technique.path, (own, of), inputs=exports)
    spec = replace(view, use=USE, technique=both, inputs=inputs, values=())
    passes = tuple(spec if p.name == "view" else p for p in sketch.graph.passes)
    return with_other_view(sketch, replace(sketch.graph, passes=passes), f"view.{_INNER}.")


def with_other_view(sketch: Sketch, graph: Graph, inner: str = "") -> Sketch:
    """Return a sketch with another graph, whose view is not the sketch's own.

    What the sketch says of parameters of its own view is said of those inside ``inner``, "view.inner.";
    without, it is left out: of values, presets, shots, keyframes and the list of main parameters.
    """

    def moved(path: str) -> str:
        """Return the path in the graph; "" where it is left out."""
        if not path.startswith("view."):
            return path
        return inner + path.removeprefix("view.") if inner else ""

    def kept(values: tuple[tuple[str, Value], ...]) -> tuple[tuple[str, Value], ...]:
        return tuple((new, value) for path, value in values if (new := moved(path)))

    return replace(
        sketch,
        graph=graph,
        overrides=kept(sketch.overrides),
        presets=tuple(replace(preset, values=kept(preset.values)) for preset in sketch.presets),
        shots=tuple(replace(shot, values=kept(shot.values)) for shot in sketch.shots),
        keyframes=tuple(replace(key, values=kept(key.values)) for key in sketch.keyframes),
        main=tuple(filter(None, map(moved, sketch.main))),
    )


def refs_of(flat: Flat) -> list[str]:
    """List the textures that a map can show: those of the sketch's own passes, then inner ones."""
    refs = [
        f"{path}:{output}"
        for path, outputs in flat.outputs.items()
        for output in outputs
        if path.partition(".")[0] != "view"
    ]
    return sorted(refs, key=lambda ref: ref.count("."))


def map_kernel() -> Kernel:
    """Read the kernel that draws maps."""
    kernel = read_technique(USE, GLSL, GLSL)
    assert isinstance(kernel, Kernel)
    return kernel
