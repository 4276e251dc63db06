"""The live view as a lesson's stage: what it shows for a lesson, and what was open before.

What was set by hand in a sketch is not lost when a lesson shows another picture of it:
undo brings it back. What was open before the lesson began comes back whole, with its own
undo, by ``go_back``. As long as a lesson is on the stage, nothing is remembered of the
sketch for the next start: what a lesson sets is no wish of the reader's.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from playground.errors import PlaygroundError
from playground.lessons.model import Scene
from playground.sketch.load import load
from playground.sketch.map_sketch import Map
from playground.sketch.model import DEFAULT_PICTURE
from playground.workbench.actions import Actions
from playground.workbench.clock import Clock
from playground.workbench.edits import Edits
from playground.workbench.history import History, state_of
from playground.workbench.inspect.compare import Kept, Mode
from playground.workbench.lesson.figure_state import edits_of, map_of, path_of, steps_of
from playground.workbench.reload_stages import ReloadStage
from playground.workbench.resume import StoredEdits

Key = tuple[str, int]
"""A picture of a lesson: the name of its block, and which of the block's."""


@dataclass(frozen=True)
class Own:
    """What the reader had open."""

    path: Path
    edits: StoredEdits
    steps: Mapping[str, int]
    map: Map | None
    clock: Clock
    history: History
    compared: Kept | None  # the A that it was compared with


class Stage:
    """What one session shows for a lesson."""

    def __init__(self, actions: Actions, begins: Callable[[], None] = lambda: None) -> None:
        self.actions = actions
        self.own: Own | None = None
        self.key: Key | None = None  # of the picture that is shown
        self.scene: Scene | None = None
        self._begins = begins  # told before the first picture takes the stage
        self._path: Path | None = None
        self._set: tuple[Edits, Mapping[str, int]] = (Edits(), {})  # for the picture
        self._histories: dict[Path, tuple[History, Edits]] = {}
        self._waits = False
        self._first: Scene | None = None  # what the picture is to be compared with
        self._compared: Kept | None = None  # the A that comes back with what was open

    @property
    def busy(self) -> bool:
        """Whether a picture is still to come."""
        return self.actions.session.drafts.stage in (ReloadStage.SANDBOX, ReloadStage.DRAW)

    @property
    def changed(self) -> bool:
        """Whether the reader has set something by hand since the picture was shown, or at all before any."""
        session = self.actions.session
        if session.shown is None:
            return False
        edits = session.shown.edits
        if self.own is None or self.scene is None:
            return bool(edits.values or edits.techniques)
        return not self.busy and (edits, dict(session.view.steps)) != self._set

    def show(self, scene: Scene, key: Key, texts: Mapping[str, str] | None = None) -> None:
        """Show a picture of a lesson; ``texts``, by absolute path, stand in for shaders' files."""
        actions, session = self.actions, self.actions.session
        path, texts = path_of(scene), texts or {}
        try:
            known = session.shown if session.path == path and not session.drafts.opening else None
            file = known.file if known is not None else load(path)
            edits, steps = edits_of(scene, file), steps_of(scene)
        except PlaygroundError as error:
            actions.say(str(error))
            return
        self._begin()
        actions.see.compare.end()
        self._first = None
        if known is None:
            self._leave()
            history, before = self._histories.get(path, (History(), edits))
            _note(history, before, edits, actions.now())
            session.open(path, start=StoredEdits(edits), texts=texts)
            actions.history = history
        else:
            actions.look_back(False)
            actions.history.call(f"Lesson: {key[0]}")
            session.drafts.read_as(texts)
            session.drafts.restore(edits)
        session.restore_view(steps, map_of(scene))
        session.view.framed_for = scene.pixels
        session.clock.time, session.clock.playing = scene.time, False
        self.scene, self.key, self._path, self._waits = scene, key, session.path, True
        self._set = edits, steps

    def set_texts(self, texts: Mapping[str, str]) -> None:
        """Have texts stand in for shaders' files in what is shown now; the reader's own stays that."""
        self.actions.session.drafts.read_as(texts)

    def stop_at(self, steps: Mapping[str, int], key: Key) -> None:
        """Stop repeats of the picture that is shown after other turns."""
        session = self.actions.session
        for path, turn in steps.items():
            session.stop_at(path, turn)
        self.key, self._set = key, (self._set[0], dict(session.view.steps))

    def compare(self, first: Scene, second: Scene, name: str) -> None:
        """Show two pictures as A and B where they are ``comparable``; else the second."""
        self.show(second, (name, 1))
        if self.scene is second and comparable(first, second):
            self._first = first

    def turn(self) -> None:
        """Take in what has become of the picture that was asked for; once a turn."""
        session = self.actions.session
        if self._compared is not None and not session.drafts.opening:
            self.actions.see.compare.take_up(self._compared)
            self._compared = None
        if self.own is not None and session.path != self._path:
            self.let_go()  # the reader opened a sketch
            return
        if self._waits and session.drafts.stage is ReloadStage.NONE and session.shown is not None:
            self._waits = False
            self._set = session.shown.edits, dict(session.view.steps)
            self._compare()

    def go_back(self) -> None:
        """Show what was open before the lesson took the stage, as it was; say so where it is gone."""
        own, session = self.own, self.actions.session
        if own is None:
            return
        try:
            session.open(own.path, start=own.edits)
        except PlaygroundError as error:
            self.actions.say(str(error))
            return
        self.actions.see.compare.end()
        self._compared, self._first = own.compared, None
        self.actions.history = own.history
        session.restore_view(own.steps, own.map)
        session.view.framed_for = DEFAULT_PICTURE
        clock = session.clock
        clock.time, clock.playing, clock.loop = own.clock.time, own.clock.playing, own.clock.loop
        self._waits = False
        self._histories.pop(own.path, None)
        self.own = self.scene = self.key = None
        self._path = session.path

    def _begin(self) -> None:
        """Keep what is open, if the reader opened it."""
        if self.own is not None:
            return
        self._begins()
        actions, session = self.actions, self.actions.session
        actions.look_back(False)
        edits, (steps, shown) = session.drafts.stored, session.view.state
        clock, compared = replace(session.clock), self._compared or actions.see.compare.kept
        self._compared = None
        self.own = Own(session.path, edits, steps, shown, clock, actions.history, compared)
        self._path = session.path

    def _leave(self) -> None:
        """Keep what was set by hand in the sketch that is left, for when a lesson shows it again."""
        session = self.actions.session
        if session.shown is not None and not session.drafts.opening:
            self.actions.look_back(False)
            self._histories[session.path] = self.actions.history, session.shown.edits

    def _compare(self) -> None:
        """Have the picture that is shown parted by a line from the one it is compared with."""
        first, self._first = self._first, None
        draft = self.actions.session.shown
        if first is not None and draft is not None:
            compare = self.actions.see.compare
            compare.mode = Mode.DIVIDER
            compare.keep_other(draft.with_edits(edits_of(first, draft.file)), steps_of(first))

    def let_go(self) -> None:
        """Let the stage go: what it shows is the reader's own from here on."""
        self.own = self.scene = self.key = self._first = None
        self._waits = False
        self.actions.session.view.framed_for = DEFAULT_PICTURE


def comparable(first: Scene, second: Scene) -> bool:
    """Say whether one sketch shows both, at one time and from one place: only then a line can part them."""
    one, other = (
        (scene.sketch.file, scene.time, scene.view, scene.sketch.camera) for scene in (first, second)
    )
    return one == other


def _note(history: History, before: Edits, after: Edits, now: float) -> None:
    """Put into a sketch's history that a lesson sets it anew, so that undo brings back what was there."""
    was, comes = state_of(before, {}), state_of(after, {})
    keys = [key for key in {*was, *comes} if was.get(key) != comes.get(key)]
    if keys:
        history.record({k: was.get(k) for k in keys}, {k: comes.get(k) for k in keys}, "Lesson", now=now)
