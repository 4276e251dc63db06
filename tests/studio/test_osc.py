"""OSC over a real UDP loopback: values by address, what does not fit, values out."""

from __future__ import annotations

import socket
import struct
import time
from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest
from pythonosc.osc_bundle_builder import IMMEDIATELY, OscBundleBuilder
from pythonosc.osc_message_builder import OscMessageBuilder
from pythonosc.osc_packet import OscPacket
from pythonosc.udp_client import SimpleUDPClient

from playground import cli
from playground.errors import ContextError, DataError
from playground.extras import install_command
from playground.studio.remote.osc import MAX_WAITING, Osc
from playground.studio.remote.remotes import RemoteOptions, Remotes

from .remote_desk import Harness


class Surface:
    """A control surface: it sends, and hears what is sent to it."""

    def __init__(self, remote: Harness) -> None:
        self.remote = remote
        self.ear = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.ear.bind(("127.0.0.1", 0))
        self.ear.setblocking(False)
        osc = remote.open(osc=("127.0.0.1", 0), osc_to=self.ear.getsockname()).osc
        assert osc is not None and osc.source is not None
        self.client = SimpleUDPClient(*osc.source)
        self.greeting = self.heard()

    def send(self, address: str, *arguments: Any) -> None:
        """Send a message, and wait until the window has done it."""
        self.client.send_message(address, list(arguments))
        self.taken()

    def raw(self, data: bytes) -> None:
        osc = self.remote.remotes.osc
        assert osc is not None and osc.source is not None
        self.ear.sendto(data, osc.source)

    def taken(self) -> None:
        osc = self.remote.remotes.osc
        end = time.monotonic() + 10
        while not osc.waits:
            assert time.monotonic() < end
            time.sleep(0.001)
        self.remote.frame()
        self.remote.frame()

    def heard(self) -> dict[str, list[Any]]:
        """Return what was sent to it since the last time: the last arguments by address."""
        time.sleep(0.05)
        values = {}
        while True:
            try:
                packet = OscPacket(self.ear.recv(65536))
            except BlockingIOError:
                return values
            values |= {timed.message.address: timed.message.params for timed in packet.messages}

    def close(self) -> None:
        self.ear.close()
        self.client.close()


@pytest.fixture
def surface(remote: Harness) -> Iterator[Surface]:
    made = Surface(remote)
    yield made
    made.close()


def test_values_come_in_by_address(remote: Harness, surface: Surface):
    surface.send("/height/level", 0.5)
    assert remote.value("height.level") == 0.5
    surface.send("/height/level", 0.3)
    assert remote.value("height.level") == 0.3, "not 0.30000001192092896"
    surface.send("/height/sun", 200.0, 40.0)
    assert remote.value("height.sun") == (200.0, 40.0)
    surface.send("/height/sun/elevation", 25)
    assert remote.value("height.sun") == (200.0, 25.0)
    surface.send("/sun/azimuth", 90)
    assert remote.value("height.sun") == (90.0, 25.0), "the pass may be left out"
    surface.send("/height/kind", "flat")
    assert remote.value("height.kind") == 2
    surface.send("/height/kind", 1)
    assert remote.value("height.kind") == 1
    surface.send("/height/rocks", False)
    assert remote.value("height.rocks") is False
    surface.send("/height/rocks", 1.0)
    assert remote.value("height.rocks") is True
    surface.send("/height/count", 6.7)
    assert remote.value("height.count") == 7, "a fader sends fractions"
    surface.send("/height/tint", "#00ff00")
    assert remote.value("height.tint") == (0.0, 1.0, 0.0)
    surface.send("/height/tint/b", 0.25)
    assert remote.value("height.tint") == (0.0, 1.0, 0.25)
    surface.send("/height/middle", 0.25, 0.75)
    assert remote.value("height.middle") == (0.25, 0.75)
    surface.send("/relief", 300.0)
    assert remote.session.sketch is not None and remote.session.sketch.terrain.relief == 300.0
    assert remote.notices == []


def test_a_button_is_pressed_where_its_message_is_no_zero(remote: Harness, surface: Surface):
    pressed = remote.pressed()
    surface.send("/height/fire", 1)
    surface.send("/height/fire", 0)
    surface.send("/height/fire", True)
    assert pressed == ["height.fire"] * 2 and remote.value("height.fire") is False


def test_a_colour_of_osc_itself(remote: Harness, surface: Surface):
    builder = OscMessageBuilder("/height/tint")
    builder.add_arg(0xFF000080, "r")  # red, half opaque
    surface.raw(builder.build().dgram)
    surface.taken()
    assert remote.value("height.tint") == (1.0, 0.0, 0.0)


def test_a_bundle_is_done_at_once_in_its_order(remote: Harness, surface: Surface):
    late = OscBundleBuilder(time.time() + 3600)
    inner = OscBundleBuilder(IMMEDIATELY)
    for builder, value in ((late, 0.6), (inner, 0.8)):
        message = OscMessageBuilder("/height/level" if builder is late else "/height/scale")
        message.add_arg(value * 10 if builder is inner else value)
        builder.add_content(message.build())
    late.add_content(inner.build())
    surface.raw(late.build().dgram)
    surface.taken()
    assert remote.value("height.level") == 0.6 and remote.value("height.scale") == 8.0


def test_time_presets_and_undo(remote: Harness, surface: Surface):
    surface.send("/playground/playing", 0)
    surface.send("/playground/time", 2.5)
    clock = remote.session.clock
    assert clock.time == 2.5 and not clock.playing
    surface.send("/playground/speed", 0.5)
    assert clock.speed == 0.5
    surface.send("/playground/preset", "high")
    assert remote.value("height.level") == 0.75
    surface.send("/playground/undo")
    assert remote.value("height.level") == 0.25
    surface.send("/playground/undo", 0)  # the button is let go
    surface.send("/playground/redo", 1)
    assert remote.value("height.level") == 0.75
    surface.send("/playground/undo")
    surface.send("/playground/preset", 0)
    assert remote.value("height.level") == 0.75


def test_what_does_not_fit_is_said_once_with_the_nearest_address(remote: Harness, surface: Surface):
    said: list[str] = []
    say = remote.bench.notices.say
    remote.bench.notices.say = lambda text: (said.append(text), say(text))[1]  # type: ignore
    for _ in range(5):
        surface.send("/height/levle", 0.5)
    assert len(said) == 1 and "did you mean '/height/level'?" in said[0]
    for value in (2.0, 3.0):
        surface.send("/height/level", value)
    assert len(said) == 2 and "outside its range 0 to 1" in said[1]
    surface.send("/height/level", 0.5)
    surface.send("/height/level", 2.0)
    assert len(said) == 3, "again, after one that fitted"
    surface.send("/playground/tiem", 1.0)
    assert "did you mean '/playground/time'?" in said[-1]
    surface.send("/height/sun/elevation", 1.0, 2.0)
    assert "one number" in said[-1]
    surface.raw(b"\xff\xfe no OSC")
    surface.taken()
    surface.raw(b"#bundle\0" + b"\0" * 3)
    surface.taken()
    assert sum("no OSC" in text for text in said) == 1
    for n in range(100):
        surface.send(f"/no/such/{n}", 1)
    assert len(said) < 30 and "further" in said[-1]


def test_an_address_that_fits_several_names_them(remote: Harness):
    from playground.studio.remote.controls import Controls
    from playground.studio.remote.osc import Addresses

    folder = remote.session.path.parent
    text = (folder / "sketch.toml").read_text("utf-8")
    (folder / "sketch.toml").write_text(
        text.replace("[view]", '[[pass]]\nname = "second"\nuse = "./hills"\n[view]'), "utf-8"
    )
    remote.session.drafts.reload()
    remote.frame()
    addresses = Addresses(Controls(remote.bench))
    addresses.receive("/level", [0.5])
    assert "/height/level or /second/level" in remote.notices[-1]


def test_changed_values_are_sent_but_not_back_to_sender(remote: Harness, surface: Surface):
    assert surface.greeting["/height/level"] == [0.25] and surface.greeting["/height/kind"] == ["round"]
    assert surface.greeting["/height/sun"] == [135.0, 25.0] and surface.greeting["/height/rocks"] == [1]
    remote.session.drafts.set("height.level", 0.5)
    remote.session.drafts.set("height.kind", 2)
    remote.frame()
    assert surface.heard() == {"/height/level": [0.5], "/height/kind": ["flat"]}
    remote.frame()
    assert surface.heard() == {}
    surface.send("/height/level", 0.75)
    assert surface.heard() == {}
    remote.bench.undo.undo()
    remote.frame()
    assert surface.heard() == {"/height/level": [0.5]}
    surface.send("/height/sun")
    assert surface.heard() == {"/height/sun": [135.0, 25.0]}, "a message without arguments asks"


def test_ten_thousand_messages_lose_not_the_last_value(remote: Harness, surface: Surface):
    def flood() -> None:
        for n in range(10_000):
            surface.client.send_message("/height/level", n / 10_000)
        for _ in range(20):  # UDP may drop some of so many
            surface.client.send_message("/height/level", 0.875)
            time.sleep(0.005)

    remote.during(flood)
    remote.until(lambda: remote.value("height.level") == 0.875)
    assert remote.notices == []


class Heard:
    """Takes what comes in."""

    def __init__(self) -> None:
        self.messages: list[tuple[str, list[Any]]] = []
        self.reports: list[str] = []

    def everything(self) -> list[Any]:
        return []

    def receive(self, address: str, arguments: list[Any]) -> list[Any]:
        self.messages.append((address, arguments))
        return []

    def report_once(self, kind: str, text: str) -> None:
        self.reports.append(text)


def test_what_waits_is_bounded():
    osc, heard = Osc(None, None), Heard()
    osc.start(heard, lambda: None)  # type: ignore[arg-type]
    for n in range(3 * MAX_WAITING):
        osc.put(message(f"/a/{n}", 1.0))
        osc.put(message("/playground/undo"))
        osc.put(message("/a/0", float(n)))
    osc.take()
    assert [address for address, _ in heard.messages].count("/playground/undo") == MAX_WAITING
    assert len(heard.messages) == 2 * MAX_WAITING and len(heard.reports) == 1
    assert [values for address, values in heard.messages if address == "/a/0"] == [[3 * MAX_WAITING - 1.0]]
    osc.take()
    assert len(heard.messages) == 2 * MAX_WAITING, "each is done once"


def message(address: str, *arguments: Any) -> bytes:
    builder = OscMessageBuilder(address)
    for argument in arguments:
        builder.add_arg(argument)
    return bytes(builder.build().dgram)


def test_bytes_that_are_no_osc_raise_nothing():
    osc, heard = Osc(None, None), Heard()
    osc.start(heard, lambda: None)  # type: ignore[arg-type]
    deep = b""
    for _ in range(2000):
        deep = b"#bundle\0" + struct.pack(">Q", 1) + struct.pack(">i", len(deep)) + deep
    wrong = (b"/", b"/a\0\0\0,f\0\0", b"\0" * 64, b"#bundle\0", deep, bytes(range(256)) * 8)
    for data in wrong:
        osc.put(data)
        osc.take()
    assert heard.messages == [] and heard.reports


def test_osc_port_host_and_package_errors_are_one_message(monkeypatch: pytest.MonkeyPatch):
    import sys

    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as other:
        other.bind(("127.0.0.1", 0))
        taken = other.getsockname()
        with pytest.raises(DataError, match=f"127.0.0.1:{taken[1]}"):
            Remotes(RemoteOptions(osc=taken))
    with pytest.raises(DataError, match="no such host"):
        Remotes(RemoteOptions(osc_to=("no such host", 9000)))
    monkeypatch.delitem(sys.modules, "playground.studio.remote.osc", raising=False)
    monkeypatch.setitem(sys.modules, "pythonosc.osc_packet", None)
    with pytest.raises(ContextError) as caught:
        Remotes(RemoteOptions(osc=("127.0.0.1", 0)))
    assert str(caught.value).endswith(install_command("osc"))


@pytest.mark.parametrize(
    "words", [["--osc", "0"], ["--osc", "a:b"], ["--osc", ":9000"], ["--osc-to", "9000000"], ["--osc", "x:"]]
)
def test_wrong_options_are_one_sentence(words: list[str], capfd: pytest.CaptureFixture[str]):
    assert cli.main(["live", *words]) == 2
    complaint = capfd.readouterr().err
    assert complaint.startswith("error: --osc") and complaint.count("\n") == 1


def test_closing_frees_the_port_and_ends_the_thread(remote: Harness):
    osc = remote.open(osc=("127.0.0.1", 0)).osc
    source = osc.source
    remote.remotes.close()
    assert remote.threads() == set() and source is not None
    with closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as again:
        again.bind(source)
