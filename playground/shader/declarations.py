"""What a GLSL text declares: names with their kinds, uniforms with their initial values, a vertex's outputs.

Of a text whose conditions depend on the driver both readings count. What is no declaration, or one with a
mistake, is passed over.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from playground.memo import TEXTS
from playground.shader.syntax.nodes import Declaration, Declarator, InterfaceBlock, Type
from playground.shader.syntax.parser import Tree
from playground.shader.syntax.symbols import Symbol, readings
from playground.shader.syntax.types import components

_KINDS = {
    "function": "called",
    "struct": "called",
    "member": "member",
    "local": "local",
    "parameter": "local",
}
_WAYS = frozenset({"flat", "smooth", "noperspective", "centroid", "sample", "invariant"})


@dataclass(frozen=True, slots=True)
class Declared:
    """A uniform."""

    name: str
    type: str
    is_array: bool
    line: int  # of the text, from 0
    written: str  # the name, its array and its initial value


@TEXTS.cached()  # passes of one file share a text
def uniforms(code: str) -> Mapping[str, Declared]:
    """Return the uniforms that a text declares, by name; of one in two branches, the first."""
    declarations: dict[str, Declared] = {}
    for tree, node in _declarations(code, "uniform"):
        if isinstance(node, Declaration):
            for one in node.names:
                arrays = _arrays(tree, one, node.type)
                value = f" = {_written(tree, one.value.first, one.value.last)}" if one.value else ""
                line = tree.line(one.at)
                declared = Declared(
                    one.name, node.type.name, bool(arrays), line, f"{one.name}{arrays}{value}"
                )
                declarations.setdefault(one.name, declared)
    return declarations


def takes(kind: str, other: str) -> bool:
    """Return whether a uniform of a type can be given what another type is given."""
    return _family(kind) == _family(other)


def _family(kind: str) -> str:
    """Return what a tool gives that declares a uniform of a type: others of the family take it, too."""
    name = kind.partition("[")[0]
    if components(name)[1]:
        return "numbers"
    if name in ("mat3", "mat4"):
        return "matrix"
    return "sampler" if name.removeprefix("i").removeprefix("u").startswith("sampler") else kind


def is_declared(code: str, name: str, *, anywhere: bool) -> bool:
    """Return whether a text declares a variable or a function, outside of functions or ``anywhere``."""
    kinds = declared_names(code).get(name, frozenset())
    return bool(kinds & {"global", "called"}) or (anywhere and bool(kinds))


@TEXTS.cached()
def declared_names(code: str) -> Mapping[str, frozenset[str]]:
    """Return the names that a text declares, its macros expanded, with their kinds.

    The kind is global, local, called (a function or a struct) or member.
    """
    names: dict[str, frozenset[str]] = {}
    for symbols in readings(code):
        for symbol in symbols.symbols:
            names[symbol.name] = names.get(symbol.name, frozenset()) | {kind_of(symbol)}
    return names


def kind_of(symbol: Symbol) -> str:
    """Return a symbol's kind: see ``declared_names``."""
    return _KINDS.get(symbol.kind, "global")


@TEXTS.cached()
def vertex_outputs(code: str) -> tuple[tuple[str, str], ...]:
    """Return what the vertex shader gives a fragment shader: declarations, and statements that set them."""
    outputs: dict[str, tuple[str, str]] = {}
    for tree, node in _declarations(code, "in"):
        if isinstance(node, InterfaceBlock):
            members = " ".join(_written(tree, member.first, member.last) for member in node.members)
            statements = [
                _set(
                    f"{node.instance}.{one.name}" if node.instance else one.name,
                    one.name,
                    member.type.name,
                    _arrays(tree, one, member.type),
                )
                for member in node.members
                for one in member.names
            ]
            declaration = f"out {node.name} {{ {' '.join(members.split())} }} {node.instance};"
            outputs.setdefault(node.name, (declaration, " ".join(statements)))
        elif node.type.name:
            qualifiers = [q for q in node.type.qualifiers if q in _WAYS or q.startswith("layout")]
            for one in node.names:
                if not one.name.startswith("gl_"):
                    arrays = _arrays(tree, one, node.type)
                    declaration = " ".join([*qualifiers, "out", node.type.name, f"{one.name}{arrays};"])
                    outputs.setdefault(
                        one.name, (declaration, _set(one.name, one.name, node.type.name, arrays))
                    )
    return tuple(outputs.values())


def _declarations(code: str, qualifier: str) -> Iterator[tuple[Tree, Declaration | InterfaceBlock]]:
    """Yield the declarations outside of functions that have a qualifier, blocks too."""
    for symbols in readings(code):
        for node in symbols.tree.declarations:
            if isinstance(node, Declaration):
                qualifiers = node.type.qualifiers
            elif isinstance(node, InterfaceBlock):
                qualifiers = node.qualifiers
            else:
                continue
            if qualifier in qualifiers:
                yield symbols.tree, node


def _arrays(tree: Tree, one: Declarator, of_type: Type) -> str:
    """Return the sizes of a name's arrays, in their brackets."""
    behind = one.value.first - 1 if one.value is not None else one.last
    begins = of_type.last - 1
    while begins > of_type.first and tree.tokens[begins].text != of_type.name:
        begins -= 1
    return _written(tree, begins + 1, of_type.last) + _written(tree, one.at + 1, behind)


def _written(tree: Tree, first: int, last: int) -> str:
    """Return tokens as the text has them, or as the macros do that write some of them."""
    tokens = tree.tokens[first:last]
    if any(token.macros for token in tokens):
        return " ".join([token.text for token in tokens])
    return tree.text[tokens[0].start : tokens[-1].end] if tokens else ""


def _set(target: str, name: str, kind: str, array: str) -> str:
    """Return the statement that sets one output."""
    value = _value(name.lower(), kind)
    if array:
        return f"for (int k_i = 0; k_i < {target}.length(); ++k_i) {target}[k_i] = {value};"
    return f"{target} = {value};"


def _value(name: str, kind: str) -> str:
    """Return an output's value by its name: coordinates 0..1, a position -1..1, a normal, white, else 0."""
    scalar, count = components(kind)
    if kind.startswith("mat"):
        return f"{kind}(1.0)"
    if scalar != "float" or count == 1:
        return f"{kind}({'1' if 'color' in name or 'colour' in name else '0'})"
    if "color" in name or "colour" in name:
        return f"{kind}(1.0)"
    if "normal" in name:
        return {2: "vec2(0.0)", 3: "vec3(0.0, 0.0, 1.0)", 4: "vec4(0.0, 0.0, 1.0, 0.0)"}[count]
    if any(part in name.replace("vertex", "") for part in ("uv", "tex", "coord")):
        return {2: "k_share", 3: "vec3(k_share, 0.0)", 4: "vec4(k_share, 0.0, 1.0)"}[count]
    if "pos" in name:
        return {2: "k_place", 3: "vec3(k_place, 0.0)", 4: "vec4(k_place, 0.0, 1.0)"}[count]
    return f"{kind}(0.0)"
