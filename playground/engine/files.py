"""Find the files that a sketch's parameters name."""

from __future__ import annotations

from pathlib import Path

from playground.errors import DataError, nearest
from playground.media.pyav import SOUND_FILES, VIDEO_FILES
from playground.paths import GLSL, shown
from playground.sketch.allowed_files import ELEVATIONS, VECTORS, outside_sidecar

_IMAGES = (".jpg", ".jpeg", ".webp")
_DATA = {*_IMAGES, *ELEVATIONS, *VECTORS, *VIDEO_FILES, *SOUND_FILES}


def find_file(text: str, folder: str, declared_in: str, parameter: str) -> Path:
    """Return the file that a parameter's text names.

    Looked for in the sketch's own folder, in that of the kernel that declares it, and in
    ``glsl/``; a path from anywhere else works only when it is absolute, which a sketch's
    file may not be (``load`` and ``--set`` see to that). Raises ``DataError`` with the nearest name.
    """
    if not text:
        raise DataError(f"{parameter} names no file")
    path = Path(text)
    places = [Path(folder), Path(declared_in).parent, GLSL]
    if path.is_absolute():
        if path.is_file():
            return path
        places = []
    for place in places:
        candidate = (place / path).resolve()
        if candidate.is_file() and any(
            candidate.is_relative_to(root.resolve()) for root in (Path(folder), GLSL)
        ):
            outside = outside_sidecar(candidate, (Path(folder), GLSL))
            if outside is not None:
                message = f"{parameter}: {outside.name} next to it leads out of the sketch's folder"
                raise DataError(message, file=shown(candidate))
            return candidate
    folders = [(place / path).parent for place in places] or [path.parent]
    near = sorted(
        {p.name for folder in folders if folder.is_dir() for p in folder.iterdir() if p.suffix in _DATA}
    )
    what = "this is a folder, not a file" if path.is_dir() else "there is no such file"
    raise DataError(f"{parameter}: {what}{nearest(path.name, near)}", file=shown(path))
