"""Write one pass of another tool's shader, or a plain shader, so that other formats can take it.

What its own tool gives it becomes a global variable, set from what the new one gives; its ``main`` or
``mainImage`` becomes a function that the pass calls.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from playground.errors import SketchError
from playground.publish.shader_export.declarations import Declaration, declaration_of, declarations_of
from playground.publish.shader_export.passes import ShaderPass, neutral
from playground.publish.shader_export.texts import Host, PassText, Sampled, variable_of, without_unwired
from playground.shader.declarations import uniforms
from playground.shader.reserved_names import NEUTRAL, SIZES
from playground.shader.source import Line
from playground.shader.syntax.nodes import Declaration as Declared
from playground.shader.syntax.nodes import InterfaceBlock, Precision, Type
from playground.shader.syntax.parser import parse
from playground.shader.syntax.tokens import as_written
from playground.sketch.model import ForeignShader, Kernel


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
        varying = parse(declaration).declarations[0]
        if not isinstance(varying, Declared) or varying.type.arrays or varying.names[0].arrays:
            message = (
                f"pass '{pass_.step.path}' takes '{declaration}' of a vertex shader, which others have not"
            )
            raise SketchError(message)
        value.append(variable_of(varying.type.name, varying.names[0].name))
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
    codes: list[str] = []
    in_precision = False
    for line in kernel.source.lines:
        _, word, *words = [*_words(line.code), "", ""] if "#" in line.code else ("", "")
        names = {*words}.difference(("defined", "(", ")", ""))
        in_precision |= word in ("if", "ifdef") and names == {"GL_ES"}
        codes.append("" if in_precision or word in ("version", "extension") else line.code)
        in_precision &= word != "endif"
    text, output = "\n".join(codes), "k_frag_color"
    whole = parse(text, all_branches=True)
    left_out: list[tuple[int, int]] = []
    for tree in (whole, *whole.branches):
        for node in tree.declarations:
            kind = node.type if isinstance(node, Declared) else node
            qualifiers = kind.qualifiers if isinstance(kind, Type | InterfaceBlock) else ()
            start, end = tree.span(node)
            if isinstance(node, Precision) or "in" in qualifiers:
                left_out.append((start, end))
            elif isinstance(node, Declared) and "out" in qualifiers and node.type.name in ("vec3", "vec4"):
                name = node.names[0].name
                output = name if node.type.name == "vec4" else f"vec4({name}, 1.0)"
                left_out.append((start, tree.tokens[node.type.at].start))
    for start, end in sorted(left_out, reverse=True):
        text = text[:start] + "\n" * text.count("\n", start, end) + text[end:]
    codes = [code if code.strip() else "" for code in text.split("\n")]
    lines = [
        line if line.code == code else replace(line, code=code, comment="")
        for line, code in zip(kernel.source.lines, codes, strict=True)
    ]
    return lines, output


def _words(code: str) -> list[str]:
    return [token.text for token in as_written(code)]


def _prelude(line: str) -> Declaration | None:
    """Return what a line before the text declares for all of it, but for what is given otherwise."""
    words = _words(line)
    if words[:2] == ["#", "define"]:
        return declaration_of(line, words[2], is_macro=True)
    is_output = "out" in words and words[-2:] == ["k_frag_color", ";"]
    return declaration_of("vec4 k_frag_color;", "k_frag_color") if is_output else None


def _without_twins(declarations: list[Declaration]) -> list[Declaration]:
    return list({(each.names, each.code): each for each in declarations}.values())


def _kinds(kernel: Kernel) -> dict[str, tuple[str, str]]:
    """Return the type of each uniform, and the brackets of an array."""
    prelude = "\n".join(kernel.prelude) if isinstance(kernel, ForeignShader) else ""
    kinds = {}
    for code in (prelude, kernel.source.code):
        for name, declared in uniforms(code).items():
            kinds[name] = declared.type, "".join(_words(declared.written)[1:4]) if declared.is_array else ""
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
