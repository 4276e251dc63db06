"""Read a Shadertoy shader of one file: ``mainImage``, and the names that Shadertoy declares."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from playground.sketch.dialects.conditions import WEBGL_2, live_source
from playground.sketch.dialects.es import rewritten
from playground.sketch.dialects.passes import VIEW
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.sampler_types import sampler_types
from playground.sketch.dialects.shader import Names, Rules, Shader
from playground.sketch.reserved_names import SIZES
from playground.sketch.source import Line, SourceText

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

MACROS = {**WEBGL_2, "HW_PERFORMANCE": "1"}
"""What Shadertoy defines."""


def defines(source: SourceText) -> tuple[str, ...]:
    """Return those of Shadertoy's own macros that a text names."""
    return ("#define HW_PERFORMANCE 1",) if "HW_PERFORMANCE" in source.names else ()


RULES = Rules("shadertoy", NAMES, epilogue="main_image.glsl", defines=defines)


_NOT_DRAWN = {"mainSound": "sound", "mainVR": "for VR"}


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file."""
    source = live_source(files.source(), MACROS)
    note_not_drawn(files, source)
    return (Shader(VIEW, rewritten(source), replace(RULES, names=with_sampler_types(NAMES, source))),)


_STAND_INS = {"samplerCube": "sky", "sampler3D": "volume"}


def with_sampler_types(names: Names, source: SourceText) -> Names:
    """Return names with the channels as the cube maps and volumes that a text reads."""
    types = {name: kind for name, kind in sampler_types(source.code).items() if name in names}
    return {**names, **{name: (kind, f"{_STAND_INS[kind]} {name[-1]}") for name, kind in types.items()}}


def note_not_drawn(files: Files, source: SourceText) -> None:
    """Note each function of a text that makes no picture here."""
    for function, what in _NOT_DRAWN.items():
        if line := _defines(source, function):
            files.note_at(line, f"{function} is {what}, which is not drawn")


def refused(files: Files) -> Sequence[Shader]:
    """Raise ``ShaderError`` for a text that has no picture of its own, at the function that it has."""
    source = files.source()
    for function, what in _NOT_DRAWN.items():
        if line := _defines(source, function):
            raise line.error(f"{function} is {what}, which is not drawn, and there is no mainImage")
    line = _defines(source, "mainCubemap") or source.lines[0]
    raise line.error(
        "a cube map alone is not drawn: as 'Cube A.glsl' it is, next to an Image.glsl that reads it"
    )


def _defines(source: SourceText, function: str) -> Line | None:
    sign = re.compile(rf"\b{function}\s*\(")
    return next((line for line in source.lines if sign.search(line.code)), None)
