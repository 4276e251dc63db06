"""A live session: the drafts of a sketch, what is drawn of it, its time, and the picture.

No window and no keys: ``frame(size)`` returns the texture to show.

    drafts   what the files say, and the user's edits
    view     a map instead of the sketch's own view, repeats stopped early
    clock    the sketch's own time
    data     the images and elevation files that were drawn with
"""

from __future__ import annotations

import time
from collections.abc import Callable, Collection, Mapping
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.engine import Engine
from playground.engine.exaggeration import exaggeration
from playground.engine.frame import Frame
from playground.engine.plain_forms import silent
from playground.engine.plan import Plan
from playground.engine.unfinished import SourceUnfinished
from playground.errors import ContextError, PlaygroundError
from playground.sketch.assign import find_targets, resolve
from playground.sketch.edit_passes import without_muted
from playground.sketch.find import find
from playground.sketch.map_sketch import Map, refs_of
from playground.sketch.model import Graph, Sketch, Value
from playground.sketch.traits import has_moving_counts, is_animated, traits_of
from playground.studio.clock import Clock
from playground.studio.edits.drafts import Drafts
from playground.studio.edits.edits import Draft, StoredEdits
from playground.studio.language import tr
from playground.studio.picture.gestures import turned_sun
from playground.studio.picture.shown_picture import CatchUp, ShownPicture
from playground.studio.picture.view import Kept, View, fitted, in_view, steps_of_repeats
from playground.studio.reload.dependencies import DataFiles
from playground.studio.reload.stages import Checks, Reload, ReloadStage, Sandbox

if TYPE_CHECKING:
    import moderngl
    import numpy as np
    from numpy.typing import NDArray

TURN = 12.0
"""[degrees a second] of the turntable."""

Version = tuple[int, int, int]
"""Changes whenever the numbers of a texture may have: its pass ran again, or another engine did."""


class Session:
    """One sketch, open."""

    def __init__(
        self,
        engine: Engine,
        path: str | Path = "",
        *,
        values: Mapping[str, Value] | None = None,
        start: StoredEdits | None = None,
        plain: bool = False,
        dialect: str = "",
        sandbox: Sandbox | None = None,
        now: Callable[[], float] = time.perf_counter,
        is_lost: Callable[[], bool] = lambda: False,
    ) -> None:
        self.engine = engine
        engine.plain_forms.notice = silent  # ``notes`` say it
        self.clock = Clock()
        self._clock_before = Clock()  # of the sketch that is shown, while another is opened
        self.view = View()
        self.data = DataFiles()
        checks = Checks(
            driver=engine.driver,
            variants=tuple(engine.plain_forms.kinds),
            sandbox=sandbox,
            now=now,
            sketch_time=lambda: self.clock.time,
        )
        start = (start or StoredEdits()).with_values(values or {})
        self.drafts = Drafts(path, checks, self, start=start, plain=plain, dialect=dialect)
        self.notes = self.drafts.notes
        self.plan: Plan | None = None  # of the last picture
        self.last_reload: Reload | None = None
        self.times: dict[str, float] = {}  # [ms] the last time each pass ran while profiling, by path
        self.draws = 0  # pictures drawn so far
        self.before_switch: Callable[[], None] = lambda: None  # called before another sketch is shown
        self._now = now
        self.catch_up = CatchUp(now)
        self._is_lost = is_lost  # says whether the engine's context is lost
        self._pressed: frozenset[str] = frozenset()  # buttons pressed since the last frame, by leaf
        self._lost_over: object = None  # what was shown when a context was lost last
        self.picture = ShownPicture(engine.ctx, now)
        self._repeats: tuple[Sketch | None, float, dict[str, int]] = (None, 0.0, {})
        self._drawn: tuple[object, ...] | None = None  # what the picture shows
        self._planned: Graph | None = None  # what was planned last while the sandbox tried it
        self._size: tuple[int, int] | None = None  # of the latest frame
        self._data_of: Sketch | None = None  # the sketch whose data files were noted last
        self._reported: set[str] = set()  # kinds of notes that are given once a sketch
        self.drafts.reload()

    # ── state ────────────────────────────────────────────────────────────────

    @property
    def shown(self) -> Draft | None:
        """The draft that is shown."""
        return self.drafts.shown

    @property
    def sketch(self) -> Sketch | None:
        """The sketch that is shown; None before the first good one."""
        return self.drafts.sketch

    @property
    def path(self) -> Path:
        """The sketch's file."""
        return self.drafts.path

    @property
    def error(self) -> PlaygroundError | None:
        """What is wrong just now."""
        return self.drafts.error

    @property
    def animated(self) -> bool:
        """Whether the picture changes with time."""
        return self.sketch is not None and is_animated(self.sketch)

    @property
    def orbits(self) -> bool:
        """Whether the camera moves anything in the picture."""
        if self.sketch is None or self.view.map is not None:
            return False
        return self.view.look is not None or traits_of(self.sketch).camera

    @property
    def refs(self) -> list[str]:
        """Every texture that a map can show."""
        if self.plan is None:
            return []
        private = self.view.map.private_refs if self.view.map is not None else ()
        return [ref for ref in refs_of(self.plan.flat) if ref not in private]

    @property
    def repeats(self) -> dict[str, int]:
        """How many steps every repeated kernel and loop of what is shown takes, by path."""
        if self.sketch is None:
            return {}
        time = self.clock.time if has_moving_counts(self.sketch) else 0.0
        if self._repeats[0] is not self.sketch or self._repeats[1] != time:
            self._repeats = self.sketch, time, steps_of_repeats(self.sketch, time)
        return self._repeats[2]

    @property
    def awaits_data(self) -> bool:
        """Whether a file that the sketch reads has changed, and the sandbox has not read it yet.

        Until then nothing may be drawn, nor passes run again.
        """
        return self.drafts.sandboxed and self.sketch is not None and self.reads_new_data(self.sketch)

    @property
    def is_preview(self) -> bool:
        """Whether the picture is a preview, and will be drawn again in full."""
        return self.picture.is_preview

    @property
    def is_idle(self) -> bool:
        """Whether there is a picture, and nothing is coming that may replace it."""
        coming = self.drafts.stage is not ReloadStage.NONE or self.catch_up.behind is not None
        return self.plan is not None and not (coming or self.is_preview or self.awaits_data)

    def can_show(self, ref: str) -> bool:
        """Say whether a map can show a texture: one of ``refs``, or one of the view itself."""
        return ref in self.refs or (self.sketch is not None and in_view(self.sketch, ref))

    def _has(self, shown: Map, sketch: Sketch) -> bool:
        """Return whether a sketch has the texture of a map."""
        has = shown.can_show(sketch)
        return self.can_show(shown.ref) if has is None else has

    # ── changes ──────────────────────────────────────────────────────────────

    def open(
        self, path: Path, *, start: StoredEdits | None = None, texts: Mapping[str, str] | None = None
    ) -> None:
        """Open another sketch; see ``Drafts.open``. Its own view is shown once it is drawn."""
        path = find(path)
        if not self.drafts.opening:
            self._clock_before = replace(self.clock)
        self.clock.rewind()
        self._reported.clear()
        self.drafts.open(path, start=start, texts=texts)
        self.view.restore({}, None, later=True)

    def open_copy(self, path: Path, saved: Draft | None = None) -> None:
        """Open a copy of the sketch that is shown; edits and view go on. Raises as ``Drafts.open``.

        ``saved`` is the same picture as the copy says it, where its paths are not those of the one shown.
        """
        self._take_back()
        if saved is not None:
            self.drafts.note_read(saved.edits)
            self.drafts.show(saved)
        self.drafts.open(path, keep=True)

    def stay(self) -> None:
        """Read the sketch that is shown again, and open no other."""
        self._take_back()
        self.drafts.stay()

    def _take_back(self) -> None:
        """Reset the view and the clock from those of a sketch that is not opened after all."""
        if self.drafts.opening:
            self.view.forget_next()
            self.clock.restore(self._clock_before)

    def reset_values(self) -> None:
        """Reset all that is not locked, and every pass, to what the file says; stop no repeat early."""
        self.view.steps.clear()
        self.drafts.reset_values()

    def redraw(self) -> None:
        """Draw again: a file that the sketch reads has changed."""
        self.view.revision += 1

    def point(self, mouse: tuple[float, float, float, float]) -> None:
        """Pass the mouse to plain shaders: pixels from the lower left, then where it was pressed."""
        runner = self.engine.runner
        if runner.mouse != mouse and self.sketch is not None and traits_of(self.sketch).mouse:
            runner.mouse = mouse
            self.redraw()

    def hover(self, position: tuple[float, float], *, pressed: bool, clicked: bool) -> None:
        """Pass the mouse to other tools' shaders, in pixels from the lower left; see ``Runner.drag``.

        ``clicked``: it was pressed in this very frame.
        """
        runner = self.engine.runner
        x, y, press_x, press_y = runner.drag
        if clicked:
            drag = (*position, *position)
        elif pressed:
            drag = (*position, abs(press_x), -abs(press_y))
        else:
            drag = (x, y, -abs(press_x), -abs(press_y))
        if (runner.hover, runner.drag) != (position, drag):
            runner.hover, runner.drag = position, drag
            if self.sketch is not None and traits_of(self.sketch).mouse:
                self.redraw()

    def press(self, path: str) -> None:
        """Press a button, by its path: the next frame alone sees it pressed."""
        if self.sketch is not None:
            self._pressed |= {target.path for target in resolve(self.sketch.graph, path)}

    def without_buttons(self, values: Mapping[str, Value]) -> dict[str, Value]:
        """Press the buttons that values by path set to true; return the values of all else."""
        graph = self.sketch.graph if self.sketch is not None else None
        others: dict[str, Value] = {}
        for path, value in values.items():
            targets = find_targets(graph, path) if graph is not None else ()
            if not targets or targets[0].parameter.widget.kind != "button":
                others[path] = value
            elif value:
                self.press(path)
        return others

    def _press(self) -> None:
        """Pass the buttons pressed since the last frame to the engine, and let go of those before."""
        runner = self.engine.runner
        if runner.pressed != self._pressed:
            runner.pressed = self._pressed
            self.redraw()
        self._pressed = frozenset()

    def hold_keys(self, codes: Collection[int]) -> None:
        """Begin a frame in which the picture's keys are down, by their codes in JavaScript."""
        inputs = self.engine.runner.inputs
        if inputs.keyboard.hold(codes) and self.sketch and traits_of(self.sketch).keys:
            self.redraw()

    @property
    def is_listening(self) -> bool:
        """Whether the picture may change by what a microphone or a camera delivers."""
        return self.sketch is not None and traits_of(self.sketch).devices

    def listen(self) -> None:
        """Begin a frame: take what microphones and cameras delivered."""
        if self.engine.runner.inputs.begin_frame() and self.is_listening:
            self.redraw()

    def advance(self, seconds: float, date: datetime) -> None:
        """Advance the clock by seconds of real time, unless it is paused; plain shaders get the date.

        While the picture is behind, it waits.
        """
        if self.catch_up.behind is None:
            self.clock.advance(seconds)
        midnight = date.replace(hour=0, minute=0, second=0, microsecond=0)
        runner = self.engine.runner
        runner.delta = seconds * self.clock.speed
        runner.date = (float(date.year), date.month - 1.0, float(date.day), (date - midnight).total_seconds())

    def show(self, ref: str | None) -> None:
        """Show a texture from above, its range fitted to its values; None: the sketch's own view."""
        self.view.last_ref = ref or self.view.last_ref
        self.view.show(Map(ref) if ref else None)
        self.fit_map()

    @property
    def exaggeration(self) -> float:
        """How many times higher than it is the terrain is shown and lit; no data depends on it."""
        given = self.engine.runner.exaggeration
        return given.factor if given is not None else 1.0

    def exaggerate(self, factor: float) -> None:
        """Show the terrain so many times higher than it is."""
        if factor != self.exaggeration:
            self.view.exaggeration = factor
            self._take_exaggeration()
            self.redraw()

    def _take_exaggeration(self) -> None:
        """Have the engine draw the terrain as high as the view has it."""
        self.engine.runner.exaggeration = exaggeration(self.view.exaggeration)
        self.view.exaggeration = self.exaggeration

    def move_suns(self, across: float, up: float) -> None:
        """Drag the suns of what is seen, those of the sketch or a look's own; see ``turned_sun``."""
        look = self.view.look if self.view.map is None else None
        if look is None:
            self.drafts.move_suns(across, up)
        elif (sun := look.sun()) is not None and isinstance(sun[1], tuple):
            azimuth, elevation = sun[1]
            self.view.show_as(look.with_sun(turned_sun((azimuth, elevation), across, up)))

    def turn_table(self, on: bool) -> None:
        """Have the camera go round the terrain, or stop it: it stays where it is then."""
        self.view.turning = on and self.orbits
        if self.view.turned and not on and self.sketch is not None:
            camera, turned = self.sketch.camera, self.view.turned
            self.drafts.set_camera(replace(camera, azimuth=round((camera.azimuth + turned) % 360, 2)))
            self.view.turned = 0.0

    def turn(self, seconds: float) -> None:
        """Go on with the turntable, where it is on."""
        if self.view.turning:
            self.view.turned = (self.view.turned + TURN * seconds) % 360.0

    def toggle_map(self) -> None:
        """Go between the sketch's own view and the map shown last, at first of the first texture."""
        if self.view.map is not None:
            self.show(None)
        elif refs := self.refs:
            self.show(self.view.last_ref if self.view.last_ref in refs else refs[0])

    def result_of(self, ref: str) -> tuple[moderngl.Texture, Version] | None:
        """Return the texture "pass:output" of the last picture, and its version; None where it had none."""
        plan, engine = self.plan, self.engine
        path, _, output = ref.partition(":")
        source = plan.flat.outputs.get(path, {}).get(output) if plan is not None else None
        result = engine.record.results.get(source.path) if source is not None else None
        if source is None or result is None or source.output not in result.textures:
            return None
        return result.textures[source.output], (id(engine), result.number, engine.runs[source.path])

    def restore_view(self, steps: Mapping[str, int], shown: Map | None, kept: Kept | None = None) -> None:
        """Stop repeats and show a map, as ``View.restore``; of a sketch being opened, once that is drawn."""
        self.view.restore(steps, shown, kept, later=self.drafts.opening)
        self._take_exaggeration()

    def stop_at(self, path: str, step: int) -> None:
        """Show a repeated pass after so many steps; after its last, it runs to its end again."""
        self.view.stop_at(path, step if 0 <= step < self.repeats.get(path, 0) else None)

    def fit_map(self) -> None:
        """Fit the map's channel and range to the texture's values; it stays while sources are at work."""
        shown = self.view.map
        if shown is not None and self.sketch is not None:
            values = self.read_values(shown.ref)
            if values is not None or not self.engine.runner.works.at_work:
                self.view.show(fitted(shown, shown.own_numbers(values)) if values is not None else None)

    def read_values(self, ref: str) -> NDArray[np.float32] | None:
        """Return a texture's values as the picture has them, row 0 south; None, and a note, if that fails.

        It fails as well while a source is at work on them: nothing is waited for.
        """
        if self.sketch is None or self.awaits_data:
            return None
        now, engine = self.clock.time, self.engine
        stops, fills = self.view.stops(self.sketch, now), self.view.interpolated
        engine.options.patience = float("inf")  # loops run to their end
        try:
            sketch = self.view.map.base_of(self.sketch) if self.view.map is not None else self.sketch
            sketch = without_muted(sketch, self.view.muted)
            return engine.read(sketch, ref, time=now, steps=stops, interpolated=fills)
        except (PlaygroundError, SourceUnfinished) as error:
            self.notes.append(str(error))
            return None
        finally:
            engine.options.patience = None

    # ── the picture ──────────────────────────────────────────────────────────

    def frame(self, size: tuple[int, int]) -> moderngl.Texture | None:
        """Return the picture, drawn again if anything changed; None before the first good one.

        ``size`` in pixels. The texture stays valid until the next call. Nothing is raised
        for a mistake in the sketch: it is in ``error``, and the last good picture stays.
        """
        drafts, self._size = self.drafts, size
        due = self.picture.is_due  # not one that this very frame draws: it is shown first
        self._press()
        if drafts.stage is ReloadStage.SANDBOX:
            drafts.take_report()
        if drafts.testing and drafts.coming is not None:
            self._plan_coming(drafts.coming.sketch, size)
        if drafts.stage is ReloadStage.DRAW:
            self._draw_coming(size)
        if drafts.shown is not None:
            key = self._picture_key(size)
            if key != self._drawn or self.catch_up.behind is not None:
                self._draw_shown(drafts.shown.sketch, key, size)
            elif due:
                self._draw_shown(drafts.shown.sketch, key, size, in_full=True, in_pieces=True)
        return self.picture.texture

    def read(self) -> Frame | None:
        """Read the picture back, in full; None before the first."""
        texture = self.picture.texture
        unfinished = self.is_preview or self.catch_up.behind is not None
        if unfinished and texture is not None and self.sketch is not None:
            self._draw_shown(self.sketch, self._picture_key(texture.size), texture.size, in_full=True)
        return self.picture.frame(self.sketch.name if self.sketch else "", self.clock.time)

    def release(self) -> None:
        """Release the picture; the engine belongs to its owner."""
        self.picture.release()

    def rebuild(self, engine: Engine) -> None:
        """Go on with another engine: the context of the one before is lost, and all that was in it.

        What is shown is drawn again, unless it lost two contexts in a row: then it waits until
        something is changed.
        """
        runner, before = engine.runner, self.engine.runner
        runner.mouse, runner.inputs = before.mouse, before.inputs
        runner.hover, runner.drag = before.hover, before.drag
        runner.exaggeration = before.exaggeration
        engine.plain_forms.notice = silent
        engine.painted.update(self.engine.painted)
        self.engine, self.plan, self._planned, self._drawn = engine, None, None, None
        self.picture = ShownPicture(engine.ctx, self._now)
        shown = self.shown, self.drafts.revision, self.view.revision
        if self._lost_over == shown and self._size is not None:
            self._drawn = self._picture_key(self._size)
            message = tr(
                "this made the graphics driver reset itself twice; it waits until something is changed"
            )
            self.drafts.report(ContextError(message))
        self._lost_over = shown
        self.notes.append(tr("the graphics driver was reset; everything was built again"))

    def needs_drawing(self, sketch: Sketch) -> bool:
        """Say whether the driver would get anything that it has not drawn already.

        Another comment, label, range, preset or shot gives it nothing, and needs no sandbox.
        Other values do: they say how often a loop runs.
        """
        if self.shown is None or self.picture.texture is None or self.drafts.opening:
            return True
        if self.reads_new_data(sketch):
            return True
        try:
            return self.picture.differs(self.engine, sketch, self.view, self.clock.time)
        except PlaygroundError:
            return True

    def reads_new_data(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with."""
        return self.data.are_new(sketch)

    def _picture_key(self, size: tuple[int, int]) -> tuple[object, ...]:
        sketch = self.drafts.sketch
        time = self.clock.time if sketch is not None and is_animated(sketch) else 0.0
        view = self.view.revision, self.view.framed_for, self.view.turned
        return self.drafts.revision, *view, size, time

    def _plan_coming(self, coming: Sketch, size: tuple[int, int]) -> None:
        """Plan a text that the sandbox tries, unless it reads new data: to plan that looks into the file."""
        if coming.graph is not self._planned and not self.reads_new_data(coming):
            self.picture.prepare(self.engine, coming, self.view, size, self.clock.time)
        self._planned = coming.graph

    def _draw_coming(self, size: tuple[int, int]) -> None:
        drafts = self.drafts
        assert drafts.coming is not None
        sketch = drafts.coming.sketch
        self._data_of = None  # the same sketch may read new data
        try:
            self._draw(sketch, size, coming=True)
            self.engine.ctx.finish()
            if self._is_lost():
                raise ContextError("this made the graphics driver reset itself, so it is not drawn again")
        except Exception as error:
            drafts.failed(error)
            return
        if drafts.opening:
            self.before_switch()
        exaggeration_before = self.exaggeration
        if self.view.take_next():
            self._take_exaggeration()
        self.last_reload = Reload(self._now() - drafts.started, drafts.sandbox_seconds)
        drafts.drawn_well()
        is_other = bool(self.view.map is not None or self.view.look is not None or self.view.muted)
        is_other |= self.exaggeration != exaggeration_before
        self._drawn = None if is_other else self._picture_key(size)

    def _draw_shown(
        self, sketch: Sketch, key: tuple[object, ...], size: tuple[int, int], **how: bool
    ) -> None:
        """Draw the sketch that is shown; ``how``: as ``_draw`` takes it."""
        if self.drafts.sandboxed and self.reads_new_data(sketch):
            return  # the last good picture stays
        time_alone = self._drawn is not None and key[:-1] == self._drawn[:-1]
        self._drawn, shown = key, self.view.map
        try:
            if shown is not None and not self._has(shown, sketch):
                self.notes.append(tr("{ref} is gone, so the sketch's own view is shown", ref=shown.ref))
                self.view.map = shown = None
            if shown is None and self.view.look is not None and not self.view.look.fits(sketch):
                self.view.look = None  # its heights are gone
            sketch = without_muted(sketch, self.view.muted)
            seen = shown or self.view.look
            self._draw(seen.of(sketch) if seen else sketch, size, **how)
            self.drafts.draw_error = None
            if time_alone and self.picture.is_slow:
                self._pause_once()
        except Exception as error:
            self.drafts.report(error)

    def _draw(self, sketch: Sketch, size: tuple[int, int], **how: bool) -> None:
        """Draw a sketch; ``how``: ``in_full``, ``in_pieces``, ``coming``: see ``ShownPicture.draw``."""
        engine, traits, opening = self.engine, traits_of(sketch), self.drafts.opening
        if opening:
            self.picture.forget()
        drawn = self.picture.draw(
            engine, sketch, self.view, self.catch_up, size=size, time=self.clock.time, **how
        )
        if engine.options.profiling:
            self.times |= engine.record.times
        if traits.files and self._data_of is not sketch:
            self.data.take(sketch)
            self._data_of = sketch
        if not drawn:
            return
        self.draws += 1
        self.plan = engine.record.plan
        if opening:
            engine.cache.turn_over()
        if engine.eye_height.message:
            self._note_once("ground", engine.eye_height.message)

    def _pause_once(self) -> None:
        """Let time stand still, the first time that a sketch is too slow for it: so it is drawn in full."""
        if self.clock.playing and "slow" not in self._reported:
            self.clock.playing = False
            self._note_once(
                "slow", tr("time is paused, so that the picture is drawn in full; Space plays it")
            )

    def _note_once(self, kind: str, message: str) -> None:
        """Add a note, unless one of its kind was given of this sketch."""
        if message and kind not in self._reported:
            self._reported.add(kind)
            self.notes.append(message)
