"""Store the result of each checked shot in a folder: one record a shot, as JSON, and its pictures.

    <folder>/<sketch>/<shot>.json             what came of it: always
    <folder>/<sketch>/<shot>.actual.png       unless it passed; with the texts of a reference
    <folder>/<sketch>/<shot>.expected.png     the reference it was held against, if there is one
    <folder>/<sketch>/<shot>.difference.png   16 times as strong
    <folder>/<sketch>/<shot>.flip.png         where an eye would see it
    <folder>/<sketch>/<shot>.masked.png       what is not compared, under stripes, if anything is

Sketches of one name in several folders, and test files of one name, are several: the first to
come has the folder of that name, each other one its own, ``hills-1a2b3c4d``. ``.home`` in the
first says whose it is, so that a later run, and another process, finds the same.

A record is complete: the report, ``review`` and ``accept`` need neither the sketch nor a
graphics card, so a folder that was made elsewhere (by a continuous integration, say) can be
looked at and accepted here. Each file is written whole or not at all, so that several
processes may fill one folder, a shot each.

It judges nothing, and knows no pytest.

A checked shot tells of itself in ``--junitxml``, too: a property each, beginning with ``shot``.

    shot                        the picture's name, "hills/dawn"; what follows it is of that one
    shot.result                 "same", or why it fails: "differs", "missing", …
    shot.renderer               what drew it, as the folders of references are named
    shot.reference              the reference that it was held against
    shot.stands-in              whose references stood in for that renderer's, if any did
    shot.trace                  the first line whose value is another than in the reference's run
    shot.score.<number>         what was measured, with its unit, as the report has it
    shot.picture.<word>         its pictures, unless it passed: actual, expected, difference, flip, masked

Paths are from the folder in which the tests were started where they lie in that.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
import secrets
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import MISSING, Field, dataclass, field, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import encode_png
from playground.errors import DataError
from playground.files import make_folder, read_regular, write_file
from playground.json_text import read_json
from playground.verify.shots.plugin_constants import REPORT, SHOT
from playground.verify.shots.verdicts import verdict_on

# ── records ──────────────────────────────────────────────────────────────────


FORMAT = 4
"""What a record's ``format`` says; a record of another is refused in words."""

FOLDER = REPORT
"""Where results go unless another folder is named."""

PICTURES = ("actual", "expected", "difference", "flip", "masked")
"""The pictures a record can have, in the order in which they are shown."""

FRAMES = "frames, in rows from the top left"
"""The number that only the record of an animation has."""

_SHOT = r"[^./\\\0]+"
_SKETCH = r"(?!\.{1,2}$)[^/\\\0]+"


@dataclass(frozen=True, kw_only=True)
class Rules:
    """How strictly a picture was compared."""

    tier: str = ""  # in a few words
    tolerance: str = ""  # that the shot declares, with its reason; "" for the usual one
    tolerated: str = ""  # "needed" or "not needed" where it declares one and passed
    masked: tuple[str, ...] = ()  # what is not compared: rectangles, images, textures
    tone: str = ""  # how floats were shown; "" for bytes, and floats from 0 to 1
    catches: str = ""  # what that tier can catch and what it cannot, in a message


@dataclass(frozen=True, kw_only=True)
class Expected:
    """What a picture was held against."""

    reference: str = ""  # the file: from the root if it is inside, else whole
    stands_in: str = ""  # whose references stood in for its renderer's, and by what; "" for its own
    home: str = ""  # the screenshots/ folder of its references: from the root if it is inside, else whole
    compared: str = ""  # file name of the reference; "" for none
    references: dict[str, str] = field(default_factory=dict)  # accepted file's name → its SHA-256, then
    size: tuple[int, int] | None = field(default=None, metadata={"key": "expected_size"})  # [pixels]
    texts: dict[str, str] = field(  # the reference's fingerprint
        default_factory=dict, metadata={"key": "expected_texts"}
    )


@dataclass(frozen=True, kw_only=True)
class Actual:
    """The picture that was drawn."""

    size: tuple[int, int] | None = None  # [pixels] width and height
    texts: dict[str, str] = field(default_factory=dict)  # the fingerprint of what drew it
    pictures: dict[str, str] = field(default_factory=dict)  # one of PICTURES → its file, from the folder
    digest: str = ""  # SHA-256 of its file


@dataclass(frozen=True, kw_only=True)
class CheckRun:
    """The test that checked a shot, and when."""

    root: str = ""  # the folder that the tests were started in, whole
    node: str = ""  # pytest's node id, as tests/test_shots.py::test_shot[hills/dawn]
    command: str = ""  # what accepts the picture, for a shell
    seconds: float = 0.0  # [s] that taking and comparing took
    when: float = 0.0  # [s since 1970, UTC] when it was checked
    name: str = field(
        default="", metadata={"key": "run"}
    )  # of the run of the tests; the same for all its processes


@dataclass(frozen=True, kw_only=True)
class Record:
    """What came of one checked shot. Everything in it is plain text and numbers; its JSON has no groups."""

    sketch: str  # its name: a folder here, and in screenshots/
    shot: str  # its name, without dots
    word: str  # of `VERDICTS`, by this version or another
    message: str  # what was found, for a person
    renderer: str = ""  # slug of what drew it, as "llvmpipe"; "" where nothing was drawn
    numbers: dict[str, float] = field(default_factory=dict)  # what was measured, by name with its unit
    place: tuple[int, int] | None = None  # [pixels] x and y, from the top left, of the worst one
    fingerprint: tuple[str, ...] = ()  # how what drew the two differs, a message each
    traced: tuple[str, ...] = ()  # the first line whose value differs from the reference's run, or is NaN
    error: str = ""  # what the child process printed before it failed
    folder: str = ""  # its folder here, where a sketch of the same name has the plain one; else ""
    rules: Rules = Rules()
    expected: Expected = Expected()
    actual: Actual = Actual()
    run: CheckRun = CheckRun()

    @property
    def place_name(self) -> str:
        """The name of its folder here: the sketch's, unless another one has that."""
        return self.folder or self.sketch

    @property
    def name(self) -> str:
        """Return "sketch/shot", where the sketch is named as its folder here."""
        return f"{self.place_name}/{self.shot}"

    @property
    def ok(self) -> bool:
        """Whether the shot passed."""
        return verdict_on(self.word).passes

    @property
    def stamp(self) -> str:
        """Return a digest of all that is in it: another run of the same shot gives another."""
        return hashlib.sha256(to_json(self).encode()).hexdigest()[:24]


_GROUPS: dict[str, type[Any]] = {"rules": Rules, "expected": Expected, "actual": Actual, "run": CheckRun}


def _fields() -> dict[str, tuple[str, Field[Any]]]:
    """Return each field by its name in a record's JSON, with the group that it is in; "": in none."""
    own = {f.name: ("", f) for f in fields(Record) if f.name not in _GROUPS}
    grouped = ((group, f) for group, kind in _GROUPS.items() for f in fields(kind))
    return own | {f.metadata.get("key", f.name): (group, f) for group, f in grouped}


def flat(record: Record) -> dict[str, Any]:
    """Return what a record holds, by its names in JSON; ``record_of`` gives the same record back."""
    return {
        key: getattr(getattr(record, group) if group else record, f.name)
        for key, (group, f) in _fields().items()
    }


def record_of(values: Mapping[str, Any]) -> Record:
    """Return the record of some values by their names in JSON."""
    groups: dict[str, dict[str, Any]] = {group: {} for group in ("", *_GROUPS)}
    for key, value in values.items():
        group, f = _fields()[key]
        groups[group][f.name] = value
    return Record(**groups.pop(""), **{group: _GROUPS[group](**held) for group, held in groups.items()})


def to_json(record: Record) -> str:
    """Return a record as JSON; `from_json` gives the same record back."""
    return json.dumps({"format": FORMAT} | flat(record), indent=1, ensure_ascii=False, allow_nan=False) + "\n"


def from_json(text: str, file: str | Path = "a record") -> Record:
    """Read a record; raise ``DataError``, which names ``file``, for anything but what `to_json` writes.

    What a later version of the playground adds would change the format's number, so a name
    that is not known is a mistake too.
    """
    try:
        result = read_json(text, constant=_no_constant)
    except ValueError as error:
        raise DataError(f"not the record of a shot: no JSON ({error})", file=file) from error
    if not isinstance(result, dict) or "format" not in result:
        raise DataError("not the record of a shot: expected an object with a 'format'", file=file)
    if result.pop("format") != FORMAT:
        raise DataError(f"a record of another format; this version reads format {FORMAT}", file=file)
    unknown = sorted(result.keys() - _TESTS.keys())
    if unknown:
        raise DataError(f"a record has no '{unknown[0]}'", file=file)
    missing = sorted(_REQUIRED - result.keys())
    if missing:
        raise DataError(f"a record without its '{missing[0]}'", file=file)
    values: dict[str, Any] = {}
    for name, value in result.items():
        expected, is_valid = _TESTS[name]
        if not is_valid(value):
            text = json.dumps(value, ensure_ascii=False)
            text = text if len(text) < 60 else text[:57] + "…"
            raise DataError(f"'{name}' in a record is {expected}; found {text}", file=file)
        values[name] = tuple(value) if isinstance(value, list) else value
    record = record_of(values)
    for word, name in record.actual.pictures.items():
        if name != _picture_name(record, word):
            expected = _picture_name(record, word)
            raise DataError(f"picture '{word}' in a record is {expected}; found {name}", file=file)
    return record


def write_result(folder: Path, record: Record, pictures: Mapping[str, NDArray[np.uint8]]) -> Record:
    """Write a shot's record and its pictures into ``folder``, and remove what a run before left of them.

    ``pictures`` has some of `PICTURES`, uint8 (height, width, 4), top row first; none for a
    shot that passed. The record goes last, and an old one is removed first: one that can be
    read has its pictures.
    Returns it as written, with the pictures' names and the digest. A new folder gets a
    ``.gitignore``, so that no repository takes it in. Raises ``DataError``, also for a name
    that cannot be a file's.
    """
    _check_names(record.sketch, record.shot, folder)
    make_folder(make_results_folder(folder) / record.place_name)
    result_path(folder, record).unlink(missing_ok=True)
    files: dict[str, str] = {}
    digest = ""
    for word in PICTURES:
        name = _picture_name(record, word)
        if word not in pictures:
            (folder / name).unlink(missing_ok=True)
            continue
        data = encode_png(pictures[word], record.actual.texts if word == "actual" else {})
        write_file(folder / name, data)
        files[word] = name
        if word == "actual":
            digest = digest_of(data)
    whole = replace(record, actual=replace(record.actual, pictures=files, digest=digest))
    write_file(result_path(folder, whole), to_json(whole))
    return whole


def make_results_folder(folder: Path) -> Path:
    """Make the results folder if it is not there, with a ``.gitignore`` of everything in it."""
    if not folder.is_dir():
        write_file(
            make_folder(folder) / ".gitignore",
            b"# Results of screenshot tests: written again by every run.\n*\n",
        )
    return folder


def read_results(folder: Path) -> list[Record]:
    """Read every record in a folder, by sketch and shot.

    Raises ``DataError`` where there is no such folder, none in it, or one that cannot be
    read, or that lies where another shot's belongs.
    """
    if not folder.is_dir():
        raise DataError("there is no such folder; pytest makes it when it checks shots", file=folder)
    records = [read_result(path) for path in sorted(folder.glob("*/*.json"))]
    if not records:
        raise DataError("no record of a shot is in it; pytest leaves them when it checks shots", file=folder)
    return sorted(records, key=lambda record: (record.place_name, record.shot))


def read_result(path: Path) -> Record:
    """Read one record from its file; raise ``DataError``."""
    try:
        text = read_regular(path).decode()
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}", file=path) from error
    except UnicodeDecodeError as error:
        raise DataError("not the record of a shot: not text in UTF-8", file=path) from error
    record = from_json(text, path)
    if (record.place_name, record.shot) != (path.parent.name, path.stem):
        raise DataError(f"the record of {record.name} lies where another belongs", file=path)
    return record


def result_path(folder: Path, record: Record) -> Path:
    """Return where a shot's record is."""
    return folder / f"{record.name}.json"


def digest_of(data: bytes) -> str:
    """Return the SHA-256 of bytes, as records hold it."""
    return hashlib.sha256(data).hexdigest()


def digests_of(files: Iterable[Path]) -> dict[str, str]:
    """Return name → SHA-256 of files; raise ``DataError`` for one that cannot be read."""
    digests = {}
    for path in files:
        try:
            digests[path.name] = digest_of(read_regular(path))
        except OSError as error:
            raise DataError(f"cannot be read: {error.strerror}", file=path) from error
    return digests


def _picture_name(record: Record, word: str) -> str:
    return f"{record.name}.{word}.png"


def _check_names(sketch: str, shot: str, file: str | Path) -> None:
    if not re.fullmatch(_SKETCH, sketch):
        raise DataError(f"{sketch!r} cannot be a sketch's folder", file=file)
    if not re.fullmatch(_SHOT, shot):
        raise DataError(f"{shot!r} cannot be a shot's name: no dot, no slash", file=file)


# What each field may be as JSON: in words, and as a test


def _no_constant(text: str) -> float:
    raise ValueError(f"{text} is no number")


def _is_text(value: object) -> bool:
    return isinstance(value, str)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _matches(pattern: str) -> Callable[[object], bool]:
    return lambda value: isinstance(value, str) and bool(re.fullmatch(pattern, value))


def _is_object_of(test: Callable[[object], bool]) -> Callable[[object], bool]:
    return lambda value: isinstance(value, dict) and all(map(test, value.values()))


def _is_pair_from(lowest: int) -> Callable[[object], bool]:
    def test(value: Any) -> bool:
        pair = isinstance(value, list) and len(value) == 2
        return value is None or (pair and all(isinstance(side, int) and side >= lowest for side in value))

    return test


_TESTS_OF_TYPES: dict[str, tuple[str, Callable[[Any], bool]]] = {
    "str": ("a text", _is_text),
    "float": ("a number", _is_number),
    "dict[str, str]": ("an object of texts", _is_object_of(_is_text)),
    "dict[str, float]": ("an object of numbers", _is_object_of(_is_number)),
    "tuple[str, ...]": (
        "a list of texts",
        lambda value: isinstance(value, list) and all(map(_is_text, value)),
    ),
    "tuple[int, int] | None": ("two numbers of pixels", _is_pair_from(1)),
}
_TESTS = {key: _TESTS_OF_TYPES[str(f.type)] for key, (_, f) in _fields().items()} | {
    "sketch": ("the name of a sketch", _matches(_SKETCH)),
    "shot": ("the name of a shot", _matches(_SHOT)),
    "folder": ("the name of a folder", _matches(f"(?:{_SKETCH})?")),
    "place": ("x and y of a pixel", _is_pair_from(0)),
    "pictures": (
        f"an object of files, of {', '.join(PICTURES)}",
        lambda value: _is_object_of(_is_text)(value) and value.keys() <= set(PICTURES),
    ),
}
_REQUIRED = {
    key for key, (_, f) in _fields().items() if f.default is MISSING and f.default_factory is MISSING
}


# ── folders of records ───────────────────────────────────────────────────────


_CLAIM = ".home"


def place_of(folder: Path, sketch: str, home: Path) -> str:
    """Return the name of the folder, in the results, of a sketch's records.

    ``home`` is the folder of its references. Makes the folder of the sketch's name if it is
    not there; raises ``DataError`` or ``OSError`` where it cannot.
    """
    make_results_folder(folder)
    try:
        key = Path(os.path.relpath(home, folder)).as_posix()
    except ValueError:  # on Windows, another drive
        key = home.as_posix()
    (folder / sketch).mkdir(exist_ok=True)
    claim = folder / sketch / _CLAIM
    first = claim.read_text("utf-8") if claim.is_file() else claim_file(claim, key)
    return sketch if first == key else f"{sketch}-{hashlib.sha256(key.encode()).hexdigest()[:8]}"


def drop(folder: Path, record: Record) -> None:
    """Remove a record and its pictures."""
    folder_path = folder / record.place_name
    (folder_path / f"{record.shot}.json").unlink(missing_ok=True)
    for word in PICTURES:
        (folder_path / f"{record.shot}.{word}.png").unlink(missing_ok=True)


def records_in(folder: Path, folder_name: str = "*") -> Iterator[Record]:
    """Yield the records of one folder of results, or of all; what cannot be read is passed over."""
    for path in sorted(
        folder.glob("*/*.json") if folder_name == "*" else (folder / folder_name).glob("*.json")
    ):
        try:
            yield read_result(path)
        except DataError:
            continue


def file_of(record: Record, root: Path) -> Path:
    """Return the sketch or the test file that a record is of; ``root`` is where the tests were started."""
    return Path(os.path.normpath(root / record.run.node.partition("::")[0]))


def clean(folder: Path, root: Path, complete: Mapping[Path, Collection[str]]) -> None:
    """Remove the records of files that are gone, and of pictures that a test file checks no more.

    ``root`` is the folder that the tests were started in: records of others stay. ``complete``
    has, for test files of which every test ran and passed, what pictures those have checked.
    Call it when no test runs any more: a folder that is empty then is not in use.
    """
    for record in list(records_in(folder)):
        file = file_of(record, root)
        if record.run.root != str(root) or not record.run.node:
            continue
        if not file.exists() or record.shot not in complete.get(file, (record.shot,)):
            drop(folder, record)
            folder_path = folder / record.place_name
            if [path.name for path in folder_path.iterdir()] in ([], [_CLAIM]):
                (folder_path / _CLAIM).unlink(missing_ok=True)
                folder_path.rmdir()


def claim_file(path: Path, text: str) -> str:
    """Write a file, whole, unless another process has been faster; return what is there then."""
    draft = path.with_name(f"{path.name}.{secrets.token_hex(6)}.draft")
    try:
        write_file(draft, text)
        try:
            os.link(draft, path)  # unlike a renaming, it fails where one is there
        except FileExistsError:
            pass
        except OSError:  # a file system without links
            if not path.exists():
                draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
    return path.read_text("utf-8")


# ── properties for --junitxml ────────────────────────────────────────────────


def properties_of(folder: Path, record: Record) -> list[tuple[str, object]]:
    """Return the properties of a record that was written into the results folder ``folder``."""
    root = Path(record.run.root)
    properties = {
        SHOT: f"{record.sketch}/{record.shot}",
        "shot.result": record.word,
        "shot.renderer": record.renderer,
        "shot.reference": record.expected.reference,
        "shot.stands-in": record.expected.stands_in,
        "shot.trace": "; ".join(record.traced),
        **{f"shot.score.{name}": f"{value:.6g}" for name, value in record.numbers.items()},
        **{
            f"shot.picture.{word}": (folder.relative_to(root) / name).as_posix()
            if folder.is_relative_to(root)
            else str(folder / name)
            for word, name in record.actual.pictures.items()
        },
    }
    return [(name, value) for name, value in properties.items() if value]
