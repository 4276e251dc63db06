"""Find the place of the terrain under a pixel on the graphics card, so that its heights stay there.

The ray march is that of ``engine.camera``: along the pixel's ray in steps of a texel, then the
step that goes below the ground is halved. One fragment does it, and four numbers come back.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from playground.engine.camera import Eye, ray_over
from playground.shader.own_shaders import own_shader
from playground.studio.inspect.results import TexelShader

if TYPE_CHECKING:
    import moderngl


class Ground(TexelShader):
    """Finds, in one context, places of the terrain."""

    def __init__(self, ctx: moderngl.Context) -> None:
        super().__init__(ctx, own_shader("surface_point.frag"), (1, 1))

    def under(
        self,
        eye: Eye,
        position: tuple[float, float],
        heights: moderngl.Texture,
        extent: tuple[float, float],
        relief: float,
    ) -> tuple[float, float, float] | None:
        """Return where on the terrain a place of the picture lies, and its height; None where there is sky.

        As ``engine.camera.ground_under``: the place in fractions of the picture from its lower left,
        the answer in fractions of the terrain's sides, east and north; the height as the texture has it.
        The context is the caller's to make current and to leave as it was.
        """
        result = ray_over(eye, position, heights.size, extent)
        if result is None:
            return None
        origin, way, entry, leave, steps = result
        texels = self.compute(
            {"height": heights},
            start=tuple((origin + entry * way).tolist()),
            way=tuple(way.tolist()),
            far=leave - entry,
            steps=steps,
            extent=extent,
            relief=relief,
        )
        east, north, hit, high = texels.ravel().tolist()
        return (east, north, high) if hit else None
