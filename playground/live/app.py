"""Open a sketch in a window and keep it there until it is closed.

One turn: sleep until something happens, take in saved files, draw the panel, draw the
sketch if anything of it changed, put the panel over it. While nothing happens, nothing
is drawn.
"""

from __future__ import annotations

import time
from collections.abc import Mapping
from contextlib import ExitStack, suppress
from datetime import datetime
from pathlib import Path
from typing import cast

from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.engine.plain_forms import silent
from playground.engine.trial import Trial
from playground.errors import Diagnostic, PlaygroundError
from playground.gpu.context import prefer_software
from playground.gpu.said import warnings_of
from playground.gpu.wrap import COMPUTE, FRAGMENT, wrap
from playground.lessons.library import SOURCE, lesson_file
from playground.live.actions import Actions
from playground.live.capture_window import draw_capture
from playground.live.code_window import draw_code, unsaved
from playground.live.drops import draw_drops, opened_from, take_dropped
from playground.live.editors import Opener
from playground.live.errors_list import draw_errors
from playground.live.finite import FiniteWatch, draw_not_finite
from playground.live.follow import Follower
from playground.live.hand import Hand
from playground.live.keymap import draw_keymap
from playground.live.keys import act_on_keys
from playground.live.lesson.beside import Lessons
from playground.live.memory import Remembered
from playground.live.overlay import Area, draw_notices, draw_waiting
from playground.live.panel import Panel
from playground.live.picture import Painter
from playground.live.place import Place
from playground.live.problems import Warnings
from playground.live.remember import QUIET, Rememberer, memory_of
from playground.live.see.ab import drag_line, paint_both
from playground.live.see.timeline import height_of_timeline
from playground.live.see.view import draw_see
from playground.live.session import REST, Session
from playground.live.status import Status
from playground.live.storing import Storing
from playground.live.watch import Watcher
from playground.live.window import Window, wake
from playground.sketch.find import find
from playground.sketch.load import load
from playground.sketch.model import DEFAULT_PICTURE, Kernel, Value
from playground.sketch.places import TEXTS

FRAME = 1 / 60  # [s] between pictures while time runs
IDLE = 1.0  # [s] between turns while nothing happens
_TRIAL = 0.004  # [s] between questions to the trial
_SETTLES = 3  # turns that the panel takes to settle after something happened
_LONGEST_STEP = 0.25  # [s] time never jumps by more, whatever a picture took


def run(
    sketch: str | Path = "",
    *,
    size: tuple[int, int] | None = None,
    software: bool = False,
    driver: str = "auto",
    plain: bool = False,
    values: Mapping[str, object] | None = None,
    fresh: bool = False,
    lesson: str = "",
    language: str = "",
    beside: bool = False,
    keeps: int = 0,
    time_limit: float | None = None,
) -> int:
    """Show a sketch in a window until it is closed; return the exit status.

    ``size`` in the screen's units, ``values`` by path as ``--set`` takes them. What was set
    by hand the last time is set again, unless ``fresh``. ``lesson`` opens one by name, in a
    ``language`` by code; ``beside`` opens the one read last, or the first, beside the sketch,
    unless the reader has closed the lessons. Expensive land is kept on disk, in at most
    ``keeps`` bytes, and taken from there. With a ``time_limit`` [s] the window closes itself.
    Raises ``ContextError`` where no window can be opened, ``SketchError`` where there is no such
    sketch, lesson or language, ``ParameterError`` for a value that does not fit; any other
    mistake in the sketch is shown in the window.
    """
    if lesson:
        lesson_file(lesson, language or SOURCE)  # says so before a window opens, where there is none
    path, unpacked = opened_from(Path(sketch)) if sketch else (find_default(), "")
    checked = _checked(path, values or {})
    if software:
        prefer_software()
    with ExitStack() as stack:
        trial = stack.enter_context(Trial(software=software))
        trial.start()
        memory = memory_of(path)
        found, complaint = (Remembered(), "") if fresh else memory.read()
        opens = size or (found.window if found.window != (0, 0) else DEFAULT_PICTURE)
        window = stack.enter_context(Window(title_of(path), opens))
        engine = Engine(window.ctx, driver=driver, notice=silent)
        session = Session(
            engine,
            path,
            values=checked,
            edits=found.edits,
            in_file=dict(found.in_file),
            camera_in_file=found.camera_in_file,
            plain=plain,
            trial=trial,
            is_lost=lambda: window.lost,
        )
        session.notes.extend(filter(None, [complaint, unpacked]))
        rememberer = Rememberer(session, memory, found)
        watcher = stack.enter_context(Watcher(wake, TEXTS))
        live = Live(window, session, watcher, rememberer, Storing(session, keeps))
        if found.at is not None:
            live.place.stand_at(found.at)
        live.lessons.begin(lesson, language, beside=beside)
        stack.callback(live.release)
        stack.callback(live.actions.capture.close)
        stack.callback(rememberer.close)
        stack.callback(live.storing.close)
        try:
            live.run(time_limit)
        except KeyboardInterrupt:
            return 130
    return 0


def find_default() -> Path:
    """Return the file of the sketch that opens when none is named."""
    from playground.paths import DEFAULT_SKETCH

    return find(DEFAULT_SKETCH)


def title_of(path: Path) -> str:
    """Return the title of a window on a sketch."""
    name = path.parent.name if path.name == "sketch.toml" else path.stem
    return f"{name} – terrain shader playground"


def _checked(path: Path, values: Mapping[str, object]) -> dict[str, Value]:
    """Return values as their parameters take them; raise ``ParameterError`` for one that does not fit.

    Where the sketch does not load yet, nothing can be checked: they wait for it as they are.
    """
    try:
        sketch = load(path) if values else None
    except PlaygroundError:
        sketch = None
    taken = dict(sketch.with_values(values).overrides) if sketch is not None else {}
    return {name: taken.get(name, cast(Value, value)) for name, value in values.items()}


class Live:
    """The window, the session and the watcher, turn by turn."""

    def __init__(
        self, window: Window, session: Session, watcher: Watcher, rememberer: Rememberer, storing: Storing
    ) -> None:
        self.window = window
        self.rememberer = rememberer
        self.storing = storing
        self.session = session
        self.follower = Follower(session, watcher)
        self.panel = Panel()
        self.place = Place(lambda: window.handle)
        self.actions = Actions(session, window.ask_to_close, full_screen=self.place.toggle_full)
        self.actions.opener = Opener(wake)
        self.warnings = Warnings(self._review)
        self.painter = Painter(window.ctx)
        self.status = Status.from_environment()
        rememberer.compare = self.actions.see.compare
        self._settling = _SETTLES
        self._last = time.perf_counter()
        self._reloads = session.last_reload
        self.hand = Hand(session, self.actions.painting)
        self.finite = FiniteWatch()
        self.lessons = Lessons(self.actions, rememberer, self._remember)

    def run(self, time_limit: float | None = None) -> None:
        """Go on until the window is closed, or so many seconds have passed."""
        end = None if time_limit is None else time.perf_counter() + time_limit
        self.follower.follow()
        while self._stays():
            now = self.actions.now()
            patience = min(
                self._patience(), self.actions.see.patience(now), self.lessons.reading.patience(now)
            )
            if end is not None:
                left = end - time.perf_counter()
                if left <= 0:
                    return
                patience = min(patience, left)
            self._sleep(patience)
            self.follower.take(self.actions.painting.files)
            if self.window.pixels != (0, 0):
                self._turn()
            if self.window.lost:
                self.recover()
            self.follower.follow()

    def _stays(self) -> bool:
        """Say whether the window stays; where it is to close and texts are not saved, that is asked first."""
        if self.window.open:
            return True
        if not unsaved(self.actions):
            return False
        self.window.stay()
        self.actions.leaving, self._settling = True, _SETTLES
        return True

    def release(self) -> None:
        """Give back all that was made in the window's context."""
        self.actions.see.release()
        self.lessons.release()
        self.painter.release()
        self.session.release()
        self.session.engine.release()

    def recover(self) -> None:
        """Build everything anew in a new context, after the driver took the old one."""
        driver = self.session.engine.driver
        with suppress(Exception):  # a lost context may refuse even this
            self.release()
        self.window.reopen()
        self.session.rebuild(Engine(self.window.ctx, driver=driver, notice=silent))
        self.storing.attach(self.session.engine)
        self.painter = Painter(self.window.ctx)
        self._settling = _SETTLES

    def _patience(self) -> float:
        """Say how long nothing needs to be done [s]."""
        if self.session.animated and self.session.clock.playing:
            return max(FRAME - (time.perf_counter() - self._last), 0.0)
        if self._settling > 0:
            return 0.0
        if self.session.testing:
            return _TRIAL
        if self.warnings.waiting:
            return 0.0
        if self.session.hasty:
            return REST / 2
        if self.finite.patience is not None:
            return self.finite.patience
        if self.storing.patience is not None:
            return min(self.storing.patience, QUIET / 2)
        if self.rememberer.waits:
            return QUIET / 2
        if self.actions.capture.working is not None:
            return 0.1
        if self.actions.notices or imgui.get_io().want_text_input:
            return 0.1
        return IDLE

    def _sleep(self, seconds: float) -> None:
        start = time.perf_counter()
        self.window.wait(seconds)
        woken = seconds > 0 and time.perf_counter() - start < 0.98 * seconds
        self._settling = _SETTLES if woken else max(self._settling - 1, 0)
        now = time.perf_counter()
        if self.session.animated:
            self.session.advance(min(now - self._last, _LONGEST_STEP), datetime.now())
        self._last = now

    def _turn(self) -> None:
        window, session, actions = self.window, self.session, self.actions
        window.call(title_of(session.path))
        take_dropped(actions, self.place.dropped())
        window.begin()
        actions.see.begin()
        left = self.lessons.draw(window.theme)
        left += self.panel.draw(actions, window.theme, left) if actions.panel_shown else 0.0
        room = imgui.get_main_viewport().size
        area: Area = (left, 0.0, max(room.x - left, 1.0), room.y)
        draw_code(actions, window.theme, area)
        act_on_keys(actions)
        if not drag_line(actions.see.compare, area):
            self.hand.act(area, window.density)
        actions.look_back(imgui.is_mouse_down(0) or imgui.is_mouse_down(1))
        wide, high = window.pixels
        skipped = min(round(left * window.density), wide - 1)
        draws, error = session.draws, session.error
        picture = session.frame((wide - skipped, high))
        if session.draws != draws or session.error is not error:
            self._settling = _SETTLES  # the panel tells what the picture took; an error grows to its size
        self.finite.turn(actions, imgui.is_mouse_down(0) or imgui.is_mouse_down(1))
        self.storing.turn(actions, self.finite)
        self._say_reload()
        actions.take_notes()
        actions.problems.take(session.error, self.warnings.of(session.sketch), session.sketch)
        above = (*area[:3], area[3] - height_of_timeline(actions, window.theme))
        draw_not_finite(self.finite, actions, window.theme, above)
        draw_errors(actions, window.theme, above)
        if picture is None and session.error is None:
            draw_waiting("trying the sketch …", window.theme, area)
        draw_see(actions, picture, window.theme, area, window.density)
        draw_notices(actions, window.theme, area)
        draw_drops(actions, window.theme)
        draw_keymap(actions, window.theme)
        actions.capture.look(actions)
        draw_capture(actions.capture, actions, window.theme)
        window.screen.use()
        window.screen.viewport = (0, 0, wide, high)
        window.ctx.clear(0.06, 0.065, 0.07, 1.0)
        if picture is not None:
            room_left = (skipped, 0, wide - skipped, high)
            if not paint_both(actions.see.compare, picture, window.screen, room_left, actions.now()):
                self.painter.paint(picture, window.screen, room_left)
        window.end()
        if not session.testing and self._settling == 0:
            self.warnings.look()
        self.status.write(actions, self.finite.found)
        rests = self._settling == 0 and not session.testing and not imgui.is_mouse_down(0)
        self.lessons.turn(idle=rests)

    def _remember(self) -> None:
        stands = self.place.geometry()
        self.rememberer.look((stands.width, stands.height), (stands.x, stands.y))

    def _review(self, kernel: Kernel) -> tuple[Diagnostic, ...]:
        """Return what the driver warns of in a kernel that it has drawn with."""
        try:
            driver = COMPUTE if kernel.kind in ("compute", "plain_compute") else FRAGMENT
            return warnings_of(self.window.ctx, wrap(kernel, driver)) if kernel.kind != "source" else ()
        except PlaygroundError:
            return ()

    def _say_reload(self) -> None:
        """Say so when a save has become a picture."""
        latest = self.session.last_reload
        if latest is not self._reloads:
            if self._reloads is not None and self.lessons.reading.stage.own is None:
                self.actions.say(f"reloaded in {latest.seconds * 1e3:.0f} ms" if latest else "")
            self._reloads = latest
