"""What a person changed by hand, and how it survives when the files change under it.

A draft is a sketch as its files say it, with the techniques chosen by hand in it and
the values and the camera set by hand over it. All of it is frozen: an edit makes a new
draft, so undoing is keeping the old one.

The one rule of a reload: an edit by hand stays, unless the file changed that very
thing since; then the file is the newer word.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

from playground.errors import ParameterError, PlaygroundError
from playground.sketch.assign import LAND, resolve, values_of
from playground.sketch.choose import with_technique
from playground.sketch.model import Camera, Parameter, Sketch, Value
from playground.sketch.values import write


@dataclass(frozen=True, slots=True)
class Edits:
    """What was set by hand."""

    values: tuple[
        tuple[str, Value], ...
    ] = ()  # parameter path → value; some may not fit the sketch of the moment
    techniques: tuple[tuple[str, str], ...] = ()  # pass → use
    camera: Camera | None = None  # None: the file's

    def with_value(self, path: str, value: Value) -> Edits:
        """Return them with a parameter set."""
        return replace(self, values=(*(v for v in self.values if v[0] != path), (path, value)))

    def without(self, path: str) -> Edits:
        """Return them without what was set for a parameter."""
        return replace(self, values=tuple(v for v in self.values if v[0] != path))

    def has(self, path: str) -> bool:
        """Say whether a parameter is set by hand."""
        return any(p == path for p, _ in self.values)


@dataclass(frozen=True)
class Draft:
    """A sketch as its files say it, and what was changed by hand."""

    file: Sketch  # as loaded
    base: Sketch  # with the techniques chosen by hand
    edits: Edits = Edits()

    @cached_property
    def sketch(self) -> Sketch:
        """The sketch to draw; edits that do not fit it are left out."""
        sketch = self.base
        for path, value in self.edits.values:
            try:
                sketch = sketch.with_values({path: value})
            except ParameterError:
                continue
        return sketch if self.edits.camera is None else sketch.with_camera(self.edits.camera)

    def with_edits(self, edits: Edits) -> Draft:
        """Return the same files with other values or another camera set by hand."""
        return replace(self, edits=edits)

    def choose(self, pass_name: str, use: str) -> Draft:
        """Return the draft with another technique in a pass; raise ``SketchError`` if it cannot be there."""
        base = with_technique(self.base, pass_name, use)
        others = tuple(t for t in self.edits.techniques if t[0] != pass_name)
        in_file = self.file.graph.find(pass_name)
        chosen = () if in_file is not None and in_file.use == use else ((pass_name, use),)
        return Draft(self.file, base, replace(self.edits, techniques=(*others, *chosen)))

    def reset(self) -> Draft:
        """Return the draft as the files say it."""
        return Draft(self.file, self.file)


def reload_draft(old: Draft | None, loaded: Sketch, edits: Edits = Edits()) -> tuple[Draft, list[str]]:
    """Return the draft after its files changed, and a sentence for each edit that gave way.

    ``edits`` are those to begin with when there is no old draft.
    """
    if old is None:
        return Draft(loaded, loaded, edits), []
    notes: list[str] = []
    edits = old.edits
    if loaded.camera != old.file.camera and edits.camera is not None:
        edits = replace(edits, camera=None)
        notes.append("camera: the file's new one is taken")
    base, techniques = loaded, []
    for name, use in edits.techniques:
        before, after = old.file.graph.find(name), loaded.graph.find(name)
        if after is None or (before is not None and before.use != after.use):
            notes.append(f"{name}: the technique chosen here gave way to the file's")
            continue
        try:
            base = with_technique(base, name, use)
            techniques.append((name, use))
        except PlaygroundError as error:
            notes.append(f"{name}: {use} can no longer be used ({error.diagnostics[0].message})")
    edits = replace(edits, techniques=tuple(techniques))
    kept = []
    for path, value in edits.values:
        fate = _fate(path, value, old.base, base)
        if fate == "":
            kept.append((path, value))
        elif fate == "gone":
            kept.append((path, value))
            if _parameter(old.base, path) is not None:
                notes.append(f"{path} is gone; what was set here is kept in case it returns")
        else:
            notes.append(fate)
    return Draft(loaded, base, replace(edits, values=tuple(kept))), notes


def _fate(path: str, value: Value, old: Sketch, new: Sketch) -> str:
    """Return "" if an edit stays, "gone" if its parameter is, else why it gave way."""
    if path in LAND:
        return "" if getattr(old, path) == getattr(new, path) else f"{path}: the file's new value is taken"
    now = _parameter(new, path)
    if now is None:
        return "gone"
    was = _parameter(old, path)
    if was is not None and was.type != now.type:
        return f"{path} was a {was.type} and is a {now.type}: back to its default"
    try:
        new.with_values({path: value})
    except ParameterError as error:
        return f"back to its default: {error.diagnostics[0].message}"
    if was is not None:
        before, after = _value(old, path), _value(new, path)
        if before != after:
            return f"{path}: the file's new value, {write(now, after)}, is taken"
    return ""


def _parameter(sketch: Sketch, path: str) -> Parameter | None:
    try:
        return resolve(sketch.graph, path)[0].parameter
    except ParameterError:
        return None


def _value(sketch: Sketch, path: str) -> Value:
    return values_of(sketch)[resolve(sketch.graph, path)[0].path]
