"""Write down a page: one or more sketches, and what they share. See ``Page`` in schema.js."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from playground.sketch.model import DEFAULT_PICTURE, Sketch
from playground.web.plan import FORMAT, sketch_data
from playground.web.shared import SharedData


def page_data(
    sketches: Sequence[Sketch],
    *,
    frame: tuple[int, int] = DEFAULT_PICTURE,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
) -> dict[str, Any]:
    """Return sketches as one page's data: JSON's own types only.

    ``frame`` in pixels, ``time`` in seconds, ``steps`` stops repeats early, by path, as in
    ``Engine.render``. The same sketches give the same data. Raises ``PlaygroundError`` for any mistake
    in a sketch, and for what no page can run.
    """
    shared = SharedData()
    written = [sketch_data(one, shared, frame=frame, time=time, steps=steps) for one in sketches]
    return {"format": FORMAT, "sketches": written, "shared": shared.data()}
