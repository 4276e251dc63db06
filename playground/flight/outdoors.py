"""Compute the air, the sky and the clouds around the craft by the scene's own passes.

They run on an engine of their own: what is new in each picture would push out of the flight's cache
what all parts share. The craft may be anywhere on endless terrain, and clouds repeat, so
their passes see it within one tile of clouds, where single precision has millimetres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from playground.engine.camera import Eye
from playground.engine.engine import Engine
from playground.engine.textures import make_texture
from playground.flight.layout import Plot
from playground.flight.lens import Lens
from playground.paths import GLSL
from playground.sketch.flat import Ref
from playground.sketch.model import Graph, PassSpec, Sketch
from playground.sketch.techniques import read_technique

if TYPE_CHECKING:
    import moderngl

CACHE_BYTES = 32 * 2**20
NO_CLOUDS = 0
"""Of the parameter that says which are drawn (clouds/parameters/drawn.glsl)."""

_WOOD, _WOOD_USE, _WOOD_SIZE = "wood_light", "trees/wood", ("24", "216")
_PASS, _USE = "outdoors", "flight/outdoors"
_TABLES = ("columns", "bounced", "dome")  # of the daylight
_CLOUDS = {"cloud": ("clouds/field", "4"), "drift": ("clouds/drift", "1")}  # where a sketch has none


@dataclass(frozen=True)
class Around:
    """What is around the craft in one picture; the textures live until the next one."""

    sky: moderngl.Texture  # rgba16f, the picture's directions
    scattered: moderngl.Texture  # of scene/air
    left: moderngl.Texture
    cloud: moderngl.Texture  # a tile
    wind: tuple[float, ...]  # clouds/drift
    table: moderngl.Texture | None  # of trees/wood, where there are trees
    mean: float  # what clouds leave of the sun on the mean
    clip: list[float]  # the lens of sky and air, columns: from around the eye to the picture
    clouded: bool  # whether clouds are drawn, and throw shadows


class Outdoors:
    """Air, sky and clouds of a sketch with a daylight; use ``release()`` at the end."""

    def __init__(self, engine: Engine, plot: Plot) -> None:
        self._engine = Engine(engine.ctx, driver=engine.driver, cache_bytes=CACHE_BYTES)
        # A processor draws the sky at half the picture's size: all of it is soft.
        self._coarser = 2 if engine.info.software else 1
        self._plot = plot
        self._sketch, self._clouded = _with_outdoors(plot)
        self._table: moderngl.Texture | None = None
        self._table_hour = math.nan
        self._mean: tuple[float, float] | None = None
        # Where the wind carries the clouds in a second, and how wide their tile is.
        try:
            at = [
                self._engine.read(self._sketch, "drift", time=time)[0, 0].astype(np.float64)
                for time in (0, 1)
            ]
        except BaseException:
            self._engine.release()
            raise
        self._still = tuple(float(n) for n in at[0])
        self._wide = self._still[3]
        self._wind = (at[1][:2] - at[0][:2] + self._wide / 2) % self._wide - self._wide / 2

    def draw(
        self, eye: tuple[float, float, float], lens: Lens, size: tuple[int, int], seconds: float, hour: float
    ) -> Around:
        """Compute what is around an eye [m], so many seconds after the start, at a time of day.

        The clouds stay, and the eye goes against the wind: so nothing else depends on the seconds.
        """
        size = max(size[0] // self._coarser, 1), max(size[1] // self._coarser, 1)
        sketch = self._sketch.with_values({self._plot.hour: hour}) if self._plot.hour else self._sketch
        if self._plot.trees is not None and hour != self._table_hour:
            self._take_table(sketch, hour)
        plan = self._engine.plan(sketch, size, ref=_PASS)
        plan = replace(plan, eye=_eye_at(self.over_tile(eye, seconds), lens))
        sky = self._engine.texture_of(plan, plan.flat.ref(_PASS, sketch.name))

        def of(name: str) -> moderngl.Texture:
            ref: Ref = plan.flat.ref(name, sketch.name)
            return self._engine.record.results[ref.path].textures[ref.output]

        air, cloud = (of(f"{_PASS}:scattered"), of(f"{_PASS}:left")), of("cloud")
        clip = lens.clip_from_near.T.ravel().tolist()
        mean = self._mean_of(cloud, hour)
        return Around(sky, *air, cloud, self._still, self._table, mean, clip, self._clouded)

    def over_tile(self, eye: tuple[float, float, float], seconds: float) -> tuple[float, float, float]:
        """Return where an eye is over the clouds' tile [m], after so many seconds."""
        east, north = (np.array(eye[:2]) - self._wind * seconds) % self._wide
        return float(east), float(north), eye[2]

    def _mean_of(self, cloud: moderngl.Texture, hour: float) -> float:
        """Return what clouds leave of the sun on the mean, at a time of day (clouds/shadow)."""
        if self._mean is None or self._mean[0] != hour:
            level = max(cloud.size).bit_length() - 1
            texel = np.frombuffer(cloud.read(level=level, alignment=1), np.float16)
            self._mean = hour, max(float(texel[3]), 1e-4)
        return self._mean[1]

    def _take_table(self, sketch: Sketch, hour: float) -> None:
        """Copy the light on a wood at a time of day."""
        if self._table is not None:
            self._table.release()
        texture = self._engine.texture(sketch, _WOOD)
        self._table = make_texture(self._engine.ctx, texture.size, "rgba32f", texture.read(alignment=1))
        self._table_hour = hour

    def release(self) -> None:
        """Release the engine."""
        if self._table is not None:
            self._table.release()
        self._engine.release()


def _eye_at(position: tuple[float, float, float], lens: Lens) -> Eye:
    shift = np.eye(4)
    shift[:3, 3] = np.negative(position)
    with np.errstate(under="ignore"):
        matrix = (lens.clip_from_near.astype(np.float64) @ shift).astype(np.float32)
    return Eye(matrix, position, position, 1.0)


def _with_outdoors(plot: Plot) -> tuple[Sketch, bool]:
    """Return the sketch with air and sky before its view, and whether clouds are drawn."""
    sketch = plot.sketch
    *passes, view = sketch.graph.passes
    names = {spec.name for spec in passes}
    clouded = names >= _CLOUDS.keys()
    for name, (use, size) in _CLOUDS.items():
        if name not in names:
            passes.append(PassSpec(name, use, read_technique(use, GLSL, GLSL), size=(size, size)))
    technique = read_technique(_USE, GLSL, GLSL)
    assert isinstance(technique, Graph)
    outdoors = dict(plot.outdoors or {})
    if not clouded:
        outdoors["clouds"] = NO_CLOUDS
    inputs = tuple((name, f"daylight:{name}") for name in _TABLES)
    passes.append(PassSpec(_PASS, _USE, technique, inputs=inputs, values=tuple(outdoors.items())))
    if plot.trees is not None:
        wood = read_technique(_WOOD_USE, GLSL, GLSL)
        own = {p.name for p in wood.parameters}
        values = tuple((name, value) for name, value in plot.trees.items() if name in own)
        passes.append(PassSpec(_WOOD, _WOOD_USE, wood, values=values, size=_WOOD_SIZE))
    graph = replace(sketch.graph, passes=(*passes, view))
    return replace(sketch, graph=graph), clouded
