"""Pack a sketch with all that it needs into one zip; ``playground.sketch.find`` opens it.

In it are the sketch's own texts, the images and elevation files that its values, presets,
shots and keyframes name, references, and a README and a licence of its folder. Of what ships
with the playground there are the names, and the version that it was packed with; of libraries
that the user named, the names alone: their licences may forbid to pass them on.

The same files give the same bytes: names are sorted, dates are fixed, nothing says who
packed it or when. (Deflate is zlib's: another version of it may write other bytes.)
"""

from __future__ import annotations

import json
import zipfile
from collections.abc import Iterable
from pathlib import Path

from playground._version import __version__
from playground.errors import DataError
from playground.files import read_regular, reason, replacing
from playground.paths import shown
from playground.shader.libraries import libraries_of
from playground.sketch.files import contents, folder_of
from playground.sketch.find import FORMAT, MANIFEST, MAX_BYTES, MAX_FILES
from playground.sketch.model import Sketch

_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip can say
_PLAIN_FILE = 0o100644 << 16
_UNIX = 3


def pack(sketch: Sketch, path: str | Path, further: Iterable[tuple[Path, str]] = ()) -> Path:
    """Write a sketch and its files as a zip, whole or not at all, and return its path.

    ``further`` are files with their names in the sketch's folder, as its references. Raises
    ``DataError`` in a message for a file that is missing, that lies outside the sketch's
    folder, and for more than can be unpacked again.
    """
    files, main, shipped = contents(sketch)
    for file, name in further:
        files.setdefault(f"{folder_of(sketch)}/{name}", file)
    manifest = {"format": FORMAT, "sketch": main, "version": __version__, "shipped": shipped}
    if left_out := sorted(libraries_of(sketch.files)):
        manifest["libraries"] = left_out
    if len(files) >= MAX_FILES:
        raise DataError(f"has {len(files)} files; a pack holds at most {MAX_FILES}", file=shown(sketch.file))
    try:
        size = sum(file.stat().st_size for file in files.values())
        if size > MAX_BYTES - 2**20:
            raise DataError(
                f"its files take {size / 2**20:.0f} MiB; a pack holds at most {MAX_BYTES // 2**20}",
                file=shown(sketch.file),
            )
        with replacing(path) as handle, zipfile.ZipFile(handle, "w") as archive:
            text = (json.dumps(manifest, indent=1, ensure_ascii=False) + "\n").encode()
            made = {MANIFEST: text}
            if main.count("/") > 1:  # what marks the folder that a shader inside it may read
                made[f"{folder_of(sketch)}/sketch.toml"] = b""
            for name in sorted({*files, *made}):
                data = read_regular(files[name]) if name in files else made[name]
                archive.writestr(zip_entry(name), data, zipfile.ZIP_DEFLATED, 9)
    except OSError as error:
        raise DataError(f"cannot be packed: {reason(error)}", file=error.filename or path) from None
    return Path(path)


def zip_entry(name: str) -> zipfile.ZipInfo:
    """Return the entry of a plain file, with a fixed date: the same files give the same bytes."""
    entry = zipfile.ZipInfo(name, _DATE)
    entry.create_system, entry.external_attr = _UNIX, _PLAIN_FILE
    entry.compress_type = zipfile.ZIP_DEFLATED
    return entry
