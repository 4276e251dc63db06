"""Where things are, and how they are called: the GLSL library, the user's folders, files in messages.

The library is next to the package in a checkout, inside it in a wheel. For a program's state and its cache
each system has a folder:

    Linux     $XDG_STATE_HOME (~/.local/state), $XDG_CACHE_HOME (~/.cache)
    macOS     ~/Library/Application Support, ~/Library/Caches
    Windows   %LOCALAPPDATA%

in a folder of the playground's own. Nothing is created here: the writer creates the folder.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
_CANDIDATES = (_PACKAGE / "glsl", _PACKAGE.parent / "glsl")

GLSL: Path = next((folder for folder in _CANDIDATES if folder.is_dir()), _CANDIDATES[0])
"""The library's folder: kernels, techniques, pure functions, the sketches that ship."""

SKETCHES: Path = GLSL / "sketches"
"""The sketches that ship."""

CHECKOUT: Path | None = (
    _PACKAGE.parent
    if (_PACKAGE.parent / "pyproject.toml").is_file() and GLSL == _PACKAGE.parent / "glsl"
    else None
)
"""The repository's root where the package runs from one (so that its own shots are found), else None."""


SCREENSHOTS = "screenshots"
"""The folder of references, beside what they are references of."""

NAME = "terrain-shader-playground"


def state_folder(system: str = sys.platform, environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder for state that lasts from one start to the next."""
    return _folder(system, environment, "state", "Application Support", ".local/state")


def cache_folder(system: str = sys.platform, environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder for what may be deleted at any time."""
    return _folder(system, environment, "cache", "Caches", ".cache")


def _folder(system: str, environment: Mapping[str, str], kind: str, library: str, home: str) -> Path:
    if system == "win32":
        return Path(environment.get("LOCALAPPDATA") or Path.home() / "AppData" / "Local") / NAME / kind
    if system == "darwin":
        return Path.home() / "Library" / library / NAME
    named = Path(environment.get(f"XDG_{kind.upper()}_HOME", ""))
    # The specification has a relative path ignored (XDG Base Directory 0.8).
    return (named if named.is_absolute() else Path.home() / home) / NAME


PART_OF_FILE = ":"
"""What comes between a file and its part in a diagnostic's place, as "shader.json:Buffer A"."""


def without_part(name: str) -> str:
    """Return the file that a name is of: of "shader.json:Buffer A" the first."""
    whole, colon, _ = name.rpartition(PART_OF_FILE)
    return whole if colon and whole.endswith(".json") else name


def quoted(text: str) -> str:
    """Return a word as the shell takes it."""
    if sys.platform == "win32":
        return f'"{text}"' if " " in text else text
    import shlex

    return shlex.quote(text)


def program() -> str:
    """Return how the shell starts this program: as ``./play`` was started, where it did."""
    return quoted(os.environ.get("PLAYGROUND_PROGRAM", "playground"))


_current = Path("/")


def shown(path: str | Path) -> str:
    """Name a file as its user would: from the current folder, from ``glsl/``, else whole."""
    full = Path(path)
    if not full.is_absolute():
        return full.as_posix()
    for base, prefix in ((current_folder(), ""), (GLSL, "glsl/")):
        if full.is_relative_to(base):
            return prefix + full.relative_to(base).as_posix()
    return str(full)


def current_folder() -> Path:
    """Return the current folder, or what it was called last where it has been deleted since."""
    global _current
    try:
        _current = Path.cwd()
    except FileNotFoundError:
        pass
    return _current


DEFAULT_SKETCH = "october"
"""What opens when no sketch is named."""
PLAIN_SKETCH = "jacksboro"
"""In which a technique is shown that is opened alone: a height, a colour and a light, little else."""
