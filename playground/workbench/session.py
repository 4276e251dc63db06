"""A sketch being worked on, as it is seen: its picture, a map of a texture, its time.

Which sketch that is, ``workbench.drafts`` says. No window and no keys: ``frame(size)`` gives
a texture to whoever has a screen.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.engine import Engine
from playground.engine.files import content_hash
from playground.engine.frame import Frame
from playground.engine.plain_forms import silent
from playground.engine.plan import Plan
from playground.engine.planner import repeats_of
from playground.errors import ContextError, PlaygroundError
from playground.sketch.allowed_files import Signature, signature
from playground.sketch.map_sketch import Map
from playground.sketch.model import DEFAULT_PICTURE, Camera, Sketch, Value, kernels_of
from playground.workbench.clock import is_animated, reads_mouse
from playground.workbench.dependencies import data_files
from playground.workbench.drafts import Drafts
from playground.workbench.edit_merge import Said
from playground.workbench.edits import Edits
from playground.workbench.framing import framed
from playground.workbench.last_frame import Painter, Picture
from playground.workbench.maps import fitted, in_view, refs_of
from playground.workbench.preview import hastily
from playground.workbench.reload_stages import Reload, Stage, Tester, explained

if TYPE_CHECKING:
    import moderngl
    import numpy as np
    from numpy.typing import NDArray

REST = 0.2  # [s] without a change after which a hasty picture is drawn again in full
_SEEN_FROM = ("clip_from_world", "world_from_clip", "eye")


def is_seen_from_camera(sketch: Sketch) -> bool:
    """Say whether the camera moves anything in a sketch's picture."""
    return any(kernel.reads(name) for _, kernel in kernels_of(sketch.graph) for name in _SEEN_FROM)


class Session(Drafts):
    """One sketch, open."""

    def __init__(
        self,
        engine: Engine,
        path: str | Path = "",
        *,
        values: Mapping[str, Value] | None = None,
        edits: Edits | None = None,
        in_file: Mapping[str, Said] | None = None,
        camera_in_file: Camera | None = None,
        plain: bool = False,
        trial: Tester | None = None,
        now: Callable[[], float] = time.perf_counter,
        is_lost: Callable[[], bool] = lambda: False,
    ) -> None:
        super().__init__(
            path,
            driver=engine.driver,
            variants=engine.plain_forms.kinds,
            plain=plain,
            values=values,
            edits=edits,
            in_file=in_file,
            camera_in_file=camera_in_file,
            trial=trial,
            now=now,
        )
        self.engine = engine
        engine.plain_forms.notice = silent  # ``notes`` say it
        self.map: Map | None = None  # what is shown instead of the sketch's own view
        self.steps: dict[str, int] = {}  # repeats that are stopped early, by path
        self.interpolated = True  # what a stopped repeat has not reached is filled
        self._next_view: tuple[dict[str, int], Map | None] | None = None  # of a sketch that was opened
        self.plan: Plan | None = None  # of the last picture
        self.last_reload: Reload | None = None
        self.times: dict[str, float] = {}  # [ms] the last time each pass ran while profiling, by path
        self.draws = 0  # pictures drawn so far
        self.framed_for = DEFAULT_PICTURE  # [pixels] the picture whose sides are seen in a narrower room too
        self.hasty = False  # the picture was drawn hastily, and will be drawn again in full
        self._is_lost = is_lost  # says whether the engine's context is lost
        self._lost_over: object = None  # what was shown when a context was lost last
        self._painter = Painter(engine.ctx)
        self._picture = Picture(self._painter)
        self._repeats: tuple[Sketch | None, dict[str, int]] = (None, {})
        self._picture_size: tuple[int, int] | None = None  # asked for last
        self._drawn: object = None  # what the picture shows
        self._drawn_at = 0.0
        # Images and elevation files that were drawn with: what they were, and a hash of it.
        self._read: dict[Path, tuple[Signature | None, str]] = {}
        self._read_for: Sketch | None = None  # the sketch that these are the files of
        self._told_of_ground = False  # that the eye stood under it
        self.reload()

    @property
    def animated(self) -> bool:
        """Whether the picture changes with time."""
        return self.sketch is not None and is_animated(self.sketch)

    @property
    def orbits(self) -> bool:
        """Whether the picture is seen from the camera."""
        if self.sketch is None or self.map is not None:
            return False
        return is_seen_from_camera(self.sketch)

    @property
    def refs(self) -> list[str]:
        """Every texture that a map can show."""
        return refs_of(self.plan) if self.plan is not None else []

    def can_show(self, ref: str) -> bool:
        """Say whether a map can show a texture: one of ``refs``, or one of the view itself."""
        return ref in self.refs or (self.sketch is not None and in_view(self.sketch, ref))

    @property
    def repeats(self) -> dict[str, int]:
        """How many turns every repeated kernel and loop of what is shown takes, by path."""
        if self.sketch is None:
            return {}
        if self._repeats[0] is not self.sketch:
            self._repeats = self.sketch, self._repeats_of(self.sketch)
        return self._repeats[1]

    def point(self, mouse: tuple[float, float, float, float]) -> None:
        """Tell plain shaders where the mouse is: pixels from the lower left, then where it was pressed."""
        if self.engine.runner.mouse != mouse and self.sketch is not None and reads_mouse(self.sketch):
            self.engine.runner.mouse = mouse
            self._revision += 1

    def reset_values(self) -> None:
        """Give all that is not locked, and every pass, back what the file says; stop no repeat early."""
        self.steps.clear()
        super().reset_values()

    def look_again(self) -> None:
        """Draw anew: a file that the sketch reads has changed."""
        self._revision += 1

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

    def view(self, steps: Mapping[str, int], shown: Map | None) -> None:
        """Stop repeats after so many turns, and show a map or, with None, the sketch's own view.

        Where another sketch was opened, that one is seen so, as soon as it is drawn.
        """
        if self.leaves:
            self._next_view = dict(steps), shown
            return
        self.steps.clear()
        self.steps.update(steps)
        self.map = shown
        self._revision += 1

    def seen_next(self) -> tuple[dict[str, int], Map | None]:
        """Return what ``view`` takes to see the sketch that is open so again, drawn already or not."""
        if self._next_view is not None:
            return self._next_view
        return dict(self.steps), self.map

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

    def interpolate(self, on: bool) -> None:
        """Fill what stopped repeats have not reached, where their headers say how, or show it as it is."""
        self._revision += 1
        self.interpolated = on

    def fit_map(self) -> None:
        """Fit the map's channel and range to the texture's values."""
        if self.map is None or self.sketch is None:
            return
        self._revision += 1
        values = self.read_values(self.map.ref)
        self.map = fitted(self.map, values) if values is not None else None

    def read_values(self, ref: str) -> NDArray[np.float32] | None:
        """Return a texture's values as the picture has them, row 0 south; None, and a note, if that fails."""
        if self.sketch is None or self._awaits_data(self.sketch):
            return None
        try:
            steps = self._steps_for(self.sketch)
            now, fills = self.clock.time, self.interpolated
            return self.engine.read(self.sketch, ref, time=now, steps=steps, interpolated=fills)
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
        engine.plain_forms.notice = silent
        engine.painted.update(self.engine.painted)
        self.engine, self.plan, self.hasty = engine, None, False
        self._painter = Painter(engine.ctx)
        self._picture = Picture(self._painter)
        self._drawn, drawn = None, (self.shown, self._revision)
        if self._lost_over == drawn and self._picture_size is not None:
            self._drawn = self._wanted(self._picture_size)
            message = "this made the graphics driver reset itself twice; it waits until something is changed"
            self._draw_error = explained(ContextError(message), self.path)
        self._lost_over = drawn
        self.notes.append("the graphics driver was reset; everything was built anew")

    def read(self) -> Frame | None:
        """Read the picture back, in full; None before the first."""
        if self.hasty and self._picture.texture is not None:
            self._draw_shown(self._picture.texture.size, in_full=True)
        return self._picture.frame(self.sketch.name if self.sketch else "", self.clock.time)

    def _wanted(self, size: tuple[int, int]) -> object:
        return self._revision, size, self.framed_for, self.clock.time if self.animated else 0.0

    def _draws_anew(self, sketch: Sketch) -> bool:
        """Say whether the driver would be given anything that it has not drawn already.

        Another comment, label, range, preset or shot gives it nothing, and needs no trial.
        Other values do: they say how often a loop turns.
        """
        texture = self._picture.texture
        if self.shown is None or texture is None or self._reads_anew(sketch):
            return True
        chosen = self._framed(hastily(sketch) if self.hasty else sketch, texture.size)
        try:
            steps, fills = self._steps_for(sketch), self.interpolated
            size, now = texture.size, self.clock.time
            return bool(self.engine.stale(chosen, size=size, time=now, steps=steps, interpolated=fills))
        except PlaygroundError:
            return True

    def _reads_anew(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with: the trial is to read them first."""
        return any(path not in self._own_files and self._is_new(path) for path in data_files(sketch))

    def _is_new(self, path: Path) -> bool:
        """Say whether a file holds other data than it was last drawn with; a newer date alone is none."""
        known, now = self._read.get(path), signature(path)
        if known is None or now is None or known[0] is None:
            return known is None or known[0] != now
        if known[0] != now:
            if _hash_of(path) != known[1]:
                return True
            self._read[path] = now, known[1]
        return False

    def _forget_view(self) -> None:
        self.map = self._next_view = None
        self._told_of_ground = False
        self.steps.clear()
        self.clock.rewind()

    def _draw_coming(self, size: tuple[int, int]) -> None:
        assert self.coming is not None
        if self._next_view is not None:
            (steps, self.map), self._next_view = self._next_view, None
            self.steps.update(steps)
        try:
            self._draw(self.coming.sketch, size)
            self.engine.ctx.finish()
            if self._is_lost():
                raise ContextError("this made the graphics driver reset itself, so it is not drawn again")
        except Exception as error:
            self.stage = Stage.FAILED
            self._file_error = explained(error, self.path)
            return
        self._note_read(self.coming.sketch)
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
        sketch = self.shown.sketch
        if self._awaits_data(sketch):
            return  # the last good picture stays
        self._drawn = self._wanted(size)
        try:
            if self.map is not None and not self.can_show(self.map.ref):
                self.notes.append(f"{self.map.ref} is gone, so the sketch's own view is shown")
                self.map = None
            self._draw(self.map.of(sketch) if self.map else sketch, size, in_full=in_full)
            self._draw_error = None
        except Exception as error:
            self._draw_error = explained(error, self.path)

    def _draw(self, sketch: Sketch, size: tuple[int, int], *, in_full: bool = False) -> None:
        """Draw; where the processor draws, hastily first: see ``workbench.preview``."""
        chosen = hastily(sketch) if self.engine.info.software and not in_full else sketch
        self.engine.runner.frame = self.draws
        seen = self._framed(chosen, size)
        steps, now = self._steps_for(sketch), self.clock.time
        texture = self.engine.draw(seen, size=size, time=now, steps=steps, interpolated=self.interpolated)
        if self.engine.eye_height.message and not self._told_of_ground:
            self._told_of_ground = True
            self.notes.append(self.engine.eye_height.message)
        if self._read_for is not sketch:
            self._note_read(sketch)
        self.hasty = chosen is not sketch
        self._drawn_at = self._now()
        self._picture.keep(texture)
        self.draws += 1
        self.times |= self.engine.times
        self.plan = self.engine.plan

    def _framed(self, sketch: Sketch, size: tuple[int, int]) -> Sketch:
        """Return a sketch as it is seen in a picture of that size, in pixels: see ``workbench.framing``."""
        if not is_seen_from_camera(sketch):
            return sketch
        return framed(sketch, self.clock.time, self.framed_for, size)

    def _awaits_data(self, sketch: Sketch) -> bool:
        """Say whether a file that a sketch reads is another by now, which the trial has not read yet."""
        return self._trial is not None and self._reads_anew(sketch)

    def _note_read(self, sketch: Sketch) -> None:
        """Remember the data that a sketch was drawn with."""
        self._read_for = sketch
        for path in data_files(sketch):
            now = signature(path)
            self._read[path] = now, _hash_of(path)

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


def _hash_of(path: Path) -> str:
    """Return a hash of a file's contents; empty where it cannot be read."""
    try:
        return content_hash(path)
    except (PlaygroundError, OSError):
        return ""
