"""Look through a camera of the computer, with PyAV and what its system has for that."""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from threading import Event
from typing import Any

from playground.errors import ContextError
from playground.media.device import Device
from playground.media.pyav import pyav


@dataclass(frozen=True, eq=False)
class Seen:
    """A picture of a camera."""

    number: int  # pictures since the beginning
    frame: Any = field(repr=False)  # PyAV's


def camera(number: int, opened: Callable[[Any, int], Any] | None = None) -> Device:
    """Return a camera, the first is 0, which delivers ``Seen``.

    ``opened(av, number)`` returns a container of PyAV whose first stream of pictures is the camera's.
    """
    return Device(partial(_look, opened or _opened, number))


def _look(
    opened: Callable[[Any, int], Any], number: int, deliver: Callable[[Seen], None], stop: Event
) -> None:
    with opened(pyav("a camera"), number) as container:
        for count, frame in enumerate(container.decode(video=0), 1):
            if stop.is_set():
                return
            deliver(Seen(count, frame.reformat(format="rgba")))  # a copy: drivers want their buffers back


def _opened(av: Any, number: int) -> Any:
    if sys.platform == "darwin":
        return av.open(str(number), format="avfoundation", options={"framerate": "30"})
    if sys.platform == "win32":
        names = [d.name for d in av.enumerate_input_devices("dshow") if "video" in d.media_types]
        if number >= len(names):
            raise ContextError(f"there is no camera {number}; there are {len(names)}")
        return av.open(f"video={names[number]}", format="dshow")
    return av.open(f"/dev/video{number}", format="v4l2")
