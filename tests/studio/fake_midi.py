"""A backend of mido: devices that a test plugs in and plays; bytes go through mido's own parser."""

from __future__ import annotations

from collections import Counter
from typing import Any

from mido.ports import BaseInput

DEVICES: dict[str, list[bytes]] = {}  # by name: what is still to be read
TAKEN: set[str] = set()
ASKED: Counter[str] = Counter()  # how often a device was asked while nothing of it was left to be read


def get_devices(**_: Any) -> list[dict[str, Any]]:
    return [{"name": name, "is_input": True, "is_output": False} for name in DEVICES]


class Input(BaseInput):
    """A port of a device."""

    def _open(self, **_: Any) -> None:
        if self.name in TAKEN:
            raise OSError("another program has it")

    def _receive(self, block: bool = True) -> None:
        data = DEVICES[self.name]  # KeyError: it was pulled out
        ASKED[self.name] += not data
        while data:
            self._parser.feed(data.pop(0))
