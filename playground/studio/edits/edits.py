"""User edits, and how they survive when the files change under them.

A draft is a sketch as its files say it, with the techniques that the user chose and the values and
the camera that the user set over it. All of it is frozen: an edit makes a new draft, so undoing is
storing the old one.

Edits survive a reload. In full, for an edited parameter:

* it keeps its value while the files change elsewhere, and also where its declaration changes:
  another default, label, step or wider range;
* where the sketch's own ``set`` (or the terrain's size, extent, relief or base elevation) now says
  another value than before, the file wins (see ``newer_value``): its value is taken, and a notice
  says so, unless it is the very value that the user had set;
* where its range no longer holds the value, the nearest end of the range is taken, with a notice;
* where its type is another now, or its menu has lost the choice, it goes back to the file's value,
  with a notice; a choice that has moved in its menu stays;
* where it is gone, with its line, its pass or its technique, its value waits and is there again when
  it returns, as long as that has the same type and a range that holds it; so does a value that the
  current technique does not take.

A parameter that is not edited shows what the files say, new defaults included. A camera set by the user
stays until the file moves the camera, a technique chosen by the user until the file fills that pass with
another, and what feeds a channel until the file feeds it otherwise. A locked parameter keeps its value,
edited or not, over any change of the files, as long as it fits at all.

The same rule holds for a reload and for the edits of an earlier session, over the files as they are now:
an edit stays, unless the files now set another value themselves. A new default alone does not win.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from playground.data.content_hash import content_key
from playground.errors import DataError, ParameterError, PlaygroundError
from playground.shader.parameter import is_whole, write
from playground.sketch.assign import TERRAIN_KEYS, check_value, resolve, values_of
from playground.sketch.model import Camera, Parameter, Sketch, Value
from playground.sketch.replace_technique import with_technique
from playground.studio.channels.channels import channels, find_channel, in_order, with_source
from playground.studio.language import tr

# ── values in files ───────────────────────────────────────────────────────────


@dataclass(frozen=True, slots=True)
class FileValue:
    """What the files say of a parameter."""

    value: Value | None  # None: of the terrain, left to the heightmap
    own: bool  # by the sketch itself; else by a default or inside a technique


def file_values(sketch: Sketch, paths: Iterable[str]) -> dict[str, FileValue]:
    """Return what the files say of each parameter, by its path; those that are gone are left out."""
    paths = tuple(paths)
    if not paths:
        return {}
    values_in_file, own = values_of(sketch), _set_by(sketch)
    by_path = {}
    for path in paths:
        if path in TERRAIN_KEYS:
            by_path[path] = FileValue(getattr(sketch.terrain, path), True)
            continue
        try:
            leaf = resolve(sketch.graph, path)[0].path
        except ParameterError:
            continue
        by_path[path] = FileValue(values_in_file[leaf], leaf in own)
    return by_path


def newer_value(
    path: str, was: Mapping[str, FileValue], now: Mapping[str, FileValue], locked: Iterable[str] = ()
) -> FileValue | None:
    """Return what the files say where it wins over the user's edit; None where the edit stays.

    ``was`` is what they set when it was edited or last shown, as ``file_values`` gives it; ``locked``
    are the paths whose values stay over any change of the files.
    """
    before, after = was.get(path), now.get(path)
    if path in locked or before is None or after is None or before.value == after.value:
        return None
    return after if before.own or after.own else None


def notice(sketch: Sketch, path: str, value: Value, newer: FileValue) -> str:
    """Return the message that reports an edit that gave way; "" where the files say that very value."""
    if newer.value == value or _same_file(sketch, value, newer.value):
        return ""
    if newer.value is None or path in TERRAIN_KEYS:
        return tr("{path}: the file's new value is taken", path=path)
    parameter = resolve(sketch.graph, path)[0].parameter
    return tr(
        "{path}: the file's new value, {write}, is taken", path=path, write=write(parameter, newer.value)
    )


def _same_file(sketch: Sketch, value: Value, newer: Value | None) -> bool:
    """Return whether two paths lead to the same contents: saving copies files next to the sketch."""
    if not (isinstance(value, str) and isinstance(newer, str)):
        return False
    folder = Path(sketch.folder)
    try:
        return content_key(folder / value) == content_key(folder / newer)
    except DataError:
        return False


def _set_by(sketch: Sketch) -> set[str]:
    """Return the paths of the parameters that the sketch's own passes set."""
    return {
        f"{spec.name}.{target.path}"
        for spec in sketch.graph.passes
        for path, _ in spec.values
        for target in resolve(spec.technique, path)
    }


# ── edits and drafts ──────────────────────────────────────────────────────────


@dataclass(frozen=True, slots=True)
class Edits:
    """What the user has set."""

    # Parameter path → value; some may not fit the sketch of the moment.
    values: tuple[tuple[str, Value], ...] = ()
    techniques: tuple[tuple[str, str], ...] = ()  # pass → use
    camera: Camera | None = None  # None: the file's
    locked: tuple[str, ...] = ()  # parameter paths that only their own row changes
    channels: tuple[tuple[str, str], ...] = ()  # channel of another tool's shader → what feeds it

    def with_value(self, path: str, value: Value) -> Edits:
        """Return them with a parameter set."""
        return replace(self, values=(*(v for v in self.values if v[0] != path), (path, value)))

    def without(self, path: str) -> Edits:
        """Return them without what was set for a parameter."""
        return replace(self, values=tuple(v for v in self.values if v[0] != path))

    def with_lock(self, path: str, locked: bool) -> Edits:
        """Return them with a parameter locked, or no longer."""
        others = tuple(p for p in self.locked if p != path)
        return replace(self, locked=(*others, path) if locked else others)

    def has(self, path: str) -> bool:
        """Say whether a parameter is edited."""
        return any(p == path for p, _ in self.values)


@dataclass(frozen=True)
class Draft:
    """A sketch as its files say it, and what was edited."""

    file: Sketch  # as loaded
    base: Sketch  # with the techniques chosen by the user
    edits: Edits = Edits()

    @cached_property
    def applied(self) -> dict[str, Value]:
        """The values edited that fit the sketch of the moment, by path; the others wait."""
        pairs = ((path, taken(self.base, path, value)) for path, value in self.edits.values)
        return {path: value for path, value in pairs if value is not None}

    @cached_property
    def sketch(self) -> Sketch:
        """The sketch to draw."""
        sketch = self.base.with_values(self.applied) if self.applied else self.base
        return sketch if self.edits.camera is None else sketch.with_camera(self.edits.camera)

    def with_edits(self, edits: Edits) -> Draft:
        """Return the same files with other values or another camera edited."""
        return replace(self, edits=edits)

    def with_value(self, path: str, raw: object) -> Draft:
        """Return the draft with one parameter set; raise ``ParameterError`` where it cannot be."""
        sketch = self.sketch.with_values({path: raw})
        value = dict(sketch.overrides).get(path, raw)
        made = self.with_edits(self.edits.with_value(path, value))  # type: ignore[arg-type]
        made.__dict__.update(sketch=sketch)  # all of it is checked already
        return made

    def without(self, path: str) -> Draft:
        """Return the draft with a parameter as the file says, by any path that it was set by."""
        mine = leaves(self.base, path)
        return self.with_edits(
            replace(
                self.edits,
                values=tuple(
                    v for v in self.edits.values if v[0] != path and not mine & leaves(self.base, v[0])
                ),
            )
        )

    def choose(self, pass_name: str, use: str) -> Draft:
        """Return the draft with another technique in a pass; raise ``SketchError`` if it cannot be there."""
        fed = next((c for c in channels(self.base) if c.alone and c.feeder == pass_name), None)
        if fed is not None:
            return self.feed(fed.path, use)
        others = tuple(t for t in self.edits.techniques if t[0] != pass_name)
        in_file = self.file.graph.find(pass_name)
        chosen = () if in_file is not None and in_file.use == use else ((pass_name, use),)
        return self.with_choices((*others, *chosen), self.edits.channels)

    def feed(self, channel: str, source: str, /, **values: Value) -> Draft:
        """Return the draft with another source for a channel, and ``values`` of the parameters of that.

        Raises ``SketchError`` if it cannot be there.
        """
        in_file = find_channel(self.file, channel)
        own = in_file.feeder if in_file is not None and in_file.alone else ""
        techniques = tuple(t for t in self.edits.techniques if t[0] != own)
        others = tuple(c for c in self.edits.channels if c[0] != channel)
        chosen = () if in_file is not None and in_file.is_fed_by(source) else ((channel, source),)
        made = self.with_choices(techniques, (*others, *chosen))
        fed = find_channel(made.base, channel)
        feeder = fed.feeder if fed is not None else ""
        for name, value in values.items():
            made = made.with_value(f"{feeder}.{name}", value)
        return made

    def with_choices(
        self, techniques: tuple[tuple[str, str], ...], sources: tuple[tuple[str, str], ...]
    ) -> Draft:
        """Return the draft with these techniques and sources of channels chosen by the user, and no others.

        They are put into the file's own sketch, so that what a pass had comes back with
        its technique. Raises ``SketchError`` if one cannot be there.
        """
        base = self.file
        for name, use in techniques:
            base = with_technique(base, name, use)
        for channel, source in in_order(sources):
            base = with_source(base, channel, source)
        return Draft(self.file, base, replace(self.edits, techniques=techniques, channels=sources))

    def with_all(self, edits: Edits) -> Draft:
        """Return the same files with other edits, techniques included; raise as ``with_choices``."""
        same = (edits.techniques, edits.channels) == (self.edits.techniques, self.edits.channels)
        return (self if same else self.with_choices(edits.techniques, edits.channels)).with_edits(edits)


def taken(sketch: Sketch, path: str, value: Value) -> Value | None:
    """Return a value as a sketch takes it; None where it has no such parameter, of its type and range.

    Text is read as on the command line.
    """
    try:
        taken_picture = check_value(sketch, path, value)
    except ParameterError:
        return None
    if path in TERRAIN_KEYS or isinstance(value, str):
        return taken_picture
    return taken_picture if _shape(taken_picture) == _shape(value) else None


def reload_draft(old: Draft, loaded: Sketch) -> tuple[Draft, list[str]]:
    """Return the draft after its files changed, and a message for each edit that gave way."""
    if old.edits == Edits():
        return Draft(loaded, loaded), []
    notes: list[str] = []
    edits, note = with_camera_of(old.edits, old.file.camera, loaded.camera)
    notes += filter(None, [note])
    base, techniques = _with_techniques(old.file, loaded, edits.techniques, notes)
    base, sources = _with_sources(old.file, base, loaded, edits.channels, notes)
    values = tuple(_after_reload(old, base, notes))
    edits = replace(edits, techniques=techniques, channels=sources, values=values)
    return Draft(loaded, base, edits), notes


def with_camera_of(edits: Edits, was: Camera, now: Camera) -> tuple[Edits, str]:
    """Return edits without their camera where the file has moved its own, and a message if one is due."""
    if edits.camera is None or now == was:
        return edits, ""
    note = "" if edits.camera == now else tr("camera: the file's new one is taken")
    return replace(edits, camera=None), note


def _with_techniques(
    before: Sketch | None, loaded: Sketch, chosen: tuple[tuple[str, str], ...], notes: list[str]
) -> tuple[Sketch, tuple[tuple[str, str], ...]]:
    """Return the sketch with the techniques that still can be chosen, and which they are.

    ``before``: what the files said when they were chosen, where that is known.
    """
    base, stay = loaded, []
    for name, use in chosen:
        was, now = before.graph.find(name) if before else None, loaded.graph.find(name)
        if now is not None and now.use == use:
            continue  # it has become the file's own
        if before and (now is None or (was is not None and was.use != now.use)):
            notes.append(tr("{name}: the technique chosen here gave way to the file's", name=name))
            continue
        try:
            base = with_technique(base, name, use)
            stay.append((name, use))
        except PlaygroundError as error:
            notes.append(
                tr(
                    "{name}: {use} can no longer be used ({message})",
                    name=name,
                    use=use,
                    message=error.diagnostics[0].message,
                )
            )
    return base, tuple(stay)


def _with_sources(
    before: Sketch | None, base: Sketch, loaded: Sketch, chosen: tuple[tuple[str, str], ...], notes: list[str]
) -> tuple[Sketch, tuple[tuple[str, str], ...]]:
    """Return the sketch with the sources that still can feed their channels, and which they are."""
    stay = []
    for channel, source in in_order(chosen):
        was, now = find_channel(before, channel) if before else None, find_channel(loaded, channel)
        if now is not None and now.is_fed_by(source):
            continue  # it has become the file's own
        if before and (now is None or (was is not None and was.source != now.source)):
            notes.append(
                tr("{channel}: what was chosen to feed it here gave way to the file's", channel=channel)
            )
            continue
        try:
            base = with_source(base, channel, source)
            stay.append((channel, source))
        except PlaygroundError as error:
            notes.append(
                tr(
                    "{channel}: {source} can no longer feed it ({message})",
                    channel=channel,
                    source=source,
                    message=error.diagnostics[0].message,
                )
            )
    return base, tuple(stay)


def _after_reload(old: Draft, base: Sketch, notes: list[str]) -> list[tuple[str, Value]]:
    """Return the edited values after a reload; add a message to the notes for each that gave way."""
    values = _with_locked(old, values_of(base))
    before, after = (file_values(sketch, [p for p, _ in values]) for sketch in (old.base, base))
    left: list[tuple[str, Value]] = []
    for path, value in values:
        was, now = _parameter(old.base, path), _parameter(base, path)
        if path not in TERRAIN_KEYS and (now is None or taken(old.base, path, value) is None):
            left.append((path, value))  # it waits
            if now is None and was is not None:
                notes.append(tr("{path} is gone; what was set here waits in case it returns", path=path))
            continue
        newer = newer_value(path, before, after, old.edits.locked)
        if newer is not None:
            notes += filter(None, [notice(base, path, value, newer)])
            continue
        if path in TERRAIN_KEYS:
            left.append((path, value))
            continue
        assert was is not None and now is not None
        stays, note = _moved(was, now, value, path, base)
        if stays is not None:
            left.append((path, stays))
        if note:
            notes.append(note)
    return left


def _with_locked(old: Draft, after: dict[str, Value]) -> list[tuple[str, Value]]:
    """Return the edited values, and those of locked parameters that the files would now change."""
    values = list(old.edits.values)
    if old.edits.locked:
        now = values_of(old.sketch)
        for path in old.edits.locked:
            inner = leaves(old.base, path)
            moved = any(leaf in after and after[leaf] != now[leaf] for leaf in inner)
            if moved and not old.edits.has(path):
                values.append((path, now[min(inner)]))
    return values


def _moved(was: Parameter, now: Parameter, value: Value, path: str, base: Sketch) -> tuple[Value | None, str]:
    """Return what becomes of a value whose parameter is declared again (None: it goes), and why."""
    if was.type != now.type or (was.widget.kind == "menu") != (now.widget.kind == "menu"):
        noun = (was.type, now.type) if was.type != now.type else (was.widget.kind, now.widget.kind)
        return None, tr(
            "{path} was {value} and is {value_2} now: back to the file's value",
            path=path,
            value=noun[0],
            value_2=noun[1],
        )
    if now.widget.kind == "menu" and isinstance(value, int) and was.widget.choices != now.widget.choices:
        choice = was.widget.choices[value]
        if choice in now.widget.choices:
            return now.widget.choices.index(choice), ""
        return None, tr(
            "{path}: its menu has no '{choice}' any more: back to the file's value", path=path, choice=choice
        )
    if taken(base, path, value) is not None:
        return value, ""
    low, high = now.widget.low, now.widget.high
    if low is None or high is None or isinstance(value, str | bool):
        return None, tr(
            "{path} no longer takes {write}: back to the file's value", path=path, write=write(was, value)
        )
    nearest = _clamped(now, value, low, high)
    if taken(base, path, nearest) is None:
        return None, tr(
            "{path} no longer takes {write}: back to the file's value", path=path, write=write(was, value)
        )
    return nearest, (
        tr(
            "{path} = {write} is outside its new range {low} to {high}: {write_2} is taken",
            path=path,
            write=write(was, value),
            low=f"{low:g}",
            high=f"{high:g}",
            write_2=write(now, nearest),
        )
    )


def _clamped(parameter: Parameter, value: Value, low: float, high: float) -> Value:
    numbers = value if isinstance(value, tuple) else (value,)
    axes = parameter.widget.axes or ((low, high),) * len(numbers)
    held = [min(max(float(n), least), most) for n, (least, most) in zip(numbers, axes, strict=True)]
    result = tuple(round(n) for n in held) if is_whole(parameter.type) else tuple(held)
    return result if isinstance(value, tuple) else result[0]


def leaves(sketch: Sketch, path: str) -> set[str]:
    """Return the paths of the parameters that a path represents; none where it is gone."""
    try:
        return {target.path for target in resolve(sketch.graph, path)}
    except ParameterError:
        return set()


def _parameter(sketch: Sketch, path: str) -> Parameter | None:
    try:
        return resolve(sketch.graph, path)[0].parameter
    except ParameterError:
        return None


def _shape(value: Value) -> object:
    """Return what type a value is of: a number that is whole is no real one, and a pair no triple."""
    return tuple(map(type, value)) if isinstance(value, tuple) else type(value)


# ── edits of an earlier session ───────────────────────────────────────────────


@dataclass(frozen=True)
class StoredEdits:
    """User edits, and what the files set when they were made."""

    edits: Edits = field(default_factory=Edits)
    in_file: Mapping[str, FileValue] = field(default_factory=dict)  # of each edited value, where it is known
    camera_in_file: Camera | None = None  # of the camera, where another is set and it is known

    def with_values(self, values: Mapping[str, Value]) -> StoredEdits:
        """Return them with values that override those of the files."""
        edits = self.edits
        for name, value in values.items():
            edits = edits.with_value(name, value)
        return replace(self, edits=edits, in_file={k: v for k, v in self.in_file.items() if k not in values})


def stored(draft: Draft) -> StoredEdits:
    """Return a draft's edits with what its files say now."""
    in_file = file_values(draft.base, [path for path, _ in draft.edits.values])
    return StoredEdits(draft.edits, in_file, draft.file.camera if draft.edits.camera is not None else None)


def first_draft(loaded: Sketch, start: StoredEdits) -> tuple[Draft, list[str]]:
    """Return the draft to begin with, and a message for each edit that gave way to the files."""
    edits, note = with_camera_of(start.edits, start.camera_in_file or loaded.camera, loaded.camera)
    notes = [note] if note else []
    base, techniques = _with_techniques(None, loaded, edits.techniques, notes)
    base, sources = _with_sources(None, base, loaded, edits.channels, notes)
    draft = Draft(loaded, base, replace(edits, techniques=techniques, channels=sources))
    now = file_values(base, [path for path, _ in edits.values])
    values = []
    for path, value in edits.values:
        newer = newer_value(path, start.in_file, now, edits.locked)
        if newer is None:
            values.append((path, value))
        else:
            notes += filter(None, [notice(draft.base, path, value, newer)])
    return draft.with_edits(replace(draft.edits, values=tuple(values))), notes
