"""Write down what the processor makes: the texels of sources as they are for one moment."""

from __future__ import annotations

from typing import Any

from playground.engine.plan import Step
from playground.gpu.textures import texels_in
from playground.media.live_inputs import LiveInputs
from playground.media.now import Now
from playground.terrain.sources import source_kind
from playground.web.blobs import Blobs


def source_data(step: Step, time: float, blobs: Blobs) -> list[dict[str, Any]]:
    """Return the texels of a source at a time in seconds: see ``DataTexture`` in schema.js.

    What a window feeds has nothing to show. Raises ``DataError`` for a file that cannot be read.
    """
    kind = source_kind(step.kernel.registry)
    moment = kind.moment(step.values, Now(time, LiveInputs())) if kind.moment else None
    arrays = kind.make(step.values, step.size, moment)
    return [
        {
            "output": output.name,
            "format": output.format,
            "size": list(step.size),
            "blob": blobs.add(texels_in(output.format, arrays[output.name])),
        }
        for output in step.kernel.outputs
    ]
