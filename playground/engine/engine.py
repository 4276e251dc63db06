"""What a program calls: pictures and textures of sketches, drawn on one OpenGL context.

``renderer`` does the work: it keeps what was computed, and computes again what is stale.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.engine.context import ContextInfo, open_context, release_context
from playground.engine.frame import Frame, reduced
from playground.engine.non_finite import NotFinite
from playground.engine.plain_forms import warn
from playground.engine.plan import checked_seconds, drawn_size, most_iterations
from playground.engine.planner import repeated_in
from playground.engine.renderer import CACHE_BYTES, Renderer
from playground.engine.textures import read_picture, read_texture
from playground.engine.trace.model import MAX_EVENTS, Trace
from playground.errors import SketchError
from playground.sketch.load import opened
from playground.sketch.model import DEFAULT_PICTURE, MAX_PICTURE_SIDE, Sketch

if TYPE_CHECKING:
    import moderngl


class Engine(Renderer):
    """Draws sketches on one context, and keeps their textures between frames.

    ``playground.headless()`` opens one with a context of its own. Here the context ``ctx`` is the
    caller's, unless ``owns_context``: then ``release`` releases it too. ``driver`` is "fragment",
    "compute", or "auto": compute for what gains by it (visits) where there is compute, fragment for the
    rest. Fast variants that need compute run unless it is "fragment". ``cache_bytes`` limits the GPU
    memory of cached textures, in bytes. ``notice`` is called, once each, with why a fast variant does
    not run.

    It draws any number of sketches. It belongs to the thread that opened it: a call from another
    raises ``ContextError``; open an engine in each thread. An engine that is dropped without
    ``release`` destroys its own context, and leaks its objects in the caller's, with a
    ``ResourceWarning``. What it has besides (see ``Renderer``) is for the playground's own tools, and changes
    without notice.

        sketch = playground.load("l_dot_n")
        with playground.headless() as engine:
            frame = engine.render(sketch, size=(64, 36))
            evening = engine.render(sketch.with_values({"product.sun": (250.0, 12.0)}), size=(64, 36))

    Raises ``ContextError`` for an unknown driver, and for "compute" on a context without it.
    """

    @property
    def ctx(self) -> moderngl.Context:
        """Return the OpenGL context, for own calls of moderngl.

        For example:

            with playground.headless() as engine:
                print(engine.ctx.version_code)
        """
        return self._ctx

    @property
    def info(self) -> ContextInfo:
        """Return what the context is: ``renderer``, ``opengl``, ``compute``, ``software``.

        For example:

            with playground.headless() as engine:
                print(engine.info.renderer, engine.info.opengl)
        """
        return self._info

    @property
    def driver(self) -> str:
        """Return what runs kernels: "auto", "fragment" or "compute".

        For example:

            with playground.headless(driver="fragment") as engine:
                assert engine.driver == "fragment"
        """
        return self._driver

    def __enter__(self) -> Engine:
        self._context.check()
        return self

    def __exit__(self, *_: object) -> None:
        self.release()

    def release(self) -> None:
        """Release every texture and program, and the context if it is the engine's own.

        A second call does nothing. Once its own context is gone, nothing more can be drawn.

            engine = playground.headless()
            engine.release()

        Raises ``ContextError`` in another thread than its own.
        """
        super().release()

    def render(
        self,
        sketch: Sketch | str | Path,
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        interpolated: bool = True,
    ) -> Frame:
        """Return the picture of a sketch, or of that of a name or path.

        ``size`` in pixels, ``time`` in seconds; ``steps`` stops repeated passes after so
        many iterations, by path. What a stopped pass has not computed yet is interpolated where its
        header says how (see ``between``); without ``interpolated`` it is shown as it is, 0.

            with playground.headless() as engine:
                frame = engine.render("l_dot_n", size=(64, 36))
                assert frame.array.shape == (36, 64, 4)

        Raises ``PlaygroundError`` for any mistake in the sketch.
        """
        opened_sketch = opened(sketch)
        size = drawn_size(opened_sketch, size)
        texture = self.draw(opened_sketch, size=size, time=time, steps=steps, interpolated=interpolated)
        pixels = reduced(read_picture(texture), opened_sketch.picture.supersample)
        return Frame(pixels, opened_sketch.name, time)

    def draw(
        self,
        sketch: Sketch | str | Path,
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        interpolated: bool = True,
    ) -> moderngl.Texture:
        """Draw the sketch's picture, as ``render``, and return its texture on the GPU.

        It lives until the next frame, and has ``size`` pixels whatever the sketch's supersampling. Its
        colours are as ``moderngl`` reads them, row 0 at the bottom.

            with playground.headless() as engine:
                texture = engine.draw("l_dot_n", size=(64, 36))
                assert texture.size == (64, 36)

        Raises ``PlaygroundError`` for any mistake in the sketch.
        """
        plan_of = partial(self.plan, size=size, time=time, steps=steps, interpolated=interpolated)
        return self.draw_above_terrain(opened(sketch), plan_of)

    def texture(
        self,
        sketch: Sketch | str | Path,
        ref: str,
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        interpolated: bool = False,
    ) -> moderngl.Texture:
        """Return the texture of ``pass[.inner…][:output]`` on the GPU; it lives until the next frame.

        Runs only what it needs. What a stopped pass has not computed is 0, unless ``interpolated``.
        ``size``, ``time`` and ``steps`` as in ``render``.

            with playground.headless() as engine:
                texture = engine.texture("l_dot_n", "height")
                print(texture.size, texture.components, texture.dtype)

        Raises ``PlaygroundError`` for any mistake in the sketch, and with the nearest name for a wrong
        ``ref``.
        """
        plan = self.plan(sketch, size, time, steps, ref, interpolated=interpolated)
        return self.texture_of(plan, plan.flat.ref(ref, plan.sketch.name))

    def read(
        self,
        sketch: Sketch | str | Path,
        ref: str,
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        interpolated: bool = False,
    ) -> NDArray[np.float32]:
        """Return the values of a texture, ``ref`` being ``pass[.inner…][:output]``.

        float32, (ny, nx) or (ny, nx, components), row 0 in the south; heights are 0..1
        (``metres`` gives metres), colours and light linear. What a stopped pass has not
        computed is 0, unless ``interpolated``. The other arguments are those of ``texture``.

            with playground.headless() as engine:
                height = engine.read("l_dot_n", "height")
                print(height.shape, height.dtype, height.max())

        Raises as ``texture``.
        """
        texture = self.texture(sketch, ref, size=size, time=time, steps=steps, interpolated=interpolated)
        return read_texture(texture)

    def metres(
        self,
        sketch: Sketch | str | Path,
        ref: str = "height",
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
        interpolated: bool = False,
    ) -> NDArray[np.float32]:
        """Return heights in metres above sea level: those of ``read`` times the relief, plus the base.

        float32, (ny, nx), row 0 in the south; ``ref`` and the other arguments as in ``texture``. It is
        meant for heights, 0..1; any texture with one number a texel is taken.

            with playground.headless() as engine:
                metres = engine.metres("jacksboro", "height")
                print(f"{metres.min():.0f} to {metres.max():.0f} m")

        Raises as ``texture``, and ``SketchError`` for a texture with several numbers a texel.
        """
        plan = self.plan(sketch, size, time, steps, ref, interpolated=interpolated)
        texture = self.texture_of(plan, plan.flat.ref(ref, plan.sketch.name))
        values = read_texture(texture)
        if values.ndim != 2:
            raise SketchError(f"texture '{ref}' has {values.shape[2]} channels; heights have one")
        return plan.terrain.metres(values)

    def steps(
        self,
        sketch: Sketch | str | Path,
        path: str,
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
    ) -> Iterator[tuple[int, NDArray[np.float32]]]:
        """Yield (iterations done, values) of a repeated pass, from before its first to after its last.

        ``path`` may be a technique's in which one pass repeats: it is that one. Values, ``size`` and
        ``time`` as in ``read``.

            small = playground.load("diamond_square").with_values({"size": 5})
            with playground.headless() as engine:
                for step, values in engine.steps(small, "height"):
                    print(step, values.std())

        Raises as ``texture``, and ``SketchError`` with those that repeat for a pass that does not.
        """
        opened_sketch = opened(sketch)
        repeated = repeated_in(opened_sketch, path)
        # No fast variant replaces a pass that is stopped.
        plan = self.plan(opened_sketch, size, time, {repeated: 0})
        whole = most_iterations(plan.nodes)[repeated]
        for done in range(whole + 1):
            yield done, self.read(opened_sketch, repeated, size=size, time=time, steps={repeated: done})

    def trace(
        self,
        sketch: Sketch | str | Path,
        path: str,
        *,
        texel: tuple[int, int],
        iteration: int | Sequence[int] | None = None,
        function: str | None = None,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        values: Mapping[str, object] | None = None,
        limit: int = MAX_EVENTS,
    ) -> Trace:
        """Return every value of one texel's run of a pass: by call, line and iteration.

        ``path`` is ``pass[.inner…]``, its canonical form; ``texel`` is (column, row) from the south-west.
        ``iteration`` is one of a pass that repeats or of the innermost loop around it, from 0, or a number
        for each of them, the outermost first; without it the last. ``function``: None for those of the
        kernel's own file, "all" for those that it includes as well (a large text takes seconds to compile),
        or the name of one. ``values`` of parameters, by path; ``size`` and ``time`` as in ``render``. At most
        ``limit`` values are recorded, see ``Trace.is_complete``.

        It is drawn by the fragment driver, on OpenGL 3.3, and compared with the texel itself, see
        ``Trace.is_exact``: a driver may round a recorded sum otherwise. What is drawn later stays the same.

            with playground.headless() as engine:
                trace = engine.trace("l_dot_n", "product", texel=(10, 20))
                for event in trace.events:
                    print(event.line, event.name, event.value)

        Raises ``ParameterError`` for a texel or an iteration outside, with what there is, and for a function
        that the kernel does not have; ``SketchError`` for a pass that is none, or has no fragment shader;
        ``ShaderError`` for a text that cannot be traced.
        """
        opened_sketch = opened(sketch).with_values(values or {})
        plan = self.tracer.plan(opened_sketch, path, drawn_size(opened_sketch, size), checked_seconds(time))
        return self.tracer.trace(plan, path, texel, iteration, function, limit)

    def trace_frame(
        self,
        path: str,
        *,
        texel: tuple[int, int],
        iteration: int | Sequence[int] | None = None,
        function: str | None = None,
        limit: int = MAX_EVENTS,
    ) -> Trace:
        """Return a trace of a pass of the last frame as it was drawn.

        ``path``, ``texel``, ``iteration``, ``function`` and ``limit`` are those of ``trace``.

            with playground.headless() as engine:
                engine.render("l_dot_n", size=(64, 36))
                print(engine.trace_frame("product", texel=(10, 20)).texel_values)

        Raises as ``trace``, and ``SketchError`` before the first frame.
        """
        last = self.record.plan
        if last is None:
            raise SketchError("nothing was drawn whose passes could be traced; draw a frame first")
        plan = self.tracer.plan(last.sketch, path, last.frame_size, last.time, last.steps)
        return self.tracer.trace(plan, path, texel, iteration, function, limit)

    def not_finite(self) -> NotFinite | None:
        """Return the first number that is not finite among what the last frame was made from, if any.

        Ask before the next frame is drawn. What it costs, and what it leaves out: see
        ``engine.non_finite``.

            with playground.headless() as engine:
                engine.render("l_dot_n", size=(64, 36))
                assert engine.not_finite() is None

        Raises ``ContextError`` once the engine was released.
        """
        self._context.check()
        return self._finite_check.first()

    def fingerprint(
        self,
        sketch: Sketch | str | Path,
        *,
        size: tuple[int, int] = DEFAULT_PICTURE,
        time: float = 0.0,
        steps: Mapping[str, int] | None = None,
    ) -> str:
        """Return a hash of all that a picture depends on, the renderer included, without drawing it.

        32 hexadecimal digits; the arguments as in ``render``. What an array or a file holds counts, not
        what it is called.

            with playground.headless() as engine:
                assert engine.fingerprint("l_dot_n") == engine.fingerprint("l_dot_n")

        Raises ``PlaygroundError`` for any mistake in the sketch.
        """
        opened_sketch = opened(sketch)
        size = drawn_size(opened_sketch, size, MAX_PICTURE_SIDE)
        plan = self.plan(opened_sketch, size, time, steps, largest=MAX_PICTURE_SIDE)
        made = f"{self.picture_hash(plan)} {self._info.renderer} {self._info.opengl}"
        return blake2b(made.encode(), digest_size=16).hexdigest()

    def forget_unused(self) -> None:
        """Drop what is cached but not used for the last frame; without it, a film caches all its frames.

        For example:

            with playground.headless() as engine:
                for azimuth in (120.0, 180.0, 240.0):
                    sketch = playground.load("l_dot_n").with_values({"product.sun": (azimuth, 20.0)})
                    engine.render(sketch, size=(64, 36))
                    engine.forget_unused()

        Raises ``ContextError`` in another thread than its own.
        """
        self._context.check()
        self.cache.drop_unused()


def open_engine(
    *,
    software: bool = False,
    device: int | None = None,
    driver: str = "auto",
    cache_bytes: int = CACHE_BYTES,
    notice: Callable[[str], None] = warn,
) -> Engine:
    """Open an engine on a context of its own, which ``release`` destroys.

    ``software`` and ``device`` are those of ``open_context``, the rest those of ``Engine``. Raises
    ``ContextError`` as both do; no context stays open then.
    """
    context = open_context(software=software, device=device)
    try:
        return Engine(context, driver=driver, cache_bytes=cache_bytes, owns_context=True, notice=notice)
    except BaseException:
        release_context(context)
        raise
