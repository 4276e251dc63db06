"""Find the files that a sketch's parameters name, and list those that a packed sketch holds."""

from __future__ import annotations

import re
import stat
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from playground.allowed_files import (
    ELEVATIONS,
    VECTORS,
    is_inside,
    named_root,
    outside_sidecar,
    sidecar_places,
    sidecars,
)
from playground.data.media import SOUND_FILES, VIDEO_FILES
from playground.errors import DataError, nearest
from playground.files import irregularity
from playground.memo import FILES
from playground.paths import GLSL, SKETCHES, shown
from playground.shader.libraries import libraries, library_around
from playground.sketch.arrays import holds_array
from playground.sketch.assign import resolve, values_of
from playground.sketch.load import is_technique
from playground.sketch.model import Sketch, Value, kernels_of

_IMAGES = (".jpg", ".jpeg", ".webp")
_DATA = {*_IMAGES, *ELEVATIONS, *VECTORS, *VIDEO_FILES, *SOUND_FILES}


class _FoundFile(NamedTuple):
    """A file that was found, and where."""

    earlier: tuple[Path, ...]  # places that are looked at before, where there was no file
    place: Path
    file: Path  # the place, its links followed
    identity: tuple[int, int]

    def holds(self) -> bool:
        """Return whether it would be found again."""
        if any(_identity(position) is not None for position in self.earlier):
            return False
        places = (self.place,) if self.place == self.file else (self.place, self.file)
        return all(_identity(position) == self.identity for position in places)


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
    cached: _FoundFile | None = FILES.get(key)
    if cached is not None and cached.holds():
        return cached.file
    path = Path(text)
    places = [Path(folder), Path(declared_in).parent, GLSL]
    if path.is_absolute():
        if path.is_file():
            return path
        places = []
    for number, path_root in enumerate(places):
        candidate = (path_root / path).resolve()
        roots = [root.resolve() for root in (named_root(candidate), Path(folder), GLSL) if root is not None]
        if candidate.is_file() and any(map(candidate.is_relative_to, roots)):
            outside = outside_sidecar(candidate, roots)
            if outside is not None:
                message = f"{parameter}: {outside.name} next to it leads out of the sketch's folder"
                raise DataError(message, file=shown(candidate))
            identity = _identity(candidate)
            if identity is not None and not sidecar_places(candidate):  # those may come, and lead elsewhere
                earlier = tuple([before / path for before in places[:number]])
                FILES.put(key, _FoundFile(earlier, path_root / path, candidate, identity))
            return candidate
    folders = [(path_root / path).parent for path_root in places] or [path.parent]
    near = sorted(
        {p.name for folder in folders if folder.is_dir() for p in folder.iterdir() if p.suffix in _DATA}
    )
    what = next(filter(None, map(irregularity, [*(path_root / path for path_root in places), path])), "")
    message = what or f"there is no such file{nearest(path.name, near)}"
    raise DataError(f"{parameter}: {message}", file=shown(path))


_DOCUMENTS = ("README*", "readme*", "LICENSE*", "LICENCE*")


def contents(sketch: Sketch) -> tuple[dict[str, Path], str, list[str]]:
    """Return the files to pack by their name in the zip, the name of the one to open, what ships.

    The last are files of ``glsl/``, named from there. Files of libraries that the user named are left out.
    """
    main, folder, top = Path(sketch.file), Path(sketch.folder), folder_of(sketch)
    alone = main.suffix != ".toml" or is_technique(main)
    # So that the folder opens by its own name, wherever it is unpacked by hand.
    first = main.relative_to(folder).as_posix() if alone else "sketch.toml"
    files, shipped = {f"{top}/{first}": main}, set[str]()
    for file in dict.fromkeys([*map(Path, sketch.files), *_data(sketch)]):
        if file == main:
            continue
        own = file.is_relative_to(folder) and (not file.is_relative_to(GLSL) or file.is_relative_to(SKETCHES))
        if own:
            if not is_inside(file, (folder,)):
                raise DataError(f"leads out of the sketch's folder, {shown(folder)}", file=shown(file))
            files[f"{top}/{file.relative_to(folder).as_posix()}"] = file
        elif is_inside(file, (GLSL,)):
            shipped.add(file.resolve().relative_to(GLSL.resolve()).as_posix())
        elif holds_array(file):
            message = (
                "it has an array, which cannot be packed: save a copy, which has it as a file, and pack that"
            )
            raise DataError(message, file=shown(sketch.file))
        elif not library_around(file, libraries()):
            message = f"lies outside the sketch's folder, {shown(folder)}; copy it there to pack the sketch"
            raise DataError(message, file=shown(file))
    if not folder.is_relative_to(GLSL):
        for pattern in _DOCUMENTS:
            for file in sorted(folder.glob(pattern)):
                if file.is_file() and is_inside(file, (folder,)):
                    files[f"{top}/{file.name}"] = file
    return files, f"{top}/{first}", sorted(shipped)


def folder_of(sketch: Sketch) -> str:
    """Return the name of the folder that a sketch is packed in."""
    return re.sub(r'[\x00-\x1f<>:"|?*\\/]+', "-", sketch.name).strip(" .") or "sketch"


def _data(sketch: Sketch) -> Iterator[Path]:
    """Yield the files that parameters name: as the sketch is, and in its presets, shots and keyframes.

    After each come the files next to it that say how to read it.
    """
    values = values_of(sketch)
    declared = {
        f"{prefix}.{parameter.name}": parameter
        for prefix, kernel in kernels_of(sketch.graph)
        for parameter in kernel.parameters
        if parameter.widget.kind == "file"
    }
    named: list[tuple[str, Value]] = [(path, values[path]) for path in declared]
    groups = [some.values for kind in (sketch.presets, sketch.shots, sketch.keyframes) for some in kind]
    for path, value in (pair for group in groups for pair in group):
        if isinstance(value, str):
            named += [(target.path, value) for target in resolve(sketch.graph, path)]
    for path, value in named:
        if value and path in declared:
            parameter = declared[path]
            file = find_file(str(value), sketch.folder, parameter.file, parameter.name)
            yield file
            yield from sidecars(file)
