"""Find the GLSL library: next to the package in a checkout, inside it in a wheel."""

from __future__ import annotations

import os
import sys
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
