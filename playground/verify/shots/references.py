"""Store reference pictures: where they live, what they say of themselves, which of them nothing uses.

``screenshots/<sketch>/<renderer>/<shot>.png``, in the checkout for the sketches that ship,
in the sketch's folder for a user's own. ``<shot>.2.png``, ``<shot>.3.png`` … are further pictures
that may match (another build of the same renderer, say).

A reference carries texts: its fingerprint, and which shot of which sketch it shows. There is no
date in them, so that writing the same picture again gives the same file.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground import paths
from playground.data.image_files import read_png, write_png
from playground.engine.context import ContextInfo
from playground.files import make_folder
from playground.paths import SCREENSHOTS
from playground.sketch.find import home_of
from playground.sketch.model import Sketch
from playground.verify.shots.fingerprint import Fingerprint, fingerprint_of, read_fingerprint

FOLDER = SCREENSHOTS

_NUMBERED = re.compile(r"(?P<shot>[^.]+)(?:\.(?P<number>[2-9]|[1-9][0-9]+))?\.png")


@dataclass(frozen=True, eq=False)
class Reference:
    """A picture that a shot may match."""

    path: Path
    pixels: NDArray[np.uint8]  # (height, width, 4), top row first, sRGB and alpha
    text: dict[str, str]  # what the file says of itself: its fingerprint's parts, sketch, shot

    @property
    def fingerprint(self) -> Fingerprint:
        """What it comes from, as far as the file says."""
        return read_fingerprint(self.text)


def reference_path(sketch: Sketch, shot: str, renderer: str) -> Path:
    """Return where a shot's first reference is, or would be; ``renderer`` is a slug such as "llvmpipe"."""
    return home_of(sketch) / sketch.name / renderer / f"{shot}.png"


def accepted(sketch: Sketch, shot: str, renderer: str) -> list[Path]:
    """List the reference files that are there for a shot, ``<shot>.png`` first; none if it is missing."""
    return accepted_in(reference_path(sketch, shot, renderer).parent, shot)


def accepted_in(folder: Path, shot: str) -> list[Path]:
    """List the reference files for a shot that are in a folder, ``<shot>.png`` first."""
    result: list[tuple[int, Path]] = []
    for path in folder.glob("*.png"):
        name = _NUMBERED.fullmatch(path.name)
        if name and name["shot"] == shot:
            result.append((int(name["number"] or 1), path))
    return [path for _, path in sorted(result)]


def read_reference(path: Path) -> Reference:
    """Read a reference; raise ``DataError`` if it is missing, damaged or no PNG."""
    pixels, text = read_png(path)
    return Reference(path, pixels, text)


def write_reference(
    sketch: Sketch,
    shot: str,
    renderer: ContextInfo,
    pixels: NDArray[np.uint8],
    drawn: str = "",
    fonts: str = "",
) -> tuple[Path, list[Path]]:
    """Write a shot's first reference for its renderer, and remove the further ones that were accepted.

    ``drawn`` is the hash of what was drawn, ``fonts`` its fonts, "" if that is not known. Otherwise as
    `write_reference_in`.
    """
    folder = reference_path(sketch, shot, renderer.slug).parent
    fingerprint = fingerprint_of(renderer, (pixels.shape[1], pixels.shape[0]), drawn, fonts)
    return write_reference_in(folder, shot, fingerprint, pixels, sketch.name)


def write_reference_in(
    folder: Path, shot: str, fingerprint: Fingerprint, pixels: NDArray[np.uint8], sketch: str = ""
) -> tuple[Path, list[Path]]:
    """Write ``<shot>.png`` into a folder, whole or not at all, and remove ``<shot>.2.png`` and so on.

    Those would otherwise let the old picture pass for ever. Returns what was written and
    what was removed. Raises ``DataError`` where the folder cannot be written to.
    """
    path = make_folder(folder) / f"{shot}.png"
    write_png(path, pixels, text=reference_texts(fingerprint, sketch, shot))
    further = [other for other in accepted_in(folder, shot) if other != path]
    for other in further:
        other.unlink()
    return path, further


def reference_texts(fingerprint: Fingerprint, sketch: str, shot: str) -> dict[str, str]:
    """Return what a reference says of itself."""
    return {**fingerprint.texts(), **({"sketch": sketch} if sketch else {}), "shot": shot}


def stale_references(sketches: Iterable[Sketch]) -> list[Path]:
    """List the reference files, of all renderers, that no shot uses.

    Give every sketch whose references are to be judged, with shots or without. Pictures of
    a sketch that is not given count only if there is no such sketch any more.
    """
    shots: dict[Path, dict[str, set[str]]] = {}
    for sketch in sketches:
        of_home = shots.setdefault(home_of(sketch), {})
        of_home.setdefault(sketch.name, set()).update(shot.name for shot in sketch.shots)
    stale: list[Path] = []
    for home, shot_names in shots.items():
        others = _sketches_of(home) - shot_names.keys()
        for path in home.rglob("*.png"):
            folders = path.relative_to(home).parts[:-1]  # sketch and renderer, if it is where it should be
            if folders and folders[0] in others:
                continue
            name = _NUMBERED.fullmatch(path.name)
            if len(folders) != 2 or name is None or name["shot"] not in shot_names.get(folders[0], ()):
                stale.append(path)
    return sorted(stale)


def _sketches_of(home: Path) -> set[str]:
    """Return the names of the sketches whose references are in ``home``."""
    folder = paths.SKETCHES if paths.CHECKOUT and home == paths.CHECKOUT / FOLDER else home.parent
    names = {path.stem for path in folder.glob("*.toml")}
    return names | {folder.name} if "sketch" in names else names
