"""What the mouse does over the picture: it orbits the terrain, looks around, moves the sun, or paints."""

from __future__ import annotations

from dataclasses import dataclass

from imgui_bundle import ImVec2, imgui

from playground.studio import theme
from playground.studio.bench import Workbench
from playground.studio.compare.panel import drag_line
from playground.studio.draw import Area
from playground.studio.picture.gestures import Gesture, divider_at, divider_position, steered_through
from playground.studio.session import Session
from playground.studio.trace.panel import act_on_picture

_ROUND = 48  # corners of the circle that shows a brush


@dataclass
class PictureMouse:
    """The mouse over one session's picture, or the cursor in its place."""

    bench: Workbench
    divider: str = ""  # the line that is held
    on_divider: bool = False  # the mouse is on a line
    strokes: bool = False  # it paints

    def act(self, area: Area, density: float) -> None:
        """Act on the mouse over the picture, unless the panel uses it."""
        bench = self.bench
        if drag_line(bench.inspection.compare, area):
            return
        self._act(area, density)
        if not bench.painting.on:
            act_on_picture(bench.tracing, bench.session.picture.texture, area, density)

    def _act(self, area: Area, density: float) -> None:
        """Steer, paint, move a line of the sketch, tell the shader."""
        io, session, walk = imgui.get_io(), self.bench.session, self.bench.walk
        if self.strokes and not imgui.is_mouse_down(0):
            self.bench.painting.release()
            self.strokes = False
        if io.want_capture_mouse or session.plan is None or session.sketch is None:
            return
        left, right = _dragged(0), _dragged(1)
        wheel = 0.0 if self._size_brush() else io.mouse_wheel
        if io.key_ctrl:
            if left and (io.mouse_delta.x or io.mouse_delta.y):
                session.move_suns(io.mouse_delta.x / area[3], -io.mouse_delta.y / area[3])
            return
        if walk.on:
            if left or right:
                walk.look(io.mouse_delta.x / area[3], io.mouse_delta.y / area[3])
            walk.hurry(io.mouse_wheel)
            return
        if self._divide(io.mouse_pos.x - area[0], area[2]) or (not io.key_shift and self._paint(area)):
            left = False
        gesture = Gesture(
            height=area[3],
            across=io.mouse_delta.x,
            down=io.mouse_delta.y,
            wheel=wheel,
            orbiting=left and not io.key_shift,
            panning=right or (left and io.key_shift),
        )
        steer(session, gesture)
        x, y = (io.mouse_pos.x - area[0]) * density, (area[3] - io.mouse_pos.y) * density
        pressed = imgui.is_mouse_down(0)
        session.hover((x, y), pressed=pressed, clicked=imgui.is_mouse_clicked(0))
        if pressed:
            gone = imgui.get_mouse_drag_delta(0, 0.0)
            session.point((x, y, x - gone.x * density, y + gone.y * density))

    def _divide(self, across: float, width: float) -> bool:
        """Move the line that is held, or grab the one under the mouse; return whether one is held."""
        session = self.bench.session
        if session.view.map is not None or session.sketch is None:
            return False
        if imgui.is_mouse_clicked(0):
            self.divider = divider_at(session.sketch, across, width)
        elif not imgui.is_mouse_down(0) and not imgui.is_mouse_released(0):
            self.divider = ""
        motion = imgui.get_io().mouse_delta
        if self.divider and motion.x:
            session.drafts.set(self.divider, divider_position(across, width))
        if motion.x or motion.y:
            self.on_divider = bool(self.divider or divider_at(session.sketch, across, width))
        if self.on_divider:
            imgui.set_mouse_cursor(imgui.MouseCursor_.resize_ew)
        return bool(self.divider)

    def _paint(self, area: Area) -> bool:
        """Paint while the left button is down, and show the brush; return whether it paints."""
        painting, io = self.bench.painting, imgui.get_io()
        if not painting.on or not self.bench.session.orbits:
            return False
        position = (io.mouse_pos.x - area[0]) / area[2], 1 - (io.mouse_pos.y - area[1]) / area[3]
        if imgui.is_mouse_clicked(0):
            self.strokes = True
            painting.press(position)
        elif self.strokes and (painting.sculpts or io.mouse_delta.x or io.mouse_delta.y):
            painting.move(position)
        self._show_brush(position, area)
        return self.strokes

    def _size_brush(self) -> bool:
        """Change the brush by the wheel, with Ctrl or Shift; return whether the wheel is the brush's."""
        painting, io = self.bench.painting, imgui.get_io()
        by = io.mouse_wheel or io.mouse_wheel_h  # with Shift, some systems turn it
        if not painting.on or not (io.key_ctrl or io.key_shift):
            return False
        if by and io.key_ctrl and io.key_shift:
            painting.soften(by)
        elif by and io.key_ctrl:
            painting.resize(by)
        elif by:
            painting.strengthen(by)
        return True

    def _show_brush(self, position: tuple[float, float], area: Area) -> None:
        """Draw the circle that the brush covers, as it lies on the terrain."""
        corners: list[ImVec2 | tuple[int | float, int | float] | list[int | float]] = [
            ImVec2(area[0] + x * area[2], area[1] + (1 - y) * area[3])
            for x, y in self.bench.painting.outline(position, _ROUND)
        ]
        if corners:
            draw = imgui.get_background_draw_list()
            draw.add_polyline(corners, theme.packed(theme.palette.warm), 2, imgui.ImDrawFlags_.closed)


def steer(session: Session, gesture: Gesture) -> None:
    """Move the camera of the picture that is shown, where it has one that moves."""
    plan, sketch = session.plan, session.sketch
    if not gesture.acts or not session.orbits or plan is None or sketch is None:
        return
    by_hand = session.shown is not None and session.shown.edits.camera is not None
    # Keyframes move the camera; a drag begins where it was in the picture that is shown.
    camera = sketch.camera if by_hand else sketch.at(plan.time).camera
    seen = steered_through(session.view.seen(camera), plan.eye, gesture, plan.sketch.camera)
    session.drafts.set_camera(session.view.unseen(seen, camera))


def _dragged(button: int) -> bool:
    """Return whether the mouse's motion since the last frame was a drag.

    The motion up to the press is none; the motion up to the release is one.
    """
    return (imgui.is_mouse_down(button) and not imgui.is_mouse_clicked(button)) or imgui.is_mouse_released(
        button
    )
