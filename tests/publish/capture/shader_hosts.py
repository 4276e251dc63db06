"""Hosts of other tools in small: they draw an exported file as its own format says, without our readers."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from typing import Any

import moderngl
import numpy as np
from numpy.typing import NDArray

from playground.engine.textures import make_framebuffer

VERTEX = """
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""
ES = "#version 300 es\nprecision highp float; precision highp int; precision highp sampler2D;\n"
TYPES = {"float": "float", "bool": "bool", "long": "int", "color": "vec4", "point2D": "vec2"}


class Host:
    """Draws passes on one context."""

    def __init__(self, ctx: moderngl.Context, stack: ExitStack) -> None:
        self.ctx = ctx
        self.stack = stack

    def texture(self, size: tuple[int, int], *, floats: bool = True, data: bytes | None = None):
        made = self.ctx.texture(size, 4, data, dtype="f4" if floats else "f1")
        self.stack.callback(made.release)
        made.filter = moderngl.LINEAR, moderngl.LINEAR
        made.repeat_x = made.repeat_y = False
        return made

    def draw(
        self,
        version: str,
        text: str,
        target: moderngl.Texture,
        reads: Mapping[str, Any],
        values: Mapping[str, Any],
    ) -> None:
        program = self.ctx.program(vertex_shader=version + VERTEX, fragment_shader=version + text)
        frame = make_framebuffer(self.ctx, [target])
        triangle = self.ctx.vertex_array(program, [])
        for unit, (name, texture) in enumerate(reads.items()):
            if name in program:
                texture.use(unit)
                program[name] = unit
        for name, value in values.items():
            if name in program:
                program[name] = value
        frame.use()
        triangle.render(moderngl.TRIANGLES, vertices=3)
        for made in (triangle, frame, program):
            made.release()


def picture_of(texture: moderngl.Texture) -> NDArray[np.uint8]:
    """Return a texture as a screen shows it, rows from the south: bytes of three channels."""
    values = np.frombuffer(texture.read(), np.float32).reshape(texture.height, texture.width, 4)
    clamped = np.clip(np.nan_to_num(values[..., :3]).astype(np.float64), 0.0, 1.0)
    return np.floor(clamped * 255.0 + 0.5).astype(np.uint8)


def side(text: str | None, size: tuple[int, int], axis: int) -> int:
    """Return what WIDTH or HEIGHT of a pass comes to."""
    text = (
        (text or ("$WIDTH", "$HEIGHT")[axis]).replace("$WIDTH", str(size[0])).replace("$HEIGHT", str(size[1]))
    )
    assert re.fullmatch(r"[\d+*/ ().-]+", text)
    return int(eval(text))


def draw_isf(
    ctx: moderngl.Context,
    text: str,
    size: tuple[int, int],
    *,
    time: float = 0.0,
    values: Mapping[str, Any] | None = None,
    images: Mapping[str, NDArray[np.uint8]] | None = None,
) -> NDArray[np.uint8]:
    """Draw an ISF file's picture; ``values`` of its inputs are the defaults unless given."""
    top, _, body = text.partition("}*/")
    header = json.loads(top.removeprefix("/*") + "}")
    version = "#version 330\n"
    before = ["uniform vec2 RENDERSIZE; uniform int PASSINDEX; uniform float TIME; out vec4 k_frag_color;"]
    before.append("#define gl_FragColor k_frag_color")
    value: dict[str, Any] = {}
    for each in header["INPUTS"]:
        before.append(f"uniform {TYPES[each['TYPE']]} {each['NAME']};")
        default = (values or {}).get(each["NAME"], each["DEFAULT"])
        value[each["NAME"]] = tuple(default) if isinstance(default, list) else default
    passes = header.get("PASSES", [{}])
    names = [each["TARGET"] for each in passes if "TARGET" in each] + list(header.get("IMPORTED", {}))
    before += [f"uniform sampler2D {name};" for name in names]
    with ExitStack() as stack:
        host = Host(ctx, stack)
        textures: dict[str, moderngl.Texture] = {}
        for name, pixels in (images or {}).items():
            textures[name] = host.texture(pixels.shape[1::-1], floats=False, data=pixels.tobytes())
        for index, each in enumerate(passes):
            whole = side(each.get("WIDTH"), size, 0), side(each.get("HEIGHT"), size, 1)
            is_last = index == len(passes) - 1
            target = host.texture(whole, floats=is_last or bool(each.get("FLOAT")))
            numbers = value | {"RENDERSIZE": whole, "PASSINDEX": index, "TIME": time}
            host.draw(version, "\n".join([*before, body]), target, textures, numbers)
            if is_last:
                return picture_of(target)
            textures[each["TARGET"]] = target
    raise AssertionError("an ISF file without a pass")


def draw_shadertoy(
    ctx: moderngl.Context, passes: Sequence[Mapping[str, Any]], size: tuple[int, int], *, time: float = 0.0
) -> NDArray[np.uint8]:
    """Draw an export's Image, each pass compiled as GLSL ES 3.00 and all buffers as large as the picture."""
    before = "uniform vec3 iResolution; uniform float iTime; out vec4 shown;\n"
    before += "uniform sampler2D iChannel0, iChannel1, iChannel2, iChannel3;\n"
    after = "\nvoid main() { mainImage(shown, gl_FragCoord.xy); }\n"
    common = "".join(each["code"] for each in passes if each["type"] == "common")
    order = sorted(
        (each for each in passes if each["type"] != "common"), key=lambda each: each["type"] == "image"
    )
    with ExitStack() as stack:
        host = Host(ctx, stack)
        textures: dict[str, moderngl.Texture] = {}
        for each in order:
            target = host.texture(size)
            reads = {f"iChannel{i['channel']}": textures[i["id"]] for i in each["inputs"]}
            for i in each["inputs"]:
                how = i["sampler"]["filter"]
                result = textures[i["id"]]
                result.filter = (moderngl.NEAREST,) * 2 if how == "nearest" else (moderngl.LINEAR,) * 2
                if how == "mipmap":
                    result.build_mipmaps()
                result.repeat_x = result.repeat_y = i["sampler"]["wrap"] == "repeat"
            numbers = {"iResolution": (*map(float, size), 1.0), "iTime": time}
            host.draw(ES, before + common + each["code"] + after, target, reads, numbers)
            if each["type"] == "image":
                return picture_of(target)
            textures[each["outputs"][0]["id"]] = target
    raise AssertionError("an export without an Image")
