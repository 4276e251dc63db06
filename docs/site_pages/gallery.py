"""Generate the gallery: every picture that the shipped sketches promise."""

from __future__ import annotations

from .markdown import code, escaped
from .shots import pictures, sketches

_HEAD = """# Gallery

Every picture that the sketches of this project promise, as the software renderer (llvmpipe) draws
it. They are the references of the screenshot tests, made small. `playground live NAME` opens a sketch.

"""


def page() -> str:
    """Return the page of all pictures, by sketch."""
    parts = [_HEAD]
    for sketch in sketches():
        result = pictures(sketch)
        if not result:
            continue
        parts.append(f"## {escaped(sketch.title)} {{ #{sketch.name} }}\n\n")
        parts.append(f"{code(f'playground live {sketch.name}')}\n\n" + '<div class="catalogue" markdown>\n\n')
        for picture in result:
            alt = f"{sketch.title}, {picture.shot}"
            image = f"![{escaped(alt)}](../{picture.thumbnail}){{ loading=lazy }}"
            parts.append(f"{image} {code(picture.shot)}\n{{ .card }}\n\n")
        parts.append("</div>\n\n")
    return "".join(parts)
