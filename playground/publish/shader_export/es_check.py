"""Compile an exported Shadertoy text as a browser does: as GLSL ES 3.00."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from playground.errors import ShaderError
from playground.publish.extensions import SHADERTOY_EXPORT, SHADERTOY_TEXT

if TYPE_CHECKING:
    import moderngl

_NEEDS = "GL_ARB_ES3_compatibility"
_VERTEX = (
    "#version 300 es",
    "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }",
)
_BEFORE = (
    "#version 300 es",
    "precision highp float; precision highp int; precision highp sampler2D;",
    "uniform vec3 iResolution; uniform float iTime; uniform int iFrame; uniform vec4 iMouse, iDate;",
    "uniform float iTimeDelta, iSampleRate, iFrameRate, iChannelTime[4]; uniform vec3 iChannelResolution[4];",
    "uniform sampler2D iChannel0, iChannel1, iChannel2, iChannel3; out vec4 colour_of_pixel;",
)
_AFTER = "void main() { mainImage(colour_of_pixel, gl_FragCoord.xy); }"


def es_texts(path: Path, text: str) -> dict[str, str]:
    """Return each pass of a Shadertoy file as a browser compiles it, by its name; none of another file."""
    ending = path.suffix.lower()
    if ending == SHADERTOY_TEXT:
        codes = {"Image": text}
    elif ending == SHADERTOY_EXPORT:
        passes = json.loads(text)[0]["renderpass"]
        common = "".join(each["code"] for each in passes if each["type"] == "common")
        codes = {each["name"]: common + each["code"] for each in passes if each["type"] != "common"}
    else:
        codes = {}
    return {name: "\n".join([*_BEFORE, code, _AFTER]) + "\n" for name, code in codes.items()}


def check_es(ctx: moderngl.Context, path: Path, text: str) -> None:
    """Raise ``ShaderError`` for what a browser would not compile, where this driver can tell.

    GLSL ES 3.00 makes no float of a whole number by itself, as desktop GLSL does.
    """
    if _NEEDS not in ctx.extensions:
        return
    for name, whole in es_texts(path, text).items():
        try:
            ctx.program(vertex_shader="\n".join(_VERTEX) + "\n", fragment_shader=whole).release()
        except Exception as error:  # moderngl.Error, by any version's name
            log = [line for line in str(error).splitlines() if "error" in line and line[:1].isdigit()]
            said = log[0] if log else str(error).strip()
            location, _, message = said.partition(": error: ")
            number = location.partition(":")[2].partition("(")[0]
            lines = whole.splitlines()
            line = lines[int(number) - 1].strip() if number.isdigit() and int(number) <= len(lines) else ""
            raise ShaderError(
                f"pass '{name}' does not compile as GLSL ES 3.00, which Shadertoy runs: {message or said}",
                file=path.name,
                excerpt=line,
            ) from None
