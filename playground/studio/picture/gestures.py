"""Mouse gestures over the picture: orbit, pan and zoom, drag the sun, drag lines that divide a picture."""

from __future__ import annotations

from dataclasses import dataclass, replace

from playground.engine.camera import Eye, orbit, pan, zoom
from playground.sketch.assign import shown_parameters, value_of, values_of
from playground.sketch.model import Camera, Sketch

# ── the camera ────────────────────────────────────────────────────────────────


HALF_TURN = 180.0
"""[degrees] that a drag over the picture's whole height turns the terrain."""
NOTCH = 0.88
"""How much nearer one notch of the wheel brings the eye."""


@dataclass(frozen=True, slots=True)
class Gesture:
    """What the mouse did since the last frame, over a picture so many pixels high."""

    height: float  # [pixels] of the picture
    across: float = 0.0  # [pixels] the mouse went to the right
    down: float = 0.0  # [pixels] … and downwards
    wheel: float = 0.0  # [notches] forward: nearer
    orbiting: bool = False  # the left button is held
    panning: bool = False  # the right button is held, or the left one with Shift

    @property
    def acts(self) -> bool:
        """Whether it changes anything."""
        moved = (self.orbiting or self.panning) and (self.across != 0 or self.down != 0)
        return moved or self.wheel != 0


def steered(camera: Camera, eye: Eye, gesture: Gesture) -> Camera:
    """Return the camera after a gesture; the terrain follows the mouse.

    ``eye`` is where the camera was in the picture that the gesture was made over.
    """
    if gesture.height <= 0:
        return camera
    across, down = gesture.across / gesture.height, gesture.down / gesture.height
    if gesture.panning:
        camera = pan(camera, eye, -across, down)
    elif gesture.orbiting:
        camera = orbit(camera, across * HALF_TURN, down * HALF_TURN)
    if gesture.wheel:
        camera = zoom(camera, NOTCH**gesture.wheel, eye.distance)
    return camera


def steered_through(camera: Camera, eye: Eye, gesture: Gesture, seen_through: Camera) -> Camera:
    """Return a camera after a gesture over a picture ``seen_through`` a wider one; it keeps its own field."""
    wide = replace(camera, field_of_view=seen_through.field_of_view)
    return replace(steered(wide, eye, gesture), field_of_view=camera.field_of_view)


# ── the sun ───────────────────────────────────────────────────────────────────


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


def turned_sun(sun: tuple[float, float], across: float, up: float) -> tuple[float, float]:
    """Return a direction after a drag, in fractions of the picture's height to the right and upwards."""
    azimuth, elevation = sun[0] + across * HALF_TURN, sun[1] + up * HALF_TURN / 2
    return round(azimuth % 360.0, 2), round(min(max(elevation, MIN_ELEVATION), 90.0), 2)


# ── dividers ──────────────────────────────────────────────────────────────────


GRAB_DISTANCE = 6.0
"""How far from a line the mouse can grab it, in the screen's units."""


def dividers_of(sketch: Sketch) -> dict[str, float]:
    """Return where the lines are, in fractions of the picture's width from its left, by path."""
    leaves = values_of(sketch)
    dividers = {
        shown.path: value_of(sketch, shown.path, leaves)
        for shown in shown_parameters(sketch)
        if shown.exported and shown.parameter.widget.kind == "divider"
    }
    return {path: float(value) for path, value in dividers.items() if isinstance(value, int | float)}


def divider_at(sketch: Sketch, across: float, width: float) -> str:
    """Return the path of the line nearest to a place ``across`` a picture ``width`` wide, in the same units.

    "" where none is near enough.
    """
    away = {path: abs(fraction * width - across) for path, fraction in dividers_of(sketch).items()}
    nearest = min(away, key=away.__getitem__, default="")
    return nearest if nearest and away[nearest] <= GRAB_DISTANCE else ""


def divider_position(across: float, width: float) -> float:
    """Return where a line is when it is held at a place across the picture."""
    return round(min(max(across / width, 0.0), 1.0), 4)
