"""Convert mouse gestures over the picture to a camera."""

from __future__ import annotations

from dataclasses import dataclass

from playground.engine.camera import Eye, orbit, pan, zoom
from playground.sketch.model import Camera

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
