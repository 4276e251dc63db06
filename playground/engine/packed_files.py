"""List what a packed sketch holds: its own files, those that its values name; and what ships, by name."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

from playground.allowed_files import is_inside, sidecars
from playground.engine.files import find_file
from playground.errors import DataError
from playground.paths import GLSL, SKETCHES, shown
from playground.shader.libraries import libraries, library_around
from playground.sketch.arrays import holds_array
from playground.sketch.assign import resolve, values_of
from playground.sketch.load import is_technique
from playground.sketch.model import Sketch, Value, kernels_of

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


def has_arrays(sketch: Sketch) -> bool:
    """Return whether a sketch has arrays from Python, which no file of its own has."""
    return any(isinstance(value, str) and holds_array(value) for _, value in sketch.overrides)


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
