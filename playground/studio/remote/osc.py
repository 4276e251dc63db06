"""OSC by UDP: messages come in at a port, new values go out to another.

A thread receives; of each address it keeps the last message until the window takes them, so
that a flood grows nothing. Bundles are done as they come: their time is not waited for.
"""

from __future__ import annotations

import socket
import threading
from collections.abc import Callable, Mapping

from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.osc_packet import OscPacket

from playground.errors import DataError
from playground.sketch.model import Value
from playground.studio.remote.addresses import OWN, Addresses, Message

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
            self._addresses.report_once("unread", "OSC: a packet came in that is no OSC")
        if lost:
            self._addresses.report_once("lost", f"OSC: more than {MAX_WAITING} addresses came in at once")

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
                    self._addresses.report_once("out", f"OSC: nothing can be sent to {to}: {error.strerror}")

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
                self._put(data)

    def _put(self, data: bytes) -> None:
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
