"""Flatten a sketch's nested techniques into passes and loops, wired and in order.

The result names no sizes and no pixels: ``engine.plan`` adds those. Wiring follows one
rule at every level: an input takes what its pass wires, else what the technique's own
caller wires through ``[inputs]``, else the latest earlier pass of its name, else the
latest earlier pass with an output of its name, but for an input that decides which passes
are there (see ``wiring``). What is wired to a path inside a technique
wins over what is wired to its export.

Every technique is in its canonical form; ``substitution`` puts fast variants in place of some.

What a loop that counts frames reads and what changes with the time moves into the loop, so that each of its
frames reads it as it was then: a film has another picture, a kernel another time. Outside of the loop it
would be what it is at the end, in all frames, and each new moment would start the loop again.

The shape of the result depends on the graph alone and is computed once for each; a slider
only puts new values into it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from playground.errors import SketchError, nearest
from playground.memo import GRAPHS
from playground.paths import shown
from playground.shader.expressions import counts_frames, follows_time
from playground.shader.header import replaced
from playground.shader.reserved_names import CLOCKED
from playground.sketch.assign import effective_values, find_targets, resolve, why_absent
from playground.sketch.flat import Fed, Flat, GraphShape, Leaf, Loop, Node, Ref, Source, leaves_of
from playground.sketch.follows import follow, rules_of
from playground.sketch.model import Graph, Kernel, PassSpec, PlainFragment, Sketch, Technique
from playground.sketch.wiring import (
    deciding_inputs,
    initial_names,
    inner,
    input_names,
    is_optional,
    output_names,
    takes_input,
    target_of,
)


def with_clocked_inside(nodes: Sequence[Node]) -> list[Node]:
    """Return nodes, each after what it reads, with what changes from frame to frame inside such loops.

    What another loop reads that the loop reads as well stays outside.
    """
    nodes_now = list(nodes)
    for loop in [node for node in nodes if isinstance(node, Loop) and counts_frames(node.repeat)]:
        index = next(i for i, node in enumerate(nodes_now) if node.path == loop.path)
        moved = _to_move(nodes_now[:index], loop)
        if moved:
            body = tuple(node for node in nodes_now[:index] if node.path in moved and isinstance(node, Leaf))
            before = [node for node in nodes_now[:index] if node.path not in moved]
            after = [node for node in before if _reads(node) & moved]
            while more := [n for n in before if n not in after and _reads(n) & {a.path for a in after}]:
                after += more
            later = [node for node in before if node in after]
            inside = replace(loop, body=(*body, *loop.body))
            nodes_now = [*(n for n in before if n not in after), inside, *later, *nodes_now[index + 1 :]]
    return nodes_now


def _to_move(earlier: Sequence[Node], loop: Loop) -> set[str]:
    """Return the paths of the leaves to move into a loop."""
    needed, paths = [], _reads(loop)
    for node in reversed(earlier):
        if {leaf.path for leaf in leaves_of([node])} & paths:
            needed.append(node)
            paths |= _reads(node)
    moved: set[str] = set()
    for node in reversed(needed):
        if isinstance(node, Leaf) and (_is_clocked(node.kernel) or _reads(node) & moved):
            moved.add(node.path)
    staying = [node for node in needed if node.path not in moved]
    while staying:  # what stays before the loop, and all that it reads
        read = set[str]().union(*(_reads(node) for node in staying))
        staying = [node for node in needed if node.path in read & moved]
        moved -= {node.path for node in staying}
    return moved


def _is_clocked(kernel: Kernel) -> bool:
    if follows_time(kernel.repeat):  # what it does of each frame is its own
        return False
    return bool(kernel.depends) or kernel.reads("time") or any(m in CLOCKED for _, m in kernel.usual)


def flatten(sketch: Sketch) -> Flat:
    """Flatten a sketch, every technique in its canonical form.

    Raises ``SketchError`` at the pass that is wrong, with the nearest valid name.
    """
    graph = sketch.graph
    shape = _shape(graph)
    values = effective_values(graph)
    for path, value in sketch.overrides:
        if path not in shape.targets:
            shape.targets[path] = tuple(target.path for target in resolve(graph, path))
        for target in shape.targets[path]:
            values[target] = value
    follow(shape.rules, values)
    inside = sorted({path for path, _ in sketch.overrides if path.count(".") > 1})
    return Flat(shape, values, sketch.folder, tuple(inside))


@GRAPHS.cached(identities=1, weight=256)
def _shape(graph: Graph) -> GraphShape:
    maker = Flattener()
    written = tuple(maker.expand(graph, "", {}))
    return GraphShape(
        nodes=in_running_order(written, maker.graphs),
        specs=maker.specs,
        graphs=maker.graphs,
        outputs=maker.outputs,
        wires=maker.wires,
        paths=maker.paths,
        rules=rules_of(maker.graphs),
        written=written,
    )


def in_running_order(nodes: tuple[Node, ...], graphs: Mapping[str, Graph]) -> tuple[Node, ...]:
    """Return nodes as they run: what changes from frame to frame inside loops, exact pictures where read."""
    return _with_exact_pictures(tuple(with_clocked_inside(nodes)), graphs)


_EXACT = {"r8": "r32f", "rg8": "rg32f", "rgba8": "rgba32f"}
"""In which format a picture keeps all its numbers."""


def _with_exact_pictures(nodes: tuple[Node, ...], graphs: Mapping[str, Graph]) -> tuple[Node, ...]:
    """Return nodes in which another tool's picture keeps 32-bit floats where a kernel outside reads it."""
    leaves = leaves_of(nodes)
    home = {
        leaf.path: leaf.path.rpartition(".")[0] for leaf in leaves if isinstance(leaf.kernel, PlainFragment)
    }
    home = {path: prefix if graphs[prefix].dialect else path for path, prefix in home.items()}
    exact = {
        source.path
        for leaf in leaves
        for _, source in (() if isinstance(leaf.kernel, PlainFragment) else leaf.inputs)
        if isinstance(source, Ref) and source.path in home
        if not leaf.path.startswith(f"{home[source.path]}.")
    }

    def changed(node: Node) -> Node:
        if isinstance(node, Loop):
            return replace(node, body=tuple(map(changed, node.body)))
        if node.path not in exact:
            return node
        outputs = tuple(replace(o, format=_EXACT.get(o.format, o.format)) for o in node.kernel.outputs)
        return replace(node, kernel=replaced(node.kernel, outputs=outputs))

    return tuple(map(changed, nodes)) if exact else nodes


def is_exported(graph: Graph, path: str) -> bool:
    """Return whether a technique exports a parameter inside, and nothing else, by some name."""
    paths = {target.path for target in find_targets(graph, path)}
    return any({t.path for t in find_targets(graph, e.name)} == paths for e in graph.parameters)


class Flattener:
    """Flattens graphs, and holds what was found of their passes, by path."""

    def __init__(self, before: GraphShape | None = None) -> None:
        self.specs: dict[str, PassSpec] = dict(before.specs) if before else {}
        self.graphs: dict[str, Graph] = dict(before.graphs) if before else {}
        self.outputs: dict[str, dict[str, Ref]] = dict(before.outputs) if before else {}
        self.wires: dict[str, dict[str, Source | None]] = dict(before.wires) if before else {}
        self.paths: dict[str, tuple[tuple[str, str], ...]] = dict(before.paths) if before else {}

    def expand(self, graph: Graph, prefix: str, wires: Mapping[str, Source | None]) -> list[Node]:
        """Return the nodes of a graph; ``wires`` maps inputs, as paths inside it, to what feeds them."""
        self.graphs[prefix] = graph
        self.wires[prefix] = dict(wires)
        for spec in graph.passes:
            path = join(prefix, spec.name)
            self.specs[path] = spec
            self.outputs[path] = self.outputs_of(spec.technique, path)
        inside: dict[str, Source | None] = {}
        for export in graph.inputs:
            # What its caller leaves unwired, a technique's own pass of that name gives.
            if export.name in wires and (wires[export.name] or not graph.find(export.name)):
                inside |= dict.fromkeys(export.targets, wires[export.name])
        inside |= {name: source for name, source in wires.items() if "." in name}
        nodes: list[Node] = []
        earlier: list[PassSpec] = []
        for spec in graph.passes:
            own = {k.partition(".")[2]: v for k, v in inside.items() if k.partition(".")[0] == spec.name}
            nodes += self._one(spec, prefix, own, earlier)
            earlier.append(spec)
        return ordered(nodes, graph)

    def outputs_of(self, technique: Technique, path: str) -> dict[str, Ref]:
        """Return the outputs of a technique at a path: the textures of leaves."""
        if isinstance(technique, Kernel):
            return {o.name: Ref(path, o.name) for o in technique.outputs}
        refs = {}
        for name in output_names(technique):
            where, _, output = target_of(technique, name).partition(":")
            source = inner(technique, where)
            if source is None:
                raise SketchError(f"output '{name}': no pass '{where}' inside", file=shown(technique.path))
            below = self.outputs_of(source, join(path, where))
            refs[name] = below[output] if output in below else below.get(name, next(iter(below.values())))
        return refs

    def _one(
        self, spec: PassSpec, prefix: str, sources: Mapping[str, Source | None], earlier: list[PassSpec]
    ) -> list[Node]:
        path = join(prefix, spec.name)
        technique = spec.technique
        wires: dict[str, Source | None] = dict(sources)
        for name, text in spec.inputs:
            if not takes_input(technique, name):
                owner = name.rpartition(".")[0]
                why = why_absent(technique, owner)
                reason = f"pass '{owner}' {why}" if why else "there is no such input"
                raise spec.error(f"nothing takes input '{name}': {reason}")
            wires[name] = self._ref(text, name, prefix, spec)
        for name in input_names(technique):
            if name not in wires and not _covered(technique, name, wires):
                wires[name] = self._unwired(name, prefix, spec, earlier)
        if not spec.repeat:
            return self._body(spec, path, wires)
        for name, source in wires.items():
            if isinstance(source, Ref) and f"{source.path}.".startswith(f"{path}."):
                raise spec.error(
                    f"pass '{spec.name}' reads itself; feedback = {{ {name} = \"…\" }} is the way"
                )
        feedback = []
        for name, output in spec.feedback:
            feedback.append((name, wires.get(name), self.outputs[path][output]))
            wires[name] = Fed(path, name)
        return [Loop(path, spec.repeat, tuple(self._body(spec, path, wires)), tuple(feedback), spec)]

    def _body(self, spec: PassSpec, path: str, wires: Mapping[str, Source | None]) -> list[Node]:
        technique = spec.technique
        if isinstance(technique, Graph):
            return self.expand(technique, path, wires)
        self.paths[path] = tuple((p.name, join(path, p.name)) for p in technique.parameters)
        return [leaf_of(technique, spec, path, wires)]

    def _ref(self, text: str, expected: str, prefix: str, spec: PassSpec) -> Ref:
        where, _, output = text.partition(":")
        head = where.partition(".")[0]
        names = [p.name for p in self.graphs[prefix].passes if p is not spec]
        if head not in names and head != spec.name:
            raise spec.error(f"input '{expected}' names no pass '{where}'{nearest(where, names)}")
        technique = inner(self.graphs[prefix], where)
        if technique is None:
            raise spec.error(f"input '{expected}': nothing named '{where}' inside '{head}'")
        outputs = self.outputs_of(technique, join(prefix, where))
        if output and output not in outputs:
            raise spec.error(
                f"input '{expected}': pass '{where}' has no output '{output}'{nearest(output, outputs)}"
            )
        if output:
            return outputs[output]
        return outputs.get(expected.rpartition(".")[2], next(iter(outputs.values())))

    def _unwired(self, name: str, prefix: str, spec: PassSpec, earlier: list[PassSpec]) -> Source | None:
        for other in reversed(earlier):
            if other.name == name:
                outputs = self.outputs[join(prefix, other.name)]
                return outputs.get(name, next(iter(outputs.values())))
        for other in reversed(earlier if name not in deciding_inputs(spec.technique) else []):
            outputs = self.outputs[join(prefix, other.name)]
            if name in outputs:
                return outputs[name]
        if is_optional(spec.technique, name):
            return None
        candidates = [
            f"{other.name}:{output}" if len(outputs) > 1 else other.name
            for other in earlier
            for outputs in [self.outputs[join(prefix, other.name)]]
            for output in outputs
        ]
        hint = f"candidates: {', '.join(candidates)}" if candidates else "there is no earlier pass"
        message = f"pass '{spec.name}' needs its input '{name}' wired, as inputs = {{ {name} = \"…\" }}"
        raise spec.error(f"{message}; {hint}")


def _covered(technique: Technique, name: str, wires: Mapping[str, Source | None]) -> bool:
    """Return whether all targets of an exported input are wired by paths inside."""
    if isinstance(technique, Kernel):
        return False
    return all(
        target in wires for export in technique.inputs if export.name == name for target in export.targets
    )


def leaf_of(kernel: Kernel, spec: PassSpec, path: str, wires: Mapping[str, Source | None]) -> Leaf:
    """Return the leaf of a kernel, fed by ``wires``."""
    names = dict.fromkeys([*input_names(kernel), *initial_names(kernel)])
    return Leaf(path, kernel, tuple((name, wires.get(name)) for name in names), spec)


def join(prefix: str, name: str) -> str:
    """Return the path of a pass or a parameter inside another's."""
    return f"{prefix}.{name}" if prefix else name


def _reads(node: Node) -> set[str]:
    """Return the paths of the leaves that a node reads, those inside a loop apart."""
    paths = {s.path for leaf in leaves_of([node]) for _, s in leaf.inputs if isinstance(s, Ref)}
    if isinstance(node, Loop):
        paths -= {leaf.path for leaf in leaves_of(node.body)}
        paths |= _starts(node)
    return paths


def _starts(loop: Loop) -> set[str]:
    """Return what the first steps of a loop, and of the loops in it, read."""
    starts = {first.path for _, first, _ in loop.feedback if isinstance(first, Ref)}
    inside = [_starts(node) for node in loop.body if isinstance(node, Loop)]
    return starts | (set().union(*inside) - {leaf.path for leaf in leaves_of(loop.body)})


def ordered(nodes: list[Node], graph: Graph) -> list[Node]:
    """Sort nodes so that each follows what it reads, otherwise as written."""
    owner = {leaf.path: i for i, node in enumerate(nodes) for leaf in leaves_of([node])}
    needs = {i: {owner[p] for p in _reads(node) if p in owner} for i, node in enumerate(nodes)}
    order: dict[int, None] = {}
    while len(order) < len(nodes):
        ready = next((i for i in needs if i not in order and needs[i] <= order.keys()), None)
        if ready is None:
            raise _circle(nodes, needs, order, graph)
        order[ready] = None
    return [nodes[i] for i in order]


def _circle(
    nodes: list[Node], needs: dict[int, set[int]], done: dict[int, None], graph: Graph
) -> SketchError:
    chain = [next(i for i in needs if i not in done)]
    while chain[-1] not in chain[:-1]:
        chain.append(next(i for i in needs[chain[-1]] if i not in done))
    chain = chain[chain.index(chain[-1]) :]
    names = " → ".join(nodes[i].path for i in chain)
    spec = nodes[chain[0]].spec
    message = f"the passes read each other in a circle: {names}; a loop needs repeat and feedback"
    return SketchError(message, file=spec.file or shown(graph.path), line=spec.line)
