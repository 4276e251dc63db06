"""Write down what a widget of sketches needs: all of a page, or only what can be dragged of them.

``Page`` in publish/web/runtime/schema.js says what a page is. Where the kernel draws, a sketch is written
without its kernels and its data, and nothing in it is locked.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from playground.engine.engine import Engine
from playground.errors import PlaygroundError
from playground.publish.web.blobs import packed_json
from playground.publish.web.page_data import page_data
from playground.publish.web.plan import FORMAT
from playground.publish.web.shown import presets_data, shown_data, tracks_data
from playground.sketch.assign import values_of
from playground.sketch.model import Sketch, Value
from playground.sketch.traits import is_animated

MAX_PAGE_LETTERS = 24 * 2**20
"""Letters of a page that a notebook is given: it is sent to the browser, and saved in the notebook."""


def browser_page(
    sketches: Sequence[Sketch], size: tuple[int, int], engine: Engine
) -> tuple[str, list[frozenset[str]]]:
    """Return sketches as a page, packed, for a picture of ``size`` pixels; and the paths fixed in each.

    Raises ``PlaygroundError`` for any mistake in a sketch, for what no page can run, and for what is too
    large.
    """
    data = page_data(sketches, frame=size, engine=engine)
    page = packed_json(data)
    if len(page) > MAX_PAGE_LETTERS:
        millions = [round(number / 2**20) for number in (len(page), MAX_PAGE_LETTERS)]
        raise PlaygroundError(f"its data take {millions[0]} MB; a notebook is given {millions[1]} at most")
    fixed = [
        frozenset(row["path"] for row in sketch_data["shown"] if row["locked"] or row["widget"] == "file")
        for sketch_data in data["sketches"]
    ]
    return page, fixed


def kernel_outline(sketches: Sequence[Sketch], size: tuple[int, int], engine: Engine) -> str:
    """Return what can be dragged of sketches, packed; raise ``PlaygroundError`` for any mistake in one."""
    return packed_json({"sketches": [_outline(sketch, size, engine) for sketch in sketches]})


def _outline(sketch: Sketch, size: tuple[int, int], engine: Engine) -> dict[str, Any]:
    terrain = engine.plan(sketch, size).terrain
    values = values_of(sketch)
    rows = shown_data(sketch, values, _unlocked)
    return {
        "format": FORMAT,
        "name": sketch.name,
        "title": sketch.title,
        "frame": list(size),
        "time": 0.0,
        "steps": {},
        "terrain": {
            "size": list(terrain.size or ()),
            "extent": list(terrain.extent or ()),
            "relief": terrain.relief,
            "base_elevation": terrain.base_elevation,
            "locked": "",
        },
        "camera": asdict(sketch.camera),
        "kernels": [],
        "nodes": [],
        "passes": {},
        "values": values,
        "shown": rows,
        "presets": presets_data(sketch, rows, _as_it_is)[0],
        "tracks": tracks_data(sketch, _unlocked, _as_it_is)[0],
        "duration": sketch.duration,
        "moves": is_animated(sketch),
        "rules": [],
        "textures": [],
        "choices": [],
        "notes": [],
    }


def _unlocked(_path: str, _targets: tuple[str, ...]) -> str:
    return ""


def _as_it_is(_path: str, value: Value) -> Value:
    return value
