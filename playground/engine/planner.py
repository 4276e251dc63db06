"""Make a sketch concrete: sizes, counts, files, the terrain's metres. Still no OpenGL.

A plan is made whole once for a graph of passes. Where only values have changed since, the passes
whose values they are get them, and the rest of the plan stays; it is made whole again where a
size or a count names a changed value or the time, or where the terrain's file is another one.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

from playground.data.image_files import picture_size
from playground.engine.camera import Eye, look
from playground.engine.lattice import between_of
from playground.engine.plan import LoopStep, Plan, PlanNode, Step, most_iterations
from playground.engine.plan_request import (
    PlanRequest,
    checked_pixels,
    checked_seconds,
    checked_steps,
)
from playground.engine.sizes import MAX_REPEAT, PassSizes, check_shapes, counted, sizes_of_variant
from playground.engine.source_facts import described, given_values, own_sizes
from playground.engine.source_kinds import Terrain
from playground.errors import ParameterError, SketchError, nearest
from playground.memo import Memo
from playground.paths import shown
from playground.shader import expressions
from playground.shader.expressions import Number
from playground.sketch.flat import Flat, Leaf, Loop, Node, repeated_path, repeated_paths
from playground.sketch.flatten import flatten
from playground.sketch.model import LARGEST_SIDE, Graph, Sketch, Technique, Value
from playground.sketch.substitution import substitute_variants
from playground.sketch.wiring import inner, output_names, target_of

_MOST_PLANS = 8  # of so many graphs, picture sizes and stops the last plan is remembered


@dataclass(frozen=True, slots=True)
class _LastPlan:
    """The last plan of a graph, and what it depends on."""

    plan: Plan
    values: Mapping[str, Mapping[str, Value]]  # of each leaf, by its path
    named: frozenset[str]  # paths of the values that a size or a count names
    by_time: bool  # one of them names the time
    pictures: Mapping[Path, tuple[int, int]]  # files whose sizes one of them names
    refusals: Mapping[str, str]  # why a fast variant does not take its size: a sentence, by its technique
    own: Mapping[str, tuple[int, int]]  # texels that sources have by themselves, by the path of the leaf


class Planner:
    """Makes plans, and remembers the last of each graph."""

    def __init__(self) -> None:
        self.made_whole = 0  # plans that were not made of an earlier one
        self._plans: Memo[object, _LastPlan] = Memo("plans of an engine", _MOST_PLANS)

    def plan(
        self,
        sketch: Sketch,
        *,
        frame_size: tuple[int, int],
        time: float = 0.0,
        variants: Collection[str] = (),
        steps: Mapping[str, int] | None = None,
        wanted: str = "",
        interpolated: bool | None = None,
        largest: int = LARGEST_SIDE,
    ) -> Plan:
        """Make a sketch concrete for one frame of at most ``largest`` pixels a side, its keyframes included.

        ``variants`` are the kinds of fast variants that may replace techniques, but not
        those around the pass that is ``wanted`` itself; ``steps`` stops repeated passes early, by
        path (that of a technique will do where one pass inside it repeats), and no later than they
        end unless their number changes with time or keyframes. What a stopped pass has not computed is
        ``interpolated`` in pictures and not in what is ``wanted``, unless given (see ``between``).
        Raises ``SketchError`` or ``DataError`` at the pass that is wrong, ``ShaderError`` at a
        kernel's header.
        """
        size, seconds = checked_pixels(frame_size, largest), checked_seconds(time)
        varies = any(keyframe.values for keyframe in sketch.keyframes)
        sketch = sketch.at(seconds)
        stopped = {
            repeated_in(sketch, path): checked_steps(path, count) for path, count in (steps or {}).items()
        }
        fills = not wanted if interpolated is None else interpolated
        terrain = Terrain(sketch.size, sketch.extent, sketch.relief, sketch.base_elevation)
        request = PlanRequest(size, tuple(stopped.items()), fills, "compute" in variants, varies, terrain)
        place = (id(sketch.graph), sketch.folder, sketch.plain, tuple(variants), wanted, request)

        def flat(refused: Iterable[str]) -> Flat:
            return substitute_variants(
                flatten(sketch),
                () if sketch.plain else variants,
                wanted=wanted,
                stopped=tuple(stopped),
                refused=tuple(refused),
            )

        found = None
        if known := self._plans.get(place):
            now = known.plan.flat  # most frames set no value
            if sketch.overrides is not known.plan.sketch.overrides:
                now = flat(known.refusals)
            found = _Planning(sketch, now, request, seconds, known=known).renewed()
        if found is None:
            self.made_whole += 1
            making, refused = _Planning(sketch, flat(()), request, seconds), dict[str, str]()
            while more := making.refusals(refused):
                refused |= more
                making = _Planning(sketch, flat(refused), request, seconds, after=making)
            found = making.whole(refused)
        self._plans.put(place, found, 1, sketch.graph)
        return found.plan


def repeated_in(sketch: Sketch, path: str) -> str:
    """Return the path of the repeated pass that a path means, or raise ``SketchError``.

    It is the path itself, or that of the only pass that repeats inside a technique.
    """
    nodes = flatten(sketch).nodes
    found = repeated_path(str(path), nodes)
    if found is None:
        hint = nearest(str(path), repeated_paths(nodes)) or "; none of its passes repeats"
        raise SketchError(f"steps: no repeated pass '{path}' in sketch {sketch.name}{hint}")
    return found


def repeats_of(sketch: Sketch, *, frame_size: tuple[int, int] = (1, 1), time: float = 0.0) -> dict[str, int]:
    """Return the iterations in all of every repeated kernel and loop, by path; what draws is left out."""
    return most_iterations(Planner().plan(sketch, frame_size=frame_size, time=time).nodes)


class _Planning:
    """One plan being made.

    ``known`` is the last of the same graph, made for the same request; ``after``: an attempt in which
    fast variants refused their sizes, which depends on what those sizes name.
    """

    def __init__(
        self,
        sketch: Sketch,
        flat: Flat,
        request: PlanRequest,
        time: float,
        known: _LastPlan | None = None,
        after: _Planning | None = None,
    ) -> None:
        self.sketch = sketch
        self.flat = flat
        self.request = request
        self.time = time
        self.known = known if known and known.plan.flat.shape is flat.shape else None
        self._most: dict[
            str, int
        ] = {}  # iterations in all of each repeat, by path; the most where they differ
        self._made: dict[tuple[object, ...], PlanNode] = {}  # each once, whatever iterations have it
        self._bodies: dict[tuple[int, ...], tuple[PlanNode, ...]] = {}
        self.values = self._values_now()
        self.terrain = described(sketch, flat, self.values)
        self.own = dict(own_sizes(sketch, flat, self.values))
        self._after = after

    def _values_now(self) -> Mapping[str, Mapping[str, Value]]:
        """Return the values of each leaf, by its path: the last plan's own where none is another."""
        known, flat, sketch = self.known, self.flat, self.sketch
        if known is None:
            return {leaf.path: given_values(leaf, sketch, flat) for leaf in flat.leaves}
        # Of the same values a file may have come that is found first.
        doubtful, changed = [(leaf, True) for leaf in flat.with_files], dict[str, Mapping[str, Value]]()
        if flat is not known.plan.flat:
            found = [(leaf, flat.has_values_of(known.plan.flat, leaf)) for leaf in flat.leaves]
            doubtful = [pair for pair in found if not pair[1] or pair[0].kernel.file_parameters]
        for leaf, is_same in doubtful:
            now = given_values(leaf, sketch, flat)
            if not is_same or now != known.values[leaf.path]:
                changed[leaf.path] = now
        return {**known.values, **changed} if changed else known.values

    @cached_property
    def sizes(self) -> PassSizes:
        """What works out sizes and counts."""
        assert self.terrain.size is not None
        found = PassSizes(
            self.sketch, self.flat, self.request, self.time, self.terrain.size, self.values, self.own
        )
        if self._after is not None:
            copied = self._after.flat.shape.copied
            found.named = {copied.get(path, path) for path in self._after.sizes.named}
            found.by_time = self._after.sizes.by_time
        return found

    def renewed(self) -> _LastPlan | None:
        """Return the known plan with the values of now; None where it has to be made whole."""
        known = self.known
        if (
            known is None
            or known.plan.terrain != self.terrain
            or known.own != self.own
            or (known.by_time and known.plan.time != self.time)
        ):
            return None
        plan, now, before = known.plan, self.flat.values, known.plan.flat.values
        if now is not before and [path for path in known.named if now[path] is not before[path]]:
            return None
        if any(picture_size(file) != size for file, size in known.pictures.items()):
            return None
        eye = plan.eye if plan.sketch.camera == self.sketch.camera else self._eye()
        nodes = plan.nodes if self.values is known.values else self._all_renewed(plan.nodes, {})
        plan = replace(plan, sketch=self.sketch, nodes=nodes, flat=self.flat, eye=eye, time=self.time)
        return replace(known, plan=plan, values=self.values)

    def _all_renewed(self, nodes: tuple[PlanNode, ...], done: dict[int, Any]) -> tuple[PlanNode, ...]:
        """Return nodes with the values of now; ``done``: what was returned for nodes and for several."""
        if id(nodes) not in done:
            found = tuple([self._renewed(node, done) for node in nodes])
            same = all([now is before for now, before in zip(found, nodes, strict=True)])
            done[id(nodes)] = nodes if same else found
        return done[id(nodes)]  # type: ignore[no-any-return]

    def _renewed(self, node: PlanNode, done: dict[int, Any]) -> PlanNode:
        if id(node) not in done:
            done[id(node)] = node
            if isinstance(node, LoopStep):
                bodies = tuple([self._all_renewed(body, done) for body in node.bodies])
                if any([now is not before for now, before in zip(bodies, node.bodies, strict=True)]):
                    done[id(node)] = replace(node, bodies=bodies)
            elif node.values is not self.values[node.path]:
                done[id(node)] = replace(node, values=self.values[node.path])
        return done[id(node)]  # type: ignore[no-any-return]

    def whole(self, refused: Mapping[str, str]) -> _LastPlan:
        """Make the plan from nothing; ``refused``: the sentences that ``refusals`` gave, by technique."""
        # What has the terrain's own size first: the others' sizes follow from it.
        for leaf in self.flat.leaves:
            if leaf.spec.size is None:
                self._refuse(leaf, self._size_of_leaf(leaf))
        nodes = tuple(self._node(node) for node in self.flat.nodes)
        self._check_stops()
        lacking = tuple(
            f"{path or 'the sketch'} does without compute shaders, which are not here: "
            f"see {shown(self.flat.graphs[path].path)}"
            for path in self.sizes.lacking
        )
        plan = Plan(
            sketch=self.sketch,
            nodes=nodes,
            flat=self.flat,
            terrain=self.terrain,
            eye=self._eye(),
            frame_size=self.request.frame_size,
            time=self.time,
            steps=dict(self.request.stopped),
            interpolated=self.request.fills,
            lacking=(*lacking, *refused.values(), *(str(o) for o in self.flat.shape.omitted if o.is_news)),
        )
        sizes = self.sizes
        named = frozenset(sizes.named & self.flat.values.keys())
        return _LastPlan(plan, self.values, named, sizes.by_time, sizes.pictures, refused, sizes.own)

    def refusals(self, before: Collection[str]) -> dict[str, str]:
        """Return a sentence for each technique whose fast variant does not take its size, by its path.

        Those of ``before`` are left out.
        """
        found: dict[str, str] = {}
        for leaf in self.flat.leaves:
            path, accepts = sizes_of_variant(leaf, self.flat)
            if accepts and path not in found and path not in before:
                for size in self.sizes.sizes_of(self._sized(leaf)):
                    if not expressions.is_accepted(accepts, size):
                        found[path] = (
                            f"{path}: {Path(leaf.kernel.path).name} takes {accepts} texels a side, "
                            f"not {size[0]} x {size[1]}; the plain form runs"
                        )
                        break
        return found

    def _eye(self) -> Eye:
        extent, relief = self.terrain.extent, self.terrain.relief
        assert extent is not None and relief is not None
        return look(self.sketch.camera, extent, relief, self.request.frame_size)

    def _node(self, node: Node) -> PlanNode:
        if isinstance(node, Loop):
            whole = self.sizes.count_of(node.path)
            run = self._stopped(node.path, whole, node.repeat)
            made = [self._body(node.body) for _ in self.sizes.iterations(node.path)]
            bodies = tuple(made if any(body is not made[0] for body in made) else made[:1])
            loop = LoopStep(node.path, run, whole, bodies, node.feedback, node.spec)
            return self._made.setdefault((node.path, run, whole, *map(id, bodies)), loop)
        kernel = node.kernel
        size = self._size_of_leaf(node)
        values = self.values[node.path]
        self._refuse(node, size)
        check_shapes(node, self.flat, self.sizes.size_of_source)
        numbers: dict[str, Number] = {"size.x": size[0], "size.y": size[1], **self.sizes.clocks()}
        numbers |= {k: v for k, v in values.items() if isinstance(v, int | float)}
        if kernel.counts != ("1",):
            self._note_names(node)
        whole = 1 if kernel.repeat == "1" else counted(kernel.repeat, node.path, kernel, numbers)
        # Of a kernel that repeats in a loop of the same path, the loop is what stops.
        repeat = whole if node.spec.repeat else self._stopped(node.path, whole, kernel.repeat)
        between = between_of(node, repeat, whole, numbers) if self.request.fills else None
        step = Step(
            path=node.path,
            kernel=kernel,
            values=values,
            inputs=node.inputs,
            size=size,
            repeat=repeat,
            whole=whole,
            spec=node.spec,
            between=between,
        )
        return self._made.setdefault((node.path, size, repeat, whole, between), step)

    def _body(self, nodes: tuple[Node, ...]) -> tuple[PlanNode, ...]:
        """Return what an iteration of a loop runs: the very same where another runs the same."""
        found = tuple([self._node(node) for node in nodes])
        return self._bodies.setdefault(tuple(map(id, found)), found)

    def _note_names(self, leaf: Leaf) -> None:
        """Note what a kernel's own counts name."""
        names = frozenset().union(*map(expressions.names_in, leaf.kernel.counts))
        self.sizes.by_time |= not names.isdisjoint(expressions.CLOCKS)
        self.sizes.named |= {path for name, path in self.flat.shape.paths[leaf.path] if name in names}

    def _stopped(self, path: str, whole: int, repeat: str) -> int:
        """Return how many of a repeat's iterations run."""
        varies = self.request.varies or expressions.follows_time(repeat)
        self._most[path] = MAX_REPEAT if varies else max(whole, self._most.get(path, 0))
        return self.request.steps_of(path, whole)

    def _check_stops(self) -> None:
        """Raise ``ParameterError`` for a repeat that stops after more iterations than it has."""
        for path, steps in self.request.stopped:
            whole = self._most.get(path, steps)
            if steps > whole:
                raise ParameterError(f"steps: '{path}' stops after {steps} steps, but it has {whole} in all")

    def _refuse(self, leaf: Leaf, size: tuple[int, int]) -> None:
        """Raise ``SketchError`` for a size that a kernel does not take, with the nearest that it takes."""
        if not leaf.kernel.accepts or expressions.is_accepted(leaf.kernel.accepts, size):
            return
        near = expressions.nearest_accepted(leaf.kernel.accepts, size)
        listed = " or ".join(f"{x} x {y}" for x, y in near)
        raise leaf.spec.error(
            f"pass '{leaf.path}' ({leaf.kernel.name}) takes {leaf.kernel.accepts} texels a side, "
            f"not {size[0]} x {size[1]}; the nearest it takes: {listed}"
        )

    def _size_of_leaf(self, leaf: Leaf) -> tuple[int, int]:
        return self.sizes.size_of(self._sized(leaf))

    def _sized(self, leaf: Leaf) -> str:
        """Return the path whose size a leaf has; a compute variant's is the pass's whose output it gives."""
        path = leaf.path
        technique: Technique = self.flat.graphs.get(path, leaf.kernel)
        while isinstance(technique, Graph):
            where = target_of(technique, output_names(technique)[0]).partition(":")[0]
            path, found = f"{path}.{where}", inner(technique, where)
            if found is None:
                break
            technique = found
        return path
