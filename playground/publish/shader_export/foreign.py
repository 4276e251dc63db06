"""Write one pass of another tool's shader, or a plain shader, so that other formats can take it.

What its own tool gives it becomes a global variable, set from what the new one gives; its ``main`` or
``mainImage`` becomes a function that the pass calls.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace

from playground.errors import SketchError
from playground.publish.shader_export.declarations import Declaration, declaration_of, declarations_of
from playground.publish.shader_export.passes import ShaderPass, neutral
from playground.publish.shader_export.texts import Host, PassText, Sampled, variable_of, without_unwired
from playground.shader.declarations import uniforms
from playground.shader.reserved_names import NEUTRAL, SIZES
from playground.shader.source import Line
from playground.sketch.model import ForeignShader, Kernel

_LEFT_OUT = re.compile(r"\s*(?:#\s*(?:version|extension)\b|precision\s)")
_OUT = re.compile(r"\s*(?:layout\s*\([^)]*\)\s*)?out\s+(?:highp\s+|mediump\s+|lowp\s+)?vec([34])\s+(\w+)\s*;")
_IN = re.compile(
    r"\s*(?:layout\s*\([^)]*\)\s*)?(?:(?:flat|smooth|noperspective|centroid)\s+)*in\s+\w+\s+[^;()]*;"
)
_PRELUDE_UNIFORM = re.compile(r"uniform\s+(\w+)\s+(\w+)\s*(\[\d+\])?\s*;")
_VERTEX_OUT = re.compile(
    r"(?:layout\s*\([^)]*\)\s*)?(?:(?:flat|smooth|noperspective|centroid)\s+)*out\s+(\w+)\s+(\w+)\s*;"
)
_PRECISION = re.compile(r"\s*#\s*if(?:def\s+GL_ES|\s+defined\s*\(?\s*GL_ES\s*\)?)\s*$")


def foreign_text(pass_: ShaderPass, host: Host, expressions: Mapping[str, Callable[[str], str]]) -> PassText:
    """Return a pass's text; ``expressions`` has an expression of each meaning by the type that is wanted."""
    kernel = pass_.step.kernel
    foreign = kernel if isinstance(kernel, ForeignShader) else None
    prelude = foreign.prelude if foreign else ()
    lines, output = _own_lines(kernel)
    value = [d for line in prelude if (d := _prelude(line))]
    statements: list[str] = []
    reads: list[Sampled] = []
    unwired: dict[str, str] = {}
    for declared, wire in pass_.inputs:
        if wire.name:
            reads.append(Sampled(declared.name, wire.name, declared.sampling, wire.is_before))
        else:
            unwired[declared.name] = (
                "vec4(0.0)" if declared.fallback == "zero" else "vec4(0.0, 0.0, 0.0, 1.0)"
            )
    kinds = _kinds(kernel)
    for name, meaning in kernel.usual:
        kind, array = kinds.get(name, ("", ""))
        if not kind or (name, kind + array) in host.native:
            continue
        value.append(declaration_of(f"{kind} {name}{array};", name) if array else variable_of(kind, name))
        statements += _setting(name, kind, array, meaning, pass_, expressions)
    for parameter in kernel.parameters:
        own, setting = host.parameter(pass_, parameter, pass_.step.values[parameter.name])
        value += own
        statements += setting
    for declaration, setting_text in foreign.vertex if foreign and isinstance(foreign.vertex, tuple) else ():
        match = _VERTEX_OUT.fullmatch(declaration)
        if not match:
            message = (
                f"pass '{pass_.step.path}' takes '{declaration}' of a vertex shader, which others have not"
            )
            raise SketchError(message)
        value.append(variable_of(match[1], match[2]))
        share = f"(({host.pixel}) / vec2({host.size}))"
        text = setting_text.replace("k_share", share).replace("k_place", f"({share} * 2.0 - 1.0)")
        statements.append(text)
    declarations = [without_unwired(d, unwired) for d in declarations_of(lines)]
    if foreign and foreign.epilogue:
        entry, result = f"{pass_.name}_image", "vec4(picture.rgb, 1.0)"
        call = ["vec4 picture = vec4(0.0, 0.0, 0.0, 1.0);", f"{entry}(picture, {host.pixel});"]
        declarations = [d.renamed({"mainImage": entry}) for d in declarations]
    else:
        entry, result = f"{pass_.name}_main", output
        call = [f"{entry}();"]
        declarations = [d.renamed({"main": entry}) for d in declarations]
    is_bytes = pass_.output.format == "rgba8"
    made_of = (*_without_twins(value), *declarations)
    return PassText(
        pass_.name, pass_.size, made_of, tuple(reads), (*statements, *call), result, is_bytes, kernel.title
    )


def _own_lines(kernel: Kernel) -> tuple[list[Line], str]:
    """Return a text's lines without what a fragment shader of its own needs, and what it writes."""
    output = "k_frag_color"
    lines: list[Line] = []
    in_precision = False
    for line in kernel.source.lines:
        code = line.code
        if _PRECISION.match(code):
            in_precision = True
        if in_precision or _LEFT_OUT.match(code) or _IN.match(code):
            in_precision = in_precision and "endif" not in code
            code = ""
        elif match := _OUT.match(code):
            output = match[2] if match[1] == "4" else f"vec4({match[2]}, 1.0)"
            code = f"vec{match[1]} {match[2]};"
        lines.append(line if code == line.code else replace(line, code=code, comment=""))
    return lines, output


def _prelude(line: str) -> Declaration | None:
    """Return what a line before the text declares for all of it, but for what is given otherwise."""
    if line.startswith("#define"):
        name = re.split(r"[\s(]", line.partition(" ")[2], maxsplit=1)[0]
        return declaration_of(line, name, is_macro=True)
    return declaration_of("vec4 k_frag_color;", "k_frag_color") if _OUT.match(line) else None


def _without_twins(declarations: list[Declaration]) -> list[Declaration]:
    return list({(each.names, each.code): each for each in declarations}.values())


def _kinds(kernel: Kernel) -> dict[str, tuple[str, str]]:
    """Return the type of each uniform, and the brackets of an array."""
    kinds = {
        match[2]: (match[1], match[3] or "")
        for line in (kernel.prelude if isinstance(kernel, ForeignShader) else ())
        if (match := _PRELUDE_UNIFORM.match(line))
    }
    for name, declared in uniforms(kernel.source.code).items():
        brackets = re.search(r"\[\s*\d+\s*\]", declared.written) if declared.is_array else None
        kinds[name] = declared.type, brackets.group() if brackets else ""
    return kinds


def _setting(
    name: str,
    kind: str,
    array: str,
    meaning: str,
    pass_: ShaderPass,
    expressions: Mapping[str, Callable[[str], str]],
) -> list[str]:
    """Return the statements that set a uniform's global."""
    count = int(array.strip("[] ")) if array else 1
    places = [f"{name}[{index}]" for index in range(count)] if array else [name]
    if meaning.startswith(SIZES):
        samplers = meaning.removeprefix(SIZES).split()
        wired = {declared.name for declared, wire in pass_.inputs if wire.name}
        return [
            f"{target} = {kind}(vec2(textureSize({sampler}, 0)){', 1.0' if kind == 'vec3' else ''});"
            for target, sampler in zip(places, samplers, strict=False)
            if sampler in wired
        ]
    if meaning in expressions:
        return [f"{target} = {expressions[meaning](kind)};" for target in places]
    return [f"{target} = {neutral(kind, NEUTRAL.get(meaning, (0.0,)))};" for target in places]
