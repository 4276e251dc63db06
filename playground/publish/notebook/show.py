"""What a notebook calls: a sketch as an interactive picture, and two to be compared."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import DataError
from playground.extras import needs
from playground.shader.parameter import spell
from playground.sketch.load import opened
from playground.sketch.model import Sketch

if TYPE_CHECKING:
    from playground.publish.notebook.widget import CompareWidget, SketchWidget

_MAX_VALUES = 2  # values that name a picture


def widget(
    sketch: Sketch | str | Path = "",
    *,
    size: tuple[int, int] = (640, 360),
    sliders: Sequence[str] | None = None,
    draws: str = "auto",
    time: float = 0.0,
    language: str = "en",
) -> SketchWidget:
    """Return an interactive picture for a notebook: sliders, orbit, playing time.

    ``sketch`` is a loaded one or what ``load`` takes; ``size`` in pixels; ``sliders`` are the paths of the
    parameters under the picture, by default those that the sketch is about; ``draws`` is "browser", "kernel",
    or "auto": the browser where it can; ``time`` in seconds; ``language`` is "en" or "fr".

        shown = playground.widget("diamond_square", size=(320, 180), sliders=["height.smoothing"])
        shown.close()

    Raises ``PlaygroundError`` for any mistake in the sketch, ``DataError`` without the extra ``notebook``.
    """
    try:
        from playground.publish.notebook.widget import SketchWidget
    except ModuleNotFoundError as error:
        raise _needed(error) from None
    sketches = [opened(sketch)]
    return SketchWidget(sketches, size=size, sliders=sliders, draws=draws, time=time, language=language)


def compare(
    a: Sketch | str | Path | Mapping[str, object],
    b: Sketch | str | Path | Mapping[str, object],
    *,
    sketch: Sketch | str | Path = "",
    swipe: bool = False,
    names: tuple[str, str] | None = None,
    size: tuple[int, int] = (640, 360),
    sliders: Sequence[str] | None = None,
    draws: str = "auto",
    time: float = 0.0,
    language: str = "en",
) -> CompareWidget:
    """Return two pictures for a notebook, seen by one camera at one time.

    ``a`` and ``b`` are sketches, or values by path of ``sketch``. ``swipe`` puts one picture over the other,
    with a line between them to move. ``names`` are written under the pictures. A slider of what is the same
    in both moves both; what differs has a slider for each. ``size``, ``sliders``, ``draws``, ``time`` and
    ``language`` are as in ``widget``.

        smooth, rough = {"height.smoothing": 0.9}, {"height.smoothing": 0.1}
        shown = playground.compare(smooth, rough, sketch="diamond_square", size=(320, 180))
        shown.close()

    Raises as ``widget``.
    """
    try:
        from playground.publish.notebook.widget import CompareWidget
    except ModuleNotFoundError as error:
        raise _needed(error) from None
    sketches = [
        opened(sketch).with_values(side) if isinstance(side, Mapping) else opened(side) for side in (a, b)
    ]
    named = [_name(*of) for of in zip((a, b), sketches, ("A", "B"), strict=True)]
    return CompareWidget(
        sketches,
        names=list(names or named),
        swipe=swipe,
        size=size,
        sliders=sliders,
        draws=draws,
        time=time,
        language=language,
    )


def _name(settings_or_sketch: object, sketch: Sketch, letter: str) -> str:
    if isinstance(settings_or_sketch, Mapping):
        settings = ", ".join(f"{path} = {spell(value)}" for path, value in settings_or_sketch.items())
        return settings if 0 < len(settings_or_sketch) <= _MAX_VALUES else letter
    return f"{letter}: {sketch.title or sketch.name}"


def _needed(error: ModuleNotFoundError) -> DataError:
    """Return what to say of a missing module; raise the error itself for one that no extra brings."""
    if error.name not in ("anywidget", "traitlets"):
        raise error
    return DataError(needs("a widget", error.name, "notebook"))
