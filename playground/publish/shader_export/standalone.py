"""Write one pass as a fragment shader of its own, with its parameters as annotated uniforms."""

from __future__ import annotations

from collections.abc import Sequence

from playground.errors import SketchError
from playground.publish.shader_export.declarations import Declaration, declaration_of, literal
from playground.publish.shader_export.passes import ShaderPass
from playground.publish.shader_export.shadertoy import blocks
from playground.publish.shader_export.texts import Host, PassText, towards
from playground.shader.header import note_at
from playground.sketch.model import Parameter, Value

_HEAD = ("#version 330", "uniform vec3 iResolution;", "uniform float iTime;", "out vec4 fragColor;")


NATIVE = frozenset({("iResolution", "vec3"), ("iTime", "float")})


def _uniform(
    pass_: ShaderPass, parameter: Parameter, value: Value
) -> tuple[tuple[Declaration, ...], tuple[str, ...]]:
    if parameter.widget.kind == "direction" and isinstance(value, tuple):
        text = f"const {parameter.type} {parameter.name} = {literal(parameter.type, value)};"
        return (declaration_of(text, parameter.name), towards(parameter.name, value)), ()
    text = f"uniform {parameter.type} {parameter.name} = {literal(parameter.type, value)};"
    lines = pass_.step.kernel.source.lines
    index = next(i for i, n in enumerate(lines) if (n.file, n.number) == (parameter.file, parameter.line))
    note = note_at(lines, index).text.strip()
    return (declaration_of(f"{text}  //! {note}" if note else text, parameter.name),), ()


def _no_file(pass_: ShaderPass, parameter: Parameter, value: Value) -> str:
    message = f"pass '{pass_.step.path}' reads the image file {value}, which a file alone has not; .fs can"
    raise SketchError(message)


_FRAME = "int(floor(iTime * 60.0 + 0.001))"
HOST = Host(
    "ivec2(iResolution.xy)",
    "ivec2(gl_FragCoord.xy)",
    "iTime",
    _FRAME,
    "gl_FragCoord.xy",
    _uniform,
    _no_file,
    NATIVE,
)


def check(texts: Sequence[PassText]) -> None:
    """Raise ``SketchError`` where there is more than one pass."""
    if len(texts) > 1:
        names = ", ".join(text.name for text in texts)
        message = (
            f"a file of its own is one pass; these are {len(texts)} ({names}): export it as .json or .fs"
        )
        raise SketchError(message)


def one_text(text: PassText, heading: Sequence[str]) -> str:
    """Return the text of one pass that reads no other."""
    lines = [f"    {line}" for line in (*text.statements, f"fragColor = {text.result};")]
    head = [_HEAD[0], *heading, "", *_HEAD[1:], ""]
    return "\n".join([*head, *blocks(text.declarations), "void main() {", *lines, "}"]) + "\n"
