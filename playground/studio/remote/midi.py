"""Receive from every MIDI device that is connected; a thread asks them some hundred times a second.

Of each control the last position is kept until the window takes it; notes are kept one by one. Devices
that are connected later are found within some seconds.
"""

from __future__ import annotations

import importlib.util
import os
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import Any

import mido

from playground.errors import ContextError
from playground.extras import needs
from playground.studio.remote.controllers import Move, Source

MAX_WAITING = 1024
"""Notes that may wait for the window."""
_EVERY = 0.004  # [s] between questions to the devices
SCAN_INTERVAL = 3.0  # [s] between looks for new devices
_DEFAULT, _FALLBACK = "rtmidi", "pygame"  # what mido receives by


class Midi:
    """All devices, from ``open`` to ``close``."""

    def __init__(self, wake: Callable[[], None]) -> None:
        self._wake = wake
        self._ports: dict[str, Any] = {}
        self._lock, self._connecting = threading.Lock(), threading.Lock()
        self._controls: dict[Source, int] = {}
        self._notes: list[Move] = []
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._run, name="receives MIDI", daemon=True)

    @property
    def waits(self) -> bool:
        """Whether there is something to ``take``."""
        return bool(self._controls or self._notes)

    @property
    def devices(self) -> list[str]:
        """The devices that are listened to."""
        return list(self._ports)

    def open(self) -> None:
        """Listen to what is connected; raise ``ContextError`` where nothing is, or nothing can be heard."""
        try:
            _choose_backend()
            self._connect()
        except ImportError:
            raise ContextError(needs("MIDI", "python-rtmidi or pygame-ce", "midi")) from None
        except Exception as error:  # each backend has its own
            raise ContextError(f"MIDI cannot be received here: {' '.join(str(error).split())}") from None
        if not self._thread.is_alive():
            self._thread.start()
        if not self._ports:
            raise ContextError("MIDI: no device is connected; one that is connected later will be found")

    def take(self) -> list[Move]:
        """Return what was moved since the last time: each note, and of each control the last position."""
        with self._lock:
            controls, self._controls = self._controls, {}
            notes, self._notes = self._notes, []
        return [*notes, *controls.items()]

    def close(self) -> None:
        """Listen no more."""
        self._ended.set()
        if self._thread.is_alive():
            self._thread.join(2)
        for port in list(self._ports.values()):  # the thread may be opening another
            port.close()
        self._ports = {}

    def _connect(self) -> None:
        """Open devices that are new, and close those that are gone."""
        with self._connecting:
            names = list(dict.fromkeys(mido.get_input_names()))
            for name in [name for name in self._ports if name not in names]:
                self._ports.pop(name).close()
            for name in names:
                if name not in self._ports:
                    with suppress(OSError):  # another program has it
                        self._ports[name] = mido.open_input(name)

    def _run(self) -> None:
        looked = time.monotonic()
        while not self._ended.wait(_EVERY):
            try:
                if time.monotonic() - looked > SCAN_INTERVAL:
                    looked = time.monotonic()
                    self._connect()
                for port in list(self._ports.values()):
                    for message in port.iter_pending():
                        self._put(message)
            except Exception:  # a device that was pulled out; the next look closes it
                continue

    def _put(self, message: Any) -> None:
        with self._lock:
            first = not self.waits
            if message.type == "control_change":
                source = Source(message.channel + 1, "control", message.control)
                self._controls.pop(source, None)
                self._controls[source] = message.value
            elif message.type in ("note_on", "note_off") and len(self._notes) < MAX_WAITING:
                strength = message.velocity if message.type == "note_on" else 0
                self._notes.append((Source(message.channel + 1, "note", message.note), strength))
            first = first and self.waits
        if first:
            self._wake()


def _choose_backend() -> None:
    """Let mido receive by pygame where rtmidi is missing, unless another was chosen."""
    is_usual = mido.backend.name == "mido.backends.rtmidi"
    if (
        is_usual
        and importlib.util.find_spec(_DEFAULT) is None
        and importlib.util.find_spec(_FALLBACK) is not None
    ):
        os.environ.setdefault("PYGAME_HIDE_SUPPORT_PROMPT", "1")
        mido.set_backend("mido.backends.pygame")
