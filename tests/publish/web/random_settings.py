"""Make random settings of a sketch, as the page and as the engine take them."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from typing import Any

from playground.engine.plan import LoopStep, Plan, every_node
from playground.sketch.model import Camera, Sketch

TERRAINS = [(33, 33), (65, 65), (129, 129), (257, 257), (64, 64), (128, 64), (129, 65), (65, 257), (100, 77)]
TOO_LARGE = (16_385, 33)


@dataclass
class Settings:
    """What is set: `values` by the path of a row of the panel."""

    values: dict[str, Any] = field(default_factory=dict)
    terrain: dict[str, Any] = field(default_factory=dict)
    camera: Camera | None = None
    frame: tuple[int, int] = (64, 36)
    time: float = 0.0
    steps: dict[str, int] = field(default_factory=dict)

    def of(self, sketch: Sketch) -> Sketch:
        """Return a sketch with them."""
        terrain = dict(self.terrain)
        if size := terrain.get("size"):
            terrain["size"] = f"{size[0]}x{size[1]}"
        result = sketch.with_values({**terrain, **self.values})
        return result.with_camera(self.camera) if self.camera else result

    def state(self, data: dict[str, Any]) -> dict[str, Any]:
        """Return them as the page's planner takes them."""
        targets = {row["path"]: row["targets"] for row in data["shown"]}
        values = {target: value for path, value in self.values.items() for target in targets[path]}
        return {
            "values": values,
            "terrain": {**{k: v for k, v in data["terrain"].items() if k in _METRES}, **self.terrain},
            "camera": vars_of(self.camera),
            "frame": self.frame,
            "time": self.time,
            "steps": self.steps,
        }


_METRES = ("size", "extent", "relief", "base_elevation")


def vars_of(camera: Camera | None) -> dict[str, Any] | None:
    """Return a camera as data."""
    return {name: getattr(camera, name) for name in camera.__dataclass_fields__} if camera else None


def random_settings(chance: random.Random, data: dict[str, Any], plan: Plan) -> Settings:
    """Return settings of an exported sketch, values inside their ranges; ``plan`` says what repeats."""
    settings = Settings(
        frame=(chance.randint(1, 301), chance.randint(1, 299)),
        time=chance.choice([0.0, 0.5, chance.uniform(0.0, 4.0), chance.randint(0, 99) / 60]),
    )
    rows = [row for row in data["shown"] if not row["locked"] and row["widget"] not in ("file", "button")]
    for row in chance.sample(rows, min(len(rows), 8)):
        settings.values[row["path"]] = _value(chance, row)
    terrain = data["terrain"]
    if not terrain["locked"] and chance.random() < 0.8:
        settings.terrain["size"] = TOO_LARGE if chance.random() < 0.05 else chance.choice(TERRAINS)
    locked = terrain["lockedMetres"]
    if chance.random() < 0.5 and "relief" not in locked:
        settings.terrain["relief"] = chance.uniform(0.0, 3000.0)
    if chance.random() < 0.2 and "extent" not in locked:
        settings.terrain["extent"] = (chance.uniform(10.0, 2e4), chance.uniform(10.0, 2e4))
    if chance.random() < 0.6:
        settings.camera = Camera(
            chance.uniform(-360, 720), chance.uniform(-89, 89), chance.choice([0.0, 5000.0])
        )
    repeats = {
        node.path: node.total
        for node in every_node(plan.nodes)
        if isinstance(node, LoopStep) or node.kernel.repeat != "1"
    }
    if repeats and chance.random() < 0.7:
        path, whole = chance.choice(sorted(repeats.items()))
        settings.steps[path] = chance.randint(0, min(whole + 2, 200))
    return settings


def _value(chance: random.Random, row: dict[str, Any]) -> Any:
    if row["type"] == "bool":
        return chance.random() < 0.5
    if row["widget"] == "menu":
        return chance.randrange(len(row["choices"]))
    if row["widget"] == "colour":
        return tuple(chance.random() for _ in row["value"])
    parts = row["value"] if isinstance(row["value"], (list, tuple)) else [row["value"]]
    whole = row["type"] in ("int", "uint") or row["type"][:4] in ("ivec", "uvec")
    numbers = []
    for number, (low, high) in zip(parts, row["ranges"] * len(parts), strict=False):
        low, high = (number, number) if low is None else (low, high)
        numbers.append(chance.randint(round(low), round(high)) if whole else chance.uniform(low, high))
    return tuple(numbers) if isinstance(row["value"], (list, tuple)) else numbers[0]
