"""Which files a sketch may read: its own folder, ``glsl/``, and the sidecars of its data files.

Sources: ESRI, "BIL, BIP, and BSQ raster files" (ArcGIS Desktop help); ESRI (1998), "Shapefile Technical
Description"; GDAL, "PAM (Persistent Auxiliary Metadata)" and "VRT -- GDAL Virtual Format".

A stranger's sketch is data; nothing it names may come from elsewhere on the disk. Paths
that the user types are the user's own affair and are not judged here.
"""

from __future__ import annotations

import os
import re
import stat
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath, PureWindowsPath
from types import MappingProxyType
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from playground.files import read_regular
from playground.memo import FILES
from playground.paths import GLSL, shown

if TYPE_CHECKING:
    from xml.etree import ElementTree

AUXILIARY = ".aux.xml"
"""What GDAL appends to a raster's name, its ending included, for what the format has no place for."""

OVERVIEWS, MASK = ".ovr", ".msk"
"""What it appends for overviews, and for a mask: TIFF files."""

_TIFF = (".tfw", AUXILIARY, OVERVIEWS, MASK)
_APPENDED = (AUXILIARY, OVERVIEWS, MASK)
_ENDINGS = {
    ".asc": (".prj", AUXILIARY),
    ".bil": (".hdr", ".prj", AUXILIARY),
    ".flt": (".hdr", ".prj", AUXILIARY),
    ".gpkg": (AUXILIARY,),
    ".hgt": (AUXILIARY,),
    ".img": (".ige", ".rrd", AUXILIARY),
    ".jp2": (".j2w", AUXILIARY, OVERVIEWS, MASK),
    ".nc": (AUXILIARY,),
    ".tif": _TIFF,
    ".tiff": _TIFF,
    ".vrt": (AUXILIARY, OVERVIEWS),
    ".shp": (".shx", ".dbf", ".prj", ".cpg"),
}
_MAX_VRT_BYTES = 2**22
MAX_SOURCES = 2**12
"""Files that a VRT may be made of."""

_READ_ALIKE = re.compile(rb"\s*<VRTDataset\b(?:[^&<\0]++|<[^!?]|&(?:amp|apos|gt|lt|quot);)*+")
"""A text of XML that every parser reads alike: without comments, entities of its own, or another encoding."""


def sidecars(path: Path) -> tuple[Path, ...]:
    """Return the files next to a data file that its readers look at, without those that are not there.

    The sources of a VRT are among them, wherever they lie, each with its own.
    """
    places = sidecar_places(path)
    pairs = zip(places[::2], places[1::2], strict=True)
    return tuple(sidecar for pair in pairs if (sidecar := next(filter(Path.is_file, pair), None)) is not None)


def sidecar_places(path: Path) -> tuple[Path, ...]:
    """Return where such files may lie: each by its ending in small letters, then in large ones."""
    if path.suffix.lower() != ".vrt":
        return _places(path)
    sources = all_sources(path)
    return _places(path) + tuple(p for file in sources for p in (file, file, *_places(file)))


def _places(path: Path) -> tuple[Path, ...]:
    return tuple(
        path.with_name(path.name + form) if ending in _APPENDED else path.with_suffix(form)
        for ending in _ENDINGS.get(path.suffix.lower(), ())
        for form in (ending, ending.upper())
    )


def all_sources(path: Path) -> tuple[Path, ...]:
    """Return the files that a VRT is made of, those of VRTs inside it too; a few thousand at most."""
    paths: dict[Path, None] = {}
    waiting = [path]
    while waiting and len(paths) < MAX_SOURCES:
        for text, source in sources_of(waiting.pop()):
            if source not in paths and source != path:
                paths[source] = None
                waiting += [source] if text.lower().endswith(".vrt") else []
    return tuple(paths)


def sources_of(path: Path) -> list[tuple[str, Path]]:
    """Return the sources that a VRT names, and their paths; none where it is no VRT."""
    root = vrt_document(path)
    names = [] if root is None else [e for e in root.iter() if e.tag in ("SourceFilename", "SourceDataset")]
    texts = [e.text or "" for e in names]
    return [(text, path.parent / text) for text in texts if text and "\0" not in text]


def vrt_document(path: Path) -> ElementTree.Element | None:
    """Return the XML of a VRT; None where it is none, or longer than a few megabytes."""
    try:
        status = path.stat()
        small = status.st_size <= _MAX_VRT_BYTES
        return _document(path, status.st_mtime_ns, status.st_size) if small else None
    except (OSError, ValueError):
        return None


@FILES.cached()
def _document(path: Path, modified: int, size: int) -> ElementTree.Element | None:
    from xml.etree import ElementTree

    text = read_regular(path)
    try:
        return ElementTree.fromstring(text) if _READ_ALIKE.fullmatch(text) else None
    except ElementTree.ParseError:
        return None


SHADERS = (".glsl", ".frag", ".comp", ".fs", ".fragment")
"""Endings of what is a shader, and so may be opened alone."""

TECHNIQUES = (".toml", ".glsl", ".frag", ".fs")
"""Endings of what ``use`` may name; it leaves them out."""

TEXTS = (*SHADERS, ".toml")
"""Endings of the text files that a sketch may be made of."""

ELEVATIONS = (
    *(".png", ".tif", ".tiff", ".npy", ".npz", ".r16", ".raw", ".hgt"),
    *(".asc", ".bil", ".flt", ".nc", ".vrt", ".img", ".jp2", ".gpkg"),
)
"""Endings of elevation files, which may be opened alone, too; in small letters or large ones."""

VECTORS = (".geojson", ".json", ".gpkg", ".shp", ".fgb", ".kml", ".gpx")
"""Endings of files of points, lines and polygons."""

FAST = (".comp", ".fast.toml")
"""Endings of fast variants, in the folder of the technique of their name; the fastest first."""

ROOT = "PLAYGROUND_ROOT"
"""The environment variable that names the folder which sketches in it may read: --root sets it."""

_MAX_FOLDERS = 500
_SPELLS_NAMES = os.name == "nt"  # following links there gives names as the disk spells them

T = TypeVar("T")


class Signature(NamedTuple):
    """What differs when a file was saved since, but for two saves in one tick of the file system's clock."""

    inode: int
    modified: int  # [ns] which a save may keep, as ``cp -p`` and archives do
    changed: int  # [ns] which no program sets (on Windows, when the file was created)
    size: int  # [bytes]

    @property
    def latest(self) -> int:
        """When it was saved last [ns since the epoch], whatever time the save bears."""
        return max(self.modified, self.changed)


@dataclass(slots=True)
class _State:
    """What one load has found out about files."""

    links: dict[Path, Path | None] = field(default_factory=dict)  # where paths lead
    files: dict[Path, bool] = field(default_factory=dict)  # whether a file is there
    texts: dict[tuple[Path, bool], str] = field(default_factory=dict)  # by path and whether in any encoding
    signatures: dict[Path, Signature | None] = field(default_factory=dict)  # from before the first look


_NOTHING: Mapping[Path, str] = MappingProxyType({})
_unsaved: ContextVar[Mapping[Path, str]] = ContextVar("unsaved", default=_NOTHING)
_noted: ContextVar[dict[Path, Signature | None] | None] = ContextVar("noted", default=None)
_state: ContextVar[_State | None] = ContextVar("state", default=None)


@contextmanager
def noting_places() -> Iterator[dict[Path, Signature | None]]:
    """Note every place where a file was looked for, and the signature of what was there, None for nothing.

    The same places give the same sketch: who watches them misses no file that comes, goes or
    changes, nor one that takes precedence over another from then on. Meanwhile each file is
    looked at once.
    """
    signatures: dict[Path, Signature | None] = {}
    with _set(_noted, signatures), _set(_state, _State()):
        yield signatures


@contextmanager
def looking_once() -> Iterator[None]:
    """Follow links, look for files and read texts once each, from here on until the outermost of these ends.

    A sketch names hundreds of places in a few folders, most of them several times.
    """
    with _set(_state, _State() if (state := _state.get()) is None else state):
        yield


@contextmanager
def reading_unsaved(texts: Mapping[Path, str]) -> Iterator[None]:
    """Take texts, by absolute path, in place of what files hold; such a file need not be there."""
    with _set(_unsaved, texts):
        yield


def unsaved_texts() -> Mapping[Path, str]:
    """Return the texts that are taken in place of what files hold, by absolute path."""
    return _unsaved.get()


def texts_of_load() -> dict[tuple[Path, bool], str] | None:
    """Return the texts that this load has read, to be added to: by path and whether in any encoding.

    None outside of a load, where a file is read each time.
    """
    return None if (state := _state.get()) is None else state.texts


@contextmanager
def noting_part() -> Iterator[dict[Path, Signature | None]]:
    """Note the places of a part of a load by itself; they are noted for the whole load, too."""
    signatures: dict[Path, Signature | None] = {}
    try:
        with _set(_noted, signatures):
            yield signatures
    finally:
        note_again(signatures)


@contextmanager
def _set(variable: ContextVar[T], value: T) -> Iterator[None]:
    token = variable.set(value)
    try:
        yield
    finally:
        variable.reset(token)


def note_again(places: Mapping[Path, Signature | None]) -> None:
    """Note places with what is known to be there; what is noted already stays as it is."""
    noted = _noted.get()
    if noted is not None:
        for path, signature_of in places.items():
            noted.setdefault(path, signature_of)


def note(path: Path) -> None:
    """Note that a file is looked for at a place; before it is read, so that no save falls in between."""
    noted = _noted.get()
    if noted is not None and path not in noted:
        noted[path] = signature_in_load(path)


def signature_in_load(path: Path) -> Signature | None:
    """Return a file's signature, taken once in a load and before the file is read."""
    state = _state.get()
    if state is None:
        return signature(path)
    if path not in state.signatures:  # what was found out before is of a time that no signature tells
        state.signatures[path] = signature(path)
        state.files.pop(path, None)
        for any_encoding in (False, True):
            state.texts.pop((path, any_encoding), None)
    return state.signatures[path]


def signature(path: Path) -> Signature | None:
    """Return a file's signature; None where there is none."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return Signature(status.st_ino, status.st_mtime_ns, status.st_ctime_ns, status.st_size)


def real(path: Path) -> Path | None:
    """Return a path with its links followed; None for what can name no file (a NUL, links in a circle)."""
    state = _state.get()
    if state is None:
        return _followed(path)
    if path not in state.links:
        state.links[path] = _followed_from_folder(path, state)
    return state.links[path]


def _followed_from_folder(path: Path, state: _State) -> Path | None:
    """Return what ``_followed`` does, by where the path's folder leads, which most others have in common."""
    folder = real(path.parent) if path.is_absolute() and path.name not in ("", "..") else None
    if folder is None or _SPELLS_NAMES:
        return _followed(path)
    try:
        mode = path.lstat().st_mode
    except OSError:  # nothing is there
        mode = 0
    except ValueError:  # a NUL
        return None
    if stat.S_ISLNK(mode):
        return _followed(path)
    file = folder / path.name
    state.files[path] = state.files[file] = stat.S_ISREG(mode)
    return file


def _followed(path: Path) -> Path | None:
    try:
        return path.resolve()
    except (OSError, ValueError, RuntimeError):
        return None


def is_file(path: Path) -> bool:
    """Return whether a file is there, also for names that no file can have."""
    note(path)
    if path in _unsaved.get():
        return True
    state = _state.get()
    if state is None:
        return _is_file(path)
    if path not in state.files:
        state.files[path] = _is_file(path)
    return state.files[path]


def _is_file(path: Path) -> bool:
    try:
        return path.is_file()
    except (OSError, ValueError):
        return False


def exists(path: Path) -> bool:
    """Return whether anything is there, a file or not, also for names that nothing can have."""
    try:
        return path.exists()
    except (OSError, ValueError):
        return False


def is_elevation(path: Path) -> bool:
    """Return whether a file is one of elevations by its name."""
    return path.suffix.lower() in ELEVATIONS


def is_variant(path: Path) -> bool:
    """Return whether a file is a fast variant by its name; a ``.comp`` with its own ``#version`` is none."""
    return path.name.endswith(FAST)


def canonical_of(path: Path) -> Path | None:
    """Return the technique that a fast variant replaces: of its name, in its folder; None for none."""
    name = next((path.name.removesuffix(ending) for ending in FAST if path.name.endswith(ending)), "")
    candidates = (path.with_name(f"{name}{ending}") for ending in (".glsl", ".toml"))
    return next((candidate for candidate in candidates if name and is_file(candidate)), None)


def named_root(path: Path) -> Path | None:
    """Return the folder that the user named as the root, where a file lies in it; else None."""
    named = real(Path(text).expanduser()) if (text := os.environ.get(ROOT)) else None
    return named if named is not None and path.is_relative_to(named) else None


def root_of(path: Path) -> Path:
    """Return the folder that a technique opened alone may read from, besides ``glsl/``.

    ``glsl/`` for what lies in it; else the root that the user named; else the nearest folder around it
    that holds a ``sketch.toml``; else its own.
    """
    if path.is_relative_to(GLSL):
        return GLSL
    marked = (folder for folder in path.parents if is_file(folder / "sketch.toml"))
    return named_root(path) or next(marked, path.parent)


def is_inside(path: Path, roots: Iterable[Path]) -> bool:
    """Return whether a path, its links followed, lies in one of some folders."""
    resolved = real(path)
    return resolved is not None and any(resolved.is_relative_to(root) for root in map(real, roots) if root)


def how_to_open(path: Path | None, folder: Path, *, marks: bool = True) -> str:
    """Return the end of a message on a file that lies outside a sketch's folder: how a user may open it.

    ``marks``: a ``sketch.toml`` around it marks the folder, as for a shader that is opened alone.
    """
    around = next((parent for parent in folder.parents if path and path.is_relative_to(parent)), None)
    if around is None or around == around.parent:
        return ""
    also = f", and so does an empty sketch.toml in {shown(around)}" if marks else ""
    return f"; --root {shown(around)} opens it{also}"


def leads_outside(text: str, folder: Path, declared_in: str = "") -> bool:
    """Return whether a data file that a sketch names lies outside its ``folder`` and ``glsl/``.

    So it does where a file next to it lies outside that says how to read it.
    ``declared_in`` is the kernel that has the parameter: files are also looked for in its folder.
    Names of files that are not there are judged by where they would be.
    """
    if is_absolute(text):
        return True
    roots = tuple(root for root in (named_root(folder), folder, GLSL) if root is not None)
    places = [folder, *([Path(declared_in).parent] if declared_in else []), GLSL]
    candidates = [root / text for root in places]
    there = [candidate for candidate in candidates if is_file(candidate)]
    return not any(
        is_inside(candidate, roots) and outside_sidecar(candidate, roots) is None
        for candidate in there or candidates
    )


def outside_sidecar(path: Path, roots: Iterable[Path]) -> Path | None:
    """Return a file next to a data file that says how to read it, and leads out of some folders; or None."""
    places, resolved = tuple(roots), real(path) or path
    with looking_once():
        return next((file for file in sidecars(resolved) if not is_inside(file, places)), None)


def is_absolute(text: str) -> bool:
    """Return whether a path is absolute on any system, so that a sketch means the same on all of them."""
    windows = PureWindowsPath(text)
    return PurePosixPath(text).is_absolute() or bool(windows.drive or windows.root) or text.startswith("~")


def names_below(roots: Sequence[Path], suffixes: tuple[str, ...]) -> list[str]:
    """List the files with some endings below some folders, from each folder, for a hint.

    Stops after some hundred folders: a sketch may lie in a home folder or in the root.
    """
    names: list[str] = []
    visited = 0
    for root in roots:
        for folder, inner, files in os.walk(root):
            visited += 1
            if visited > _MAX_FOLDERS:
                return names
            inner[:] = sorted(name for name in inner if not name.startswith("."))
            here = Path(folder).relative_to(root)
            names += [(here / name).as_posix() for name in files if name.endswith(suffixes)]
    return names
