"""Gather what the sketches of a page share: see ``Shared`` in schema.js.

Image files are decoded as the engine decodes them. Eight bits stay as the file has them (the sampler makes
them linear where a kernel asks for that); sixteen become half floats as on the engine's card. Decoders of
JPEG differ between browsers, so that files are decoded here; what has no transparency travels as lossless
WebP, which every browser with WebGL2 decodes to the same texels, all else as the texels themselves.
"""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data.content_hash import content_hash
from playground.data.image_files import MAX_HALF, read_image
from playground.publish.web.blobs import Blobs
from playground.publish.web.texts import Texts
from playground.shader.colours import srgb_to_linear
from playground.shader.own_shaders import own_shader
from playground.shader.reserved_names import GIVEN

_OWN = ("copy.frag", "spread.frag", "fill_between.frag", "changed.frag", "triangle.vert")
_MAX_WEBP_SIDE = 16_383


class Images:
    """The image files of a page, by key: see ``Shared.images`` in schema.js."""

    def __init__(self, blobs: Blobs) -> None:
        self.blobs = blobs
        self.data: dict[str, dict[str, Any]] = {}

    def add(self, path: Path, *, encoded: bool) -> str:
        """Return the key of an image; ``encoded``: its colours are read as the file has them."""
        key = f"{content_hash(path)[:12]}-{'encoded' if encoded else 'linear'}"
        if key not in self.data:
            pixels = read_image(path).pixels
            eight = pixels.dtype == np.uint8
            entry: dict[str, Any] = {"size": [pixels.shape[1], pixels.shape[0]]}
            if not eight:
                entry |= {"kind": "rgba16f", "blob": self.blobs.add(_halves(pixels, encoded).tobytes())}
            else:
                entry["kind"] = "rgba8" if encoded else "srgb8"
                file = _lossless(pixels)
                entry["blob"] = self.blobs.add(file or np.ascontiguousarray(pixels[::-1]).tobytes())
                if file:
                    entry["file"] = "image/webp"
            self.data[key] = entry
        return key


def _halves(pixels: NDArray[Any], encoded: bool) -> NDArray[np.float16]:
    """Return numbers as half floats, row 0 south."""
    texels = pixels[::-1].astype(np.float64)
    if not encoded:
        texels[..., :3] = srgb_to_linear(texels[..., :3])
    with np.errstate(under="ignore"):
        return np.ascontiguousarray(np.clip(texels, -MAX_HALF, MAX_HALF).astype(np.float16))


def _lossless(pixels: NDArray[Any]) -> bytes:
    """Return opaque pixels, top row first, as a lossless WebP; nothing for others."""
    import PIL.Image

    if (pixels[..., 3] != 255).any() or max(pixels.shape[:2]) > _MAX_WEBP_SIDE:
        return b""
    stream = io.BytesIO()
    picture = PIL.Image.fromarray(np.ascontiguousarray(pixels[..., :3]))
    picture.save(stream, "WEBP", lossless=True, quality=75, method=4)
    return stream.getvalue()


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
