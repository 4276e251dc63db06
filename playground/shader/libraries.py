"""Find GLSL libraries whose folders the user named once, so that ``#include "lygia/…"`` is found.

Their names are in one small JSON file in the user's state folder, the same for every sketch. The
environment variable ``PLAYGROUND_LIBRARIES`` names more, as ``lygia=FOLDER``, separated as in ``PATH``;
it takes precedence. No library ships, and none is packed.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from playground.allowed_files import is_inside, names_below, note
from playground.errors import DataError, ParameterError, nearest
from playground.files import partial_file, read_regular
from playground.json_text import read_json
from playground.paths import program, state_folder

VARIABLE = "PLAYGROUND_LIBRARIES"
ENDINGS = (".glsl", ".frag", ".vert", ".hlsl", ".fs", ".h")
FORMAT = 1
_MAX_BYTES = 2**16  # [bytes]
_NAME = re.compile(r"[A-Za-z_][\w.-]{0,39}")


def libraries_file() -> Path:
    """Return where the names are remembered."""
    return state_folder() / "libraries.json"


def libraries(environment: Mapping[str, str] = os.environ) -> dict[str, Path]:
    """Return the folder of each library by its name; those of the environment come last, and count.

    Raises ``DataError`` where the file of names cannot be read, ``ParameterError`` for a variable
    that is no list of names and folders.
    """
    return {**remembered(), **_in_environment(environment.get(VARIABLE, ""))}


def remembered() -> dict[str, Path]:
    """Return the libraries that were named by ``playground library add``; raise ``DataError``."""
    path = libraries_file()
    note(path)
    try:
        if path.stat().st_size > _MAX_BYTES:
            raise ValueError(f"it is larger than {_MAX_BYTES} bytes")
        table = read_json(read_regular(path).decode())
        if table["format"] != FORMAT:
            raise ValueError(f"it has format {table['format']}, and this version knows {FORMAT}")
        return {str(name): Path(str(folder)) for name, folder in table["libraries"].items()}
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, TypeError, KeyError, AttributeError) as error:
        message = f"does not list libraries ({error}); remove it, and name them again"
        raise DataError(message, file=path) from None


def add_library(name: str, folder: str | Path) -> Path:
    """Remember a library's folder by its name, and return it whole; a name that is known gets this folder.

    Raises ``ParameterError`` for what is no name, ``DataError`` for a folder without shaders.
    """
    if not _NAME.fullmatch(name):
        raise ParameterError(f"'{name}' is no name of a library: expected letters, digits, '_' and '-'")
    path = Path(folder).expanduser().absolute()
    if not path.is_dir():
        raise DataError("there is no such folder", file=folder)
    if not names_below((path,), ENDINGS):
        raise DataError(f"holds no shader ({', '.join(ENDINGS)}), so it is no library", file=folder)
    if (path / name).is_dir() and not any(path.glob("*.glsl")):
        raise DataError(f"holds a folder '{name}'; name that one, {path / name}", file=folder)
    _remember({**remembered(), name: path})
    return path


def remove_library(name: str) -> None:
    """Forget a library; its folder stays. Raises ``ParameterError`` for one that was never named."""
    folders = remembered()
    if name not in folders:
        raise ParameterError(f"no library '{name}' was named{nearest(name, folders)}")
    _remember({library_name: folder for library_name, folder in folders.items() if library_name != name})


def libraries_of(files: Iterable[str | Path]) -> dict[str, list[Path]]:
    """Return those of some files that lie in a named library, by its name."""
    paths: dict[str, list[Path]] = {}
    for file in map(Path, files):
        name = library_around(file, libraries())
        if name:
            paths.setdefault(name, []).append(file)
    return paths


def library_around(file: Path, paths: Mapping[str, Path]) -> str:
    """Return the library that a file lies in, the innermost of several; "" for none."""
    around = [name for name, folder in paths.items() if is_inside(file, (folder,))]
    return max(around, key=lambda name: len(paths[name].parts), default="")


def how_to_name(name: str) -> str:
    """Return how a library's folder is named, as a command."""
    return f"{program()} library add {name} FOLDER"


def _remember(paths: Mapping[str, Path]) -> None:
    path = libraries_file()
    table = {"format": FORMAT, "libraries": {name: str(paths[name]) for name in sorted(paths)}}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with partial_file(path) as partial:
            partial.handle.write(json.dumps(table, indent=1, ensure_ascii=False).encode())
            partial.rename(path)
    except OSError as error:
        raise DataError(f"cannot be written to: {error.strerror or error}", file=path) from None


def _in_environment(text: str) -> dict[str, Path]:
    paths: dict[str, Path] = {}
    for part in filter(str.strip, text.split(os.pathsep)):
        name, equals, folder = (piece.strip() for piece in part.partition("="))
        if not equals or not folder or not _NAME.fullmatch(name):
            raise ParameterError(f"{VARIABLE}: expected NAME=FOLDER, found '{part}'")
        paths[name] = Path(folder).expanduser().absolute()
    return paths
