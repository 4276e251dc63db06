"""Two states of a sketch side by side: A is stored as it was, B is what is worked on.

A is a draft, with its texts in memory, and its picture. While nothing but B changes, that
picture stays. When the camera, the time, the size or the texture that is shown moves on, or the
forms of its passes that previews have of B, A is drawn again from its draft; where that can no
longer be done, since an image that it reads is another now or a pass does not draw, its picture
stays, and a notice says so.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.plan import Plan
from playground.engine.planner import repeats_of
from playground.errors import PlaygroundError
from playground.sketch.map_sketch import Map
from playground.sketch.model import Sketch
from playground.sketch.traits import is_animated, traits_of
from playground.studio.edits.edits import Draft, StoredEdits, first_draft
from playground.studio.edits.memory import Compared
from playground.studio.land.looks import Look
from playground.studio.language import tr
from playground.studio.picture.full_screen import Blend, Painter, Picture
from playground.studio.picture.preview import as_preview
from playground.studio.picture.shown_picture import pointed_at
from playground.studio.reload.dependencies import hash_of
from playground.studio.session import Session

if TYPE_CHECKING:
    import moderngl

    from playground.engine.engine import Engine

PERIOD = 0.5
"""[s] that each of the two is shown while they flicker."""


class Mode(Enum):
    """How the two are shown."""

    DIVIDER = "divider"
    FLICKER = "flicker"
    DIFFERENCE = "difference"


@dataclass(frozen=True)
class Stored:
    """One state."""

    path: Path  # of the sketch's file
    draft: Draft
    steps: Mapping[str, int]  # repeats that are stopped early
    files: Mapping[Path, str]  # hashes of the images and heightmaps it reads, as they were


class Compare:
    """A, and how it is shown with what one session shows."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.mode = Mode.DIVIDER
        self.split = 0.5  # fraction of the picture's width where the two meet
        self.gain = 8.0  # of the difference
        self.held = False  # the line between them is held
        self.draws = 0  # pictures of A that were drawn
        self.blend: Blend | None = None  # who paints the two
        self._stored: Stored | None = None
        self._painter: Painter | None = None
        self._picture: Picture | None = None
        self._drawn: object = None  # what A's picture shows
        self._is_preview = False  # as of ``as_preview``
        self._reported = False  # that A cannot be drawn
        self._recalled: tuple[Compared, Draft] | None = None  # A of an earlier session, while it is tried

    @property
    def on(self) -> bool:
        """Whether there is an A."""
        return self._stored is not None

    @property
    def stored(self) -> Stored | None:
        """A itself, to be restored later by ``resume``."""
        return self._stored

    @property
    def picture(self) -> moderngl.Texture | None:
        """A's picture; None where there is no A."""
        return self._picture.texture if self.on and self._picture is not None else None

    # ── storing, swapping ────────────────────────────────────────────────────

    def toggle(self) -> None:
        """Store what is shown as A, or end the comparison."""
        if self.on:
            self.end()
        else:
            self.keep()

    def keep(self) -> None:
        """Store what is shown as A."""
        self._set(self._now())

    def resume(self, stored: Stored) -> None:
        """Compare with an A that was stored before; it ends where another sketch is open by now."""
        self._set(stored)

    def keep_state(self, draft: Draft, steps: Mapping[str, int]) -> None:
        """Store another state of the shown sketch as A; it is drawn as B is shown."""
        now = self._now()
        if now is not None:
            self._set(replace(now, draft=draft, steps=dict(steps)))

    def end(self) -> None:
        """End the comparison."""
        self._stored = None
        self.release()

    def back(self) -> None:
        """Restore A as the current state; it stays stored."""
        if self._stored is not None:
            self._take(self._stored)

    def swap(self) -> None:
        """Exchange A and the current state."""
        now, before = self._now(), self._stored
        if before is not None and now is not None:
            self._take(before)
            self._set(now)

    # ── over a restart ───────────────────────────────────────────────────────

    def remembered(self) -> Compared | None:
        """Return what brings A back in a later session; None where there is none."""
        if self._stored is None:
            return None
        steps = tuple(sorted(self._stored.steps.items()))
        return Compared(self._stored.draft.edits, steps, self.mode.value, self.split, self.gain)

    def recall(self, compared: Compared) -> bool:
        """Compare with A of an earlier session, over the files as they are now; return whether that is done.

        Until it has proved good it is tried as what is saved is: ask again.
        """
        session = self.session
        if session.shown is None or session.plan is None:
            return False
        recalled, file = self._recalled, session.shown.file
        if recalled is None or recalled[0] is not compared or recalled[1].file is not file:
            recalled = self._recalled = compared, first_draft(file, StoredEdits(compared.edits))[0]
        draft = recalled[1]
        report = session.drafts.check_aside(draft.sketch)
        if report is None:
            return False
        self._recalled = None
        if not report.ok:
            session.notes.append(tr("A of the last session is left out: {error}", error=report.error))
            return True
        try:
            plan = session.engine.plan(draft.sketch, session.plan.frame_size, session.clock.time)
        except PlaygroundError as error:
            session.notes.append(tr("A of the last session is left out: {error}", error=error))
            return True
        files = {path: hash_of(path) for path in _files_of(plan)}
        self._set(Stored(session.drafts.shown_path, draft, dict(compared.steps), files))
        self.split, self.gain = compared.split, compared.gain
        self.mode = next((mode for mode in Mode if mode.value == compared.mode), Mode.DIVIDER)
        return True

    def _set(self, stored: Stored | None) -> None:
        self._stored, self._drawn, self._reported = stored, None, False

    def _now(self) -> Stored | None:
        session = self.session
        if session.shown is None or session.plan is None:
            return None
        files = {path: hash_of(path) for path in _files_of(session.plan)}
        return Stored(session.drafts.shown_path, session.shown, dict(session.view.steps), files)

    def _take(self, stored: Stored) -> None:
        session = self.session
        if session.shown is not None and stored.draft.file is not session.shown.file:
            session.notes.append(tr("A is of the files as they were; the next save brings those of now"))
        session.drafts.show(stored.draft)
        session.view.steps.clear()
        session.view.steps.update(stored.steps)
        session.redraw()

    # ── A's picture ──────────────────────────────────────────────────────────

    def follow(self, picture: moderngl.Texture) -> None:
        """Draw A's picture at the size, camera and time of B's, which the session has just drawn."""
        stored, session = self._stored, self.session
        if stored is None or session.awaits_data:
            return
        if stored.path != session.drafts.shown_path:
            self.end()  # another sketch was opened
            return
        plan = session.plan
        if plan is None:
            return
        if self._painter is not None and self._painter.ctx is not session.engine.ctx:
            self._picture = self._painter = self._drawn = None  # they went with a context that was lost
        if self._picture is None:
            self._painter = Painter(session.engine.ctx)
            self._picture = Picture(self._painter)
        key = self._picture_key(stored, plan, picture.size)
        if self._drawn is None and stored.draft is session.shown and stored.steps == session.view.steps:
            with session.engine.borrowed():
                self._picture.copy(picture)
            self._drawn, self._is_preview = key, session.is_preview
        elif self._is_preview and not session.is_preview:
            self._draw(stored, plan, picture.size, preview=False)
            self._drawn = key
        elif key != self._drawn:
            self._draw(stored, plan, picture.size, preview=session.engine.info.software)
            self._drawn = key

    def release(self) -> None:
        """Release what was made in the engine's context; it is drawn again where it is needed."""
        for made in (self._picture, self._painter, self.blend):
            if made is not None:
                made.release()
        self._picture = self._painter = self.blend = self._drawn = None

    def _picture_key(self, stored: Stored, plan: Plan, size: tuple[int, int]) -> object:
        shown = self._shown()
        time = plan.time if is_animated(stored.draft.sketch) else 0.0
        view_inputs = size, plan.sketch.camera, plan.interpolated, plan.exaggeration
        return stored.draft, view_inputs, time, shown, self._faster(stored.draft.sketch), self.session.engine

    def _faster(self, sketch: Sketch) -> frozenset[str]:
        """Return the passes of A that have the forms of previews, since B's have them."""
        return self.session.picture.faster.intersection(path for path, _ in traits_of(sketch).faster)

    def _draw(self, stored: Stored, plan: Plan, size: tuple[int, int], *, preview: bool) -> None:
        """Draw A with as many pixels as B was drawn with, and at the size that B is shown at."""
        assert self._picture is not None
        session, engine = self.session, self.session.engine
        sketch = self._seen_as(stored.draft.sketch, plan)
        faster = self._faster(sketch)
        chosen = as_preview(sketch, size, plan.frame_size, faster) if preview else sketch
        changed = [path for path, before in stored.files.items() if hash_of(path) != before]
        try:
            if changed:
                raise PlaygroundError(f"{changed[0].name} is another file now")
            with as_before(engine, plan):
                repeats = repeats_of(chosen, time=plan.time)
                # A save may have left fewer steps than it stopped at.
                steps = {path: step for path, step in stored.steps.items() if step < repeats.get(path, 0)}
                with pointed_at(engine.runner, size, plan.frame_size):
                    texture = _drawn(engine, chosen, plan, steps)
                with engine.borrowed():
                    self._picture.copy(texture, size)
        except Exception as error:
            if not self._reported:
                session.notes.append(tr("A stays as it was drawn last: {error}", error=error))
            self._reported, self._is_preview = True, False
            return
        self.draws += 1
        self._is_preview = chosen is not sketch or plan.frame_size != size

    def _seen_as(self, sketch: Sketch, plan: Plan) -> Sketch:
        """Return a sketch as B is shown: by its camera, and the same texture if one is shown."""
        shown = self._shown()
        seen = sketch.with_camera(plan.sketch.camera)
        return shown.of(seen) if shown is not None else seen

    def _shown(self) -> Map | Look | None:
        """Return what is shown in place of the sketch's own view."""
        view = self.session.view
        return view.map if view.map is not None else view.look


@contextmanager
def as_before(engine: Engine, plan: Plan) -> Iterator[None]:
    """Draw something else, and leave the engine's records those of the picture before it."""
    record, runs, profiling = engine.record, engine.runs.copy(), engine.options.profiling
    engine.options.profiling = False
    try:
        yield
    finally:
        # All of it is cached, so that nothing runs; what was computed for the picture is current again.
        try:
            _drawn(engine, plan.sketch, plan, plan.steps)
        finally:
            engine.options.profiling = profiling
            engine.record = engine.record.counted_as(record)
            engine.runs.clear()
            engine.runs.update(runs)


def _drawn(engine: Engine, sketch: Sketch, plan: Plan, steps: Mapping[str, int]) -> moderngl.Texture:
    """Draw a sketch as a plan does its own."""
    size, fills = plan.frame_size, plan.interpolated
    return engine.draw(sketch, size=size, time=plan.time, steps=steps, interpolated=fills)


def _files_of(plan: Plan) -> list[Path]:
    """Return the images and heightmaps that a picture was made from."""
    files = []
    for step in plan.walk():
        for parameter in step.kernel.parameters:
            if parameter.widget.kind == "file" and step.values.get(parameter.name):
                files.append(Path(str(step.values[parameter.name])))
    return files
