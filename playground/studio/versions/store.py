"""Keep the versions of one sketch in a folder of its own in the user's state folder.

``versions.json`` lists them, the oldest first; texts and pictures are files beside it, named by a hash of
what they hold, so that a text that many versions have is stored once. What is in the list is complete: texts
and pictures are written before it, and removed after it.

Two windows on one sketch may both keep: each change reads the list again under a lock that is held for that
change alone. A list that cannot be read is set aside with its whole folder, and a new one begins.
"""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import DataError
from playground.files import make_folder, read_regular, write_file, writing
from playground.json_text import read_json
from playground.paths import state_folder
from playground.sketch.model import Camera
from playground.studio.edits.edits import Edits, FileValue, StoredEdits
from playground.studio.edits.memory import locked, typed
from playground.studio.language import tr
from playground.studio.start.thumbnails import shrunk

FORMAT = 1
MAX_VERSIONS = 200
"""Versions of one sketch; the oldest without a name go first."""
MAX_BYTES = 50 * 2**20
"""Bytes that the versions of one sketch may take."""

_MAX_LIST = 16 * 2**20  # [bytes]
_PATIENCE = 0.3  # [s] for another window that is writing
_QUALITY = 85


@dataclass(frozen=True)
class State:
    """What a version holds besides its texts: what was edited, and repeats that were stopped early."""

    edits: Edits = field(default_factory=Edits)
    in_file: tuple[tuple[str, FileValue], ...] = ()  # what the files set for each edited value
    camera_in_file: Camera | None = None  # the file's, where another was edited
    steps: tuple[tuple[str, int], ...] = ()

    @property
    def start(self) -> StoredEdits:
        """The edits, as a draft begins with them."""
        return StoredEdits(self.edits, dict(self.in_file), self.camera_in_file)


@dataclass(frozen=True)
class Version:
    """One version; ``key`` is a hash of its texts and its state."""

    key: str
    at: float  # [s since the epoch] when it was kept last
    main: str  # the sketch's file, relative to its folder
    texts: tuple[tuple[str, str], ...]  # file relative to the sketch's folder → hash of what it holds
    written: str = "{}"  # its state as JSON: of hundreds that are listed few are asked for it
    name: str = ""  # one that has a name is kept until that is taken away

    @cached_property
    def state(self) -> State:
        """What it holds besides its texts; raises ``DataError`` where that cannot be read."""
        try:
            state: State = typed(State, read_json(self.written))
        except (ValueError, TypeError, KeyError, AttributeError, ArithmeticError) as error:
            raise DataError(f"the values of this version cannot be read: {error}") from None
        return state


def _version(row: dict[str, Any]) -> Version:
    """Return a row of the list; raise ``KeyError``, ``TypeError`` or ``ValueError`` for what is none."""
    texts = tuple((name, digest) for name, digest in row["texts"])
    version = Version(row["key"], float(row["at"]), row["main"], texts, row["written"], row["name"])
    words = [
        version.key,
        version.main,
        version.written,
        version.name,
        *(word for pair in texts for word in pair),
    ]
    if not all(isinstance(word, str) for word in words):
        raise TypeError("a version in it is none")
    return version


class VersionStore:
    """The versions of the sketch in a file."""

    def __init__(
        self,
        sketch: Path,
        folder: Path | None = None,
        *,
        most: int = MAX_VERSIONS,
        most_bytes: int = MAX_BYTES,
    ) -> None:
        whole = str(sketch.resolve())
        digest = hashlib.blake2b(whole.encode("utf-8", "surrogatepass"), digest_size=6).hexdigest()
        self.sketch = sketch
        self.folder = (folder or state_folder() / "versions") / f"{sketch.stem[:40]}-{digest}"
        self.complaint = ""  # why the list was set aside; empty once it was taken
        self._most, self._most_bytes = most, most_bytes
        self._list = self.folder / "versions.json"
        self._read: tuple[tuple[int, int, int] | None, tuple[Version, ...]] = (None, ())

    # ── reading ──────────────────────────────────────────────────────────────

    def versions(self) -> tuple[Version, ...]:
        """Return all versions, the oldest first; those that another window kept, too."""
        signature = self._signature()
        if self._read[0] != signature:
            self._read = signature, self._versions()
        return self._read[1]

    def _signature(self) -> tuple[int, int, int] | None:
        try:
            status = self._list.stat()
        except OSError:
            return None
        return status.st_ino, status.st_mtime_ns, status.st_size

    def _versions(self) -> tuple[Version, ...]:
        try:
            if self._list.stat().st_size > _MAX_LIST:
                raise ValueError(f"it is larger than {_MAX_LIST // 2**20} MiB")
            table = read_json(read_regular(self._list).decode())
            if table["format"] != FORMAT:
                raise ValueError(f"it has format {table['format']}, and this version knows {FORMAT}")
            return tuple(map(_version, table["versions"]))
        except FileNotFoundError:
            return ()
        except (OSError, ValueError, TypeError, KeyError, AttributeError, ArithmeticError) as error:
            self._set_aside(error)
            return ()

    def _set_aside(self, error: Exception) -> None:
        """Rename the folder to ``NAME.unread``, numbered where that is taken."""
        base, number = self.folder.with_name(self.folder.name + ".unread"), 2
        aside = base
        while aside.exists():
            aside, number = base.with_name(f"{base.name}-{number}"), number + 1
        why = f" ({error})" if str(error) else ""
        try:
            self.folder.rename(aside)
        except OSError:
            self.complaint = tr(
                "the versions of this sketch cannot be read nor set aside: {folder}{why}",
                folder=self.folder,
                why=why,
            )
        else:
            self.complaint = tr(
                "the versions of this sketch cannot be read; they are in {folder}{why}", folder=aside, why=why
            )

    def texts(self, version: Version) -> dict[str, bytes]:
        """Return what a version's files hold, by their names; raise ``DataError`` where one is damaged."""
        contents = {}
        for name, digest in version.texts:
            path = self._text(digest)
            try:
                data = read_regular(path)
            except OSError as error:
                reason = error.strerror or str(error)
                raise DataError(f"{name} of this version cannot be read: {reason}", file=path) from None
            if hash_of_text(data) != digest:
                raise DataError(f"{name} of this version is damaged", file=path)
            contents[name] = data
        return contents

    def picture(self, version: Version) -> Path:
        """Return the file of a version's small picture; it may be missing."""
        return self.folder / "pictures" / f"{version.key}.jpg"

    # ── changes ──────────────────────────────────────────────────────────────

    def keep(
        self,
        main: str,
        texts: Mapping[str, bytes],
        state: State,
        *,
        pixels: NDArray[np.uint8] | None = None,
        name: str = "",
        at: float | None = None,
    ) -> Version:
        """Keep a version, and remove the oldest without a name where there are too many; return it.

        ``texts`` by names relative to the sketch's folder, ``pixels``: (height, width, 3 or 4), top row
        first. One of the same texts and state becomes the newest, with its name and, where there are no
        pixels, its picture. Raises ``DataError`` where it cannot be kept: nothing has changed then.
        """
        if sum(map(len, texts.values())) > self._most_bytes:
            raise DataError(f"its texts are larger than {self._most_bytes / 2**20:g} MiB", file=self.sketch)
        hashes = tuple((file, hash_of_text(data)) for file, data in sorted(texts.items()))
        at = time.time() if at is None else at
        version = Version(key_of(main, hashes, state), at, main, hashes, _written(state))
        with self._locked():
            rows = list(self.versions())
            before = next((row for row in rows if row.key == version.key), None)
            version = replace(version, name=name or (before.name if before else ""))
            if name:
                self._check_named([*rows, version], version)
            with writing(self.folder):
                for file, digest in hashes:
                    path = self._text(digest)
                    if not path.is_file():
                        make_folder(path.parent)
                        write_file(path, texts[file])
                if pixels is not None:
                    self._write_picture(version, pixels)
            self._write([*(row for row in rows if row.key != version.key), version], spared=version.key)
        return version

    def rename(self, key: str, name: str) -> None:
        """Give a version a name, or with "" take it away; raise ``DataError`` where that cannot be."""
        with self._locked():
            rows = [replace(row, name=name) if row.key == key else row for row in self.versions()]
            if name:
                self._check_named(rows, next((row for row in rows if row.key == key), None))
            self._write(rows)

    def remove(self, key: str) -> None:
        """Remove a version; raise ``DataError`` where that cannot be."""
        with self._locked():
            self._write([row for row in self.versions() if row.key != key])

    def _check_named(self, rows: Sequence[Version], version: Version | None) -> None:
        """Raise ``DataError`` where versions with a name would take all the room."""
        named = {row.key: row for row in rows if row.name}
        if version is not None and len(named) > self._most:
            message = f"{self._most} versions have names; take the name from another, or remove one"
            raise DataError(message, file=self.sketch)

    def _write(self, rows: list[Version], spared: str = "") -> None:
        """Write the list without the versions that there are too many of, then remove what is not in it."""
        sizes = self._sizes()
        while len(rows) > self._most or _bytes_of(rows, sizes) > self._most_bytes:
            oldest = next((row for row in rows if not row.name and row.key != spared), None)
            if oldest is None:
                break
            rows.remove(oldest)
        make_folder(self.folder)
        table = {"format": FORMAT, "sketch": str(self.sketch), "versions": [_row(row) for row in rows]}
        text = json.dumps(table, ensure_ascii=False, separators=(",", ":"))
        write_file(self._list, text.encode("utf-8", "surrogatepass"))
        self._read = self._signature(), tuple(rows)
        used = {name for row in rows for name in _files_of(row)}
        for name in sizes.keys() - used:
            with suppress(OSError):
                (self.folder / name).unlink(missing_ok=True)

    def _sizes(self) -> dict[str, int]:
        """Return the size of each text and picture [bytes], by its name in the folder."""
        sizes: dict[str, int] = {}
        for part in ("texts", "pictures"):
            with suppress(OSError), os.scandir(self.folder / part) as entries:
                sizes |= {f"{part}/{entry.name}": entry.stat().st_size for entry in entries}
        return sizes

    def _write_picture(self, version: Version, pixels: NDArray[np.uint8]) -> None:
        from io import BytesIO

        from PIL import Image

        data = BytesIO()
        shrunk(Image.fromarray(np.ascontiguousarray(pixels[..., :3]))).save(data, "jpeg", quality=_QUALITY)
        path = self.picture(version)
        make_folder(path.parent)
        write_file(path, data.getvalue())

    def _text(self, digest: str) -> Path:
        return self.folder / "texts" / digest

    @contextmanager
    def _locked(self) -> Iterator[None]:
        """Let no other window change the list in the block; raise ``DataError`` where one does for long."""
        make_folder(self.folder.parent)
        path, end = self.folder.with_name(self.folder.name + ".lock"), time.monotonic() + _PATIENCE
        with writing(path), path.open("a+b") as lock:
            while not locked(lock):
                if time.monotonic() > end:
                    raise DataError("another window is writing the versions of this sketch", file=path)
                time.sleep(0.005)
            yield


def key_of(main: str, hashes: Sequence[tuple[str, str]], state: State) -> str:
    """Return what tells a version from every other."""
    table = json.dumps([main, list(hashes), _written(state)])
    return hashlib.blake2b(table.encode("utf-8", "surrogatepass"), digest_size=12).hexdigest()


def _written(state: State) -> str:
    return json.dumps(asdict(state), sort_keys=True, separators=(",", ":"))


def _row(version: Version) -> dict[str, object]:
    names = ("key", "at", "main", "texts", "written", "name")
    return {name: getattr(version, name) for name in names}


def hash_of_text(data: bytes) -> str:
    """Return what a text is stored as."""
    return hashlib.blake2b(data, digest_size=16).hexdigest()


def _files_of(version: Version) -> set[str]:
    return {f"texts/{digest}" for _, digest in version.texts} | {f"pictures/{version.key}.jpg"}


def _bytes_of(rows: Sequence[Version], sizes: Mapping[str, int]) -> int:
    return sum(sizes.get(name, 0) for name in {name for row in rows for name in _files_of(row)})
