"""Make a sketch concrete: sizes, counts, files, the terrain's metres. Still no OpenGL.

``make_plan`` is a function of a sketch and a request. ``planned`` returns the same plan, made of the last
plan of the same graph where only values have changed since: the passes whose values they are get them, and
the rest of the plan stays. It is made whole again where a size or a count names a changed value or the time,
or where the terrain's file is another one.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

from playground.data.image_files import picture_size
from playground.engine.camera import Eye, look
from playground.engine.lattice import between_of
from playground.engine.plan import (
    LoopStep,
    Plan,
    PlanBasis,
    PlanNode,
    PlanRequest,
    Step,
    checked_pixels,
    checked_seconds,
    checked_steps,
    error_at,
    most_iterations,
)
from playground.engine.sizes import MAX_REPEAT, PassSizes, counted
from playground.engine.source_kinds import Terrain
from playground.engine.sources import source_kind
from playground.engine.textures import misfit
from playground.errors import DataError, ParameterError, PlaygroundError, SketchError, nearest
from playground.memo import PLANS
from playground.paths import shown
from playground.shader import expressions
from playground.shader.expressions import Number
from playground.sketch.files import find_file
from playground.sketch.flat import Fed, Flat, Leaf, Loop, Node, Source, repeated_path, repeated_paths
from playground.sketch.flatten import flatten, substitute_variants
from playground.sketch.model import ComputeVariant, Graph, Sketch, Technique, Value
from playground.sketch.variants import INSIDE
from playground.sketch.wiring import inner, output_names, target_of

DEFAULT_SIZE = (513, 513)  # texels of a terrain whose size nothing says
DEFAULT_EXTENT = 10_240.0  # [m] from west to east
DEFAULT_RELIEF = 1_800.0  # [m]

Values = Mapping[str, Mapping[str, Value]]
"""The values of each leaf, by its path."""


def make_plan(sketch: Sketch, request: PlanRequest) -> Plan:
    """Make a sketch concrete for one frame, its keyframes included.

    Raises ``ParameterError`` for a request that cannot be, ``SketchError`` or ``DataError`` at the pass that
    is wrong, ``ShaderError`` at a kernel's header.
    """
    return _made(sketch, _checked(sketch, request), None)


def planned(sketch: Sketch, request: PlanRequest) -> Plan:
    """Return what ``make_plan`` does, made of the last plan of the same graph as far as that still holds."""
    request = _checked(sketch, request)
    variants, steps = (*request.variants, request.canonical), tuple(request.steps.items())
    shown = request.fills, request.exaggeration
    asked = request.frame_size, variants, steps, request.ref, *shown, _varies(sketch)
    key = (planned, id(sketch.graph), sketch.folder, sketch.plain, sketch.terrain, asked)
    return PLANS.put(key, _made(sketch, request, PLANS.get(key)), 1, sketch.graph)  # type: ignore[no-any-return]


def repeated_in(sketch: Sketch, path: str) -> str:
    """Return the path of the repeated pass that a path means, or raise ``SketchError``.

    It is the path itself, or that of the only pass that repeats inside a technique.
    """
    nodes = flatten(sketch).nodes
    path_of_repeat = repeated_path(str(path), nodes)
    if path_of_repeat is None:
        hint = nearest(str(path), repeated_paths(nodes)) or "; none of its passes repeats"
        raise SketchError(f"steps: no repeated pass '{path}' in sketch {sketch.name}{hint}")
    return path_of_repeat


def repeats_of(sketch: Sketch, *, frame_size: tuple[int, int] = (1, 1), time: float = 0.0) -> dict[str, int]:
    """Return the iterations in all of every repeated kernel and loop, by path; what draws is left out."""
    return most_iterations(make_plan(sketch, PlanRequest(frame_size, time)).nodes)


def smallest_terrain(sketch: Sketch, least: int = 33) -> tuple[int, int]:
    """Return the smallest terrain of ``least`` texels a side or more that all its kernels take."""
    return flatten(sketch).accepted((least, least))


def _checked(sketch: Sketch, request: PlanRequest) -> PlanRequest:
    """Return a request with numbers that can be, and stops by the paths of what repeats."""
    return replace(
        request,
        frame_size=checked_pixels(request.frame_size, request.largest),
        time=checked_seconds(request.time),
        steps={
            repeated_in(sketch, path): checked_steps(path, count) for path, count in request.steps.items()
        },
    )


def _varies(sketch: Sketch) -> bool:
    """Return whether keyframes set parameters, and so perhaps counts of steps."""
    return any(keyframe.values for keyframe in sketch.keyframes)


def _made(sketch: Sketch, request: PlanRequest, last: Plan | None) -> Plan:
    """Make a plan; ``last`` is one of the same graph for the same request, at any time."""
    varies, sketch = _varies(sketch), sketch.at(request.time)
    names = request.canonical.split(".") if request.canonical else []
    around = [".".join(names[: count + 1]) for count in range(len(names))]

    def flat(refused: Iterable[str]) -> Flat:
        return substitute_variants(
            flatten(sketch),
            () if sketch.plain else request.variants,
            ref=request.ref,
            stopped=tuple(request.steps),
            refused=(*refused, *around),
        )

    if last is not None:
        now = last.flat  # most frames set no value
        if sketch.overrides is not last.sketch.overrides:
            now = flat(last.basis.refusals)
        updated_plan = Planning(sketch, now, request, varies, last=last).updated_plan()
        if updated_plan is not None:
            return updated_plan
    making, refused = Planning(sketch, flat(()), request, varies), dict[str, str]()
    while more := making.refusals(refused):
        refused |= more
        making = Planning(sketch, flat(refused), request, varies, after=making)
    return making.build(refused)


class Planning:
    """One plan being made.

    ``varies``: keyframes set parameters; ``last`` is the last plan of the same graph, made for the same
    request; ``after``: an attempt in which fast variants refused their sizes, which depends on what those
    sizes name.
    """

    def __init__(
        self,
        sketch: Sketch,
        flat: Flat,
        request: PlanRequest,
        varies: bool,
        last: Plan | None = None,
        after: Planning | None = None,
    ) -> None:
        self.sketch = sketch
        self.flat = flat
        self.request = request
        self.varies = varies
        self.last = last if last and last.flat.shape is flat.shape else None
        # Iterations in all of each repeat, by path; the most where they differ.
        self._most: dict[str, int] = {}
        self._made: dict[tuple[object, ...], PlanNode] = {}  # each once, whatever iterations have it
        self._bodies: dict[tuple[int, ...], tuple[PlanNode, ...]] = {}
        self.values = self._values_now()
        self.terrain = _terrain_of(sketch, flat, self.values)
        self.own = dict(_own_sizes(sketch, flat, self.values))
        self._after = after

    def _values_now(self) -> Values:
        """Return the values of each leaf, by its path: the last plan's own where none is another."""
        last, flat, sketch = self.last, self.flat, self.sketch
        if last is None:
            return {leaf.path: _given_values(leaf, sketch, flat) for leaf in flat.leaves}
        # Of the same values a file may have come that is found first.
        candidates, changed = (
            [(leaf, True) for leaf in flat.with_files],
            dict[str, Mapping[str, Value]](),
        )
        if flat is not last.flat:
            pairs_of_leaves = [(leaf, flat.has_values_of(last.flat, leaf)) for leaf in flat.leaves]
            candidates = [pair for pair in pairs_of_leaves if not pair[1] or pair[0].kernel.file_parameters]
        for leaf, is_same in candidates:
            now = _given_values(leaf, sketch, flat)
            if not is_same or now != last.basis.values[leaf.path]:
                changed[leaf.path] = now
        return {**last.basis.values, **changed} if changed else last.basis.values

    @cached_property
    def sizes(self) -> PassSizes:
        """What works out sizes and counts."""
        assert self.terrain.size is not None
        pass_sizes = PassSizes(self.sketch, self.flat, self.request, self.terrain.size, self.values, self.own)
        if self._after is not None:
            copied = self._after.flat.shape.copied
            pass_sizes.named = {copied.get(path, path) for path in self._after.sizes.named}
            pass_sizes.by_time = self._after.sizes.by_time
        return pass_sizes

    def updated_plan(self) -> Plan | None:
        """Return the last plan with the values of now; None where it has to be made whole."""
        last, time = self.last, self.request.time
        if (
            last is None
            or last.terrain != self.terrain
            or last.basis.own != self.own
            or (last.basis.by_time and last.time != time)
        ):
            return None
        basis, now, before = last.basis, self.flat.values, last.flat.values
        if now is not before and [path for path in basis.named if now[path] is not before[path]]:
            return None
        if any(picture_size(file) != size for file, size in basis.pictures.items()):
            return None
        eye = last.eye if last.sketch.camera == self.sketch.camera else self._eye()
        nodes = last.nodes
        if self.values is not basis.values:
            nodes, basis = self._all_updated(nodes, {}), replace(basis, values=self.values)
        return replace(last, sketch=self.sketch, nodes=nodes, flat=self.flat, eye=eye, time=time, basis=basis)

    def _all_updated(self, nodes: tuple[PlanNode, ...], done: dict[int, Any]) -> tuple[PlanNode, ...]:
        """Return nodes with the values of now; ``done``: what was returned for nodes and for several."""
        if id(nodes) not in done:
            updated = tuple([self._renewed(node, done) for node in nodes])
            same = all([now is before for now, before in zip(updated, nodes, strict=True)])
            done[id(nodes)] = nodes if same else updated
        return done[id(nodes)]  # type: ignore[no-any-return]

    def _renewed(self, node: PlanNode, done: dict[int, Any]) -> PlanNode:
        if id(node) not in done:
            done[id(node)] = node
            if isinstance(node, LoopStep):
                bodies = tuple([self._all_updated(body, done) for body in node.bodies])
                if any([now is not before for now, before in zip(bodies, node.bodies, strict=True)]):
                    done[id(node)] = replace(node, bodies=bodies)
            elif node.values is not self.values[node.path]:
                done[id(node)] = replace(node, values=self.values[node.path])
        return done[id(node)]  # type: ignore[no-any-return]

    def build(self, refused: Mapping[str, str]) -> Plan:
        """Make the plan from nothing; ``refused``: the sentences that ``refusals`` gave, by technique."""
        # What has the terrain's own size first: the others' sizes follow from it.
        for leaf in self.flat.leaves:
            if leaf.spec.size is None:
                self._refuse(leaf, self._size_of_leaf(leaf))
        nodes = tuple(self.plan_node(node) for node in self.flat.nodes)
        self._check_stops()
        lacking = tuple(
            f"{path or 'the sketch'} does without compute shaders, which are not here: "
            f"see {shown(self.flat.graphs[path].path)}"
            for path in self.sizes.lacking
        )
        sizes, request = self.sizes, self.request
        return Plan(
            sketch=self.sketch,
            nodes=nodes,
            flat=self.flat,
            terrain=self.terrain,
            eye=self._eye(),
            frame_size=request.frame_size,
            time=request.time,
            basis=PlanBasis(
                values=self.values,
                named=frozenset(sizes.named & self.flat.values.keys()),
                by_time=sizes.by_time,
                pictures=sizes.pictures,
                refusals=refused,
                own=sizes.own,
            ),
            steps=request.steps,
            exaggeration=request.exaggeration,
            interpolated=request.fills,
            lacking=(*lacking, *refused.values(), *(str(o) for o in self.flat.shape.omitted if o.is_news)),
        )

    def refusals(self, before: Collection[str]) -> dict[str, str]:
        """Return a message for each technique whose fast variant does not take its size, by its path.

        Those of ``before`` are left out.
        """
        refusals: dict[str, str] = {}
        for leaf in self.flat.leaves:
            path, accepts = _sizes_of_variant(leaf, self.flat)
            if accepts and path not in refusals and path not in before:
                for size in self.sizes.sizes_of(self._sized(leaf)):
                    if not expressions.is_accepted(accepts, size):
                        refusals[path] = (
                            f"{path}: {Path(leaf.kernel.path).name} takes {accepts} texels a side, "
                            f"not {size[0]} x {size[1]}; the plain form runs"
                        )
                        break
        return refusals

    def _eye(self) -> Eye:
        extent, relief = self.terrain.extent, self.terrain.relief
        assert extent is not None and relief is not None
        shown_relief = relief * self.request.exaggeration
        return look(self.sketch.camera, extent, shown_relief, self.request.frame_size)

    def plan_node(self, node: Node) -> PlanNode:
        """Plan a pass or a loop."""
        if isinstance(node, Loop):
            total = self.sizes.count_of(node.path)
            run = self._stopped(node.path, total, node.repeat)
            made = [self._body(node.body) for _ in self.sizes.iterations(node.path)]
            bodies = tuple(made if any(body is not made[0] for body in made) else made[:1])
            loop = LoopStep(node.path, run, total, bodies, node.feedback, node.spec)
            return self._made.setdefault((node.path, run, total, *map(id, bodies)), loop)
        kernel = node.kernel
        size = self._size_of_leaf(node)
        values = self.values[node.path]
        self._refuse(node, size)
        _check_shapes(node, self.flat, self.sizes.size_of_source)
        numbers: dict[str, Number] = {"size.x": size[0], "size.y": size[1], **self.sizes.clocks()}
        numbers |= {k: v for k, v in values.items() if isinstance(v, int | float)}
        if kernel.counts != ("1",):
            self._note_names(node)
        total = 1 if kernel.repeat == "1" else counted(kernel.repeat, node.path, kernel, numbers)
        # Of a kernel that repeats in a loop of the same path, the loop is what stops.
        repeat = total if node.spec.repeat else self._stopped(node.path, total, kernel.repeat)
        between = between_of(node, repeat, total, numbers) if self.request.fills else None
        step = Step(
            path=node.path,
            kernel=kernel,
            values=values,
            inputs=node.inputs,
            size=size,
            repeat=repeat,
            total=total,
            spec=node.spec,
            between=between,
        )
        return self._made.setdefault((node.path, size, repeat, total, between), step)

    def _body(self, nodes: tuple[Node, ...]) -> tuple[PlanNode, ...]:
        """Return what an iteration of a loop runs: the very same where another runs the same."""
        body = tuple([self.plan_node(node) for node in nodes])
        return self._bodies.setdefault(tuple(map(id, body)), body)

    def _note_names(self, leaf: Leaf) -> None:
        """Note what a kernel's own counts name."""
        names = frozenset().union(*map(expressions.names_in, leaf.kernel.counts))
        self.sizes.by_time |= not names.isdisjoint(expressions.CLOCKS)
        self.sizes.named |= {path for name, path in self.flat.shape.paths[leaf.path] if name in names}

    def _stopped(self, path: str, total: int, repeat: str) -> int:
        """Return how many of a repeat's iterations run."""
        varies = self.varies or expressions.follows_time(repeat)
        self._most[path] = MAX_REPEAT if varies else max(total, self._most.get(path, 0))
        return self.request.steps_of(path, total)

    def _check_stops(self) -> None:
        """Raise ``ParameterError`` for a repeat that stops after more iterations than it has."""
        for path, steps in self.request.steps.items():
            total = self._most.get(path, steps)
            if steps > total:
                raise ParameterError(f"steps: '{path}' stops after {steps} steps, but it has {total} in all")

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
            path, technique_inside = f"{path}.{where}", inner(technique, where)
            if technique_inside is None:
                break
            technique = technique_inside
        return path


# ── what a plan is made of ───────────────────────────────────────────────────


def _sizes_of_variant(leaf: Leaf, flat: Flat) -> tuple[str, str]:
    """Return which technique a fast variant's kernel runs for, and the sizes that it takes; else nothing."""
    if isinstance(leaf.kernel, ComputeVariant):
        return leaf.path, leaf.kernel.own_accepts
    path, inside, _ = leaf.path.partition(f".{INSIDE}.")
    is_variant = inside and flat.specs[path].technique.variants
    return (path, leaf.kernel.accepts) if is_variant else (path, "")


def _check_shapes(leaf: Leaf, flat: Flat, size_of: Callable[[Source], tuple[int, int]]) -> None:
    """Raise ``SketchError`` for what is wired to a cube map, a volume or an array and cannot be one.

    ``size_of`` returns the size in texels of what an input reads.
    """
    shapes = {declared.name: declared.shape for declared in leaf.kernel.inputs if declared.shape}
    for name, source in leaf.inputs if shapes else ():
        if source is None or name not in shapes:
            continue
        size = size_of(source)
        if isinstance(source, Fed):
            output = dict(flat.specs[source.loop].feedback)[source.name]
            source = flat.outputs[source.loop][output]
        if wrong := misfit(shapes[name], size):
            message = f"{name} reads '{source.path}', {size[0]} x {size[1]} texels; {wrong}"
            raise flat.user(leaf.path).error(f"pass '{leaf.path}': {message}")


def _known_by_sources(sketch: Sketch, flat: Flat, values: Values) -> Terrain:
    """Return what the first source that knows anything of the terrain says of it."""
    for leaf in flat.sources:
        _check_source(leaf)
        try:
            terrain = source_kind(leaf.kernel.registry).describe(values[leaf.path])
        except DataError as error:
            raise error_at(error, sketch, flat.user(leaf.path)) from error
        if terrain != Terrain():
            return terrain
    return Terrain()


def extent_follows_size(sketch: Sketch, flat: Flat, values: Values) -> bool:
    """Return whether nothing says the terrain's metres: its sides are to each other as its texels are."""
    terrain = _known_by_sources(sketch, flat, values)
    return sketch.terrain.extent is None and terrain.extent is None and terrain.size is None


def _terrain_of(sketch: Sketch, flat: Flat, values: Values) -> Terrain:
    """Return the terrain with every field known: by the sketch, else by its first source that knows."""
    own, terrain = sketch.terrain, _known_by_sources(sketch, flat, values)
    size = own.size or flat.accepted(terrain.size or DEFAULT_SIZE)
    extent = own.extent or terrain.extent
    if extent is None:
        shape = terrain.size or size
        ratio = (shape[1] - 1) / max(shape[0] - 1, 1) or 1.0
        extent = (DEFAULT_EXTENT, DEFAULT_EXTENT * ratio)
    relief = own.relief if own.relief is not None else terrain.relief
    base = own.base_elevation if own.base_elevation is not None else terrain.base_elevation
    relief = DEFAULT_RELIEF if relief is None else relief
    return Terrain(size, extent, relief, base or 0.0, terrain.place)


def _own_sizes(sketch: Sketch, flat: Flat, values: Values) -> Iterator[tuple[str, tuple[int, int]]]:
    """Yield the texels that sources have by themselves, such as a film, where their passes say none."""
    for leaf in flat.sources:
        if leaf.spec.size is None and leaf.path != "view":
            try:
                size = source_kind(leaf.kernel.registry).size(values[leaf.path])
            except DataError as error:
                raise error_at(error, sketch, flat.user(leaf.path)) from error
            if size is not None:
                yield leaf.path, size


def _given_values(leaf: Leaf, sketch: Sketch, flat: Flat) -> dict[str, Value]:
    """Return a leaf's values as its kernel gets them: files by absolute path, of menus their values."""
    values = flat.values_of(leaf)
    for parameter in leaf.kernel.valued_menus:
        values[parameter.name] = parameter.widget.uniform_value(values[parameter.name])
    for parameter in leaf.kernel.file_parameters:
        text = str(values[parameter.name])
        try:
            path = find_file(text, flat.folder, parameter.file, f"{leaf.path}.{parameter.name}")
        except DataError as error:
            raise error_at(error, sketch, flat.user(leaf.path)) from error
        values[parameter.name] = str(path)
    return values


def _check_source(leaf: Leaf) -> None:
    try:
        kind = source_kind(leaf.kernel.registry)
    except PlaygroundError as error:
        raise leaf.spec.error(str(error)) from None
    missing = [name for name in kind.parameters if leaf.kernel.parameter(name) is None]
    if missing:
        raise leaf.spec.error(f"source '{leaf.kernel.registry}' needs the parameters {', '.join(missing)}")
    declared = [item.name for item in leaf.kernel.inputs]
    if set(declared) != set(kind.inputs):
        expected = f"the inputs {', '.join(kind.inputs)}" if kind.inputs else "no inputs"
        declared_text = f"; the file declares {', '.join(declared) or 'none'}"
        raise leaf.spec.error(f"source '{leaf.kernel.registry}' needs {expected}{declared_text}")
