"""OSC by UDP: messages come in at a port, new values go out to another.

A thread receives; of each address it keeps the last message until the window takes them, so
that a flood grows nothing. Bundles are done as they come: their time is not waited for.

Parameters have addresses: ``/light/sun 135 25``, ``/sun/elevation 25``, ``/playground/time 2.5``. An address
is a parameter's path with slashes. A last word may be a part of a vector. Where only one parameter ends so,
the first words may be left out: ``/sun/elevation``. What does not fit is said once, not at each message.
"""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.osc_packet import OscPacket

from playground.errors import DataError, ParameterError, PlaygroundError, SketchError, nearest
from playground.shader.parameter import is_whole, part_names, tidied
from playground.sketch.assign import TERRAIN_KEYS, find_targets
from playground.sketch.model import Graph, Parameter, Value
from playground.studio.language import tr
from playground.studio.panel.parameter_list import items_of, shown_values
from playground.studio.remote.controls import Controls

# ── addresses ─────────────────────────────────────────────────────────────────


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
        items = items_of(self.controls.session.shown)
        news = {p: v for p, v in changed.items() if p in items and self._received.pop(p, None) != v}
        return [_message(path, items[path].parameter, value) for path, value in news.items()]

    def everything(self) -> list[Message]:
        """Return the messages that tell of all values."""
        draft = self.controls.session.shown
        values = shown_values(draft).of if draft is not None else {}
        return [_message(path, item.parameter, values[path]) for path, item in items_of(draft).items()]

    def report_once(self, kind: str, message: str) -> None:
        """Show a notice, unless one of its kind was shown, or too many."""
        if kind in self._reported or len(self._reported) > _REPORTED:
            return
        if len(self._reported) == _REPORTED:
            message = tr("OSC: further messages that fit nothing are ignored without a notice")
        self._reported.add(kind)
        self.controls.bench.notices.say(message)

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
        items = items_of(self.controls.session.shown)
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
            self.controls.set({path: [_tidy(argument) for argument in arguments]})
            return []
        parameter = find_targets(self._graph, path)[0].parameter
        if not arguments:
            return [_message(path, parameter, self.controls.value(path))]
        new_value = _value_of(parameter, arguments)
        if part is not None:
            value = self.controls.value(path)
            numbers: list[Any] = list(value) if isinstance(value, tuple) else [value]
            if len(arguments) != 1:
                raise ParameterError(f"expected one number, found {len(arguments)} arguments")
            numbers[part] = new_value
            new_value = numbers
        self.controls.set({path: new_value})
        self._received[path] = self.controls.value(path)
        return []


def _value_of(parameter: Parameter, arguments: Sequence[Any]) -> Any:
    """Return arguments as ``--set`` takes a value of a parameter."""
    if parameter.type == "bool" and len(arguments) == 1 and isinstance(arguments[0], int | float):
        return bool(arguments[0])
    if parameter.widget.kind == "colour" and len(arguments) == 1 and type(arguments[0]) is int:
        return f"#{arguments[0] >> 8 & 0xFFFFFF:06x}"  # OSC's own type of colours: 8 bits each of r, g, b, a
    names = [_tidy(argument) for argument in arguments]
    if is_whole(parameter.type) and parameter.widget.kind != "menu":
        names = [
            round(argument) if isinstance(argument, float) and abs(argument) < 2**31 else argument
            for argument in names
        ]
    return names[0] if len(names) == 1 else names


def _tidy(argument: Any) -> Any:
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


# ── sockets ───────────────────────────────────────────────────────────────────


MAX_WAITING = 1024
"""Addresses that may wait for the window, and as many messages that are no parameter's."""
_MAX_BYTES = 2**16  # [bytes] no datagram is larger
_OWN = OWN.encode()

Address = tuple[str, int]
Datagram = bytes | Message
"""As it came, or a message of a bundle."""


class Osc:
    """The two sockets; ``addresses`` says what messages mean."""

    def __init__(self, source: Address | None, target: Address | None) -> None:
        """Open the sockets; raise ``DataError`` for a port that is taken or a host that is unknown."""
        self._in = _bound(source) if source is not None else None
        self._target = _resolved(target) if target is not None else None
        self._out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM) if self._target else None
        if self._out is not None:
            self._out.setblocking(False)
        self._lock = threading.Lock()
        self._waiting: dict[bytes, Datagram] = {}  # the last of each address
        self._acts: list[Datagram] = []  # undo and its like: each counts
        self._lost = 0  # messages that there was no room for
        self._unread = 0  # datagrams that are no OSC
        self._closed = False
        self._addresses: Addresses | None = None
        self._wake: Callable[[], None] = lambda: None
        self._thread = threading.Thread(target=self._receive, name="receives OSC", daemon=True)

    @property
    def source(self) -> Address | None:
        """Where messages come in."""
        return self._in.getsockname() if self._in is not None else None

    @property
    def waits(self) -> bool:
        """Whether there is something to ``take``."""
        return bool(self._waiting or self._acts or self._unread or self._lost)

    def start(self, addresses: Addresses, wake: Callable[[], None]) -> None:
        """Receive from now on, and tell of every value."""
        self._addresses, self._wake = addresses, wake
        if self._in is not None:
            self._thread.start()
        self.send(addresses.everything())

    def take(self) -> None:
        """Do what has come in. For the window's thread."""
        if self._addresses is None or not self.waits:
            return
        with self._lock:
            waiting, self._waiting = self._waiting, {}
            acts, self._acts = self._acts, []
            lost, unread, self._lost, self._unread = self._lost, self._unread, 0, 0
        for datagram in (*waiting.values(), *acts):
            messages = messages_of(datagram)
            unread += not messages
            for address, arguments in messages:
                self.send(self._addresses.receive(address, arguments))
        if unread:
            self._addresses.report_once("unread", tr("OSC: a packet came in that is no OSC"))
        if lost:
            self._addresses.report_once(
                "lost", tr("OSC: more than {MAX_WAITING} addresses came in at once", MAX_WAITING=MAX_WAITING)
            )

    def tell(self, changed: Mapping[str, Value], *, everything: bool) -> None:
        """Send new values; ``everything`` where the sketch is another now."""
        if self._addresses is not None and self._out is not None:
            messages = self._addresses.messages_for(changed)
            self.send(self._addresses.everything() if everything else messages)

    def send(self, messages: list[Message]) -> None:
        """Send messages, where there is somebody to send them to."""
        if self._out is None or self._target is None:
            return
        for address, arguments in messages:
            builder = OscMessageBuilder(address)
            for argument in arguments:
                builder.add_arg(argument)
            try:
                self._out.sendto(builder.build().dgram, self._target)
            except OSError as error:  # nobody listens, or the buffer is full: the next value says it again
                if self._addresses is not None:
                    to = "{}:{}".format(*self._target)
                    self._addresses.report_once(
                        "out",
                        tr("OSC: nothing can be sent to {to}: {strerror}", to=to, strerror=error.strerror),
                    )

    def close(self) -> None:
        """Close the sockets."""
        self._closed = True
        if self._in is not None:
            if self._thread.is_alive():
                with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own:  # ends its wait
                    host, port = self._in.getsockname()
                    own.sendto(b"", ("127.0.0.1" if host == "0.0.0.0" else host, port))
                self._thread.join(2)
            self._in.close()
        if self._out is not None:
            self._out.close()

    def _receive(self) -> None:
        assert self._in is not None
        while not self._closed:
            try:
                data = self._in.recv(_MAX_BYTES)
            except OSError:  # on Windows also where a packet that was sent found nobody
                continue
            if data:
                self.put(data)

    def put(self, data: bytes) -> None:
        """Keep a datagram; of a single message only its address is read here."""
        end = data.find(b"\0")
        messages: list[tuple[bytes, Datagram]] = [(data[:end], data)]
        if end < 0 or not data.startswith(b"/"):
            messages = [(message[0].encode("utf-8", "replace"), message) for message in messages_of(data)]
        with self._lock:
            first = not self.waits
            self._unread += not messages
            for address, message in messages:
                if address.startswith(_OWN):
                    if len(self._acts) < MAX_WAITING:
                        self._acts.append(message)
                    else:
                        self._lost += 1
                elif address in self._waiting or len(self._waiting) < MAX_WAITING:
                    self._waiting.pop(address, None)  # what came last is done last
                    self._waiting[address] = message
                else:
                    self._lost += 1
        if first:
            self._wake()


def messages_of(data: Datagram) -> list[Message]:
    """Return the messages of a datagram, in the order of their times; none where it is no OSC."""
    if isinstance(data, tuple):
        return [data]
    try:
        return [(timed.message.address, list(timed.message.params)) for timed in OscPacket(data).messages]
    except Exception:  # what the package raises for what is no OSC is of many kinds
        return []


def _bound(source: Address) -> socket.socket:
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    try:
        made.bind(source)
    except (OSError, UnicodeError) as error:
        made.close()
        why = getattr(error, "strerror", None) or error
        raise DataError(f"OSC cannot be received at {source[0]}:{source[1]}: {why}") from None
    return made


def _resolved(target: Address) -> Address:
    try:
        addresses = socket.getaddrinfo(*target, socket.AF_INET, socket.SOCK_DGRAM)
    except (OSError, UnicodeError) as error:
        why = getattr(error, "strerror", None) or error
        raise DataError(f"OSC cannot be sent to {target[0]}:{target[1]}: {why}") from None
    host, port = addresses[0][4][:2]
    return str(host), int(port)
