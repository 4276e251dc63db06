"""Export a sketch as a web page: one HTML file with its data, the runtime, and the picture as a poster."""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from playground.engine.engine import Engine
from playground.engine.frame import Frame
from playground.errors import DataError
from playground.publish.web.blobs import bytes_in_page
from playground.publish.web.bundle import read_bundle
from playground.publish.web.page import Poster, page_html
from playground.publish.web.page_data import page_data
from playground.sketch.model import DEFAULT_PICTURE, Sketch

MAX_PAGE_BYTES = 32 * 2**20
"""Bytes of a page: a phone opens no larger one in a time that anybody waits."""
POSTER_WIDTH = 960
"""Pixels of the poster at most."""
_QUALITY = 82


@dataclass(frozen=True)
class WebPage:
    """A page that is written but for its poster."""

    data: Mapping[str, Any]
    script: str
    style: str
    steps: Mapping[str, int]
    time: float
    frame: tuple[int, int]

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what the page does otherwise than the sketch, or cannot."""
        notes = [note for sketch in self.data["sketches"] for note in sketch["notes"]]
        return tuple(dict.fromkeys(notes))


def prepare_page(
    engine: Engine,
    sketch: Sketch,
    path: Path,
    techniques: Mapping[str, tuple[str, ...]],
    *,
    frame: tuple[int, int] | None = None,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
    traces: bool = False,
) -> WebPage:
    """Write down a sketch for a page; raise ``PlaygroundError`` for what no page can run, or is too large.

    ``frame`` is the picture's size in pixels at first; None for the usual one. The engine draws what
    sources are made of, once for all combinations of techniques. With ``traces`` the page shows the values
    of a texel beside the code.
    """
    size, stops = frame or DEFAULT_PICTURE, dict(steps or {})
    parts = ("trace", "page") if traces else ("page",)  # what traces hand to a page is there before it begins
    style, script = ("".join(read_bundle(f"{part}.{kind}") for part in parts) for kind in ("css", "js"))
    at: dict[str, Any] = {"frame": size, "time": time, "steps": stops, "traces": traces}
    data = page_data([sketch], **at, techniques=techniques, engine=engine)
    bytes_of_data = bytes_in_page(data["shared"]["blobs"])
    if bytes_of_data > MAX_PAGE_BYTES:
        largest = f"at most {MAX_PAGE_BYTES // 2**20} MiB; a smaller terrain, image or film would do"
        raise DataError(f"its data would be {bytes_of_data / 2**20:.0f} MiB of a page, {largest}", file=path)
    return WebPage(data, script, style, stops, time, size)


def page_bytes(engine: Engine, sketch: Sketch, page: WebPage, language: str = "en") -> tuple[bytes, str]:
    """Return a page in a language of ``LANGUAGES``, its poster drawn, and a line on what it holds."""
    width, height = page.frame
    scale = min(1.0, POSTER_WIDTH / width)
    size = (max(round(width * scale), 1), max(round(height * scale), 1))
    poster = encoded_poster(engine.render(sketch, size=size, time=page.time, steps=page.steps))
    html = page_html(page.data, poster, script=page.script, style=page.style, language=language).encode()
    inside = bytes_in_page(page.data["shared"]["blobs"]) + len(poster.data) * 4 // 3
    count = len(page.data["sketches"])
    parts = [
        f"{len(html) / 1024:.0f} KiB",
        f"{inside / 1024:.0f} KiB of them data and poster" if inside else "",
        f"{count} sketches" if count > 1 else "",
        f"{len(page.data['shared']['files'])} texts to edit",
    ]
    return html, "; ".join(filter(None, parts))


def encoded_poster(frame: Frame) -> Poster:
    """Return a picture as WebP, much smaller than a PNG and the same wherever it is decoded."""
    import PIL.Image

    pixels = np.ascontiguousarray(frame.array[..., :3])
    stream = io.BytesIO()
    PIL.Image.fromarray(pixels).save(stream, "WEBP", quality=_QUALITY, method=4)
    return Poster(stream.getvalue(), "image/webp", (pixels.shape[1], pixels.shape[0]))
