"""How each method of lighting is set up to be compared: one sun of strength 1, white, and nothing else.

A method is a technique in ``glsl/lighting``, under one choice of its parameters. ``sketch_of`` hands a
terrain of the truth to the engine; the engine's own heights, times the relief, are what the truth is worked
out from, so both look at the same numbers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.sketch.model import Sketch

from ..loading import load
from ..sketch_texts import kernel, use
from ..sketch_texts import passes as write
from .land import Array, Land

SUN, SKY, BOTH, BOUNCED = "sun", "sky", "sun and sky", "sky and bounces"
AMBIENT = 0.4  # the even sky's strength beside a sun of 1, where there are both
GROUND = 0.5  # the ground's colour, where light is thrown on


@dataclass(frozen=True)
class Method:
    """A technique under one choice of its parameters."""

    name: str
    use: str  # below lighting/
    values: Mapping[str, object] = field(default_factory=dict)
    gives: str = SUN  # what its light is compared with
    after: str = ""  # a technique below lighting/ that changes its light afterwards
    after_values: Mapping[str, object] = field(default_factory=dict)
    arc: str = ""  # a parameter that takes the sun's azimuth too
    shadows: bool = True  # terrain hides its sun as it would hide a sun of this diameter
    diameter: float = 0.0  # [degrees] of the sun that it has in mind, at most; 0: a point
    measured: bool = True  # against the truth under the real sun
    output: str = ""  # which of its outputs is its light

    @property
    def exists(self) -> bool:
        """Say whether the library has it."""
        return any((GLSL / "lighting" / f"{self.use}{end}").is_file() for end in (".glsl", ".toml"))


def _wide(delta_r: float) -> float:
    """Return the diameter [degrees] of a sun that a cone of that tangent holds."""
    return 2 * float(np.degrees(np.arctan(delta_r)))


_ONE = {"gain": 1.0}
_SWEPT = {"gain": 1.0, "form": "sweep"}
_EIGHT = {"gain": 1.0, "measured": "eight directions"}
_ON_ARC = {"gain": 1.0, "measured": "on its arc"}
_WHITE, _BLACK, _GREY = (1.0, 1.0, 1.0), (0.0, 0.0, 0.0), (GROUND, GROUND, GROUND)
_PATCHES = dict.fromkeys(("overhead", "north", "east", "south", "west"), _WHITE)
_ALL = {"summed": "over all directions", "directions": 32}
_WITH_SKY = {"ambient": AMBIENT, "sky_colour": _WHITE, "ground": _BLACK}

METHODS = [
    Method("height difference", "height_difference", _ONE, shadows=False),
    Method("L·N", "l_dot_n", _ONE, shadows=False),
    Method("ray cast", "ray_cast", _ONE),
    Method("ray cast, sweep", "ray_cast", _SWEPT),
    Method("ray cast, mean filter", "ray_cast", _ONE, shadows=False, after="mean_filter"),
    Method("cylinder", "soft_cylinder", _ONE, shadows=False),
    Method("cone 0.01", "soft_cone", _ONE, diameter=_wide(0.01)),
    Method("cone 0.01, sweep", "soft_cone", _SWEPT, diameter=_wide(0.01)),
    Method("cone 0.0046", "soft_cone", {**_ONE, "delta_r": 0.0046}, diameter=_wide(0.0046)),
    Method("cone 0.0046, sweep", "soft_cone", {**_SWEPT, "delta_r": 0.0046}, diameter=_wide(0.0046)),
    Method("sun disc", "sun_disc", _ONE, diameter=0.53),
    Method("sun disc, step length 0.25", "sun_disc", {**_ONE, "step_length": 0.25}, diameter=0.53),
    Method("sun disc, sweep", "sun_disc", _SWEPT, diameter=0.53),
    Method("night", "night", _ONE, shadows=False, measured=False),
    Method("horizon sun, on its arc", "horizon_sun", _ON_ARC, arc="arc", diameter=0.53),
    Method("horizon sun, eight", "horizon_sun", _EIGHT, shadows=False),
    Method("horizon sky, table", "horizon_sky", {"ground": _BLACK}, SKY, output="k"),
    Method("horizon sky, 32 directions", "horizon_sky", {"ground": _BLACK, **_ALL}, SKY, output="k"),
    Method("sky patches, all white", "sky_patches", {"ground": _BLACK, **_PATCHES}, SKY),
    Method("analytic", "analytic", {**_EIGHT, **_WITH_SKY}, BOTH),
    Method("sun disc, interreflection", "sun_disc", _ONE, BOTH, "interreflection", {**_ALL, **_WITH_SKY}),
    Method("interreflection, table", "horizon_sky", {"ground": _GREY}, BOUNCED),
    Method("interreflection, 32 directions", "horizon_sky", {"ground": _GREY, **_ALL}, BOUNCED),
]
"""What is compared. Without shadows are: those that throw none; the filter, which smears them; the
cylinder and the night's cone, whose sun is far wider than the sun; the horizon between two of eight
directions, which rounds off what is between them."""


RAISED = kernel(
    "base + texelFetch(land, texel, 0).r",
    "height:r32f",
    "uniform sampler2D land;     //! input",
    "uniform float base = 0.0;",
)


def sketch_of(folder: Path, terrain: Land, passes: str, *, base: float = 0.0) -> Sketch:
    """Write a sketch of a terrain, as the pass ``height``, and the passes that light it.

    Heights are 0..1 and ``base`` more; the relief makes them metres.
    """
    low, relief = float(terrain.heights.min()), relief_of(terrain)
    ny, nx = terrain.heights.shape
    # A file of heights has two texels a side or more; of a smaller terrain, some are not read.
    kept = np.pad((terrain.heights - low) / relief, ((0, max(2 - ny, 0)), (0, max(2 - nx, 0))))
    np.save(folder / "terrain.npy", kept.astype(np.float32))
    (folder / "raised.glsl").write_text(RAISED)
    extent = [max(n - 1, 1) * metres for n, metres in zip((nx, ny), terrain.spacing, strict=True)]
    head = f"format = 1\nsize = [{nx}, {ny}]\nextent = {extent}\nrelief = {relief}\n"
    file = use("generation/heightmap", size=kept.shape[::-1], elevation="terrain.npy", first_row="south")
    path = folder / "sketch.toml"
    path.write_text(head + write(land=file, height=use("./raised", base=float(base))) + passes)
    return load(path)


def relief_of(terrain: Land) -> float:
    """Return the metres of height 1; 1 where the terrain is flat."""
    return float(np.ptp(terrain.heights)) or 1.0


def passes_of(method: Method, sun: tuple[float, float] | None = None) -> str:
    """Return the passes of one method; its last is named ``light``. Methods of the sky have no sun."""
    values = dict(method.values)
    if sun is not None and method.gives in (SUN, BOTH):
        values |= {"sun": sun, **({method.arc: sun[0]} if method.arc else {})}
    lit = use(f"lighting/{method.use}", **values)
    if not method.after:
        return write(light=lit)
    after = use(f"lighting/{method.after}", inputs={"light": "given"}, **method.after_values)
    return write(given=lit, light=after)


def as_read(engine: Engine, sketch: Sketch, terrain: Land) -> Land:
    """Return the terrain as the engine's texture has it."""
    heights = engine.read(sketch, "height").astype(np.float64) * relief_of(terrain)
    return Land(heights, terrain.spacing, terrain.name)


def lit(
    engine: Engine,
    folder: Path,
    method: Method,
    terrain: Land,
    sun: tuple[float, float] | None,
    *,
    base: float = 0.0,
) -> Array:
    """Return a method's light (ny, nx, components); in alpha is the visible part of the sun."""
    sketch = sketch_of(folder, terrain, passes_of(method, sun), base=base)
    result = engine.read(sketch, f"light:{method.output}" if method.output else "light").astype(np.float64)
    return result.reshape(*terrain.heights.shape, -1)
