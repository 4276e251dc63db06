"""The remotes of one window, together: opened before it, asked before each of its frames, told after."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import TracebackType
from typing import TYPE_CHECKING, TypeVar

from playground.errors import ContextError, PlaygroundError
from playground.extras import needs
from playground.local_server import check_token, new_token
from playground.studio.bench import Workbench
from playground.studio.remote.controls import Calls, Changes, Controls

if TYPE_CHECKING:
    from playground.studio.remote.midi import Midi
    from playground.studio.remote.osc import Osc
    from playground.studio.remote.server import Server

Opened = TypeVar("Opened")

Address = tuple[str, int]
"""Host and port."""


@dataclass(frozen=True)
class RemoteOptions:
    """What is to be opened; None: not."""

    port: int | None = None  # of HTTP and WebSocket, on 127.0.0.1; 0: a free one
    token: str = ""  # "": a random one
    osc: Address | None = None  # where OSC comes in
    osc_to: Address | None = None  # where values go


class Remotes:
    """Use it with ``with``: what it opens is closed at the end."""

    def __init__(self, options: RemoteOptions = RemoteOptions()) -> None:
        """Open the ports.

        Raises ``ContextError`` for an extra that is missing, ``DataError`` for a port that is taken.
        """
        self.server: Server | None = None
        self.osc: Osc | None = None
        self.calls = Calls()
        self.midi: Midi | None = None  # once something is to be received
        self._controls: Controls | None = None
        self._listened: object = None  # the bindings for which devices were asked for
        if options.port is not None:
            self.server = _server(options.port, check_token(options.token) if options.token else new_token())
        if options.osc is not None or options.osc_to is not None:
            self.osc = self._closing(lambda: _osc(options.osc, options.osc_to))

    def __enter__(self) -> Remotes:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def sentences(self) -> list[str]:
        """Where it can be reached, for the terminal."""
        addresses = [f"remote: {self.server.url}"] if self.server is not None else []
        if self.osc is not None and self.osc.source is not None:
            addresses.append("OSC: received at {}:{}".format(*self.osc.source))
        return addresses

    @property
    def waits(self) -> bool:
        """Whether there is something to ``take``."""
        asked = len(self.calls) > 0 or (self.osc is not None and self.osc.waits)
        return asked or (self.midi is not None and self.midi.waits) or self._settles

    def attach(self, bench: Workbench, wake: Callable[[], None]) -> None:
        """Drive a session from now on; ``wake`` ends the window's sleep, from any thread."""
        self.calls.wake = wake
        self._controls, self._changes = Controls(bench), Changes(bench)
        self._controllers = bench.controllers
        bench.controllers.listen, self._say = self._listen, bench.notices.say
        if self.server is not None:
            self.server.start(self.calls, self._controls)
        if self.osc is not None:
            from playground.studio.remote.osc import Addresses

            self.osc.start(Addresses(self._controls), wake)

    def take(self) -> None:
        """Do what was asked since the last frame."""
        if self._controls is not None:
            self.calls.run()
            if self.osc is not None:
                self.osc.take()
            self._controls.flush()
            self._take_moves()

    def tell(self) -> None:
        """Tell those who listen what has changed."""
        if self._controls is None or (self.server is None and self.osc is None):
            return
        events = self._changes.look()
        if self.server is not None:
            self.server.tell(events)
        if self.osc is not None:
            is_new = any(event["event"] == "sketch" for event in events)
            self.osc.tell(self._changes.changed if self._changes.started else {}, everything=is_new)

    def close(self) -> None:
        """Close everything; requests that wait are refused."""
        self.calls.close()
        if self.server is not None:
            self.server.close()
        if self.osc is not None:
            self.osc.close()
        if self.midi is not None:
            self.midi.close()

    @property
    def _settles(self) -> bool:
        return self._controls is not None and self._controllers.settles

    def _take_moves(self) -> None:
        """Have MIDI controllers set what they are bound to; the first binding opens the devices."""
        controllers = self._controllers
        if controllers.bindings and controllers.bindings is not self._listened:
            self._listened = controllers.bindings
            if self.midi is None and (why := self._listen()):
                self._say(why)
        if self.midi is not None:
            controllers.take(self.midi.take())
        controllers.update()

    def _listen(self) -> str:
        """Receive from MIDI devices; return why that cannot be done, or ""."""
        try:
            if self.midi is None:
                self.midi = _midi(self.calls.wake)
            self.midi.open()
        except PlaygroundError as error:
            return str(error)
        return ""

    def _closing(self, opened: Callable[[], Opened]) -> Opened:
        """Open another remote; where that fails, close those that are open."""
        try:
            return opened()
        except BaseException:
            self.close()
            raise


def _midi(wake: Callable[[], None]) -> Midi:
    try:
        from playground.studio.remote.midi import Midi
    except ImportError:
        raise ContextError(needs("MIDI", "mido", "midi")) from None
    return Midi(wake)


def _osc(source: Address | None, target: Address | None) -> Osc:
    try:
        from playground.studio.remote.osc import Osc
    except ImportError:
        raise ContextError(needs("OSC", "python-osc", "osc")) from None
    return Osc(source, target)


def _server(port: int, token: str) -> Server:
    try:
        from playground.studio.remote.server import Server
    except ImportError:
        raise ContextError(needs("the remote", "aiohttp", "remote")) from None
    return Server(port, token)
