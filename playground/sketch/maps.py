"""A sketch that shows one of its textures as a map from above, instead of its own view."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from playground.paths import GLSL
from playground.sketch.model import Kernel, PassSpec, Sketch, Value
from playground.sketch.techniques import read_technique

USE = "view/map"


@dataclass(frozen=True)
class Map:
    """One texture of a sketch, and how it is shown from above."""

    ref: str  # "pass[.inner…]:output"
    values: tuple[tuple[str, Value], ...] = ()  # of view/map's parameters
    kernel: Kernel = field(default_factory=lambda: map_kernel(), compare=False)

    def of(self, sketch: Sketch) -> Sketch:
        """Return the sketch with this map for its view."""
        spec = PassSpec("view", USE, self.kernel, inputs=(("shown", self.ref),), values=self.values)
        passes = (*(p for p in sketch.graph.passes if p.name != "view"), spec)
        overrides = tuple(v for v in sketch.overrides if not v[0].startswith("view."))
        return replace(sketch, graph=replace(sketch.graph, passes=passes), overrides=overrides)

    def with_value(self, name: str, value: Value) -> Map:
        """Return the map with one of its parameters set."""
        return replace(self, values=(*(v for v in self.values if v[0] != name), (name, value)))

    def value(self, name: str) -> Value:
        """Return the value of one of its parameters."""
        known = dict(self.values)
        parameter = self.kernel.parameter(name)
        return known[name] if name in known or parameter is None else parameter.default


def map_kernel() -> Kernel:
    """Read the kernel that draws maps."""
    found = read_technique(USE, GLSL, GLSL)
    assert isinstance(found, Kernel)
    return found
