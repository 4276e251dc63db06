"""What the course adds to a window: lessons next to the picture, their presentation, the keys of both.

What draws a lesson is imported with the first that is shown: a window may show none.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, cast

from imgui_bundle import imgui

from playground.course.library import SOURCE, lesson_file
from playground.course.talk.stage import Presenting, Stage
from playground.course.window.progress import open_progress, progress_file
from playground.course.window.reader import Reader
from playground.studio.addition import Addition, Layer
from playground.studio.bench import Host, Workbench
from playground.studio.keys import Key
from playground.studio.start.page import Card
from playground.studio.start.thumbnails import thumbnails

if TYPE_CHECKING:
    from playground.course.window.panel import LessonPanel


class Lessons(Addition):
    """The lessons of one window."""

    name = "the lesson"
    button = "Lessons"
    button_note = "What there is to know of terrain, step by step (F2)"

    def __init__(self, host: Host) -> None:
        file = progress_file()
        progress, complaint = open_progress(file)
        bench = host.bench
        bench.session.notes.extend(filter(None, [complaint]))
        self.reader = Reader(bench, progress, file, self._store_own, host.autosave.open)
        self.stage = Stage(bench, self.reader, host.wake)
        self._panel: LessonPanel | None = None
        self._host = host

    def begin(self, request: Mapping[str, object]) -> None:
        """Open ``lesson`` by name, in a ``language`` by code, and ``present`` it."""
        reader, name, language = self.reader, str(request.get("lesson", "")), str(request.get("language", ""))
        if language and not name:
            reader.progress.language = language
        if name:
            reader.open(name, language=language)
        if "present" in request:
            self.stage.begin(cast(Presenting, request["present"]))

    def toggle(self) -> None:
        """Show or hide the panel."""
        self.reader.toggle()

    def start_cards(self) -> Iterator[Card]:
        """Yield a card for each lesson, with the small picture of its hero's sketch."""
        from playground.course.figures import hero_sketches

        sketches, cells = hero_sketches(), {row.name: row.cell for row in thumbnails()}
        for summary in self.reader.summaries:
            yield Card(
                f"lesson {summary.name}",
                summary.title,
                summary.goal,
                partial(self.reader.open, summary.name),
                "lesson",
                cell=cells.get(sketches.get(summary.name, ""), -1),
                words=summary.name.replace("_", " "),
            )

    def layers(self) -> Iterator[Layer]:
        """Yield the panel, where it is shown."""
        if self.reader.lesson is not None and self.reader.progress.shown:
            yield "lesson", self.reader.toggle

    def status(self) -> Mapping[str, object]:
        """Return the number of the beat that is presented."""
        return {"beat": self.stage.beat_number}

    @property
    def patience(self) -> float:
        """How long nothing needs to be done here [s]."""
        return min(self.reader.patience(self._host.bench.notices.now()), self.stage.patience)

    @property
    def shows_own(self) -> bool:
        """Whether a lesson's picture is shown."""
        return self.reader.figure.before_lesson is not None

    @property
    def full_screen(self) -> Stage | None:
        """The presentation, while a lesson is presented."""
        return self.stage if self.stage.on else None

    def take(self) -> None:
        """Do what the page of notes asked for."""
        self.stage.take()

    def draw_panel(self) -> float:
        """Draw the panel; return the width it takes, in the window's units."""
        if self._panel is None:
            if self.reader.lesson is None:
                return 0.0
            from playground.course.window.panel import LessonPanel

            self._panel = LessonPanel()
        return self._panel.draw(self.reader, self._host.theme(), self.stage.begin)

    def update(self, *, idle: bool) -> None:
        """Update the reader after a frame; ``idle``: there is time to compute."""
        if not self.shows_own:  # what a lesson sets is not the reader's
            self._host.remember()
        self.reader.update(idle=idle)

    def release(self) -> None:
        """Release what was made in the session's context; it is made again where it is needed."""
        if self._panel is not None:
            self._panel.release()
        self.reader.tasks.close()
        self.stage.release()

    def close(self) -> None:
        """Close the page of notes."""
        self.stage.close()

    def _store_own(self) -> None:
        """Remember what is shown, before a lesson shows something else."""
        self._host.remember()
        self._host.autosave.pause()


def open_addition(host: Host) -> Lessons:
    """Return the lessons of a window."""
    return Lessons(host)


def check_request(request: Mapping[str, object]) -> None:
    """Raise ``SketchError`` where there is no such lesson or language."""
    if request.get("lesson"):
        lesson_file(str(request["lesson"]), str(request.get("language") or SOURCE))


def _on_lessons(act: Callable[[Lessons], None]) -> Callable[[Workbench], None]:
    """Return what a key does where the bench has lessons."""

    def act_on(bench: Workbench) -> None:
        for addition in bench.additions:
            if isinstance(addition, Lessons):
                act(addition)

    return act_on


_K = imgui.Key
KEYS = (
    Key(_K.f2, "F2", "show or hide the lessons", _on_lessons(lambda own: own.toggle())),
    Key(_K.page_down, "PgDn", "next page of the lesson", _on_lessons(lambda own: own.reader.turn_page(1))),
    Key(_K.page_up, "PgUp", "previous page of the lesson", _on_lessons(lambda own: own.reader.turn_page(-1))),
    Key(
        _K.f5, "F5", "present the lesson to a class, full screen", _on_lessons(lambda own: own.stage.begin())
    ),
)
"""The keys of lessons, among those of the window."""
