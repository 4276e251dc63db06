"""Say which pages are generated, and where they lie in the site."""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from playground import rooms

from . import commands, gallery, keys, python, shots, techniques
from .markdown import escaped

ROOT = Path(__file__).resolve().parents[2]

ELSEWHERE = {
    "reference/shaders.md": "glsl/README.md",
    "changelog.md": "CHANGELOG.md",
    "contributing.md": "CONTRIBUTING.md",
}
"""Pages whose one home is another place of the checkout."""

PICTURES = {
    "assets/first.webp": "screenshots/october/llvmpipe/morning.png",
    "assets/flight.webp": "tests/flight/pictures/llvmpipe/tour-450.png",
}
"""Pictures that written pages show, and where they come from."""

TECHNIQUES = "reference/techniques/"
"""The folder of the catalogue; in the navigation it represents all of its pages."""

_PAGES: dict[str, Callable[[], str]] = {
    "reference/commands.md": commands.page,
    "reference/keys.md": keys.page,
    "reference/python.md": python.page,
    "reference/gallery.md": gallery.page,
    **{path: partial(write, escaped) for room in rooms.modules("site") for path, write in room.PAGES.items()},
}
_LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!\w+:|#)([^)#\s]+)(#[^)\s]*)?\)")


def generated_paths() -> list[str]:
    """List the pages that ``generated`` returns, without making them."""
    techniques_of = [techniques.path_of(e) for names in techniques.entries().values() for e in names]
    return [*_PAGES, f"{TECHNIQUES}index.md", *techniques_of, *ELSEWHERE]


def generated() -> dict[str, str | bytes]:
    """Return every page and picture that no file of this folder holds, by its path in the site."""
    result: dict[str, str | bytes] = {path: write() for path, write in _PAGES.items()}
    result[f"{TECHNIQUES}index.md"] = techniques.index()
    for names in techniques.entries().values():
        result |= {techniques.path_of(entry): techniques.page(entry) for entry in names}
    for page, source in ELSEWHERE.items():
        result[page] = moved((ROOT / source).read_text("utf-8"), source, page)
    for sketch in shots.sketches():
        for picture in shots.pictures(sketch):
            result[picture.thumbnail] = shots.thumbnail(picture.file)
    for path, source in PICTURES.items():
        result[path] = shots.thumbnail(ROOT / source, 1280)
    return result


def missing_pictures() -> list[str]:
    """List the pictures that the site shows and the checkout lacks."""
    files = [picture.file for sketch in shots.sketches() for picture in shots.pictures(sketch)]
    files += [ROOT / source for source in PICTURES.values()]
    return [str(file) for file in files if not file.is_file()]


def moved(text: str, source: str, page: str) -> str:
    """Return a Markdown text whose links still lead there from its place in the site.

    What is no page of the site is named in place of a link.
    """
    homes = {home: key for key, home in ELSEWHERE.items()}
    for room in rooms.modules("site"):
        homes |= {file.relative_to(ROOT).as_posix(): key for file, key in room.HOMES.items()}
    up = "../" * page.count("/")

    def lead(match: re.Match[str]) -> str:
        target = (ROOT / source).parent.joinpath(match[3]).resolve().relative_to(ROOT).as_posix()
        home = homes.get(target, target.removeprefix("docs/") if target.startswith("docs/") else "")
        return f"{match[1]}[{match[2]}]({up}{home}{match[4] or ''})" if home else match[2]

    return _LINK.sub(lead, text)


def expanded(entry: Any) -> Any:
    """Return an entry of the navigation, the folder of the catalogue as a list of its pages."""
    if isinstance(entry, dict):
        return {title: expanded(below) for title, below in entry.items()}
    if isinstance(entry, list):
        return [expanded(below) for below in entry]
    if entry != TECHNIQUES:
        return entry
    values: list[Any] = [f"{TECHNIQUES}index.md"]
    for folder, names in techniques.entries().items():
        title = techniques.FOLDERS.get(folder, folder).partition(":")[0]
        values.append({title: [{e.name.partition("/")[2]: techniques.path_of(e)} for e in names]})
    return values
