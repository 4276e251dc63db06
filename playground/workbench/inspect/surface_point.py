"""Find the place of the land under a pixel on the graphics card, so that its heights stay there.

The walk is that of ``terrain.pick``: along the pixel's ray in steps of a texel, then the
step that goes below the ground is halved. One fragment does it, and four numbers come back.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from playground.gpu.textures import make_framebuffer, make_texture
from playground.gpu.triangle import TRIANGLE
from playground.terrain.camera import Eye
from playground.terrain.pick import walk_over

if TYPE_CHECKING:
    import moderngl

_FRAGMENT = """#version 330
uniform sampler2D height;
uniform vec3 start;  // [m] where the ray comes over the land
uniform vec3 way;    // its unit vector
uniform float far;   // [m] along it to where it leaves
uniform int steps;
uniform vec2 extent;
uniform float relief;
out vec4 found;      // shares east and north, 1 where there is ground, its height

float ground(vec2 place) {
    ivec2 last = textureSize(height, 0) - 1;
    vec2 at = clamp(place / extent, 0.0, 1.0) * vec2(last);
    ivec2 low = min(ivec2(at), max(last - 1, 0)), high = min(low + 1, last);
    vec2 part = at - vec2(low);
    float south = mix(texelFetch(height, low, 0).r, texelFetch(height, ivec2(high.x, low.y), 0).r, part.x);
    float north = mix(texelFetch(height, ivec2(low.x, high.y), 0).r, texelFetch(height, high, 0).r, part.x);
    return mix(south, north, part.y);
}

bool below(float along) {
    vec3 place = start + along * way;
    return place.z <= ground(place.xy) * relief;
}

void main() {
    found = vec4(0.0);
    for (int n = 0; n <= steps; ++n) {
        float high = far * (float(n) / float(steps));
        if (!below(high)) continue;
        float low = far * (float(max(n - 1, 0)) / float(steps));
        for (int k = 0; k < 24; ++k) {
            float middle = 0.5 * (low + high);
            if (below(middle)) high = middle; else low = middle;
        }
        vec2 place = (start + high * way).xy;
        found = vec4(clamp(place / extent, 0.0, 1.0), 1.0, ground(place));
        return;
    }
}
"""


class Ground:
    """Asks one context for places of the land."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self.ctx = ctx
        self._program = ctx.program(vertex_shader=TRIANGLE, fragment_shader=_FRAGMENT)
        self._triangle = ctx.vertex_array(self._program, [])
        self._texture = make_texture(ctx, (1, 1), "rgba32f")
        self._framebuffer = make_framebuffer(ctx, [self._texture])

    def under(
        self,
        eye: Eye,
        place: tuple[float, float],
        heights: moderngl.Texture,
        extent: tuple[float, float],
        relief: float,
    ) -> tuple[float, float, float] | None:
        """Return where on the land a place of the picture lies, and its height; None where there is sky.

        As ``terrain.pick.ground_under``: the place in shares of the picture from its lower left,
        the answer in shares of the land's sides, east and north; the height as the texture has it.
        The context is the caller's to make current and to leave as it was.
        """
        found = walk_over(eye, place, heights.size, extent)
        if found is None:
            return None
        origin, way, entry, leave, steps = found
        given = {
            "height": 0,
            "start": tuple((origin + entry * way).tolist()),
            "way": tuple(way.tolist()),
            "far": leave - entry,
            "steps": steps,
            "extent": extent,
            "relief": relief,
        }
        for name, value in given.items():
            self._program[name].value = value  # type: ignore[union-attr]
        self._framebuffer.use()
        self.ctx.disable(self.ctx.BLEND | self.ctx.DEPTH_TEST | self.ctx.CULL_FACE)
        self.ctx.clear_samplers(0, 1)
        heights.use(0)
        self._triangle.render(self.ctx.TRIANGLES, vertices=3)
        east, north, hit, high = np.frombuffer(self._texture.read(), np.float32).tolist()
        return (east, north, high) if hit else None

    def release(self) -> None:
        """Give all of it back to the driver."""
        for made in (self._framebuffer, self._texture, self._triangle, self._program):
            made.release()
