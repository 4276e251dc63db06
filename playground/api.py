"""The few functions that most programs need: a headless engine, a picture, a sketch's parameters."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from playground.engine.engine import Engine, open_engine
from playground.engine.frame import Frame
from playground.engine.plain_forms import warn
from playground.engine.renderer import CACHE_BYTES
from playground.engine.trace.model import MAX_EVENTS, Trace
from playground.errors import Diagnostic, PlaygroundWarning
from playground.sketch.assign import shown_parameters, value_of, values_of
from playground.sketch.load import opened
from playground.sketch.model import DEFAULT_PICTURE, Parameter, Sketch, Value


def headless(
    *,
    software: bool = False,
    device: int | None = None,
    driver: str = "auto",
    cache_bytes: int = CACHE_BYTES,
    notice: Callable[[str], None] = warn,
) -> Engine:
    """Open an engine on a context without a window; use it with ``with``, or call its ``release()``.

    ``software`` asks for the software renderer, ``device`` for an EGL device by number,
    ``driver`` is "auto", "fragment" or "compute". ``cache_bytes`` limits the GPU memory of
    cached textures, in bytes. What can be drawn although something is wrong
    raises Python's warning ``PlaygroundWarning``, once. ``notice`` receives the reason why a fast
    variant does not run: by default as a ``PlainFormWarning``; with a function of your own, the
    other warnings are left out as well. An engine belongs to the thread that opens it.

        with playground.headless(software=True) as engine:
            engine.render("l_dot_n", size=(64, 36))

    Raises ``ContextError`` where there is no OpenGL, for another driver, and for one that it lacks.
    """
    engine = open_engine(
        software=software, device=device, driver=driver, cache_bytes=cache_bytes, notice=notice
    )
    if notice is warn:
        engine.warnings.report = _warn
    return engine


def _warn(warning: Diagnostic) -> None:
    warnings.warn(str(warning), PlaygroundWarning, stacklevel=2)


def render(
    sketch: Sketch | str | Path = "",
    *,
    size: tuple[int, int] = DEFAULT_PICTURE,
    time: float = 0.0,
    values: Mapping[str, object] | None = None,
    plain: bool = False,
) -> Frame:
    """Render one frame with a context of its own.

    ``sketch`` is a loaded one or what ``load`` takes; ``size`` in pixels, ``time`` in seconds,
    ``values`` of parameters by path; ``plain`` runs every technique in its canonical form, no
    fast variant. For more than one frame, keep an engine from ``headless()``.

        frame = playground.render("l_dot_n", size=(64, 36), values={"product.sun": (120.0, 20.0)})

    Raises ``PlaygroundError`` for any mistake in the sketch or its values.
    """
    opened_sketch = opened(sketch)
    with headless() as engine:
        engine.options.keeps = False
        return engine.render(opened_sketch.plainly(plain).with_values(values or {}), size=size, time=time)


def trace(
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
    """Return every value of one texel's run of a pass, with a context of its own; see ``Engine.trace``.

    ``sketch`` is a loaded one or what ``load`` takes, ``path`` a pass of it, ``texel`` (column, row) from the
    south-west. ``iteration`` is one of a pass that repeats or of a loop around it, without it the last;
    ``function`` None for those of the kernel's own file, "all" or the name of one. ``size`` of the picture in
    pixels, ``time`` in seconds, ``values`` of parameters by path; at most ``limit`` values are recorded.

        trace = playground.trace("l_dot_n", "product", texel=(10, 20))
        print(trace.calls_of("kernel")[0]["slope"])

    Raises ``PlaygroundError`` for a pass, texel, iteration or function that there is not.
    """
    with headless() as engine:
        return engine.trace(
            sketch,
            path,
            texel=texel,
            iteration=iteration,
            function=function,
            size=size,
            time=time,
            values=values,
            limit=limit,
        )


def parameters(sketch: Sketch) -> dict[str, tuple[Parameter, Value]]:
    """Return every parameter of a ``sketch`` with its value, by path.

    For example:

        for path, (parameter, value) in playground.parameters(playground.load("l_dot_n")).items():
            print(path, parameter.type, parameter.unit, value)
    """
    leaves = values_of(sketch)
    return {
        shown.path: (shown.parameter, value_of(sketch, shown.path, leaves))
        for shown in shown_parameters(sketch)
    }
