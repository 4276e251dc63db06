"""Lessons next to the picture: what the window calls in each frame.

What draws them is imported with the first that is shown: a window may show none.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from playground.live.theme import Theme
from playground.workbench.autosave import Autosave
from playground.workbench.bench import Workbench
from playground.workbench.lesson.progress import open_progress, progress_file
from playground.workbench.lesson.reader import Reader

if TYPE_CHECKING:
    from playground.live.lesson.panel import LessonPanel


class Lessons:
    """The lessons of one window; ``remember`` stores what is shown, for the next start."""

    def __init__(self, bench: Workbench, autosave: Autosave, remember: Callable[[], None]) -> None:
        file = progress_file()
        progress, complaint = open_progress(file)
        bench.session.notes.extend(filter(None, [complaint]))
        self.reader = Reader(bench, progress, file, self._store_own, autosave.open)
        self._panel: LessonPanel | None = None
        self._autosave = autosave
        self._remember = remember
        bench.lessons.toggle, bench.lessons.turn_page = self.reader.toggle, self.reader.turn_page
        bench.lessons.is_shown = lambda: self.reader.lesson is not None and self.reader.progress.shown

    def begin(self, name: str, language: str, *, show_lessons: bool) -> None:
        """Open a lesson by name; else, with ``show_lessons``, the one read last, unless all were closed."""
        reader = self.reader
        if language and not name:
            reader.progress.language = language
        if name:
            reader.open(name, language=language)
        elif show_lessons and reader.progress.shown:
            reader.open(show=False)

    def draw(self, look: Theme) -> float:
        """Draw the panel; return the width it takes, in the window's units."""
        if self._panel is None:
            if self.reader.lesson is None:
                return 0.0
            from playground.live.lesson.panel import LessonPanel

            self._panel = LessonPanel()
        return self._panel.draw(self.reader, look)

    def update(self, *, idle: bool) -> None:
        """Update the reader after a frame; ``idle``: there is time to compute."""
        if self.reader.figure.before_lesson is None:  # what a lesson sets is not the reader's
            self._remember()
        self.reader.update(idle=idle)

    def release(self) -> None:
        """Release what was made in the session's context; it is made again where it is needed."""
        if self._panel is not None:
            self._panel.release()
        self.reader.tasks.close()

    def _store_own(self) -> None:
        """Remember what is shown, before a lesson shows something else."""
        self._remember()
        self._autosave.pause()
