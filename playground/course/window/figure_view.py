"""Show a lesson's figures in the live view, and restore what was open before.

User edits of a sketch are not lost when a lesson shows another figure of it: undo restores them.
What was open before the lesson began comes back whole, with its own undo, by ``go_back``. As long
as a lesson's figure is shown, nothing is remembered of the sketch for the next start: what a lesson
sets is no choice of the reader's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from playground.course.model import Scene
from playground.course.scenes import comparable
from playground.engine.planner import repeated_in
from playground.errors import PlaygroundError
from playground.sketch.flatten import flatten
from playground.sketch.load import load
from playground.sketch.map_sketch import USE, Map
from playground.sketch.model import DEFAULT_PICTURE, Sketch, Value
from playground.studio.clock import Clock
from playground.studio.compare.compare import Compare, Mode, Stored
from playground.studio.edits.edits import Edits, StoredEdits
from playground.studio.edits.history import History, changes_between
from playground.studio.edits.undo import Undo
from playground.studio.language import tr
from playground.studio.reload.stages import ReloadStage


def sketch_path(scene: Scene) -> Path:
    """Return the file of a picture's sketch."""
    return Path(scene.sketch.file)


def edits_of(scene: Scene, file: Sketch) -> Edits:
    """Return what has to be edited in a sketch, as its file says it, to see a picture."""
    values: dict[str, Value] = {}
    parts = [_preset(file, scene.preset), dict(scene.values)]
    if scene.shot:
        shot = file.shot(scene.shot)
        parts = [_preset(file, shot.preset), dict(shot.values), *parts]
    for part in parts:  # what is set later comes later: of two names of one parameter, the last counts
        values = {path: value for path, value in values.items() if path not in part} | part
    seen = scene.sketch
    moved = seen.camera != file.camera or seen.keyframes != file.keyframes
    return Edits(tuple(values.items()), camera=seen.camera if moved else None)


def steps_of(scene: Scene) -> dict[str, int]:
    """Return after how many steps each repeated pass of a picture stops, by its whole path."""
    return {repeated_in(scene.sketch, path): step for path, step in scene.steps}


def map_of(scene: Scene) -> Map | None:
    """Return the map that a picture is; None where it is the sketch's own view."""
    if not scene.view:
        return None
    path, _, output = scene.view.partition(":")
    if not output:  # a pass's texture is that of its own name, else its first
        outputs, last = flatten(scene.sketch).outputs[path], path.rpartition(".")[2]
        output = last if last in outputs else next(iter(outputs))
    spec = scene.sketch.graph.find("view")
    return Map(f"{path}:{output}", spec.values if spec is not None and spec.use == USE else ())


def _preset(file: Sketch, name: str) -> dict[str, Value]:
    return next((dict(preset.values) for preset in file.presets if preset.name == name), {})


Key = tuple[str, int]
"""A picture of a lesson: the name of its block, and which of the block's."""


@dataclass(frozen=True)
class BeforeLesson:
    """What the reader had open."""

    path: Path
    edits: StoredEdits
    steps: Mapping[str, int]
    map: Map | None
    clock: Clock
    history: History
    compared: Stored | None  # the A that it was compared with


class FigureView:
    """Shows the figures of a lesson in one session."""

    def __init__(self, undo: Undo, compare: Compare, begins: Callable[[], None] = lambda: None) -> None:
        self.session = undo.session
        self.undo = undo
        self.compared_with = compare
        self.before_lesson: BeforeLesson | None = None
        self.key: Key | None = None  # of the picture that is shown
        self.scene: Scene | None = None
        self._begins = begins  # called before the first figure is shown
        self._opened = 0  # the count of sketches opened, when a figure or what was open was shown
        self._set: tuple[Edits, Mapping[str, int]] = (Edits(), {})  # for the picture
        self._histories: dict[Path, tuple[History, Edits]] = {}
        self._waits = False
        self._first: Scene | None = None  # what the picture is to be compared with
        self._compared: Stored | None = None  # the A that comes back with what was open

    @property
    def busy(self) -> bool:
        """Whether a figure is still to come."""
        return self.session.drafts.stage in (ReloadStage.SANDBOX, ReloadStage.DRAW)

    @property
    def changed(self) -> bool:
        """Whether the reader has edited something since the figure was shown, or at all before any."""
        session = self.session
        if session.shown is None:
            return False
        edits = session.shown.edits
        if self.before_lesson is None or self.scene is None:
            return bool(edits.values or edits.techniques or edits.channels)
        return not self.busy and (edits, dict(session.view.steps)) != self._set

    def show(self, scene: Scene, key: Key, texts: Mapping[str, str] | None = None) -> None:
        """Show a picture of a lesson; ``texts``, by absolute path, replace shaders' files."""
        undo, session = self.undo, self.session
        path, texts = sketch_path(scene), texts or {}
        try:
            draft_shown = session.shown if session.path == path and not session.drafts.opening else None
            file = draft_shown.file if draft_shown is not None else load(path)
            edits, steps = edits_of(scene, file), steps_of(scene)
        except PlaygroundError as error:
            undo.notices.say(str(error))
            return
        self._begin()
        self.compared_with.end()
        self._first = None
        if draft_shown is None:
            self._leave()
            history, before = self._histories.get(path, (History(), edits))
            _record_change(history, before, edits, undo.notices.now())
            session.open(path, start=StoredEdits(edits), texts=texts)
            undo.begin(history)
        else:
            undo.record()
            undo.history.call(tr("Lesson: {value}", value=key[0]))
            session.drafts.read_as(texts)
            session.drafts.restore(edits)
        session.restore_view(steps, map_of(scene))
        session.view.framed_for = scene.pixels
        session.clock.time, session.clock.playing = scene.time, False
        self.scene, self.key, self._opened, self._waits = scene, key, session.drafts.opened, True
        self._set = edits, steps

    def set_texts(self, texts: Mapping[str, str]) -> None:
        """Replace shaders' files by texts in what is shown now; the reader's own sketch stays that."""
        self.session.drafts.read_as(texts)

    def stop_at(self, steps: Mapping[str, int], key: Key) -> None:
        """Stop repeats of the picture that is shown after other steps."""
        session = self.session
        for path, step in steps.items():
            session.stop_at(path, step)
        self.key, self._set = key, (self._set[0], dict(session.view.steps))

    def compare(self, first: Scene, second: Scene, name: str) -> None:
        """Show two pictures as A and B where they are ``comparable``; else the second."""
        self.show(second, (name, 1))
        if self.scene is second and comparable(first, second):
            self._first = first

    def update(self) -> None:
        """Update the figure that was requested, once a frame."""
        session = self.session
        if self._compared is not None and not session.drafts.opening:
            self.compared_with.resume(self._compared)
            self._compared = None
        if self.before_lesson is not None and session.drafts.opened != self._opened:
            self.forget_figure()  # the reader opened a sketch
            return
        if self._waits and session.drafts.stage is ReloadStage.NONE and session.shown is not None:
            self._waits = False
            self._set = session.shown.edits, dict(session.view.steps)
            self._compare()

    def go_back(self) -> None:
        """Show what was open before the lesson's figures, as it was; report it where it is gone."""
        own, session = self.before_lesson, self.session
        if own is None:
            return
        try:
            session.open(own.path, start=own.edits)
        except PlaygroundError as error:
            self.undo.notices.say(str(error))
            return
        self.compared_with.end()
        self._compared, self._first = own.compared, None
        self.undo.begin(own.history)
        session.restore_view(own.steps, own.map)
        session.view.framed_for = DEFAULT_PICTURE
        clock = session.clock
        clock.time, clock.playing, clock.loop = own.clock.time, own.clock.playing, own.clock.loop
        self._waits = False
        self._histories.pop(own.path, None)
        self.before_lesson = self.scene = self.key = None

    def _begin(self) -> None:
        """Store what is open, if the reader opened it."""
        if self.before_lesson is not None:
            return
        self._begins()
        session = self.session
        self.undo.record()
        edits, (steps, shown) = session.drafts.stored, session.view.state
        clock, compared = replace(session.clock), self._compared or self.compared_with.stored
        self._compared = None
        self.before_lesson = BeforeLesson(
            session.path, edits, steps, shown, clock, self.undo.opened, compared
        )
        self._opened = session.drafts.opened

    def _leave(self) -> None:
        """Store the user's edits of the sketch that is left, for when a lesson shows it again."""
        session = self.session
        if session.shown is not None and not session.drafts.opening:
            self.undo.record()
            self._histories[session.path] = self.undo.history, session.shown.edits

    def _compare(self) -> None:
        """Compare the picture that is shown with the first of two, divided by a line."""
        first, self._first = self._first, None
        draft = self.session.shown
        if first is not None and draft is not None:
            compare = self.compared_with
            compare.mode = Mode.DIVIDER
            compare.keep_state(draft.with_edits(edits_of(first, draft.file)), steps_of(first))

    def forget_figure(self) -> None:
        """Forget the figure: what is shown is the reader's own from here on."""
        self.before_lesson = self.scene = self.key = self._first = None
        self._waits = False
        self.session.view.framed_for = DEFAULT_PICTURE


def _record_change(history: History, before: Edits, after: Edits, now: float) -> None:
    """Record in a sketch's history that a lesson sets it again, so that undo restores what was there."""
    was, comes = changes_between(before, after)
    if was:
        history.record(was, comes, tr("Lesson"), now=now)
