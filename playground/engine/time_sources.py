"""Sources that change with time: films and sounds, and what a window feeds."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import ceil, floor
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.data import media
from playground.data.live_inputs import CAMERA, KEYS, MICROPHONE, Heard, KeysNow, LiveInputs, Now, Seen
from playground.data.media import RATE, Film, Sound, as_pixels, film_of, sound_of
from playground.engine.source_kinds import number_of, whole_number_of
from playground.shader.expressions import FRAME_RATE
from playground.sketch.model import Value

OUTPUT = "channel_texels"
_EVERYTHING = 2**62  # [samples]
_CHANNEL, _WAVES, _SPECTRUM = range(3)  # the choices of ``content``


def _film(values: Mapping[str, Value]) -> Film:
    return film_of(Path(str(values["video"])))


def size_of_video(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the pixels of a film's frames."""
    return _film(values).size


def moment_of_video(values: Mapping[str, Value], now: Now) -> int:
    """Return which frame of a film is shown, from 0."""
    seconds = number_of(values, "start") + number_of(values, "speed") * now.time
    return _film(values).frame_at(seconds, loop=bool(values["loop"]))


def make_video(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return the frame that ``moment_of_video`` named."""
    return {OUTPUT: _film(values).pixels(moment, size)}


def frames_of_video(
    values: Mapping[str, Value], size: tuple[int, int]
) -> Iterator[tuple[float, Mapping[str, NDArray[np.uint8]]]]:
    """Yield each frame of a film with the second at which it begins, from the film's beginning."""
    film = _film(values)
    for number, time in enumerate(film.times):
        yield time, {OUTPUT: film.pixels(number, size)}


def length_of_video(values: Mapping[str, Value]) -> float:
    """Return the seconds of a film."""
    return _film(values).duration


def _sound(values: Mapping[str, Value]) -> Sound:
    return sound_of(Path(str(values["sound"])))


def size_of_sound(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the texels of what is shown of a sound."""
    return size_of_content(int(values["content"]), _sound(values).channels)  # type: ignore[arg-type]


def size_of_content(content: int, channels: int) -> tuple[int, int]:
    """Return the texels of a choice of ``content``, of a sound of so many channels."""
    width = {_CHANNEL: media.SHOWN, _WAVES: media.WINDOW, _SPECTRUM: media.BINS}[content]
    return width, 2 if content == _CHANNEL else channels


def moment_of_sound(values: Mapping[str, Value], now: Now) -> int:
    """Return the sample that is about to be heard; before the first and long after the last it stays."""
    end = max(floor((number_of(values, "start") + now.time) * RATE + 1e-6), 0)
    length = None if values["loop"] else _sound(values).length(end)
    return end if length is None else min(end, length + media.SPAN)


def make_sound(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return what is shown of a sound before a sample: see ``data.media``."""
    heard = _sound(values).heard(moment, max(media.SPAN, size[0]), loop=bool(values["loop"]))
    return {OUTPUT: shown_of(heard, int(values["content"]), size)}  # type: ignore[arg-type]


def frames_of_sound(
    values: Mapping[str, Value], size: tuple[int, int]
) -> Iterator[tuple[float, Mapping[str, NDArray[np.uint8]]]]:
    """Yield what is shown of a sound, played once, at each sixtieth of a second until it is silent again."""
    once = {**values, "loop": False}
    number, last = 0, None
    while last is None or number <= last:
        end = floor(number / FRAME_RATE * RATE + 1e-6)
        length = _sound(values).length(end)
        last = last if length is None else ceil((length + media.SPAN) / RATE * FRAME_RATE)
        yield number / FRAME_RATE, make_sound(once, size, end)
        number += 1


LEAD = media.SPAN / RATE
"""[s] of a sound in which the silence before it is heard still: from then on each lap is as the next."""


def laps_of_sound(
    values: Mapping[str, Value], size: tuple[int, int]
) -> Iterator[tuple[float, Mapping[str, NDArray[np.uint8]]]]:
    """Yield what is shown of a sound that repeats, as ``frames_of_sound``, from its end on for ``LEAD``."""
    again, length = {**values, "loop": True}, length_of_sound(values)
    for number in range(floor(length * FRAME_RATE + 1e-6), ceil((length + LEAD) * FRAME_RATE) + 1):
        yield number / FRAME_RATE, make_sound(again, size, floor(number / FRAME_RATE * RATE + 1e-6))


def length_of_sound(values: Mapping[str, Value]) -> float:
    """Return the seconds of a sound, all of which is decoded for it."""
    sound = _sound(values)
    sound.decode_until(_EVERYTHING)
    return (sound.length(_EVERYTHING) or 0) / RATE


def shown_of(heard: NDArray[np.float32], content: int, size: tuple[int, int]) -> NDArray[np.uint8]:
    """Return the texels of what was heard, (channels, samples), as a choice of ``content`` shows it."""
    if content == _WAVES:
        return media.waves(heard, size)
    if content == _SPECTRUM:
        return media.spectra(heard, size)
    rows = np.arange(size[1]) * 2 // size[1]
    columns = np.arange(size[0]) * media.SHOWN // size[0]
    return media.channel(heard)[rows[:, None], columns]


def size_of_keys(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the texels of the keyboard's texture."""
    return KEYS, 3


def moment_of_keys(values: Mapping[str, Value], now: Now) -> KeysNow:
    """Return which keys are down, were pressed, are toggled."""
    return now.inputs.keyboard.now


def make_keys(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return the keyboard's texture; at another size each texel is repeated or left out."""
    rows, columns = np.arange(size[1]) * 3 // size[1], np.arange(size[0]) * KEYS // size[0]
    return {OUTPUT: (moment or KeysNow()).texels()[rows[:, None], columns]}


def size_of_microphone(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the texels of what is shown of a microphone."""
    return size_of_content(whole_number_of(values, "content"), 1)


def moment_of_microphone(values: Mapping[str, Value], now: Now) -> Heard | None:
    """Return what was heard; None for nothing."""
    device = now.inputs.device(MICROPHONE)
    return device.now if device else None


def make_microphone(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return what is shown of a microphone; of nothing, silence."""
    heard = moment.samples if moment else np.zeros((1, media.SPAN), np.float32)
    return {OUTPUT: shown_of(heard, whole_number_of(values, "content"), size)}


def lack_of_microphone(values: Mapping[str, Value], inputs: LiveInputs) -> str:
    """Return why it is silent, if it is."""
    problem = inputs.problem(MICROPHONE)
    return f"{problem}; it is silent here" if problem else ""


def size_of_camera(values: Mapping[str, Value]) -> tuple[int, int]:
    """Return the texels of a camera's picture."""
    return 640, 480


def moment_of_camera(values: Mapping[str, Value], now: Now) -> Seen | None:
    """Return the camera's picture; None for none."""
    device = now.inputs.device(CAMERA, whole_number_of(values, "device"))
    return device.now if device else None


def make_camera(
    values: Mapping[str, Value], size: tuple[int, int], moment: Any = None
) -> dict[str, NDArray[np.uint8]]:
    """Return the camera's picture; of none, black."""
    if moment is None:
        black = np.zeros((size[1], size[0], 4), np.uint8)
        black[..., 3] = 255
        return {OUTPUT: black}
    pixels = as_pixels(moment.frame, size)
    return {OUTPUT: pixels[:, ::-1] if values["mirror"] else pixels}


def lack_of_camera(values: Mapping[str, Value], inputs: LiveInputs) -> str:
    """Return why it is black, if it is."""
    problem = inputs.problem(CAMERA, whole_number_of(values, "device"))
    return f"{problem}; it is black here" if problem else ""
