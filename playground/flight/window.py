"""A window to fly in: input, steps of a sixtieth of a second, parts for some milliseconds, a picture.

All parts visible are made before the first step. From then on each picture leaves a little
time to make parts; what is not there yet is far away, in the haze.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import Any

import glfw
from imgui_bundle import ImVec2, imgui

from playground.allowed_files import Signature, noting_places
from playground.engine.context import context_info, prefer_software
from playground.engine.engine import Engine
from playground.engine.sandbox import Sandbox, TrySketch
from playground.errors import DataError, PlaygroundError
from playground.flight.craft import STEP, Controls, Wheel, by_gamepad, by_keys, by_mouse, together
from playground.flight.flight import CACHE_BYTES, RADIUS, Flight
from playground.flight.record import Header, Moment, Record, Recorder
from playground.sketch.load import load
from playground.sketch.model import Sketch
from playground.studio.draw import ctrl_held, letters, plate
from playground.studio.interface import Preferences, remembered_preferences
from playground.studio.keys import pressed_sign
from playground.studio.language import choose_language, counted, language, shortcut, tr
from playground.studio.picture.full_screen import Painter
from playground.studio.reload.dependencies import watched
from playground.studio.reload.stages import Sandbox as Stage
from playground.studio.reload.stages import explained, refusal
from playground.studio.reload.watcher import Watcher
from playground.studio.status import add_line, status_file
from playground.studio.theme import DARK, Rgb, Theme, packed
from playground.studio.window import Window, wake

# isort: split


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
        preferences = remembered_preferences()
        choose_language(preferences.language)
        window = stack.enter_context(Window(f"{sketch.name} – {tr('flight')}", size))
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
        live = Fly(window, flight, preferences, recorder, iter(replay) if replay else None, saves)
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
        preferences: Preferences,
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
        self.preferences = preferences
        window.zoom = self.preferences.size
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
            why = error.diagnostics[0].message
            self.instruments.trouble = tr("no longer recorded: {why}", why=why)

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
            self.preferences.choose(size=1.0)
        elif key:
            self.preferences.step(1 if key == "+" else -1)
        self.window.zoom = self.preferences.size

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
            "language": language(),
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
}
# Their keys depend on the keyboard.
_LETTERS = {"[": "earlier", ",": "earlier", "]": "later", ".": "later", "?": "help"}
# GLFW's standard mapping: bumpers, back, start.
_PAD = {4: "earlier", 5: "later", 6: "reset", 7: "pause"}


def _pressed() -> set[str]:
    pressed = {name for key, name in _PRESSES.items() if imgui.is_key_pressed(key, repeat=False)}
    return pressed | {name for letter, name in _LETTERS.items() if letter in letters()}


# ── instruments ────────────────────────────────────────────────────────────────


_MARGIN, _PADDING = 14.0, 8.0
_ERRORS = 6  # lines of what is wrong that are shown


def help_rows() -> tuple[tuple[str, str], ...]:
    """Return the keys of a flight and what each does, in the language that is in use."""
    return (
        ("S ↓   W ↑", tr("nose up, nose down")),
        ("A ←   D →", tr("bank left, bank right")),
        ("Q   E", tr("turn left, turn right")),
        (shortcut("Shift   Ctrl"), tr("faster, slower (also Page Up, Page Down)")),
        (tr("left button held"), tr("the mouse is the stick")),
        (tr("wheel"), tr("throttle")),
        (tr("gamepad"), tr("left stick flies, right stick turns, triggers for speed")),
        ("[   ]   ,   .", tr("half an hour earlier, later (gamepad: bumpers)")),
        (shortcut("P   Space"), tr("pause (gamepad: Start)")),
        ("R", tr("back to the start (gamepad: Back)")),
        ("?   F1", tr("this help")),
        (shortcut("Ctrl +   Ctrl -   Ctrl 0"), tr("text larger, smaller, at its first size")),
        (shortcut("Esc"), tr("close this help; pause")),
        (shortcut("Ctrl+Q"), tr("quit, while paused")),
    )


class Instruments:
    """Text over the picture, drawn by imgui."""

    def __init__(self, *, recording: bool, replaying: bool) -> None:
        self.help = False
        self.recording = recording
        self.replaying = replaying
        self.ended = False  # a replay has come to its end
        self.trouble = ""  # why nothing is recorded any more
        self.error: PlaygroundError | None = None  # of what was saved
        self.changing = False  # what was saved is being made

    def draw(self, flight: Flight, theme: Theme, *, ready: bool, paused: bool) -> None:
        """Draw everything for this frame."""
        room = imgui.get_main_viewport().size
        if not ready:
            there = len(flight.parts.visible) - flight.parts.missing
            count = len(flight.parts.visible)
            text = tr("making the terrain: {there} of {count} parts", there=there, count=count)
            _plate(text, theme, (room.x / 2, room.y / 2), align=(0.5, 0.5))
            return
        low = room.y - _MARGIN
        _plate(self._values(flight), theme, (_MARGIN, low), align=(0.0, 1.0))
        state = "   ".join([*(label for label, on in self._states(paused) if on), tr("?  help")])
        ink = DARK.alarm if self.ended or self.trouble else DARK.ink
        _plate(state, theme, (room.x - _MARGIN, low), align=(1.0, 1.0), ink=ink)
        if self.error is not None:
            self._draw_error(self.error, theme, room)
        elif self.changing:
            _plate(tr("making the saved terrain"), theme, (room.x / 2, _MARGIN), align=(0.5, 0.5))
        if self.help:
            self._draw_help(theme, room)

    def _states(self, paused: bool) -> tuple[tuple[str, bool], ...]:
        return (
            (self.trouble, bool(self.trouble)),
            (tr("recording"), self.recording),
            (tr("end of the replay: Ctrl+Q quits"), self.ended),
            (tr("replay"), self.replaying and not self.ended),
            (tr("paused: P flies on, Ctrl+Q quits"), paused and not self.ended),
        )

    def _values(self, flight: Flight) -> str:
        craft = flight.craft
        degrees = round(math.degrees(craft.heading)) % 360
        wind = tr("N NE E SE S SW W NW").split()[round(degrees / 45) % 8]
        speed, throttle = f"{craft.speed * 3.6:.0f}", f"{craft.throttle * 100:.0f}"
        ground, sea = f"{flight.above_ground:.0f}", f"{flight.above_sea:.0f}"
        lines = [
            tr("{speed} km/h   throttle {throttle} %", speed=speed, throttle=throttle),
            tr("{ground} m above ground   {sea} m above sea", ground=ground, sea=sea),
            tr("heading {degrees}° {wind}", degrees=f"{degrees:03d}", wind=wind),
        ]
        if flight.plot.hour:
            lines[-1] += f"   {clock(flight.hour)}"
        return "\n".join(lines)

    def _draw_error(self, error: PlaygroundError, theme: Theme, room: ImVec2) -> None:
        """Write the first lines of a save's error along the upper edge."""
        lines = str(error).split("\n")
        shown = lines[:_ERRORS]
        if len(lines) > _ERRORS:
            shown.append(tr("… and {lines} more", lines=counted(len(lines) - _ERRORS, "line")))
        text = "\n".join([*shown, tr("the flight goes on over the last good save")])
        wide = max(room.x - 2 * (_MARGIN + _PADDING), 80.0)
        _plate(text, theme, (_MARGIN, _MARGIN), ink=DARK.alarm, alpha=0.85, wrap=wide)

    def _draw_help(self, theme: Theme, room: ImVec2) -> None:
        with theme.font(theme.text):
            line, pad, gap = imgui.get_text_line_height() * 1.45, 18.0, 24.0
            rows = help_rows()
            keys = max(imgui.calc_text_size(key).x for key, _ in rows)
            wide = keys + gap + max(imgui.calc_text_size(meaning).x for _, meaning in rows) + 2 * pad
            high = line * len(rows) + 2 * pad
            left, top = max((room.x - wide) / 2, 0.0), max((room.y - high) / 2, 0.0)
            over = imgui.get_foreground_draw_list()
            corner = ImVec2(left + wide, top + high)
            over.add_rect_filled(ImVec2(left, top), corner, packed((0.06, 0.07, 0.08), 0.88), 8.0)
            for number, (key, meaning) in enumerate(rows):
                y = top + pad + number * line
                over.add_text(ImVec2(left + pad, y), packed(DARK.warm), key)
                over.add_text(ImVec2(left + pad + keys + gap, y), packed(DARK.ink), meaning)


def _plate(
    text: str,
    theme: Theme,
    corner: tuple[float, float],
    *,
    align: tuple[float, float] = (0.0, 0.0),
    ink: Rgb = DARK.ink,
    alpha: float = 0.55,
    wrap: float = -1.0,
) -> None:
    """Write text on a dark plate, as ``draw.plate`` places it."""
    with theme.font(theme.code):
        plate(
            imgui.get_foreground_draw_list(),
            text,
            corner,
            ink=packed(ink),
            ground=packed((0.04, 0.05, 0.06), alpha),
            padding=_PADDING,
            rounding=6.0,
            wrap=wrap,
            align=align,
        )


def clock(hour: float) -> str:
    """Return a time of day as a clock shows it."""
    minutes = round(hour * 60) % (24 * 60)
    return f"{minutes // 60:02d}:{minutes % 60:02d}"


# ── what was saved ─────────────────────────────────────────────────────────────


class SaveFollower:
    """One sketch's; use it with ``with``.

    ``values`` are set over what its files say, ``shown`` is the sketch that is flown over,
    ``wake`` is called from another thread when something was saved.
    """

    def __init__(
        self,
        path: Path,
        shown: Sketch,
        values: Mapping[str, object],
        sandbox: Stage,
        driver: str,
        wake: Callable[[], None],
    ) -> None:
        self.error: PlaygroundError | None = None
        self._path = path
        self._shown = shown
        self._values = dict(values)
        self._sandbox = sandbox
        self._driver = driver
        self._checked: Sketch | None = None  # waits for the sandbox's answer
        self._watcher = Watcher(wake)
        self._places: Mapping[Path, Signature | None] = {}
        self._follow(time.time())

    def __enter__(self) -> SaveFollower:
        self._watcher.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._watcher.stop()

    @property
    def waits(self) -> bool:
        """Whether an answer of the sandbox is awaited."""
        return self._checked is not None

    def update(self) -> Sketch | None:
        """Take in what was saved; return a sketch that has proved good and is another than the one shown."""
        if self._watcher.take():
            self._read()
        if self._checked is None:
            return None
        report = self._sandbox.poll()
        if report is None:
            return None
        good, self._checked, self.error = self._checked, None, refusal(report)
        if self.error is not None:
            self._follow(time.time())
            return None
        self._shown = good
        return good

    def refuse(self, error: Exception) -> None:
        """Say that the sketch returned last cannot be flown over after all."""
        self.error = explained(error, self._path)

    def _read(self) -> None:
        read_at = time.time()
        self._checked = None
        try:
            with noting_places() as self._places:
                sketch = load(self._path).plainly(self._shown.plain).with_values(self._values)
        except Exception as error:
            self.error = explained(error, self._path)
        else:
            # One that was refused is tried again: what it depends on may have changed.
            if sketch == self._shown and self.error is None:
                return
            self._checked = sketch
            self._sandbox.submit(TrySketch(sketch, drivers=(self._driver,)))
        self._follow(read_at)

    def _follow(self, read_at: float) -> None:
        sketches = [sketch for sketch in (self._shown, self._checked) if sketch is not None]
        errors = [self.error] if self.error is not None else []
        files = watched(self._path, sketches, errors, self._places)
        self._watcher.follow(files, read_at=read_at, read=self._places)
