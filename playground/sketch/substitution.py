"""Substitute verified fast variants for techniques of a flat sketch.

A variant's own kernel stands at its technique's path; the passes of a ``.fast.toml`` are at
``pass.fast.inner``, which no path may name. A variant gives its technique's outputs only, and after the
last step: why one does not run is an ``Omission``.
"""

from __future__ import annotations

import logging
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from playground.memo import GRAPHS
from playground.shader.kernel import Variant
from playground.sketch.assign import effective_values, resolve
from playground.sketch.flat import Flat, GraphShape, Leaf, Loop, Node, Ref, Source, leaves_of
from playground.sketch.flatten import (
    Flattener,
    flatten,
    in_running_order,
    is_exported,
    join,
    leaf_of,
    ordered,
)
from playground.sketch.model import VARIANTS, Graph, Kernel, PassSpec, Sketch, Technique, Value
from playground.sketch.variants import INSIDE, Omission, active_variant, unverified
from playground.sketch.wiring import initial_names, input_names

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
    shape = _substituted(flat.shape, limits)
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
def _substituted(shape: GraphShape, limits: _Limits) -> GraphShape:
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
        self.reads = list(_reads(shape.written))
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
            self.reads += _reads(nodes)
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


def _reads(nodes: Collection[Node]) -> Iterator[tuple[str, Ref]]:
    """Yield the textures that nodes read, each with the path of its reader."""
    for node in nodes:
        if isinstance(node, Loop):
            paths = [source for _, first, ref in node.feedback for source in (first, ref)]
            yield from _reads(node.body)
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
