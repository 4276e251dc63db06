"""Exercises that check themselves, and pictures to match, in the live view.

What a student writes is a copy of the file, as a broken shader is. The last attempt, the best points and
the best score are remembered from one start to the next.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import cast

from playground.course.judging import JudgeProcess, Request, judgement
from playground.course.model import Block, Challenge, Exercise, Scene
from playground.course.scenes import with_value
from playground.course.tasks import (
    Ends,
    Match,
    Picture,
    Verdict,
    Work,
    path_of,
    scene_of,
    starter,
    starter_text,
)
from playground.course.window.bugs import Copies, Copy, kernel_line
from playground.course.window.figure_view import FigureView
from playground.course.window.progress import Attempt, Progress
from playground.engine.process.pool import Task as Future
from playground.errors import PlaygroundError
from playground.sketch.assign import value_of, values_of
from playground.sketch.model import Sketch, Value, kernels_of
from playground.studio.code.open_files import typed_in
from playground.studio.notices import Notices
from playground.studio.reload.stages import ReloadStage
from playground.studio.session import Session

SIDE = 160
"""Pixels, the longer way, of the pictures that a score compares while one plays."""


@dataclass(kw_only=True)
class Judging:
    """What the process is asked by one reader, and what has come of it."""

    notices: Notices
    is_idle: Callable[[], bool]  # whether the picture in view rests
    received: Callable[[str, Verdict | Match], None]  # called with a block's name and what came of its work
    process: JudgeProcess = field(default_factory=JudgeProcess)
    verdicts: dict[str, Verdict] = field(default_factory=dict)  # by block
    ends: dict[str, Ends] = field(default_factory=dict)  # by challenge: what its score lies between
    judged: dict[str, Work] = field(default_factory=dict)  # by block: what its verdict is on
    matches: dict[str, Match] = field(default_factory=dict)  # by challenge: its last score
    at: str = ""  # the exercise whose work is judged, or is to be
    _work: Request | None = None  # that is still to be sent
    _wanted: list[Challenge] = field(default_factory=list)
    _sent: Future | None = None  # of what the process is at
    _scored: tuple[str, Work] | None = None  # the challenge's work that was sent last

    @property
    def busy(self) -> bool:
        """Whether an answer is to come."""
        return self._sent is not None or self._work is not None

    def check(self, block: Exercise, work: Work) -> None:
        """Have a work judged; ``update`` receives the verdict."""
        self.at, self._work = block.name, Request(block, work)

    def score(self, block: Challenge, drawn: Work) -> None:
        """Have the picture in view scored, unless it is the one before; ``drawn`` is what it is made of."""
        if (block.name, drawn) != self._scored and self._sent is None and self._work is None:
            self._scored, self._work = (block.name, drawn), Request(block, drawn, SIDE)

    def want(self, blocks: tuple[Block, ...]) -> None:
        """Have the pictures to match of a page drawn, while the picture in view rests."""
        self._wanted = [b for b in blocks if isinstance(b, Challenge) and b.name not in self.ends]

    def target(self, block: Challenge) -> Picture | None:
        """Return the picture to match; None while it is not drawn yet."""
        ends = self.ends.get(block.name)
        return None if ends is None else ends.target

    def update(self) -> bool:
        """Receive what has come, and send what comes next; return whether anything has come."""
        came = self._sent is not None and self._sent.done()
        if self._sent is not None and came:
            self._receive(self._sent)
        if self._sent is None and self._work is None and self._wanted and self.is_idle():
            self._work = Request(self._wanted.pop(0), None, SIDE)
        if self._sent is None and self._work is not None:
            self._sent, self._work = self.process.submit(self._work), None
        return came

    def forget(self) -> None:
        """Forget all, and expect nothing more of the process."""
        self._withdraw()
        self._scored = None
        for table in (self.verdicts, self.judged, self.matches, self.ends, self._wanted):
            table.clear()

    def forget_work(self, name: str) -> None:
        """Forget what came of a work that is no more."""
        self.verdicts.pop(name, None)
        self.matches.pop(name, None)
        self._scored = None

    def close(self) -> None:
        """End the process; it starts again where it is needed."""
        self._withdraw()
        self.process.close()

    def _withdraw(self) -> None:
        if self._sent is not None:
            self._sent.cancel(0.0)
        self.at, self._sent, self._work = "", None, None

    def _receive(self, sent: Future) -> None:
        request, self._sent = cast(Request, sent.request), None
        name = request.task.name
        if name == self.at and self._work is None:
            self.at = ""
        try:
            answer = judgement(request, sent.result())
        except PlaygroundError as error:
            self.notices.say(str(error))
            return
        if isinstance(answer, Ends):
            self.ends[name] = answer
            return
        if isinstance(answer, Match):
            self.matches[name] = answer
        elif request.work is not None:
            self.verdicts[name], self.judged[name] = answer, request.work
        self.received(name, answer)


Task = Exercise | Challenge

BEGUN = 1
"""Which picture of a task is the student's own; 0 is that of the solution."""

_POLL = 0.05  # [s] between two looks at what is judged
_STORE = 2.0  # [s] after which what is typed is remembered


@dataclass(kw_only=True)
class Tasks:
    """The tasks of one reader."""

    session: Session
    notices: Notices
    copies: Copies
    figure: FigureView
    progress: Progress
    label: Callable[..., str]  # of the interface, by key, with values in its places
    remember: Callable[[], None]  # stores the progress
    clear: Callable[[], None]  # called before a task's picture is shown
    lesson: Callable[[], str]  # the name of the lesson that is open

    def __post_init__(self) -> None:
        self.judging = Judging(
            notices=self.notices, is_idle=lambda: self.session.is_idle, received=self._received
        )
        self._on: Task | None = None  # the task that was begun
        self._copy: Copy | None = None  # what replaces its file
        self._given: dict[str, list[str]] = {}  # parameters that a starter has
        self._news = False  # something has come that is not on the screen yet
        self._store_at = math.inf
        self._stored: Work | None = None  # what was remembered last

    # ── what the student does ────────────────────────────────────────────────

    def start(self, block: Task) -> None:
        """Show what the student has, or what there is to begin from, and open its text."""
        scene = block.begin
        if scene is None:
            return
        self.leave()
        self.clear()
        attempt = self.attempt(block)
        texts: Mapping[str, str] = {}
        if block.file:
            path, text = path_of(block), attempt.text or starter_text(block)

            def keep(new: str) -> None:
                self._keep(block, Work(new, attempt.values))

            self._copy = self.copies.edit(path, text, keep, kernel_line(text))
            texts = {str(path): text}
        for slider, value in attempt.values.items():
            if slider in block.sliders:
                scene = _set(scene, slider, value)
        self._on = block
        self.figure.show(scene, (block.name, BEGUN), texts)

    def focus(self, block: Task) -> None:
        """Bring the student's text to the front, also where its window was closed."""
        self.copies.focus(path_of(block))

    def check(self, block: Exercise) -> None:
        """Send the work to be judged; ``update`` receives the verdict."""
        work = self.work(block)
        self._keep(block, work)
        self.judging.check(block, work)

    def start_again(self, block: Task) -> None:
        """Show the starter; what was there before comes back by ``undo``."""
        self._exchange(block, ("", {}))

    def undo(self, block: Task) -> None:
        """Bring back what was there before the student began again, in exchange for what is there now."""
        before = self.attempt(block).before
        if before is not None:
            self._exchange(block, before)

    # ── what is known ────────────────────────────────────────────────────────

    def attempt(self, block: Task) -> Attempt:
        """Return what is remembered of a task."""
        return self.progress.attempts.setdefault(f"{self.lesson()}/{block.name}", Attempt())

    def is_begun(self, block: Task) -> bool:
        """Return whether the student's own picture of a task is in view."""
        mine = self._on is not None and self._on.name == block.name
        return mine and self.figure.key == (block.name, BEGUN)

    def sliders(self, block: Task) -> tuple[str, ...]:
        """Return the parameters to drag in the picture in view: the task's, and the student's own."""
        shown = self.session.shown
        if shown is None or not self.is_begun(block) or self.figure.busy:
            return ()
        if not block.file:
            return block.sliders
        if block.name not in self._given:
            self._given[block.name] = _parameters(scene_of(block, starter(block)).sketch, path_of(block))
        own = [
            path for path in _parameters(shown.sketch, path_of(block)) if path not in self._given[block.name]
        ]
        return tuple(dict.fromkeys([*block.sliders, *own]))

    def work(self, block: Task) -> Work:
        """Return what the student has now, saved or not."""
        attempt, text = self.attempt(block), None
        if block.file:
            text = self._text_of(block) or attempt.text or starter_text(block)
        values: dict[str, Value] = {k: v for k, v in attempt.values.items() if k in block.sliders}
        shown = self.session.shown
        if shown is not None and self.is_begun(block) and not self.figure.busy:
            values = _values(shown.sketch, block.sliders)
        return Work(text, values)

    # ── frames ───────────────────────────────────────────────────────────────

    def update(self, block: Task | None, now: float) -> None:
        """Receive verdicts, score the picture in view, and remember what is typed.

        ``block`` is the task whose picture is in view, if any.
        """
        self._news = self.judging.update()
        if self._on is not None and now >= self._store_at:
            self._store_at = now + _STORE
            self.store()
        elif self._on is not None and self._store_at == math.inf:
            self._store_at = now + _STORE
        coming = self.session.drafts.stage is not ReloadStage.NONE or self.session.error is not None
        if isinstance(block, Challenge) and self.is_begun(block) and not coming:
            self.judging.score(block, Work(self._drawn_text(block), self.work(block).values))

    def patience(self, now: float) -> float:
        """Return how long nothing needs to be done here [s]."""
        if self._news or self.judging.busy:
            return 0.0 if self._news else _POLL
        return max(self._store_at - now, 0.0) if self._on is not None else math.inf

    def store(self) -> None:
        """Remember what is typed and set of the task that was begun."""
        block = self._on
        if block is None:
            return
        work = self.work(block)
        if work != self._stored:
            self._stored = work
            self._keep(block, work)

    def leave(self) -> None:
        """Close the copy of a task: another picture comes."""
        block = self._on
        if block is None:
            return
        self.store()
        self._close(block)

    def close(self) -> None:
        """Remember what is typed, and end the process that judges."""
        self.store()
        self.judging.close()

    def forget(self) -> None:
        """Forget verdicts: another lesson is opened."""
        self.leave()
        self.judging.forget()
        self._given.clear()

    # ── parts of it ──────────────────────────────────────────────────────────

    def _received(self, name: str, result: Verdict | Match) -> None:
        attempt = self.progress.attempts.setdefault(f"{self.lesson()}/{name}", Attempt())
        if isinstance(result, Match):
            attempt.score = max(attempt.score, result.score)
        else:
            attempt.points, attempt.of = max(attempt.points, result.points), result.of
        self.remember()

    def _text_of(self, block: Task) -> str | None:
        """Return the text of a task's copy with what is typed; None where it is not open."""
        path = path_of(block)
        mine = self._on is not None and self._on.name == block.name
        if self._copy is None or not mine or self.copies.open.get(path) is not self._copy:
            return None
        editing = self.copies.files.copy_of(path)
        typed = typed_in(editing) if editing is not None else None
        return self.copies.text_of(path) if typed is None else typed

    def _drawn_text(self, block: Task) -> str | None:
        """Return the text of a task's copy that is drawn; None where there is none."""
        return self._copy.base if block.file and self._text_of(block) is not None and self._copy else None

    def _close(self, block: Task) -> None:
        """Close the copy of a task, which gets what was typed in it."""
        copy, self._copy = self._copy, None
        self._on, self._store_at = None, math.inf
        if block.file and copy is not None and self.copies.open.get(copy.path) is copy:
            self.copies.close(copy.path)

    def _exchange(self, block: Task, new: tuple[str, dict[str, Value]]) -> None:
        """Show another text and values, and keep what was there; a bare starter is not worth keeping."""
        attempt, now = self.attempt(block), _own(block, self.work(block))  # read while its copy is open
        self._close(block)
        attempt.text, attempt.values = new
        attempt.before = now if any(now) else None
        self._forget(block)
        self.start(block)

    def _keep(self, block: Task, work: Work) -> None:
        attempt = self.attempt(block)
        attempt.text, attempt.values = _own(block, work)
        self.remember()

    def _forget(self, block: Task) -> None:
        """Forget what was said of a work that is no more."""
        self.judging.forget_work(block.name)
        self.remember()


def _own(block: Task, work: Work) -> tuple[str, dict[str, Value]]:
    """Return what is a student's own of a work: the text where it is not the starter, the values likewise."""
    text = "" if not block.file or work.text == starter_text(block) else work.text or ""
    values_at_start = _values(block.begin.sketch, block.sliders) if block.begin is not None else {}
    values = dict(work.values)
    return text, {} if values == values_at_start else values


def _set(scene: Scene, path: str, value: Value) -> Scene:
    """Return a picture with a value that was remembered; without it where the parameter takes it no more."""
    try:
        return with_value(scene, path, value)
    except PlaygroundError:
        return scene


def _parameters(sketch: Sketch, path: Path) -> list[str]:
    """Return the parameters of the kernels that a file makes."""
    kernel_read = [(where, kernel) for where, kernel in kernels_of(sketch.graph) if Path(kernel.path) == path]
    return [f"{where}.{parameter.name}" for where, kernel in kernel_read for parameter in kernel.parameters]


def _values(sketch: Sketch, sliders: tuple[str, ...]) -> dict[str, Value]:
    """Return the values of parameters; without those that a kernel of the student's has no more."""
    result, values = values_of(sketch), dict[str, Value]()
    for slider in sliders:
        with suppress(PlaygroundError):
            values[slider] = value_of(sketch, slider, result)
    return values
