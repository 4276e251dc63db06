"""Have a kernel told its texel's place by the vertex shader, where a software renderer is quicker so.

There ``gl_FragCoord`` is upside down where a texture is drawn, and put right by two uniforms. llvmpipe reads
a uniform once for each of eight texels: of a pass that fetches four texels these two are a seventh.
A place between two vertices is rounded, by far less than the half texel that lies between it and the next.
"""

from __future__ import annotations

from dataclasses import replace

from playground.shader.own_shaders import own_shader
from playground.shader.wrap import Wrapped

_FROM, _TO = "ivec2(gl_FragCoord.xy)", "ivec2(k_place_at)"


def with_interpolated_place(wrapped: Wrapped) -> Wrapped:
    """Return a kernel's stages that do so; of a pass whose target has the size ``size``."""
    fragment = wrapped.stages["fragment"]
    version, rest = fragment.text.split("\n", 1)
    before, _, after = rest.rpartition(_FROM)  # behind the kernel's own lines
    text = f"{version}\nnoperspective in vec2 k_place_at;\n{before}{_TO}{after}"
    stages = {
        "vertex": replace(wrapped.stages["vertex"], text=own_shader("triangle_with_place.vert")),
        "fragment": replace(fragment, text=text, first=fragment.first + 1),
    }
    return replace(wrapped, stages=stages)
