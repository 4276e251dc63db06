"""Know the pictures in ``screenshots/`` and make thumbnails of them."""

from __future__ import annotations

import io
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from PIL import Image

from playground.paths import GLSL
from playground.sketch.find import shipped_sketches
from playground.sketch.load import load_with
from playground.sketch.model import Graph, Kernel, Sketch, Technique
from playground.sketch.techniques import Techniques

SCREENSHOTS = GLSL.parent / "screenshots"
RENDERER = "llvmpipe"
WIDTH = 400  # pixels of a thumbnail


@dataclass(frozen=True, slots=True)
class Picture:
    """A reference of a shot."""

    sketch: str
    shot: str

    @property
    def file(self) -> Path:
        """The reference."""
        return SCREENSHOTS / self.sketch / RENDERER / f"{self.shot}.png"

    @property
    def thumbnail(self) -> str:
        """Where the site has it, from its top."""
        return f"assets/shots/{self.sketch}-{self.shot}.webp"

    @property
    def command(self) -> str:
        """What draws it."""
        return f"playground render {self.sketch} --shot {self.shot}"


@cache
def sketches() -> tuple[Sketch, ...]:
    """Load every sketch that ships."""
    read = Techniques()
    return tuple(load_with(read, name) for name in shipped_sketches())


def pictures(sketch: Sketch) -> list[Picture]:
    """List the references of a sketch's shots."""
    return [Picture(sketch.name, shot.name) for shot in sketch.shots]


@cache
def picture_of(technique: str) -> Picture | None:
    """Return a technique's first picture: of the sketch of its name, else as a pass, else inside one."""
    title = technique.rpartition("/")[2]
    ranked = []
    for number, sketch in enumerate(sketches()):
        depth = _depth(sketch.graph, technique)
        if depth and (result := pictures(sketch)):
            ranked.append((sketch.name != title, depth, number, result[0]))
    return min(ranked, key=lambda row: row[:3])[3] if ranked else None


def _depth(technique: Technique, text: str, depth: int = 0) -> int:
    """Return how deep a technique lies inside another, from 1; 0 where it does not."""
    if isinstance(technique, Kernel):
        return 0
    result = []
    for spec in technique.passes:
        if spec.technique.name == text:
            return depth + 1
        if isinstance(spec.technique, Graph):
            result.append(_depth(spec.technique, text, depth + 1))
    return min(filter(None, result), default=0)


def thumbnail(file: Path, width: int = WIDTH) -> bytes:
    """Return a picture as a WebP, at most so many pixels wide."""
    with Image.open(file) as image:
        small = image.convert("RGB")
        small.thumbnail((width, width), Image.Resampling.BOX, reducing_gap=2.0)
        out = io.BytesIO()
        small.save(out, "WEBP", quality=80, method=2)
    return out.getvalue()
