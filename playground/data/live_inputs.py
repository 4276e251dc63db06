"""What only a window has: a keyboard, a microphone, cameras; and the time."""

from __future__ import annotations

import sys
from collections.abc import Callable, Collection
from dataclasses import dataclass, field
from functools import partial
from threading import Event, Thread
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from playground.data.media import RATE, SPAN, pyav
from playground.errors import ContextError, PlaygroundError
from playground.extras import needs
from playground.files import reason

_PATIENCE = 2.0  # [s] that a device may take to stop


class Device:
    """Something that is opened and listened to; ``listen`` runs until it ends or is stopped.

    ``listen(deliver, stop)`` calls ``deliver(something)`` whenever something came. What it raises is the
    ``problem``: why nothing comes any more.
    """

    def __init__(self, listen: Callable[[Callable[[Any], None], Event], None]) -> None:
        self.problem = ""
        self.now: Any = None  # what a frame takes; None: nothing came yet
        self._came: Any = None
        self._known = ""  # the problem when the last frame began
        self._stop = Event()
        self._thread = Thread(target=self._run, args=(listen,), daemon=True)
        self._thread.start()

    def latch(self) -> bool:
        """Begin a frame: take what came; return whether it, or the problem, is new."""
        before, self.now = (self.now, self._known), self._came
        self._known = self.problem
        return self.now is not before[0] or self._known != before[1]

    def close(self) -> None:
        """Stop it."""
        self._stop.set()
        self._thread.join(_PATIENCE)

    def _run(self, listen: Callable[[Callable[[Any], None], Event], None]) -> None:
        try:
            listen(self._deliver, self._stop)
            if not self._stop.is_set():
                self.problem = "it ended"
        except PlaygroundError as error:
            self.problem = error.diagnostics[0].message
        except Exception as error:  # libraries of devices raise what they like
            self.problem = reason(error)

    def _deliver(self, something: Any) -> None:
        self._came = something


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


KEYS = 256
"""Columns of the keyboard's texture: a key's code in JavaScript."""

MICROPHONE, CAMERA = "microphone", "camera"
_UNUSED = 120  # frames after which a device that nothing asked for is closed


class KeysNow(NamedTuple):
    """The keys of one frame, by their codes in JavaScript, in order."""

    down: tuple[int, ...] = ()
    pressed: tuple[int, ...] = ()  # in this very frame
    toggled: tuple[int, ...] = ()  # pressed an odd number of times

    def texels(self) -> NDArray[np.uint8]:
        """Return (3, 256) bytes: what is down, what was pressed, what is toggled; 255 or 0."""
        texels = np.zeros((3, KEYS), np.uint8)
        for row, codes in enumerate(self):
            texels[row, list(codes)] = 255
        return texels


class Keyboard:
    """The keys that a picture gets, frame by frame."""

    def __init__(self) -> None:
        self.now = KeysNow()

    def hold(self, codes: Collection[int]) -> bool:
        """Begin a frame in which these keys are down; return whether anything differs from the last one."""
        before = self.now
        down = {code for code in codes if 0 <= code < KEYS}
        pressed = down - set(before.down)
        toggled = set(before.toggled) ^ pressed
        self.now = KeysNow(tuple(sorted(down)), tuple(sorted(pressed)), tuple(sorted(toggled)))
        return self.now != before


@dataclass
class LiveInputs:
    """The live inputs of one engine; what has a window feeds them.

    A device is opened when a picture asks for it, and closed when none did for two seconds.
    """

    keyboard: Keyboard = field(default_factory=Keyboard)
    is_live: bool = False  # there is a window, so that devices may be opened
    makers: dict[str, Callable[[int], Device]] = field(
        default_factory=lambda: {MICROPHONE: microphone, CAMERA: camera}
    )
    _devices: dict[tuple[str, int], Device] = field(default_factory=dict)
    _unused: dict[tuple[str, int], int] = field(default_factory=dict)  # frames since it was asked for

    def device(self, kind: str, number: int = 0) -> Device | None:
        """Return a device, opened if it was not; None without a window."""
        if not self.is_live:
            return None
        key = kind, number
        if key not in self._devices:
            self._devices[key] = self.makers[kind](number)
        self._unused[key] = 0
        return self._devices[key]

    def problem(self, kind: str, number: int = 0) -> str:
        """Return why nothing comes from a device, "" where something may."""
        if not self.is_live:
            return f"a {kind} is for the window only"
        device = self._devices.get((kind, number))
        return f"the {kind} gives nothing: {device.problem}" if device and device.problem else ""

    def begin_frame(self) -> bool:
        """Take what the devices delivered; return whether anything is new."""
        for key in [key for key, frames in self._unused.items() if frames >= _UNUSED]:
            self._devices.pop(key).close()
            del self._unused[key]
        self._unused = {key: frames + 1 for key, frames in self._unused.items()}
        return any([device.latch() for device in self._devices.values()])

    def close(self) -> None:
        """Close every device."""
        for device in self._devices.values():
            device.close()
        self._devices.clear()
        self._unused.clear()


@dataclass(frozen=True)
class Now:
    """The moment that a picture shows."""

    time: float = 0.0  # [s]
    inputs: LiveInputs = field(default_factory=LiveInputs)
