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
    if system == "win32":
        return _local(environment) / NAME / "state"
    if system == "darwin":
        return Path.home() / "Library" / "Application Support" / NAME
    return _xdg(environment, "XDG_STATE_HOME", ".local/state") / NAME


def cache_folder(system: str = sys.platform, environment: Mapping[str, str] = os.environ) -> Path:
    """Return the folder for what may be deleted at any time."""
    if system == "win32":
        return _local(environment) / NAME / "cache"
    if system == "darwin":
        return Path.home() / "Library" / "Caches" / NAME
    return _xdg(environment, "XDG_CACHE_HOME", ".cache") / NAME


def _xdg(environment: Mapping[str, str], variable: str, otherwise: str) -> Path:
    named = environment.get(variable, "")
    # The specification has a relative path ignored (XDG Base Directory 0.8).
    return Path(named) if Path(named).is_absolute() else Path.home() / otherwise


def _local(environment: Mapping[str, str]) -> Path:
    named = environment.get("LOCALAPPDATA", "")
    return Path(named) if named else Path.home() / "AppData" / "Local"
