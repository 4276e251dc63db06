"""Small pictures of textures: drawn small by the graphics card, only when stale, one at a time."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from playground.engine.textures import make_texture
from playground.shader.colours import linear_to_srgb
from playground.shader.own_shaders import own_shader
from playground.studio.inspect.results import TexelShader, Version, result_of
from playground.studio.session import Session

if TYPE_CHECKING:
    import moderngl

SIDE = 64
"""Texels of a thumbnail."""
APART = 0.1
"""[s] from one that is drawn to the next."""
_NO_NUMBER = (1.0, 0.0, 1.0)


class Thumbnails:
    """The thumbnails of one session's textures, by name."""

    def __init__(self, session: Session) -> None:
        self.session = session
        self.made = 0  # how many were drawn so far
        self._cached: dict[str, tuple[object, moderngl.Texture]] = {}  # what each is of, and the thumbnail
        self._shrink: TexelShader | None = None
        self._last = -APART

    def get(self, name: str) -> moderngl.Texture | None:
        """Return the thumbnail of "pass:output" as it was drawn last, ``SIDE`` texels a side; rgba8."""
        cached = self._cached.get(name)
        return cached[1] if cached is not None else None

    def is_current(self, name: str) -> bool:
        """Return whether the last picture was made from this very texture."""
        source, cached = self._source(name), self._cached.get(name)
        return source is not None and cached is not None and cached[0] == source[1]

    def refresh(self, names: Iterable[str], now: float) -> bool:
        """Draw the first that is stale, unless another was drawn a moment ago; return whether more are stale.

        ``now``: seconds of any clock. What has another name is released.
        """
        names_shown = list(names)
        for name in [name for name in self._cached if name not in names_shown]:
            self._cached.pop(name)[1].release()
        stale = [n for n in names_shown if self._source(n) is not None and not self.is_current(n)]
        if stale and now - self._last >= APART and not self.session.awaits_data:
            self._last = now
            self._draw(stale.pop(0))
        return bool(stale)

    def release(self) -> None:
        """Release all of them; they are drawn again where they are needed."""
        cached, self._cached = self._cached, {}
        shrink, self._shrink = self._shrink, None
        for _, texture in cached.values():
            texture.release()
        if shrink is not None:
            shrink.release()

    def _draw(self, name: str) -> None:
        source = self._source(name)
        assert source is not None
        texture, of = source
        engine = self.session.engine
        if self._shrink is not None and self._shrink.ctx is not engine.ctx:
            self._shrink, self._cached = None, {}  # they went with a context that was lost
        with engine.borrowed():
            if self._shrink is None:
                self._shrink = TexelShader(engine.ctx, own_shader("thumbnail.frag"), (SIDE, SIDE))
            values = self._shrink.compute({"shown": texture}, side=float(SIDE))
            cached = self._cached.get(name)
            small = cached[1] if cached is not None else make_texture(engine.ctx, (SIDE, SIDE), "rgba8")
            small.filter = (engine.ctx.LINEAR, engine.ctx.LINEAR)
            small.write(picture_of(values, texture.components, encoded=texture.dtype == "f1").tobytes())
        self._cached[name] = of, small
        self.made += 1

    def _source(self, name: str) -> tuple[moderngl.Texture, Version] | None:
        if name.partition(":")[0].partition(".")[0] == "view" and self.session.view.map is not None:
            return None  # that is the map
        return result_of(self.session, name)


def picture_of(values: NDArray[np.float32], components: int, *, encoded: bool) -> NDArray[np.uint8]:
    """Return texels, (ny, nx, 4), as a picture of bytes.

    One or two components are numbers, from the least to the greatest; more are light, and
    ``encoded`` colours are as the eye takes them already.
    What is no number is magenta.
    """
    shown = values[..., :1] if components < 3 else values[..., :3]
    finite = np.isfinite(shown)
    tidy = np.where(finite, shown, 0.0).astype(np.float64)
    if components < 3:
        low = float(tidy[finite].min()) if finite.any() else 0.0
        high = float(tidy[finite].max()) if finite.any() else 0.0
        tidy = np.repeat((tidy - low) / ((high - low) or 1.0), 3, axis=2)
        finite = np.repeat(finite, 3, axis=2)
    else:
        tidy = np.clip(tidy, 0.0, 1.0)
        tidy = tidy if encoded else np.asarray(linear_to_srgb(tidy))
    colour = np.where(finite.all(axis=2, keepdims=True), tidy, np.array(_NO_NUMBER))
    alpha = np.ones((*colour.shape[:2], 1))
    whole: NDArray[np.float64] = np.concatenate([colour, alpha], axis=2)
    return np.rint(np.clip(whole, 0, 1) * 255).astype(np.uint8)
