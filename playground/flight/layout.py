"""Read from a sketch how its terrain is cut into parts, or explain why it cannot be flown over.

A flight requires of a sketch no more than this: a pass ``height`` whose technique has a parameter
``part`` (two whole numbers: which part is made), on terrain as wide as it is long. If it has
``apron`` as well, so many texels on each side belong to the neighbours, and are cut off once
the light is computed. Every other pass with a parameter ``part`` receives it too. The passes
``colour``, ``light`` and ``daylight`` are used where they are there, and so are the colours
of the view. A parameter ``daylight.hour`` makes the time of day the pilot's. Under the sky of a
daylight, passes ``cloud`` and ``drift`` give it clouds, and a pass ``density`` trees.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from playground.engine.engine import Engine
from playground.errors import ParameterError, PlaygroundError, SketchError
from playground.paths import GLSL
from playground.sketch.assign import resolve, value_of, values_of
from playground.sketch.model import Graph, Parameter, Sketch, Technique, Value
from playground.sketch.techniques import read_technique
from playground.sketch.wiring import output_names

PartName = tuple[int, int]
"""Which part of the terrain, counted east and north."""

_HEIGHT, _COLOUR, LIGHT, DAYLIGHT = "height", "colour", "light", "daylight"
DENSITY, VISIBILITY = "density", f"{LIGHT}.visibility"
_TREES = ("cell", "tallest", "shortest", "seed", "needles", "needles_from", "ragged")
"""The view's parameters of trees, which are those of ``_TREES_USE``."""
_TREES_USE = ("trees/place", "trees/seen", "trees/species")
_TABLES = {"columns", "bounced", "dome"}
"""What a daylight gives besides, for air and sky."""
_OUTDOORS = ("mist", "mist_top", "mist_level", "beyond", "clouds", "steps", "wear")
"""The view's parameters of air and sky."""
_PART, _APRON, _HOUR, _MAX_DISTANCE = "part", "apron", "hour", "max_distance"
_FINEST = 1024  # intervals of a part, and texels of its ground
FARTHEST = 2**20
"""Parts east or north of the first beyond which a node's number no longer fits 32 bits."""


@dataclass(frozen=True)
class View:
    """The view's colours and its sea; defaults are those of ``view/terrain``."""

    zenith: tuple[float, float, float] = (0.105, 0.245, 0.56)
    horizon: tuple[float, float, float] = (0.60, 0.70, 0.80)
    exposure: float = 0.0  # [stops]
    tone: int = 0
    white: float = 3.0
    sea: bool = False
    sea_level: float = 0.0  # [m] above the zero of elevations
    water: tuple[float, float, float] = (0.015, 0.075, 0.11)
    clarity: float = 12.0  # [m]


@dataclass(frozen=True)
class PlotLight:
    """How a sketch lights its terrain."""

    has_daylight: bool = False  # by a daylight
    gain: float = 0.0  # what the sun's light is multiplied by
    ambient: float = 0.0  # the same of the sky's light
    has_visibility: bool = False  # whether the light says what of the sun is visible


@dataclass(frozen=True)
class Plot:
    """A sketch's terrain, cut into parts."""

    sketch: Sketch
    part_paths: tuple[str, ...]  # of the parameters that receive the part
    intervals: int  # of a part, from node to node
    apron: int  # [texels of the height] around it
    spacing: float  # [m] from node to node
    relief: float  # [m] from height 0 to 1
    base: float  # [m] above the zero of elevations at height 0
    ground: int  # [texels] a side of a part's lit ground
    shares: dict[str, tuple[float, float]] = field(
        hash=False
    )  # pass → first texel, and texels a ground texel
    view: View = View()
    hour: str = ""  # path of the time of day; empty: the sketch has none
    light: PlotLight = PlotLight()
    outdoors: dict[str, Value] | None = field(default=None, hash=False)
    """What the view sets of air and sky; None where they are not a daylight's."""
    trees: dict[str, float] | None = field(default=None, hash=False)
    """What the view sets of trees, or how they are; None where there are none."""
    density: int = 1  # [texels] to an interval

    @property
    def width(self) -> float:
        """Metres along a part's side."""
        return self.intervals * self.spacing

    def at(self, part: PartName, hour: float | None = None) -> Sketch:
        """Return the sketch of one part, at a time of day."""
        values: dict[str, object] = {path: part for path in self.part_paths}
        if hour is not None and self.hour:
            values[self.hour] = hour
        return self.sketch.with_values(values)

    def first_hour(self) -> float:
        """Return the sketch's time of day in hours; 12 where it has none."""
        if not self.hour:
            return 12.0
        value = value_of(self.sketch, self.hour, values_of(self.sketch))
        return float(value) if isinstance(value, int | float) else 12.0


def plot_of(sketch: Sketch, engine: Engine) -> Plot:
    """Return a sketch's terrain, cut into parts; raise ``SketchError`` where it cannot be flown over."""
    names = [spec.name for spec in sketch.graph.passes]
    if _HEIGHT not in names:
        raise _refused(sketch, f"it has no pass named '{_HEIGHT}'")
    leaves = values_of(sketch)
    _check_part(sketch, leaves)
    apron = _apron(sketch, leaves)
    # What is made with another apron would not fit: one for all.
    aprons = [f"{name}.{_APRON}" for name in names]
    others = [path for path in aprons if _value(sketch, path, leaves) not in (None, apron)]
    sketch = sketch.with_values(dict.fromkeys(others, apron))
    ground = engine.plan(sketch, (1, 1)).terrain
    extent, relief = ground.extent, ground.relief
    assert extent is not None and relief is not None
    used = (_HEIGHT, _COLOUR, LIGHT, DENSITY)
    sizes = {name: _size(sketch, engine, name) for name in used if name in names}
    side, intervals = _intervals(sketch, sizes[_HEIGHT], extent, apron)
    finer = {name: _finer(sketch, name, size, side, apron) for name, size in sizes.items() if name != _HEIGHT}
    lit = {name: times for name, times in finer.items() if name != DENSITY}
    outdoors = _outdoors(sketch, leaves)
    finest = max(lit.values(), default=1)
    parts = [f"{name}.{_PART}" for name in names]
    hour = f"{DAYLIGHT}.{_HOUR}"
    return Plot(
        sketch=sketch,
        part_paths=tuple(path for path in parts if _value(sketch, path, leaves) is not None),
        intervals=intervals,
        apron=apron,
        spacing=extent[0] / (side - 1),
        relief=relief,
        base=ground.base_elevation or 0.0,
        ground=intervals * finest + 1,
        shares={name: (float(apron * times), times / finest) for name, times in lit.items()},
        view=_view(sketch, leaves),
        hour=hour if _value(sketch, hour, leaves) is not None else "",
        light=PlotLight(
            has_daylight=DAYLIGHT in names,
            gain=_number(sketch, f"{LIGHT}.gain", leaves),
            ambient=_number(sketch, f"{LIGHT}.ambient", leaves),
            has_visibility=_has_visibility(sketch),
        ),
        outdoors=outdoors,
        trees=_trees(sketch, leaves, outdoors) if DENSITY in names else None,
        density=finer.get(DENSITY, 1),
    )


def _check_part(sketch: Sketch, leaves: dict[str, Value]) -> None:
    """Raise ``SketchError`` where the height has no parameter for the part to make."""
    part = _value(sketch, f"{_HEIGHT}.{_PART}", leaves)
    if not (isinstance(part, tuple) and len(part) == 2 and all(isinstance(n, int) for n in part)):
        raise _refused(
            sketch,
            f"the technique of its pass '{_HEIGHT}' has no parameter '{_PART}' of two whole numbers, "
            "which part of the terrain to make",
        )


def _apron(sketch: Sketch, leaves: dict[str, Value]) -> int:
    """Return the apron of the height [texels]; raise ``SketchError`` where shadows reach beyond it."""
    value = _value(sketch, f"{_HEIGHT}.{_APRON}", leaves)
    apron = value if isinstance(value, int) else 0
    distance = _value(sketch, f"{LIGHT}.{_MAX_DISTANCE}", leaves)
    if isinstance(distance, int | float) and distance > apron > 0:
        raise _refused(
            sketch,
            f"shadows reach {distance:g} texels ({LIGHT}.{_MAX_DISTANCE}), and there are only {apron} "
            f"around a part ({_HEIGHT}.{_APRON}); set {LIGHT}.{_MAX_DISTANCE}={apron}",
        )
    return apron


def _intervals(
    sketch: Sketch, size: tuple[int, int], extent: tuple[float, float], apron: int
) -> tuple[int, int]:
    """Return the texels of a side, and the intervals of a part; raise ``SketchError`` for a bad fit."""
    side = size[0]
    if size != (side, side) or abs(extent[0] - extent[1]) > 1e-6 * extent[0]:
        raise _refused(
            sketch,
            f"its terrain is {side} x {size[1]} texels on {extent[0]:g} x {extent[1]:g} m, "
            "and parts are as wide as they are long",
        )
    intervals = side - 1 - 2 * apron
    if not 2 <= intervals <= _FINEST:
        raise _refused(
            sketch,
            f"{side} texels less an apron of {apron} on each side leave a part of {intervals} intervals; "
            f"2 to {_FINEST} were expected",
        )
    return side, intervals


def _refused(sketch: Sketch, why: str) -> SketchError:
    return SketchError(
        f"sketch {sketch.name} cannot be flown over: {why}; the sketch 'flight' shows what it takes",
        file=sketch.file,
    )


def _value(sketch: Sketch, path: str, leaves: dict[str, Value]) -> Value | None:
    try:
        resolve(sketch.graph, path)
    except ParameterError:
        return None
    return value_of(sketch, path, leaves)


def _number(sketch: Sketch, path: str, leaves: dict[str, Value]) -> float:
    """Return a parameter's value; 0 where there is none."""
    numbers = _value(sketch, path, leaves)
    return float(numbers) if isinstance(numbers, int | float) else 0.0


def _size(sketch: Sketch, engine: Engine, name: str) -> tuple[int, int]:
    plan = engine.plan(sketch, (1, 1), ref=name)
    try:
        step = plan.step(plan.flat.ref(name, sketch.name).path)
    except PlaygroundError as error:
        raise _refused(sketch, str(error)) from None
    if step is None:
        raise _refused(sketch, f"its pass '{name}' gives no texture")
    return step.size


def _finer(sketch: Sketch, name: str, size: tuple[int, int], side: int, apron: int) -> int:
    """Return how many texels of a pass lie on an interval of the height: a whole number, so that cuts fit."""
    times, rest = divmod(size[0] - 1, side - 1)
    if size[0] != size[1] or rest or times < 1:
        raise _refused(
            sketch,
            f"its pass '{name}' has {size[0]} x {size[1]} texels where the height has {side}; "
            f"a whole number of texels for each interval was expected, as {side} or {2 * side - 1}",
        )
    if apron * times * 2 + 2 > size[0] or (side - 1 - 2 * apron) * times > _FINEST:
        raise _refused(sketch, f"its pass '{name}' is finer than {_FINEST} texels along a part")
    return times


def _view(sketch: Sketch, leaves: dict[str, Value]) -> View:
    values: dict[str, Value] = {}
    for name in View.__dataclass_fields__:
        value = _value(sketch, f"view.{name}", leaves)
        if value is not None:
            values[name] = value
    return replace(View(), **values)  # type: ignore[arg-type]


def _outdoors(sketch: Sketch, leaves: dict[str, Value]) -> dict[str, Value] | None:
    """Return what the view sets of air and sky; None unless they are those of a daylight."""
    daylight = sketch.graph.find(DAYLIGHT)
    if daylight is None or not _TABLES <= {*output_names(daylight.technique)}:
        return None
    # A view outdoors has no other sky.
    if _value(sketch, "view.sky", leaves) == 0 and _value(sketch, "view.mist", leaves) is None:
        return None
    values = {name: _value(sketch, f"view.{name}", leaves) for name in _OUTDOORS}
    return {name: value for name, value in values.items() if value is not None}


def _trees(sketch: Sketch, leaves: dict[str, Value], outdoors: dict[str, Value] | None) -> dict[str, float]:
    """Return what the view sets of trees, or how they are; raise ``SketchError`` where they have no light."""
    if outdoors is None:
        raise _refused(
            sketch,
            f"its pass '{DENSITY}' has trees, which are lit by a pass '{DAYLIGHT}' of lighting/daylight "
            'under its own sky; add both, as view.sky = "daylight", or take out the trees',
        )
    usual: dict[str, Value] = {}
    for use in _TREES_USE:
        technique = read_technique(use, GLSL, GLSL)
        usual |= {path.rpartition(".")[2]: p.default for path, p in _parameters(technique).items()}
    values = {name: _value(sketch, f"view.{name}", leaves) for name in _TREES}
    chosen = {name: usual[name] if value is None else value for name, value in values.items()}
    return {name: float(value) for name, value in chosen.items() if isinstance(value, int | float)}


def _parameters(technique: Technique) -> dict[str, Parameter]:
    if isinstance(technique, Graph):
        return technique.leaf_parameters
    return {parameter.name: parameter for parameter in technique.parameters}


def _has_visibility(sketch: Sketch) -> bool:
    """Return whether the light's technique has a pass that says what of the sun is visible."""
    light = sketch.graph.find(LIGHT)
    inner = VISIBILITY.partition(".")[2]
    return (
        light is not None and isinstance(light.technique, Graph) and light.technique.find(inner) is not None
    )
