"""Address parameters as OSC does: ``/light/sun 135 25``, ``/sun/elevation 25``, ``/playground/time 2.5``.

An address is a parameter's path with slashes. A last word may be a part of a vector. Where only one
parameter ends so, the first words may be left out: ``/sun/elevation``. What does not fit is said
once, not at each message.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from playground.errors import ParameterError, PlaygroundError, SketchError, nearest
from playground.shader.parameter import is_whole, part_names, tidied
from playground.sketch.assign import TERRAIN_KEYS, find_targets
from playground.sketch.model import Graph, Parameter, Value
from playground.studio.remote.controls import Controls
from playground.studio.remote.items import items_of, values_of

OWN = "/playground/"
"""What addresses begin with that are no parameter's."""
_REPORTED = 20  # addresses that are named; for more, one message

Message = tuple[str, list[Any]]
"""An address and its arguments."""


def address_of(path: str) -> str:
    """Return a parameter's address."""
    return "/" + path.replace(".", "/")


class Addresses:
    """What messages with an address do to a session, and which messages tell of it."""

    def __init__(self, controls: Controls) -> None:
        self.controls = controls
        self._reported: set[str] = set()  # addresses that did not fit, each until one of it fits
        self._received: dict[str, Value] = {}  # by path: what is not told to who has sent it

    def receive(self, address: str, arguments: Sequence[Any]) -> list[Message]:
        """Do what a message says; return what answers it: a parameter's value, where it has no arguments.

        What does not fit becomes a notice, once for each address.
        """
        try:
            if address.startswith(OWN):
                self._act(address, arguments)
                answer: list[Message] = []
            else:
                answer = self._set(address, arguments)
        except PlaygroundError as error:
            self.report_once(address, f"OSC {address}: {error}")
            return []
        self._reported.discard(address)
        return answer

    def messages_for(self, changed: Mapping[str, Value]) -> list[Message]:
        """Return the messages that tell of new values, but for those that were just received."""
        items = items_of(self.controls.session)
        news = {p: v for p, v in changed.items() if p in items and self._received.pop(p, None) != v}
        return [_message(path, items[path].parameter, value) for path, value in news.items()]

    def everything(self) -> list[Message]:
        """Return the messages that tell of all values."""
        values, items = values_of(self.controls.session), items_of(self.controls.session)
        if values is None:
            return []
        return [_message(path, item.parameter, values.of[path]) for path, item in items.items()]

    def report_once(self, kind: str, sentence: str) -> None:
        """Show a notice, unless one of its kind was shown, or too many."""
        if kind in self._reported or len(self._reported) > _REPORTED:
            return
        if len(self._reported) == _REPORTED:
            sentence = "OSC: further messages that fit nothing are ignored without a notice"
        self._reported.add(kind)
        self.controls.bench.notices.say(sentence)

    def find(self, address: str) -> tuple[str, int | None]:
        """Return the path of a parameter by its address, and which part of it, None for all of it.

        Raises ``ParameterError`` with the nearest address, or with those that it could be.
        """
        graph, name = self._graph, address.strip("/").replace("/", ".")
        if name in TERRAIN_KEYS or find_targets(graph, name):
            return name, None
        head, _, last = name.rpartition(".")
        for target in find_targets(graph, head)[:1] if head else ():
            if last in part_names(target.parameter):
                return head, part_names(target.parameter).index(last)
        addresses: dict[str, tuple[str, int | None]] = {}
        items = items_of(self.controls.session)
        for path, item in items.items():
            if path.endswith(f".{name}"):
                addresses[address_of(path)] = path, None
            elif head and path.endswith(f".{head}") and last in part_names(item.parameter):
                addresses[f"{address_of(path)}/{last}"] = path, part_names(item.parameter).index(last)
        if len(addresses) > 1:
            raise ParameterError(f"it may be {' or '.join(addresses)}; write one of them")
        if addresses:
            return next(iter(addresses.values()))
        every = [address_of(path) for path in items]
        every += [
            f"{address_of(p)}/{part}" for p, item in items.items() for part in part_names(item.parameter)
        ]
        raise ParameterError(f"no parameter has this address{nearest(address, every)}")

    @property
    def _graph(self) -> Graph:
        draft = self.controls.session.shown
        if draft is None:
            raise SketchError("no sketch is shown yet")
        return draft.base.graph

    def _act(self, address: str, arguments: Sequence[Any]) -> None:
        """Do what is no parameter's: time, presets, undo."""
        name, argument = address.removeprefix(OWN), arguments[0] if arguments else True
        names = [name for name in self.controls.names if name not in ("set", "reset")]
        if name not in names:
            raise ParameterError(f"no such address{nearest(address, [OWN + name for name in names])}")
        is_number = isinstance(argument, int | float)
        if name in ("undo", "redo") and not argument:
            return  # the button is let go
        if name == "playing" and is_number:
            argument = bool(argument)
        sketch = self.controls.session.sketch
        presets = sketch.presets if sketch is not None else ()
        if name == "preset" and is_number and 0 <= argument < len(presets):
            argument = presets[int(argument)].name
        self.controls.do({name: tidied(argument) if isinstance(argument, float) else argument})

    def _set(self, address: str, arguments: Sequence[Any]) -> list[Message]:
        path, part = self.find(address)
        if path in TERRAIN_KEYS:
            self.controls.set({path: [_plain(argument) for argument in arguments]})
            return []
        parameter = find_targets(self._graph, path)[0].parameter
        if not arguments:
            return [_message(path, parameter, self.controls.value(path))]
        numbers_given = _given(parameter, arguments)
        if part is not None:
            value = self.controls.value(path)
            numbers: list[Any] = list(value) if isinstance(value, tuple) else [value]
            if len(arguments) != 1:
                raise ParameterError(f"expected one number, found {len(arguments)} arguments")
            numbers[part] = numbers_given
            numbers_given = numbers
        self.controls.set({path: numbers_given})
        self._received[path] = self.controls.value(path)
        return []


def _given(parameter: Parameter, arguments: Sequence[Any]) -> Any:
    """Return arguments as ``--set`` takes a value of a parameter."""
    if parameter.type == "bool" and len(arguments) == 1 and isinstance(arguments[0], int | float):
        return bool(arguments[0])
    if parameter.widget.kind == "colour" and len(arguments) == 1 and type(arguments[0]) is int:
        return f"#{arguments[0] >> 8 & 0xFFFFFF:06x}"  # OSC's own type of colours: 8 bits each of r, g, b, a
    names = [_plain(argument) for argument in arguments]
    if is_whole(parameter.type) and parameter.widget.kind != "menu":
        names = [
            round(argument) if isinstance(argument, float) and abs(argument) < 2**31 else argument
            for argument in names
        ]
    return names[0] if len(names) == 1 else names


def _plain(argument: Any) -> Any:
    """Return an argument; a number in the fewest digits that say it, as OSC has single precision."""
    return tidied(argument) if isinstance(argument, float) else argument


def _message(path: str, parameter: Parameter, value: Value) -> Message:
    """Return the message that tells of a value: numbers, a menu's choice by name, 1 or 0 for a checkbox."""
    if parameter.widget.kind == "menu" and isinstance(value, int):
        return address_of(path), [parameter.widget.choices[value]]
    if isinstance(value, bool):
        return address_of(path), [int(value)]
    numbers = list(value) if isinstance(value, tuple) else [value]
    return address_of(path), numbers
