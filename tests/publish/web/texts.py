"""What tests of the text hand to the runtime: the files of the library, and every program in it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from playground.paths import GLSL
from playground.shader.header import parsed_kernel
from playground.sketch.model import Kernel


def shared_files(folder: Path, prefix: str = "") -> dict[str, object]:
    """Return the texts of a folder as a page has them, with nothing known of what they include."""
    files = {
        prefix + path.relative_to(folder).as_posix(): path.read_text("utf-8")
        for path in sorted(folder.rglob("*.glsl"))
    }
    return {"files": files, "includes": {}}


@cache
def kernels() -> dict[str, Kernel]:
    """Return every kernel and every draw of the library, by the name of its file."""
    result = {}
    for path in sorted(GLSL.rglob("*.glsl")):
        name = path.relative_to(GLSL).as_posix()
        kernel = parsed_kernel(name, path, [])
        if kernel and kernel.kind in ("kernel", "draw"):
            result[name] = kernel
    return result
