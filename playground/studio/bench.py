"""The parts of a live session, put together: each takes those that it uses; what a room may use."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from playground.paths import GLSL, SKETCHES
from playground.studio.actions import Actions
from playground.studio.addition import Addition
from playground.studio.code.editors import Opener
from playground.studio.code.open_files import OpenFiles, is_changed
from playground.studio.code.unsaved_texts import KeptTexts
from playground.studio.edits.autosave import Autosave
from playground.studio.edits.history import Typed
from playground.studio.edits.undo import Undo
from playground.studio.graph.edits import PassEdits
from playground.studio.inspect.inspection import Inspection
from playground.studio.interface import Interface, Panes, Preferences, Tab, WindowControls
from playground.studio.keyframes.keyframe_edits import KeyframeEdits
from playground.studio.land.walk import Walk
from playground.studio.language import tr
from playground.studio.notices import Notices
from playground.studio.paint.painting import Painting
from playground.studio.problems.problems import Problems
from playground.studio.remote.controllers import Controllers
from playground.studio.save.sketch_file import SketchFile
from playground.studio.session import Session
from playground.studio.start.page import Card, StartPage
from playground.studio.trace.tracing import TraceSandbox, Tracing
from playground.studio.versions.versions import Versions

if TYPE_CHECKING:
    from playground.studio.theme import Theme


class Workbench:
    """One session, and what works on it."""

    def __init__(
        self,
        session: Session,
        window: WindowControls,
        *,
        folder: Path | None = None,
        now: Callable[[], float] = time.perf_counter,
        opener: Opener | None = None,
        preferences: Preferences | None = None,
        wake: Callable[[], None] | None = None,
        trace_sandbox: TraceSandbox | None = None,
        kept: KeptTexts | None = None,
    ) -> None:
        folder = folder or Path.cwd()  # where pictures, masks and copies go
        self.session = session
        self.window = window
        self.notices = Notices(now)
        self.problems = Problems(unsaved=session.drafts.unsaved)
        self.inspection = Inspection(session)
        self.tracing = Tracing(session, trace_sandbox)
        self.painting = Painting(session, folder, wake=wake)
        self.walk = Walk(session, self._before_walk)
        self.file = SketchFile(session, self.notices)
        self.undo = Undo(session, self.notices, self.painting, self.file)
        self.actions = Actions(session, self.notices, self.undo, self.file, folder)
        self.keyframes = KeyframeEdits(session, self.notices, self.undo)
        self.passes = PassEdits(session, self.notices, self.undo)
        self.file.save_typed = self._save_typed_sketch
        self.interface = Interface(preferences=preferences or Preferences())
        self.start = StartPage(self.actions, more=self._cards)
        self.panes = Panes(self.interface.preferences)
        self.files = OpenFiles(
            self.notices,
            opener or Opener(),
            kept=kept or KeptTexts(),
            take_typed=session.drafts.take_typed,
            show=self.panes.show_code,
            copy_in=self._copy_in,
            step=lambda by: self.undo.go(by, self._text()),
        )
        self.undo.seen = lambda: self._text() if self.panes.code_is_open else None
        self.file.show_written = lambda paths: self.files.take_saved(paths, is_own=True)
        self.tabs: list[Tab] = []  # of the strip below the picture
        self._before_trace: tuple[bool, bool] | None = None  # code and strip were open; None: no trace
        self.additions: list[Addition] = []  # of the rooms that can be removed
        self.versions = Versions(self.actions, self.inspection.compare, is_left_out=self._shows_rooms_own)
        self.controllers = Controllers(session, self.notices)

    def _before_walk(self) -> None:
        """Put down what the mouse or the keys would be for besides; the steps so far are recorded."""
        self.interface.cursor.leave()
        if self.painting.on:
            self.painting.toggle()
        self.undo.record()

    def record(self, *, held: bool) -> None:
        """Record what a frame has changed; ``held``: a mouse button is down. A walk is one step."""
        self.undo.record(held=held or self.walk.on)

    def _shows_rooms_own(self) -> bool:
        """Return whether the sketch that is shown is a room's, and not the user's."""
        return any(addition.shows_own for addition in self.additions)

    def _cards(self) -> Iterator[Card]:
        """Yield what rooms add to the start page."""
        for addition in self.additions:
            yield from addition.start_cards()

    def toggle_passes(self) -> None:
        """Open the strip at the passes, which get the keys, or close it."""
        self.inspection.graph.gets_keys = not self.panes.shows("passes")
        self.panes.toggle_strip("passes")

    def toggle_cursor(self) -> None:
        """Have keys move a cursor over the picture in the mouse's place, or no longer; a walk ends."""
        if self.walk.on:
            self.walk.end()
        self.interface.cursor.toggle()
        if self.interface.cursor.on:
            self.notices.say(tr("arrows move the cursor, Space or Enter presses its button, Esc ends it"))

    def toggle_code(self) -> None:
        """Close the code pane, or open it and give it the keys."""
        if self.panes.code_is_open:
            self.panes.show_code(False)
        elif self.files.current is not None:
            self.files.focus(self.files.current, self.files.current.line, self.files.current.column)

    def follow_files(self) -> None:
        """Have the tabs of the code pane be those of the sketch that is shown."""
        drafts = self.session.drafts
        if not drafts.opening and (drafts.shown is not None or drafts.error is not None):
            self.files.follow(drafts.path, drafts.shown.file if drafts.shown is not None else None)
        self._follow_trace()
        self.panes.has_code = bool(self.files.editing)
        self.problems.is_quiet = self.files.pane.has_keys

    def _follow_trace(self) -> None:
        """Open the code and the strip's tab while a texel is traced, and show the line that is asked for.

        In a narrow window the code would take the picture's place, and the mouse has to point there.
        """
        panes, caret = self.panes, self.tracing.caret
        if self.tracing.on != (self._before_trace is not None):
            if self._before_trace is None:
                strip = panes.is_open("strip", narrow=panes.is_narrow)
                self._before_trace = panes.code_is_open, strip
                panes.show_code(panes.code_is_open or not panes.is_narrow)
                panes.show_strip("trace")
            else:
                code, strip = self._before_trace
                self._before_trace = None
                panes.show_code(panes.code_is_open and code)
                panes.show_strip(shown=strip)
        if self.tracing.on and caret.is_asked:
            caret.is_asked = False
            self.files.reveal(Path(caret.file), caret.line)

    def _text(self) -> Typed | None:
        """Return the text of the code pane."""
        return self.files.current.view if self.files.current is not None else None

    def _save_typed_sketch(self) -> None:
        """Save what is typed in the sketch's own file: values, keyframes and passes are written into that."""
        editing = self.files.at(self.session.path)
        if editing is not None and is_changed(editing):
            self.files.save(editing)

    def _copy_in(self, path: Path) -> None:
        """Make a file that is not to be changed the sketch's own, or copy the sketch that it belongs to."""
        if path.is_relative_to(SKETCHES) or self.session.path.is_relative_to(GLSL):
            self.actions.save_a_copy()
            return
        copied = self.actions.copy_technique(path)
        if copied is not None:
            self.files.open(copied, here=True)

    def take_notes(self) -> None:
        """Show what the session and the editors report, and remove notices that are over."""
        self.painting.follow()
        self.notices.take(self.session.notes, self.files.opener.notes)


@dataclass(frozen=True)
class Host:
    """What an addition may use of its window."""

    bench: Workbench
    autosave: Autosave
    remember: Callable[[], None]  # stores what is shown, for the next start
    wake: Callable[[], None]  # ends the window's sleep, from any thread
    theme: Callable[[], Theme]
