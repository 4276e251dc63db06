"""Gather the scenes of a book for a browser: sketches once each, and what each scene sets of them.

Most scenes of a lesson are one sketch with other values, another camera or fewer iterations. So a
lesson's data has few sketches, and for each scene a *setting*: a sketch's number, and what differs.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, field, replace
from typing import Any

from playground.course.model import Scene
from playground.engine.engine import Engine
from playground.web.plan import sketch_data
from playground.web.shared import SharedData

SET = ("terrain", "camera", "frame", "time", "steps")
"""What a setting has as a whole where it differs; of values, rows and texels it has those that differ."""


@dataclass
class Library:
    """What all lessons of a book share: texts, kernels, images, bytes, and who draws some of these."""

    engine: Engine | None = None  # as of ``sketch_data``
    shared: SharedData = field(default_factory=SharedData)
    kernels: list[Any] = field(default_factory=list)
    _numbers: dict[str, int] = field(default_factory=dict)  # a kernel as text → its number

    def number(self, kernel: Any) -> int:
        """Return the number of a kernel in the book."""
        text = json.dumps(kernel)
        if text not in self._numbers:
            self._numbers[text] = len(self.kernels)
            self.kernels.append(kernel)
        return self._numbers[text]

    def data(self) -> dict[str, Any]:
        """Return what every page of the book reads: see ``Shared`` in schema.js, without the blobs.

        Only shaders are among the files: a book has no version of a sketch to download.
        """
        shared = self.shared.data()
        del shared["blobs"]
        read = {kernel["file"] for kernel in self.kernels}
        read |= {stage["file"] for kernel in self.kernels for stage in stages_of(kernel) if "file" in stage}
        for name in (names := list(read)):  # it grows: what a file includes is read as well
            news = set(shared["includes"].get(name, {}).values()) - read
            read |= news
            names += sorted(news)
        for table in (shared["files"], shared["includes"]):
            for name in set(table) - read:
                del table[name]
        return {**shared, "kernels": self.kernels}


def stages_of(kernel: dict[str, Any]) -> list[dict[str, Any]]:
    """Return the stages of a kernel, as a page has it."""
    return [kernel["vertex"], kernel["fragment"]]


@dataclass
class Scenes:
    """The sketches of one lesson."""

    library: Library
    sketches: list[dict[str, Any]] = field(default_factory=list)
    _numbers: dict[str, int] = field(default_factory=dict)  # a sketch's outline as text → its number
    _known: dict[tuple[object, ...], dict[str, Any]] = field(default_factory=dict)

    def setting(self, scene: Scene) -> dict[str, Any]:
        """Return the setting of a scene; raise ``PlaygroundError`` for what no page can run."""
        key = (scene.sketch, scene.pixels, scene.time, scene.steps)
        if key not in self._known:
            sketch = replace(scene.sketch, presets=(), shots=())  # a figure offers none
            steps = dict(scene.steps)
            at: dict[str, Any] = {"frame": scene.pixels, "time": scene.time, "steps": steps}
            data = sketch_data(sketch, self.library.shared, **at, engine=self.library.engine)
            self._known[key] = self._written(data)
        return self._known[key]

    def row(self, setting: dict[str, Any], path: str) -> dict[str, Any] | None:
        """Return the panel's row of a parameter; None where the panel has none."""
        rows = self.sketches[setting["sketch"]]["shown"]
        return next((row for row in rows if row["path"] == path), None)

    def value(self, setting: dict[str, Any], path: str) -> Any:
        """Return what a row shows in a setting."""
        row = self.row(setting, path)
        return setting.get("shown", {}).get(path, row["value"] if row else None)

    def _written(self, sketch: dict[str, Any]) -> dict[str, Any]:
        sketch["kernels"] = [self.library.number(kernel) for kernel in sketch["kernels"]]
        outline = _outline(sketch)
        if outline not in self._numbers:
            self._numbers[outline] = len(self.sketches)
            self.sketches.append(sketch)
        number = self._numbers[outline]
        base = self.sketches[number]
        data: dict[str, Any] = {"sketch": number}
        data |= {name: sketch[name] for name in SET if sketch[name] != base[name]}
        differing = {
            "values": _differing(sketch["values"], base["values"]),
            "shown": _differing(_rows(sketch), _rows(base)),
            "data": _differing(_texels(sketch["nodes"]), _texels(base["nodes"])),
        }
        return data | {name: table for name, table in differing.items() if table}


def _outline(sketch: dict[str, Any]) -> str:
    """Return what scenes of one sketch have in common, as text."""
    rows = [{name: of for name, of in row.items() if name != "value"} for row in sketch["shown"]]
    common = {name: of for name, of in sketch.items() if name not in (*SET, "values", "shown")}
    common["nodes"] = [_without_texels(node) for node in sketch["nodes"]]
    return json.dumps([common, rows, sorted(sketch["values"]), sketch["terrain"]["locked"]])


def _without_texels(node: dict[str, Any]) -> dict[str, Any]:
    return {name: of for name, of in node.items() if name != "data"}


def _texels(nodes: list[dict[str, Any]]) -> dict[str, Any]:
    """Return what sources give, by path; a source is never inside a loop."""
    return {node["path"]: node["data"] for node in nodes if "data" in node}


def _rows(sketch: dict[str, Any]) -> dict[str, Any]:
    return {row["path"]: row["value"] for row in sketch["shown"]}


def _differing(values: dict[str, Any], base: dict[str, Any]) -> dict[str, Any]:
    return {path: value for path, value in values.items() if value != base[path]}
