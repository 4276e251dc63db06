"""Find the files that a sketch's parameters name, and know when they have changed."""

from __future__ import annotations

import hashlib
import time
from functools import lru_cache
from pathlib import Path

from playground.errors import DataError, nearest
from playground.paths import GLSL, shown

_IMAGES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff", ".npy", ".npz", ".r16", ".raw", ".hgt")

_TICK = 50_000_000  # [ns] more than a file system's clock takes to move on


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
            return candidate
    folders = [(place / path).parent for place in places] or [path.parent]
    near = sorted(
        {p.name for folder in folders if folder.is_dir() for p in folder.iterdir() if p.suffix in _IMAGES}
    )
    what = "this is a folder, not a file" if path.is_dir() else "there is no such file"
    raise DataError(f"{parameter}: {what}{nearest(path.name, near)}", file=shown(path))


def content_hash(path: Path) -> str:
    """Return a hash of a file's contents, worked out anew when its time, size or identity changes."""
    try:
        stat = path.stat()
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", file=shown(path)) from None
    # Two saves may fall into one tick of a file system's clock: what is so new is not remembered.
    is_new = abs(time.time_ns() - stat.st_mtime_ns) < _TICK
    work_out = _hash.__wrapped__ if is_new else _hash
    return work_out(str(path), stat.st_mtime_ns, stat.st_size, stat.st_ino)


@lru_cache(maxsize=256)
def _hash(path: str, modified: int, size: int, inode: int) -> str:
    digest = hashlib.blake2b(digest_size=16)
    with Path(path).open("rb") as handle:
        while block := handle.read(1 << 20):
            digest.update(block)
    return digest.hexdigest()
