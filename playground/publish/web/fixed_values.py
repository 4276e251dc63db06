"""Say what cannot be changed in a page, and why: what the processor makes is exported as it is.

A source's texels depend on its own parameters and on its size; whatever that size depends on is locked
with them. Where a fast variant runs in place of a technique, its inner parameters that it does not
have are locked as well: setting them would need another plan.
"""

from __future__ import annotations

from collections.abc import Iterator

from playground.engine import sizes
from playground.engine.plan import Plan
from playground.engine.sizes import FRAME, TERRAIN, base_of, counting, named
from playground.engine.sources import source_kind
from playground.shader.expressions import names_in
from playground.sketch.flat import Fed, Leaf, Loop, Ref, Source
from playground.sketch.flatten import is_exported
from playground.sketch.model import CpuSource, Graph
from playground.sketch.variants import INSIDE, canonical_path

_METRES = {
    "extent": ("extent", "spacing"),
    "relief": ("relief",),
    "base_elevation": ("base_elevation",),
}
"""What a terrain says in metres → the given names of a kernel that depend on it."""


class FixedValues:
    """Those of one planned sketch, each with the reason."""

    def __init__(self, plan: Plan) -> None:
        self.plan = plan
        self.flat = plan.flat
        self.sources = {leaf.path: leaf for leaf in self.flat.leaves if isinstance(leaf.kernel, CpuSource)}
        self._needed_by: dict[str, str] = {}  # path of a value, or a base → the source whose size it sets
        self._read_by = self._readers()  # path of a leaf → the source that was made of it
        for path in self._read_by:
            self._note(path, self._read_by[path], set())
        for path in self.sources:
            if path not in plan.basis.own:
                self._note(path, path, set())
        self._replaced = {canonical_path(path) for path in self.flat.specs if f".{INSIDE}." in f"{path}."}

    def of_parameter(self, path: str, targets: tuple[str, ...]) -> str:
        """Return why a parameter cannot be changed, a message; "": it can."""
        for target in targets:
            leaf, _, name = target.rpartition(".")
            if leaf in self.sources and not self._plays_by(leaf, name):
                return _sentence(f"{made_by(self.sources[leaf])} was made when the page was exported")
            if leaf in self._read_by:
                return self._made_of(leaf)
            if target in self._needed_by:
                made = made_by(self.sources[self._needed_by[target]])
                return _sentence(f"{made} was made in this size when the page was exported")
            kernel = next((item.kernel for item in self.flat.leaves if item.path == leaf), None)
            parameter = kernel.parameter(name) if kernel else None
            if parameter is not None and parameter.widget.kind == "file":
                return "The image was chosen when the page was exported."
        return self._replaced_around(path)

    def of_steps(self, path: str) -> str:
        """Return why a repeated pass cannot be stopped early, a message; "": it can, or is not repeated."""
        spec = self.flat.specs[path]
        leaf = next((leaf for leaf in self.flat.leaves if leaf.path == path), None)
        if not spec.repeat and (leaf is None or leaf.kernel.repeat == "1"):
            return ""
        for read in self._read_by:
            if f"{read}.".startswith(f"{path}."):
                return self._made_of(read)
        return ""

    def of_terrain(self) -> str:
        """Return why the terrain's size cannot be changed; "": it can."""
        if TERRAIN not in self._needed_by:
            return ""
        made = made_by(self.sources[self._needed_by[TERRAIN]])
        return _sentence(f"{made} was made in this size when the page was exported")

    def of_metres(self) -> dict[str, str]:
        """Return why the terrain's metres cannot be changed, of those by name that cannot."""
        leaves = {leaf.path: leaf for leaf in self.flat.leaves}
        reasons: dict[str, str] = {}
        for path, source in {**{path: path for path in self.sources}, **self._read_by}.items():
            kernel = leaves[path].kernel
            for name, names in _METRES.items():
                if any(map(kernel.reads, names)):
                    made = made_by(self.sources[source])
                    reasons[name] = _sentence(f"{made} was made by this when the page was exported")
        return reasons

    def notes(self) -> list[str]:
        """Return a message on each source that a page has as it was at export: its size, its moment."""
        notes = []
        if FRAME in self._needed_by:
            path = self._needed_by[FRAME]
            notes.append(f"{path}: {made_by(self.sources[path])} has the size of the picture at export")
        for leaf in self.flat.leaves:
            if leaf.path in self._read_by and leaf.kernel.reads("time"):
                made = made_by(self.sources[self._read_by[leaf.path]])
                moment = f"at {self.plan.time:g} s, so that it does not move in a page"
                notes.append(f"{leaf.path}: {made} was made of this {moment}")
        return notes

    def _readers(self) -> dict[str, str]:
        """Return the leaves that the inputs of sources read, however far behind."""
        leaves = {leaf.path: leaf for leaf in self.flat.leaves}
        loops = {name: (first, ref) for name, first, ref in self._fed()}
        readers: dict[str, str] = {}

        def note(read: Source | None, source: str, seen: set[Fed]) -> None:
            if isinstance(read, Fed):
                if read not in seen:
                    seen.add(read)
                    for each in loops[read]:
                        note(each, source, seen)
            elif read is not None and read.path not in readers:
                readers[read.path] = source
                for _, each in leaves[read.path].inputs:
                    note(each, source, seen)

        for path, leaf in self.sources.items():
            for _, each in leaf.inputs:
                note(each, path, set())
        return readers

    def _fed(self) -> Iterator[tuple[Fed, Source | None, Ref]]:
        """Yield what each loop feeds back: what its first iteration reads, and what the next ones do."""
        waiting = list(self.flat.nodes)
        while waiting:
            node = waiting.pop()
            if isinstance(node, Loop):
                waiting += node.body
                yield from ((Fed(node.path, name), first, ref) for name, first, ref in node.feedback)

    def _made_of(self, path: str) -> str:
        """Return the sentence on a leaf that a source reads."""
        made = made_by(self.sources[self._read_by[path]])
        return _sentence(f"{made} was made of this when the page was exported")

    def _plays_by(self, path: str, parameter: str) -> bool:
        """Return whether a parameter of a source says which second of a file shows: that a page works out."""
        recording = source_kind(self.sources[path].kernel.registry).recording
        return recording is not None and parameter in recording.clock.values()

    def _replaced_around(self, path: str) -> str:
        """Return why an inner parameter of a technique that a fast variant replaces cannot be set."""
        if path.count(".") < 2:
            return ""
        for around in self._replaced:
            rest = path.removeprefix(f"{around}.")
            technique = self.flat.specs[around].technique
            if rest != path and isinstance(technique, Graph) and not is_exported(technique, rest):
                return f"A faster form of {around} runs in this page, which does not have it."
        return ""

    def _note(self, path: str, source: str, seen: set[str]) -> None:
        """Note the values and bases that the size of a pass depends on, for a source."""
        if path in seen:
            return
        seen.add(path)
        if path in (TERRAIN, FRAME):
            self._needed_by.setdefault(path, source)
            return
        spec = self.flat.specs[path]
        if spec.size is None:
            self._note(base_of(path), source, seen)
            return
        for text in spec.size:
            self._note_names(path, text, source, seen)

    def _note_names(self, path: str, text: str, source: str, seen: set[str], *, repeat: bool = False) -> None:
        """Note what an expression of the pass at a path depends on: its size, or its ``repeat``."""
        for word in sorted(names_in(text)):
            kind, where, _, _ = named(self.flat, path, word, repeat=repeat)
            if kind == sizes.SIZE:
                self._note(where, source, seen)
            elif kind == sizes.VALUE:
                self._needed_by.setdefault(self.flat.shape.copied.get(where, where), source)
            elif where in counting(self.flat) and kind in (sizes.COUNTER, sizes.FED):
                message = (
                    f"pass '{source}' has a size for each iteration of '{where}', and a page has one of it"
                )
                raise self.flat.user(source).error(message)
            elif kind == sizes.COUNTER and where:
                self._note_names(where, self.flat.specs[where].repeat, source, seen, repeat=True)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}."


def made_by(leaf: Leaf) -> str:
    """Return what a source makes, as text."""
    return source_kind(leaf.kernel.registry).makes
