"""Show one expression at one line of a pass as a map: the pass gets outputs for what it is there.

``probed`` returns a sketch whose pass has two outputs more, and everything else as it was: the engine wires,
sizes, repeats and caches it as any other. Behind the line's statement the text hands the expression over to a
function; overloads choose its type.

    probe: rgba32f    its components, as of the last time that the line ran; a condition is 1 or 0
    hits:  rg32f      how often the line ran; the run, from 1, in which it was first not zero, else 0
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from playground.errors import PlaygroundError, ShaderError, SketchError, nearest
from playground.memo import GRAPHS
from playground.paths import shown
from playground.shader.kernel import Draw, ForeignShader, Kernel, Output, PlainFragment, TexelKernel
from playground.shader.source import Line, SourceText
from playground.shader.stage_recipe import version_line
from playground.shader.syntax.nodes import (
    Assign,
    Block,
    Case,
    Declaration,
    Do,
    Empty,
    Expression,
    For,
    Function,
    If,
    Jump,
    Node,
    Switch,
    Unary,
    While,
    walk,
)
from playground.shader.syntax.parser import Tree, parse
from playground.sketch.map_sketch import Map
from playground.sketch.model import Graph, Sketch, Technique
from playground.sketch.variants import INSIDE
from playground.sketch.wiring import initial_names

_ZEROS = {"float": "0.0", "int": "0", "uint": "0u", "bool": "false"}
_VECTORS = {"vec": "float", "ivec": "int", "uvec": "uint", "bvec": "bool"}
_MAX_LENGTH = 400  # letters of an expression


@dataclass(frozen=True)
class Probe:
    """An expression at a line of a pass."""

    path: str  # of the pass: "height.detail"; in a fast variant "light.fast.sweep"
    file: str  # absolute path of the author's file
    line: int  # from 1
    expression: str

    @property
    def place(self) -> str:
        """The path of the pass in the probed sketch, in which a fast variant takes its technique's place."""
        return ".".join(part for part in self.path.split(".") if part != INSIDE)

    def __str__(self) -> str:
        return f"{self.expression} behind line {self.line}"


@dataclass(frozen=True)
class ProbeMap(Map):
    """A map of a probe."""

    probe: Probe = Probe("", "", 0, "")
    hits: str = "hits"  # the name of its second output
    is_remembered = False

    @property
    def hits_ref(self) -> str:
        """The texture of how often the line ran, and in which run the probe was first not zero."""
        return f"{self.probe.place}:{self.hits}"

    @property
    def private_refs(self) -> tuple[str, ...]:
        """The probe's two textures."""
        return self.ref, self.hits_ref

    def base_of(self, sketch: Sketch) -> Sketch:
        """Return the sketch with the probe's outputs."""
        return probed(sketch, self.probe)[0]

    def own_numbers(self, values: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return the components up to the last that is not 0 throughout."""
        used = [part for part in range(4) if values[..., part].any()]
        count = max(used, default=0) + 1
        return values[..., 0] if count == 1 else values[..., :count]

    def can_show(self, sketch: Sketch) -> bool | None:
        """Return whether the pass is still there, and the line still has a statement."""
        try:
            probed(sketch, self.probe)
        except PlaygroundError:
            return False
        return True


def map_of(sketch: Sketch, probe: Probe) -> ProbeMap:
    """Return the map of a probe; raise as ``probed``."""
    _, output, hits = probed(sketch, probe)
    return ProbeMap(f"{probe.place}:{output}", probe=probe, hits=hits)


@GRAPHS.cached(identities=1)
def probed(sketch: Sketch, probe: Probe) -> tuple[Sketch, str, str]:
    """Return a sketch with a probe, and the names of the outputs that its pass has more.

    Raises ``ShaderError`` at the line for what is no expression, and for a line without a statement, with
    the nearest one that has one; ``SketchError`` where the pass cannot have a probe.
    """
    names: list[str] = []

    def change(kernel: Kernel) -> Kernel:
        changed, *added = with_probe(kernel, probe)
        names.extend(added)
        return changed

    graph = _changed(sketch.graph, probe.path.split("."), change, probe.path)
    assert isinstance(graph, Graph)
    return replace(sketch, graph=graph), names[0], names[1]


def _changed(
    technique: Technique, parts: list[str], change: Callable[[Kernel], Kernel], path: str
) -> Technique:
    """Return a technique with the kernel at a path inside changed; no fast variant replaces it."""
    if not parts:
        if isinstance(technique, Graph):
            inner = [spec.name for spec in technique.passes]
            raise SketchError(f"'{path}' is several passes: {', '.join(inner)}; choose one")
        return change(technique)
    name, *rest = parts
    graphs: list[Technique] = [technique]
    if name == INSIDE:
        name, *rest = rest
        graphs = [variant.technique for variant in technique.variants]
    for graph in graphs:
        spec = graph.written.find(name) if isinstance(graph, Graph) else None
        if not isinstance(graph, Graph) or spec is None:
            continue
        inner_technique = _changed(spec.technique, rest, change, path)
        renamed = _renamed_inputs(spec.technique, inner_technique) if not rest else {}
        renames = {".".join((*rest, old)): ".".join((*rest, new)) for old, new in renamed.items()}
        changed = replace(
            spec,
            technique=inner_technique,
            inputs=tuple((renames.get(key, key), ref) for key, ref in spec.inputs),
            feedback=tuple((renames.get(key, key), ref) for key, ref in spec.feedback),
        )
        targets = {f"{name}.{old}": f"{name}.{new}" for old, new in renames.items()}
        exports = tuple(
            replace(export, targets=tuple(targets.get(target, target) for target in export.targets))
            for export in graph.written.inputs
        )
        passes = tuple(changed if each is spec else each for each in graph.written.passes)
        return replace(graph.written, passes=passes, inputs=exports, variants=())
    known = [s.name for g in graphs if isinstance(g, Graph) for s in g.passes]
    raise SketchError(f"no pass '{path}'{nearest(name, known)}")


def _renamed_inputs(before: Technique, after: Technique) -> dict[str, str]:
    """Return the new name of each input that a repeat starts from: with several outputs each has its own."""
    names = {output: name for name, output in initial_names(after).items()}
    return {name: names[output] for name, output in initial_names(before).items() if output in names}


# ── the text ──────────────────────────────────────────────────────────────────


def with_probe(kernel: Kernel, probe: Probe) -> tuple[Kernel, str, str]:
    """Return a kernel with a probe, and the names of the outputs that it has more; raise as ``probed``."""
    entry, source = _entry(kernel), kernel.source
    tree = parse(source.code, {"FRAGMENT_STAGE": ""} if isinstance(kernel, Draw) else None)
    _check(probe, source)
    code = _edited(source.code, _insertions(tree, kernel, probe))
    taken = {output.name for output in kernel.outputs} | source.names
    added = Output(_free("probe", taken), "rgba32f"), Output(_free("hits", taken), "rg32f")
    code = re.sub(rf"\b{entry}\b", f"k_own_{entry}", code)
    if isinstance(kernel, TexelKernel) and len(kernel.outputs) == 1:
        code = re.sub(r"\bprevious\b(?=\s*\()", f"previous_{kernel.outputs[0].name}", code)
    text = source.with_codes(code.split("\n")[:-1])
    own = next((f for f in tree.declarations if isinstance(f, Function) and f.name == entry and f.body), None)
    if own is None:
        raise kernel.error(f"there is no function {entry} to probe")
    first, start, end = (tree.line(at) for at in (tree.declarations[0].first, own.first, own.last - 1))
    head, main = _own_lines(kernel, own, tree, added)
    begins, ends = ("#ifdef FRAGMENT_STAGE", "#endif") if isinstance(kernel, Draw) else ("", "")
    lines = (
        *text.lines[:first],
        _line(text, head),
        *text.lines[first:start],
        _line(text, begins),
        *text.lines[start : end + 1],
        _line(text, ends),
        *text.lines[end + 1 :],
        _line(text, main),
    )
    changed = replace(
        kernel, source=replace(text, lines=lines), outputs=(*kernel.outputs, *added), variants=()
    )
    return changed, added[0].name, added[1].name


def _entry(kernel: Kernel) -> str:
    """Return the function that a text begins with; raise ``ShaderError`` for a kind without a probe."""
    if isinstance(kernel, TexelKernel):
        return "kernel"
    if isinstance(kernel, Draw):
        return "fragment"
    if isinstance(kernel, PlainFragment):
        version = version_line(kernel.source)
        words = version.code.split() if version else []
        if len(words) > 1 and words[1].isdigit() and int(words[1]) < 130:
            raise kernel.error(f"a probe needs #version 130 or later, and this text has {words[1]}")
        epilogue = kernel.epilogue if isinstance(kernel, ForeignShader) else ""
        if "cubemap" in epilogue and "mainCubemap" in kernel.source.names:
            return "mainCubemap"
        return "mainImage" if epilogue else "main"
    raise kernel.error(f"{kernel.name} is a {kernel.kind.replace('_', ' ')}, which has no line to probe")


def _own_lines(kernel: Kernel, own: Function, tree: Tree, added: tuple[Output, Output]) -> tuple[str, str]:
    """Return the line before a text's first declaration, and the one behind its last: the new entry."""
    head = f"vec4 k_seen = vec4(0.0); vec2 k_runs = vec2(0.0); {''.join(_overloads())}"
    parameters = [tree.source(parameter) for parameter in own.parameters if parameter.type.name != "void"]
    call = f"k_own_{own.name}({', '.join(p.name for p in own.parameters if p.name)})"
    probe, hits = (output.name for output in added)
    if isinstance(kernel, PlainFragment):
        probe, hits = f"k_out_{probe}", f"k_out_{hits}"
        for unit, name in enumerate((probe, hits), len(kernel.outputs)):
            head += f"layout(location = {unit}) out vec4 {name}; "
    else:
        is_draw = isinstance(kernel, Draw)
        more = added if len(kernel.outputs) > 1 else (*kernel.outputs, *added)
        parameters += [f"out {'vec4' if is_draw else output.glsl} {output.name}" for output in more]
        if len(kernel.outputs) == 1:
            call = f"{kernel.outputs[0].name} = {call}"
    runs = "k_runs" if isinstance(kernel, TexelKernel) else "vec4(k_runs, 0.0, 0.0)"
    body = f"{call}; {probe} = k_seen; {hits} = {runs};"
    return head, f"void {own.name}({', '.join(parameters)}) {{ {body} }}"


def _overloads() -> Iterator[str]:
    """Yield the functions that take what is seen, one a type."""
    for scalar, zero in _ZEROS.items():
        yield _overload(scalar, "vec4(float(k_it), 0.0, 0.0, 0.0)", zero)
    for vector, scalar in _VECTORS.items():
        for size, fill in ((2, ", 0.0, 0.0"), (3, ", 0.0"), (4, "")):
            kind = f"{vector}{size}"
            yield _overload(kind, f"vec4(vec{size}(k_it){fill})", f"{kind}({_ZEROS[scalar]})")


def _overload(kind: str, wide: str, zero: str) -> str:
    first = f"if (k_runs.y == 0.0 && k_it != {zero}) k_runs.y = k_runs.x;"
    return f"void k_see({kind} k_it) {{ k_runs.x += 1.0; k_seen = {wide}; {first} }} "


def _line(source: SourceText, code: str) -> Line:
    """Return a line of our own; a driver's message about it points at the file's first line."""
    return Line("", code, "", source.path, 1)


def _free(name: str, taken: set[str]) -> str:
    return name if name not in taken else _free(f"{name}_", taken)


def _edited(code: str, edits: list[tuple[int, str]]) -> str:
    for at, text in sorted(edits, key=lambda edit: -edit[0]):
        code = code[:at] + text + code[at:]
    return code


def _check(probe: Probe, source: SourceText) -> None:
    """Refuse what is no expression, or changes something."""
    text = probe.expression.strip()
    line = _line_of(source, probe)
    if not text:
        raise line.error("an empty probe; expected an expression, as 'far' or 'height > 0.5'")
    if len(text) > _MAX_LENGTH or re.search(r"[\n;{}#\\]|//|/\*", text):
        raise line.error(f"'{text[:60]}' is no single expression, as 'far' or 'height > 0.5'")
    tree = parse(f"void k_any() {{ k_it = ({text}); }}")
    if tree.errors:
        raise line.error(f"'{text}' is no expression: {tree.errors[0].message}")
    for node in walk(*tree.declarations):
        value = node.value if isinstance(node, Expression) else None
        is_own = isinstance(node, Assign) and tree.source(node.target) == "k_it"
        if value is None and not is_own and _sets(node):
            raise line.error(f"'{text}' sets a variable; a probe only reads")


def _sets(node: Node) -> bool:
    return isinstance(node, Assign) or (isinstance(node, Unary) and node.operator in ("++", "--"))


# ── where ─────────────────────────────────────────────────────────────────────


@dataclass
class _Statement:
    node: Node
    first: int  # lines of the flattened text, from 0
    last: int
    in_block: bool
    body: Block | None = None  # into which the probe goes: of a loop or a function
    function: str = ""


def _line_of(source: SourceText, probe: Probe) -> Line:
    """Return the line that a probe names; raise ``ShaderError`` where the text has none such."""
    for line in source.lines:
        if line.file == probe.file and line.number == probe.line:
            return line
    files = ", ".join(shown(file) for file in source.files)
    raise ShaderError(f"line {probe.line} of {shown(probe.file)} is not in this pass, whose text is {files}")


def _insertions(tree: Tree, kernel: Kernel, probe: Probe) -> list[tuple[int, str]]:
    """Return what is inserted, at which offsets of the code."""
    source, statements = kernel.source, list(_statements(tree))
    see = f"k_see({probe.expression.strip()});"
    for index, line in enumerate(source.lines):
        if (line.file, line.number) != (probe.file, probe.line):
            continue
        best: _Statement | None = None
        for statement in statements:
            if statement.first <= index <= statement.last and (
                best is None or best.first < index or not _is_in(statement, best)
            ):
                best = statement
        if best is not None and isinstance(kernel, Draw) and best.function == "vertex":
            raise line.error(f"line {probe.line} runs at vertices; a probe shows what fragments are")
        if best is not None:
            return _edits(tree, best, see)
    numbers = [source.lines[s.first].number for s in statements if source.lines[s.first].file == probe.file]
    other = min(numbers, key=lambda number: (abs(number - probe.line), -number), default=0)
    hint = f"; the nearest is line {other}" if other else ""
    raise _line_of(source, probe).error(f"line {probe.line} has no statement to probe{hint}")


def _is_in(inner: _Statement, outer: _Statement) -> bool:
    return outer.node.first <= inner.node.first < outer.node.last


def _edits(tree: Tree, statement: _Statement, see: str) -> list[tuple[int, str]]:
    node = statement.node
    start, end = tree.span(node)
    if statement.body is not None:
        return [(tree.span(statement.body)[0] + 1, f" {see}")]
    if isinstance(node, For | While | Do):
        inner = tree.span(node.body)
        return [(inner[0], f"{{ {see} "), (inner[1], " }")]
    behind = isinstance(node, Declaration | Expression) or (
        isinstance(node, If)
        and tree.line(node.first) == tree.line(node.last - 1)
        and not any(isinstance(n, Jump) for n in walk(node))
    )
    before, after = ("", f" {see}") if behind else (f"{see} ", "")
    if not statement.in_block:
        before, after = f"{{ {before}", f"{after} }}"
    return [(start, before), (end, after)]


def _statements(tree: Tree) -> Iterator[_Statement]:
    """Yield what a probe can stand at, each before what is in it, with the lines of its head."""
    for function in tree.declarations:
        if isinstance(function, Function) and function.body is not None:
            head = tree.line(function.first), tree.line(function.body.first)
            for statement in (
                _Statement(function, *head, True, function.body),
                *_inside(tree, function.body),
            ):
                statement.function = function.name
                yield statement


def _inside(tree: Tree, node: Node, in_block: bool = True) -> Iterator[_Statement]:
    start = tree.line(node.first)
    match node:
        case Block():
            for statement in node.statements:
                yield from _inside(tree, statement)
        case If():
            yield _Statement(node, start, tree.line(node.condition.last), in_block)
            yield from _inside(tree, node.yes, False)
            if node.no is not None:
                yield from _inside(tree, node.no, False)
        case For() | While() | Do():
            body = node.body if isinstance(node.body, Block) else None
            yield _Statement(node, start, tree.line(node.body.first), in_block, body)
            yield from _inside(tree, node.body, False)
        case Switch():
            yield _Statement(node, start, tree.line(node.body.first), in_block)
            yield from _inside(tree, node.body)
        case Case() | Empty():
            return
        case _:
            yield _Statement(node, start, tree.line(node.last - 1), in_block)
