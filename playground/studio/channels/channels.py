"""The channels of other tools' shaders in a sketch: what feeds each, what may, and how that is changed.

A channel is an input of such a shader, as "view.iChannel0". What feeds it is a source: a technique as
``use`` names it ("foreign/noise"), in a pass that is there for this channel alone; another pass or one
of its outputs ("photo", "land:height"); or "" for nothing, which is black.

Every technique of ``glsl/foreign`` that gives ``channel_texels`` and needs no input may feed a channel.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from functools import cache

from playground.allowed_files import ELEVATIONS
from playground.data.media import SOUND_FILES, VIDEO_FILES
from playground.errors import PlaygroundError, SketchError, nearest
from playground.memo import GRAPHS
from playground.paths import GLSL, shown
from playground.shader.dialect import dialects
from playground.sketch.assign import find_targets
from playground.sketch.find import shipped_names
from playground.sketch.flat import Ref, Source, leaves_of
from playground.sketch.flatten import flatten
from playground.sketch.model import (
    ForeignShader,
    Graph,
    Kernel,
    Parameter,
    PassSpec,
    Sketch,
    Technique,
    TexelKernel,
    Value,
    kernels_of,
)
from playground.sketch.techniques import read_technique
from playground.sketch.wiring import input_names, is_optional, output_names
from playground.studio.language import tr, tr_label

OUTPUT = "channel_texels"
FOLDER = "foreign/"
_CUBES = ("foreign/sky_box", "foreign/cube_faces")  # six square faces above each other
_HEARD = ("foreign/microphone", "foreign/sound")
_ANY = "foreign/black"  # what has any shape
_OWN_SIZE = ("camera", "video_file")  # sources that give a pass of no size their own
_NUMBER = re.compile(r"\d{1,2}$")


@dataclass(frozen=True, slots=True)
class Channel:
    """An input of another tool's shader."""

    path: str  # "view.iChannel0": a pass of the sketch, and an input of it or inside it
    source: str  # what feeds it now; "" for nothing
    feeder: str = ""  # the pass of the sketch that feeds it; "" where that is inside the shader's own
    alone: bool = False  # the feeder feeds nothing else, and a technique of ``glsl/foreign`` fills it
    shape: str = ""  # of what it reads: a value of ``SHAPES``

    @property
    def spec(self) -> str:
        """The pass that has it."""
        return self.path.partition(".")[0]

    @property
    def name(self) -> str:
        """Its name in that pass."""
        return self.path.partition(".")[2]

    def is_fed_by(self, source: str) -> bool:
        """Say whether a source feeds it now: a pass by its name, or by the technique that fills it."""
        return source in (self.source, self.feeder) if source else not self.source


def channels(sketch: Sketch) -> tuple[Channel, ...]:
    """Return every channel of a sketch, pass by pass, by name."""
    return _channels(sketch.graph)


@GRAPHS.cached(identities=1)
def _channels(graph: Graph) -> tuple[Channel, ...]:
    names = [
        (spec, name)
        for spec in graph.passes
        for name in sorted(_names(spec.technique), key=_by_number)
        if name not in dict(spec.feedback)
    ]
    if not names:
        return ()
    flat = flatten(_bare(graph))
    readers: dict[str, set[tuple[str, str]]] = {}  # passes of a shader read one channel by one name
    sources: dict[tuple[str, str], Source | None] = {}
    shapes: dict[tuple[str, str], str] = {}
    for leaf in leaves_of(flat.nodes):
        shapes |= {(leaf.path, declared.name): declared.shape for declared in leaf.kernel.inputs}
        for name, source in leaf.inputs:
            sources[leaf.path, name] = source
            if isinstance(source, Ref):
                readers.setdefault(source.path, set()).add((leaf.path.partition(".")[0], name))
    result = []
    for spec, name in names:
        kernel, _, own = _leaf(spec, name).rpartition(".")
        source, shape = sources.get((kernel, own)), shapes.get((kernel, own), "")
        if isinstance(source, Ref):
            fed = _fed(graph, f"{spec.name}.{name}", source, len(readers[source.path]), flat.specs)
            result.append(replace(fed, shape=shape))
        elif source is None:
            result.append(Channel(f"{spec.name}.{name}", "", shape=shape))
    return tuple(result)


def _by_number(name: str) -> list[str | int]:
    """Return a key that sorts u_tex2 before u_tex10."""
    parts = re.split(r"(\d+)", name)
    return [int(part) if part.isdigit() else part for part in parts]


def _fed(graph: Graph, path: str, source: Ref, readers: int, specs: dict[str, PassSpec]) -> Channel:
    spec = specs[source.path]
    is_own = graph.find(source.path) is spec
    is_feed = spec.use.startswith(FOLDER) and output_names(spec.technique) == (OUTPUT,)
    if is_feed and (readers == 1 or not is_own):
        return Channel(path, spec.use, source.path if is_own else "", is_own)
    head = source.path.partition(".")[0]
    several = len(output_names(graph.find(head).technique)) > 1  # type: ignore[union-attr]
    return Channel(path, f"{head}:{source.output}" if several else head, head)


def channel_of(sketch: Sketch, path: str) -> Channel:
    """Return a channel by its path; raise ``SketchError`` with the nearest where there is none."""
    channels_by_path = {channel.path: channel for channel in channels(sketch)}
    if path not in channels_by_path:
        raise SketchError(f"no channel '{path}' in sketch {sketch.name}{nearest(path, channels_by_path)}")
    return channels_by_path[path]


def find_channel(sketch: Sketch, path: str) -> Channel | None:
    """Return a channel by its path; None where there is none."""
    return next((channel for channel in channels(sketch) if channel.path == path), None)


def source_of(sketch: Sketch, path: str) -> str | None:
    """Return what feeds a channel; None where there is no such channel."""
    channel = find_channel(sketch, path)
    return channel.source if channel is not None else None


def sources(sketch: Sketch, path: str) -> list[str]:
    """List what may feed a channel: techniques, then passes and their outputs; what does now is among them.

    Raises ``SketchError`` where there is no such channel.
    """
    now = channel_of(sketch, path)
    stand_ins = {channel.feeder for channel in channels(sketch) if channel.alone}
    passes = [
        f"{spec.name}:{output}" if len(outputs) > 1 else spec.name
        for spec in sketch.graph.passes
        for outputs in [output_names(spec.technique)]
        for output in outputs
        if spec.name not in (now.spec, now.feeder)
        and not (spec.name in stand_ins and not _reads_file(spec))  # another channel's own
    ]
    feeds = [use for use in _feeds() if use == _ANY or (use in _CUBES) == (now.shape == "cube")]
    candidates = dict.fromkeys([*feeds, *passes, now.source])
    return [source for source in candidates if source == now.source or _may_feed(sketch, path, source)]


def _reads_file(spec: PassSpec) -> bool:
    return isinstance(spec.technique, Kernel) and bool(spec.technique.file_parameters)


def is_technique(source: str) -> bool:
    """Return whether a source is a technique, by its name; else it is a pass."""
    return "/" in source


def in_order(sources: Iterable[tuple[str, str]]) -> list[tuple[str, str]]:
    """Return (channel, source) pairs in the order that ``with_source`` takes: a pass may be one of them."""
    return sorted(sources, key=lambda pair: not is_technique(pair[1]))


@cache
def _feeds() -> tuple[str, ...]:
    """Return the techniques that may feed a channel."""
    feeds = []
    for use in shipped_names():
        if use.startswith(FOLDER):
            technique = read_technique(use, GLSL, GLSL)
            needs = [name for name in input_names(technique) if not is_optional(technique, name)]
            if output_names(technique) == (OUTPUT,) and not needs:
                feeds.append(use)
    return tuple(feeds)


def _may_feed(sketch: Sketch, path: str, source: str) -> bool:
    try:
        with_source(sketch, path, source)
    except PlaygroundError:
        return False
    return True


def with_source(sketch: Sketch, path: str, source: str) -> Sketch:
    """Return the sketch with another source for a channel, as ``sources`` lists them.

    A technique takes the place of the one that feeds this channel alone, else it comes in a new pass.
    Raises ``SketchError`` where there is no such channel, technique or pass, or the passes would
    read each other in a circle.
    """
    now = channel_of(sketch, path)
    if now.is_fed_by(source):
        return sketch
    if not is_technique(source):
        return _wired(sketch, now, source, sketch.graph.passes)
    technique = read_technique(source, GLSL, GLSL)
    passes = sketch.graph.passes
    name = now.feeder if now.alone else _new_name(sketch, now)
    before = sketch.graph.find(name)
    spec = PassSpec(
        name,
        source,
        technique,
        values=(*_values(technique, now), *_same_choices(technique, before)),
        size=_size(technique, source, now.shape, name, before),
        file=shown(sketch.file),
    )
    if not now.alone:
        return _wired(sketch, now, name, (*passes[:-1], spec, passes[-1]))
    was = next(spec for spec in passes if spec.name == name)
    spec = replace(spec, inputs=(), file=was.file, line=was.line)
    return _checked(sketch, tuple(spec if pass_ is was else pass_ for pass_ in passes))


def _wired(sketch: Sketch, channel: Channel, source: str, passes: tuple[PassSpec, ...]) -> Sketch:
    def wired(spec: PassSpec) -> PassSpec:
        if spec.name != channel.spec:
            return spec
        if any(name == channel.name for name, _ in spec.inputs):
            inputs = tuple((n, source if n == channel.name else s) for n, s in spec.inputs)
        else:
            inputs = (*spec.inputs, (channel.name, source))
        return replace(spec, inputs=inputs)

    return _checked(sketch, tuple(map(wired, passes)))


def _checked(sketch: Sketch, passes: tuple[PassSpec, ...]) -> Sketch:
    graph = replace(sketch.graph, passes=passes)
    overrides = tuple(pair for pair in sketch.overrides if find_targets(graph, pair[0]))
    checked = replace(sketch, graph=graph, overrides=overrides)
    flatten(checked)
    return checked


def _new_name(sketch: Sketch, channel: Channel) -> str:
    """Return a name for a pass: the channel's, unless another pass has it or would read it by that name."""
    taken = [spec.name for spec in sketch.graph.passes]
    same = [spec for spec in sketch.graph.passes if channel.name in input_names(spec.technique)]
    own = channel.path.replace(".", "_")
    base_name = own if len(same) > 1 or "." in channel.name else channel.name
    numbered = (f"{base_name}_{number}" for number in range(2, 10_000))
    return next(name for name in (base_name, *numbered) if name not in taken)


def _values(technique: Technique, channel: Channel) -> tuple[tuple[str, Value], ...]:
    """Return the number of a stand-in: that of the channel's name, so that channels differ."""
    number = _NUMBER.search(channel.name)
    return (("number", int(number.group())),) if number and find_targets(technique, "number") else ()


def _same_choices(technique: Technique, before: PassSpec | None) -> Iterator[tuple[str, Value]]:
    """Yield the choices that a stand-in has and what takes its place has too: a spectrum stays one."""
    if before is None or not isinstance(technique, Kernel) or not isinstance(before.technique, Kernel):
        return
    for name, value in before.values:
        was, parameter = before.technique.parameter(name), technique.parameter(name)
        if was is None or parameter is None or not isinstance(value, int) or not was.widget.choices:
            continue
        if was.widget.choices[value] in parameter.widget.choices:
            yield name, parameter.widget.choices.index(was.widget.choices[value])


def _size(
    technique: Technique, use: str, shape: str, name: str, before: PassSpec | None
) -> tuple[str, str] | None:
    """Return the size of a pass that feeds a channel: that of its picture, if it reads one.

    A sound has no size: its texels are as many as those of a made-up one ``before``.
    """
    sizes = dialects().sizes()
    kernel = technique if isinstance(technique, Kernel) else None
    if kernel is not None and kernel.registry in _OWN_SIZE:
        return None
    if use in _HEARD and before is not None and before.use == "foreign/spectrum":
        return before.size
    files = [p for p in kernel.parameters if p.widget.kind == "file"] if kernel is not None else []
    if files and isinstance(kernel, TexelKernel):
        wide, high = (f"{name}.{files[0].name}.size.{axis}" for axis in "xy")
        return (wide, f"6 * {wide}") if use in _CUBES else (wide, high)
    if use in sizes:
        return sizes[use]
    if before is not None and before.use not in sizes and before.size and not _reads_file(before):
        return before.size  # as an ISF filter has it, whose image is as large as its picture
    return dialects().size_of_shape(shape)


def _names(technique: Technique) -> Iterator[str]:
    """Yield the inputs of other tools' shaders in a technique, as its user wires them."""
    if isinstance(technique, Kernel):
        if isinstance(technique, ForeignShader):
            yield from input_names(technique)
        return
    if not any(isinstance(kernel, ForeignShader) for _, kernel in kernels_of(technique)):
        return
    exported = dict[str, None]()
    for export in technique.inputs:
        if any(_is_foreign(technique, target) for target in export.targets):
            exported |= dict.fromkeys(export.targets)
            yield export.name
    for spec in technique.passes:
        wired = {name for name, _ in (*spec.inputs, *spec.feedback)}
        for name in _names(spec.technique):
            if f"{spec.name}.{name}" not in exported and name not in wired:
                yield f"{spec.name}.{name}"


def _is_foreign(graph: Graph, target: str) -> bool:
    return isinstance(_reader(graph, target)[0], ForeignShader)


def _leaf(spec: PassSpec, name: str) -> str:
    """Return the path of the kernel's input that a channel's name leads to."""
    return f"{spec.name}.{_reader(spec.technique, name)[1]}"


def _reader(technique: Technique, name: str) -> tuple[Kernel, str]:
    """Return the kernel that has an input of a name or path, and the path of the input."""
    path = ""
    while isinstance(technique, Graph):
        export = next((e for e in technique.inputs if e.name == name), None)
        head, _, name = (export.targets[0] if export else name).partition(".")
        path = f"{path}{head}."
        technique = technique.find(head).technique  # type: ignore[union-attr]
    return technique, f"{path}{name}"


def _bare(graph: Graph) -> Sketch:
    return Sketch(graph.name, graph.path, "", graph)


# ── descriptions, and files that feed channels ────────────────────────────────


IMAGES = (".jpg", ".jpeg", ".webp", *ELEVATIONS)
"""Endings of what a parameter for files reads."""
PICTURES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
"""Endings of what is read as a picture."""

MEDIA = {"video_file": VIDEO_FILES, "sound_file": SOUND_FILES}
"""Endings of what sources of these kinds read."""


def source_label(sketch: Sketch, source: str) -> str:
    """Return what a source is called in a list: "noise", "image file", "pass photo"."""
    if not source:
        return tr("nothing (black)")
    if not is_technique(source):
        return tr("pass {source}", source=source)
    name = source.rpartition("/")[2].replace("_", " ")
    takes_file = _file_parameter(_technique(sketch, source)) is not None
    return tr("{name} file", name=name) if takes_file else name


def note_of(sketch: Sketch, channel: Channel) -> str:
    """Return a tooltip: what feeds a channel."""
    if not is_technique(channel.source):
        spec = sketch.graph.find(channel.feeder)
        title = tr_label(spec.technique.title) if spec is not None else ""
        what = (
            tr("the pass {source}", source=channel.source)
            if channel.source
            else tr("nothing: it reads black")
        )
        return "\n".join(filter(None, [tr("Fed by {what}", what=what), title]))
    return (
        tr("Fed by {what}", what=channel.source) + "\n" + tr_label(_technique(sketch, channel.source).title)
    )


def file_of(sketch: Sketch, channel: Channel) -> tuple[str, Parameter] | None:
    """Return the parameter, with its path, that names the file which feeds a channel; None for no file."""
    spec = sketch.graph.find(channel.feeder) if channel.alone else None
    parameter = _file_parameter(spec.technique) if spec is not None else None
    return (f"{channel.feeder}.{parameter.name}", parameter) if parameter is not None else None


@dataclass(frozen=True, slots=True)
class Taker:
    """A channel that a file may feed."""

    channel: Channel
    source: str  # the technique that reads the file
    parameter: str  # of the technique: names the file


def takers(sketch: Sketch, ending: str) -> tuple[Taker, ...]:
    """Return the channels that a file of an ending, as ".png", may feed."""
    result = []
    for channel in channels(sketch):
        for source in [s for s in sources(sketch, channel.path) if is_technique(s)]:
            parameter = _file_parameter(_technique(sketch, source))
            if parameter is not None and ending in endings_of(sketch, source):
                result.append(Taker(channel, source, parameter.name))
    return tuple(result)


def endings_of(sketch: Sketch, source: str) -> tuple[str, ...]:
    """Return the endings of the files that a technique reads for a channel."""
    kernel = _technique(sketch, source)
    if not isinstance(kernel, Kernel):
        return ()
    return MEDIA.get(kernel.registry, PICTURES if isinstance(kernel, TexelKernel) else ())


def _technique(sketch: Sketch, source: str) -> Technique:
    spec = next((spec for spec in sketch.graph.passes if spec.use == source), None)
    return spec.technique if spec is not None else read_technique(source, GLSL, GLSL)


def _file_parameter(technique: Technique) -> Parameter | None:
    """Return the one parameter of a technique that names a file; None for none, or several."""
    file_parameters = technique.file_parameters if isinstance(technique, Kernel) else ()
    return file_parameters[0] if len(file_parameters) == 1 else None
