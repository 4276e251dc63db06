"""A sketch being worked on: what is shown, what was changed by hand, what is wrong.

There are at most two drafts. ``shown`` is the last one that drew well; the panel shows
its parameters, and it goes on being drawn. ``coming`` is what was saved or chosen
since: it is tried (in the trial child, where there is one), then drawn, and only then
takes the place of ``shown``. If it fails, its error is kept and ``shown`` stays.

No window and no keys: ``frame(size)`` gives a texture to whoever has a screen.
"""

from __future__ import annotations

import time
from collections import deque
from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.engine.plan import Plan, repeats_of
from playground.engine.trial import TrySketch
from playground.errors import ContextError, ParameterError, PlaygroundError
from playground.live.begin import first_draft
from playground.live.clock import Clock, is_animated, reads_mouse
from playground.live.edits import Draft, Edits, reload_draft, taken
from playground.live.files import watched
from playground.live.maps import Map, fitted, refs_of
from playground.live.picture import Painter, Picture
from playground.live.stages import Reload, Stage, Tester, explained, has_draws
from playground.live.sunlight import suns_of, turned
from playground.live.words import Said
from playground.sketch.find import find
from playground.sketch.load import load
from playground.sketch.model import Camera, Sketch, Value, kernels_of
from playground.sketch.places import Signature, noting_places

if TYPE_CHECKING:
    import moderngl
    import numpy as np
    from numpy.typing import NDArray

REST = 0.2  # [s] without a change after which a hasty picture is drawn again in full
_SEEN_FROM = ("clip_from_world", "world_from_clip", "eye")


class Session:
    """One sketch, open."""

    def __init__(
        self,
        engine: Engine,
        path: str | Path = "",
        *,
        values: Mapping[str, Value] | None = None,
        edits: Edits | None = None,
        in_file: Mapping[str, Said] | None = None,
        trial: Tester | None = None,
        now: Callable[[], float] = time.perf_counter,
        is_lost: Callable[[], bool] = lambda: False,
    ) -> None:
        self.engine = engine
        self.path = find(path) if path else find("")
        self.clock = Clock()
        self.shown: Draft | None = None
        self.coming: Draft | None = None
        self.stage = Stage.NONE
        self.map: Map | None = None  # what is shown instead of the sketch's own view
        self.steps: dict[str, int] = {}  # repeats that are stopped early, by path
        self.notes: deque[str] = deque(maxlen=32)  # sentences for a person; whoever shows them takes them out
        self.plan: Plan | None = None  # of the last picture
        self.last_reload: Reload | None = None
        self.times: dict[str, float] = {}  # [ms] the last time each pass ran while profiling, by path
        self.draws = 0  # pictures drawn so far
        self.hasty = False  # the picture has one sample a pixel only, and will be drawn again in full
        self.read_at = 0.0  # [s since the epoch] when the files were last read
        self._another = False  # what is coming is another sketch than the one that is shown
        self.places: dict[Path, Signature | None] = {}  # where files were looked for, and what was there
        edits = edits or Edits()
        for name, value in (values or {}).items():
            edits = edits.with_value(name, value)
        self._initial = edits  # set by hand in an earlier session; the values, on the command line
        self._in_file = {k: v for k, v in (in_file or {}).items() if k not in (values or {})}
        self._trial = trial
        self._now = now
        self._is_lost = is_lost  # says whether the engine's context is lost
        self._lost_over: object = None  # what was shown when a context was lost last
        self._started = 0.0  # when what is coming began to be read
        self._trial_seconds = 0.0
        self._coming_notes: list[str] = []
        self._file_error: PlaygroundError | None = None  # of what is coming
        self._draw_error: PlaygroundError | None = None  # of what is shown
        self._painter = Painter(engine.ctx)
        self._picture = Picture(self._painter)
        self._repeats: tuple[Sketch | None, dict[str, int]] = (None, {})
        self._revision = 0
        self._picture_size: tuple[int, int] | None = None  # asked for last
        self._drawn: object = None  # what the picture shows
        self._drawn_at = 0.0
        self.reload()

    # ── what it is ───────────────────────────────────────────────────────────

    @property
    def sketch(self) -> Sketch | None:
        """The sketch that is shown; None before the first good one."""
        return self.shown.sketch if self.shown else None

    @property
    def error(self) -> PlaygroundError | None:
        """What is wrong just now."""
        return self._file_error or self._draw_error

    @property
    def testing(self) -> bool:
        """Whether an answer of the trial is awaited."""
        return self.stage is Stage.TRIAL

    @property
    def animated(self) -> bool:
        """Whether the picture changes with time."""
        return self.sketch is not None and is_animated(self.sketch)

    @property
    def orbits(self) -> bool:
        """Whether the picture is seen from the camera."""
        if self.sketch is None or self.map is not None:
            return False
        return any(kernel.reads(name) for _, kernel in kernels_of(self.sketch.graph) for name in _SEEN_FROM)

    @property
    def files(self) -> frozenset[Path]:
        """Every file worth watching: of the drafts, those that an error points at, and where others may come.

        See ``files.watched``.
        """
        drafts = [draft for draft in (self.shown, self.coming) if draft is not None]
        errors = [error for error in (self._file_error, self._draw_error) if error is not None]
        sketches = [sketch for draft in drafts for sketch in (draft.sketch, draft.file)]
        return watched(self.path, sketches, errors, self.places)

    @property
    def refs(self) -> list[str]:
        """Every texture that a map can show."""
        return refs_of(self.plan) if self.plan is not None else []

    @property
    def repeats(self) -> dict[str, int]:
        """How many turns every repeated kernel and loop of what is shown takes, by path."""
        if self.sketch is None:
            return {}
        if self._repeats[0] is not self.sketch:
            self._repeats = self.sketch, self._repeats_of(self.sketch)
        return self._repeats[1]

    # ── files ────────────────────────────────────────────────────────────────

    def reload(self) -> None:
        """Read the files again; what is new in them is shown once it has proved good."""
        self.read_at = time.time()
        self._started = self._now()
        try:
            with noting_places() as self.places:
                loaded = load(self.path)
            old = None if self._another else self.shown or self.coming
            draft, notes = (
                reload_draft(old, loaded) if old else first_draft(loaded, self._initial, self._in_file)
            )
        except Exception as error:
            self._drop_coming()
            self._file_error = explained(error)
            return
        if self.shown is not None and loaded == self.shown.file:
            self._drop_coming()
            self._file_error = self._draw_error = None
            self._revision += 1  # the texts are the same, but an image may be another
            return
        self._propose(draft, notes)

    def open(self, path: Path, *, keep: bool = False) -> None:
        """Open another sketch; the picture stays until that one has proved good.

        ``keep``: it is a copy of this one, and what is set by hand goes on.
        """
        self.path = find(path)
        if not keep:
            self._initial, self._in_file, self._another = Edits(), {}, True
            self.map = None
            self.steps.clear()
            self.clock.rewind()
        self.reload()

    def choose(self, pass_name: str, use: str) -> None:
        """Fill a pass with another technique, once that has proved good."""
        if self.shown is None:
            return
        self._started = self._now()
        try:
            self._propose(self.shown.choose(pass_name, use), [])
        except PlaygroundError as error:
            self._file_error = error

    def dismiss(self) -> None:
        """Put what failed away; a save brings it back."""
        if self.stage is Stage.FAILED:
            self._drop_coming()
        self._file_error = self._draw_error = None

    def _propose(self, draft: Draft, notes: list[str]) -> None:
        self.coming, self._coming_notes = draft, notes
        self._file_error, self._trial_seconds = None, 0.0
        if self._trial is None or not self._draws_anew(draft.sketch):
            self.stage = Stage.DRAW
            return
        self.stage = Stage.TRIAL
        self._trial.submit(TrySketch(draft.sketch, time=self.clock.time, drivers=(self.engine.driver,)))

    def _draws_anew(self, sketch: Sketch) -> bool:
        """Say whether the driver would be given anything that it has not drawn already.

        Another comment, label, range, preset or shot gives it nothing, and needs no trial.
        Other values do: they say how often a loop turns.
        """
        texture = self._picture.texture
        if self.shown is None or texture is None:
            return True
        chosen = replace(sketch, samples=1) if self.hasty else sketch
        try:
            steps = self._steps_for(sketch)
            return bool(self.engine.stale(chosen, size=texture.size, time=self.clock.time, steps=steps))
        except PlaygroundError:
            return True

    def _drop_coming(self) -> None:
        self.coming, self.stage, self._coming_notes = None, Stage.NONE, []

    # ── edits by hand ────────────────────────────────────────────────────────

    def set(self, path: str, value: object) -> None:
        """Set a parameter by its path; one that it does not take becomes a note."""
        if self.sketch is None:
            return
        try:
            changed = self.sketch.with_values({path: value})
        except ParameterError as error:
            self.notes.append(str(error))
            return
        kept = dict(changed.overrides).get(path, value)
        self._edit(lambda edits: edits.with_value(path, kept))  # type: ignore[arg-type]

    def set_all(self, values: Mapping[str, Value]) -> None:
        """Set several parameters at once; those that are locked, gone or do not take theirs stay."""
        if self.shown is not None:
            free = [(p, v) for p, v in values.items() if p not in self.shown.edits.locked]
            fit = {p: v for p, given in free if (v := taken(self.shown.base, p, given)) is not None}
            others = [(p, v) for p, v in self.shown.edits.values if p not in fit]
            self._edit(lambda edits: replace(edits, values=(*others, *fit.items())))

    def unset(self, *paths: str) -> None:
        """Give parameters back the file's values."""
        draft = self.shown
        if draft is not None:
            for path in paths:
                draft = draft.without(path)
            left = draft.edits.values
            self._edit(lambda edits: replace(edits, values=left))

    def lock(self, path: str, locked: bool) -> None:
        """Lock a parameter against presets, chance and reloads, or let it go."""
        self._edit(lambda edits: edits.with_lock(path, locked))

    def restore(self, edits: Edits) -> None:
        """Take other edits for those of now: values and camera at once, techniques once they proved good."""
        if self.shown is None:
            return
        if edits.techniques == self.shown.edits.techniques:
            self._edit(lambda old: replace(edits, techniques=old.techniques))
            return
        self._started = self._now()
        try:
            self._propose(self.shown.with_techniques(edits.techniques).with_edits(edits), [])
        except PlaygroundError as error:
            self._file_error = error

    def look(self, camera: Camera) -> None:
        """See the land from another camera."""
        self._edit(lambda edits: replace(edits, camera=camera))

    def apply_preset(self, name: str) -> None:
        """Set the values of one of the sketch's presets."""
        for preset in self.sketch.presets if self.sketch else ():
            if preset.name == name:
                self.set_all(dict(preset.values))

    def point(self, mouse: tuple[float, float, float, float]) -> None:
        """Tell plain shaders where the mouse is: pixels from the lower left, then where it was pressed."""
        if self.engine.runner.mouse != mouse and self.sketch is not None and reads_mouse(self.sketch):
            self.engine.runner.mouse = mouse
            self._revision += 1

    def look_again(self) -> None:
        """Draw anew: a file that the sketch reads has changed."""
        self._revision += 1

    def turn_suns(self, across: float, up: float) -> None:
        """Move every sun of the sketch by so much of the picture's height, to the right and upwards."""
        if self.sketch is not None:
            for path, sun in suns_of(self.sketch).items():
                self.set(path, turned(sun, across, up))

    def reset_camera(self) -> None:
        """See the land as the file says."""
        self._edit(lambda edits: replace(edits, camera=None))

    def reset_values(self) -> None:
        """Give all that is not locked, and every pass, back what the file says; stop no repeat early."""
        self.steps.clear()
        if self.shown is not None:
            locked = set(self.shown.edits.locked)
            left = tuple(v for v in self.shown.edits.values if v[0] in locked)
            self.restore(replace(self.shown.edits, values=left, techniques=()))

    def _edit(self, change: Callable[[Edits], Edits]) -> None:
        self._revision += 1
        if self.shown is not None:
            self.shown = self.shown.with_edits(change(self.shown.edits))
        if self.coming is not None:
            self.coming = self.coming.with_edits(change(self.coming.edits))

    def advance(self, seconds: float, date: datetime) -> None:
        """Let so much of the wall's time pass, unless the clock rests; plain shaders are told the date."""
        self.clock.advance(seconds)
        midnight = date.replace(hour=0, minute=0, second=0, microsecond=0)
        runner = self.engine.runner
        runner.delta = seconds * self.clock.speed
        runner.date = (float(date.year), date.month - 1.0, float(date.day), (date - midnight).total_seconds())

    # ── what is shown ────────────────────────────────────────────────────────

    def show(self, ref: str | None) -> None:
        """Show a texture from above, its range fitted to its values; None: the sketch's own view."""
        self._revision += 1
        self.map = Map(ref) if ref else None
        self.fit_map()

    def set_map(self, name: str, value: Value) -> None:
        """Set a parameter of the map."""
        if self.map is not None:
            self._revision += 1
            self.map = self.map.with_value(name, value)

    def stop_at(self, path: str, turn: int) -> None:
        """Show a repeated pass after so many turns; after its last, it runs to its end again."""
        self._revision += 1
        self.steps.pop(path, None)
        if 0 <= turn < self.repeats.get(path, 0):
            self.steps[path] = turn

    def fit_map(self) -> None:
        """Fit the map's channel and range to the texture's values."""
        if self.map is None or self.sketch is None:
            return
        self._revision += 1
        values = self.read_values(self.map.ref)
        self.map = fitted(self.map, values) if values is not None else None

    def read_values(self, ref: str) -> NDArray[np.float32] | None:
        """Return a texture's values as the picture has them, row 0 south; None, and a note, if that fails."""
        if self.sketch is None:
            return None
        try:
            steps = self._steps_for(self.sketch)
            return self.engine.read(self.sketch, ref, time=self.clock.time, steps=steps)
        except PlaygroundError as error:
            self.notes.append(str(error))
            return None

    def frame(self, size: tuple[int, int]) -> moderngl.Texture | None:
        """Return the picture, drawn anew if anything changed; None before the first good one.

        ``size`` in pixels. The texture stays good until the next call. Nothing is raised
        for a mistake in the sketch: it is in ``error``, and the last good picture stays.
        """
        self._picture_size = size
        self._hear_trial()
        if self.stage is Stage.DRAW:
            self._draw_coming(size)
        if self.shown is not None and self._wanted(size) != self._drawn:
            self._draw_shown(size)
        elif self.hasty and self.shown is not None and self._now() - self._drawn_at >= REST:
            self._draw_shown(size, in_full=True)
        return self._picture.texture

    def release(self) -> None:
        """Give back the picture; the engine is its owner's."""
        self._picture.release()
        self._painter.release()

    def rebuild(self, engine: Engine) -> None:
        """Go on with another engine: the context of the one before is lost, and all that was in it.

        What is shown is drawn anew, unless it was just that which cost two contexts already:
        then it waits until something is changed.
        """
        engine.runner.mouse = self.engine.runner.mouse
        self.engine, self.plan, self.hasty = engine, None, False
        self._painter = Painter(engine.ctx)
        self._picture = Picture(self._painter)
        self._drawn, drawn = None, (self.shown, self._revision)
        if self._lost_over == drawn and self._picture_size is not None:
            self._drawn = self._wanted(self._picture_size)
            message = "this made the graphics driver reset itself twice; it waits until something is changed"
            self._draw_error = ContextError(message)
        self._lost_over = drawn
        self.notes.append("the graphics driver was reset; everything was built anew")

    def read(self) -> Frame | None:
        """Read the picture back, in full; None before the first."""
        if self.hasty and self._picture.texture is not None:
            self._draw_shown(self._picture.texture.size, in_full=True)
        return self._picture.frame(self.sketch.name if self.sketch else "", self.clock.time)

    def _wanted(self, size: tuple[int, int]) -> object:
        return self._revision, size, self.clock.time if self.animated else 0.0

    def _hear_trial(self) -> None:
        if self.stage is not Stage.TRIAL or self._trial is None:
            return
        report = self._trial.poll()
        if report is None:
            return
        # Without a context the child can try nothing; this one may well have what it takes.
        if report.ok or isinstance(report.error, ContextError):
            self.stage = Stage.DRAW
            self._trial_seconds = report.seconds
            return
        self.stage = Stage.FAILED
        self._file_error = report.error or PlaygroundError("the trial failed without saying why")

    def _draw_coming(self, size: tuple[int, int]) -> None:
        assert self.coming is not None
        try:
            self._draw(self.coming.sketch, size)
            self.engine.ctx.finish()
            if self._is_lost():
                raise ContextError("this made the graphics driver reset itself, so it is not drawn again")
        except Exception as error:
            self.stage = Stage.FAILED
            self._file_error = explained(error)
            return
        self.shown, self._another = self.coming, False
        self.notes.extend(self._coming_notes)
        self._drop_coming()
        self._file_error = self._draw_error = None
        self._drawn = self._wanted(size)
        self.last_reload = Reload(self._now() - self._started, self._trial_seconds)
        if self.map is not None:
            self._draw_shown(size)

    def _draw_shown(self, size: tuple[int, int], *, in_full: bool = False) -> None:
        assert self.shown is not None
        self._drawn = self._wanted(size)
        sketch = self.shown.sketch
        try:
            if self.map is not None and self.map.ref not in self.refs:
                self.notes.append(f"{self.map.ref} is gone, so the sketch's own view is shown")
                self.map = None
            self._draw(self.map.of(sketch) if self.map else sketch, size, in_full=in_full)
            self._draw_error = None
        except Exception as error:
            self._draw_error = explained(error)

    def _draw(self, sketch: Sketch, size: tuple[int, int], *, in_full: bool = False) -> None:
        """Draw; where the processor draws, hastily first: four samples take it three times as long as one."""
        hasty = self.engine.info.software and not in_full and sketch.samples > 1 and has_draws(sketch)
        self.engine.runner.frame = self.draws
        chosen = replace(sketch, samples=1) if hasty else sketch
        texture = self.engine.draw(chosen, size=size, time=self.clock.time, steps=self._steps_for(sketch))
        self.hasty = hasty
        self._drawn_at = self._now()
        self._picture.keep(texture)
        self.draws += 1
        self.times |= self.engine.times
        self.plan = self.engine.plan

    def _repeats_of(self, sketch: Sketch) -> dict[str, int]:
        try:
            return repeats_of(sketch, time=self.clock.time)
        except PlaygroundError:  # it says so when it is drawn
            return {}

    def _steps_for(self, sketch: Sketch) -> dict[str, int]:
        """Return where to stop: a repeat that is gone, or has fewer turns by now, is not stopped."""
        if not self.steps:
            return {}
        repeats = self._repeats_of(sketch)
        return {path: turn for path, turn in self.steps.items() if turn < repeats.get(path, 0)}
