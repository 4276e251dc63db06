"""Which files a sketch depends on, so that they can be watched, and which of its data have been drawn with.

New contents of an image or an elevation file go through the sandbox first: what they do to their reader is
not known yet, and a process of its own finds out.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from pathlib import Path

from playground.allowed_files import Signature, sidecar_places
from playground.data.content_hash import content_hash
from playground.errors import DataError, PlaygroundError
from playground.memo import INTERFACE
from playground.paths import GLSL, current_folder, without_part
from playground.sketch.assign import values_of
from playground.sketch.files import find_file
from playground.sketch.model import Sketch
from playground.sketch.traits import traits_of


def files_of(sketch: Sketch) -> frozenset[Path]:
    """Return every file of a sketch: its texts, and the images and elevation files its parameters name.

    A file that is missing is among them, where it is expected.
    """
    return _paths(sketch.files) | data_files(sketch)


@INTERFACE.cached(weight=16)
def _paths(names: tuple[str, ...]) -> frozenset[Path]:
    """Return paths: the same objects for the same names, whose hashes are worked out once."""
    return frozenset(map(Path, names))


def data_files(sketch: Sketch) -> frozenset[Path]:
    """Return the images and elevation files that a sketch's parameters name, there or missing.

    With each come the files next to it that say how to read it, there or missing.
    """
    paths: set[Path] = set()
    parameters = traits_of(sketch).files
    values = values_of(sketch) if parameters else {}
    for path, parameter in parameters:
        text = values.get(path)
        if not text:
            continue
        try:
            file = find_file(str(text), sketch.folder, parameter.file, parameter.name)
        except DataError:
            file = Path(sketch.folder, str(text))
        paths |= {file, *sidecar_places(file)}
    return frozenset(paths)


def watched(
    path: Path,
    sketches: Iterable[Sketch],
    errors: Iterable[PlaygroundError],
    places: Mapping[Path, Signature | None],
) -> frozenset[Path]:
    """Return every file worth watching for the sketch in a file.

    ``places`` are where its files were looked for, and what was there. One where nothing
    is counts inside the sketch's folder and the library only: nothing else is likely to come
    from elsewhere.
    """
    # As texts: hundreds of places are compared at each save, and parts of paths take ten times as long.
    roots = tuple(os.path.normcase(f"{root}{os.sep}") for root in (path.resolve().parent, GLSL))
    files = {path}
    files |= {p for p, there in places.items() if there or os.path.normcase(p).startswith(roots)}
    for sketch in sketches:
        files |= files_of(sketch)
    for error in errors:
        files |= files_named_by(error)
    return frozenset(files)


def files_named_by(error: PlaygroundError) -> frozenset[Path]:
    """Return the files that an error points at; those of its includes as well."""
    named = [d.file for d in error.diagnostics]
    named += [location.rpartition(":")[0] for d in error.diagnostics for location in d.chain]
    return frozenset(path_named(name) for name in filter(None, named))


def path_named(name: str) -> Path:
    """Return the file that a diagnostic names, as its user would, as an absolute path."""
    name = without_part(name)
    here = current_folder() / name
    path = GLSL / name.removeprefix("glsl/") if name.startswith("glsl/") else here
    return path if path.is_file() else here


class DataFiles:
    """The files that one session has drawn with."""

    def __init__(self) -> None:
        self._hashes: dict[Path, str] = {}  # a hash of the contents
        self._own: set[Path] = set()  # written by this process

    def trust(self, path: Path) -> None:
        """Take a file that this process writes for good: it needs no sandbox."""
        self._own.add(path)

    def are_new(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with; a newer date alone is no new data."""
        return any(
            path not in self._own and self._hashes.get(path) != hash_of(path) for path in data_files(sketch)
        )

    def take(self, sketch: Sketch) -> None:
        """Remember the data that a sketch was drawn with."""
        self._hashes.update((path, hash_of(path)) for path in data_files(sketch))


def hash_of(path: Path) -> str:
    """Return a hash of a file's contents; empty where it cannot be read."""
    try:
        return content_hash(path)
    except (PlaygroundError, OSError):
        return ""
