"""Write down what the processor makes: the texels of sources, of a film or a sound frame by frame.

A file that is played is written from its beginning as far as that fits into ``MAX_SOURCE_BYTES`` of a page
and ``MAX_SECONDS`` seconds; what comes later stays as the last frame is. Of a sound that repeats, a page has
also what is heard of its end in the next lap. What a window feeds has nothing to show in a page.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from numpy.typing import NDArray

from playground.data.live_inputs import LiveInputs, Now
from playground.engine.plan import Step
from playground.engine.source_kinds import Recording
from playground.engine.sources import source_kind
from playground.engine.textures import texels_in
from playground.publish.web.blobs import Blobs

MAX_SOURCE_BYTES = 3 * 2**20
"""Bytes of a page that the frames of one source may take."""
MAX_SECONDS = 10.0
"""[s] of a file that is played that a page has at most."""


@dataclass(frozen=True)
class SourceData:
    """What a page has of a source."""

    textures: list[dict[str, Any]]  # see ``DataTexture`` in schema.js
    note: str  # a message on what that is


def source_data(
    step: Step, what: str, blobs: Blobs, drawn: Callable[[], Mapping[str, NDArray[Any]]]
) -> SourceData:
    """Return the texels of a source; ``what`` it makes, as text.

    ``drawn`` gives the texels of one that has inputs. Raises ``DataError`` for a file that cannot be read.
    """
    kind = source_kind(step.kernel.registry)
    if kind.recording is not None:
        return _recorded(kind.recording, step, what, blobs)
    if kind.make is None:
        return SourceData(_textures(step, drawn(), blobs), f"{step.path}: {what} is exported as it is")
    moment = kind.moment(step.values, Now(0.0, LiveInputs())) if kind.moment else None
    textures = _textures(step, kind.make(step.values, step.size, moment), blobs)
    if kind.moment is not None:
        return SourceData(textures, f"{step.path}: {what} feeds nothing in a page")
    return SourceData(textures, f"{step.path}: {what} is exported as it is")


def _recorded(recording: Recording, step: Step, what: str, blobs: Blobs) -> SourceData:
    sources: list[dict[str, Any]] = []
    times: list[float] = []
    length, limit = recording.length(step.values), blobs.size + MAX_SOURCE_BYTES
    for time, arrays in recording.frames(step.values, step.size):
        if times and (blobs.size >= limit or time > MAX_SECONDS):
            note = f"{step.path}: of {what}, {length:.3g} s long, the page has the first {time:.3g} s"
            break
        now = _textures(step, arrays, blobs)
        sources = sources or [entry | {"times": times, "frames": [], "length": length} for entry in now]
        times.append(time)
        for entry, other in zip(sources, now, strict=True):
            entry["frames"].append(other["blob"])
    else:
        note = f"{step.path}: {what} is exported as it is, {length:.3g} s"
    if recording.laps is not None:
        _add_laps(sources, recording, step, blobs)
    return SourceData(sources, note)


def _add_laps(sources: list[dict[str, Any]], recording: Recording, step: Step, blobs: Blobs) -> None:
    """Add to each texture what shows from the end of a file on that repeats."""
    assert recording.laps is not None
    times: list[float] = []
    for entry in sources:
        entry["laps"] = {"lead": recording.lead, "times": times, "frames": []}
    for time, arrays in recording.laps(step.values, step.size):
        times.append(time)
        for entry, other in zip(sources, _textures(step, arrays, blobs), strict=True):
            entry["laps"]["frames"].append(other["blob"])


def _textures(step: Step, arrays: Mapping[str, NDArray[Any]], blobs: Blobs) -> list[dict[str, Any]]:
    return [
        {
            "output": output.name,
            "format": output.format,
            "size": list(step.size),
            "blob": blobs.add(texels_in(output.format, arrays[output.name])),
        }
        for output in step.kernel.outputs
    ]
