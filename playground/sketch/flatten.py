"""Flatten a sketch's nested techniques into passes and loops, wired and in order.

The result names no sizes and no pixels: ``engine.plan`` adds those. Wiring follows one
rule at every level: an input takes what its pass wires, else what the technique's own
caller wires through ``[inputs]``, else the latest earlier pass of its name, else the
latest earlier pass with an output of its name, but for an input that decides which passes
are there (see ``wiring``). What is wired to a path inside a technique
wins over what is wired to its export.

Every technique is in its canonical form; ``substitute_variants`` puts fast variants in place of some.

What a loop that counts frames reads and what changes with the time moves into the loop, so that each of its
frames reads it as it was then: a film has another picture, a kernel another time. Outside of the loop it
would be what it is at the end, in all frames, and each new moment would start the loop again.

The shape of the result depends on the graph alone and is computed once for each; a slider
only puts new values into it.
"""

from __future__ import annotations

import logging
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from playground.errors import SketchError, nearest
from playground.memo import GRAPHS
from playground.paths import shown
from playground.shader.expressions import counts_frames, follows_time
from playground.shader.header import replaced
from playground.shader.kernel import Variant
from playground.shader.reserved_names import CLOCKED
from playground.sketch.assign import effective_values, find_targets, resolve, why_absent
from playground.sketch.flat import Fed, Flat, GraphShape, Leaf, Loop, Node, Ref, Source, leaves_of
from playground.sketch.follows import follow, rules_of
from playground.sketch.model import VARIANTS, Graph, Kernel, PassSpec, PlainFragment, Sketch, Technique, Value
from playground.sketch.variants import INSIDE, Omission, active_variant, unverified
from playground.sketch.wiring import (
    found_source,
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
    shape = graph_shape(graph)
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
def graph_shape(graph: Graph) -> GraphShape:
    """Expand the techniques of a graph into passes, in running order."""
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
        found = found_source(spec.technique, name, earlier)
        if found is not None:
            return self.outputs[join(prefix, found[0].name)][found[1]]
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


# ── fast variants ────────────────────────────────────────────────────────────
#
# A variant's own kernel stands at its technique's path; the passes of a ``.fast.toml`` are at
# ``pass.fast.inner``, which no path may name. A variant gives its technique's outputs only, and after the
# last step: why one does not run is an ``Omission``.

_log = logging.getLogger(__name__)


def substitute_variants(
    flat: Flat,
    kinds: Collection[str],
    *,
    ref: str = "",
    stopped: tuple[str, ...] = (),
    refused: tuple[str, ...] = (),
) -> Flat:
    """Return a canonical flat sketch with verified fast variants of some ``kinds`` in place of techniques.

    None replaces a technique around the pass that is ``ref`` or around one that is ``stopped``, nor
    one that is ``stopped`` or ``refused`` itself.
    """
    if not kinds:
        return flat
    limits = _Limits(frozenset(kinds), ref.partition(":")[0], stopped, refused, flat.set_inside)
    shape = substituted_shape(flat.shape, limits)
    values = flat.values
    if plain := {path for path, name, default in shape.lacking if values[join(path, name)] != default}:
        more = (*refused, *sorted(plain))
        return substitute_variants(flat, kinds, ref=ref, stopped=stopped, refused=more)
    if shape.constants:
        values = values | shape.constants | {path: values[source] for path, source in shape.copied.items()}
    return replace(flat, shape=shape, values=values)


def omissions(sketch: Sketch, kinds: Collection[str]) -> tuple[Omission, ...]:
    """Return the fast variants that do not run in a sketch of any size, where ``kinds`` can run."""
    shape = substitute_variants(flatten(sketch), () if sketch.plain else kinds).shape
    return (*unverified(sketch, kinds), *shape.omitted)


def omitted(sketch: Sketch, kinds: Collection[str]) -> tuple[str, ...]:
    """Return a message for each of the ``omissions`` that follows from no request."""
    return tuple(str(omission) for omission in omissions(sketch, kinds) if omission.is_news)


class _Limits(NamedTuple):
    """What bars fast variants: see ``substitute_variants``."""

    kinds: frozenset[str]
    ref: str
    stopped: tuple[str, ...]
    refused: tuple[str, ...]
    set_inside: tuple[str, ...]


@GRAPHS.cached(identities=1, weight=256)
def substituted_shape(shape: GraphShape, limits: _Limits) -> GraphShape:
    """Replace techniques by their variants, as far as the limits allow."""
    made = _Substitution(shape, limits)
    for path in shape.specs:  # a technique before what is inside it
        made.consider(path)
    for omission in made.omitted:
        _log.debug("%s", omission)
    return made.shape()


class _Substitution:
    def __init__(self, shape: GraphShape, limits: _Limits) -> None:
        self.canonical, self.limits = shape, limits
        self.found = Flattener(shape)
        self.leaves = {leaf.path: leaf for leaf in leaves_of(shape.written)}
        self.reads = list(_read_refs(shape.written))
        inside = [("", path) for path in limits.set_inside]
        for prefix, graph in shape.graphs.items():
            inside += [(prefix, f"{spec.name}.{path}") for spec in graph.passes for path, _ in spec.values]
        self.set_inside = {at for prefix, path in inside for at in _around_hidden(shape, prefix, path)}
        self.replaced: dict[str, list[Node]] = {}  # technique → the nodes in place of its own
        self.renamed: dict[Ref, Ref] = {}  # texture of a technique that is replaced → that of its variant
        self.constants: dict[str, Value] = {}
        self.copied: dict[str, str] = {}
        self.omitted: list[Omission] = []
        self.lacking: list[tuple[str, str, Value]] = []

    def consider(self, path: str) -> None:
        """Substitute the fast variant of the technique at a path, if it has one that runs here."""
        spec = self.found.specs[path]
        variant = active_variant(spec.technique, self.limits.kinds)
        if self._replaced_around(path) is not None:
            return
        if variant is None:
            if other := active_variant(spec.technique, VARIANTS):
                name, reason = Path(other.path).name, _LIMITS[other.kind]
                self.omitted.append(Omission(name, reason, path, is_news=False))
            return
        is_graph = isinstance(spec.technique, Graph)
        wires = self.found.wires[path] if is_graph else dict(self.leaves[path].inputs)
        if reason := self._why_not(path, spec.technique, variant, wires):
            name, is_news = Path(variant.path).name, reason.startswith(_LACKS)
            self.omitted.append(Omission(name, reason, path, is_news=is_news))
        else:
            self._substitute(path, spec, variant, wires)

    def _why_not(
        self, path: str, technique: Technique, variant: Variant, wires: dict[str, Source | None]
    ) -> str:
        """Return why a fast variant does not run in place of the technique at a path; "" where it does."""
        if path in self.limits.refused:
            return "the plan refuses it"
        if any(_is_at(item, path) for item in self.limits.stopped):
            return "it is stopped early"
        outputs = {*self.found.outputs[path].values()}
        read = (s for reader, s in self.reads if _is_at(s.path, path) and not _is_at(reader, path))
        if self.limits.ref.startswith(f"{path}.") or not outputs.issuperset(read):
            return "a pass inside is read"
        if any("." in name for name in wires):
            return "something is wired to a pass inside"
        if path in self.set_inside:
            return "a parameter inside is set"
        if variant.kind != "draws" and any(wires.get(name) for name in initial_names(technique)):
            return "it takes no initial state"
        unread = {*input_names(technique)} - {*input_names(variant.technique)}
        lacking = sorted(name for name in unread if wires.get(name))
        return f"{_LACKS} {' and '.join(lacking)}" if lacking else ""

    def _substitute(
        self, path: str, spec: PassSpec, variant: Variant, wires: dict[str, Source | None]
    ) -> None:
        technique, fast, result = spec.technique, variant.technique, self.found
        before = result.outputs[path]
        if variant.kind == "draws":
            self.lacking += [(path, *own) for own in _defaults_of_lacking(technique, fast)]
        if isinstance(fast, Kernel):
            result.paths[path] = tuple((p.name, _own(technique, path, p.name)) for p in fast.parameters)
            self.replaced[path] = [leaf_of(fast, spec, path, wires)]
            now = {name: Ref(path, name) for name in before}
        else:
            inner = join(path, INSIDE)
            result.specs[inner] = PassSpec(INSIDE, spec.use, fast, file=spec.file, line=spec.line)
            nodes = self.replaced[path] = result.expand(fast, inner, wires)
            now = result.outputs_of(fast, inner)
            self.leaves |= {leaf.path: leaf for leaf in leaves_of(nodes)}
            self.reads += _read_refs(nodes)
            self.constants |= {join(inner, name): value for name, value in effective_values(fast).items()}
            for export in fast.parameters:
                for target in resolve(fast, export.name):
                    self.copied[join(inner, target.path)] = _own(technique, path, export.name)
        self.renamed |= {old: now[name] for name, old in before.items() if old != now[name]}
        for inside in [spec for spec in result.specs if spec.startswith(f"{join(path, INSIDE)}.")]:
            self.consider(inside)

    def shape(self) -> GraphShape:
        """Return the shape with what was substituted."""
        nodes = tuple(self._nodes(self.canonical.written))
        result = self.found
        there = {leaf.path for leaf in leaves_of(nodes)}
        return GraphShape(
            nodes=in_running_order(nodes, result.graphs),
            specs=result.specs,
            graphs=result.graphs,
            outputs=self._present({path: result.outputs[path] for path in self.canonical.outputs}),
            wires=self._present(result.wires),
            paths={path: own for path, own in result.paths.items() if path in there},
            rules=self.canonical.rules,
            written=nodes,
            constants=self.constants,
            copied=self.copied,
            omitted=tuple(self.omitted),
            lacking=tuple(self.lacking),
        )

    def _present(self, sources: Mapping[str, Mapping[str, Source | None]]) -> Any:
        """Return the textures of passes, by path and name, without the passes that are replaced."""
        return {
            path: {name: self._now(source) for name, source in own.items()}
            for path, own in sources.items()
            if self._replaced_around(path) is None
        }

    def _nodes(self, nodes: Collection[Node]) -> list[Node]:
        """Return nodes with those of fast variants in place of their techniques', in an order that runs."""
        result: list[Node] = []
        names: set[str] = set()
        for node in nodes:
            path = self._replaced_around(node.path)
            if path is None and isinstance(node, Leaf) and node.path in self.replaced:
                path = node.path
            if path is None and isinstance(node, Loop):
                result.append(self._rewired(replace(node, body=tuple(self._nodes(node.body)))))
            elif path is None:
                result.append(self._rewired(node))
            elif path not in names:
                names.add(path)
                result += self._nodes_of(path)
        return ordered(result, self.canonical.graphs[""]) if names else result

    def _nodes_of(self, path: str) -> list[Node]:
        """Return the nodes of a fast variant, in which others may be substituted."""
        own = self.replaced[path]
        return [self._rewired(own[0])] if own[0].path == path else self._nodes(own)

    def _rewired(self, node: Node) -> Node:
        if not self.renamed:
            return node
        if isinstance(node, Loop):
            feedback = tuple((name, self._now(first), self._now(ref)) for name, first, ref in node.feedback)
            return replace(node, feedback=feedback)
        return replace(node, inputs=tuple((name, self._now(source)) for name, source in node.inputs))

    def _now(self, source: Source | None) -> Any:
        """Return what gives a texture now."""
        while isinstance(source, Ref) and source in self.renamed:
            source = self.renamed[source]
        return source

    def _replaced_around(self, path: str) -> str | None:
        """Return the technique around a path whose own passes a fast variant replaces."""
        while path:
            path, _, name = path.rpartition(".")
            if path in self.replaced and name != INSIDE:
                return path
        return None


def _read_refs(nodes: Collection[Node]) -> Iterator[tuple[str, Ref]]:
    """Yield the textures that nodes read, each with the path of its reader."""
    for node in nodes:
        if isinstance(node, Loop):
            paths = [source for _, first, ref in node.feedback for source in (first, ref)]
            yield from _read_refs(node.body)
        else:
            paths = [source for _, source in node.inputs]
        yield from ((node.path, source) for source in paths if isinstance(source, Ref))


def _is_at(path: str, technique: str) -> bool:
    return path == technique or path.startswith(f"{technique}.")


def _around_hidden(shape: GraphShape, prefix: str, path: str) -> Iterator[str]:
    """Yield the techniques around a parameter, by its path inside one, that do not export it."""
    while "." in path:
        first, _, path = path.partition(".")
        prefix = join(prefix, first)
        if "." in path and prefix in shape.graphs and not is_exported(shape.graphs[prefix], path):
            yield prefix


def _defaults_of_lacking(technique: Technique, variant: Technique) -> list[tuple[str, Value]]:
    """Return the values that a technique has and its fast variant lacks: paths inside, and defaults."""
    values, own_names = effective_values(technique), {parameter.name for parameter in variant.parameters}
    names = [parameter.name for parameter in technique.parameters if parameter.name not in own_names]
    return [(target.path, values[target.path]) for name in names for target in resolve(technique, name)]


def _own(technique: Technique, path: str, name: str) -> str:
    """Return where the value of a technique's parameter is, by the parameter's name."""
    return join(path, name if isinstance(technique, Kernel) else resolve(technique, name)[0].path)


_LACKS = "it does not read what is wired to"
"""Begins the reason of a fast variant that lacks an input."""

_LIMITS = {
    "compute": "there are no compute shaders here",
    "passes": "fast variants of several passes are not asked for",
    "draws": "it is for whole pictures of one sample a pixel on a software renderer",
}
"""Why a kind of fast variant does not run at all."""
