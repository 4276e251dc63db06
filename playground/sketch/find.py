"""Find a sketch by name or path, unpack a packed one, and list what ships.

A zip is not trusted: nothing of it is written outside its folder, no link is made, and how many
files and bytes it may become is known before the first is written. Commands read it from
the cache, in a folder named after its bytes, which is made again where a file of it was
changed; a window opens a copy in the same folder, whose files may be edited.
"""

from __future__ import annotations

import hashlib
import re
import secrets
import shutil
import stat
import zipfile
import zlib
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from playground import paths
from playground._version import __version__
from playground.allowed_files import (
    ELEVATIONS,
    SHADERS,
    TECHNIQUES,
    TEXTS,
    is_elevation,
    is_file,
    is_inside,
    is_variant,
)
from playground.errors import DataError, SketchError, counted, nearest
from playground.files import irregularity, open_regular
from playground.json_text import read_json
from playground.paths import GLSL, SCREENSHOTS, SKETCHES, cache_folder, shown
from playground.shader.dialect import dialects

if TYPE_CHECKING:
    from playground.sketch.model import Sketch

ENDING = ".zip"
MANIFEST = "pack.json"
FORMAT = 1
MAX_FILES = 2000
MAX_BYTES = 2**30
_MAX_RATIO = 200  # of what is unpacked to the zip; what is drawn or measured stays far below
_ALWAYS_FINE = 2**26  # [bytes] unpacked, with any ratio
MAX_PACKS = 16  # packs in the cache
_STAMP = ".unpacked-from"
_MAX_MANIFEST_BYTES = 2**20

# Windows takes these for devices, with any ending.
_DEVICES = {"con", "prn", "aux", "nul", *(f"{name}{n}" for name in ("com", "lpt") for n in range(1, 10))}
_FORBIDDEN = re.compile(r'[\x00-\x1f<>:"|?*\\]')
_LEFT_OUT = ("__MACOSX/", "/.DS_Store", "/Thumbs.db", "/desktop.ini")  # what systems put into zips


@dataclass(frozen=True)
class Manifest:
    """What a pack says of itself."""

    sketch: str  # the file to open, from the zip's root
    version: str = ""  # of the playground that packed it
    shipped: tuple[str, ...] = ()  # files of ``glsl/`` that it needs
    libraries: tuple[str, ...] = ()  # libraries that it includes from, which are not in it


@dataclass(frozen=True)
class Pack:
    """A zip that was looked through and is safe to unpack."""

    path: Path
    digest: str
    manifest: Manifest
    files: dict[str, zipfile.ZipInfo] = field(default_factory=dict)  # by name


def is_pack(path: Path) -> bool:
    """Return whether a path is named like a packed sketch."""
    return path.suffix.lower() == ENDING


def unpacked(path: Path, cache: Path | None = None) -> Path:
    """Return the sketch's file of a zip, unpacked into the cache; raise ``DataError``."""
    pack = read_pack(path)
    home = (cache or cache_folder()) / "packs"
    target = home / pack.digest
    if not _is_complete(pack, target):
        shutil.rmtree(target, ignore_errors=True)
        _unpack(pack, target)
        _drop_oldest(home, target)
    return target / pack.manifest.sketch


def unpacked_beside(path: Path, cache: Path | None = None) -> tuple[Path, str]:
    """Return the sketch's file of a zip in a new folder next to it, to be edited, and a message.

    A folder that came of the same zip before is opened again, with what was edited there.
    Where the zip's own folder cannot be written to, it is one in the cache, and stays there.
    """
    pack = read_pack(path)
    top, in_folder, inner = pack.manifest.sketch.partition("/")
    name, inner = (top, inner) if in_folder else (path.stem, top)
    for home in (path.resolve().parent, (cache or cache_folder()) / "edited" / pack.digest):
        for number in range(1, 1000):
            target = home / (name if number == 1 else f"{name}-{number}")
            if _stamp_of(target) == pack.digest and (target / inner).is_file():
                message = f"{path.name} is unpacked in {target}: this is what opens, and edits stay"
                return target / inner, message
            if target.exists() or target.is_symlink():
                continue
            if not _can_make(target):
                break
            _unpack(pack, target, strip=bool(in_folder))
            return target / inner, f"{path.name} is unpacked into {target}: edits go there, the zip stays"
    raise DataError("no folder could be made to unpack it into", file=path)


def read_pack(path: Path) -> Pack:
    """Look through a zip and return what it holds; raise ``DataError`` for one that is not safe to unpack."""
    try:
        with zipfile.ZipFile(path) as archive:
            entries = [e for e in archive.infolist() if not e.is_dir() and not _is_left_out(e.filename)]
            _check(entries, path.stat().st_size)
            files = {entry.filename: entry for entry in entries}
            manifest = _manifest(archive, files)
        digest = _digest(path)
    except DataError as error:
        raise DataError(error.diagnostics[0].message, file=path) from None
    except (OSError, zipfile.BadZipFile, NotImplementedError, RuntimeError, zlib.error, EOFError) as error:
        raise DataError(f"is no zip that can be read: {_reason(error)}", file=path) from None
    missing = [name for name in manifest.shipped if not (GLSL / name).is_file()]
    if missing:
        raise DataError(
            f"needs glsl/{missing[0]}, which this playground ({__version__}) has not; it was packed with "
            f"{manifest.version or 'another one'}",
            file=path,
        )
    return Pack(path, digest, manifest, {name: files[name] for name in files if name != MANIFEST})


def _check(entries: list[zipfile.ZipInfo], size: int) -> None:
    """Raise ``DataError`` for what is not safe to unpack; ``size`` is the zip's own, in bytes."""
    if not entries:
        raise DataError("holds no file; expected a packed sketch")
    if len(entries) > MAX_FILES:
        raise DataError(f"holds {len(entries)} files; at most {MAX_FILES} are unpacked")
    whole = sum(e.file_size for e in entries)
    if sum(e.compress_size for e in entries) > size:
        raise DataError("its files overlap, as those of a zip bomb do; it is not unpacked")
    if whole > MAX_BYTES or (whole > _ALWAYS_FINE and whole > _MAX_RATIO * size):
        raise DataError(
            f"would become {whole / 2**20:.0f} MiB from {size / 2**20:.2g}: that is too much to unpack"
        )
    names = set()
    for entry in entries:
        _check_entry(entry)
        folded = entry.filename.casefold()  # some systems tell no capitals
        if folded in names:
            raise DataError(f"holds '{entry.filename}' twice")
        names.add(folded)
    for name in names:
        if any(folder.as_posix() in names for folder in PurePosixPath(name).parents):
            raise DataError(f"'{_printable(name)}' lies inside a file")


def _check_entry(entry: zipfile.ZipInfo) -> None:
    name, wrong = entry.filename, ""
    if stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG):
        wrong = "is a link or a device; only plain files are unpacked"
    elif entry.flag_bits & 1:
        wrong = "is encrypted; a packed sketch has no password"
    elif entry.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        wrong = "is compressed in a way other than deflate"
    elif (
        (name.startswith("/") or len(name) > 200 or entry.orig_filename != name)
        or _FORBIDDEN.search(name)
        or any(map(_is_bad_part, name.split("/")))
    ):
        wrong = "is no name that a file of a sketch may have; nothing was unpacked"
    if wrong:
        raise DataError(f"'{_printable(name)}' {wrong}")


def _is_bad_part(part: str) -> bool:
    bare = part.partition(".")[0].rstrip().casefold()
    return part in ("", ".", "..") or part[-1] in " ." or bare in _DEVICES


def _is_left_out(name: str) -> bool:
    return any(name.startswith(s) if s.endswith("/") else f"/{name}".endswith(s) for s in _LEFT_OUT)


def _printable(name: str) -> str:
    return "".join(c if c.isprintable() else "?" for c in name)[:80]


def _manifest(archive: zipfile.ZipFile, files: dict[str, zipfile.ZipInfo]) -> Manifest:
    """Return what the zip says of itself; of one that was made by the user, where its sketch is."""
    if MANIFEST not in files:
        sketches = [n for n in files if PurePosixPath(n).name == "sketch.toml" and n.count("/") <= 1]
        if len(sketches) == 1:
            return Manifest(sketches[0])
        what = f"{len(sketches)} of them" if sketches else "none"
        raise DataError(
            f"is no packed sketch: expected one sketch.toml, in it or in its only folder, and found {what}"
        )
    if files[MANIFEST].file_size > _MAX_MANIFEST_BYTES:
        raise DataError(f"its {MANIFEST} is too large")
    try:
        table = read_json(archive.read(MANIFEST))
        if table["format"] != FORMAT:
            raise DataError(f"is of format {table['format']}; this playground ({__version__}) reads {FORMAT}")
        shipped, named = (tuple(map(str, some)) for some in (table["shipped"], table.get("libraries", ())))
        manifest = Manifest(str(table["sketch"]), str(table["version"]), shipped, named)
    except (ValueError, KeyError, TypeError) as error:
        raise DataError(f"its {MANIFEST} cannot be read: {_reason(error)}") from None
    if manifest.sketch not in files or manifest.sketch == MANIFEST:
        raise DataError(f"says that it opens '{_printable(manifest.sketch)}', and does not hold it")
    return manifest


def _unpack(pack: Pack, target: Path, *, strip: bool = False) -> None:
    """Write the files into a new folder, all or none; ``strip``: without the zip's own top folder."""
    scratch = target.with_name(f".{target.name[:40]}.{secrets.token_hex(6)}.part")
    try:
        scratch.mkdir(parents=True)
        with zipfile.ZipFile(pack.path) as archive:
            for name, entry in pack.files.items():
                path = scratch / (name.partition("/")[2] if strip and "/" in name else name)
                path.parent.mkdir(parents=True, exist_ok=True)
                with archive.open(entry) as source, path.open("xb") as file:
                    shutil.copyfileobj(source, file, 1 << 20)
        (scratch / _STAMP).write_text(pack.digest + "\n", encoding="utf-8")
        scratch.replace(target)
    except (OSError, zipfile.BadZipFile, zlib.error, EOFError) as error:
        shutil.rmtree(scratch, ignore_errors=True)
        if _is_complete(pack, target):
            return  # another process was faster
        raise DataError(f"cannot be unpacked into {target}: {_reason(error)}", file=pack.path) from None
    except BaseException:
        shutil.rmtree(scratch, ignore_errors=True)
        raise


def _is_complete(pack: Pack, target: Path) -> bool:
    """Return whether a folder holds every file of a pack, unchanged."""
    if _stamp_of(target) != pack.digest:
        return False
    try:
        return all(
            (target / name).stat().st_size == entry.file_size and _crc(target / name) == entry.CRC
            for name, entry in pack.files.items()
        )
    except OSError:
        return False


def _crc(path: Path) -> int:
    checksum = 0
    with open_regular(path) as file:
        while block := file.read(1 << 20):
            checksum = zlib.crc32(block, checksum)
    return checksum


def _digest(path: Path) -> str:
    with open_regular(path) as file:
        return hashlib.file_digest(file, lambda: hashlib.blake2b(digest_size=12)).hexdigest()


def _stamp_of(folder: Path) -> str:
    try:
        return (folder / _STAMP).read_text(encoding="utf-8").strip()
    except (OSError, UnicodeDecodeError):
        return ""


def _can_make(target: Path) -> bool:
    try:
        target.mkdir(parents=True)
        target.rmdir()
    except OSError:
        return False
    return True


def _drop_oldest(home: Path, but: Path) -> None:
    packs = sorted((p for p in home.iterdir() if p.is_dir() and p != but), key=lambda p: p.stat().st_mtime)
    for old in packs[: max(len(packs) + 1 - MAX_PACKS, 0)]:
        shutil.rmtree(old, ignore_errors=True)


def _reason(error: BaseException) -> str:
    text = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return " ".join(text.split()).rstrip(".") or type(error).__name__


def summary(pack: Pack) -> str:
    """Return how many files and bytes a pack holds."""
    return f"{counted(len(pack.files), 'file')}, {sum(e.file_size for e in pack.files.values())} bytes"


def find(name: str | Path) -> Path:
    """Return the file of a sketch's name or path; raise ``SketchError`` if there is none.

    A zip is unpacked into the cache first: ``DataError`` says why one cannot be.
    """
    path = Path(name)
    try:
        path = path.expanduser()
        is_folder = path.is_dir()
    except (OSError, RuntimeError, ValueError):
        is_folder = False
    if is_folder and is_file(path / "sketch.toml"):
        return path / "sketch.toml"
    if is_folder:
        if (image := dialects().image_of(path)) is not None:
            return image
    if is_file(path):
        if is_pack(path):
            return unpacked(path)
        if path.suffix not in TEXTS and not is_elevation(path):
            if dialects().is_export(path):
                return path
            if path.suffix in dialects().endings:
                message = "a sketch is a .toml, and a .json a Shadertoy export; this holds no renderpass"
                raise SketchError(message, file=path)
            message = f"a sketch is a .toml, a shader ends in {', '.join(SHADERS)}"
            raise SketchError(f"{message}, an elevation file in {', '.join(ELEVATIONS)}", file=path)
        return path
    text = str(name)
    places = [SKETCHES / f"{text}.toml"] if "/" not in text and "\\" not in text else []
    places += [GLSL / f"{text}{suffix}" for suffix in ("", *TECHNIQUES)]
    for candidate in places:
        if candidate.suffix in TEXTS and is_file(candidate) and is_inside(candidate, (GLSL,)):
            return candidate
    sketch_file = path / "sketch.toml" if is_folder else path
    if what := irregularity(sketch_file):
        raise SketchError(what, file=sketch_file)
    if is_folder:
        raise SketchError("this folder holds no sketch.toml, and no Image of Shadertoy of its own", file=path)
    names = [*shipped_sketches(), *(shipped_names() if "/" in text else [])]
    raise SketchError(f"there is no file and no shipped sketch '{text}'{nearest(text, names)}")


def shipped_sketches() -> list[str]:
    """List the names of the sketches that ship.

    For example:

        assert "l_dot_n" in playground.shipped_sketches()
    """
    return sorted(path.stem for path in SKETCHES.glob("*.toml"))


def shipped_names() -> list[str]:
    """List every name that ``use`` may take in ``glsl/``, library files too, without reading the files."""
    paths = [
        p
        for p in GLSL.rglob("*")
        if p.suffix in TECHNIQUES and not is_variant(p) and not p.is_relative_to(SKETCHES)
    ]
    return sorted({p.relative_to(GLSL).with_suffix("").as_posix() for p in paths})


def is_part(name: str) -> bool:
    """Return whether a name in ``glsl/`` is a part of a technique: it lies in a folder named after one."""
    return any(is_file(GLSL / folder.with_suffix(".toml")) for folder in Path(name).parents if folder.name)


def home_of(sketch: Sketch) -> Path:
    """Return the ``screenshots`` folder that a sketch's references are in, which may not exist yet.

    Raises ``DataError`` for a shipped sketch of an installed package, which has none.
    """
    if not Path(sketch.file).is_relative_to(paths.SKETCHES):
        return Path(sketch.folder) / SCREENSHOTS
    if paths.CHECKOUT is None:
        message = f"the references of '{sketch.name}' are in the repository; an installed package has none"
        raise DataError(message, file=shown(sketch.file))
    return paths.CHECKOUT / SCREENSHOTS
