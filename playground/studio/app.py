"""Open a sketch in a window and keep it there until it is closed.

One frame: sleep until something happens, take in saved files, draw the panel, draw the
sketch if anything of it changed, put the panel over it. While nothing happens, nothing
is drawn. Each part of a frame has a guard: one that fails is left out, and the window stays.
"""

from __future__ import annotations

import gc
import time
from collections.abc import Callable, Mapping
from contextlib import ExitStack, suppress
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, cast

from imgui_bundle import imgui

from playground import rooms
from playground.allowed_files import TEXTS
from playground.engine.context import prefer_software
from playground.engine.engine import Engine
from playground.engine.programs import warnings_of
from playground.engine.sandbox import Sandbox
from playground.engine.trace.live_texel import live_file
from playground.errors import Diagnostic, PlaygroundError
from playground.paths import DEFAULT_SKETCH, PLAIN_SKETCH, state_folder
from playground.shader.wrap import COMPUTE, FRAGMENT, wrap
from playground.sketch.find import find
from playground.sketch.load import load
from playground.sketch.model import DEFAULT_PICTURE, ComputeVariant, CpuSource, Kernel, PlainCompute, Value
from playground.studio import focus, theme
from playground.studio.addition import Addition, FullScreen
from playground.studio.bench import Host, Workbench
from playground.studio.code.editors import Opener
from playground.studio.code.panel import draw_code, draw_questions
from playground.studio.code.unsaved_texts import KeptTexts
from playground.studio.compare.panel import below_bar, paint_both
from playground.studio.cost.panel import draw_readout
from playground.studio.cost.readout import Readout
from playground.studio.cursor import draw_cursor, feed
from playground.studio.draw import Area, tooltip_waits
from playground.studio.drops import Drops, opened_from
from playground.studio.edits.autosave import QUIET, Autosave, memory_of
from playground.studio.edits.memory import Remembered
from playground.studio.graph.panel import passes_tab
from playground.studio.guard import Guard
from playground.studio.interface import WindowControls, remembered_preferences
from playground.studio.keyframes.panel import height_of_timeline
from playground.studio.keymap_panel import draw_keymap
from playground.studio.keys import PictureKeys, act_on_keys
from playground.studio.language import choose_language, tr
from playground.studio.mouse import PictureMouse
from playground.studio.overlay import (
    checking_text,
    draw_behind,
    draw_checking,
    draw_drops,
    draw_inspection,
    draw_notices,
    draw_waiting,
)
from playground.studio.panel.panel import Panel
from playground.studio.panes import PaneLayout
from playground.studio.picture.disk_caching import SessionCaching
from playground.studio.picture.full_screen import Painter
from playground.studio.picture.panel import draw_part_labels
from playground.studio.problems.non_finite import FiniteWatch
from playground.studio.problems.panel import ErrorsList, draw_border, draw_not_finite
from playground.studio.problems.problems import TerminalErrors, Warnings, to_log
from playground.studio.reload.watcher import Follower, Watcher
from playground.studio.remote.remotes import Remotes
from playground.studio.session import Session
from playground.studio.settings_panel import draw_hints
from playground.studio.start.panel import StartPanel
from playground.studio.status import Status
from playground.studio.trace.live import LiveTexelFile
from playground.studio.trace.panel import draw_mark, trace_tab
from playground.studio.versions.panel import VersionsPanel
from playground.studio.window import Window, WindowPlacement, wake

if TYPE_CHECKING:
    import moderngl

FRAME = 1 / 60  # [s] between pictures while time runs
IDLE = 1.0  # [s] between frames while nothing happens
_SANDBOX = 0.1  # [s] between questions to the sandbox, whose answer wakes the window
_SETTLES = 3  # frames that the panel takes to settle after something happened
_MAX_STEP = 0.25  # [s] time never jumps by more, however long a frame took


def run(
    sketch: str | Path = "",
    *,
    size: tuple[int, int] | None = None,
    software: bool = False,
    driver: str = "auto",
    plain: bool = False,
    dialect: str = "",
    values: Mapping[str, object] | None = None,
    fresh: bool = False,
    request: Mapping[str, object] | None = None,
    cache_limit: int = 0,
    time_limit: float | None = None,
    sandbox: Sandbox | None = None,
    report: Callable[[str], None] = to_log,
    remotes: Remotes | None = None,
    start_page: bool = False,
) -> int:
    """Show a sketch in a window until it is closed; return the exit status.

    ``size`` in the screen's units, ``values`` by path as ``--set`` takes them. The user's edits
    of the last time are restored, unless ``fresh``. ``request`` is what the additions of
    rooms are asked for, by name (``Addition.begin``). Expensive terrain is cached on disk, in at most
    ``cache_limit`` bytes, and taken from there. With a ``time_limit`` [s] the window closes itself.
    ``sandbox``: one that has been started already, and is its owner's.
    ``report`` receives each error, for the terminal. ``remotes`` are closed by who opened them.
    ``start_page``: the window begins with it.
    Raises ``ContextError`` where no window can be opened, ``SketchError`` where there is no such
    sketch, or nothing that the request names, ``ParameterError`` for a value that does not fit; any other
    mistake in the sketch is shown in the window.
    """
    for module in rooms.modules("addition"):
        module.check_request(request or {})
    path, unpacked = (
        opened_from(Path(sketch)) if sketch else (find(PLAIN_SKETCH if start_page else DEFAULT_SKETCH), "")
    )
    checked = _checked(path, values or {}, dialect)
    if software:
        prefer_software()
    with ExitStack() as stack:
        gc.freeze()  # what was imported stays: no collection while pictures move goes through it
        stack.callback(gc.unfreeze)
        if sandbox is None:
            sandbox = stack.enter_context(Sandbox(software=software))
            sandbox.start()
        memory = memory_of(path)
        remembered, complaint = (Remembered(), "") if fresh else memory.read()
        opens = size or (remembered.window if remembered.window != (0, 0) else DEFAULT_PICTURE)
        window = stack.enter_context(Window(title_of(path), opens))
        sandbox.on_answer = wake
        engine = Engine(window.ctx, driver=driver)
        session = Session(
            engine,
            path,
            values=checked,
            start=remembered.start,
            plain=plain,
            dialect=dialect,
            sandbox=sandbox,
            is_lost=lambda: window.lost,
        )
        session.notes.extend(filter(None, [complaint, unpacked]))
        autosave = Autosave(session, memory, remembered)
        watcher = stack.enter_context(Watcher(wake, TEXTS))
        tracer = stack.enter_context(Sandbox(software=software))
        tracer.on_answer = wake
        caching = SessionCaching(session, cache_limit)
        live = Live(window, session, watcher, autosave, caching, report, tracer)
        live.remotes = remotes or stack.enter_context(Remotes())
        live.remotes.attach(live.bench, wake)
        if remembered.at is not None:
            live.place.move_to(remembered.at)
        for addition in live.additions:
            addition.begin(request or {})
        stack.callback(live.release)
        for addition in live.additions:
            stack.callback(addition.close)
        stack.callback(live.finish_painting, report)
        stack.callback(autosave.close)
        stack.callback(live.note_recent)
        if start_page:
            live.bench.start.open()
        stack.callback(live.caching.close)
        try:
            live.run(time_limit)
        except KeyboardInterrupt:
            return 130
    return 0


def title_of(path: Path) -> str:
    """Return the title of a window on a sketch."""
    name = path.parent.name if path.name == "sketch.toml" else path.stem
    return f"{name} – terrain shader playground"


def _pixels_of(area: Area, window: Window) -> tuple[int, int, int, int]:
    """Return what an area covers of the screen: x, y from below, width, height [pixels]."""
    (wide, high), density = window.pixels, window.density
    left = min(round(area[0] * density), wide - 1)
    top = min(round(area[1] * density), high - 1)
    across = max(min(round(area[2] * density), wide - left), 1)
    down = max(min(round(area[3] * density), high - top), 1)
    return left, high - top - down, across, down


def _checked(path: Path, values: Mapping[str, object], dialect: str) -> dict[str, Value]:
    """Return values as their parameters take them; raise ``ParameterError`` for one that does not fit.

    Where the sketch does not load yet, nothing can be checked: they wait for it as they are.
    """
    try:
        sketch = load(path, dialect=dialect) if values else None
    except PlaygroundError:
        sketch = None
    if sketch is None:
        return cast(dict[str, Value], dict(values))
    taken = dict(sketch.with_values(values).overrides)
    return {path: taken.get(path, cast(Value, value)) for path, value in values.items()}


class Live:
    """Runs the frames of a window: wait, read saved files, draw the interface, draw the sketch."""

    def __init__(
        self,
        window: Window,
        session: Session,
        watcher: Watcher,
        autosave: Autosave,
        caching: SessionCaching,
        report: Callable[[str], None],
        tracer: Sandbox,
    ) -> None:
        self.window = window
        self.autosave = autosave
        self.caching = caching
        self.session = session
        self.panel = Panel()
        self.place = WindowPlacement(lambda: window.handle)
        controls = WindowControls(
            quit=window.ask_to_close,
            toggle_full=self.place.toggle_full,
            is_full=lambda: self.place.full,
            sign_held=lambda: window.sign_held,
        )
        preferences = remembered_preferences()
        self.bench = Workbench(
            session,
            controls,
            opener=Opener(wake),
            preferences=preferences,
            wake=wake,
            trace_sandbox=tracer,
            kept=KeptTexts(state_folder() / "unsaved"),
        )
        self.follower = Follower(session, watcher, self.bench.files.take_saved)
        choose_language(preferences.language)
        self.bench.tabs.append(passes_tab(self.bench))
        self.panes = PaneLayout(self.bench.panes)
        self.drops = Drops(self.bench.actions)
        self.guard = Guard(self.bench.notices.say)
        self.terminal = TerminalErrors(report)
        self.warnings = Warnings(self._review)
        self.painter = Painter(window.ctx)
        self.start_panel = StartPanel(window.ctx)
        self.versions_panel = VersionsPanel(window.ctx, self.bench.versions)
        self.bench.tabs.append(self.versions_panel.tab)
        self.bench.tabs.append(trace_tab(self.bench.tracing))
        self.status = Status()
        autosave.compare = self.bench.inspection.compare
        self.bench.actions.opens = self._open
        self._settling = _SETTLES
        self._last = time.perf_counter()
        self._reloads = session.last_reload
        self.mouse = PictureMouse(self.bench)
        self.keys = PictureKeys(self.bench)
        session.engine.runner.inputs.is_live = True
        self.finite = FiniteWatch()
        self.readout = Readout(session, time.perf_counter)
        host = Host(self.bench, autosave, self._remember, wake, lambda: window.theme)
        self.additions: list[Addition] = [m.open_addition(host) for m in rooms.modules("addition")]
        self.bench.additions = self.additions
        self.live_texel = LiveTexelFile(self.bench.tracing, live_file(), time.monotonic)
        self.remotes = Remotes()

    def run(self, time_limit: float | None = None) -> None:
        """Run frames until the window is closed, or for a limited time [s]."""
        end = None if time_limit is None else time.perf_counter() + time_limit
        self.guard.run("watching the files", self.follower.follow, None)
        while self._stays_open():
            now = self.bench.notices.now()
            others = (
                self.bench.inspection.patience(now),
                self.bench.tracing.patience,
                self.live_texel.patience,
                self.bench.versions.patience,
                *(addition.patience for addition in self.additions),
            )
            patience = min(self._patience(), *others)
            if end is not None:
                left = end - time.perf_counter()
                if left <= 0:
                    return
                patience = min(patience, left)
            self._sleep(patience)
            self.guard.run("reading what was saved", self._take_saved, None)
            self.guard.run("what a remote asks for", self.remotes.take, None)
            for addition in self.additions:
                self.guard.run(f"what {addition.name} is asked for", addition.take, None)
            if self.window.pixels != (0, 0):
                self._draw_frame()
            if self.window.lost:
                self.recover()
            self.guard.run("watching the files", self.follower.follow, None)

    def _take_saved(self) -> None:
        if self.follower.take(self.bench.painting.files):
            self._settling = _SETTLES  # an error grows to its size

    def _stays_open(self) -> bool:
        """Return whether the window stays; what is typed and not saved is kept where it closes."""
        if self.window.open:
            return True
        self.bench.files.keep_typed()
        return False

    def _open(self, path: Path) -> None:
        """Open another sketch with what is remembered of it; the one that is left becomes a recent one."""
        self.bench.versions.leave()
        self.note_recent()
        self.autosave.open(path)

    def note_recent(self) -> None:
        """Put the sketch that is shown first among the recent ones, with its picture."""
        session = self.session
        sketch, frame = session.sketch, None
        if session.draws and sketch is not None and not any(a.shows_own for a in self.additions):
            with suppress(PlaygroundError):
                frame = session.read()
            title = sketch.title.strip() or session.path.stem
            self.bench.start.recent.note(session.path, title, None if frame is None else frame.array)

    def finish_painting(self, report: Callable[[str], None]) -> None:
        """Wait until what is painted is written; the terminal learns of what cannot be."""
        for error in self.bench.painting.close():
            report(error)

    def release(self) -> None:
        """Release all that was made in the window's context."""
        self.bench.inspection.release()
        self.bench.tracing.release()
        self.live_texel.close()
        self.start_panel.release()
        self.versions_panel.release()
        for addition in self.additions:
            addition.release()
        self.painter.release()
        self.session.engine.runner.inputs.close()
        self.session.release()
        self.session.engine.release()

    def recover(self) -> None:
        """Rebuild everything in a new context, after the driver lost the old one."""
        driver = self.session.engine.driver
        with suppress(Exception):  # a lost context may refuse even this
            self.release()
        self.window.reopen()
        self.session.rebuild(Engine(self.window.ctx, driver=driver))
        self.caching.attach(self.session.engine)
        self.painter = Painter(self.window.ctx)
        self.start_panel = StartPanel(self.window.ctx)
        self.versions_panel.rebuild(self.window.ctx)
        self._settling = _SETTLES

    def _patience(self) -> float:
        """Return how long nothing needs to be done [s]."""
        moves = self.session.animated and self.session.clock.playing
        if self.session.is_listening or moves or self.session.view.turning or self.bench.walk.moves:
            return max(FRAME - (time.perf_counter() - self._last), 0.0)
        if self._settling > 0 or self.remotes.waits or self.window.keys.waits:
            return 0.0
        if self.session.catch_up.behind is not None:
            return 0.0
        if tooltip_waits():
            return FRAME
        if self.session.drafts.testing:
            return _SANDBOX
        if self.warnings.waiting:
            return 0.0
        if self.session.is_preview:
            return self.session.picture.rest / 2
        if self.finite.patience is not None:
            return self.finite.patience
        if self.caching.patience is not None:
            return min(self.caching.patience, QUIET / 2)
        if self.autosave.waits:
            return QUIET / 2
        if self.bench.notices.items or self.start_panel.waits:
            return 0.1
        if self.bench.files.pane.draws_in is not None:
            return self.bench.files.pane.draws_in
        if self.readout.waits:
            return 0.25
        if imgui.get_io().want_text_input:
            return 0.1
        return IDLE

    def _sleep(self, seconds: float) -> None:
        start = time.perf_counter()
        self.window.wait(seconds)
        woken = seconds > 0 and time.perf_counter() - start < 0.98 * seconds
        self._settling = _SETTLES if woken else max(self._settling - 1, 0)
        now = time.perf_counter()
        if self.session.animated:
            self.session.advance(min(now - self._last, _MAX_STEP), datetime.now())
        self.session.turn(min(now - self._last, _MAX_STEP))
        self.bench.walk.advance(min(now - self._last, _MAX_STEP))
        self._last = now

    def _draw_frame(self) -> None:
        """Draw the window once; a part of it that fails is left out, and a notice says so."""
        window, bench, guard = self.window, self.bench, self.guard
        look = window.theme
        window.set_title(title_of(self.session.drafts.shown_path))
        guard.run("taking in what was dropped", lambda: self.drops.take(self.place.dropped()), None)
        window.zoom = bench.interface.preferences.size
        look.choose(theme.LIGHT if bench.interface.preferences.is_light else theme.DARK)
        full = next((a.full_screen for a in self.additions if a.full_screen is not None), None)
        if bench.start.shown or full is not None:
            bench.interface.cursor.leave()
        window.begin(partial(feed, bench.interface.cursor))
        focus.begin(bench.interface.focus)
        bench.inspection.begin()
        if bench.start.shown:
            self._draw_start_page()
            return
        if full is not None:
            self._draw_full(full)
            return
        left = 0.0
        for addition in self.additions:
            left += guard.draw(f"{addition.name}'s panel", addition.draw_panel, 0.0)
        if bench.interface.panel_shown:
            left += guard.draw("the panel", lambda: self.panel.draw(bench, look, left), 0.0)
        guard.run("the files that are open", bench.follow_files, None)
        places = self.panes.place(left, bench.tabs, look)
        area = places.picture
        guard.draw(
            "the code",
            lambda: self.panes.draw_code(
                places, lambda: draw_code(bench.files, bench.problems, look, bench.tracing)
            ),
            None,
        )
        guard.draw("the question on a file", lambda: draw_questions(bench.files), None)
        guard.draw("the strip", lambda: self.panes.draw_strip(places, bench.tabs, look), None)
        guard.draw("what a key asks for", self._act_on_keys, None)
        guard.draw("the mouse over the picture", lambda: self._act(area), None)
        pixels = _pixels_of(area, window)
        guard.run("listening", self.session.listen, None)
        if window.keys.waits:
            self._draw_over(self.session.picture.texture, area)
            window.skip()
            return
        picture = guard.run("the picture", lambda: self._picture(pixels[2:]), None)
        guard.run("taking in the picture", self._take_in, None)
        self._draw_over(picture, area)
        guard.run("showing the picture", lambda: self._show(picture, pixels), None)
        window.end()
        guard.run("what follows a picture", self._follow_up, None)

    def _draw_start_page(self) -> None:
        """Draw the rest of a frame while the start page fills the window: no sketch is drawn."""
        window, bench, guard = self.window, self.bench, self.guard
        guard.draw(
            "the start page", lambda: self.start_panel.draw(bench.start, window.theme, bench.interface), None
        )
        guard.draw("what a key asks for", lambda: act_on_keys(bench), None)
        if window.keys.waits:
            window.skip()
            return
        room = imgui.get_main_viewport().size
        bench.take_notes()
        below_head = 76 * window.theme.scale  # which has the page's buttons
        area: Area = (0.0, below_head, room.x, room.y - below_head)
        guard.draw("the notices", lambda: draw_notices(bench.notices, window.theme, area), None)
        guard.draw("what was dropped", lambda: draw_drops(self.drops, window.theme), None)
        guard.run("showing the page", lambda: self._show(None, (0, 0, *window.pixels)), None)
        window.end()
        self.status.write(bench, ())
        self._settling = max(self._settling, 0 if bench.start.shown else _SETTLES)

    def _draw_full(self, full: FullScreen) -> None:
        """Draw the rest of a frame while a room fills the window: the picture, and what is around it."""
        window, bench, guard = self.window, self.bench, self.guard
        pixels_area, density = full.area(window.pixels), window.density
        area: Area = (0.0, 0.0, pixels_area[2] / density, pixels_area[3] / density)
        if guard.draw(f"keys and mouse of {full.name}", lambda: full.act(area), False):
            guard.draw("the mouse over the picture", lambda: self._act(area), None)
        if full.turned():  # its text comes at once, its picture as soon as it is drawn
            picture, self._settling = self.session.picture.texture, _SETTLES
        else:
            picture = guard.run("the picture", lambda: self._picture((pixels_area[2], pixels_area[3])), None)
        guard.run("taking in the picture", self._take_in, None)
        if picture is not None:
            compared = bench.inspection.compare
            guard.run("the picture that it is compared with", lambda: compared.follow(picture), None)
        bench.inspection.update()
        guard.draw(full.name, lambda: full.draw(window.pixels, density, area), None)
        guard.run("showing the picture", lambda: self._show(picture, pixels_area), None)
        window.end()
        guard.run("what follows a picture", self._follow_up, None)

    def _act_on_keys(self) -> None:
        if not self.keys.act():
            act_on_keys(self.bench)

    def _act(self, area: Area) -> None:
        self.mouse.act(area, self.window.density)
        self.bench.record(held=imgui.is_mouse_down(0) or imgui.is_mouse_down(1))

    def _picture(self, size: tuple[int, int]) -> moderngl.Texture | None:
        session = self.session
        draws, error = session.draws, session.error
        began = time.perf_counter()
        picture = session.frame(size)
        self.readout.take(time.perf_counter() - began)
        if session.draws != draws or session.error is not error:
            self._settling = _SETTLES  # the panel shows what the frame took; an error grows to its size
        return picture

    def _take_in(self) -> None:
        """Update the watches, the notices and the list of errors from the last frame."""
        bench, session = self.bench, self.session
        self.finite.update(session, held=imgui.is_mouse_down(0) or imgui.is_mouse_down(1))
        self.caching.update(bench.inspection, self.finite)
        self._say_reload()
        bench.take_notes()
        inputs = session.engine.runner.inputs
        warnings = self.warnings.of(session.sketch, session.plan, inputs)
        bench.problems.take(session.error, warnings, session.sketch)
        self.terminal.take(bench.problems.errors)

    def _draw_over(self, picture: moderngl.Texture | None, area: Area) -> None:
        """Draw what is over the picture, each with a guard of its own."""
        bench, session, look, draw = self.bench, self.session, self.window.theme, self.guard.draw
        taken = draw("the bar of time", lambda: height_of_timeline(session, bench.interface, look), 0.0)
        above = (*area[:3], area[3] - taken)
        finite, tracing = self.finite, bench.tracing
        draw("what is not finite", lambda: draw_not_finite(finite, session, tracing, look, above), None)
        if picture is not None:
            draw("the border", lambda: draw_border(bench.problems, look, area), None)
        errors = ErrorsList(bench.problems, bench.files, session, bench.interface)
        draw("the list of errors", lambda: errors.draw(look, above), None)
        if picture is None and session.error is None and session.catch_up.behind is None:
            subject, seconds = session.drafts.checking or (session.path.name, 0.0)
            draw_waiting(checking_text(subject, seconds), area)
        else:
            draw_checking(session, look, area)
            draw_behind(session, look, area)
        if picture is not None and session.sketch is not None and session.view.map is None:
            parted, free = session.sketch, below_bar(bench.inspection.compare, look, area)
            draw("the names of the parts", lambda: draw_part_labels(parted, look, free), None)
        view = bench, picture, look, area, self.window.density
        draw("what is shown over the picture", lambda: draw_inspection(*view), None)
        self.guard.run("tracing", lambda: tracing.update(picture), None)
        self.guard.run("the texel for editors", self.live_texel.update, None)
        corner = bench.interface, bench.inspection, look, above
        if not bench.problems.open:
            draw("the frames a second", lambda: draw_readout(self.readout, *corner), None)
        if picture is not None and not bench.problems.open:
            draw("the hints", lambda: draw_hints(bench.interface.preferences, look, above), None)
        draw("the pinned texel", lambda: draw_mark(tracing, look, area), None)
        draw("the notices", lambda: draw_notices(bench.notices, look, area), None)
        draw("what was dropped", lambda: draw_drops(self.drops, look), None)
        draw("the key map", lambda: draw_keymap(bench.interface, look), None)
        for addition in self.additions:
            draw(addition.name, addition.draw_over, None)
        draw("the cursor", lambda: draw_cursor(bench.interface.cursor, session, look, area), None)

    def _show(self, picture: moderngl.Texture | None, area: tuple[int, int, int, int]) -> None:
        """Put the picture on the screen, under all that was drawn."""
        window = self.window
        window.screen.use()
        window.screen.viewport = (0, 0, *window.pixels)
        window.ctx.clear(*theme.palette.surround, 1.0)
        compare, now = self.bench.inspection.compare, self.bench.notices.now()
        if picture is not None and not paint_both(compare, picture, window.screen, area, now):
            self.painter.paint(picture, window.screen, area)

    def _follow_up(self) -> None:
        """Do what may wait until the frame is shown: driver warnings, free memory, the status, the rooms."""
        is_idle = self._settling == 0 and not self.session.drafts.testing
        if is_idle:
            self.warnings.look()
            self.session.engine.runner.programs.rest()
        self.status.write(self.bench, self.finite.non_finite)
        self.remotes.tell()
        self.guard.run("keeping versions", lambda: self._keep_versions(idle=is_idle), None)
        for addition in self.additions:
            addition.update(idle=is_idle and not imgui.is_mouse_down(0))

    def _keep_versions(self, *, idle: bool) -> None:
        versions, looked = self.bench.versions, self.bench.versions.looked
        versions.update(idle=idle and not imgui.is_mouse_down(0))
        if versions.looked is not looked:
            self._settling = _SETTLES

    def _remember(self) -> None:
        if self.bench.versions.is_looking:
            return  # it is not what is worked on
        geometry = self.place.geometry()
        self.autosave.look((geometry.width, geometry.height), (geometry.x, geometry.y))

    def _review(self, kernel: Kernel) -> tuple[Diagnostic, ...]:
        """Return what the driver warns of in a kernel that it has drawn with."""
        try:
            if isinstance(kernel, CpuSource):
                return ()
            driver = COMPUTE if isinstance(kernel, ComputeVariant | PlainCompute) else FRAGMENT
            ctx = self.window.ctx
            return warnings_of(ctx, wrap(kernel, driver, ctx.version_code))
        except PlaygroundError:
            return ()

    def _say_reload(self) -> None:
        """Show a notice when a save has become a picture."""
        latest = self.session.last_reload
        if latest is not self._reloads:
            if self._reloads is not None and not any(addition.shows_own for addition in self.additions):
                self.bench.notices.say(
                    tr("reloaded in {value} ms", value=f"{latest.seconds * 1e3:.0f}") if latest else ""
                )
            self._reloads = latest
