"""Listen to the computer's microphone, with sounddevice (PortAudio), an extra."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from threading import Event
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import ContextError
from playground.extras import needs
from playground.media.analysis import SPAN
from playground.media.device import Device
from playground.media.sound import RATE


@dataclass(frozen=True, eq=False)
class Heard:
    """What was heard up to a moment."""

    number: int  # samples since the beginning
    samples: NDArray[np.float32] = field(repr=False)  # (1, SPAN), the latest last


def microphone(number: int = 0, library: Callable[[], Any] | None = None) -> Device:
    """Return the default microphone, which delivers ``Heard``; there is one only, number 0.

    ``library`` returns what has the ``InputStream`` of sounddevice.
    """
    return Device(partial(_listen, library or _sounddevice))


def _listen(library: Callable[[], Any], deliver: Callable[[Heard], None], stop: Event) -> None:
    recent, count = np.zeros((1, SPAN), np.float32), 0

    def take(data: NDArray[np.float32], frames: int, time: object, status: object) -> None:
        nonlocal recent, count
        mixed = np.asarray(data, np.float32).reshape(frames, -1).mean(axis=1)
        recent = np.concatenate([recent, mixed[None]], axis=1)[:, -SPAN:]
        count += frames
        deliver(Heard(count, recent))

    with library().InputStream(samplerate=RATE, channels=1, dtype="float32", callback=take):
        stop.wait()


def _sounddevice() -> Any:
    try:
        import sounddevice
    except ImportError:
        raise ContextError(needs("a microphone", "sounddevice", "microphone")) from None
    return sounddevice
