"""Name the command that installs an extra into this installation: the one home of that command.

An installation is a checkout that ``./play`` started, a checkout in another environment, or a wheel, whose
extras are the packages that its metadata list: this distribution is on no package index.
"""

from __future__ import annotations

import importlib.util
import json
import re
import shutil
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from playground.paths import CHECKOUT, current_folder, quoted

if TYPE_CHECKING:
    from importlib.metadata import Distribution

DISTRIBUTION = "terrain-shader-playground"

EXTRAS = {
    "bench": "the benchmark's peers and plots",
    "docs": "the documentation's site",
    "gis": "vector data in GeoPackage, Shapefile and other formats",
    "lsp": "diagnostics and completion in your editor",
    "microphone": "sound from a microphone",
    "midi": "MIDI controllers",
    "models": "glTF models on the ground",
    "notebook": "widgets and lessons in notebooks",
    "osc": "Open Sound Control",
    "remote": "a remote in a browser",
    "research": "sweeps as xarray data",
    "test": "the tests",
    "video": "films, sounds and cameras",
}
"""What each extra of ``pyproject.toml`` is for."""


def needs(what: str, package: str, extra: str) -> str:
    """Return the sentence on a missing package: what needs it, and the command that installs it here."""
    return f"{what} needs {package}: {install_command(extra)}"


def install_command(extra: str) -> str:
    """Return the shell's command that installs an extra into this installation."""
    if CHECKOUT is not None:
        if _is_of_play(CHECKOUT):
            return f"{_play(CHECKOUT)} add {extra}"
        return f"{_pip_install()} -e {_in_quotes(f'{CHECKOUT}[{extra}]')}"
    return f"{_pip_install()} {' '.join(map(_in_quotes, requirements(extra)))}"


def reinstall_command() -> str:
    """Return the shell's command that installs this distribution again, from where it came."""
    again = f"{_pip_install()} --force-reinstall --no-deps"
    if CHECKOUT is not None:
        return f"{again} -e {_in_quotes(str(CHECKOUT))}"
    distribution = _distribution()
    source = json.loads(distribution.read_text("direct_url.json") or "{}") if distribution else {}
    return f"{again} {_in_quotes(source.get('url', 'FILE.whl'))}"


def requirements(extra: str) -> list[str]:
    """Return the requirements of an extra as pip takes them, with their conditions on the system."""
    distribution = _distribution()
    return list(_of_extra(extra, distribution.requires or [] if distribution else [])) or [
        f"{DISTRIBUTION}[{extra}]"
    ]


def _distribution() -> Distribution | None:
    """Return what is installed; None where the package is imported from a folder alone."""
    from importlib import metadata

    try:
        return metadata.distribution(DISTRIBUTION)
    except metadata.PackageNotFoundError:
        return None


def _of_extra(extra: str, listed: Sequence[str]) -> Iterator[str]:
    for requirement in listed:
        needed, _, marker = (part.strip() for part in requirement.partition(";"))
        condition, _, last = marker.rpartition("extra ==")
        if last.strip(" '\"") != extra:
            continue
        if needed.startswith(f"{DISTRIBUTION}["):
            yield from _of_extra(needed.partition("[")[2].rstrip("]"), listed)
            continue
        condition = condition.strip().removesuffix("and").strip().replace('"', "'")
        condition = re.sub(r"^\(([^()]*)\)$", r"\1", condition)
        yield f"{needed}; {condition}" if condition else needed


def _is_of_play(checkout: Path) -> bool:
    """Return whether this is the environment of a checkout that ``./play`` keeps."""
    venv = checkout / ".venv"
    return Path(sys.prefix).resolve() == venv.resolve() and any(venv.glob("*play-stamp*"))


def _play(checkout: Path) -> str:
    """Return how the shell starts a checkout's ``play`` from the current folder."""
    on_windows = sys.platform == "win32"
    if current_folder() == checkout:
        return "play" if on_windows else "./play"
    return quoted(str(checkout / ("play.cmd" if on_windows else "play")))


def _pip_install() -> str:
    """Return how the shell installs by pip into this Python; uv makes environments without pip."""
    python = quoted(sys.executable or "python")
    if importlib.util.find_spec("pip") is None and shutil.which("uv"):
        return f"uv pip install --python {python}"
    return f"{python} -m pip install"


def _in_quotes(text: str) -> str:
    """Return a word in double quotes, which cmd.exe and zsh take too."""
    special = "" if sys.platform == "win32" else '\\"$`'
    return '"' + "".join(f"\\{letter}" if letter in special else letter for letter in text) + '"'
