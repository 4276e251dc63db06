"""Gather what the sketches of a page share: see ``Shared`` in schema.js."""

from __future__ import annotations

from typing import Any

from playground.publish.web.blobs import Blobs
from playground.publish.web.images import Images
from playground.publish.web.texts import Texts
from playground.shader.own_shaders import own_shader
from playground.shader.reserved_names import GIVEN

_OWN = ("copy.frag", "spread.frag", "fill_between.frag", "changed.frag", "triangle.vert")


class SharedData:
    """Files, images and bytes, each once."""

    def __init__(self) -> None:
        self.blobs = Blobs()
        self.texts = Texts()
        self.images = Images(self.blobs)

    def data(self) -> dict[str, Any]:
        """Return all of it, in an order that is the same for the same sketches."""
        return {
            "files": dict(sorted(self.texts.files.items())),
            "includes": {name: self.texts.includes[name] for name in sorted(self.texts.includes)},
            "given": {name: list(pair) for name, pair in GIVEN.items()},
            "own": {name: own_shader(name) for name in _OWN},
            "images": dict(sorted(self.images.data.items())),
            "blobs": dict(sorted(self.blobs.texts.items())),
        }
