"""The channels of other tools' shaders in words, and which of them take a file."""

from __future__ import annotations

from dataclasses import dataclass

from playground.data.media import SOUND_FILES, VIDEO_FILES
from playground.paths import GLSL
from playground.sketch.model import Kernel, Parameter, Sketch, Technique, TexelKernel
from playground.sketch.techniques import read_technique
from playground.studio.channels.channels import Channel, channels, is_technique, sources

PICTURES = (".png", ".jpg", ".jpeg", ".webp", ".tif", ".tiff")
"""Endings of what is read as a picture."""

MEDIA = {"video_file": VIDEO_FILES, "sound_file": SOUND_FILES}
"""Endings of what sources of these kinds read."""


def in_words(sketch: Sketch, source: str) -> str:
    """Return what a source is called in a list: "noise", "image file", "pass photo"."""
    if not source:
        return "nothing (black)"
    if not is_technique(source):
        return f"pass {source}"
    name = source.rpartition("/")[2].replace("_", " ")
    takes_file = _file_parameter(_technique(sketch, source)) is not None
    return f"{name} file" if takes_file else name


def note_of(sketch: Sketch, channel: Channel) -> str:
    """Return a tooltip: what feeds a channel."""
    if not is_technique(channel.source):
        spec = sketch.graph.find(channel.feeder)
        title = spec.technique.title if spec is not None else ""
        what = f"the pass {channel.source}" if channel.source else "nothing: it reads black"
        return "\n".join(filter(None, [f"Fed by {what}", title]))
    return f"Fed by {channel.source}\n{_technique(sketch, channel.source).title}"


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
