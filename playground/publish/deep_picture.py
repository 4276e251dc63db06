"""Draw a picture in more than 8 bits: a PNG of 16, or an EXR of the light in floats.

What makes a picture writes 8 bits, as a screen shows them. Here those textures are floats instead, so that no
number is rounded: to the nearest of 255 the picture is the usual one. It is drawn whole, and so is no larger
than a texture may be.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import encode_samples
from playground.engine.engine import Engine
from playground.engine.plan import drawn_size
from playground.engine.textures import read_texture
from playground.errors import DataError
from playground.files import write_file
from playground.publish.large import max_side
from playground.publish.texture_encoding import encode_exr
from playground.shader.colours import linear_to_srgb, srgb_to_linear
from playground.shader.kernel import with_inner
from playground.sketch.model import Graph, Sketch, Technique

ENDINGS = (".exr", ".png")
_BYTES = {"r8": "r32f", "rg8": "rg32f", "rgba8": "rgba32f"}


def check_deep(engine: Engine, sketch: Sketch, size: tuple[int, int]) -> None:
    """Raise ``PlaygroundError`` for a size in pixels in which no such picture can be drawn here."""
    most = max_side(engine) // sketch.picture.supersample
    if max(size) > most:
        raise DataError(
            f"a picture of more than 8 bits is drawn whole, here with at most {most} pixels a side; "
            f"one of {size[0]} x {size[1]} pixels can be a PNG of 8 bits"
        )
    drawn_size(sketch, size)


def read_deep(
    engine: Engine,
    sketch: Sketch,
    size: tuple[int, int],
    *,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
) -> NDArray[np.float32]:
    """Draw a picture and return it in floats, (height, width, 4), top row first, sRGB and straight alpha.

    ``size`` in pixels; ``time`` and ``steps`` as in ``Engine.render``. Raises as that does, and as
    ``check_deep``.
    """
    check_deep(engine, sketch, size)
    deep, times = _deepened(sketch), sketch.picture.supersample
    values = read_texture(engine.draw(deep, size=drawn_size(sketch, size), time=time, steps=steps))[::-1]
    picture = np.zeros((*values.shape[:2], 4), np.float32)
    picture[..., 3] = 1.0
    if values.ndim == 2:
        picture[..., :3] = values[..., None]
    else:
        picture[..., : values.shape[2]] = values
    return _reduced(picture, times) if times > 1 else picture


def save_deep(
    engine: Engine,
    sketch: Sketch,
    path: Path,
    size: tuple[int, int],
    *,
    time: float = 0.0,
    steps: Mapping[str, int] | None = None,
) -> None:
    """Write a picture by the path's ending, whole or not at all, from what ``read_deep`` returns.

    ``.png`` has 16 bits a channel, sRGB, straight alpha; ``.exr`` float32, linear light, its colours
    multiplied by their alpha as the format wants.
    """
    picture = read_deep(engine, sketch, size, time=time, steps=steps)
    if path.suffix.lower() == ".png":
        tidy = np.clip(np.nan_to_num(picture, nan=0.0), 0.0, 1.0).astype(np.float64)
        write_file(path, encode_samples(np.rint(tidy * 65535.0).astype(np.uint16)))
        return
    light = srgb_to_linear(picture[..., :3]) * picture[..., 3:]
    data = np.concatenate([light, picture[..., 3:]], axis=-1).astype(np.float32)
    write_file(path, encode_exr(data, "linear light of what a screen shows, primaries of sRGB"))


def _deepened(sketch: Sketch) -> Sketch:
    """Return a sketch whose view makes floats wherever it made bytes."""
    passes = sketch.graph.passes
    view = replace(passes[-1], technique=_in_floats(passes[-1].technique))
    return replace(sketch, graph=replace(sketch.graph, passes=(*passes[:-1], view)))


def _in_floats(technique: Technique) -> Technique:
    """Return a technique of the same passes, whose textures are no bytes; without those that replace it."""
    if isinstance(technique, Graph):
        return replace(with_inner(technique, _in_floats), variants=())
    outputs = tuple(replace(o, format=_BYTES.get(o.format, o.format)) for o in technique.outputs)
    return technique if outputs == technique.outputs else replace(technique, outputs=outputs, variants=())


def _reduced(picture: NDArray[np.float32], times: int) -> NDArray[np.float32]:
    """Return the mean light of each square of so many pixels a side; colours count by their alpha."""
    height, width = picture.shape[0] // times, picture.shape[1] // times
    squares = picture.reshape(height, times, width, times, 4).astype(np.float64)
    alpha = squares[..., 3:]
    light = (srgb_to_linear(squares[..., :3]) * alpha).sum(axis=(1, 3))
    whole = alpha.sum(axis=(1, 3))
    mean = linear_to_srgb(light / np.maximum(whole, 1e-12))
    return np.concatenate([mean, whole / times**2], axis=-1).astype(np.float32)
