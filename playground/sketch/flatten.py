"""Flatten a sketch's nested techniques into passes and loops, wired and in order.

A loop that counts frames shows each of its frames what it reads as it was then: a film has another
picture, a kernel another time. Outside of the loop they would be what they are at the end, in all its
frames, and each new moment would start the loop anew.

The result names no sizes and no pixels: ``engine.plan`` adds those. Wiring follows one
rule at every level: an input takes what its pass wires, else what the technique's own
caller wires through ``[inputs]``, else the latest earlier pass of its name, else the
latest earlier pass with an output of its name, but for an input that decides which passes
are there (see ``presence``). What is wired to a path inside a technique
wins over what is wired to its export.

Where a fast variant replaces a technique (see ``variants``), its own kernel or passes are
in the result; those of a ``.fast.toml`` are at ``pass.fast.inner``, which no path may name.

The shape of the result depends on the graph alone and is computed once for each; a slider
only puts new values into it.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from playground.errors import SketchError, nearest
from playground.paths import shown
from playground.shader.expressions import counts_frames, follows_time
from playground.shader.kernel_cache import replaced
from playground.shader.reserved_names import CLOCKED
from playground.sketch.assign import effective_values, find_targets, resolve
from playground.sketch.flat import Fed, Flat, Leaf, Loop, Node, Ref, Shape, Source, leaves_of
from playground.sketch.follows import follow, rules_of
from playground.sketch.identity import Identity
from playground.sketch.model import Graph, Kernel, PassSpec, PlainFragment, Sketch, Technique, Value, Variant
from playground.sketch.presence import deciding_inputs, why_unfed
from playground.sketch.variants import INSIDE, active_variant
from playground.sketch.wiring import (
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
    found = list(nodes)
    for loop in [node for node in nodes if isinstance(node, Loop) and counts_frames(node.repeat)]:
        index = next(i for i, node in enumerate(found) if node.path == loop.path)
        moved = _to_move(found[:index], loop)
        if moved:
            body = tuple(node for node in found[:index] if node.path in moved and isinstance(node, Leaf))
            before = [node for node in found[:index] if node.path not in moved]
            after = [node for node in before if _all_reads(node) & moved]
            while more := [n for n in before if n not in after and _all_reads(n) & {a.path for a in after}]:
                after += more
            later = [node for node in before if node in after]
            inside = replace(loop, body=(*body, *loop.body))
            found = [*(n for n in before if n not in after), inside, *later, *found[index + 1 :]]
    return found


def _to_move(earlier: Sequence[Node], loop: Loop) -> set[str]:
    """Return the paths of the leaves to move into a loop."""
    needed, wanted = [], _all_reads(loop)
    for node in reversed(earlier):
        if {leaf.path for leaf in leaves_of([node])} & wanted:
            needed.append(node)
            wanted |= _all_reads(node)
    moved: set[str] = set()
    for node in reversed(needed):
        if isinstance(node, Leaf) and (_is_clocked(node.kernel) or _all_reads(node) & moved):
            moved.add(node.path)
    staying = [node for node in needed if node.path not in moved]
    while staying:  # what stays before the loop, and all that it reads
        read = set[str]().union(*(_all_reads(node) for node in staying))
        staying = [node for node in needed if node.path in read & moved]
        moved -= {node.path for node in staying}
    return moved


def _is_clocked(kernel: Kernel) -> bool:
    if follows_time(kernel.repeat):  # what it does of each frame is its own
        return False
    return bool(kernel.depends) or kernel.reads("time") or any(m in CLOCKED for _, m in kernel.usual)


def _all_reads(node: Node) -> set[str]:
    found: set[str] = set()
    for leaf in leaves_of([node]):
        found |= {source.path for _, source in leaf.inputs if isinstance(source, Ref)}
    if isinstance(node, Loop):
        found |= _first_reads(node)
        found -= _loop_paths(node)
    return found


def _first_reads(loop: Loop) -> set[str]:
    found = {first.path for _, first, _ in loop.feedback if isinstance(first, Ref)}
    return found.union(*(_first_reads(node) for node in loop.body if isinstance(node, Loop)))


def _loop_paths(loop: Loop) -> set[str]:
    return {leaf.path for leaf in leaves_of(loop.body)}


def flatten(
    sketch: Sketch,
    *,
    variants: Collection[str] = (),
    opened: tuple[str, ...] = (),
    stopped: tuple[str, ...] = (),
    refused: tuple[str, ...] = (),
    before: Flat | None = None,
) -> Flat:
    """Flatten a sketch; fast variants of the kinds named replace techniques, where they are verified.

    A variant gives its technique's outputs only, and after the last step: it does not replace
    a technique that holds one of the paths ``opened``, or a pass inside that something is wired to,
    or a parameter inside that is set and that it does not have, or an input that it does not have,
    or a draw of which a parameter that it does not have is not at its default,
    nor one that is itself among the ``stopped`` or the ``refused``, or whose initial state is wired.
    Leaves of ``before``, an earlier result, are reused where their values are the same objects.
    Raises ``SketchError`` at the pass that is wrong, with the nearest valid name.
    """
    graph = sketch.graph
    kinds = frozenset[str]() if sketch.plain else frozenset(variants)
    inside = sorted({path for path, _ in sketch.overrides if path.count(".") > 1})
    limits = (opened, stopped, refused, tuple(inside)) if kinds else ((), (), (), ())
    shape = _shape(Identity(graph), kinds, *limits)
    values = effective_values(graph)
    for path, value in sketch.overrides:
        if path not in shape.targets:
            shape.targets[path] = tuple(target.path for target in resolve(graph, path))
        for target in shape.targets[path]:
            values[target] = value
    follow(shape.rules, values)
    if plain := {path for path, name, default in shape.lacking if values[_join(path, name)] != default}:
        more = (*refused, *sorted(plain))
        return flatten(sketch, variants=variants, opened=opened, stopped=stopped, refused=more, before=before)
    values |= shape.constants | {path: values[source] for path, source in shape.copied.items()}
    nodes, stale = shape.nodes, None
    if before is not None and before.shape is shape and before.folder == sketch.folder:
        changed = [path for path, value in values.items() if value is not before.values[path]]
        nodes, stale = before.nodes, set[str]().union(*[shape.readers.get(path, ()) for path in changed])
    return Flat(
        nodes=_filled(nodes, shape, values, sketch.folder, stale),
        specs=shape.specs,
        graphs=shape.graphs,
        values=values,
        outputs=shape.outputs,
        wires=shape.wires,
        shape=shape,
        folder=sketch.folder,
    )


def withheld(sketch: Sketch, variants: Collection[str]) -> tuple[str, ...]:
    """Return a sentence for each fast variant that lacks an input that its sketch wires."""
    return flatten(sketch, variants=variants).shape.withheld


@lru_cache(maxsize=32)
def _shape(
    key: Identity[Graph],
    kinds: frozenset[str],
    opened: tuple[str, ...],
    stopped: tuple[str, ...],
    refused: tuple[str, ...],
    overrides: tuple[str, ...],
) -> Shape:
    maker = _Flattener(key.object, kinds, opened, stopped, refused, overrides)
    nodes = tuple(with_clocked_inside(maker.expand(key.object, "", {})))
    outputs = {
        path: {name: maker.real(ref) for name, ref in found.items()}
        for path, found in maker.outputs.items()
        if f".{INSIDE}." not in path or not any(path.startswith(f"{p}.{INSIDE}.") for p in maker.inside)
    }
    wires = {
        path: {name: maker.real(source) for name, source in found.items()}
        for path, found in maker.wires.items()
    }
    inside = tuple(f"{path}.{INSIDE}." for path in maker.inside)  # there values are copied
    rules = rules_of({path: g for path, g in maker.graphs.items() if not f"{path}.".startswith(inside)})
    readers: dict[str, set[str]] = {}
    for leaf, pairs in maker.paths.items():
        for _, path in pairs:
            readers.setdefault(path, set()).add(leaf)
    return Shape(
        nodes=_with_exact_pictures(nodes, maker.graphs),
        specs=maker.specs,
        graphs=maker.graphs,
        outputs=outputs,
        wires=wires,
        paths=maker.paths,
        constants=maker.constants,
        copied=maker.copied,
        rules=rules,
        readers=readers,
        withheld=tuple(maker.withheld.values()),
        lacking=tuple(maker.lacking),
    )


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


def _filled(
    nodes: tuple[Node, ...],
    shape: Shape,
    values: Mapping[str, Value],
    folder: str,
    stale: Collection[str] | None,
) -> tuple[Node, ...]:
    """Return nodes with values in their leaves; where ``stale`` is not None, new ones in those alone."""
    if stale is not None and not stale:
        return nodes
    found: list[Node] = []
    for node in nodes:
        if isinstance(node, Loop):
            found.append(replace(node, body=_filled(node.body, shape, values, folder, stale)))
        elif stale is None or node.path in stale:
            own = tuple([(name, values[path]) for name, path in shape.paths[node.path]])
            found.append(Leaf(node.path, node.kernel, own, node.inputs, folder, node.spec))
        else:
            found.append(node)
    return tuple(found)


def is_exported(graph: Graph, path: str) -> bool:
    """Return whether a technique exports a parameter inside, and nothing else, by some name."""
    wanted = {target.path for target in find_targets(graph, path)}
    return any({t.path for t in find_targets(graph, e.name)} == wanted for e in graph.parameters)


class _Flattener:
    def __init__(
        self,
        graph: Graph,
        kinds: frozenset[str],
        opened: tuple[str, ...],
        stopped: tuple[str, ...],
        refused: tuple[str, ...],
        overrides: tuple[str, ...],
    ) -> None:
        self.kinds = kinds
        self.specs: dict[str, PassSpec] = {}
        self.graphs: dict[str, Graph] = {}
        self.outputs: dict[str, dict[str, Ref]] = {}
        self.wires: dict[str, dict[str, Source | None]] = {}
        self.paths: dict[str, tuple[tuple[str, str], ...]] = {}
        self.constants: dict[str, Value] = {}
        self.copied: dict[str, str] = {}
        # Pass → what gives its outputs: the passes of its fast variant, or its own where that steps back.
        self.inside: dict[str, dict[str, Ref]] = {}
        self.withheld: dict[str, str] = {}
        self.lacking: list[tuple[str, str, Value]] = []
        self.opened: set[str] = set()
        if kinds:
            for path in (*opened, *stopped):
                self._open("", path)
            self.opened |= {*stopped, *refused}
            self._open_wired(graph, "")
            for path in overrides:
                self._open_set(graph, "", path)

    def _open(self, prefix: str, path: str) -> None:
        """Bar fast variants from replacing the techniques around a pass."""
        parts = path.partition(":")[0].split(".")
        self.opened |= {_join(prefix, ".".join(parts[:i])) for i in range(1, len(parts))}

    def _open_wired(self, graph: Graph, prefix: str) -> None:
        for _, text in graph.outputs:
            self._open(prefix, text)
        for export in graph.inputs:
            for target in export.targets:
                self._open(prefix, target.rpartition(".")[0])
        for spec in graph.passes:
            for _, text in spec.inputs:
                self._open(prefix, text)
            for name, _ in (*spec.inputs, *spec.feedback):
                self._open(prefix, f"{spec.name}.{name}".rpartition(".")[0])
            for path, _ in spec.values:
                self._open_set(graph, prefix, f"{spec.name}.{path}")
            if isinstance(spec.technique, Graph):
                self._open_wired(spec.technique, _join(prefix, spec.name))

    def _open_set(self, graph: Graph, prefix: str, path: str) -> None:
        """Bar fast variants from replacing the techniques that do not export a parameter inside."""
        first, _, rest = path.partition(".")
        spec = graph.find(first)
        if spec is None or not isinstance(spec.technique, Graph) or "." not in rest:
            return
        here = _join(prefix, first)
        if not is_exported(spec.technique, rest):
            self.opened.add(here)
        self._open_set(spec.technique, here, rest)

    def _active(self, technique: Technique, path: str) -> Variant | None:
        """Return the fast variant that may replace a technique, if any may."""
        return active_variant(technique, self.kinds) if self.kinds and path not in self.opened else None

    def real(self, source: Source | None) -> Any:
        """Return what gives a texture: the pass inside, of a variant of passes or where one steps back."""
        while isinstance(source, Ref) and source.path in self.inside:
            source = self.inside[source.path][source.output]
        return source

    def expand(self, graph: Graph, prefix: str, wires: Mapping[str, Source | None]) -> list[Node]:
        """Return the nodes of a graph; ``wires`` maps inputs, as paths inside it, to what feeds them."""
        self.graphs[prefix] = graph
        self.wires[prefix] = dict(wires)
        for spec in graph.passes:
            path = _join(prefix, spec.name)
            self.specs[path] = spec
            self.outputs[path] = self._outputs_of(spec.technique, path)
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
        return _ordered([self._rewired(node) for node in nodes], graph)

    def _outputs_of(self, technique: Technique, path: str) -> dict[str, Ref]:
        if isinstance(technique, Kernel):
            return {o.name: Ref(path, o.name) for o in technique.outputs}
        if self._active(technique, path):
            return {name: Ref(path, name) for name in output_names(technique)}
        found = {}
        for name in output_names(technique):
            where, _, output = target_of(technique, name).partition(":")
            source = inner(technique, where)
            if source is None:
                raise SketchError(f"output '{name}': no pass '{where}' inside", file=shown(technique.path))
            below = self._outputs_of(source, _join(path, where))
            found[name] = below[output] if output in below else below.get(name, next(iter(below.values())))
        return found

    def _one(
        self, spec: PassSpec, prefix: str, given: Mapping[str, Source | None], earlier: list[PassSpec]
    ) -> list[Node]:
        path = _join(prefix, spec.name)
        technique = spec.technique
        wires: dict[str, Source | None] = dict(given)
        for name, text in spec.inputs:
            if not takes_input(technique, name):
                raise spec.error(f"nothing takes input '{name}': {why_unfed(technique, name)}")
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
        variant = self._active(technique, path)
        starts = initial_names(technique) if isinstance(technique, Kernel) else {}
        if any(wires.get(name) for name in starts) and not (variant and variant.kind == "draws"):
            variant = None  # only the canonical form takes an initial state
        lacking = sorted(name for name in _lacking(technique, variant) if wires.get(name)) if variant else []
        if variant and lacking:
            what = f"it does not read what is wired to {' and '.join(lacking)}"
            name = Path(variant.path).name
            self.withheld[path] = f"{path}: {name} is left out, the plain form runs: {what}"
            variant = None
            if isinstance(technique, Graph):
                self.opened.add(path)
                self.inside[path] = self._outputs_of(technique, path)
        if variant and variant.kind == "draws":
            self.lacking += [(path, *own) for own in _defaults_of_lacking(technique, variant.technique)]
        if variant and isinstance(variant.technique, Graph):
            return self._passes(variant.technique, spec, path, wires)
        if isinstance(technique, Kernel):
            kernel = technique
            if variant and isinstance(variant.technique, Kernel):
                kernel = variant.technique
            self.paths[path] = tuple((p.name, _join(path, p.name)) for p in kernel.parameters)
        elif variant and isinstance(variant.technique, Kernel):
            kernel = variant.technique
            self.wires[path] = dict(wires)
            self._add_replaced(technique, path)
            self.paths[path] = tuple((p.name, _own(technique, path, p.name)) for p in kernel.parameters)
        else:
            return self.expand(technique, path, wires)
        wanted = (*input_names(kernel), *(n for n in initial_names(kernel) if n not in input_names(kernel)))
        inputs = tuple((name, wires.get(name)) for name in wanted)
        return [Leaf(path=path, kernel=kernel, values=(), inputs=inputs, folder="", spec=spec)]

    def _passes(
        self, variant: Graph, spec: PassSpec, path: str, wires: Mapping[str, Source | None]
    ) -> list[Node]:
        """Return the passes of a fast variant, in place of its technique."""
        place = _join(path, INSIDE)
        self.specs[place] = PassSpec(INSIDE, spec.use, variant, file=spec.file, line=spec.line)
        if isinstance(spec.technique, Graph):
            self.wires[path] = dict(wires)
            self._add_replaced(spec.technique, path)
        self.constants |= {_join(place, name): value for name, value in effective_values(variant).items()}
        for export in variant.parameters:
            for target in resolve(variant, export.name):
                self.copied[_join(place, target.path)] = _own(spec.technique, path, export.name)
        nodes = self.expand(variant, place, wires)
        found = self._outputs_of(variant, place)
        self.inside[path] = {name: found[name] for name in output_names(spec.technique)}
        return nodes

    def _rewired(self, node: Node) -> Node:
        """Return a node that reads from variants of several passes, where they are active."""
        if not self.inside:
            return node
        if isinstance(node, Loop):
            feedback = tuple((name, self.real(first), self.real(ref)) for name, first, ref in node.feedback)
            return replace(node, body=tuple(map(self._rewired, node.body)), feedback=feedback)
        return replace(node, inputs=tuple((name, self.real(source)) for name, source in node.inputs))

    def _add_replaced(self, graph: Graph, prefix: str) -> None:
        """Add the passes that a fast variant replaces: expressions may still name their sizes."""
        self.graphs[prefix] = graph
        for spec in graph.passes:
            self.specs[_join(prefix, spec.name)] = spec
            if isinstance(spec.technique, Graph):
                self._add_replaced(spec.technique, _join(prefix, spec.name))

    def _ref(self, text: str, wanted: str, prefix: str, spec: PassSpec) -> Ref:
        where, _, output = text.partition(":")
        head = where.partition(".")[0]
        names = [p.name for p in self.graphs[prefix].passes if p is not spec]
        if head not in names and head != spec.name:
            raise spec.error(f"input '{wanted}' names no pass '{where}'{nearest(where, names)}")
        technique = inner(self.graphs[prefix], where)
        if technique is None:
            raise spec.error(f"input '{wanted}': nothing named '{where}' inside '{head}'")
        outputs = self._outputs_of(technique, _join(prefix, where))
        if output and output not in outputs:
            raise spec.error(
                f"input '{wanted}': pass '{where}' has no output '{output}'{nearest(output, outputs)}"
            )
        if output:
            return outputs[output]
        return outputs.get(wanted.rpartition(".")[2], next(iter(outputs.values())))

    def _unwired(self, name: str, prefix: str, spec: PassSpec, earlier: list[PassSpec]) -> Source | None:
        for other in reversed(earlier):
            if other.name == name:
                outputs = self.outputs[_join(prefix, other.name)]
                return outputs.get(name, next(iter(outputs.values())))
        for other in reversed(earlier if name not in deciding_inputs(spec.technique) else []):
            outputs = self.outputs[_join(prefix, other.name)]
            if name in outputs:
                return outputs[name]
        if is_optional(spec.technique, name):
            return None
        candidates = [
            f"{other.name}:{output}" if len(outputs) > 1 else other.name
            for other in earlier
            for outputs in [self.outputs[_join(prefix, other.name)]]
            for output in outputs
        ]
        hint = f"candidates: {', '.join(candidates)}" if candidates else "there is no earlier pass"
        message = f"pass '{spec.name}' needs its input '{name}' wired, as inputs = {{ {name} = \"…\" }}"
        raise spec.error(f"{message}; {hint}")


def _lacking(technique: Technique, variant: Variant) -> set[str]:
    """Return the inputs of a technique that its fast variant does not have."""
    return {*input_names(technique)} - {*input_names(variant.technique)}


def _covered(technique: Technique, name: str, wires: Mapping[str, Source | None]) -> bool:
    """Return whether all targets of an exported input are wired by paths inside."""
    if isinstance(technique, Kernel):
        return False
    return all(
        target in wires for export in technique.inputs if export.name == name for target in export.targets
    )


def _defaults_of_lacking(technique: Technique, variant: Technique) -> list[tuple[str, Value]]:
    """Return the values that a technique has and its fast variant lacks: paths inside, and defaults."""
    values, known = effective_values(technique), {one.name for one in variant.parameters}
    names = [one.name for one in technique.parameters if one.name not in known]
    return [(target.path, values[target.path]) for name in names for target in resolve(technique, name)]


def _own(technique: Technique, path: str, name: str) -> str:
    """Return where the value of a technique's parameter is, by the parameter's name."""
    return _join(path, name if isinstance(technique, Kernel) else resolve(technique, name)[0].path)


def _join(prefix: str, name: str) -> str:
    return f"{prefix}.{name}" if prefix else name


def _reads(node: Node) -> set[str]:
    found = {s.path for leaf in leaves_of([node]) for _, s in leaf.inputs if isinstance(s, Ref)}
    if isinstance(node, Loop):
        found -= {leaf.path for leaf in leaves_of(node.body)}
        found |= _starts(node)
    return found


def _starts(loop: Loop) -> set[str]:
    """Return what the first steps of a loop, and of the loops in it, read."""
    found = {first.path for _, first, _ in loop.feedback if isinstance(first, Ref)}
    inside = [_starts(node) for node in loop.body if isinstance(node, Loop)]
    return found | (set().union(*inside) - {leaf.path for leaf in leaves_of(loop.body)})


def _ordered(nodes: list[Node], graph: Graph) -> list[Node]:
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
