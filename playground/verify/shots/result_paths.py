"""Resolve where in the results folder a sketch's records are, and remove those that mean nothing any more.

Sketches of one name in several folders, and test files of one name, are several: the first to
come has the folder of that name, each other one its own, ``hills-1a2b3c4d``. ``.home`` in the
first says whose it is, so that a later run, and another process, finds the same.
"""

from __future__ import annotations

import hashlib
import os
import secrets
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path

from playground.errors import DataError
from playground.files import write_file
from playground.verify.shots.results import PICTURES, Record, make_results_folder, read_result

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
    if not claim.is_file():
        _put(claim, key)
    return sketch if claim.read_text("utf-8") == key else f"{sketch}-{_digest(key)}"


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


def _put(claim: Path, key: str) -> None:
    """Write a claim, whole, unless another process has been faster."""
    draft = claim.with_name(f"{_CLAIM}.{secrets.token_hex(6)}")
    write_file(draft, key)
    try:
        os.link(draft, claim)  # unlike a renaming, it fails where one is there
    except FileExistsError:
        pass
    except OSError:  # a file system without links
        if not claim.exists():
            draft.replace(claim)
    finally:
        draft.unlink(missing_ok=True)


def _digest(key: str) -> str:
    return hashlib.sha256(key.encode()).hexdigest()[:8]
