"""Read a Shadertoy shader of one file: ``mainImage``, and the names that Shadertoy declares."""

from __future__ import annotations

from collections.abc import Sequence

from playground.sketch.dialects.es import rewritten
from playground.sketch.dialects.passes import VIEW
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.shader import Names, Rules, Shader
from playground.sketch.reserved_names import SIZES

CHANNELS = tuple(f"iChannel{number}" for number in range(4))

NAMES: Names = {
    "iResolution": ("vec3", "resolution"),
    "iTime": ("float", "time"),
    "iGlobalTime": ("float", "time"),
    "iTimeDelta": ("float", "delta"),
    "iFrame": ("int", "frame_of_time"),
    "iFrameRate": ("float", "frame_rate"),
    "iSampleRate": ("float", "sample_rate"),
    "iMouse": ("vec4", "drag"),
    "iDate": ("vec4", "date"),
    "iChannelTime": ("float[4]", "time"),
    "iChannelResolution": ("vec3[4]", f"{SIZES}{' '.join(CHANNELS)}"),
    **{name: ("sampler2D", f"noise {number}") for number, name in enumerate(CHANNELS)},
}

_MORE_CHANNELS = tuple(f"iChannel{number}" for number in range(10))

MORE_NAMES: Names = {
    **NAMES,
    "iGlobalFrame": ("int", "frame_of_time"),
    "iMouseButton": ("vec4", "buttons"),
    "iViewMatrix": ("mat4", "identity4"),
    "iChannelResolution": ("vec3[10]", f"{SIZES}{' '.join(_MORE_CHANNELS)}"),
    **{name: ("sampler2D", f"noise {number}") for number, name in enumerate(_MORE_CHANNELS)},
}
"""Those of the VS Code extension."""

RULES = Rules("shadertoy", NAMES, epilogue="main_image.glsl")


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file."""
    return (Shader(VIEW, rewritten(files.source()), RULES),)
