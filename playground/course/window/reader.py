"""A reader and the lessons: which page is open, which figure is shown, questions and answers.

Draws nothing; ``update`` is called once a frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from playground.course.library import LANGUAGES, SOURCE, labels
from playground.course.measures import Number, filled, measured, named_in
from playground.course.model import (
    Block,
    Challenge,
    Compare,
    Exercise,
    Figure,
    Lesson,
    Markdown,
    Measure,
    Question,
    Scene,
    Section,
    Slider,
    Steps,
    Trace,
    texts_of,
)
from playground.course.scenes import BOTH, Sketches, comparable
from playground.course.tasks import answer_text, path_of
from playground.course.traces import (
    Answer,
    TracedLines,
    answers_in,
    number_in,
    numbers_with_answers,
    traced,
    traces_named,
)
from playground.course.window.bugs import Bugs, Copies
from playground.course.window.figure_view import FigureView, steps_of
from playground.course.window.progress import Progress, progress_file, write_progress
from playground.course.window.tasks import Tasks
from playground.errors import PlaygroundError
from playground.studio.bench import Workbench
from playground.studio.code.open_files import unsaved
from playground.studio.compare.compare import as_before
from playground.studio.language import language as window_language
from playground.studio.session import Session

if TYPE_CHECKING:
    from playground.course.read import Summary


@dataclass
class Catalogue:
    """The lessons of one window; ``say`` reports errors."""

    say: Callable[[str], None]
    sketches: Sketches = field(default_factory=Sketches)
    _listed: dict[str, list[Summary]] = field(default_factory=dict)  # by language
    _missing: set[str] = field(default_factory=set)  # lessons reported to have no translation

    def listed(self, language: str) -> list[Summary]:
        """Return all lessons, in their order."""
        if language not in self._listed:
            from playground.course.read import summaries

            try:
                self._listed[language] = summaries(language)
            except PlaygroundError as error:
                self.say(str(error))
                self._listed[language] = []
        return self._listed[language]

    def read(self, name: str, language: str, untranslated: str) -> Lesson:
        """Return a lesson; without a translation in English, and ``untranslated`` is reported once.

        Raises ``SketchError`` for one that is not there or not well written.
        """
        from playground.course.read import read_lesson

        try:
            return read_lesson(name, language, self.sketches)
        except PlaygroundError:
            if language == SOURCE:
                raise
            lesson = read_lesson(name, SOURCE, self.sketches)
            if name not in self._missing:
                self._missing.add(name)
                self.say(untranslated)
            return lesson


Known = dict[str, Number]


@dataclass
class Numbers:
    """The results of the measures and traces of the lessons read so far."""

    session: Session
    results: dict[str, Known] = field(default_factory=dict)  # by lesson and name
    traces: dict[tuple[str, str], TracedLines] = field(default_factory=dict)  # by lesson and block
    answers: dict[tuple[str, str], Answer] = field(default_factory=dict)  # by lesson and question
    failed: dict[tuple[str, str], str] = field(default_factory=dict)  # why there is no number
    pending: list[tuple[str, Measure | Trace]] = field(default_factory=list)
    _lessons: dict[str, Lesson] = field(default_factory=dict)

    def want(self, lesson: Lesson, blocks: tuple[Block, ...]) -> None:
        """Request all numbers that blocks of a lesson show."""
        names = {name for block in blocks for text in texts_of(block) for name in named_in(text)}
        names |= {block.name for block in blocks if isinstance(block, Measure | Trace | Question)}
        numbers = self.results.setdefault(lesson.name, {})
        self._lessons[lesson.name] = lesson
        measures: list[Measure | Trace] = [
            each for each in lesson.measures if each.name in names and each.name not in numbers
        ]
        traces = [each for each in traces_named(lesson, names) if (lesson.name, each.name) not in self.traces]
        self.pending = [
            (lesson.name, each)
            for each in [*measures, *traces]
            if (lesson.name, each.name) not in self.failed
        ]

    def waits(self, lesson: Lesson, name: str) -> bool:
        """Return whether a number is still to be computed."""
        block = name.partition(":")[0]
        return any((lesson.name, block) == (other, each.name) for other, each in self.pending)

    @property
    def ready(self) -> bool:
        """Whether a number is wanted, and the picture rests."""
        return bool(self.pending) and self.session.is_idle

    def compute(self) -> bool:
        """Compute the next number that is wanted, where the picture rests; return whether one was."""
        session = self.session
        if not self.ready or session.plan is None:
            return False
        lesson, block = self.pending.pop(0)
        try:
            with as_before(session.engine, session.plan):
                if isinstance(block, Measure):
                    self.results[lesson][block.name] = measured(session.engine, block)
                else:
                    self._trace(self._lessons[lesson], block)
        except PlaygroundError as error:
            self.failed[lesson, block.name] = error.diagnostics[0].message
        return True

    def _trace(self, lesson: Lesson, block: Trace) -> None:
        lines = traced(self.session.engine, lesson, block)
        self.results[lesson.name] |= numbers_with_answers(lesson, {block.name: lines})
        self.answers |= {(lesson.name, n): a for n, a in answers_in(lesson, {block.name: lines}).items()}
        self.traces[lesson.name, block.name] = lines

    def fill(self, text: Markdown, lesson: Lesson) -> Markdown:
        """Return a text with today's numbers; "…" for one that is not computed yet."""
        return filled(text, self.results.get(lesson.name, {}), lesson.language)


_STEP, _VALUE = 0.8, 0.5
"""[s] that a step, and a value of a sweep, is shown while it plays."""

FigureBlock = Steps | Slider | Compare | Figure | Exercise | Challenge


@dataclass
class Reader:
    """The lesson, the page and the figure of one reader."""

    bench: Workbench
    progress: Progress
    file: Path = field(default_factory=progress_file)  # where the progress is remembered
    begins: Callable[[], None] = lambda: None  # called before a lesson shows its first figure
    play: Callable[[Path], None] | None = None  # opens a sketch as the reader's own
    lesson: Lesson | None = None
    at: dict[str, int] = field(default_factory=dict)  # of a series: which picture, by block
    shown: set[tuple[str, str]] = field(default_factory=set)  # what was opened: (block, "answer")
    chosen: dict[str, int] = field(default_factory=dict)  # the answers given, by question
    typed: dict[str, str] = field(default_factory=dict)  # the numbers given, by question
    checked: dict[str, bool | None] = field(default_factory=dict)  # whether right; None: no number
    playing: str = ""  # the series that plays
    to_top: bool = False  # a page was turned: it is to be shown from its top

    def __post_init__(self) -> None:
        bench = self.bench
        self.figure = FigureView(bench.undo, bench.inspection.compare, self.begins)
        self.numbers = Numbers(bench.session)
        copies = Copies(bench.files, self.figure.set_texts, self.say)
        self.bugs = Bugs(
            session=bench.session,
            notices=bench.notices,
            copies=copies,
            figure=self.figure,
            label=self.say,
        )
        self.tasks = Tasks(
            session=bench.session,
            notices=bench.notices,
            copies=copies,
            figure=self.figure,
            progress=self.progress,
            label=self.say,
            remember=self.remember,
            clear=self._clear,
            lesson=lambda: self.progress.lesson,
        )
        self.catalogue = Catalogue(bench.notices.say)
        self._opened_in = ""  # the language that was asked for
        self._due = math.inf  # when what plays goes on
        self._hid = False  # the parameters' panel, to make room

    # ── pages ────────────────────────────────────────────────────────────────

    @property
    def language(self) -> str:
        """The code of the language that is read: the window's, unless lessons were put into another."""
        return self.progress.language if self.progress.language in LANGUAGES else window_language()

    def say(self, key: str, *values: object, **named: object) -> str:
        """Return a label of the window in that language, with values in its places."""
        return labels("window", self.language)(key, *values, **named)

    @property
    def section(self) -> Section | None:
        """The page that is open."""
        sections = self.lesson.sections if self.lesson else ()
        return sections[self.index] if sections else None

    @property
    def index(self) -> int:
        """Which of the lesson's pages is open, from 0."""
        if self.lesson is None:
            return 0
        return min(self.progress.sections.get(self.lesson.name, 0), len(self.lesson.sections) - 1)

    @property
    def summaries(self) -> list[Summary]:
        """All lessons, in their order."""
        return self.catalogue.listed(self.language)

    def open(self, name: str = "", *, language: str = "", page: int | None = None, show: bool = True) -> bool:
        """Open a lesson, at the page where it was left; return whether that could be done.

        By default the one read last, or the first. ``show``: its figure is shown.
        """
        names = [summary.name for summary in self.summaries]
        name = name or (self.progress.lesson if self.progress.lesson in names else next(iter(names), ""))
        if language:
            self.progress.language = "" if language == window_language() else language
        self._opened_in = self.language
        try:
            lesson = self.catalogue.read(name, self.language, self.say("untranslated"))
        except PlaygroundError as error:
            self.bench.notices.say(str(error))
            return False
        if self.lesson is None or lesson.name != self.lesson.name:
            self.at, self.shown, self.chosen = {}, set(), {}
            self.typed, self.checked = {}, {}
            self.tasks.forget()
            self.bugs.forget()
        if self.lesson is None or not self.progress.shown:
            self._make_room()
        self.lesson, self.progress.lesson, self.progress.shown = lesson, name, True
        self.go(self.progress.sections.get(name, 0) if page is None else page, show=show)
        return True

    def set_language(self, language: str) -> None:
        """Switch to another language."""
        if self.lesson is not None:
            self.open(self.lesson.name, language=language, show=False)

    def go(self, page: int, *, show: bool = True) -> None:
        """Open a page of the lesson; ``show``: its first figure is shown."""
        if self.lesson is None:
            return
        last = len(self.lesson.sections) - 1
        page = min(max(page, 0), last)
        self.progress.sections[self.lesson.name] = page
        if page == last and self.lesson.name not in self.progress.done:
            self.progress.done.append(self.lesson.name)
        self.playing, self.to_top = "", True
        self.tasks.leave()
        self.bugs.close_all()
        section = self.lesson.sections[page]
        self.numbers.want(self.lesson, section.blocks)
        self.tasks.judging.want(section.blocks)
        self.remember()
        first = self._picture_of(page)
        if not show or first is None:
            return
        if unsaved(self.bench.files.editing) or (self.figure.before_lesson is None and self.figure.changed):
            self.bench.notices.say(self.say("yours_stays"))
            return
        self.show(first)

    def _picture_of(self, page: int) -> Block | None:
        """Return what a page shows first; of one without, while nothing is shown yet, the one before."""
        sections = self.lesson.sections if self.lesson else ()
        mine, *earlier = [
            [b for b in section.blocks if isinstance(b, Figure | Steps | Slider | Compare)]
            for section in reversed(sections[: page + 1])
        ]
        if mine or self.figure.key is not None:
            return next(iter(mine), None)
        return next((blocks[-1] for blocks in earlier if blocks), None)

    def turn_page(self, pages: int) -> None:
        """Go a number of pages forwards or backwards."""
        if self.lesson is not None and self.progress.shown:
            self.go(self.index + pages)

    def toggle(self) -> None:
        """Show or hide the panel."""
        if self.lesson is None:
            self.open(show=False)
            return
        self.progress.shown = not self.progress.shown
        if self.progress.shown:
            self._make_room()
        else:
            self.playing = ""
            self.bench.interface.panel_shown = self.bench.interface.panel_shown or self._hid
            if self.figure.before_lesson is not None and self.figure.changed:
                self.bench.notices.say(self.say("not_kept"))
        self.remember()

    def _make_room(self) -> None:
        """Hide the parameters: a page has those that it is about."""
        self._hid, self.bench.interface.panel_shown = self.bench.interface.panel_shown, False

    def remember(self) -> None:
        """Store where the reader is."""
        complaint = write_progress(self.progress, self.file)
        if complaint:
            self.bench.notices.say(complaint)

    # ── pictures ─────────────────────────────────────────────────────────────

    def is_on(self, block: FigureBlock) -> bool:
        """Return whether a figure of a block is shown."""
        return self.figure.key is not None and self.figure.key[0] == block.name

    def show(self, block: Block) -> None:
        """Show a block's figure; of a series the one it was left at."""
        if isinstance(block, Figure) and block.scene is not None:
            self._put(block.scene, block.name, 0)
        elif isinstance(block, Exercise | Challenge) and block.scene is not None:
            texts = {str(path_of(block)): answer_text(block)} if block.file else {}
            self._put(block.scene, block.name, 0, texts)
        elif isinstance(block, Compare):
            both = len(block.scenes) == 2 and comparable(*block.scenes)
            self.choose(block, self.at.get(block.name, BOTH if both else 0))
        elif isinstance(block, Steps | Slider):
            self.move(block, self.at.get(block.name, 0))

    def move(self, block: Steps | Slider, index: int) -> None:
        """Show another step, or another value."""
        index = min(max(index, 0), len(block.scenes) - 1)
        scene = block.scenes[index]
        if not self.is_on(block) or self.figure.busy:
            self._put(scene, block.name, index)
        elif isinstance(block, Steps):
            self.figure.stop_at(steps_of(scene), (block.name, index))
        else:
            self.bench.session.drafts.set(block.parameter, block.values[index])
        self.at[block.name] = index

    def choose(self, block: Compare, index: int) -> None:
        """Show one of several pictures, or ``BOTH``."""
        if index == BOTH:
            self.tasks.leave()
            self.bugs.leave()
            self.figure.compare(block.scenes[0], block.scenes[1], block.name)
        else:
            self._put(block.scenes[index], block.name, index)
        self.at[block.name] = index

    def play_or_pause(self, block: Steps | Slider) -> None:
        """Play a series from where it is, from its beginning when it is over; or pause."""
        if self.playing == block.name:
            self.playing = ""
            return
        at = self.at.get(block.name, 0)
        self.move(block, 0 if at >= len(block.scenes) - 1 else at)
        self.playing, self._due = block.name, self.bench.notices.now() + _pause(block)

    def check_number(self, question: Question) -> None:
        """Compare the number typed for a question with its answer, once that is computed."""
        answer = self.numbers.answers.get((self.progress.lesson, question.name))
        text = self.typed.get(question.name, "")
        if answer is None:
            return
        known = number_in(text) is not None
        self.checked[question.name] = answer.accepts(text) if known else None
        if self.checked[question.name]:
            self.shown.add((question.name, "answer"))

    def reset(self, block: FigureBlock) -> None:
        """Show a block's picture as the lesson has it."""
        self.playing = ""
        self.show(block)

    def go_back(self) -> None:
        """Show again what was open before the lessons."""
        self.playing = ""
        self.tasks.leave()
        self.bugs.close_all(drawn=False)
        self.figure.go_back()
        if self.figure.before_lesson is not None:  # it is gone: the lesson's picture stays, without copies
            self.bugs.close_all()

    def _put(self, scene: Scene, name: str, index: int, texts: Mapping[str, str] | None = None) -> None:
        if self.playing != name:
            self.playing = ""
        self.tasks.leave()
        self.bugs.leave()
        self.figure.show(scene, (name, index), {**self.bugs.copies.texts, **(texts or {})})

    def _clear(self) -> None:
        """Stop what plays and what is broken: a task's picture comes."""
        self.playing = ""
        self.bugs.leave()

    # ── frames ───────────────────────────────────────────────────────────────

    def update(self, *, idle: bool) -> None:
        """Update figures and series after a frame; ``idle``: there is time to compute."""
        self.figure.update()
        if self.lesson is None or not self.progress.shown:
            return
        if self.language != self._opened_in:  # another was chosen for the whole window
            self.open(self.lesson.name, show=False)
        if self.playing and self.bench.notices.now() >= self._due and not self.figure.busy:
            self._play()
        shown = self.lesson.named.get(self.figure.key[0]) if self.figure.key is not None else None
        task = shown if isinstance(shown, Exercise | Challenge) else None
        self.tasks.update(task, self.bench.notices.now())
        if idle and not self.playing and not self.bugs.check():
            self.numbers.compute()

    def patience(self, now: float) -> float:
        """Return how long nothing needs to be done here [s]."""
        if self.lesson is None or not self.progress.shown:
            return math.inf
        if self.playing:
            return max(self._due - now, 0.0)
        return 0.0 if self.numbers.ready or self.bugs.waits else self.tasks.patience(now)

    def _play(self) -> None:
        block = self.lesson.named.get(self.playing) if self.lesson else None
        if not isinstance(block, Steps | Slider):
            self.playing = ""
            return
        self.move(block, self.at.get(block.name, 0) + 1)
        self._due = self.bench.notices.now() + _pause(block)
        if self.at[block.name] >= len(block.scenes) - 1:
            self.playing = ""


def _pause(block: Steps | Slider) -> float:
    return _STEP if isinstance(block, Steps) else _VALUE
