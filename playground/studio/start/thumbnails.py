"""Small pictures of the shipped sketches in one image that ships, made from the references of the tests.

Made anew in a checkout, after a sketch or its reference has changed:

    python -m playground.studio.start.thumbnails
"""

from __future__ import annotations

import json
import tomllib
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from playground.paths import GLSL, SCREENSHOTS, SKETCHES

if TYPE_CHECKING:
    from PIL import Image

CELL = (192, 108)
"""Width and height of one picture [pixels]."""

_ACROSS = 11  # pictures in a row
_ATLAS = Path(__file__).parent / "thumbnails.jpg"
_TABLE = _ATLAS.with_suffix(".json")
_QUALITY = 82

SUBJECTS = ("landscapes", "land", "erosion", "water", "sky", "textures", "light", "methods")
_OF_FOLDERS = {
    "water": "water",
    "erosion": "erosion",
    "clouds": "sky",
    "sky": "sky",
    "trees": "textures",
    "texturing": "textures",
    "lighting": "light",
    "simulation": "methods",
    "maths": "methods",
    "foreign": "methods",
    "generation": "land",
    "terrain": "land",
    "noise": "land",
}
"""Of a technique's folder: what a sketch is about say the passes whose parameters it puts first."""


@dataclass(frozen=True)
class Thumbnail:
    """A shipped sketch on the start page."""

    name: str
    title: str
    about: str  # the sentence that its file begins with
    subject: str  # one of ``SUBJECTS``
    cell: int  # its picture in the atlas; -1 without one


@cache
def thumbnails() -> tuple[Thumbnail, ...]:
    """Return the shipped sketches in the order of their names."""
    table = json.loads(_TABLE.read_text("utf-8"))
    return tuple(Thumbnail(**row) for row in table["sketches"])


def read_atlas() -> Image.Image:
    """Return all pictures in rows of ``_ACROSS``."""
    return read_picture(_ATLAS)


def read_picture(file: str | Path) -> Image.Image:
    """Return a picture; raise ``OSError`` where it cannot be read."""
    from PIL import Image  # takes a while to read: only pages that are shown need it

    with Image.open(file) as picture:
        return picture.convert("RGB")


def place_of(cell: int, size: tuple[int, int]) -> tuple[float, float, float, float]:
    """Return where a picture is in an atlas of a size: left, top, right, bottom, as fractions."""
    column, row = cell % _ACROSS, cell // _ACROSS
    wide, high = CELL[0] / size[0], CELL[1] / size[1]
    return column * wide, row * high, (column + 1) * wide, (row + 1) * high


def reference_of(name: str) -> Path | None:
    """Return the reference of a sketch's first shot that has one; None without, and outside of a checkout."""
    shots = tomllib.loads((SKETCHES / f"{name}.toml").read_text("utf-8")).get("shot", [])
    folders = sorted((GLSL.parent / SCREENSHOTS / name).glob("*/"))
    paths = (folder / f"{shot['name']}.png" for shot in shots for folder in folders)
    return next((path for path in paths if path.is_file()), None)


def make_atlas() -> None:
    """Write the pictures and their table."""
    from PIL import Image

    rows: list[dict[str, object]] = []
    pictures: list[Image.Image] = []
    for path in sorted(SKETCHES.glob("*.toml")):
        reference = reference_of(path.stem)
        cell = -1
        if reference is not None:
            cell = len(pictures)
            pictures.append(shrunk(read_picture(reference)))
        rows.append({"name": path.stem, **_described(path), "cell": cell})
    high = -(-len(pictures) // _ACROSS) * CELL[1]
    atlas = Image.new("RGB", (_ACROSS * CELL[0], high))
    for number, picture in enumerate(pictures):
        atlas.paste(picture, (number % _ACROSS * CELL[0], number // _ACROSS * CELL[1]))
    atlas.save(_ATLAS, quality=_QUALITY, subsampling=0, optimize=True)
    lines = ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows)
    _TABLE.write_text(f'{{"sketches": [\n{lines}\n]}}\n', encoding="utf-8")


def shrunk(picture: Image.Image) -> Image.Image:
    """Return a picture as large as one of the atlas, its edges cut where it is wider or higher."""
    from PIL import Image

    wide, high = picture.size
    scale = min(wide / CELL[0], high / CELL[1])
    left, top = max(wide - scale * CELL[0], 0.0) / 2, max(high - scale * CELL[1], 0.0) / 2  # 0 may be rounded
    return picture.resize(CELL, Image.Resampling.BOX, box=(left, top, wide - left, high - top))


def _described(path: Path) -> dict[str, object]:
    """Return a sketch's title, first sentence and subject."""
    text = path.read_text("utf-8")
    table = tomllib.loads(text)
    comment: list[str] = []
    for line in text.splitlines():
        if not line.startswith("# "):
            break
        comment.append(line[2:])
    sentence = " ".join(comment).split(". ")[0].rstrip(".")
    subject = _subject(table)
    return {"title": table.get("title", path.stem), "about": f"{sentence}.", "subject": subject}


def _subject(table: dict[str, Any]) -> str:
    """Return what most of a sketch's main parameters belong to, of equals the first; else its last pass.

    A sketch with all of it in one picture is a landscape.
    """
    if str(table.get("view", {}).get("use", "")).startswith("scene/"):
        return SUBJECTS[0]
    folders = {
        str(entry.get("name")): str(entry.get("use", "")).split("/")[0] for entry in table.get("pass", [])
    }
    named = [str(path).split(".")[0] for path in table.get("main", [])]
    subjects = [_OF_FOLDERS[folders[name]] for name in named if folders.get(name) in _OF_FOLDERS]
    subjects = subjects or [_OF_FOLDERS[f] for f in reversed(folders.values()) if f in _OF_FOLDERS][:1]
    return max(subjects, key=subjects.count) if subjects else "methods"


if __name__ == "__main__":
    make_atlas()
