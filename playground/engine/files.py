"""Find the files that a sketch's parameters name.

Every frame asks, for a file may have come, gone or been replaced since. To follow links takes a tenth of a
millisecond, so what was found is remembered, and holds while the file is there and none is in the places that
are looked at first.
"""

from __future__ import annotations

import stat
from pathlib import Path
from typing import NamedTuple

from playground.allowed_files import ELEVATIONS, VECTORS, named_root, outside_sidecar, sidecar_places
from playground.data.media import SOUND_FILES, VIDEO_FILES
from playground.errors import DataError, nearest
from playground.memo import FILES
from playground.paths import GLSL, shown
from playground.regular_file import irregularity

_IMAGES = (".jpg", ".jpeg", ".webp")
_DATA = {*_IMAGES, *ELEVATIONS, *VECTORS, *VIDEO_FILES, *SOUND_FILES}


class _Found(NamedTuple):
    """A file that was found, and where."""

    earlier: tuple[Path, ...]  # places that are looked at before, where there was no file
    place: Path
    file: Path  # the place, its links followed
    identity: tuple[int, int]

    def holds(self) -> bool:
        """Return whether it would be found again."""
        if any(_identity(place) is not None for place in self.earlier):
            return False
        places = (self.place,) if self.place == self.file else (self.place, self.file)
        return all(_identity(place) == self.identity for place in places)


def _identity(path: Path) -> tuple[int, int] | None:
    """Return what tells a file from every other; None where there is none."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return (status.st_dev, status.st_ino) if stat.S_ISREG(status.st_mode) else None


def find_file(text: str, folder: str, declared_in: str, parameter: str) -> Path:
    """Return the file that a parameter's text names.

    Looked for in the sketch's own folder, in that of the kernel that declares it, and in
    ``glsl/``; a path from anywhere else works only when it is absolute, which a sketch's
    file may not be (``load`` and ``--set`` see to that). Raises ``DataError`` with the nearest name.
    """
    if not text:
        raise DataError(f"{parameter} names no file")
    key = (find_file, text, folder, declared_in)
    known: _Found | None = FILES.get(key)
    if known is not None and known.holds():
        return known.file
    path = Path(text)
    places = [Path(folder), Path(declared_in).parent, GLSL]
    if path.is_absolute():
        if path.is_file():
            return path
        places = []
    for number, place in enumerate(places):
        candidate = (place / path).resolve()
        roots = [root.resolve() for root in (named_root(candidate), Path(folder), GLSL) if root is not None]
        if candidate.is_file() and any(map(candidate.is_relative_to, roots)):
            outside = outside_sidecar(candidate, roots)
            if outside is not None:
                message = f"{parameter}: {outside.name} next to it leads out of the sketch's folder"
                raise DataError(message, file=shown(candidate))
            identity = _identity(candidate)
            if identity is not None and not sidecar_places(candidate):  # those may come, and lead elsewhere
                earlier = tuple([before / path for before in places[:number]])
                FILES.put(key, _Found(earlier, place / path, candidate, identity))
            return candidate
    folders = [(place / path).parent for place in places] or [path.parent]
    near = sorted(
        {p.name for folder in folders if folder.is_dir() for p in folder.iterdir() if p.suffix in _DATA}
    )
    what = next(filter(None, map(irregularity, [*(place / path for place in places), path])), "")
    message = what or f"there is no such file{nearest(path.name, near)}"
    raise DataError(f"{parameter}: {message}", file=shown(path))
