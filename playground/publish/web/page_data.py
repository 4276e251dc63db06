"""Write down a page: one or more sketches, and what they share. See ``Page`` in schema.js."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from playground.engine.engine import Engine
from playground.publish.web.plan import FORMAT, sketch_data
from playground.publish.web.shared_data import SharedData
from playground.publish.web.techniques import technique_menus
from playground.sketch.model import DEFAULT_PICTURE, Sketch


def page_data(
    sketches: Sequence[Sketch],
    *,
    frame: tuple[int, int] = DEFAULT_PICTURE,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    techniques: Mapping[str, Sequence[str]] | None = None,
    engine: Engine | None = None,
    traces: bool = False,
) -> dict[str, Any]:
    """Return sketches as one page's data: JSON's own types only.

    ``frame`` in pixels, ``time`` in seconds, ``steps`` stops repeats early, by path, as in
    ``Engine.render``. ``techniques`` lists by pass what else may fill it in the first sketch (an empty
    list: all that fits), for a page with menus of them. ``engine`` draws what sources are made of,
    and ``traces`` adds traced texts, as in ``sketch_data``.
    The same sketches give the same data. Raises ``PlaygroundError`` for any mistake in a sketch, and for
    what no page can run.
    """
    shared = SharedData()
    menus: list[list[dict[str, Any]]] = [[] for _ in sketches]
    if techniques:
        made, first = technique_menus(sketches[0], techniques)
        sketches, menus = [*made, *sketches[1:]], [*first, *menus[1:]]
    at: dict[str, Any] = {"frame": frame, "time": time, "steps": steps, "engine": engine, "traces": traces}
    written = [sketch_data(sketch_entry, shared, **at) for sketch_entry in sketches]
    for sketch_entry, choices in zip(written, menus, strict=True):
        sketch_entry["choices"] = choices
    return {"format": FORMAT, "sketches": written, "shared": shared.data()}
