"""Find the textures that a session's last picture was made from, and compute texels from them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.textures import make_framebuffer, make_texture
from playground.studio.picture.full_screen import FullScreen
from playground.studio.session import Session

if TYPE_CHECKING:
    import moderngl

Version = tuple[int, int, int]
"""Changes whenever the numbers of a texture may have: its pass ran again, or another engine did."""


def result_of(session: Session, name: str) -> tuple[moderngl.Texture, Version] | None:
    """Return the texture "pass:output" of the last picture, and its version; None where it had none."""
    plan, engine = session.plan, session.engine
    path, _, output = name.partition(":")
    ref = plan.flat.outputs.get(path, {}).get(output) if plan is not None else None
    result = engine.record.results.get(ref.path) if ref is not None else None
    if ref is None or result is None or ref.output not in result.textures:
        return None
    return result.textures[ref.output], (id(engine), result.number, engine.runs[ref.path])


class TexelShader(FullScreen):
    """Computes a few texels, rgba32f, with a fragment shader; the context is its caller's."""

    def __init__(self, ctx: moderngl.Context, fragment_shader: str, size: tuple[int, int]) -> None:
        super().__init__(ctx, fragment_shader)
        self._texture = make_texture(ctx, size, "rgba32f")
        self._framebuffer = make_framebuffer(ctx, [self._texture])

    def compute(self, textures: Mapping[str, moderngl.Texture], **uniforms: Any) -> NDArray[np.float32]:
        """Return the texels, (height, width, 4), the lowest row first."""
        self.draw(self._framebuffer, textures, **uniforms)
        width, height = self._texture.size
        return np.frombuffer(self._texture.read(), np.float32).reshape(height, width, 4)

    def release(self) -> None:
        """Release the program and its texture."""
        self._framebuffer.release()
        self._texture.release()
        super().release()
