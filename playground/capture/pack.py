"""Pack a sketch with all that it needs into one zip; ``playground.sketch.unpack`` opens it.

In it are the sketch's own texts, the images and elevation files that its values, presets,
shots and keyframes name, references, and a README and a licence of its folder. Of what ships
with the playground there are the names, and the version that it was packed with; of libraries
that the user named, the names alone: their licences may forbid to pass them on.

The same files give the same bytes: names are sorted, dates are fixed, nothing says who
packed it or when. (Deflate is zlib's: another version of it may write other bytes.)
"""

from __future__ import annotations

import json
import re
import zipfile
from collections.abc import Iterable, Iterator
from pathlib import Path

from playground._version import __version__
from playground.engine.files import find_file
from playground.errors import DataError
from playground.images.files import reason, replacing
from playground.paths import GLSL, SKETCHES, shown
from playground.sketch.allowed_files import is_inside
from playground.sketch.assign import resolve, values_of
from playground.sketch.libraries import libraries, libraries_of, library_around
from playground.sketch.load import is_technique
from playground.sketch.model import Sketch, Value, kernels_of
from playground.sketch.unpack import FORMAT, MANIFEST, MOST_BYTES, MOST_FILES

_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip can say
_PLAIN_FILE = 0o100644 << 16
_UNIX = 3
_DOCUMENTS = ("README*", "readme*", "LICENSE*", "LICENCE*")


def pack(sketch: Sketch, path: str | Path, further: Iterable[tuple[Path, str]] = ()) -> Path:
    """Write a sketch and its files as a zip, whole or not at all, and return its path.

    ``further`` are files with their names in the sketch's folder, as its references. Raises
    ``DataError`` in a sentence for a file that is missing, that lies outside the sketch's
    folder, and for more than can be unpacked again.
    """
    files, main, shipped = contents(sketch)
    for file, name in further:
        files.setdefault(f"{_folder_of(sketch)}/{name}", file)
    manifest = {"format": FORMAT, "sketch": main, "version": __version__, "shipped": shipped}
    if left_out := sorted(libraries_of(sketch.files)):
        manifest["libraries"] = left_out
    if len(files) >= MOST_FILES:
        raise DataError(f"has {len(files)} files; a pack holds at most {MOST_FILES}", file=shown(sketch.file))
    try:
        size = sum(file.stat().st_size for file in files.values())
        if size > MOST_BYTES - 2**20:
            raise DataError(
                f"its files take {size / 2**20:.0f} MiB; a pack holds at most {MOST_BYTES // 2**20}",
                file=shown(sketch.file),
            )
        with replacing(path) as handle, zipfile.ZipFile(handle, "w") as archive:
            text = (json.dumps(manifest, indent=1, ensure_ascii=False) + "\n").encode()
            for name in sorted({*files, MANIFEST}):
                data = text if name == MANIFEST else files[name].read_bytes()
                archive.writestr(_entry(name), data, zipfile.ZIP_DEFLATED, 9)
    except OSError as error:
        raise DataError(f"cannot be packed: {reason(error)}", file=error.filename or path) from None
    return Path(path)


def contents(sketch: Sketch) -> tuple[dict[str, Path], str, list[str]]:
    """Return the files to pack by their name in the zip, the name of the one to open, what ships.

    The last are files of ``glsl/``, named from there. Files of libraries that the user named are left out.
    """
    main, folder, top = Path(sketch.file), Path(sketch.folder), _folder_of(sketch)
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
        elif not library_around(file, libraries()):
            message = f"lies outside the sketch's folder, {shown(folder)}; copy it there to pack the sketch"
            raise DataError(message, file=shown(file))
    if not folder.is_relative_to(GLSL):
        for pattern in _DOCUMENTS:
            for file in sorted(folder.glob(pattern)):
                if file.is_file() and is_inside(file, (folder,)):
                    files[f"{top}/{file.name}"] = file
    return files, f"{top}/{first}", sorted(shipped)


def _folder_of(sketch: Sketch) -> str:
    return re.sub(r'[\x00-\x1f<>:"|?*\\/]+', "-", sketch.name).strip(" .") or "sketch"


def _data(sketch: Sketch) -> Iterator[Path]:
    """Yield the files that parameters name: as the sketch is, and in its presets, shots and keyframes."""
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
            yield find_file(str(value), sketch.folder, parameter.file, parameter.name)


def _entry(name: str) -> zipfile.ZipInfo:
    entry = zipfile.ZipInfo(name, _DATE)
    entry.create_system, entry.external_attr = _UNIX, _PLAIN_FILE
    entry.compress_type = zipfile.ZIP_DEFLATED
    return entry
