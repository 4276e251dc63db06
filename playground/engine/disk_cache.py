"""Cache the textures of passes on disk by what they are computed from, so that a sketch reopens at once.

A file holds the textures of one pass: a header of JSON, the texels as they are, a checksum. Its name is
a hash of the pass's key (see ``cache_keys``) and of what computed it: the build of the renderer and this
version of the playground, down to its own Python files. So nothing here is ever out of date; when the
bound in bytes is reached, the least recently used files go first.

A file is written under a temporary name and then renamed, so that another process sees all of it
or nothing. One that is damaged, cut short or not ours is dropped, and the terrain is computed.
``disk_caching`` chooses the passes that are worth it, reads and writes their textures.
"""

from __future__ import annotations

import hashlib
import json
import os
import queue
import struct
import threading
import time
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import IO, Any

from playground import paths
from playground._version import __version__
from playground.engine.context import ContextInfo, build_of
from playground.engine.textures import bytes_of, levels_of
from playground.errors import ParameterError, PlaygroundError
from playground.files import replacing
from playground.json_text import read_json
from playground.paths import cache_folder

LIMIT = 2**30  # [bytes] unless the environment says another
VARIABLE = "PLAYGROUND_CACHE"
MAX_FILES = 4096  # files, however small
SHARE = 4  # no file takes more than a quarter of the bound

_MAGIC = b"playground land 1\n"
_ENDING = ".land"
_PART = ".part"
_ABANDONED = 3600.0  # [s] after which a half-written file is removed
_MAX_HEADER_BYTES = 2**16  # [bytes]
_UNITS = {"": 1, "K": 2**10, "M": 2**20, "G": 2**30, "T": 2**40}
_ROOMS = ("data", "engine", "shader", "sketch")  # whose Python decides what a pass computes


@dataclass(frozen=True)
class CachedTextures:
    """The textures of one pass, and where they came from."""

    size: tuple[int, int]  # texels
    outputs: tuple[tuple[str, str], ...]  # name and format of each
    cost: float  # [ms] that they took to compute, with all that they depend on
    made_for: str = ""  # sketch and pass, for people: the key knows neither
    data: tuple[memoryview, ...] = field(default=(), repr=False)  # of each output; none where only listed
    mipmapped: frozenset[str] = frozenset()  # outputs whose texels are followed by those of their mipmaps

    @property
    def bytes(self) -> int:
        """Bytes of its texels, mipmaps included."""
        return sum(self.bytes_of_output(name, form) for name, form in self.outputs)

    def bytes_of_output(self, name: str, form: str) -> int:
        """Bytes of an output's texels, mipmaps included."""
        levels = levels_of(self.size) if name in self.mipmapped else [self.size]
        return sum(bytes_of(level, form) for level in levels)


@dataclass(frozen=True)
class Listed:
    """A file of the cache."""

    path: Path
    bytes: int  # of the file
    used: float  # [s since the epoch] when it was read or written last
    textures: CachedTextures | None  # None: it cannot be read


def cache_directory() -> Path:
    """Return the folder that holds the files."""
    return cache_folder() / "land"


def limit_in(environment: Mapping[str, str] = os.environ) -> int:
    """Return the bound [bytes] that the environment sets, 0 for no disk cache; raise ``ParameterError``."""
    setting = environment.get(VARIABLE, "").strip()
    if not setting:
        return LIMIT
    text = setting.upper().removesuffix("IB").removesuffix("B")
    unit = text[-1:] if text[-1:] in _UNITS else ""
    try:
        number = 0.0 if text == "OFF" else float(text.removesuffix(unit))
    except ValueError:
        number = -1.0
    if not 0 <= number < 1e15:
        raise ParameterError(f"{VARIABLE}={setting}: expected a size, as 500M or 2G, or 0 to cache nothing")
    return int(number * _UNITS[unit])


class DiskCache:
    """The files, for one build of a renderer; its own thread writes them."""

    def __init__(self, folder: Path, *, limit: int = LIMIT, made_by: str = "") -> None:
        self.folder = folder
        self.limit = limit  # [bytes]
        self.trouble = ""  # why files can no longer be written, as a message
        self._made_by = made_by
        self._waiting: queue.SimpleQueue[tuple[str, CachedTextures] | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None

    def __contains__(self, key: str) -> bool:
        return self.path_of(key).exists()

    def read(self, key: str) -> CachedTextures | None:
        """Return what is cached under a key, checked, and mark it as used; None if there is nothing."""
        path = self.path_of(key)
        try:
            with path.open("rb") as file:
                textures = _read(file, key)
        except OSError:
            return None
        if textures is None:
            _drop(path)
            return None
        with suppress(OSError):
            os.utime(path)
        return textures

    def fits(self, size: int) -> bool:
        """Return whether so many bytes of texels may be cached."""
        return not self.trouble and size <= self.limit // SHARE

    def write(self, key: str, textures: CachedTextures) -> None:
        """Have a thread write textures; ``trouble`` says why where it cannot."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._write_all, name="store", daemon=True)
            self._thread.start()
        self._waiting.put((key, textures))

    def close(self, patience: float = 30.0) -> None:
        """Wait until all is written, for so many seconds at most."""
        if self._thread is not None:
            self._waiting.put(None)
            self._thread.join(patience)
            self._thread = None

    def path_of(self, key: str) -> Path:
        """Return the file of a key, whether it exists or not."""
        name = hashlib.blake2b(f"{self._made_by} {key}".encode(), digest_size=16).hexdigest()
        return self.folder / f"{name}{_ENDING}"

    def _write_all(self) -> None:
        while (work := self._waiting.get()) is not None:
            key, textures = work
            path = self.path_of(key)
            try:
                self.folder.mkdir(parents=True, exist_ok=True)
                with replacing(path) as file:
                    for part in _written(key, textures):
                        file.write(part)
            except (PlaygroundError, OSError) as error:
                # Where it exists, another session wrote it, and reads it: Windows then refuses to rename.
                if not path.exists():
                    self.trouble = f"terrain cannot be cached on disk: {error}"
                continue
            trim(self.folder, self.limit)


def disk_cache_for(renderer: ContextInfo, limit: int, folder: Path | None = None) -> DiskCache:
    """Return the disk cache of a renderer's build, in the user's cache unless a folder is named."""
    return DiskCache(folder or cache_directory(), limit=limit, made_by=repr((build_of(renderer), tool())))


@cache
def tool() -> str:
    """Return a hash of what decides a texture besides the driver: our own files, what reads images."""
    versions: list[object] = [__version__]
    # Another version of a package is another file; importlib.metadata takes 30 ms to be imported.
    for package in ("moderngl", "numpy", "PIL", "rasterio", "tifffile"):
        spec = find_spec(package)
        if spec is not None and spec.origin is not None:
            status = Path(spec.origin).stat()
            versions.append((spec.origin, status.st_size, status.st_mtime_ns))
    home = Path(paths.__file__).parent
    for path in sorted(path for room in _ROOMS for path in (home / room).rglob("*.py")):
        status = path.stat()
        versions.append((path.name, status.st_size, status.st_mtime_ns))
    return hashlib.blake2b(repr(versions).encode(), digest_size=16).hexdigest()


def listed(folder: Path) -> list[Listed]:
    """Return the files of a disk cache, those used last first."""
    entries = []
    for entry, status in _entries(folder):
        path = Path(entry.path)
        try:
            with path.open("rb") as file:
                textures = _head(file)[1]
        except (OSError, ValueError):
            textures = None
        entries.append(Listed(path, status.st_size, status.st_mtime, textures))
    return sorted(entries, key=lambda each: -each.used)


def bytes_in(folder: Path) -> tuple[int, int]:
    """Return how many files a disk cache holds, and their bytes."""
    sizes = [status.st_size for _, status in _entries(folder)]
    return len(sizes), sum(sizes)


def clear(folder: Path) -> tuple[int, int]:
    """Remove the files of a disk cache; return how many went, and their bytes. Other files stay."""
    number, size = 0, 0
    for entry, status in _entries(folder):
        if _drop(Path(entry.path)):
            number, size = number + 1, size + status.st_size
    _drop_abandoned(folder)
    return number, size


def trim(folder: Path, limit: int, most: int = MAX_FILES) -> None:
    """Remove what was used least recently until the bounds hold, and what was left half-written."""
    entries = sorted(_entries(folder), key=lambda each: each[1].st_mtime, reverse=True)
    total = 0
    for number, (entry, status) in enumerate(entries):
        total += status.st_size
        if total > limit or number >= most:
            _drop(Path(entry.path))
    _drop_abandoned(folder)


def _drop_abandoned(folder: Path) -> None:
    """Remove what was left half-written; what is new may be another session's."""
    for entry, status in _entries(folder, _PART):
        if time.time() - status.st_mtime > _ABANDONED:
            _drop(Path(entry.path))


def _entries(folder: Path, ending: str = _ENDING) -> Iterator[tuple[os.DirEntry[str], os.stat_result]]:
    try:
        entries = list(os.scandir(folder))
    except OSError:
        return
    for entry in entries:
        if entry.name.endswith(ending):
            with suppress(OSError):  # another session may have removed it
                yield entry, entry.stat()


def _drop(path: Path) -> bool:
    try:
        path.unlink()
    except OSError:  # it is gone, or another session has it open on Windows
        return False
    return True


def _written(key: str, textures: CachedTextures) -> Iterator[bytes | memoryview]:
    header = json.dumps(
        {
            "key": key,
            "size": textures.size,
            "outputs": textures.outputs,
            "cost": round(textures.cost, 3),
            "made_for": textures.made_for,
            "mipmapped": sorted(textures.mipmapped),
        }
    ).encode()
    checksum = 0
    parts: list[bytes | memoryview] = [_MAGIC, struct.pack("<I", len(header)), header, *textures.data]
    for part in parts:
        checksum = zlib.crc32(part, checksum)
        yield part
    yield struct.pack("<I", checksum)


def _head(file: IO[bytes]) -> tuple[bytes, CachedTextures, str]:
    """Return a file's first bytes, its textures without texels, and the key; raise ``ValueError``."""
    start = file.read(len(_MAGIC) + 4)
    if len(start) < len(_MAGIC) + 4 or not start.startswith(_MAGIC):
        raise ValueError("not a file of the disk cache")
    (length,) = struct.unpack("<I", start[len(_MAGIC) :])
    if length > _MAX_HEADER_BYTES:
        raise ValueError("not a header")
    header = file.read(length)
    try:
        table: dict[str, Any] = read_json(header)
        width, height = (int(side) for side in table["size"])
        outputs = tuple((str(name), str(form)) for name, form in table["outputs"])
        mipmapped = frozenset(str(name) for name in table.get("mipmapped", ()))
        textures = CachedTextures(
            (width, height), outputs, float(table["cost"]), str(table["made_for"]), mipmapped=mipmapped
        )
        if min(width, height) < 1 or textures.bytes < 1:
            raise ValueError("no texels")
        return start + header, textures, str(table["key"])
    except (TypeError, KeyError, ArithmeticError) as error:
        raise ValueError(f"not a header: {error}") from None


def _read(file: IO[bytes], key: str) -> CachedTextures | None:
    """Return what a file holds; None if it is not whole, or of another key."""
    try:
        head, textures, named = _head(file)
    except ValueError:
        return None
    if named != key or os.fstat(file.fileno()).st_size != len(head) + textures.bytes + 4:
        return None
    body = memoryview(file.read())
    if len(body) != textures.bytes + 4:
        return None
    if zlib.crc32(body[:-4], zlib.crc32(head)) != struct.unpack("<I", body[-4:])[0]:
        return None
    parts, start = [], 0
    for name, form in textures.outputs:
        length = textures.bytes_of_output(name, form)
        parts.append(body[start : start + length])
        start += length
    return replace(textures, data=tuple(parts))
