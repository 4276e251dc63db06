"""Read a fragment shader with a ``main`` of its own.

The names are those of glslCanvas, glslViewer, KodeLife, Bonzomatic and glslsandbox.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace

from playground.sketch.dialects import shadertoy
from playground.sketch.dialects.conditions import WEBGL, live_source, macros_of
from playground.sketch.dialects.declarations import uniforms, vertex_outputs
from playground.sketch.dialects.es import rewritten, version_of
from playground.sketch.dialects.passes import VIEW
from playground.sketch.dialects.reading import Files
from playground.sketch.dialects.shader import Channel, Made, Names, Rules, Shader
from playground.sketch.dialects.viewer import shaders_of
from playground.sketch.model import Sampling
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
_BEFORE = ("backbuffer", "u_backbuffer", "prevFrame", "prevPass", "texPreviousFrame")
"""Samplers that read the picture of the frame before: 8 bits a channel, as the tools have it."""

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
    **{name: ("sampler1D", "fft 0") for name in ("texFFT", "texFFTSmoothed", "texFFTIntegrated")},
    "texChecker": ("sampler2D", "picture 0"),
    "texNoise": ("sampler2D", "noise 0"),
    **{f"texTex{n}": ("sampler2D", f"picture {n}") for n in range(1, 5)},
    # KodeLife and glslsandbox
    "mouse": ("vec2", "hover_share"),
    "spectrum": ("vec3", "bands"),
    **{f"texture{n}": ("sampler2D", f"picture {n}") for n in range(4)},
    **{name: ("sampler2D", "none") for name in _BEFORE},
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
    tested = {
        name for line in source.lines if _CONDITION.match(line.code) for name in _NAME.findall(line.code)
    }
    for name, lines in _SHADOW_MAP.items():  # where a text asks for it first, it does without
        if name in source.names and name not in tested:
            found += [
                line for line in lines if line.startswith("#") or "u_lightShadowMap" not in source.names
            ]
    return (*found, "#define BACKGROUND") if "BACKGROUND" in source.names else tuple(found)


_CONDITION, _NAME = re.compile(r"\s*#\s*(?:el)?if"), re.compile(r"[A-Za-z_]\w*")
_SHADOW_MAP = {
    "LIGHT_SHADOWMAP": ["#define LIGHT_SHADOWMAP u_lightShadowMap", "uniform sampler2D u_lightShadowMap;"],
    "LIGHT_SHADOWMAP_SIZE": ["#define LIGHT_SHADOWMAP_SIZE 2048.0"],
}
"""What glslViewer defines for a scene: here the map is black."""

RULES = Rules("main", NAMES, declared_anywhere=True, defines=_defines)


def shaders(files: Files) -> Sequence[Shader | Made]:
    """Return the passes of a file, none where it lacks nothing that a plain shader is given."""
    whole = files.source()
    version = version_of(whole)
    known = {} if version else WEBGL
    rules = replace(RULES, names=shadertoy.with_sampler_types(NAMES, whole))
    if found := shaders_of(rewritten(whole), rules, known):
        return found
    macros = {**known, **macros_of(_defines(whole))}
    source = live_source(whole, macros, unknown=None if version else False)
    if not files.named and version >= 330 and not _needs_dialect(source):
        return ()
    text = rewritten(source)
    before = dict.fromkeys(_BEFORE, Channel(target=VIEW, sampling=Sampling("linear", "clamp")))
    return (Shader(VIEW, text, rules, target=VIEW, channels=before, keeps=True),)
