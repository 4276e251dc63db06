"""What flattening a sketch gives: passes and loops, wired and in order."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

from playground.errors import SketchError, nearest
from playground.shader.expressions import is_accepted, nearest_accepted
from playground.sketch.follows import Rule
from playground.sketch.model import CpuSource, Graph, Kernel, PassSpec, Value
from playground.sketch.variants import Omission


@dataclass(frozen=True, slots=True)
class Ref:
    """A texture: an output of a leaf pass."""

    path: str  # of the leaf, "height.sum"
    output: str

    def __str__(self) -> str:
        return f"{self.path}:{self.output}"


@dataclass(frozen=True, slots=True)
class Fed:
    """A texture that a loop feeds back: its own output of the step before."""

    loop: str  # path of the loop
    name: str  # of the fed input


Source = Ref | Fed


@dataclass(frozen=True)
class Leaf:
    """One kernel, draw or source to run."""

    path: str
    kernel: Kernel
    inputs: tuple[tuple[str, Source | None], ...]  # None: its fallback, or no initial state
    spec: PassSpec


@dataclass(frozen=True)
class Loop:
    """Passes that run over and over, some inputs fed by outputs of the step before."""

    path: str
    repeat: str
    body: tuple[Leaf | Loop, ...]
    feedback: tuple[tuple[str, Source | None, Ref], ...]  # input, what the first step reads, output
    spec: PassSpec


Node = Leaf | Loop


@dataclass(frozen=True)
class Flat:
    """A sketch without nesting."""

    shape: GraphShape  # the same before any value is set
    values: dict[str, Value]  # every leaf parameter, by path
    folder: str  # where files are looked for
    set_inside: tuple[str, ...]  # paths that are set over the sketch's file, of parameters inside techniques

    @property
    def nodes(self) -> tuple[Node, ...]:
        """Its passes and loops, in an order that wiring allows."""
        return self.shape.nodes

    @property
    def specs(self) -> dict[str, PassSpec]:
        """Every pass at every level, by path."""
        return self.shape.specs

    @property
    def graphs(self) -> dict[str, Graph]:
        """Every technique of several passes, by path; "" is the sketch."""
        return self.shape.graphs

    @property
    def outputs(self) -> dict[str, dict[str, Ref]]:
        """Every pass at every level: its outputs."""
        return self.shape.outputs

    @property
    def wires(self) -> dict[str, dict[str, Source | None]]:
        """Every technique of several passes: what feeds its inputs."""
        return self.shape.wires

    def values_of(self, leaf: Leaf) -> dict[str, Value]:
        """Return the values of a leaf's parameters, by name."""
        return {name: self.values[path] for name, path in self.shape.paths[leaf.path]}

    def has_values_of(self, before: Flat, leaf: Leaf) -> bool:
        """Return whether a leaf has the very values that it has in another one of the same shape."""
        return all([self.values[path] is before.values[path] for _, path in self.shape.paths[leaf.path]])

    @property
    def leaves(self) -> list[Leaf]:
        """Every leaf, those inside loops included."""
        return self.shape.leaves

    @cached_property
    def sources(self) -> list[Leaf]:
        """Every leaf that is a source."""
        return [leaf for leaf in self.leaves if isinstance(leaf.kernel, CpuSource)]

    @cached_property
    def with_files(self) -> list[Leaf]:
        """Every leaf with parameters that name files."""
        return [leaf for leaf in self.leaves if leaf.kernel.file_parameters]

    @cached_property
    def _accepts(self) -> list[str]:
        """Which sizes of terrain kernels take, those of the view left out."""
        own = [leaf for leaf in self.leaves if leaf.kernel.accepts and leaf.spec.size is None]
        return [leaf.kernel.accepts for leaf in own if leaf.path.partition(".")[0] != "view"]

    def accepted(self, size: tuple[int, int]) -> tuple[int, int]:
        """Return the size of terrain, or the next larger one, that every kernel of the terrain accepts."""
        for accepts in self._accepts:
            if not is_accepted(accepts, size):
                size = nearest_accepted(accepts, size)[-1]
        return size

    def user(self, path: str) -> PassSpec:
        """Return the sketch's own pass that a pass at any level belongs to."""
        return self.specs[path.partition(".")[0]]

    def ref(self, text: str, sketch: str) -> Ref:
        """Return the texture that ``pass[.inner…][:output]`` names; raise ``SketchError``."""
        path, _, output = text.partition(":")
        if path not in self.outputs:
            raise SketchError(f"no pass '{path}' in sketch {sketch}{nearest(path, self.outputs)}")
        refs = self.outputs[path]
        if not output:
            return refs.get(path.rpartition(".")[2], next(iter(refs.values())))
        if output not in refs:
            raise SketchError(f"pass '{path}' has no output '{output}'{nearest(output, refs)}")
        return refs[output]


@dataclass(frozen=True)
class GraphShape:
    """A flat graph before any value is set."""

    nodes: tuple[Node, ...]
    specs: dict[str, PassSpec]
    graphs: dict[str, Graph]
    outputs: dict[str, dict[str, Ref]]
    wires: dict[str, dict[str, Source | None]]
    paths: dict[str, tuple[tuple[str, str], ...]]  # leaf → its parameters, and where their values are
    rules: tuple[Rule, ...]  # of parameters that follow others until they are set
    written: tuple[Node, ...]  # its nodes before what changes from frame to frame was moved into loops
    # Of fast variants' own passes: values that no export reaches, by path, and paths of the techniques'
    # values that others have as well.
    constants: dict[str, Value] = field(default_factory=dict)
    copied: dict[str, str] = field(default_factory=dict)
    omitted: tuple[Omission, ...] = ()
    # Of techniques with a fast variant that draws, each parameter that it lacks: the technique's path, that
    # of the value inside it, its default.
    lacking: tuple[tuple[str, str, Value], ...] = ()
    targets: dict[str, tuple[str, ...]] = field(default_factory=dict)  # of each override so far

    @cached_property
    def leaves(self) -> list[Leaf]:
        """Every leaf, those inside loops included."""
        return leaves_of(self.nodes)


def leaves_of(nodes: tuple[Node, ...] | list[Node]) -> list[Leaf]:
    """Return every leaf, those inside loops included."""
    leaves: list[Leaf] = []
    for node in nodes:
        if isinstance(node, Loop):
            leaves += leaves_of(node.body)
        else:
            leaves.append(node)
    return leaves


def repeated_paths(nodes: tuple[Node, ...]) -> list[str]:
    """Return the paths of the passes that repeat, those inside loops included."""
    kernels = {leaf.path for leaf in leaves_of(nodes) if leaf.kernel.repeat != "1"}
    return sorted(kernels | _loops_of(nodes))


def repeated_path(path: str, nodes: tuple[Node, ...]) -> str | None:
    """Return the pass that repeats at a path: the pass itself, or the only one inside it."""
    valid = repeated_paths(nodes)
    if path in valid:
        return path
    inside = [name for name in valid if name.startswith(f"{path}.")]
    return inside[0] if len(inside) == 1 else None


def _loops_of(nodes: tuple[Node, ...]) -> set[str]:
    loops = [node for node in nodes if isinstance(node, Loop)]
    return {loop.path for loop in loops}.union(*(_loops_of(loop.body) for loop in loops))
