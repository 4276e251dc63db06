"""Make a new sketch folder from the files in ``new/`` or ``empty/``; it never overwrites anything."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

from playground.errors import SketchError
from playground.files import write_file
from playground.paths import shown

_HERE = Path(__file__).resolve().parent
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,63}")
_TITLE = "@TITLE@"


def make_sketch(folder: Path, *, empty: bool = False) -> Path:
    """Make the folder with ``sketch.toml`` and a kernel, and return it.

    ``empty``: a kernel of heights that gives 0 everywhere, to be written. The folder's last part is the
    sketch's name; the folder around it must exist. Raises
    ``SketchError`` where the name is not valid, or something is there already.
    """
    name = folder.name
    if not _NAME.fullmatch(name):
        message = "cannot name a sketch: a letter, then letters, digits, - and _, as my-land"
        raise SketchError(f"'{name or folder}' {message}")
    if folder.exists() or folder.is_symlink():
        raise SketchError("there is something of that name already; choose another name", file=shown(folder))
    if not folder.parent.is_dir():
        raise SketchError(f"there is no folder '{folder.parent}' to make it in", file=shown(folder))
    try:
        folder.mkdir()
        for template in sorted((_HERE / ("empty" if empty else "new")).iterdir()):
            if template.suffix == ".toml":
                text = template.read_text(encoding="utf-8").replace(_TITLE, _title(name))
                write_file(folder / template.name, text)
            elif template.suffix == ".glsl":
                shutil.copyfile(template, folder / template.name)
    except OSError as error:
        raise SketchError(f"cannot be made: {error.strerror}", file=shown(folder)) from None
    return folder


def _title(name: str) -> str:
    return re.sub(r"[-_]+", " ", name).strip().capitalize()
