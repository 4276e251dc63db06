"""Looks: one and the same terrain in the colours and the light of a map, of clay, of its slopes.

A look is a view made of shipped techniques (``looks/*.toml``) that takes the place of the sketch's own
for the picture alone; no file changes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

from playground.engine.plan import Plan, view_height
from playground.sketch.assign import find_targets
from playground.sketch.map_sketch import with_other_view
from playground.sketch.model import Graph, Parameter, PassSpec, Sketch, Technique, Value
from playground.sketch.techniques import read_technique
from playground.studio.language import tr

LOOKS = ("natural", "hypsometric", "hillshade", "clay", "slope", "contours")
"""In the order in which they are offered; natural is the sketch's own view."""

_SUN = "sunlight.sun"  # of a look that has a light
_INTERVAL = "lines.interval"  # of one that has contour lines
_FOLDER = Path(__file__).parent / "looks"


def look_title(name: str) -> str:
    """Return what a look is called."""
    titles = {
        "natural": tr("Natural"),
        "hypsometric": tr("Hypsometric"),
        "hillshade": tr("Swiss hillshade"),
        "clay": tr("Clay"),
        "slope": tr("Slope"),
        "contours": tr("Contours"),
    }
    return titles[name]


@cache
def _technique(name: str) -> Technique:
    return read_technique(f"./{name}", _FOLDER, _FOLDER)


@dataclass(frozen=True)
class Look:
    """A view of a sketch's heights in place of its own."""

    name: str  # of ``LOOKS``
    height: str  # "pass[.inner…]:output"
    values: tuple[tuple[str, Value], ...] = ()  # of its parameters, by path inside

    def __post_init__(self) -> None:
        """Raise ``ValueError`` for a name that is none."""
        if self.name not in LOOKS[1:]:
            raise ValueError(f"there is no look {self.name!r}")

    def of(self, sketch: Sketch) -> Sketch:
        """Return the sketch in this look: of the same graph always the same one."""
        return with_other_view(sketch, _with_view(sketch.graph, self))

    def sun(self) -> tuple[Parameter, Value] | None:
        """Return the direction of its light, and the azimuth and elevation it has; None where it has none."""
        technique = _technique(self.name)
        if not isinstance(technique, Graph) or technique.find("sunlight") is None:
            return None
        parameter = find_targets(technique, _SUN)[0].parameter
        spec = technique.find("sunlight")
        own = dict(spec.values).get("sun", parameter.default) if spec is not None else parameter.default
        return parameter, dict(self.values).get(_SUN, own)

    def with_sun(self, value: Value) -> Look:
        """Return the look with another direction of light."""
        return self._with(_SUN, value)

    @property
    def interval(self) -> float | None:
        """The metres from one of its contour lines to the next; None where it has none."""
        value = dict(self.values).get(_INTERVAL)
        return float(value) if isinstance(value, int | float) else None

    def with_interval(self, metres: float) -> Look:
        """Return the look with its contour lines so far apart, within what the lines can be."""
        return self._with(_INTERVAL, min(max(metres, 0.1), 2000.0))

    def _with(self, path: str, value: Value) -> Look:
        return replace(self, values=(*(v for v in self.values if v[0] != path), (path, value)))

    def fits(self, sketch: Sketch) -> bool:
        """Return whether the sketch has the heights."""
        return sketch.graph.find(self.height.partition(":")[0].partition(".")[0]) is not None


@dataclass(frozen=True)
class Appearance:
    """How a terrain is shown where that is not as its sketch says."""

    exaggeration: float = 1.0  # how many times higher than it is
    look: Look | None = None


def look_of(name: str, plan: Plan | None, unit: float = 1.0) -> Look | None:
    """Return a look at what a plan shows; None for natural, and where the plan has no heights.

    Contour lines are a round number of a ``unit`` [m] apart.
    """
    height = view_height(plan) if plan is not None else ""
    if plan is None or name == "natural" or not height:
        return None
    look = Look(name, height)
    if name != "contours":
        return look
    return look.with_interval(interval_for((plan.terrain.relief or 1.0) / unit) * unit)


def interval_for(relief: float) -> float:
    """Return how far apart contour lines suit a relief, in the same unit: 1, 2 or 5 with noughts.

    There are 10 to 25 lines.
    """
    least = max(relief, 1e-3) / 25
    power = 10.0 ** math.floor(math.log10(least))
    number = next(n for n in (1, 2, 5, 10) if n * power >= least * (1 - 1e-9))
    return number * power


_last: dict[tuple[int, Look], tuple[Graph, Graph]] = {}  # the sketch's graph, and that in a look


def _with_view(graph: Graph, look: Look) -> Graph:
    """Return a graph with a look for its view; the very same for the same, so that plans stay."""
    key = id(graph), look
    made = _last.get(key)
    if made is None or made[0] is not graph:
        if len(_last) > 8:
            _last.clear()
        view = PassSpec(
            "view", look.name, _technique(look.name), inputs=(("height", look.height),), values=look.values
        )
        passes = (*(spec for spec in graph.passes if spec.name != "view"), view)
        made = _last[key] = graph, replace(graph, passes=passes)
    return made[1]
