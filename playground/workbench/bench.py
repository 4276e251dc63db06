"""The parts of a live session, put together: each takes the parts that it uses."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path

from playground.workbench.addition import Addition
from playground.workbench.captures import Captures
from playground.workbench.commands import Commands
from playground.workbench.control.controllers import Controllers
from playground.workbench.editors import Opener
from playground.workbench.inspect.toggles import Inspection
from playground.workbench.interface import Interface, InterfaceSize, WindowControls
from playground.workbench.keyframe_edits import KeyframeEdits
from playground.workbench.notices import Notices
from playground.workbench.open_files import OpenFiles
from playground.workbench.painting import Painting
from playground.workbench.problems import Problems
from playground.workbench.session import Session
from playground.workbench.sketch_file import SketchFile
from playground.workbench.undo import Undo


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
        size: InterfaceSize | None = None,
        wake: Callable[[], None] | None = None,
    ) -> None:
        folder = folder or Path.cwd()  # where pictures, masks and copies go
        self.session = session
        self.window = window
        self.notices = Notices(now)
        self.problems = Problems()
        self.inspection = Inspection(session)
        self.painting = Painting(session, folder, wake=wake)
        self.file = SketchFile(session, self.notices)
        self.undo = Undo(session, self.notices, self.painting, self.file)
        self.commands = Commands(session, self.notices, self.undo, self.file, folder)
        self.keyframes = KeyframeEdits(session, self.notices, self.undo, self.file)
        settle = self.painting.settle
        self.captures = Captures(session=session, notices=self.notices, folder=folder, settle=settle)
        self.files = OpenFiles(self.notices, opener or Opener())
        self.interface = Interface(size=size or InterfaceSize())
        self.additions: list[Addition] = []  # of the rooms that can be removed
        self.controllers = Controllers(session, self.notices)

    def take_notes(self) -> None:
        """Show what the session and the editors report, and remove notices that are over."""
        self.painting.follow()
        self.notices.take(self.session.notes, self.files.opener.notes)
