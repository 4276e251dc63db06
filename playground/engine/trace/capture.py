"""Read what a vertex stage hands one fragment, so that the fragment can run again without the mesh.

The step is drawn once more, with a fragment shader that gives each varying and, where derivatives count, its
value in each of the quad's four fragments, whether the triangle covers them or not: what is 0 in the three
others has that value as its difference along both axes. Where a driver takes one difference for the whole
quad, ``dFdx`` and ``dFdy`` say what the others have, but for the last bits. Of a draw that keeps the nearest
fragment, the depth that it left says which that is.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from playground.engine.programs import Program
from playground.engine.textures import make_framebuffer, release_framebuffer
from playground.engine.trace.instrument import Traced
from playground.memo import Memo
from playground.shader.own_shaders import TRIANGLE
from playground.shader.wrap import Wrapped

if TYPE_CHECKING:
    import moderngl

_Floats = NDArray[np.float32]
_MAX_PROGRAMS = 16
_MAX_BYTES = 2**27  # of a target's textures, unless one alone takes more
_MAX_SLOTS = 8  # outputs that every OpenGL has
_LANE = "((int(gl_FragCoord.y) & 1) * 2 + (int(gl_FragCoord.x) & 1))"
_FINE_TEST = f"""#version 330
out vec4 k_fine;
void main() {{ k_fine = vec4(dFdy(dFdx({_LANE} == 0 ? 3.0 : 0.0))); }}
"""


class Capture:
    """Captures varyings on one context."""

    def __init__(self, ctx: moderngl.Context) -> None:
        self._ctx = ctx
        self._programs: Memo[tuple[str, str], Program] = Memo(
            "capturing programs", _MAX_PROGRAMS, dropped=lambda _, program: program.release()
        )
        self._fine: bool | None = None
        self._size = (0, 0)  # of the textures
        self._textures: list[moderngl.Texture] = []

    def release(self) -> None:
        """Release programs and the target."""
        self._programs.clear()
        self._release_textures()

    def uniforms(
        self,
        wrapped: Wrapped,
        traced: Traced,
        texel: tuple[int, int],
        size: tuple[int, int],
        depth: moderngl.Renderbuffer | None,
        draw: Callable[[Program], None],
    ) -> dict[str, Any] | None:
        """Return the uniforms by which a traced fragment has the varyings of a texel; None for no fragment.

        ``size``: of the step's textures. ``draw`` sets what the program reads and draws into what is bound;
        the depth that is tested then is ``depth``.
        """
        slots = ["vec4(gl_FragCoord.zw, gl_FrontFacing ? 1.0 : 0.0, 1.0)"]
        for varying in traced.varyings:
            name, texts = varying.name, [varying.name]
            if traced.quads and not varying.is_flat and self._is_fine():
                masked = [
                    f"dFdy(dFdx({_LANE} == {lane} ? {name} : {varying.type}(0.0)))" for lane in range(4)
                ]
                texts = [f"{sign}{text}" for sign, text in zip(("", "-", "-", ""), masked, strict=True)]
            elif traced.quads and not varying.is_flat:
                texts += [f"dFdx({name})", f"dFdy({name})"]
            slots += [_as_vec4(varying.type, text) for text in texts]
        own_x, own_y = texel[0] & 1, texel[1] & 1
        most = max(min(_MAX_BYTES // (16 * size[0] * size[1]), _MAX_SLOTS), 1)
        values: list[_Floats] = []  # of each slot
        for first in range(0, len(slots), most):
            group = slots[first : first + most]
            program = self._program(wrapped, traced.declarations, group)
            framebuffer = self._framebuffer(size, len(group), depth)
            try:
                framebuffer.use()
                framebuffer.scissor = (texel[0] & ~1, texel[1] & ~1, 2, 2)
                framebuffer.depth_mask = False
                framebuffer.clear()
                draw(program)
                for index in range(len(group)):
                    data = framebuffer.read((*texel, 1, 1), 4, attachment=index, alignment=1, dtype="f4")
                    values.append(np.frombuffer(data, np.float32))
            finally:
                release_framebuffer(framebuffer)
            if first == 0 and values[0][3] == 0.0:
                return None
        uniforms: dict[str, Any] = {
            "k_at_depth": tuple(values[0][:2].tolist()),
            "k_is_front": bool(values[0][2]),
        }
        rest = iter(values[1:])
        for varying in traced.varyings:
            type_ = varying.type
            if not traced.quads or varying.is_flat:
                uniforms[varying.uniform] = _value(type_, next(rest))
            elif self._is_fine():
                uniforms[varying.uniform] = [_value(type_, next(rest)) for _ in range(4)]
            else:
                at, along_x, along_y = next(rest), next(rest), next(rest)
                uniforms[varying.uniform] = [
                    _value(type_, at + np.float32(x - own_x) * along_x + np.float32(y - own_y) * along_y)
                    for y in range(2)
                    for x in range(2)
                ]
        return uniforms

    def _is_fine(self) -> bool:
        """Return whether each row and each column of a quad has a difference of its own here."""
        if self._fine is None:
            program = self._ctx.program(vertex_shader=TRIANGLE, fragment_shader=_FINE_TEST)
            filled, texture = Program(self._ctx, program), self._ctx.texture((2, 2), 4, dtype="f4")
            framebuffer = make_framebuffer(self._ctx, [texture])
            framebuffer.use()
            filled.fill()
            numbers = np.frombuffer(framebuffer.read(components=4, dtype="f4"), np.float32)
            self._fine = bool((numbers == 3.0).all())
            release_framebuffer(framebuffer)
            texture.release()
            filled.release()
        return self._fine

    def _program(self, wrapped: Wrapped, declarations: Sequence[str], slots: Sequence[str]) -> Program:
        vertex = wrapped.stages["vertex"].text
        text = _capture_text(wrapped.stages["fragment"].text, declarations, slots)
        program: Program | None = self._programs.get((vertex, text))
        if program is None:
            compiled = self._ctx.program(vertex_shader=vertex, fragment_shader=text)
            program = self._programs.put((vertex, text), Program(self._ctx, compiled))
        return program

    def _framebuffer(
        self, size: tuple[int, int], count: int, depth: moderngl.Renderbuffer | None
    ) -> moderngl.Framebuffer:
        if self._size != size:
            self._release_textures()
            self._size = size
        while len(self._textures) < count:
            self._textures.append(self._ctx.texture(size, 4, dtype="f4"))
        return make_framebuffer(self._ctx, self._textures[:count], depth)

    def _release_textures(self) -> None:
        for texture in self._textures:
            texture.release()
        self._textures.clear()


def _as_vec4(type_: str, text: str) -> str:
    """Return an expression of four numbers that have the bits of one of a type."""
    count = int(type_[-1]) if type_[-1].isdigit() else 1
    bits = {"i": f"intBitsToFloat({text})", "u": f"uintBitsToFloat({text})"}.get(type_[0], text)
    return f"vec4({bits}{', 0.0' * (4 - count)})"


def _value(type_: str, numbers: _Floats) -> Any:
    count = int(type_[-1]) if type_[-1].isdigit() else 1
    whole = {"i": np.int32, "u": np.uint32}.get(type_[0])
    values = (numbers if whole is None else numbers.view(whole))[:count].tolist()
    return values[0] if count == 1 else tuple(values)


def _is_es(text: str) -> bool:
    return "es" in text.partition("\n")[0].split()


def _capture_text(fragment: str, declarations: Sequence[str], slots: Sequence[str]) -> str:
    """Return a fragment shader that gives some expressions of the varyings."""
    lines = [line for line in fragment.split("\n") if line.startswith(("#version", "#extension"))]
    if _is_es(fragment):
        lines.append("precision highp float; precision highp int;")
    lines += declarations
    lines += [f"layout(location = {slot}) out vec4 k_slot_{slot};" for slot in range(len(slots))]
    sets = [f"k_slot_{slot} = {text};" for slot, text in enumerate(slots)]
    return "\n".join([*lines, "void main() {", *sets, "}", ""])
