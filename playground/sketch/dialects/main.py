"""Read a fragment shader with a ``main`` of its own.

The names are those of glslCanvas, glslViewer, KodeLife, Bonzomatic and glslsandbox.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from playground.sketch.dialects import shadertoy
from playground.sketch.dialects.declarations import uniforms, vertex_outputs
from playground.sketch.dialects.es import rewritten, version_of
from playground.sketch.dialects.passes import VIEW
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.shader import Names, Rules, Shader
from playground.sketch.reserved_names import PLAIN_UNIFORMS, SIZES
from playground.sketch.source import SourceText

_MOST_PICTURES = 10
_TYPES = {
    "time": "float",
    "resolution": "vec2",
    "mouse": "vec2",
    "frame": "int",
    "delta": "float",
    "date": "vec4",
}
_MEANINGS = {"mouse": "hover", "frame": "frame_of_time"}
_MATRICES = (
    "u_modelMatrix u_viewMatrix u_projectionMatrix u_modelViewMatrix u_modelViewProjectionMatrix".split()
)
_PICTURES = range(_MOST_PICTURES)

_ELSEWHERE: Names = {
    # glslViewer
    **{f"u_tex{n}": ("sampler2D", f"picture {n}") for n in _PICTURES},
    **{f"u_tex{n}Resolution": ("vec2", f"{SIZES}u_tex{n}") for n in _PICTURES},
    "u_camera": ("vec3", "camera"),
    "u_light": ("vec3", "light"),
    "u_lightColor": ("vec3", "one"),
    "u_view2d": ("mat3", "identity3"),
    "u_normalMatrix": ("mat3", "identity3"),
    **{name: ("mat4", "identity4") for name in _MATRICES},
    "u_SH": ("vec3[9]", "none"),
    "u_cubeMap": ("samplerCube", "sky 0"),
    "u_scene": ("sampler2D", "none"),
    # Bonzomatic
    "fGlobalTime": ("float", "time"),
    "fFrameTime": ("float", "delta"),
    "v2Resolution": ("vec2", "resolution"),
    **{name: ("sampler1D", "sound 0") for name in ("texFFT", "texFFTSmoothed", "texFFTIntegrated")},
    "texPreviousFrame": ("sampler2D", "none"),
    "texChecker": ("sampler2D", "picture 0"),
    "texNoise": ("sampler2D", "noise 0"),
    **{f"texTex{n}": ("sampler2D", f"picture {n}") for n in range(1, 5)},
    # KodeLife and glslsandbox
    "mouse": ("vec2", "hover_share"),
    "spectrum": ("vec3", "bands"),
    **{f"texture{n}": ("sampler2D", f"picture {n}") for n in range(4)},
    **{name: ("sampler2D", "none") for name in ("prevFrame", "prevPass", "backbuffer")},
}

NAMES: Names = {
    **{
        name: (_TYPES[meaning], _MEANINGS.get(meaning, meaning))
        for meaning, names in PLAIN_UNIFORMS.items()
        for name in names
    },
    **shadertoy.NAMES,
    **_ELSEWHERE,
}

_PASS = re.compile(
    r"#\s*(?:if|ifdef|elif)\b.*\b((?:DOUBLE_)?BUFFER_\d+|(?:CONVOLUTION_)?PYRAMID_\w+|FLOOD_\w+)\b"
)


def _refuse_passes(source: SourceText) -> None:
    """Raise ``ShaderError`` at the first pass that glslViewer would make of the text by a define."""
    for line in source.lines:
        if not line.chain and (match := _PASS.search(line.code)):
            message = f"glslViewer's {match.group(1)} is a pass of its own, which is not drawn yet"
            raise line.error(message, match.start(1) + 1)


def _needs_dialect(source: SourceText) -> bool:
    """Return whether a text of ``#version`` 330 or more needs what a plain shader is not given.

    That is what a vertex shader gives it, and names that it declares or lacks of tools other than those
    whose names every plain shader may use.
    """
    code = source.code
    declared = uniforms(code)
    return bool(vertex_outputs(code)) or any(
        name in source.names and (name in declared or name.startswith("u_"))
        for name in _ELSEWHERE
        if name != "mouse"
    )


def _defines(source: SourceText) -> tuple[str, ...]:
    """Return glslViewer's own macros where its names occur."""
    found = ["#define GLSLVIEWER 1", "#define PLATFORM_LINUX"]
    found = found if any(name.startswith("u_") for name in source.names) else []
    return (*found, "#define BACKGROUND") if "BACKGROUND" in source.names else tuple(found)


RULES = Rules("main", NAMES, declared_anywhere=True, defines=_defines)


def shaders(files: Files) -> Sequence[Shader]:
    """Return the passes of a file, none where it lacks nothing that a plain shader is given."""
    source = files.source()
    _refuse_passes(source)
    if not files.named and version_of(source) >= 330 and not _needs_dialect(source):
        return ()
    return (Shader(VIEW, rewritten(source), RULES),)
