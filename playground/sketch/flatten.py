"""Flatten a sketch's nested techniques into passes and loops, wired and in order.

The result names no sizes and no pixels: ``engine.plan`` adds those. Wiring follows one
rule at every level: an input takes what its pass wires, else what the technique's own
caller wires through ``[inputs]``, else the latest earlier pass of its name, else the
latest earlier pass with an output of its name.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from playground.errors import SketchError, nearest
from playground.paths import shown
from playground.sketch.assign import resolve, values_of
from playground.sketch.model import Graph, Kernel, Output, PassSpec, Sketch, Technique, Value


@dataclass(frozen=True, slots=True)
class Ref:
    """A texture: an output of a leaf pass."""

    path: str  # of the leaf, "height.sum"
    output: str

    def __str__(self) -> str:
        return f"{self.path}:{self.output}"


@dataclass(frozen=True, slots=True)
class Fed:
    """A texture that a loop feeds back: its own output of the turn before."""

    loop: str  # path of the loop
    name: str  # of the fed input


Source = Ref | Fed


@dataclass(frozen=True)
class Leaf:
    """One kernel, draw or source to run."""

    path: str
    kernel: Kernel
    values: tuple[tuple[str, Value], ...]
    inputs: tuple[tuple[str, Source | None], ...]  # None: its fallback, or no initial state
    folder: str  # where its files are looked for
    spec: PassSpec


@dataclass(frozen=True)
class Loop:
    """Passes that run over and over, some inputs fed by outputs of the turn before."""

    path: str
    repeat: str
    body: tuple[Leaf | Loop, ...]
    feedback: tuple[tuple[str, Source | None, Ref], ...]  # input, what the first turn reads, output
    spec: PassSpec


Node = Leaf | Loop


@dataclass(frozen=True)
class Flat:
    """A sketch without nesting."""

    nodes: tuple[Node, ...]  # in an order that wiring allows
    specs: dict[str, PassSpec]  # every pass at every level, by path
    graphs: dict[str, Graph]  # every technique of several passes, by path; "" is the sketch
    values: dict[str, Value]  # every leaf parameter, by path
    outputs: dict[str, dict[str, Ref]]  # every pass at every level: its outputs

    def ref(self, text: str, sketch: str) -> Ref:
        """Return the texture that ``pass[.inner…][:output]`` stands for; raise ``SketchError``."""
        path, _, output = text.partition(":")
        if path not in self.outputs:
            raise SketchError(f"no pass '{path}' in sketch {sketch}{nearest(path, self.outputs)}")
        found = self.outputs[path]
        if not output:
            return found[path] if path in found else next(iter(found.values()))
        if output not in found:
            raise SketchError(f"pass '{path}' has no output '{output}'{nearest(output, found)}")
        return found[output]


def flatten(sketch: Sketch, *, compute: bool) -> Flat:
    """Flatten a sketch; ``compute`` lets companions stand for whole techniques.

    Raises ``SketchError`` at the pass that is wrong, with the nearest valid name.
    """
    maker = _Flattener(values_of(sketch), sketch.folder, compute)
    nodes = maker.expand(sketch.graph, "", {})
    return Flat(tuple(nodes), maker.specs, maker.graphs, maker.values, maker.outputs)


def output_names(technique: Technique) -> tuple[str, ...]:
    """Return the names of a technique's outputs."""
    if isinstance(technique, Kernel):
        return tuple(o.name for o in technique.outputs)
    if technique.outputs:
        return tuple(name for name, _ in technique.outputs)
    return output_names(technique.passes[-1].technique)


def input_names(technique: Technique) -> tuple[str, ...]:
    """Return the names of a technique's inputs, optional ones included."""
    if isinstance(technique, Kernel):
        return tuple(i.name for i in technique.inputs)
    return tuple(e.name for e in technique.inputs)


def initial_names(kernel: Kernel) -> dict[str, str]:
    """Map the optional inputs that a repeated kernel or a draw starts from to the outputs they start."""
    if kernel.kind == "draw":
        return {"initial": kernel.outputs[0].name}
    if kernel.kind != "kernel" or kernel.repeat == "1":
        return {}
    if len(kernel.outputs) == 1:
        return {"initial": kernel.outputs[0].name}
    return {f"initial_{o.name}": o.name for o in kernel.outputs}


def takes_input(technique: Technique, name: str) -> bool:
    """Say whether an input of that name, or path inside, can be wired."""
    if isinstance(technique, Kernel):
        return name in input_names(technique) or name in initial_names(technique)
    head, _, rest = name.partition(".")
    if not rest:
        return name in input_names(technique)
    spec = technique.find(head)
    return spec is not None and takes_input(spec.technique, rest)


def outputs_with_formats(graph: Graph) -> tuple[Output, ...]:
    """Return a technique's outputs with the formats that its inner kernels give them."""
    found = []
    for name in output_names(graph):
        output = _leaf_output(graph, name)
        found.append(replace(output, name=name))
    return tuple(found)


def check_graph(graph: Graph) -> None:
    """Raise ``SketchError`` for an export, input or output of a technique that stands for nothing."""
    for export in graph.parameters:
        for target in export.targets:
            try:
                resolve(graph, target)
            except SketchError as error:
                raise SketchError(f"{export.name}: {error}", file=shown(graph.path), line=export.line) from None
    for export in graph.inputs:
        for target in export.targets:
            if "." not in target or not takes_input(graph, target):
                valid = [f"{s.name}.{i}" for s in graph.passes for i in input_names(s.technique)]
                message = f"input '{export.name}': nothing inside takes '{target}'{nearest(target, valid)}"
                raise SketchError(message, file=shown(graph.path), line=export.line)
    for name, _ in graph.outputs:
        _leaf_output(graph, name)


def _leaf_output(graph: Graph, name: str) -> Output:
    text = dict(graph.outputs).get(name, f"{graph.passes[-1].name}:{name}")
    path, _, output = text.partition(":")
    technique: Technique = graph
    for part in path.split("."):
        spec = technique.find(part) if isinstance(technique, Graph) else None
        if spec is None:
            raise SketchError(f"output '{name}': no pass '{path}' inside {graph.name}", file=shown(graph.path))
        technique = spec.technique
    names = output_names(technique)
    output = output or (name if name in names else names[0])
    if output not in names:
        raise SketchError(f"output '{name}': '{path}' has no '{output}'{nearest(output, names)}", file=shown(graph.path))
    if isinstance(technique, Graph):
        return _leaf_output(technique, output)
    return next(o for o in technique.outputs if o.name == output)


class _Flattener:
    def __init__(self, values: dict[str, Value], folder: str, compute: bool) -> None:
        self.values = values
        self.folder = folder
        self.compute = compute
        self.specs: dict[str, PassSpec] = {}
        self.graphs: dict[str, Graph] = {}
        self.outputs: dict[str, dict[str, Ref]] = {}

    def expand(self, graph: Graph, prefix: str, wires: Mapping[str, Source | None]) -> list[Node]:
        """Return the nodes of a graph; ``wires`` maps inputs, as paths inside it, to what feeds them."""
        self.graphs[prefix] = graph
        for spec in graph.passes:
            path = _join(prefix, spec.name)
            self.specs[path] = spec
            self.outputs[path] = self._outputs_of(spec.technique, path)
        inside: dict[str, Source | None] = {}
        for name, source in wires.items():
            export = next((e for e in graph.inputs if e.name == name), None)
            for target in export.targets if export else (name,):
                inside[target] = source
        nodes: list[Node] = []
        earlier: list[PassSpec] = []
        for spec in graph.passes:
            own = {k.partition(".")[2]: v for k, v in inside.items() if k.partition(".")[0] == spec.name}
            nodes += self._one(spec, prefix, own, earlier)
            earlier.append(spec)
        return _ordered(nodes, graph)

    def _outputs_of(self, technique: Technique, path: str) -> dict[str, Ref]:
        if isinstance(technique, Kernel):
            return {o.name: Ref(path, o.name) for o in technique.outputs}
        if self.compute and technique.companion:
            return {name: Ref(path, name) for name in output_names(technique)}
        found = {}
        for name in output_names(technique):
            text = dict(technique.outputs).get(name, f"{technique.passes[-1].name}:{name}")
            inner, _, output = text.partition(":")
            inner_technique: Technique = technique
            for part in inner.split("."):
                spec = inner_technique.find(part) if isinstance(inner_technique, Graph) else None
                if spec is None:
                    raise SketchError(f"output '{name}': no pass '{inner}' inside", file=shown(technique.path))
                inner_technique = spec.technique
            below = self._outputs_of(inner_technique, _join(path, inner))
            found[name] = below[output] if output in below else below.get(name, next(iter(below.values())))
        return found

    def _one(
        self, spec: PassSpec, prefix: str, given: Mapping[str, Source | None], earlier: list[PassSpec]
    ) -> list[Node]:
        path = _join(prefix, spec.name)
        technique = spec.technique
        wires: dict[str, Source | None] = dict(given)
        for name, text in spec.inputs:
            wires[name] = self._ref(text, name, prefix, spec)
        for name in input_names(technique):
            if name not in wires:
                wires[name] = self._unwired(name, prefix, spec, earlier)
        if not spec.repeat:
            return self._body(spec, path, wires)
        feedback = []
        for name, output in spec.feedback:
            feedback.append((name, wires.get(name), self.outputs[path][output]))
            wires[name] = Fed(path, name)
        return [Loop(path, spec.repeat, tuple(self._body(spec, path, wires)), tuple(feedback), spec)]

    def _body(self, spec: PassSpec, path: str, wires: Mapping[str, Source | None]) -> list[Node]:
        technique = spec.technique
        if isinstance(technique, Graph):
            if not (self.compute and technique.companion):
                return self.expand(technique, path, wires)
            kernel = technique.companion
            values = tuple(
                (p.name, self.values[_join(path, resolve(technique, p.name)[0].path)]) for p in kernel.parameters
            )
            self.graphs[path] = technique
        else:
            kernel = technique
            values = tuple((p.name, self.values[_join(path, p.name)]) for p in kernel.parameters)
        wanted = (*(i.name for i in kernel.inputs), *initial_names(kernel))
        inputs = tuple((name, wires.get(name)) for name in wanted)
        return [Leaf(path, kernel, values, inputs, self.folder, spec)]

    def _ref(self, text: str, wanted: str, prefix: str, spec: PassSpec) -> Ref:
        inner, _, output = text.partition(":")
        path = _join(prefix, inner)
        head = _join(prefix, inner.split(".")[0])
        graph = self.graphs[prefix]
        if head not in self.specs:
            names = [p.name for p in graph.passes if p is not spec]
            raise spec.error(f"input '{wanted}' names no pass '{inner}'{nearest(inner, names)}")
        if path not in self.outputs:
            technique: Technique = self.specs[head].technique
            for part in inner.split(".")[1:]:
                found = technique.find(part) if isinstance(technique, Graph) else None
                if found is None:
                    raise spec.error(f"input '{wanted}': nothing named '{inner}' inside '{inner.split('.')[0]}'")
                technique = found.technique
            outputs = self._outputs_of(technique, path)
        else:
            outputs = self.outputs[path]
        if output:
            if output not in outputs:
                raise spec.error(f"input '{wanted}': pass '{inner}' has no output '{output}'{nearest(output, outputs)}")
            return outputs[output]
        if wanted in outputs:
            return outputs[wanted]
        return next(iter(outputs.values()))

    def _unwired(self, name: str, prefix: str, spec: PassSpec, earlier: list[PassSpec]) -> Source | None:
        for other in reversed(earlier):
            if other.name == name:
                outputs = self.outputs[_join(prefix, other.name)]
                return outputs.get(name, next(iter(outputs.values())))
        for other in reversed(earlier):
            outputs = self.outputs[_join(prefix, other.name)]
            if name in outputs:
                return outputs[name]
        if _is_optional(spec.technique, name):
            return None
        candidates = [
            f"{other.name}:{output}" if len(outputs) > 1 else other.name
            for other in earlier
            for outputs in [self.outputs[_join(prefix, other.name)]]
            for output in outputs
        ]
        hint = f"; candidates: {', '.join(candidates)}" if candidates else "; there is no earlier pass"
        raise spec.error(f"pass '{spec.name}' needs its input '{name}' wired, as inputs = {{ {name} = \"…\" }}{hint}")


def _is_optional(technique: Technique, name: str) -> bool:
    if isinstance(technique, Kernel):
        if name in initial_names(technique):
            return True
        return any(i.name == name and i.fallback for i in technique.inputs)
    export = next((e for e in technique.inputs if e.name == name), None)
    if export is None:
        return True
    for target in export.targets:
        head, _, rest = target.partition(".")
        spec = technique.find(head)
        if spec is None or not _is_optional(spec.technique, rest):
            return False
    return True


def _join(prefix: str, name: str) -> str:
    return f"{prefix}.{name}" if prefix else name


def leaves_of(nodes: tuple[Node, ...] | list[Node]) -> Iterator[Leaf]:
    """Yield every leaf, those inside loops included."""
    for node in nodes:
        if isinstance(node, Loop):
            yield from leaves_of(node.body)
        else:
            yield node


def _reads(node: Node) -> set[str]:
    found = {s.path for leaf in leaves_of([node]) for _, s in leaf.inputs if isinstance(s, Ref)}
    if isinstance(node, Loop):
        found |= {first.path for _, first, _ in node.feedback if isinstance(first, Ref)}
        found -= {leaf.path for leaf in leaves_of(node.body)}
    return found


def _ordered(nodes: list[Node], graph: Graph) -> list[Node]:
    """Sort nodes so that each follows what it reads, otherwise as written."""
    owner = {leaf.path: i for i, node in enumerate(nodes) for leaf in leaves_of([node])}
    needs = {i: {owner[p] for p in _reads(node) if p in owner} for i, node in enumerate(nodes)}
    order: list[int] = []
    while len(order) < len(nodes):
        ready = next((i for i in range(len(nodes)) if i not in order and needs[i] <= set(order)), None)
        if ready is None:
            rest = [i for i in range(len(nodes)) if i not in order]
            chain = [rest[0]]
            while True:
                following = next(j for j in needs[chain[-1]] if j not in order)
                chain.append(following)
                if following in chain[:-1]:
                    break
            chain = chain[chain.index(chain[-1]) :]
            names = " → ".join(nodes[i].path for i in chain)
            spec = nodes[chain[0]].spec
            raise SketchError(
                f"the passes read each other in a circle: {names}; a loop needs repeat and feedback",
                file=spec.file or shown(graph.path),
                line=spec.line,
            )
        order.append(ready)
    return [nodes[i] for i in order]
