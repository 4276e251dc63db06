"""Work out what each pass's textures depend on, before anything runs.

A pass is stale when its key changes. The key holds its text without comments, the values
and given names that the text uses, its size and count of iterations, its driver, its files by
their contents, and the keys of what it reads. Inside a loop, what is fed back has a name
in place of a key: a loop's key is the same at every iteration, so a loop can go on from the
iteration that is cached. Likewise the time, the mouse and all else that belongs to a frame are in no key
where a loop counts frames: they are those of its iterations.

Of a plan with the passes of the last one, keys are computed again for those nodes only that are others, that
are given something else or read another file, and for what reads a node whose key has changed.
"""

from __future__ import annotations

import hashlib
import re
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from heapq import heappop, heappush
from operator import attrgetter
from pathlib import Path
from typing import Any, NamedTuple

from playground.data.content_hash import content_hash
from playground.engine.meshes import mesh_parameters
from playground.engine.plan import LoopStep, Plan, PlanNode, Step, every_version, sources_of, walk
from playground.engine.source_kinds import Terrain
from playground.memo import GRAPHS
from playground.shader.expressions import counts_frames
from playground.shader.kernel import VertexShader
from playground.shader.reserved_names import CLOCKED, GIVEN, MATCHES, PRESSED, TOWARDS
from playground.shader.sampler_reads import read_by_texels_alone
from playground.sketch.flat import Fed, GraphShape, Ref, Source
from playground.sketch.model import ComputeVariant, CpuSource, Draw, ForeignShader, Kernel, TexelKernel

_IDENTIFIER = re.compile(r"[A-Za-z_]\w*")
_FIXED = frozenset(GIVEN) - {"time", "clip_from_world", "world_from_clip", "eye"}
"""Given names that the same passes of the same terrain are given in every frame."""


@dataclass(frozen=True, slots=True)
class StepKey:
    """What a step's textures depend on: hashes, and what went into them by name."""

    result: str  # of the textures that others read
    computed: str  # the same of what it has, where more is shown
    unfinished: str  # the same after any number of iterations
    # The same without the inputs of which single texels are read and nothing else; "" where there are none.
    by_texels: str
    parts: tuple[tuple[str, object], ...] = field(compare=False, repr=False)

    def difference(self, other: StepKey) -> tuple[str, ...]:
        """Return the names of what differs: why the step runs again after the other.

        They are "text", "driver", "size", "window", "repeat", "iterations", "continued", a value or a file by
        the name of its parameter ("value amplitude"), "given time" and the like, "input height" where what
        that reads is another: ask its step why.
        """
        ours, theirs = ({name: repr(part) for name, part in key.parts} for key in (self, other))
        names = [name for name in {**theirs, **ours} if ours.get(name) != theirs.get(name)]
        return tuple(names or (("iterations of its loop",) if self.result != other.result else ()))


@dataclass
class Keys:
    """The keys of one plan."""

    steps: dict[str, StepKey] = field(default_factory=dict)  # by the step's path
    loops: dict[str, str] = field(default_factory=dict)  # by the loop's path
    # The paths of the loops around a node whose iterations change it, by the node's identity.
    changes: dict[int, frozenset[str]] = field(default_factory=dict)

    def result(self, path: str) -> str:
        """Return the key of the textures that others read of a step, or of its last iteration in a loop."""
        return self.steps[path].result

    def computed(self, path: str) -> str:
        """Return the key of what a step has computed itself; "" where there is no such step."""
        key = self.steps.get(path)
        return key.computed if key is not None else ""

    def copy(self) -> Keys:
        """Return the same keys, to be changed."""
        return Keys(*(getattr(self, name).copy() for name in self.__dataclass_fields__))


class KeyMaker:
    """Makes the keys of plans; remembers what kernels' texts say.

    ``text`` gives what counts of a kernel's text, ``content`` what tells a file's contents from others.
    """

    def __init__(
        self,
        text: Callable[[Kernel], str] = attrgetter("source.canonical"),
        content: Callable[[Path], str] = content_hash,
    ) -> None:
        self._text = text
        self._content = content
        self._last: _PlanKeys | None = None  # of the last plan

    def keys_of(
        self, plan: Plan, driver: Callable[[Step], str], uniforms_of: Callable[[Step], Mapping[str, Any]]
    ) -> Keys:
        """Return the keys of a plan; they are not to be changed.

        ``driver`` chooses how a step runs, always the same; ``uniforms_of`` returns what the engine gives it
        besides its parameters: of a kernel, what its text names, and which of its buttons are pressed.
        """
        last = self._last
        keys = last.copy() if last is not None and last.is_like(plan) else _PlanKeys(plan)
        computation = KeyComputation(self.text_of, self._content, driver, uniforms_of, keys)
        waiting = keys.possibly_stale(plan.nodes)  # places of nodes, the first on top
        queued, stale = set(waiting), set[int]()
        while waiting:
            index = heappop(waiting)
            before = keys.parts[index]
            if before is None or index in stale or computation.differs(before, plan.nodes[index]):
                part = computation.part(plan.nodes[index], before)
                keys.put(index, part)
                if before is None or part.shown != before.shown:
                    for reader in keys.readers[index]:
                        stale.add(reader)
                        if reader not in queued:
                            queued.add(reader)
                            heappush(waiting, reader)
        self._last = keys
        return keys.keys

    def text_of(self, kernel: Kernel) -> _Text:
        """Return what a kernel's text says, worked out once: texts are long, and kernels seldom change."""
        return _read_text(kernel, self._text)


@dataclass(frozen=True)
class _Text:
    """What a kernel's text says of staleness."""

    digest: str
    used: frozenset[str]  # names in the text besides their declaration, or in its header
    needs_check: bool  # the same plan of the same terrain may give it something else in the next frame
    by_texels: frozenset[str]  # inputs of which a kernel that runs once reads single texels and nothing else


@GRAPHS.cached(identities=1)
def _read_text(kernel: Kernel, text_of: Callable[[Kernel], str]) -> _Text:
    header: list[Any] = [kernel.kind, kernel.outputs]
    header += [(row.name, value) for row, value in kernel.options if row.keyed]
    header += [(i.name, i.sampling, i.fallback, i.shape) for i in kernel.inputs]
    used = {n for n, times in Counter(_IDENTIFIER.findall(kernel.source.code)).items() if times > 1}
    used |= kernel.names_in_options
    used |= kernel.source.names & {"iterations"}
    used |= {p.name for p in kernel.parameters if kernel.reads(f"{TOWARDS}{p.name}")}
    match kernel:
        case ForeignShader():  # what its tool declares is not in its text
            header += [kernel.prelude, kernel.epilogue, kernel.helpers, kernel.usual]
            header += _vertex(kernel.vertex)
            used |= {p.name for p in kernel.parameters if kernel.reads(p.name)}
        case CpuSource():
            used |= {p.name for p in kernel.parameters}
        case Draw():
            used |= set(mesh_parameters(kernel.mesh))
    needs_check = (
        not isinstance(kernel, TexelKernel | ComputeVariant)
        or bool(kernel.file_parameters)
        or not _FIXED.issuperset(kernel.engine_uniforms)
        or any(parameter.widget.kind == "button" for parameter in kernel.parameters)
    )
    by_texels = frozenset[str]()
    if isinstance(kernel, TexelKernel) and kernel.repeat == "1":
        by_texels = read_by_texels_alone(kernel.source)
        by_texels -= {name for name in by_texels if kernel.reads(f"{MATCHES}{name}")}
    return _Text(_digest([header, text_of(kernel)]), frozenset(used), needs_check, by_texels)


def _vertex(vertex: VertexShader | tuple[tuple[str, str], ...]) -> list[Any]:
    if isinstance(vertex, VertexShader):
        return [vertex.prelude, vertex.helpers, vertex.source.canonical]
    return [vertex]


class _Loops(NamedTuple):
    """The loops around a node, by their paths; "" for none."""

    innermost: str
    frames: str  # the innermost that counts frames


_NO_LOOP = _Loops("", "")


class _Reads(NamedTuple):
    """What a step's textures depend on besides the step itself."""

    driver: str
    files: list[str]  # contents
    sources: list[tuple[str, str]]  # input → key of what it reads
    uniforms: Mapping[str, Any]
    is_continued: bool  # by a later draw
    clocked: frozenset[str]  # what is in no key, since it is that of the frame that a loop is at


class _CachedKey(NamedTuple):
    """The key of a step in one plan; in the next it is the same if the step and what it reads are."""

    step: Step
    reads: str
    key: StepKey


class _NodeKeys(NamedTuple):
    """A node of a plan whose keys are known, with what is inside it."""

    node: PlanNode
    steps: Mapping[int, _CachedKey]  # by the step's identity
    moving: tuple[Step, ...]  # steps that the same plan may give something else in the next frame
    uniforms: str  # what they were given
    shown: list[tuple[str, frozenset[str]]]  # what the nodes that read it see of it: see ``KeyComputation``


class _PlanKeys:
    """The keys of one plan, and what is needed to compute those of the next one from them."""

    def __init__(self, plan: Plan) -> None:
        self.shape: GraphShape = plan.flat.shape
        self.terrain: Terrain = plan.terrain
        self.continued = plan.continued
        self.keys = Keys()
        self.varies: dict[str, frozenset[str]] = {}  # loops that a step changes with, for its next reader
        self.parts: list[_NodeKeys | None] = [None] * len(plan.nodes)
        self.moving: set[int] = set()  # places of the nodes with moving steps
        self.readers = _readers(plan.nodes)  # places of the nodes that read each node

    def is_like(self, plan: Plan) -> bool:
        """Return whether a plan has the same passes, wired so, of the same terrain."""
        return self.shape is plan.flat.shape and self.terrain == plan.terrain

    def copy(self) -> _PlanKeys:
        """Return the same, to be changed."""
        copied = copy(self)
        copied.keys, copied.varies = self.keys.copy(), self.varies.copy()
        copied.parts, copied.moving = self.parts.copy(), self.moving.copy()
        return copied

    def possibly_stale(self, nodes: Sequence[PlanNode]) -> list[int]:
        """Return the places of nodes whose keys may be others now, ascending."""
        pairs = enumerate(zip(nodes, self.parts, strict=True))
        others = {index for index, (node, part) in pairs if part is None or part.node is not node}
        return sorted(others | self.moving)

    def put(self, index: int, part: _NodeKeys) -> None:
        """Set the keys of the node at a place."""
        self.parts[index] = part
        if part.moving:
            self.moving.add(index)
        else:
            self.moving.discard(index)


def _inside(node: PlanNode) -> list[PlanNode]:
    """Return a step, or a loop and what it runs in all of its iterations."""
    return [node] if isinstance(node, Step) else every_version((node,))


def _readers(nodes: Sequence[PlanNode]) -> list[frozenset[int]]:
    """Return the places of the nodes that read each node, by its place."""
    home = {step.path: index for index, node in enumerate(nodes) for step in walk((node,))}
    readers: list[set[int]] = [set() for _ in nodes]
    for index, node in enumerate(nodes):
        for source in sources_of(node):
            if isinstance(source, Ref) and home[source.path] != index:
                readers[home[source.path]].add(index)
    return [frozenset(places) for places in readers]


class KeyComputation:
    """Computes keys of nodes of one plan, into ``keys``."""

    def __init__(
        self,
        text_of: Callable[[Kernel], _Text],
        content: Callable[[Path], str],
        driver: Callable[[Step], str],
        uniforms_of: Callable[[Step], Mapping[str, Any]],
        keys: _PlanKeys,
    ) -> None:
        self.keys = keys.keys
        self.varies = keys.varies
        self.continued = keys.continued
        self.before: Mapping[int, _CachedKey] = {}
        self.step_keys: dict[int, _CachedKey] = {}
        self.sized: dict[tuple[str, bool], frozenset[str]] = {}  # see ``_note_sized``
        self.text_of = text_of
        self.content = content
        self.driver = driver
        self.uniforms_of = uniforms_of

    def differs(self, part: _NodeKeys, node: PlanNode) -> bool:
        """Return whether a node is another than it was, or its moving steps are given something else."""
        return part.node is not node or (bool(part.moving) and part.uniforms != self._given_to(part.moving))

    def part(self, node: PlanNode, before: _NodeKeys | None) -> _NodeKeys:
        """Compute the keys of a node and of what is inside it; ``before``: those of the last plan."""
        self.before, self.step_keys = before.steps if before else {}, {}
        if before is not None:
            for old in _inside(before.node):
                self.keys.changes.pop(id(old), None)
        self.add(node, _NO_LOOP, {}, {})
        steps = [step for step in _inside(node) if isinstance(step, Step)]
        moving = tuple([step for step in steps if self.text_of(step.kernel).needs_check])
        shown = [(self.keys.steps[step.path].result, self.varies[step.path]) for step in steps]
        return _NodeKeys(node, self.step_keys, moving, self._given_to(moving) if moving else "", shown)

    def _given_to(self, steps: Sequence[Step]) -> str:
        return repr([(self._files_of(step), self.uniforms_of(step)) for step in steps])

    def _files_of(self, step: Step) -> list[str]:
        """Return what tells the contents of a step's files from others."""
        named = step.kernel.file_parameters
        return [self.content(Path(str(step.values[p.name]))) for p in named] if named else []

    def add(
        self, node: PlanNode, loops: _Loops, fed: Mapping[Fed, str], varying: Mapping[Fed, frozenset[str]]
    ) -> None:
        """Add a node with the ``loops`` around it; ``fed`` names what they feed back."""
        if isinstance(node, LoopStep):
            self._loop(node, loops, fed, varying)
            return
        kernel, path = node.kernel, node.path
        sources = [(name, self._source(source, fed) if source else "") for name, source in node.inputs]
        files = self._files_of(node)
        uniforms, clocked = self.uniforms_of(node), frozenset[str]()
        if loops.frames or counts_frames(kernel.repeat):
            clocked = _clocked(node, uniforms)
            uniforms = {name: value for name, value in uniforms.items() if name not in clocked}
        reads = _Reads(self.driver(node), files, sources, uniforms, path in self.continued, clocked)
        cached, written = self.before.get(id(node)), repr(reads)
        if cached is None or cached.step is not node or cached.reads != written:
            cached = _CachedKey(node, written, self._key_of(node, reads))
        self.step_keys[id(node)] = cached
        self.keys.steps[path] = cached.key
        varies = self.sized.get((path, False), frozenset[str]())
        for _, source in node.inputs:
            varies |= self._varies(source, varying) if source else varies
        if loops.innermost and kernel.repeat == "1" and kernel.reads("iteration"):
            varies |= {loops.innermost}
        if loops.frames and clocked and not counts_frames(kernel.repeat):
            varies |= {loops.frames}
        self.varies[path] = self.keys.changes[id(node)] = varies

    def _key_of(self, step: Step, reads: _Reads) -> StepKey:
        """Return the key of a step that reads so."""
        kernel, text = step.kernel, self.text_of(step.kernel)
        own: list[tuple[str, Any]] = [("text", text.digest), ("driver", reads.driver)]
        own += [("size", step.size), ("window", step.window)]
        contents = iter(reads.files)
        for parameter in kernel.parameters:
            name, value = parameter.name, step.values[parameter.name]
            if parameter.widget.kind == "file":
                suffix = Path(str(value)).suffix
                own.append((f"file {name}", (name, parameter.sampling, suffix, next(contents))))
            elif name in text.used and name not in reads.clocked:
                own.append((f"value {name}", (name, value)))
        more: list[tuple[str, Any]] = [(f"given {pair[0]}", pair) for pair in reads.uniforms.items()]
        if "iterations" in text.used:
            more.append(("iterations", step.total))
        if reads.is_continued:
            more.append(("continued", "continued"))
        parts, rest = [part for _, part in own], [part for _, part in more]
        by_texels = ""
        if text.by_texels:
            others = [(name, bool(key) if name in text.by_texels else key) for name, key in reads.sources]
            by_texels = _digest([step.repeat, parts, others, rest])
        parts += [*reads.sources, *rest]
        computed = result = _digest([step.repeat, parts])
        if step.between is not None:
            result = _digest([computed, *step.between])
        sources = [(f"input {pair[0]}", pair) for pair in reads.sources]
        named = (*own, *sources, *more, ("repeat", step.repeat), ("between", step.between))
        return StepKey(result, computed, _digest([step.path, parts]), by_texels, named)

    def _loop(
        self,
        loop: LoopStep,
        loops: _Loops,
        fed: Mapping[Fed, str],
        varying: Mapping[Fed, frozenset[str]],
    ) -> None:
        inside = sorted({step.path for step in walk(loop.body)})
        own = _loops_in(loop)
        sized = self.sized.get((loop.path, True), frozenset())
        outer = sized
        for source in sources_of(loop):
            within = source.loop in own if isinstance(source, Fed) else source.path in inside
            if not within:
                outer |= self._varies(source, varying)
        names, changes = dict(fed), dict(varying)
        for name, _, _ in loop.feedback:
            names[Fed(loop.path, name)] = f"fed back: {loop.path} {name}"
            changes[Fed(loop.path, name)] = outer | {loop.path}
        around = _Loops(loop.path, loop.path if loop.counts_frames else loops.frames)
        self._note_sized(loop)
        inner_keys: dict[int, list[str]] = {}  # the keys of the steps inside, by the identity of the body
        for body in (*loop.bodies, loop.body):
            if id(body) not in inner_keys or body is loop.body:
                for node in body:
                    self.add(node, around, names, changes)
                inner_keys[id(body)] = [self.keys.steps[path].result for path in inside]
        parts: list[Any] = [loop.path, *inner_keys[id(loop.body)]]
        if len(loop.bodies) > 1:
            parts = [loop.path, *(inner_keys[id(body)] for body in loop.bodies)]
        parts += [(name, self._source(first, fed), str(ref)) for name, first, ref in loop.feedback]
        if any("iterations" in self.text_of(step.kernel).used for step in walk(loop.body)):
            parts.append(loop.total)
        key = self.keys.loops[loop.path] = _digest(parts)
        self.keys.changes[id(loop)] = outer
        for path in inside:
            if loop.path in self.varies[path]:  # what reads it from here on sees the last iteration
                last = _digest([key, path, loop.repeat])
                self.keys.steps[path] = replace(self.keys.steps[path], result=last)
                self.varies[path] = (self.varies[path] - {loop.path}) | sized

    def _note_sized(self, loop: LoopStep) -> None:
        """Note what a loop's iterations have in sizes or counts of their own: by path, and whether a loop."""
        if len(loop.bodies) == 1:
            return
        versions: dict[tuple[str, bool], set[tuple[int, ...]]] = {}
        for body in {id(body): body for body in loop.bodies}.values():
            now: dict[tuple[str, bool], tuple[int, ...]] = {}
            for node in every_version(body):
                key = node.path, isinstance(node, LoopStep)
                now[key] = (*now.get(key, ()), id(node))
            for key, nodes in now.items():
                versions.setdefault(key, set()).add(nodes)
        for key, several in versions.items():
            if len(several) > 1:
                self.sized[key] = self.sized.get(key, frozenset()) | {loop.path}

    def _varies(self, source: Source | None, varying: Mapping[Fed, frozenset[str]]) -> frozenset[str]:
        if source is None:
            return frozenset()
        return varying[source] if isinstance(source, Fed) else self.varies[source.path]

    def _source(self, source: Source | None, fed: Mapping[Fed, str]) -> str:
        if source is None:
            return ""
        return fed[source] if isinstance(source, Fed) else f"{self.keys.result(source.path)}:{source.output}"


def _clocked(step: Step, uniforms: Mapping[str, Any]) -> frozenset[str]:
    """Return what a step reads that belongs to one frame: given names, and buttons among its parameters."""
    buttons = [p.name for p in step.kernel.parameters if p.widget.kind == "button"]
    return (CLOCKED & uniforms.keys()) | frozenset([*buttons, *(f"{PRESSED}{name}" for name in buttons)])


def _loops_in(loop: LoopStep) -> set[str]:
    loops = {loop.path}
    for node in loop.body:
        if isinstance(node, LoopStep):
            loops |= _loops_in(node)
    return loops


def _digest(parts: object) -> str:
    return hashlib.blake2b(repr(parts).encode(), digest_size=16).hexdigest()
