"""A GLFW window with an OpenGL context and Dear ImGui in it: the one place that knows of screens.

``imgui_bundle`` is imported before ``glfw``, so that both use one GLFW library.
"""

from __future__ import annotations

import ctypes
import math
import os
import sys
import time
from collections import deque
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, cast

import imgui_bundle
from imgui_bundle import imgui

# isort: split
import glfw

from playground.engine.context import abandon, adopt_context
from playground.engine.driver_advice import advice
from playground.errors import ContextError
from playground.studio.key_queue import KeyQueue
from playground.studio.theme import Theme

if TYPE_CHECKING:
    import moderngl

# ── clicks and releases ───────────────────────────────────────────────────────


DOUBLE_CLICK_TIME = 0.3
"""[s] that the clicks of a double click are apart at most."""
_AT_ONCE = 0.004  # [s] from the beginning of a wait: what came before it is reported by then
_NEVER, _ALWAYS = 0.0, 1e3  # [s] what imgui is to take for the longest time between the two


class Clicks:
    """Judges double clicks by when the left button went down, not by the frames in which they are drawn.

    imgui spreads the presses and releases of one moment over several frames and compares the times of the
    frames: where a picture takes 0.4 s, no two clicks are ever a double one. GLFW reports that a button
    went down only when it is polled, after the frame before has ended. So an event came after the last
    poll; one that comes while the window sleeps is reported at once. Two clicks are a double click if
    they can have been one. ``before_poll`` and ``after_poll`` surround each wait.
    """

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self._now = now
        self._poll_end = self._poll_start = now()
        self._pressed: float | None = None  # the latest that the last press can have been
        self._doubles: deque[bool] = deque()  # presses that imgui has not come to, oldest first

    def before_poll(self) -> None:
        """Record when GLFW is about to be polled for events."""
        self._poll_start = self._now()

    def after_poll(self) -> None:
        """Record when it has reported all events."""
        self._poll_end = self._now()

    def press(self) -> None:
        """Record a press of the button."""
        now = self._now()
        waited_for = now - self._poll_start > _AT_ONCE
        earliest = now if waited_for else self._poll_end
        self._doubles.append(self._pressed is not None and earliest - self._pressed < DOUBLE_CLICK_TIME)
        self._pressed = now

    def double_click_time(self) -> float:
        """Return the longest time between two clicks [s] that imgui uses in its next frame."""
        if not self._doubles:
            return DOUBLE_CLICK_TIME
        return _ALWAYS if self._doubles[0] else _NEVER

    def handled(self) -> None:
        """Forget the oldest press, which imgui has handled."""
        if self._doubles:
            self._doubles.popleft()


def before_release(position: tuple[float, float]) -> None:
    """Prepare imgui for a release at a place of the window, whose event follows.

    Where a picture is slow, the last movement of a drag and the release come in one frame. imgui then ends
    the drag without having looked at that movement, so a slider would stay behind the mouse. Of a touch
    screen it handles the release one frame later; so such a release is said to come from one.
    """
    io = imgui.get_io()
    moved = (io.mouse_pos.x, io.mouse_pos.y) != tuple(map(math.floor, position))  # imgui has whole pixels
    io.add_mouse_source_event(imgui.MouseSource.touch_screen if moved else imgui.MouseSource.mouse)


def after_events() -> None:
    """Have what comes next be the mouse's own."""
    imgui.get_io().add_mouse_source_event(imgui.MouseSource.mouse)


# ── the window ────────────────────────────────────────────────────────────────


_VERSIONS = ((4, 3), (4, 1), (3, 3))
_HINTS = {
    glfw.OPENGL_PROFILE: glfw.OPENGL_CORE_PROFILE,
    glfw.OPENGL_FORWARD_COMPAT: True,
    glfw.SCALE_TO_MONITOR: True,
    glfw.DEPTH_BITS: 0,
    glfw.STENCIL_BITS: 0,
    glfw.CONTEXT_ROBUSTNESS: glfw.LOSE_CONTEXT_ON_RESET,
}
_MIN_SIZE = (480, 320)
_SIGNS = {"+": "+", "=": "+", "-": "-"}  # what a key's own name asks for; + is over = on many keyboards
_SIGN_KEYS = (glfw.KEY_EQUAL, glfw.KEY_MINUS, glfw.KEY_RIGHT_BRACKET, glfw.KEY_SLASH, glfw.KEY_BACKSLASH)
_READINGS = 4  # of the window's size, until two in a row are the same
_ATTEMPTS, _BETWEEN = 20, 0.5  # a driver that was reset may take some seconds to come back [s]


class Window:
    """An open window. Use it with ``with``, or call ``close()``."""

    def __init__(self, title: str, size: tuple[int, int]) -> None:
        glfw.ERROR_REPORTING = "ignore"  # errors are read below, and reported in a message
        if not glfw.init():
            raise _refused("glfw.init failed")
        self._title = title
        self._clicks = Clicks()
        self.keys = KeyQueue()
        self._screen_size = (0, 0)
        self._screen: moderngl.Framebuffer | None = None
        self.zoom = 1.0  # of text and margins, over the screen's own scale
        try:
            self._open(size)
            self.theme = self._start_imgui()
        except BaseException:
            glfw.terminate()
            raise

    def __enter__(self) -> Window:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def handle(self) -> Any:
        """GLFW's own window."""
        return self._handle

    @property
    def open(self) -> bool:
        """Whether it has not been closed."""
        return not glfw.window_should_close(self._handle)

    @property
    def lost(self) -> bool:
        """Whether the driver was reset, and the context lost with it; False where it does not report that."""
        return self._reset_status is not None and self._reset_status() != 0

    @property
    def pixels(self) -> tuple[int, int]:
        """Width and height of what is drawn [pixels]; (0, 0) while it is minimised."""
        width, height = glfw.get_framebuffer_size(self._handle)
        return (0, 0) if glfw.get_window_attrib(self._handle, glfw.ICONIFIED) else (width, height)

    @property
    def density(self) -> float:
        """Pixels in one of the window's own units: 2 on a Retina screen, 1 on Windows and X11."""
        for _ in range(_READINGS):  # a person may pull its edge between the two questions
            before, pixels = glfw.get_window_size(self._handle), self.pixels
            if before == glfw.get_window_size(self._handle):
                break
        return float(pixels[0] / before[0]) if before[0] and pixels[0] else 1.0

    @property
    def scale(self) -> float:
        """How much larger text and margins are drawn, in the window's own units."""
        return float(max(glfw.get_window_content_scale(self._handle)[0] / self.density, 0.5))

    @property
    def screen(self) -> moderngl.Framebuffer:
        """The window's own framebuffer, at its present size."""
        if self._screen is None or self._screen_size != self.pixels:
            glfw.make_context_current(self._handle)
            self.ctx.detect_framebuffer(0).use()
            self._screen, self._screen_size = self.ctx.detect_framebuffer(0), self.pixels
        return self._screen

    @property
    def sign_held(self) -> str:
        """What a key that is held down types, "+" or "-", wherever this keyboard has it; else nothing."""
        for code in _SIGN_KEYS:
            if glfw.get_key(self._handle, code) == glfw.PRESS:
                name = glfw.get_key_name(code, 0) or ""
                if name in _SIGNS:
                    return _SIGNS[name]
        return ""

    def set_title(self, title: str) -> None:
        """Set its title."""
        if title != self._title:
            self._title = title
            glfw.set_window_title(self._handle, title)

    def ask_to_close(self) -> None:
        """Close it at the end of this frame."""
        glfw.set_window_should_close(self._handle, True)

    def wait(self, seconds: float) -> None:
        """Sleep until an event or a call of ``wake``, at most ``seconds``; then handle the events."""
        self._clicks.before_poll()
        if seconds <= 0:
            glfw.poll_events()
        else:
            glfw.wait_events_timeout(seconds)
        self._clicks.after_poll()
        after_events()

    def begin(self, point: Callable[[tuple[float, float]], None] = lambda _: None) -> None:
        """Begin a frame of the interface.

        ``point`` receives the mouse's place, and may give imgui another.
        """
        self.theme.rescale(self.scale * self.zoom)
        imgui.backends.opengl3_new_frame()
        imgui.backends.glfw_new_frame()
        io, longest = imgui.get_io(), self._clicks.double_click_time()
        io.mouse_double_click_time, io.mouse_single_click_delay = longest, longest + 0.25
        point(glfw.get_cursor_pos(self._handle))
        self.keys.feed()
        imgui.new_frame()
        if imgui.is_mouse_clicked(0):
            self._clicks.handled()

    def end(self) -> None:
        """Draw the interface over what is on the screen, and show it."""
        imgui.render()
        self.screen.use()
        imgui.backends.opengl3_render_draw_data(imgui.get_draw_data())
        glfw.swap_buffers(self._handle)

    def skip(self) -> None:
        """End a frame that is not shown, since more keys wait for frames of their own."""
        imgui.end_frame()

    def close(self) -> None:
        """Close the window and end GLFW."""
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        imgui.destroy_context()
        self.ctx.release()
        glfw.destroy_window(self._handle)
        glfw.terminate()

    def reopen(self) -> None:
        """Put a window with a new context in its place, after the old one was lost.

        All that was made in the old context is gone; what the interface shows stays as it is.
        Raises ``ContextError`` where the driver gives no context any more.
        """
        position, size = glfw.get_window_pos(self._handle), glfw.get_window_size(self._handle)
        imgui.backends.opengl3_shutdown()
        imgui.backends.glfw_shutdown()
        abandon(self.ctx)
        glfw.destroy_window(self._handle)
        for attempt in range(_ATTEMPTS):
            try:
                self._open(size)
                break
            except ContextError:
                if attempt == _ATTEMPTS - 1:
                    raise
                time.sleep(_BETWEEN)
        glfw.set_window_pos(self._handle, *position)
        self._start_backends()

    def _open(self, size: tuple[int, int]) -> None:
        self._handle = _create(self._title, size)
        glfw.make_context_current(self._handle)
        glfw.swap_interval(1)
        glfw.set_window_size_limits(self._handle, *_MIN_SIZE, glfw.DONT_CARE, glfw.DONT_CARE)
        self.ctx: moderngl.Context = _adopt()
        self._reset_status = _reset_status(self._handle)
        self._screen_size, self._screen = (0, 0), None

    def _start_backends(self) -> None:
        address = ctypes.cast(self._handle, ctypes.c_void_p).value
        assert address is not None
        pressed: Any = self._press
        glfw.set_mouse_button_callback(self._handle, pressed)  # imgui's own callback hands on to it
        imgui.backends.glfw_init_for_opengl(address, True)
        imgui.backends.opengl3_init("#version 330 core")
        self.keys.listen(self._handle)

    def _press(self, handle: Any, button: int, action: int, _: int) -> None:
        if action == glfw.RELEASE:
            before_release(glfw.get_cursor_pos(handle))
        elif button == glfw.MOUSE_BUTTON_LEFT:
            self._clicks.press()

    def _start_imgui(self) -> Theme:
        imgui.create_context()
        io = imgui.get_io()
        io.set_ini_filename("")  # nothing is left in the current folder
        io.config_windows_move_from_title_bar_only = True
        self._start_backends()
        return Theme(Path(imgui_bundle.__file__).parent / "assets" / "fonts")


def wake() -> None:
    """Wake a window that waits; may be called from any thread."""
    glfw.post_empty_event()


def _create(title: str, size: tuple[int, int]) -> Any:
    complaints = []
    for major, minor in _VERSIONS:
        glfw.default_window_hints()
        glfw.window_hint(glfw.CONTEXT_VERSION_MAJOR, major)
        glfw.window_hint(glfw.CONTEXT_VERSION_MINOR, minor)
        for hint, value in _HINTS.items():
            glfw.window_hint(hint, value)
        for hint in (glfw.WAYLAND_APP_ID, glfw.X11_CLASS_NAME):
            glfw.window_hint_string(hint, "terrain-shader-playground")
        handle = glfw.create_window(*size, title, None, None)
        if handle:
            return handle
        complaints.append(_complaint() or f"no window with OpenGL {major}.{minor}")
    raise ContextError(advice(complaints[0], sys.platform, os.environ))


def _reset_status(handle: Any) -> Callable[[], int] | None:
    """Return OpenGL's function that reports a reset, where the context was made to report one."""
    if glfw.get_window_attrib(handle, glfw.CONTEXT_ROBUSTNESS) != glfw.LOSE_CONTEXT_ON_RESET:
        return None
    for name in ("glGetGraphicsResetStatus", "glGetGraphicsResetStatusKHR", "glGetGraphicsResetStatusARB"):
        address = _address_of(name)
        if address:
            return ctypes.CFUNCTYPE(ctypes.c_uint)(address)
    return None


def _adopt() -> moderngl.Context:
    try:
        return adopt_context(_address_of)
    except Exception as error:  # moderngl raises bare Exception and ValueError
        raise ContextError(advice(str(error), sys.platform, os.environ)) from None


def _address_of(name: str) -> int | None:
    return cast("int | None", glfw.get_proc_address(name))  # a c_void_p comes back as a number


def _refused(otherwise: str) -> ContextError:
    return ContextError(advice(_complaint() or otherwise, sys.platform, os.environ))


def _complaint() -> str:
    """Return what GLFW last complained of."""
    code, text = glfw.get_error()
    message = text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text or "")
    return f"{message} (GLFW error {code:#x})" if code else ""


# ── its place on the screen ───────────────────────────────────────────────────


Rectangle = tuple[int, int, int, int]
"""x, y, width, height, in the screen's units."""


@dataclass(frozen=True)
class Geometry:
    """A window's place on the screen, in the screen's units."""

    x: int
    y: int
    width: int
    height: int
    maximised: bool = False


class WindowPlacement:
    """The place of one window; ``handle`` gives its current GLFW window."""

    def __init__(self, handle: Callable[[], Any]) -> None:
        self._handle = handle
        self._before: Geometry | None = None  # while it fills the screen: its place
        self._dropped: list[Path] = []
        self._listening: Any = None

    @property
    def full(self) -> bool:
        """Whether it fills a screen."""
        return self._before is not None

    def geometry(self) -> Geometry:
        """Return its place, or that before it filled the screen."""
        if self._before is not None:
            return self._before
        handle = self._handle()
        (x, y), (width, height) = glfw.get_window_pos(handle), glfw.get_window_size(handle)
        return Geometry(x, y, width, height, bool(glfw.get_window_attrib(handle, glfw.MAXIMIZED)))

    def move_to(self, at: tuple[int, int]) -> None:
        """Move its upper left corner, at most as far as all of it stays on a screen."""
        handle = self._handle()
        width, height = glfw.get_window_size(handle)
        left, top, right, bottom = glfw.get_window_frame_size(handle)
        frame = at[0] - left, at[1] - top, width + left + right, height + top + bottom
        x, y = on_screen(frame, screens())
        glfw.set_window_pos(handle, x + left, y + top)

    def toggle_full(self) -> None:
        """Fill the screen that most of it is on, or restore its place."""
        handle = self._handle()
        if self._before is not None:
            back, self._before = self._before, None
            no_monitor: Any = None
            glfw.set_window_monitor(
                handle, no_monitor, back.x, back.y, back.width, back.height, glfw.DONT_CARE
            )
            if back.maximised:
                glfw.maximize_window(handle)
            return
        geometry = self.geometry()
        monitors = glfw.get_monitors()
        if not monitors:
            return
        overlaps = [_overlap(geometry, area) for area in screens()]
        monitor = monitors[overlaps.index(max(overlaps))]
        mode = glfw.get_video_mode(monitor)
        self._before = geometry
        glfw.set_window_monitor(handle, monitor, 0, 0, mode.size.width, mode.size.height, mode.refresh_rate)

    def dropped(self) -> list[Path]:
        """Return the files dropped on it since the last call."""
        handle = self._handle()
        if self._listening is not handle:
            took: Any = self.drop
            glfw.set_drop_callback(handle, took)
            self._listening = handle
        paths, self._dropped = self._dropped, []
        return paths

    def drop(self, _: object, names: Iterable[str]) -> None:
        """Store the names of dropped files; GLFW's callback."""
        self._dropped += [Path(name) for name in names]


def screens() -> list[Rectangle]:
    """Return the screens that there are."""
    rectangles = []
    for monitor in glfw.get_monitors():
        (x, y), mode = glfw.get_monitor_pos(monitor), glfw.get_video_mode(monitor)
        rectangles.append((x, y, mode.size.width, mode.size.height))
    return rectangles


def on_screen(window: Rectangle, areas: list[Rectangle]) -> tuple[int, int]:
    """Return where a window's upper left corner goes, so that screens show all of it, or all that fits.

    It stays where they do, also across several; else it goes into the one that shows most of it.
    """
    x, y, width, height = window
    geometry = Geometry(x, y, width, height)
    overlaps = [_overlap(geometry, area) for area in areas]
    if not areas or sum(overlaps) >= width * height:
        return x, y
    left, top, wide, high = areas[overlaps.index(max(overlaps))]
    return max(min(x, left + wide - width), left), max(min(y, top + high - height), top)


def _overlap(geometry: Geometry, area: Rectangle) -> int:
    """Return how much of a window is on a screen."""
    x, y, width, height = area
    across = min(geometry.x + geometry.width, x + width) - max(geometry.x, x)
    down = min(geometry.y + geometry.height, y + height) - max(geometry.y, y)
    return max(across, 0) * max(down, 0)


# ── the clipboard ─────────────────────────────────────────────────────────────


def clipboard_text() -> str:
    """Return the text on the clipboard, "" where there is none; raise ``ContextError`` without a display."""
    glfw.ERROR_REPORTING = "ignore"  # an empty clipboard is an error for GLFW
    if not glfw.init():
        raise ContextError(advice("glfw.init failed", sys.platform, os.environ))
    try:
        no_window: Any = None
        data: Any = glfw.get_clipboard_string(no_window)  # bytes, or None
        return data.decode("utf-8", "replace") if data else ""
    finally:
        glfw.terminate()
