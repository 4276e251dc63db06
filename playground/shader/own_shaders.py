"""Read the playground's own GLSL: what wraps a kernel's text, and small programs besides the passes.

A file ending in .vert or .frag is a whole shader; of the others each is a part of one. ``$name`` in a
part is filled in: names and types that a kernel's header declares.
"""

from __future__ import annotations

from pathlib import Path
from string import Template

from playground.memo import TEXTS

_FOLDER = Path(__file__).parent / "shaders"


@TEXTS.cached()
def own_shader(name: str) -> str:
    """Return the text of a file."""
    return (_FOLDER / name).read_text(encoding="utf-8")


def own_part(part: str, **names: str) -> str:
    """Return the text of a part with its names filled in, without its last line's end."""
    return Template(own_shader(part)).substitute(names).rstrip("\n")


TRIANGLE = own_shader("triangle.vert")
"""The vertex shader of one triangle that covers a whole target: draw three vertices without a buffer."""
