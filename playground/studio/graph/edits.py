"""Edits of the passes in the window: each is written into the sketch's file, and is one step of undo."""

from __future__ import annotations

import time
from collections.abc import Callable, Container, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from playground.errors import PlaygroundError
from playground.sketch import edit_passes
from playground.sketch.edit_passes import PassEdit, components_of, passed_on, put_on_wire, save_passes
from playground.sketch.find import is_part, shipped_names
from playground.sketch.model import Kernel, PassSpec, Sketch, Technique
from playground.sketch.replace_technique import own_names, reader_of
from playground.sketch.wiring import input_names, output_names
from playground.studio.edits.edits import Draft
from playground.studio.edits.undo import Undo
from playground.studio.language import labels_of, tr
from playground.studio.notices import Notices
from playground.studio.session import Session


class PassEdits:
    """Edits the passes of one session's sketch."""

    def __init__(self, session: Session, notices: Notices, undo: Undo) -> None:
        self.session, self.notices, self.undo = session, notices, undo
        self._asked: tuple[object, object, str] = (None, (), "")  # of which file, about what; the answer

    @property
    def draft(self) -> Draft | None:
        """What the file says, shown or still being checked."""
        drafts = self.session.drafts
        return drafts.shown if drafts.opening or drafts.coming is None else drafts.coming

    def add(
        self,
        use: str,
        after: str = "",
        output: str = "",
        *,
        between: bool = True,
        on: tuple[str, str] | None = None,
    ) -> str:
        """Add a pass behind another, on a wire, or before the view; return its name, "" where it cannot be.

        ``on``: the reader and the input of that wire.
        """

        def add(file: Sketch) -> PassEdit:
            return edit_passes.added(file, use, after, output, between=between, on=on)

        return self._write(tr("Add {name}", name=use.rpartition("/")[2]), add)

    def put(self, name: str, reader: str, input_name: str) -> bool:
        """Put a pass on the wire to an input; return whether that worked."""
        label = tr("Put {name} before {reader}", name=name, reader=reader)
        return bool(self._write(label, lambda file: put_on_wire(file, name, reader, input_name)))

    def why_not(self, name: str, reader: str, input_name: str) -> str:
        """Return why a pass cannot be put on the wire to an input; "" where it can."""
        draft = self.draft
        if draft is None:
            return ""
        asked = name, reader, input_name
        if self._asked[0] is not draft.file or self._asked[1] != asked:
            self._asked = draft.file, asked, ""
            try:
                put_on_wire(draft.file, *asked)
            except PlaygroundError as error:
                self._asked = draft.file, asked, error.diagnostics[0].message
        return self._asked[2]

    def wire(self, giver: str, output: str, reader: str, name: str) -> bool:
        """Feed an input of a pass from an output of another; return whether that worked."""
        label = tr("Wire {giver} to {reader}", giver=giver, reader=reader)
        return bool(self._write(label, lambda file: edit_passes.wired(file, giver, output, reader, name)))

    def unwire(self, reader: str, name: str) -> bool:
        """Take away the wire to an input; return whether that worked."""
        label = tr("Take the wire to {reader} away", reader=reader)
        return bool(self._write(label, lambda file: edit_passes.unwired(file, reader, name)))

    def delete(self, name: str) -> bool:
        """Delete a pass; what it was made of goes to its readers. Return whether that worked."""
        label = tr("Delete {name}", name=name)
        return bool(self._write(label, lambda file: edit_passes.deleted(file, name)))

    def duplicate(self, name: str) -> str:
        """Write a pass a second time; return the new one's name, "" where it cannot be."""
        label = tr("Duplicate {name}", name=name)
        return self._write(label, lambda file: edit_passes.duplicated(file, name))

    def move(self, name: str, by: int) -> bool:
        """Write a pass one place earlier (-1) or later (1); return whether that worked."""
        label = tr("Move {name}", name=name)
        return bool(self._write(label, lambda file: edit_passes.moved(file, name, by)))

    def _write(self, label: str, make: Callable[[Sketch], PassEdit]) -> str:
        """Write an edit as one step; return the name of its new pass, or "-" for an edit without one."""
        draft, done = self.draft, list[PassEdit]()
        if draft is None:
            return ""

        def act() -> None:
            done.append(make(draft.file))
            save_passes(draft.file, done[0])

        written = self.undo.write(label, act, Path(draft.file.file))
        return done[0].name or "-" if written else ""

    # ── neither is written ───────────────────────────────────────────────────

    def can_mute(self, name: str) -> bool:
        """Return whether a pass has something to let through."""
        sketch = self.session.sketch
        spec = sketch.graph.find(name) if sketch is not None else None
        if sketch is None or spec is None or name == "view":
            return False
        return any(passed_on(sketch.graph, name, output) for output in output_names(spec.technique))

    def mute(self, name: str) -> None:
        """Let through what a pass is made of, as if it were not there; or no longer."""
        view = self.session.view
        if name == "view":
            self.notices.say(tr("the view makes the picture, so it is not muted"))
            return
        if name not in view.muted and not self.can_mute(name):
            words = tr("{name} is made of nothing that could take its place, so it is not muted", name=name)
            self.notices.say(words)
            return
        view.mute(name, name not in view.muted)

    def solo(self, name: str, ref: str) -> None:
        """Show a pass's texture from above, or the picture again."""
        shown = self.session.view.map
        self.session.show(None if name == "view" or (shown is not None and shown.ref == ref) else ref)


# ── what may be added ─────────────────────────────────────────────────────────


@dataclass(frozen=True)
class Entry:
    """A technique that may be added."""

    use: str  # as a file names it
    title: str  # one sentence
    inputs: tuple[str, ...]
    outputs: Mapping[str, int]  # how many numbers a texel of each has

    @property
    def name(self) -> str:
        """Its name without its folder."""
        return self.use.rpartition("/")[2]


_FIRST = ("erosion", "texturing", "lighting", "water", "generation", "trees", "clouds", "view")
"""The folders that are read first."""


class Catalogue:
    """The techniques that a sketch may add; they are read piece by piece, a frame each."""

    def __init__(self) -> None:
        self.entries: dict[str, Entry] = {}
        self._left: dict[str, None] = {}
        self._read: Callable[[str], Technique] | None = None

    @property
    def is_whole(self) -> bool:
        """Whether all are read."""
        return not self._left

    def begin(self, sketch: Sketch) -> None:
        """Begin to read what a sketch may add; those of its own folder are read anew."""
        own = own_names(sketch)
        shipped = sorted(filter(lambda name: not is_part(name), shipped_names()), key=_rank)
        self.entries = {u: e for u, e in self.entries.items() if not u.startswith("./")}
        self._left = dict.fromkeys(use for use in (*own, *shipped) if use not in self.entries)
        self._read = reader_of(sketch)

    def go_on(self, search: str, seconds: float) -> None:
        """Read for so long, what is searched for first; a file that is no technique is left out."""
        words, end = search.lower().split(), time.perf_counter() + seconds
        while self._left and self._read is not None:
            use = next((u for u in self._left if all(word in u for word in words)), next(iter(self._left)))
            del self._left[use]
            with suppress(PlaygroundError):
                technique = self._read(use)
                title = technique.title or use.rpartition("/")[2].replace("_", " ").capitalize()
                self.entries[use] = Entry(use, title, input_names(technique), components_of(technique))
            if time.perf_counter() > end:
                break

    def found(self, search: str, outputs: Sequence[str], pictured: Container[str] = ()) -> list[Entry]:
        """Return what has all words of a search, best first: what goes on from one of the outputs.

        A technique with an input and an output of that name comes first, then others that take it, then
        those that take nothing; of equals those with a picture.
        """
        words = search.lower().split()
        texts = ((e, f"{e.use} {' '.join(labels_of(e.title))}".lower()) for e in self.entries.values())
        entries = [entry for entry, text in texts if all(word in text for word in words)]

        def rank(entry: Entry) -> tuple[object, ...]:
            named = not words or any(entry.name.startswith(word) for word in words)
            return not named, fit(entry, outputs), entry.use not in pictured, _rank(entry.use)

        return sorted(entries, key=rank)


def fit(entry: Entry, outputs: Sequence[str]) -> int:
    """Return how well a technique goes on from outputs: 0 best, 3 worst."""
    taken = [name for name in outputs if name in entry.inputs]
    if any(name in entry.outputs for name in taken):
        return 0
    if taken:
        return 1
    return 2 if not entry.inputs or not outputs else 3


def _rank(use: str) -> tuple[int, str]:
    folder = use.partition("/")[0]
    return (-1 if folder == "." else _FIRST.index(folder) if folder in _FIRST else len(_FIRST)), use


def outputs_of(spec: PassSpec) -> tuple[str, ...]:
    """Return the outputs of a pass, its main one first."""
    names = output_names(spec.technique)
    return tuple(sorted(names, key=lambda name: name != spec.name))


def technique_at(sketch: Sketch, path: str) -> Technique | None:
    """Return the technique of a pass, by its path; of one inside a fast variant, the technique around it."""
    found: Technique | None = None
    for name in path.split("."):
        around = sketch.graph if found is None else found
        spec = None if isinstance(around, Kernel) else around.find(name)
        if spec is None:
            break
        found = spec.technique
    return found
