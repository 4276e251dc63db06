"""Make a sketch concrete: sizes, counts, files, the terrain's metres. Still no OpenGL.

A plan is made whole once for a graph of passes. Where only values have changed since, the passes
whose values they are get them, and the rest of the plan stays; it is made whole again where a
size or a count names a changed value or the time, or where the terrain's file is another one.
"""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import partial
from itertools import zip_longest
from pathlib import Path

from playground.engine.accepted_sizes import sizes_of_variant
from playground.engine.between import between_of
from playground.engine.error_place import placed
from playground.engine.input_shapes import check_shapes
from playground.engine.plan import LoopStep, Plan, PlanNode, Step, every_node
from playground.engine.plan_request import (
    PlanRequest,
    checked_pixels,
    checked_seconds,
    checked_steps,
)
from playground.engine.source_facts import described, given_values, own_sizes
from playground.errors import DataError, ParameterError, SketchError, nearest
from playground.images.picture_size import picture_size
from playground.paths import shown
from playground.sketch import expressions
from playground.sketch.assign import resolve
from playground.sketch.expressions import ExpressionError, Number
from playground.sketch.flat import Flat, Leaf, Loop, Node, repeated_path, repeated_paths
from playground.sketch.flatten import flatten
from playground.sketch.identity import Identity
from playground.sketch.model import LARGEST_SIDE, Graph, Kernel, PassSpec, Sketch, Technique, Value
from playground.sketch.named_numbers import (
    CLOCK,
    COMPUTE,
    FRAME,
    PICTURE,
    SIZE,
    TERRAIN,
    base_of,
    named,
)
from playground.sketch.wiring import inner, output_names, target_of
from playground.terrain.camera import Eye, look
from playground.terrain.source_kinds import Terrain

MAX_REPEAT = 1_000_000
Names = Mapping[str, Number] | Callable[[str], Number]
"""The numbers of the names in an expression."""
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
        self._plans: OrderedDict[object, _LastPlan] = OrderedDict()

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
        place = (Identity(sketch.graph), sketch.folder, sketch.plain, tuple(variants), wanted, request)

        def flat(refused: Iterable[str], before: Flat | None = None) -> Flat:
            return flatten(
                sketch,
                variants=variants,
                opened=(wanted,) if wanted else (),
                stopped=tuple(stopped),
                refused=tuple(refused),
                before=before,
            )

        found = None
        if known := self._plans.pop(place, None):
            now = flat(known.refusals, known.plan.flat)
            found = _Planning(sketch, now, request, seconds, known=known).renewed()
        if found is None:
            self.made_whole += 1
            making, refused = _Planning(sketch, flat(()), request, seconds), dict[str, str]()
            while more := making.refusals(refused):
                refused |= more
                making = _Planning(sketch, flat(refused), request, seconds, after=making)
            found = making.whole(refused)
        self._plans[place] = found
        while len(self._plans) > _MOST_PLANS:
            self._plans.popitem(last=False)
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
    found: dict[str, int] = {}
    for node in every_node(Planner().plan(sketch, frame_size=frame_size, time=time).nodes):
        if isinstance(node, LoopStep) or (node.kernel.kind == "kernel" and node.kernel.repeat != "1"):
            found.setdefault(node.path, node.whole)
    return found


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
        self.stopped = dict(request.stopped)
        self.known = known if known and known.plan.flat.shape is flat.shape else None
        self.lacking: dict[str, None] = {}  # techniques that lack compute shaders, by path
        copied = after.flat.shape.copied if after else {}
        self.named: set[str] = {copied.get(path, path) for path in after.named} if after else set()
        self.by_time: bool = after is not None and after.by_time
        self.pictures: dict[Path, tuple[int, int]] = {}
        self._sizes: dict[str, tuple[int, int]] = {}
        self._open: list[str] = []
        self._values: dict[str, Mapping[str, Value]] = {}
        before = self.known.values if self.known else {}
        same = self.known.plan.flat.leaves if self.known else ()
        for leaf, earlier in zip_longest(flat.leaves, same):
            values = before[leaf.path] if leaf is earlier else {}
            if leaf is not earlier or leaf.kernel.file_parameters:
                now = given_values(leaf, sketch, flat)  # a file may have come that is found first
                values = values if values == now else now
            self._values[leaf.path] = values
        self.terrain = described(sketch, flat, self._values)
        self.own = dict(own_sizes(sketch, flat, self._values))

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
        if [path for path in known.named if now[path] is not before[path]]:
            return None
        if any(picture_size(file) != size for file, size in known.pictures.items()):
            return None
        eye = plan.eye if plan.sketch.camera == self.sketch.camera else self._eye()
        nodes = tuple([self._renewed(node) for node in plan.nodes])
        plan = replace(plan, sketch=self.sketch, nodes=nodes, flat=self.flat, eye=eye, time=self.time)
        return replace(known, plan=plan, values=self._values)

    def _renewed(self, node: PlanNode) -> PlanNode:
        if isinstance(node, LoopStep):
            body = tuple([self._renewed(inside) for inside in node.body])
            same = all([now is before for now, before in zip(body, node.body, strict=True)])
            return node if same else replace(node, body=body)
        values = self._values[node.path]
        return node if node.values is values else replace(node, values=values)

    def whole(self, refused: Mapping[str, str]) -> _LastPlan:
        """Make the plan from nothing; ``refused``: the sentences that ``refusals`` gave, by technique."""
        # What has the terrain's own size first: the others' sizes follow from it.
        for leaf in self.flat.leaves:
            if leaf.spec.size is None:
                self._refuse(leaf, self._size_of_leaf(leaf))
        nodes = tuple(self._node(node) for node in self.flat.nodes)
        lacking = tuple(
            f"{path or 'the sketch'} does without compute shaders, which are not here: "
            f"see {shown(self.flat.graphs[path].path)}"
            for path in self.lacking
        )
        plan = Plan(
            sketch=self.sketch,
            nodes=nodes,
            flat=self.flat,
            terrain=self.terrain,
            eye=self._eye(),
            frame_size=self.request.frame_size,
            time=self.time,
            steps=self.stopped,
            interpolated=self.request.fills,
            lacking=(*lacking, *refused.values()),
        )
        named = frozenset(self.named & self.flat.values.keys())
        return _LastPlan(plan, self._values, named, self.by_time, self.pictures, refused, self.own)

    def refusals(self, before: Collection[str]) -> dict[str, str]:
        """Return a sentence for each technique whose fast variant does not take its size, by its path.

        Those of ``before`` are left out.
        """
        found: dict[str, str] = {}
        for leaf in self.flat.leaves:
            path, accepts = sizes_of_variant(leaf, self.flat)
            if accepts and path not in found and path not in before:
                size = self._size_of_leaf(leaf)
                if not expressions.is_accepted(accepts, size):
                    found[path] = (
                        f"{path}: {Path(leaf.kernel.path).name} takes {accepts} texels a side, "
                        f"not {size[0]} x {size[1]}; the plain form runs"
                    )
        return found

    def _eye(self) -> Eye:
        extent, relief = self.terrain.extent, self.terrain.relief
        assert extent is not None and relief is not None
        return look(self.sketch.camera, extent, relief, self.request.frame_size)

    def _node(self, node: Node) -> PlanNode:
        if isinstance(node, Loop):
            prefix = node.path.rpartition(".")[0]
            names = partial(self._number, prefix, node.spec)
            whole = self._count(node.repeat, node.spec.name, node.spec, names)
            count = self._stopped(node.path, whole, node.repeat)
            body = tuple(self._node(inside) for inside in node.body)
            return LoopStep(
                path=node.path, repeat=count, whole=whole, body=body, feedback=node.feedback, spec=node.spec
            )
        kernel = node.kernel
        size = self._size_of_leaf(node)
        values = self._values[node.path]
        self._refuse(node, size)
        check_shapes(node, self.flat, self.size_of)
        numbers: dict[str, Number] = {"size.x": size[0], "size.y": size[1], **self._clocks()}
        numbers |= {k: v for k, v in values.items() if isinstance(v, int | float)}
        if kernel.repeat != "1" or kernel.stride:
            self._note_names(node)
        whole = 1 if kernel.repeat == "1" else self._count(kernel.repeat, node.path, kernel, numbers)
        # Of a kernel that repeats in a loop of the same path, the loop is what stops.
        repeat = whole if node.spec.repeat else self._stopped(node.path, whole, kernel.repeat)
        fills = self.request.fills and kernel.between
        between = between_of(node, repeat, whole, numbers) if fills else None
        return Step(
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

    def _clocks(self) -> dict[str, Number]:
        return {"time": self.time, "frames": expressions.frames_at(self.time)}

    def _note_names(self, leaf: Leaf) -> None:
        """Note what a kernel's own counts name."""
        names = frozenset[str]()
        for text in (leaf.kernel.repeat, leaf.kernel.stride):
            names |= expressions.names_in(text) if text else names
        self.by_time |= not names.isdisjoint(expressions.CLOCKS)
        self.named |= {path for name, path in self.flat.shape.paths[leaf.path] if name in names}

    def _stopped(self, path: str, whole: int, repeat: str) -> int:
        """Return how many of a repeat's steps run; raise ``ParameterError`` for more than there are."""
        steps = self.stopped.get(path, whole)
        if steps > whole and not self.request.varies and not expressions.follows_time(repeat):
            raise ParameterError(f"steps: '{path}' stops after {steps} steps, but it has {whole} in all")
        return min(steps, whole)

    def _count(self, text: str, name: str, owner: PassSpec | Kernel, names: Names) -> int:
        """Return how many iterations; ``owner`` is what says so, and where a mistake is."""
        try:
            count = expressions.evaluate(text, names)
        except ExpressionError as error:
            raise owner.error(f"pass '{name}': repeat {error}") from None
        if not 0 <= count <= MAX_REPEAT:
            raise owner.error(
                f"pass '{name}': repeat '{text}' gives {count}; 0 to {MAX_REPEAT} were expected"
            )
        return count

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
        """Return a leaf's size; a compute variant's is that of the pass whose output it gives."""
        path = leaf.path
        technique: Technique = self.flat.graphs.get(path, leaf.kernel)
        while isinstance(technique, Graph):
            where = target_of(technique, output_names(technique)[0]).partition(":")[0]
            path, found = f"{path}.{where}", inner(technique, where)
            if found is None:
                break
            technique = found
        return self.size_of(path)

    def size_of(self, path: str) -> tuple[int, int]:
        """Return the size in texels of a pass at any level."""
        if path in self._sizes:
            return self._sizes[path]
        spec = self.flat.specs[path]
        prefix = path.rpartition(".")[0]
        if path in self._open:
            raise spec.error(f"the sizes of {' and '.join(self._open)} depend on each other")
        self._open.append(path)
        size = self._size_around(base_of(path))
        if path in self.own:
            size = self.own[path]
            self._check_sides(spec, size)
        elif spec.size is not None:
            try:
                names = partial(self._number, prefix, spec)
                size = (expressions.evaluate(spec.size[0], names), expressions.evaluate(spec.size[1], names))
            except ExpressionError as error:
                raise spec.error(f"pass '{spec.name}': size {error}") from None
            self._check_sides(spec, size)
        self._open.pop()
        self._sizes[path] = size
        return size

    def _check_sides(self, spec: PassSpec, size: tuple[int, int]) -> None:
        if not all(1 <= side <= LARGEST_SIDE for side in size):
            raise spec.error(
                f"pass '{spec.name}': size {size[0]} x {size[1]}; 1 to {LARGEST_SIDE} a side were expected"
            )

    def _size_around(self, base: str) -> tuple[int, int]:
        """Return the size of a pass, or of a base: see ``named_numbers``."""
        if base not in (TERRAIN, FRAME):
            return self.size_of(base)
        assert self.terrain.size is not None
        return self.request.frame_size if base == FRAME else self.terrain.size

    def _number(self, prefix: str, spec: PassSpec, name: str) -> Number:
        """Return the number of a name in an expression of a pass: a size, or a parameter around it.

        Raises ``KeyError`` for any other name.
        """
        kind, path, axis = named(self.flat, prefix, spec, name)
        if kind == CLOCK:
            self.by_time = True
            return self._clocks()[path]
        if kind == SIZE:
            return self._size_around(path)[axis]
        if kind == PICTURE:
            return self._picture_size(path)[axis]
        if kind == COMPUTE:
            if not self.request.compute:
                self.lacking[prefix] = None
            return int(self.request.compute)
        self.named.add(path)
        value = resolve(self.flat.graphs[prefix], name)[0].parameter.widget.given(self.flat.values[path])
        if not isinstance(value, int | float):
            raise KeyError(name)
        return value

    def _picture_size(self, path: str) -> tuple[int, int]:
        """Return the size of the picture that the parameter of a path reads."""
        self.named.add(path)
        leaf, _, parameter = path.rpartition(".")
        file = Path(str(self._values[leaf][parameter]))
        try:
            self.pictures[file] = picture_size(file)
        except DataError as error:
            raise placed(error, self.sketch, self.flat.user(leaf)) from error
        return self.pictures[file]
