"""Make the files of a sketch's picture as a shader of another tool, by the file's ending."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

from playground.engine.plan import Plan
from playground.errors import DataError, ShaderError
from playground.files import read_regular, reason
from playground.publish.export_formats import ISF, SHADERTOY_EXPORT, SHADERTOY_TEXT, kind_of
from playground.publish.shader_export import isf, shadertoy, standalone
from playground.publish.shader_export.foreign import foreign_text
from playground.publish.shader_export.passes import (
    MOUSE,
    PROBES,
    ExportPlan,
    ShaderPass,
    export_plan,
    given_by,
    plan_of,
)
from playground.publish.shader_export.texts import (
    Host,
    PassText,
    constants_of,
    is_sampled,
    shown_text,
    size_of,
    text_of,
)
from playground.sketch.model import PlainFragment, Sketch

if TYPE_CHECKING:
    import moderngl


MADE_BY = "terrain shader playground"


@dataclass(frozen=True)
class ShaderFiles:
    """The files of one export, and what is to be told of them."""

    plan: Plan
    files: dict[Path, bytes]  # the shader's own first
    summary: str
    warnings: tuple[str, ...]


def shader_files(sketch: Sketch, path: Path, *, texture: str, kind: str, time: float) -> ShaderFiles:
    """Return a sketch's picture, or one texture of it, as the shader that the path's ending names.

    Raises ``SketchError`` with a message for each thing that the format has not.
    """
    shows = kind
    if texture:
        plan = plan_of(sketch, PROBES[0], time)
        plan.flat.ref(texture, sketch.name)
        shows = kind or kind_of(plan, texture)
    result = export_plan(sketch, texture, shows, time)
    heading = [f"// {_ascii(sketch.title or sketch.name)}, exported by the {MADE_BY}"]
    ending = path.suffix.lower()
    notes = _notes(sketch, result)
    if ending not in (SHADERTOY_TEXT, SHADERTOY_EXPORT):
        notes += _mouse_notes(result)
    files: dict[Path, bytes] = {}
    if ending == ISF:
        inputs = isf.inputs_of(result)
        texts = _texts(result, inputs.host(), shows)
        copies = _copies(path, inputs.images)
        text = isf.written(texts, inputs, heading, {name: copy.name for name, copy in copies.items()})
        for name, copy in copies.items():
            files[copy] = _read(inputs.images[name])
        notes += _isf_notes(texts, inputs)
        count = len(texts) + len(inputs.decoded)
        what = f"ISF; {_counted(count, 'pass')}, {_counted(len(inputs.header), 'input')}"
    elif ending in (SHADERTOY_TEXT, SHADERTOY_EXPORT):
        texts = shadertoy.fitted(_texts(result, shadertoy.HOST, shows))
        is_export = ending == SHADERTOY_EXPORT
        shadertoy.check(texts, one_text=not is_export)
        least = [max((text.size[axis] or 0) for text in texts) for axis in (0, 1)]
        if max(least):
            notes.append(f"it needs a picture of at least {max(least[0], 1)} x {max(least[1], 1)} pixels")
        if is_export:
            text = shadertoy.export(texts, sketch.title or sketch.name, heading)
            what = f"Shadertoy export; {_counted(len(texts) - 1, 'buffer')}"
        else:
            text = shadertoy.one_text(texts[0], heading)
            what = "Shadertoy text"
    else:
        texts = _texts(result, standalone.HOST, shows)
        standalone.check(texts)
        text = standalone.one_text(texts[0], heading)
        what = "GLSL 3.30"
    data = _ascii(text).encode()
    return ShaderFiles(result.plan, {path: data, **files}, f"{what}; {len(data)} bytes", tuple(notes))


def _texts(plan: ExportPlan, host: Host, shows: str) -> list[PassText]:
    sizes = {pass_.name: pass_.size for pass_ in plan.passes}
    passes = [replace(pass_, shows="") for pass_ in plan.passes] if plan.is_shown else plan.passes
    texts = [
        _foreign(pass_, host) if _is_foreign(pass_) else text_of(plan, pass_, host, sizes) for pass_ in passes
    ]
    texts = [*(more := constants_of(texts)), *texts]
    if plan.is_shown:
        index = len(more) + next(i for i, pass_ in enumerate(plan.passes) if pass_.name == plan.picture)
        output = plan.passes[index - len(more)].output
        texts.append(shown_text(texts[index], output.components, shows, host))
    return texts


def _is_foreign(pass_: ShaderPass) -> bool:
    return isinstance(pass_.step.kernel, PlainFragment) and not pass_.copies.name


def _foreign(pass_: ShaderPass, host: Host) -> PassText:
    time = f"float({host.frame}) / 60.0" if pass_.by_frames else host.time
    return foreign_text(pass_, host, given_by(size_of(pass_.size, host), time, host.frame, host.mouse))


def _notes(sketch: Sketch, plan: ExportPlan) -> list[str]:
    notes = []
    if plan.follows and any(pass_.size == (None, None) for pass_ in plan.passes[:-1]):
        notes.append("the terrain has as many texels as the picture has pixels")
    if sketch.keyframes:
        notes.append(f"keyframes stay behind: values are those at {plan.plan.time:g} s")
    return notes


def _mouse_notes(plan: ExportPlan) -> list[str]:
    usual = {pair for pass_ in plan.passes for pair in pass_.step.kernel.usual}
    names = sorted({name for name, meaning in usual if meaning in MOUSE})
    return [f"the mouse stays behind: {', '.join(names)} is at 0"] if names else []


def _isf_notes(texts: Sequence[PassText], inputs: isf.Inputs) -> list[str]:
    notes = []
    small = sorted(
        {
            read.word
            for text in texts
            for read in text.reads
            if read.sampling.mipmap and is_sampled(text, read.word)
        }
    )
    if small:
        notes.append(
            f"ISF has no mipmaps: {', '.join(small)} is rougher where it is shown smaller than it is"
        )
    if inputs.unbounded:
        notes.append(f"without a range of their own, so that one was made up: {', '.join(inputs.unbounded)}")
    return notes


def _copies(path: Path, images: dict[str, Path]) -> dict[str, Path]:
    """Return where each imported image is copied to: beside the file, under a name of its own."""
    copies: dict[str, Path] = {}
    for name, source in images.items():
        copy = path.with_name(f"{path.stem}-{source.name}")
        if copy in copies.values():
            copy = path.with_name(f"{path.stem}-{name}{source.suffix}")
        if copy.exists() and _read(copy) != _read(source):
            message = f"{copy.name} is there already, and is another image; choose another name"
            raise DataError(message, file=path)
        copies[name] = copy
    return copies


def _read(path: Path) -> bytes:
    try:
        return read_regular(path)
    except OSError as error:
        raise DataError(f"cannot be read: {reason(error)}", file=path) from error


def _ascii(text: str) -> str:
    """Return a text that every tool reads: what is not ASCII is in comments and titles alone."""
    for old, new in {"–": "-", "—": "-", "’": "'", "…": "...", "°": " degrees", "×": "x", "−": "-"}.items():
        text = text.replace(old, new)
    return re.sub(r"[^\x00-\x7f]", "?", text)


def _counted(count: int, what: str) -> str:
    plural = f"{what}es" if what.endswith("s") else f"{what}s"
    return f"{count} {what if count == 1 else plural}"


# ── checked as a browser compiles it ───────────────────────────────────────────


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
