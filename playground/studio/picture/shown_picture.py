"""Draw the picture that a session shows: a preview while something changes, and in full when it rests.

On a software renderer what changes is drawn with one sample a pixel and a coarser mesh (see
``preview``), and with as few pixels as it takes to follow the hand (see ``PreviewSize``), enlarged to
the size of the picture. What is read from it, saved or compared at rest is drawn in full. At rest that goes
on in pieces, so that the window answers meanwhile; until the last pass has run the preview stays.

A loop that follows the time runs in pieces as well: after a jump in time, or where a frame takes longer than
its 1/60 s, each picture runs for a short time and shows how far that came, and the sketch's clock waits until
it is there. It waits likewise while a source is at work: then the last picture stays.
"""

from __future__ import annotations

import time
import time as clock
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.engine.plan import Plan
from playground.engine.runner import Runner
from playground.engine.unfinished import PassesUnfinished, SourceUnfinished, Unfinished
from playground.sketch.model import Sketch, kernels_of
from playground.sketch.traits import traits_of
from playground.sketch.variants import canonical_path
from playground.studio.picture.full_screen import Painter, Picture
from playground.studio.picture.preview import SLOW, PreviewSize, Size, as_preview, divided
from playground.studio.picture.view import View, framed

if TYPE_CHECKING:
    import moderngl

LOOP_PIECE = 0.1
"""[s] that loops may run for one picture."""
_TRIES = 4  # at earlier times: of several loops, each may have come less far


class CatchUp:
    """How far the picture is behind the clock."""

    def __init__(self, now: Callable[[], float] = time.perf_counter) -> None:
        self.behind: tuple[int, int] | None = None  # iterations that have run, and those that are wanted
        self.source = ""  # the path of the source that is at work, whose parts those are then
        self._now = now
        self._since = 0.0

    @property
    def seconds(self) -> float:
        """How long it has been behind [s]."""
        return self._now() - self._since if self.behind else 0.0

    def draw(
        self, engine: Engine, seconds: float, draw: Callable[[float], moderngl.Texture], *, in_full: bool
    ) -> moderngl.Texture | None:
        """Return the picture at a time [s], or ``in_full`` unset at an earlier one that was reached.

        ``draw`` draws the picture of a time; None is returned where the loops need more time for any, and
        while a source is at work.
        """
        before = self.behind
        self.behind, self.source, at = None, "", seconds
        engine.options.patience = None if in_full else LOOP_PIECE
        try:
            for _ in range(1 + _TRIES):
                try:
                    return draw(at)
                except SourceUnfinished as stopped:
                    self.behind, self.source = (stopped.done, stopped.total), stopped.path
                    self._since = self._since if before else self._now()
                    return None
                except Unfinished as stopped:
                    at *= stopped.done / stopped.total
                    if self.behind is None:
                        self.behind = stopped.done, stopped.total
                        self._since = self._since if before else self._now()
            return None
        finally:
            engine.options.patience = None


REST = 0.2  # [s] without a change after which a preview is drawn again in full
PIECE = 0.15
"""[s] that passes of a full picture run before the window answers."""
STEADY = 40
"""Pieces of that length; then each is twice as long as the last, so that one ends which no cache holds."""


class ShownPicture:
    """The last good picture of one session, in one context."""

    def __init__(self, ctx: moderngl.Context, now: Callable[[], float] = clock.perf_counter) -> None:
        self.is_preview = False  # it will be drawn again in full
        self.needs_all_pixels = False  # somebody reads pixels while it moves
        self.rest = REST  # [s] after which a preview is due
        self._now = now
        self._painter = Painter(ctx)
        self._picture = Picture(self._painter)
        self._sizes = PreviewSize()
        self._drawn_size: Size = (0, 0)  # before it was enlarged
        self._pieces = 0  # of a full picture that have run, and not the last one
        self._faster: frozenset[str] = frozenset()  # passes that have run in a preview since it was in full
        self._drawn_at = 0.0

    @property
    def texture(self) -> moderngl.Texture | None:
        """The picture, enlarged if need be; None before the first."""
        return self._picture.texture

    @property
    def is_due(self) -> bool:
        """Whether it is a preview that has rested, so that it is to be drawn in full."""
        return self.is_preview and self._now() - self._drawn_at >= self.rest

    @property
    def is_slow(self) -> bool:
        """Whether it has fewer pixels because all of them are known to take far too long."""
        texture = self._picture.texture
        return texture is not None and texture.size != self._drawn_size and self._sizes.whole > SLOW

    @property
    def drawn_size(self) -> Size:
        """The pixels that were drawn; fewer than those of ``texture`` in a preview."""
        return self._drawn_size

    @property
    def faster(self) -> frozenset[str]:
        """Paths of the passes whose menus have the choices of previews, and of others: see ``as_preview``."""
        return self._faster

    def frame(self, sketch: str, time: float) -> Frame | None:
        """Read the picture back, as what can be saved; None before the first."""
        return self._picture.frame(sketch, time)

    def forget(self) -> None:
        """Forget what passes took: another sketch is opened."""
        self._sizes.forget()

    def release(self) -> None:
        """Release the picture."""
        self._picture.release()
        self._painter.release()

    def draw(
        self,
        engine: Engine,
        sketch: Sketch,
        view: View,
        catch_up: CatchUp,
        *,
        size: Size,
        time: float,
        in_full: bool = False,
        coming: bool = False,
        in_pieces: bool = False,
    ) -> bool:
        """Draw a sketch, on a software renderer as a preview unless ``in_full``; return whether that is done.

        ``coming``: it is opened or read again, and the view is the one that it will have. ``in_pieces``:
        only a piece of its passes runs, and the next call goes on.
        Raises as ``Engine.draw``.
        """
        previews = engine.info.software and not in_full
        sized = previews and not self.needs_all_pixels and view.map is None
        moves = previews and engine.info.compute and self.texture is not None and not coming
        pixels, faster = size, self._faster if moves else frozenset()
        if sized or (moves and traits_of(sketch).faster):
            at = _at(view, sketch, time, coming=coming)
            # What a new text runs is asked below, of the preview alone: a plan less.
            is_new = coming and _has_new_text(engine.record.plan, sketch)
            changed = None if is_new else self._changed(engine, sketch, view, size, at)
            faster |= {canonical_path(path) for path in changed or () if moves}
        chosen = as_preview(sketch, faster=faster) if previews else sketch
        if sized:
            if changed != [] or self.texture is None or self.texture.size != size:
                pixels = self._sizes.choose(engine, _framed(chosen, view, time, size), size, changed, **at)
            else:
                pixels = self._drawn_size
            chosen = as_preview(sketch, size, pixels, faster)

        def drawn_at(time: float) -> moderngl.Texture:
            at = _at(view, sketch, time, coming=coming)
            return engine.draw(_framed(chosen, view, time, size), size=pixels, **at)

        end = self._now() + PIECE * 2 ** max(self._pieces - STEADY, 0)
        engine.options.piece = (lambda: self._now() > end) if in_pieces else None
        try:
            with _timed(engine), pointed_at(engine.runner, size, pixels):
                texture = catch_up.draw(engine, time, drawn_at, in_full=in_full)
        except PassesUnfinished:
            self._pieces, self.rest = self._pieces + 1, 0.0  # it goes on at once
            return False
        finally:
            engine.options.piece = None
        self._pieces = 0
        if engine.info.software and engine.record.plan is not None:
            self._sizes.take(
                engine.record.plan,
                engine.record.times,
                in_full=in_full and as_preview(sketch) is not sketch,
            )
        if texture is None:
            return False
        with engine.borrowed():
            self._picture.copy(texture, size)
        self.is_preview, self._faster = chosen is not sketch or pixels != size, faster
        # Nobody waits for what was drawn small because its cost was not known.
        self.rest = 0.0 if pixels != size and self._sizes.guessed else REST
        self._drawn_size, self._drawn_at = pixels, self._now()
        return True

    def prepare(self, engine: Engine, sketch: Sketch, view: View, size: Size, time: float) -> None:
        """Plan the preview of a sketch that is coming, while nothing may be drawn of it.

        ``draw`` goes on from these plans, and raises what is wrong with them.
        """
        if not engine.info.software or view.map is not None:
            return
        with suppress(Exception):
            preview, at = _framed(as_preview(sketch), view, time, size), _at(view, sketch, time, coming=True)
            for divisor in sorted({1, 2, self._sizes.divisor}):
                engine.stale(preview, size=divided(size, divisor), **at)

    def differs(self, engine: Engine, sketch: Sketch, view: View, time: float) -> bool:
        """Return whether a sketch would run a pass if it were drawn as this was; raise as ``Engine.draw``."""
        assert self.texture is not None
        return bool(self._changed(engine, sketch, view, self.texture.size, _at(view, sketch, time)))

    def _changed(
        self, engine: Engine, sketch: Sketch, view: View, size: Size, at: Mapping[str, Any]
    ) -> list[str]:
        """Return the passes that would run if a sketch were drawn as the last picture was, by path."""
        pixels = self._drawn_size if self.texture is not None and self.texture.size == size else size
        chosen = as_preview(sketch, size, pixels, self._faster) if self.is_preview else sketch
        with pointed_at(engine.runner, size, pixels):
            return engine.stale(_framed(chosen, view, at["time"], size), size=pixels, **at)


def _at(view: View, sketch: Sketch, time: float, *, coming: bool = False) -> dict[str, Any]:
    """Return the time, and where repeats stop, as ``Engine.draw`` takes them."""
    stops = view.stops(sketch, time, coming=coming)
    return {"time": time, "steps": stops, "interpolated": view.interpolated}


def _has_new_text(plan: Plan | None, sketch: Sketch) -> bool:
    """Return whether a kernel of a sketch has another text than it had in a plan; a comment is none."""
    kernels = dict(kernels_of(plan.sketch.graph)) if plan is not None else {}
    for path, kernel in kernels_of(sketch.graph):
        before = kernels.get(path, kernel)
        if before is not kernel and before.source.canonical != kernel.source.canonical:
            return True
    return False


def _framed(sketch: Sketch, view: View, time: float, size: Size) -> Sketch:
    """Return a sketch at a time as it is shown in a picture of a size."""
    if not traits_of(sketch).camera:
        return sketch
    if view.turned or view.exaggeration != 1.0:
        now = sketch.at(time)
        sketch = now.with_camera(view.seen(now.camera))
    return framed(sketch, time, view.framed_for, size)


@contextmanager
def _timed(engine: Engine) -> Iterator[None]:
    """Have passes timed on a software renderer, where that costs next to nothing."""
    before = engine.options.profiling
    engine.options.profiling = before or engine.info.software
    try:
        yield
    finally:
        engine.options.profiling = before


@contextmanager
def pointed_at(runner: Runner, size: Size, drawn: Size) -> Iterator[None]:
    """Move the mouse, given over a picture of a size, to the same place of the one that is drawn."""
    before = runner.mouse, runner.hover, runner.drag
    if drawn != size:
        x, y = drawn[0] / size[0], drawn[1] / size[1]
        (a, b, c, d), (e, f), (g, h, i, j) = before
        runner.mouse, runner.hover = (a * x, b * y, c * x, d * y), (e * x, f * y)
        runner.drag = g * x, h * y, i * x, j * y
    try:
        yield
    finally:
        runner.mouse, runner.hover, runner.drag = before
