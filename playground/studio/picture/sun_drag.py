"""Move the sun of a sketch with the mouse: every direction that its passes show moves alike."""

from __future__ import annotations

from playground.sketch.assign import shown_parameters, value_of, values_of
from playground.sketch.model import Sketch
from playground.studio.picture.camera_drag import HALF_TURN

MIN_ELEVATION = -10.0
"""[degrees] A little below the horizon, so that a sunset can be gone through."""


def suns_of(sketch: Sketch) -> dict[str, tuple[float, float]]:
    """Return azimuth and elevation [degrees] of every direction that a pass shows, by path.

    Those of the view count only where no pass has one: they light a mesh, not the terrain.
    """
    suns: dict[str, tuple[float, float]] = {}
    leaves = values_of(sketch)
    for shown in shown_parameters(sketch):
        if shown.exported and shown.parameter.widget.kind == "direction":
            value = value_of(sketch, shown.path, leaves)
            if isinstance(value, tuple):
                suns[shown.path] = (float(value[0]), float(value[1]))
    of_terrain = {path: value for path, value in suns.items() if not path.startswith("view.")}
    return of_terrain or suns


def turned(sun: tuple[float, float], across: float, up: float) -> tuple[float, float]:
    """Return a direction after a drag, in fractions of the picture's height to the right and upwards."""
    azimuth, elevation = sun[0] + across * HALF_TURN, sun[1] + up * HALF_TURN / 2
    return round(azimuth % 360.0, 2), round(min(max(elevation, MIN_ELEVATION), 90.0), 2)
