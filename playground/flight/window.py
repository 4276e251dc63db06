"""A window to fly in: input, steps of a sixtieth of a second, parts for some milliseconds, a picture.

All parts visible are made before the first step. From then on each picture leaves a little
time to make parts; what is not there yet is far away, in the haze.
"""

from __future__ import annotations

import math
import time
from collections.abc import Iterator, Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Any

from imgui_bundle import imgui

# isort: split
import glfw

from playground.engine.context import context_info, prefer_software
from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox
from playground.errors import DataError
from playground.flight.controls import Wheel, by_gamepad, by_keys, by_mouse, together
from playground.flight.craft import STEP, Controls
from playground.flight.flight import CACHE_BYTES, RADIUS, Flight
from playground.flight.instruments import Instruments
from playground.flight.record import Header, Moment, Record, Recorder
from playground.flight.reload import SaveFollower
from playground.sketch.model import Sketch
from playground.studio.draw import ctrl_held, letters
from playground.studio.interface import remembered_size
from playground.studio.keys import pressed_sign
from playground.studio.picture.full_screen import Painter
from playground.studio.status import add_line, status_file
from playground.studio.window import Window, wake

MAKING = 0.005  # [s] of each picture for parts
OPENING = 0.05  # [s] between pictures before the first step
DRAWN = 640 * 360  # [pixels] that a processor draws in time; a larger window shows them larger
MAX_STEPS = 6  # of one picture: on a slower machine time goes slower
HOURS = 0.5  # that a key moves the time of day
_IDLE = 0.1  # [s] between frames while it is paused
_WRITES = 0.05  # [s] between lines of the status

_K = imgui.Key
_HOLDS: dict[str, tuple[imgui.Key, ...]] = {
    "up": (_K.s, _K.down_arrow),
    "down": (_K.w, _K.up_arrow),
    "left": (_K.a, _K.left_arrow),
    "right": (_K.d, _K.right_arrow),
    "yaw_left": (_K.q,),
    "yaw_right": (_K.e,),
    "faster": (_K.left_shift, _K.right_shift, _K.page_up),
    "slower": (_K.left_ctrl, _K.right_ctrl, _K.page_down),
}


def run(
    sketch: Sketch,
    name: str,
    *,
    size: tuple[int, int],
    values: Mapping[str, object] | None = None,
    record: str = "",
    replay: Record | None = None,
    radius: float | None = None,
    software: bool = False,
    driver: str = "auto",
    time_limit: float | None = None,
) -> int:
    """Fly in a window until it is closed; return the exit status.

    ``name`` is what a record calls the sketch, ``values`` what was set of it. With a
    ``time_limit`` [s] the window closes itself. Raises ``ContextError`` where no window can be
    opened, ``SketchError`` where the sketch cannot be flown over, ``DataError`` where the
    record cannot be written.
    """
    if software:
        prefer_software()
    with ExitStack() as stack:
        window = stack.enter_context(Window(f"{sketch.name} – flight", size))
        engine = stack.enter_context(Engine(window.ctx, driver=driver, cache_bytes=CACHE_BYTES))
        header = replay.header if replay else Header(name, size, {}, radius or RADIUS)
        # A processor draws four samples in four times the time of one.
        samples = 1 if context_info(window.ctx).software else sketch.picture.samples
        flight = stack.enter_context(
            Flight(engine, sketch, radius=header.radius, start=header.start, samples=samples)
        )
        recorder = None
        if record:
            recorder = stack.enter_context(
                Recorder(Path(record).expanduser(), replace(header, values=dict(values or {})))
            )
        saves = None
        if replay is None:  # a recorded flight is over the terrain that it was recorded over
            sandbox = stack.enter_context(Sandbox(software=software))
            sandbox.start()
            path = Path(flight.sketch.file)
            saves = stack.enter_context(SaveFollower(path, sketch, values or {}, sandbox, driver, wake))
        live = Fly(window, flight, recorder, iter(replay) if replay else None, saves)
        stack.callback(live.painter.release)
        try:
            live.run(time_limit)
        except KeyboardInterrupt:
            return 130
    return 0


class Fly:
    """The window and the flight, frame by frame."""

    def __init__(
        self,
        window: Window,
        flight: Flight,
        recorder: Recorder | None,
        replay: Iterator[Moment] | None,
        saves: SaveFollower | None = None,
    ) -> None:
        self.window = window
        self.flight = flight
        self.recorder = recorder
        self.replay = replay
        self.saves = saves
        self.painter = Painter(window.ctx)
        self.size = remembered_size()
        window.zoom = self.size.size
        self.instruments = Instruments(recording=recorder is not None, replaying=replay is not None)
        self.paused = False
        self.draws = 0
        self.changes = 0  # saves that are flown over by now
        self._ready = False
        self._owed = 0.0  # [s] that have passed and were not flown yet
        self._last = time.perf_counter()
        self._hour: float | None = None  # to be set with the next step
        self._reset = False
        self._buttons: tuple[int, ...] = ()
        self._wheel = Wheel()
        self._status = status_file()
        self._written = 0.0

    def run(self, time_limit: float | None = None) -> None:
        """Run frames until the window is closed, or for a limited time [s]."""
        end = math.inf if time_limit is None else time.perf_counter() + time_limit
        while self.window.open and time.perf_counter() < end:
            busy = self.flight.changing or (self.saves is not None and self.saves.waits)
            resting = self._ready and self.paused and not self.flight.parts.missing and not busy
            self.window.wait(_IDLE if resting else 0.0)
            if self.window.pixels == (0, 0):
                self.window.wait(_IDLE)
                self._last = time.perf_counter()
                continue
            self._draw_frame()

    def _draw_frame(self) -> None:
        window, flight = self.window, self.flight
        window.begin()
        self._take_keys()
        now = time.perf_counter()
        passed, self._last = now - self._last, now
        self._take_saves()
        if not self._ready:
            flight.parts.tend_for(OPENING)
            self._ready = flight.parts.missing == 0
        elif not flight.changing:
            if not self.paused:
                self._fly(passed)
            flight.parts.tend_for(MAKING)
        size = window.pixels
        picture = flight.draw(self._drawn(size)) if self._ready else None
        self.draws += 1
        self.instruments.draw(flight, window.theme, ready=self._ready, paused=self.paused)
        window.screen.use()
        window.screen.viewport = (0, 0, *size)
        window.ctx.clear(0.06, 0.065, 0.07, 1.0)
        if picture is not None:
            self.painter.paint(picture, window.screen, (0, 0, *size))
        window.end()
        self._write_status()

    def _take_saves(self) -> None:
        """Switch to what was saved, once its parts are made; until then time is paused."""
        saves, flight = self.saves, self.flight
        if saves is None:
            return
        try:
            coming = saves.update()
            if coming is not None:
                flight.change(coming)
            if flight.changing and self._ready and flight.tend_change(OPENING):
                self.changes += 1
                self._last = time.perf_counter()
        except Exception as error:
            saves.refuse(error)
        self.instruments.error = saves.error
        self.instruments.changing = flight.changing

    def _drawn(self, size: tuple[int, int]) -> tuple[int, int]:
        """Return how large the picture is drawn that fills a window of that size [pixels]."""
        if not self.flight.engine.info.software:
            return size
        share = min(math.sqrt(DRAWN / (size[0] * size[1])), 1.0)
        return max(round(size[0] * share), 1), max(round(size[1] * share), 1)

    def _fly(self, passed: float) -> None:
        """Fly the steps of the time that has passed, at most ``MAX_STEPS``."""
        self._owed = min(self._owed + passed, MAX_STEPS * STEP)
        controls = self._controls() if self.replay is None else Controls()
        while self._owed >= STEP:
            self._owed -= STEP
            moment = Moment(together(controls, self._wheel.next()), self._hour, self._reset)
            if self.replay is not None:
                replay = next(self.replay, None)
                if replay is None:
                    self.paused, self.instruments.ended = True, True
                    return
                moment = replay
            self._hour, self._reset = None, False
            self._record(moment)
            self.flight.step(moment, 0)

    def _record(self, moment: Moment) -> None:
        """Record a step; where that fails, show so and fly on."""
        if self.recorder is None:
            return
        try:
            self.recorder.add(moment)
        except DataError as error:
            self.recorder, self.instruments.recording = None, False
            self.instruments.trouble = f"no longer recorded: {error.diagnostics[0].message}"

    # ── input ────────────────────────────────────────────────────────────────

    def _controls(self) -> Controls:
        self._wheel.scroll(imgui.get_io().mouse_wheel)
        held = {name for name, keys in _HOLDS.items() if any(map(imgui.is_key_down, keys))}
        controls_held = [by_keys(held)]
        if imgui.is_mouse_down(0):
            gone = imgui.get_mouse_drag_delta(0, 0.0)
            controls_held.append(by_mouse(gone.x, gone.y, imgui.get_main_viewport().size.y))
        pad = self._gamepad()
        if pad is not None:
            controls_held.append(by_gamepad(list(pad.axes)))
        return together(*controls_held)

    def _gamepad(self) -> Any:
        """Return the state of the first gamepad, None where there is none."""
        for number in range(glfw.JOYSTICK_1, glfw.JOYSTICK_LAST + 1):
            if glfw.joystick_is_gamepad(number):
                return glfw.get_gamepad_state(number)
        return None

    def _take_keys(self) -> None:
        """Act on each key pressed since the last frame, once."""
        pressed = _pressed()
        pad = self._gamepad()
        if pad is not None:
            held = tuple(int(b) for b in pad.buttons)
            fresh = {n for n, b in enumerate(held) if b and not (self._buttons[n : n + 1] or (0,))[0]}
            self._buttons = held
            pressed |= {name for number, name in _PAD.items() if number in fresh}
        ctrl = ctrl_held()
        if self.paused and "quit" in pressed and ctrl:
            self.window.ask_to_close()
        if ctrl:
            zero = imgui.is_key_pressed(imgui.Key._0)
            self._resize("0" if zero else pressed_sign(lambda: self.window.sign_held))
        if "leave" in pressed:
            self._leave()
        if "help" in pressed:
            self.instruments.help = not self.instruments.help
        if "pause" in pressed:
            self.paused = not self.paused
        if self.replay is not None:
            return
        if "reset" in pressed:
            self._reset, self.paused = True, False
        for name, hours in (("earlier", -HOURS), ("later", HOURS)):
            if name in pressed and self.flight.plot.hour:
                hour = self.flight.hour if self._hour is None else self._hour
                self._hour = (hour + hours) % 24.0
                self.paused = False

    def _resize(self, key: str) -> None:
        """Draw text larger, smaller or as large as the screen says, and remember it for every window."""
        if key == "0":
            self.size.choose(1.0)
        elif key:
            self.size.step(1 if key == "+" else -1)
        self.window.zoom = self.size.size

    def _leave(self) -> None:
        """Close the help; else pause. Esc never quits: in flight Ctrl and Q are controls."""
        if self.instruments.help:
            self.instruments.help = False
        else:
            self.paused = True

    def _write_status(self) -> None:
        """Append a line of status, at most twenty a second."""
        now = time.perf_counter()
        if self._status is None or now - self._written < _WRITES:
            return
        self._written = now
        craft = self.flight.craft
        line = {
            "draws": self.draws,
            "ready": self._ready,
            "paused": self.paused,
            "help": self.instruments.help,
            "zoom": self.window.zoom,
            "hour": self.flight.hour,
            "steps": craft.steps,
            "up": craft.up,
            "pitch": craft.pitch,
            "roll": craft.roll,
            "heading": craft.heading,
            "throttle": craft.throttle,
            "parts": len(self.flight.parts),
            "missing": self.flight.parts.missing,
            "changes": self.changes,
            "error": str(self.saves.error) if self.saves is not None and self.saves.error else "",
        }
        add_line(self._status, line)


_PRESSES: dict[imgui.Key, str] = {
    _K.escape: "leave",
    _K.q: "quit",
    _K.f1: "help",
    _K.p: "pause",
    _K.space: "pause",
    _K.r: "reset",
    _K.left_bracket: "earlier",
    _K.right_bracket: "later",
    _K.comma: "earlier",
    _K.period: "later",
}
# GLFW's standard mapping: bumpers, back, start.
_PAD = {4: "earlier", 5: "later", 6: "reset", 7: "pause"}


def _pressed() -> set[str]:
    pressed = {name for key, name in _PRESSES.items() if imgui.is_key_pressed(key, repeat=False)}
    return pressed | ({"help"} if "?" in letters() else set())  # its key depends on the keyboard
