"""Keep what a picture shows from side to side as the room for it narrows.

A camera's field of view is its vertical one. Next to the panels a picture is narrower than what
the sketch was framed for, and would be cut at its sides: it is opened instead, so that more is
visible above and below. Only the window does so; a render of a size is that of the sketch's camera.
"""

from __future__ import annotations

import math
from dataclasses import replace

from playground.engine.camera import Eye
from playground.sketch.model import Camera, Sketch
from playground.studio.picture.camera_drag import Gesture, steered

MAX_FIELD_OF_VIEW = 100.0
"""[degrees] that a view is opened to at most: beyond, what is near its edges is drawn out of shape."""

Size = tuple[int, int]


def framed(sketch: Sketch, time: float, size: Size, room: Size) -> Sketch:
    """Return a sketch at a time as it is shown in a ``room``; the same object where nothing is opened.

    ``size``: the size of the picture whose sides stay visible. Sizes in pixels.
    """
    now = sketch.at(time)
    opened = field_for(now.camera.field_of_view, size, room)
    if opened == now.camera.field_of_view:
        return sketch
    return replace(now, camera=replace(now.camera, field_of_view=opened))


def field_for(degrees: float, size: Size, room: Size) -> float:
    """Return the vertical field of view that shows in a room what a picture shows from side to side."""
    narrower = (size[0] / size[1]) / (room[0] / max(room[1], 1))
    if narrower <= 1.0:
        return degrees
    opened = 2 * math.degrees(math.atan(math.tan(math.radians(degrees) / 2) * narrower))
    return max(degrees, min(opened, MAX_FIELD_OF_VIEW))


def moved(camera: Camera, eye: Eye, gesture: Gesture, seen_through: Camera) -> Camera:
    """Return a camera after a gesture over a picture ``seen_through`` a wider one; it keeps its own field."""
    wide = replace(camera, field_of_view=seen_through.field_of_view)
    return replace(steered(wide, eye, gesture), field_of_view=camera.field_of_view)
