"""The texels of every pass of a flat sketch, and the iterations of every loop.

Where a size or a count inside a loop names its iteration, each iteration has sizes and counts of its own:
``iteration`` says which one is meant. From outside such a loop it is the last one.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import NamedTuple

from playground.data.image_files import picture_size
from playground.engine.plan import PlanRequest, error_at
from playground.errors import DataError, PlaygroundError
from playground.memo import GRAPHS
from playground.shader import expressions
from playground.shader.expressions import CLOCKS, COUNTERS, ITERATION, ExpressionError, Number, names_in
from playground.sketch.assign import find_targets, resolve
from playground.sketch.flat import Fed, Flat, GraphShape, Loop, Node, Source
from playground.sketch.model import MAX_SIDE, Kernel, PassSpec, Sketch, Value

CLOCK, SIZE, PICTURE, VALUE, COMPUTE = "clock", "size", "picture", "value", "compute"
COUNTER, FED, UNWIRED = "counter", "fed", "unwired"
TERRAIN, FRAME = "#terrain", "#frame"
"""The bases of the sketch's own passes: of the view the picture's size, of the others the terrain's."""

_AXES = {"x": 0, "y": 1}


class Named(NamedTuple):
    """What a name stands for."""

    kind: str  # SIZE of a pass or a base, PICTURE: an image file's size, UNWIRED: 1, or another of the above
    path: str = ""  # of the pass, or TERRAIN or FRAME; of the leaf parameter; of a COUNTER's or FED's loop
    axis: int = 0  # of a size: 0 along x, 1 along y
    name: str = ""  # of a CLOCK or a COUNTER; of FED, whose size is what its loop feeds back


def base_of(path: str) -> str:
    """Return whose size a pass has unless it says another: that of the technique around it, or a base."""
    return path.rpartition(".")[0] or (FRAME if path == "view" else TERRAIN)


def loops_around(specs: Mapping[str, PassSpec], path: str) -> tuple[str, ...]:
    """Return the passes with a repeat that a pass at any level is in, outermost first, itself included."""
    parts = path.split(".")
    paths = [".".join(parts[: count + 1]) for count in range(len(parts))]
    return tuple([each for each in paths if each in specs and specs[each].repeat])


def counting(flat: Flat) -> frozenset[str]:
    """Return the loops of whose iterations each may have sizes and counts of its own, by path."""
    return _counting(flat.shape)


@GRAPHS.cached(identities=1)
def _counting(shape: GraphShape) -> frozenset[str]:
    names = set[str]()
    for path, spec in shape.specs.items():
        around = loops_around(shape.specs, path)
        texts = [(text, around[-1:]) for text in spec.size or ()]
        texts += [(spec.repeat, around[:-1][-1:])] if spec.repeat else []
        graph = shape.graphs.get(path.rpartition(".")[0])  # None inside what a fast variant replaces
        if graph is not None and not find_targets(graph, ITERATION):
            names.update(*(loop for text, loop in texts if ITERATION in names_in(text)))
    return frozenset(names)


def named(flat: Flat, path: str, name: str, *, repeat: bool = False) -> Named:
    """Return what a name means in the size, or the ``repeat``, of the pass at a path.

    Raises ``KeyError`` for what it does not know.
    """
    prefix, spec = path.rpartition(".")[0], flat.specs[path]
    if name in CLOCKS:
        return Named(CLOCK, name=name)
    head, _, axis = name.rpartition(".")
    if axis in _AXES and head == "size":
        return Named(SIZE, base_of(inside(prefix, spec.name)), _AXES[axis])
    if axis in _AXES and head.endswith(".size"):
        return _sized(flat, prefix, head.removesuffix(".size"), _AXES[axis])
    try:
        target = resolve(flat.graphs[prefix], name)[0]
    except PlaygroundError:
        if name in COUNTERS:
            around = loops_around(flat.specs, path)
            around = around[:-1] if repeat else around
            return Named(COUNTER, around[-1] if around else "", name=name)
        if name != COMPUTE:
            raise KeyError(name) from None
        return Named(COMPUTE)
    return Named(VALUE, inside(prefix, target.path))


def _sized(flat: Flat, prefix: str, name: str, axis: int) -> Named:
    """Return the size of the picture that a parameter reads, of a pass, or of what feeds an input."""
    target = next(iter(find_targets(flat.graphs[prefix], name)), None)
    if target is not None and target.parameter.widget.kind == "file":
        return Named(PICTURE, inside(prefix, target.path), axis)
    path = inside(prefix, name)
    if path in flat.specs:
        return Named(SIZE, path, axis)
    source = flat.wires[prefix][name]
    if isinstance(source, Fed):
        return Named(FED, source.loop, axis, source.name)
    if source is None:  # what is read there is one texel
        return Named(UNWIRED)
    return Named(SIZE, source.path, axis)


def inside(prefix: str, name: str) -> str:
    """Return the path of what has a name in the technique at ``prefix``."""
    return f"{prefix}.{name}" if prefix else name


MAX_REPEAT = 1_000_000
_MAX_BOUND = 2**31 - 1  # of a repeat that ends by itself: what GLSL counts
_MAX_COUNTED = 1024  # iterations of a loop of which each may have its own sizes: each is planned
Size = tuple[int, int]
Names = Mapping[str, Number] | Callable[[str], Number]
"""The numbers of the names in an expression."""


class PassSizes:
    """The sizes and counts of one plan being made, and what they depend on."""

    def __init__(
        self,
        sketch: Sketch,
        flat: Flat,
        request: PlanRequest,
        terrain: Size,
        values: Mapping[str, Mapping[str, Value]],
        own: Mapping[str, Size],
    ) -> None:
        self.sketch = sketch
        self.flat = flat
        self.request = request
        self.values = values  # of each leaf, by its path
        self.own = own  # of sources that have a size by themselves, by the path of the leaf
        self.counting = counting(flat)
        self.lacking: dict[str, None] = {}  # techniques that lack compute shaders, by path
        self.named: set[str] = set()  # paths of the values that a size or a count names
        self.by_time = False  # one of them names the time
        self.pictures: dict[Path, Size] = {}  # files whose sizes one of them names
        self._bases = {TERRAIN: terrain, FRAME: request.frame_size}
        self._at: dict[str, int] = {}  # the iteration of each counting loop around what is worked out
        self._sizes: dict[tuple[object, ...], Size] = {}
        self._counts: dict[tuple[object, ...], int] = {}
        self._open: list[str] = []
        self._first: dict[Fed, Source | None] | None = None  # what a loop's first iteration reads

    def clocks(self) -> dict[str, Number]:
        """Return the numbers that follow the time."""
        return {"time": self.request.time, "frames": expressions.frames_at(self.request.time)}

    # ── iterations ───────────────────────────────────────────────────────────

    def iterations(self, loop: str) -> Iterator[None]:
        """Go through the iterations of a loop: sizes and counts are those of one after the other.

        There is one at least; of a loop whose iterations are all the same, only one.
        """
        if loop not in self.counting:
            yield
            return
        for number in range(max(self.count_of(loop), 1)):
            with self._in(self._at | {loop: number}):
                yield

    def sizes_of(self, path: str) -> Iterator[Size]:
        """Yield the sizes of a pass in every iteration of the loops around it."""

        def within(loops: tuple[str, ...]) -> Iterator[Size]:
            if not loops:
                yield self.size_of(path)
                return
            for _ in self.iterations(loops[0]):
                yield from within(loops[1:])

        yield from within(loops_around(self.flat.specs, path))

    @contextmanager
    def _in(self, at: dict[str, int]) -> Iterator[None]:
        before, self._at = self._at, at
        try:
            yield
        finally:
            self._at = before

    def _around(self, path: str, *, outside: bool = False) -> dict[str, int]:
        """Return the iterations of the counting loops around a pass: of now, else their last.

        ``outside``: without the pass itself.
        """
        counts: dict[str, int] = {}
        if not self.counting:
            return counts
        for loop in loops_around(self.flat.specs, path):
            if loop in self.counting and not (outside and loop == path):
                if loop in self._at:
                    counts[loop] = self._at[loop]
                else:
                    with self._in(counts):
                        counts[loop] = max(self.request.steps_of(loop, self.count_of(loop)) - 1, 0)
        return counts

    # ── counts ───────────────────────────────────────────────────────────────

    def count_of(self, loop: str) -> int:
        """Return the iterations in all of a loop; raise ``SketchError`` at a repeat that is wrong."""
        around = self._around(loop, outside=True)
        key = (loop, *around.values())
        if key not in self._counts:
            spec = self.flat.specs[loop]
            with self._in(around):
                count = counted(spec.repeat, spec.name, spec, partial(self._number, loop, repeat=True))
            if loop in self.counting and count > _MAX_COUNTED:
                why = "were expected where a size or a repeat inside names the iteration"
                message = f"repeat '{spec.repeat}' gives {count}; 0 to {_MAX_COUNTED} {why}"
                raise spec.error(f"pass '{spec.name}': {message}")
            self._counts[key] = count
        return self._counts[key]

    # ── sizes ────────────────────────────────────────────────────────────────

    def size_of(self, path: str) -> Size:
        """Return the size in texels of a pass at any level."""
        at = self._around(path)
        key = (path, *at.values())
        if key in self._sizes:
            return self._sizes[key]
        spec = self.flat.specs[path]
        if path in self._open:
            raise spec.error(f"the sizes of {' and '.join(self._open)} depend on each other")
        self._open.append(path)
        with self._in(at):
            size = self._size_around(base_of(path))
            if path in self.own:
                size = self.own[path]
                self._check_sides(spec, size)
            elif spec.size is not None:
                try:
                    names = partial(self._number, path)
                    size = (
                        expressions.evaluate(spec.size[0], names),
                        expressions.evaluate(spec.size[1], names),
                    )
                except ExpressionError as error:
                    raise spec.error(f"pass '{spec.name}': size {error}") from None
                self._check_sides(spec, size)
        self._open.pop()
        self._sizes[key] = size
        return size

    def size_of_source(self, source: Source) -> Size:
        """Return the size of what an input reads: of what is fed back, that of the iteration before."""
        if not isinstance(source, Fed):
            return self.size_of(source.path)
        output = dict(self.flat.specs[source.loop].feedback)[source.name]
        path = self.flat.outputs[source.loop][output].path
        at = self._around(source.loop)
        if not at.get(source.loop):
            first = self._read_first(source) if source.loop in at else None
            return self.size_of(path) if first is None else self.size_of_source(first)
        with self._in(at | {source.loop: at[source.loop] - 1}):
            return self.size_of(path)

    def _read_first(self, fed: Fed) -> Source | None:
        """Return what the first iteration reads where what a loop feeds back comes in."""
        if self._first is None:
            self._first = dict(first_sources(self.flat.nodes))
        return self._first[fed]

    def _check_sides(self, spec: PassSpec, size: Size) -> None:
        if not all(1 <= side <= MAX_SIDE for side in size):
            when = f" in iteration {[*self._at.values()][-1]}" if self._at else ""
            message = f"size {size[0]} x {size[1]}{when}; 1 to {MAX_SIDE} a side were expected"
            raise spec.error(f"pass '{spec.name}': {message}")

    def _size_around(self, base: str) -> Size:
        """Return the size of a pass, or of a base: ``TERRAIN`` or ``FRAME``."""
        return self._bases[base] if base in self._bases else self.size_of(base)

    # ── names ────────────────────────────────────────────────────────────────

    def _number(self, owner: str, name: str, *, repeat: bool = False) -> Number:
        """Return the number of a name in the size, or the ``repeat``, of the pass at a path.

        Raises ``KeyError`` for any other name.
        """
        kind, path, axis, what = named(self.flat, owner, name, repeat=repeat)
        prefix = owner.rpartition(".")[0]
        if kind == CLOCK:
            self.by_time = True
            return self.clocks()[what]
        if kind == COUNTER:
            return self._counter(what, path, inside=bool(prefix))
        if kind == SIZE:
            return self._size_around(path)[axis]
        if kind == FED:
            return self.size_of_source(Fed(path, what))[axis]
        if kind == PICTURE:
            return self._picture_size(path)[axis]
        if kind == UNWIRED:
            return 1
        if kind == COMPUTE:
            if "compute" not in self.request.variants:
                self.lacking[prefix] = None
                return 0
            return 1
        self.named.add(path)
        value = resolve(self.flat.graphs[prefix], name)[0].parameter.widget.uniform_value(
            self.flat.values[path]
        )
        if not isinstance(value, int | float):
            raise KeyError(name)
        return value

    def _counter(self, name: str, loop: str, *, inside: bool) -> int:
        """Return a loop's iteration, or its iterations in all, of which there is one at least.

        A technique that is ``inside`` no loop is in iteration 0 of 1, as its kernels are.
        """
        if not loop and not inside:
            where = "the size of a pass with a repeat and for the passes inside it"
            raise ExpressionError(f"names '{name}', which is for {where}")
        if name == ITERATION:
            return self._at[loop] if loop else 0
        return max(self.count_of(loop), 1) if loop else 1

    def _picture_size(self, path: str) -> Size:
        """Return the size of the picture that the parameter of a path reads."""
        self.named.add(path)
        leaf, _, parameter = path.rpartition(".")
        file = Path(str(self.values[leaf][parameter]))
        try:
            self.pictures[file] = picture_size(file)
        except DataError as error:
            raise error_at(error, self.sketch, self.flat.user(leaf)) from error
        return self.pictures[file]


def counted(text: str, name: str, owner: PassSpec | Kernel, names: Names) -> int:
    """Return how many iterations a repeat gives; ``owner`` is what says so, and where a mistake is."""
    try:
        count = expressions.evaluate(text, names)
    except ExpressionError as error:
        raise owner.error(f"pass '{name}': repeat {error}") from None
    ends = isinstance(owner, Kernel) and owner.ends_early
    limit = _MAX_BOUND if ends else MAX_REPEAT
    if not 0 <= count <= limit:
        raise owner.error(f"pass '{name}': repeat '{text}' gives {count}; 0 to {limit} were expected")
    return count


def first_sources(nodes: tuple[Node, ...]) -> Iterator[tuple[Fed, Source | None]]:
    """Yield what each loop feeds back, with what its first iteration reads in its place."""
    for node in nodes:
        if isinstance(node, Loop):
            yield from ((Fed(node.path, name), first) for name, first, _ in node.feedback)
            yield from first_sources(node.body)
