"""Write a figure of a notebook as HTML that is live without a kernel, without widgets, without a network.

It is a picture, the state of the widget, the runtime, and a script of a few lines that starts them
(saved.js). Where scripts are taken away, as on GitHub, the picture is left. Each figure of a notebook holds
the runtime, since any of them may be shown alone; a page needs it once, so ``without_runtime`` takes it out
of the others.
"""

from __future__ import annotations

import base64
import hashlib
import io
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from PIL import Image

from playground.markup import Markup, tag
from playground.memo import INTERFACE
from playground.publish.web.blobs import packed_json
from playground.publish.web.bundle import read_bundle

STATE = (
    *("kind", "page", "language", "alt", "values"),
    *("labels", "controls"),  # of a lesson's block
    *("sides", "names", "rows", "swipe", "size", "left", "right", "camera", "time"),  # of sketches
)
"""The traits that a live figure needs, of those that its widget has."""

_STILL = {
    "en": "This figure stands still, because it cannot be started here: {reason}",
    "fr": "Cette figure reste fixe, car elle ne peut pas être lancée ici : {reason}",
}
_QUALITY = 85  # of WebP
_RUNTIME = re.compile(r'<script type="application/gzip" data-terrain-runtime="(\w+)">[\w+/=]*</script>')


@dataclass(frozen=True)
class Runtime:
    """What draws figures: a module and its style."""

    key: str  # a hash
    packed: str

    @property
    def element(self) -> Markup:
        """The element of a page that holds it."""
        return tag("script", self.packed, type="application/gzip", data_terrain_runtime=self.key)


@INTERFACE.cached()
def runtime_of(esm: str, css: str) -> Runtime:
    """Return a runtime by the texts that a widget has of it."""
    packed = packed_json({"esm": esm, "css": css})
    return Runtime(hashlib.sha256(packed.encode()).hexdigest()[:16], packed)


def shipped_runtime() -> Runtime:
    """Return today's runtime; raise ``PlaygroundError`` where it is not built."""
    return runtime_of(read_bundle("notebook.js"), read_bundle("notebook.css"))


def saved_figure(state: Mapping[str, Any], png: bytes, runtime: Runtime) -> Markup:
    """Return a figure as HTML: ``state`` has a widget's traits, ``png`` is its picture."""
    picture = Image.open(io.BytesIO(png)).convert("RGB")
    stream = io.BytesIO()
    picture.save(stream, "WEBP", quality=_QUALITY, method=4)
    image = tag(
        "img",
        src=f"data:image/webp;base64,{base64.b64encode(stream.getvalue()).decode()}",
        alt=state["alt"],
        width=picture.width,
        height=picture.height,
        style="max-width:100%;height:auto",
    )
    kept = packed_json({name: state[name] for name in STATE if name in state})
    return tag(
        "div",
        tag("div", image),
        tag("script", kept, type="application/gzip", data_terrain_state=True),
        runtime.element,
        tag("script", Markup(_script())),
        data_terrain_saved=runtime.key,
        data_still=_STILL["fr" if state["language"].startswith("fr") else "en"],
    )


def runtimes_in(html: str) -> set[str]:
    """Return the keys of the runtimes that some HTML holds."""
    return set(_RUNTIME.findall(html))


def without_runtime(html: str, keys: set[str]) -> str:
    """Return HTML without the runtimes that a page has already."""
    return _RUNTIME.sub(lambda match: "" if match[1] in keys else match[0], html)


@cache
def _script() -> str:
    return (Path(__file__).parent / "saved.js").read_text(encoding="utf-8")
