"""Find the folders of this system for a program's state and for its cache.

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
