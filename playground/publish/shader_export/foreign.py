"""Write one pass of another tool's shader, or a plain shader, so that other formats can take it.

What its own tool gives it becomes a global variable, set from what the new one gives; its ``main`` or
``mainImage`` becomes a function that the pass calls.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

from playground.errors import SketchError
from playground.publish.shader_export.declarations import Declaration, declaration_of, declarations_of
from playground.publish.shader_export.passes import ShaderPass, neutral
from playground.publish.shader_export.texts import Host, PassText, Sampled, variable_of, without_unwired
from playground.shader.reserved_names import NEUTRAL, SIZES
from playground.shader.source import Line
from playground.shader.syntax.nodes import Declaration as Statement
from playground.shader.syntax.nodes import Declarator, Node, Precision
from playground.shader.syntax.parser import parse
from playground.shader.syntax.tokens import tokenize
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
        node = next(iter(parse(declaration).declarations), None)
        if not isinstance(node, Statement) or len(node.names) != 1 or node.names[0].arrays:
            message = (
                f"pass '{pass_.step.path}' takes '{declaration}' of a vertex shader, which others have not"
            )
            raise SketchError(message)
        value.append(variable_of(node.type.name, node.names[0].name))
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
    text = "\n".join(line.code for line in kernel.source.lines)
    edits: list[tuple[int, int, str]] = []
    trees = [parse(text, all_branches=True)]
    for tree in trees:
        trees += tree.branches
        for node in tree.declarations:
            start, end = tree.span(node)
            if isinstance(node, Precision) or _is_input(node):
                edits.append((start, end, ""))
            elif (out := _output(node)) is not None:
                name, kind = out.name, node.type.name  # type: ignore[attr-defined]
                output = name if kind == "vec4" else f"vec4({name}, 1.0)"
                edits.append((start, end, f"{kind} {name};"))
    edits += _directives(text, [(start, end) for start, end, new in edits if not new])
    for start, end, new in sorted(edits, reverse=True):
        text = text[:start] + new + "\n" * text.count("\n", start, end) + text[end:]
    pairs = zip(kernel.source.lines, text.split("\n"), strict=True)
    return [
        line if code == line.code else replace(line, code=code, comment="") for line, code in pairs
    ], output


def _directives(text: str, gone: Sequence[tuple[int, int]]) -> Iterator[tuple[int, int, str]]:
    """Yield the directives that a fragment shader begins with, and conditions on GL_ES around them alone."""
    open_: list[int] = []
    tokens = tokenize(text)[0]
    for index, token in enumerate(tokens):
        words = token.text[1:].split() if token.kind == "directive" else [""]
        if words[0] in ("version", "extension"):
            yield token.start, token.end, ""
        elif words[0].startswith("if"):
            open_.append(index)
        elif words[0] == "endif" and open_:
            first = open_.pop()
            between = tokens[first + 1 : index]
            is_gone = all(any(start <= one.start < end for start, end in gone) for one in between)
            if "GL_ES" in tokens[first].text and is_gone:
                yield tokens[first].start, tokens[first].end, ""
                yield token.start, token.end, ""


def _is_input(node: Node) -> bool:
    return isinstance(node, Statement) and not {"in", "varying"}.isdisjoint(node.type.qualifiers)


def _output(node: Node) -> Declarator | None:
    """Return what a declaration of a picture's colour declares."""
    is_output = isinstance(node, Statement) and "out" in node.type.qualifiers
    if not is_output or node.type.name not in ("vec3", "vec4"):  # type: ignore[attr-defined]
        return None
    names: list[Declarator] = node.names  # type: ignore[attr-defined]
    return names[0] if len(names) == 1 and not names[0].arrays else None


def _prelude(line: str) -> Declaration | None:
    """Return what a line before the text declares for all of it, but for what is given otherwise."""
    tree = parse(line)
    for macro in tree.preprocessed.macros:
        return declaration_of(line, macro.name, is_macro=True)
    is_output = any(_output(node) is not None for node in tree.declarations)
    return declaration_of("vec4 k_frag_color;", "k_frag_color") if is_output else None


def _without_twins(declarations: list[Declaration]) -> list[Declaration]:
    return list({(each.names, each.code): each for each in declarations}.values())


def _kinds(kernel: Kernel) -> dict[str, tuple[str, str]]:
    """Return the type of each uniform, and the brackets of an array."""
    kinds: dict[str, tuple[str, str]] = {}
    for text in ("\n".join(kernel.prelude) if isinstance(kernel, ForeignShader) else "", kernel.source.code):
        tree = parse(text)
        for node in tree.declarations:
            if isinstance(node, Statement) and "uniform" in node.type.qualifiers:
                for one in node.names:
                    sizes = [size for size in (*one.arrays, *node.type.arrays) if size is not None]
                    texts = [[t.text for t in tree.tokens[size.first : size.last]] for size in sizes]
                    kinds[one.name] = node.type.name, "".join(f"[{''.join(parts)}]" for parts in texts)
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
