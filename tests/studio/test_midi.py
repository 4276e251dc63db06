"""MIDI: devices of a fake backend, whose bytes mido itself parses, learned in the panel and played."""

from __future__ import annotations

import sys
import time
from collections.abc import Iterator
from pathlib import Path

import mido
import pytest

from playground.errors import SketchError
from playground.extras import install_command
from playground.studio.remote.controllers import (
    SETTLES,
    Binding,
    Source,
    file_of,
    read_bindings,
    write_bindings,
)
from playground.studio.remote.remotes import Remotes
from tests.studio import fake_midi

from ..sketch_texts import map_of, passes
from .panel_desk import Bare
from .remote_desk import Harness

KNOB, OTHER = 21, 22
HALF = 5.01e-6  # of the last decimal that a value from 0 to 1 is given


class Device:
    """A device that is played at a desk."""

    def __init__(self, remote: Harness) -> None:
        self.remote = remote
        self.data = fake_midi.DEVICES.setdefault("a box of knobs", [])
        self.said: list[str] = []
        say = remote.bench.notices.say
        remote.bench.notices.say = lambda text: (self.said.append(text), say(text))[1]  # type: ignore
        remote.open()

    def raw(self, *data: int) -> None:
        """Send bytes, and wait until the window has done what they say."""
        self.data.append(bytes(data))
        end = time.monotonic() + 60
        while self.data:
            assert time.monotonic() < end
            time.sleep(0.001)
        (name,) = (name for name, left in fake_midi.DEVICES.items() if left is self.data)
        asked = fake_midi.ASKED[name]
        while fake_midi.ASKED[name] == asked:  # it is asked again when all that it said is passed on
            assert time.monotonic() < end
            time.sleep(0.001)
        self.remote.frame()
        self.remote.frame()

    def turn(self, control: int, position: int, channel: int = 1) -> None:
        self.raw(0xB0 + channel - 1, control, position)

    def strike(self, note: int, strength: int = 100) -> None:
        self.raw(0x90, note, strength)
        self.raw(0x80, note, 0)

    def learn(self, path: str, part: str = "", control: int = KNOB) -> None:
        """Learn a control; it is left at 0."""
        self.remote.bench.controllers.learn(path, part)
        assert self.remote.bench.controllers.learning is not None, self.said
        self.turn(control, 1)
        self.turn(control, 0)
        self.settle()

    def settle(self) -> None:
        time.sleep(SETTLES + 0.05)
        self.remote.frame()
        assert self.remote.bench.controllers.learning is None


@pytest.fixture(autouse=True)
def fake_backend() -> Iterator[None]:
    before = mido.backend.name
    mido.set_backend(
        "tests.studio.fake_midi" if "tests.studio.fake_midi" in sys.modules else fake_midi.__name__
    )
    yield
    mido.set_backend(before)
    fake_midi.DEVICES.clear()
    fake_midi.TAKEN.clear()


@pytest.fixture
def device(remote: Harness, fake_backend: None) -> Device:
    return Device(remote)


@pytest.mark.slow
def test_a_knob_is_learned_goes_over_the_range_and_is_remembered(remote: Harness, device: Device):
    device.learn("height.level")
    file = file_of(remote.session.path)
    assert read_bindings(file) == (Binding("height.level", "", Source(1, "control", KNOB)),)
    assert "control 21 of channel 1 sets height.level" in device.said[-1]
    device.turn(KNOB, 127)
    for position in (127, 64, 32, 1, 0):
        device.turn(KNOB, position)
        assert remote.value("height.level") == pytest.approx(position / 127, abs=HALF)
    device.turn(OTHER, 99)
    device.turn(KNOB, 99, channel=2)
    assert remote.value("height.level") == 0.0
    assert remote.bench.undo.history.can_undo


@pytest.mark.slow
def test_soft_takeover_waits_until_knob_passes_value(remote: Harness, device: Device):
    device.learn("height.level")
    device.turn(KNOB, 20)
    assert remote.value("height.level") == 0.25, "0.157 lies below, the knob came from below"
    device.turn(KNOB, 40)
    assert remote.value("height.level") == pytest.approx(40 / 127, abs=HALF), "it has passed 0.25"
    remote.session.drafts.set("height.level", 0.75)  # by the mouse
    device.turn(KNOB, 50)
    assert remote.value("height.level") == 0.75
    device.turn(KNOB, 95)
    assert remote.value("height.level") == pytest.approx(95 / 127, abs=HALF), (
        "0.748 is as near as a knob gets"
    )
    device.turn(KNOB, 10)
    assert remote.value("height.level") == pytest.approx(10 / 127, abs=HALF)


@pytest.mark.slow
def test_each_widget_has_a_range(remote: Harness, device: Device):
    """Truth: the middle and the ends of each widget's range, by its own definition."""
    for number, (path, part, middle, ends) in enumerate(
        (
            ("height.scale", "", 1000 ** (64 / 127), (1.0, 1000.0)),
            ("height.count", "", 5, (0, 10)),
            ("height.kind", "", 1, (0, 2)),
            ("height.rocks", "", True, (False, True)),
            ("height.phase", "", -360 + 720 * 64 / 127, (-360.0, 360.0)),
        )
    ):
        device.learn(path, part, control=40 + number)
        for position, expected in ((127, ends[1]), (0, ends[0]), (64, middle), (127, ends[1])):
            device.turn(40 + number, position)
            assert remote.value(path) == pytest.approx(expected, rel=5e-5, abs=5e-4), "five digits"
    device.turn(43, 63)
    assert remote.value("height.rocks") is False


@pytest.mark.slow
def test_the_parts_of_a_vector_have_a_knob_each(remote: Harness, device: Device):
    device.learn("height.sun", "elevation", KNOB)
    device.learn("height.sun", "azimuth", OTHER)
    device.turn(KNOB, 127)
    device.turn(OTHER, 127)
    device.turn(KNOB, 0)
    device.turn(OTHER, 0)
    assert remote.value("height.sun") == (0.0, 0.0)
    device.turn(KNOB, 127)
    assert remote.value("height.sun") == (0.0, 90.0)
    device.learn("height.tint", "g", 23)
    device.turn(23, 127)
    device.turn(23, 64)
    red, green, blue = remote.value("height.tint")
    shown = 64 / 127
    assert (red, blue) == (1.0, 0.0) and green == pytest.approx(((shown + 0.055) / 1.055) ** 2.4, rel=1e-4)
    assert len(read_bindings(file_of(remote.session.path))) == 3


def test_notes_switch_step_and_strike(remote: Harness, device: Device):
    controllers = remote.bench.controllers
    for note, path in ((60, "height.rocks"), (61, "height.kind"), (62, "height.level")):
        controllers.learn(path)
        device.strike(note)
        assert controllers.learning is None
    assert remote.value("height.rocks") is True, "learning sets nothing"
    device.strike(60)
    assert remote.value("height.rocks") is False
    device.strike(60)
    assert remote.value("height.rocks") is True
    kinds = []
    for _ in range(4):
        device.strike(61)
        kinds.append(remote.value("height.kind"))
    assert kinds == [1, 2, 0, 1]
    device.strike(62, 127)
    assert remote.value("height.level") == 1.0
    device.raw(0x90, 60, 90, 0x90, 60, 0, 0x90, 60, 90)  # twice within a frame
    assert remote.value("height.rocks") is True


@pytest.mark.slow
def test_a_button_is_pressed_by_a_note_and_where_a_control_rises(remote: Harness, device: Device):
    pressed = remote.pressed()
    device.learn("height.fire")
    for position, count in ((63, 0), (64, 1), (127, 1), (0, 1), (127, 2)):
        device.turn(KNOB, position)
        assert len(pressed) == count, position
    remote.bench.controllers.learn("height.fire")
    device.strike(60)
    device.strike(60)
    assert len(pressed) == 3 and remote.value("height.fire") is False


def test_a_control_of_14_bits_is_found_while_it_is_learned(remote: Harness, device: Device):
    remote.bench.controllers.learn("height.level")
    device.raw(0xB0, 7, 0, 0xB0, 39, 5)
    device.settle()
    assert read_bindings(file_of(remote.session.path))[0].fine
    device.raw(0xB0, 7, 127, 0xB0, 39, 127)
    assert remote.value("height.level") == 1.0
    device.raw(0xB0, 7, 64, 0xB0, 39, 1)
    assert remote.value("height.level") == pytest.approx((64 * 128 + 1) / 16383, abs=HALF)
    device.raw(0xB0, 39, 2)
    assert remote.value("height.level") == pytest.approx((64 * 128 + 2) / 16383, abs=HALF)


def test_a_parameter_without_a_range_and_a_file_are_not_learned(remote: Harness, device: Device):
    for path, why in (("height.free", "has no range"), ("height.grass", "names a file")):
        remote.bench.controllers.learn(path)
        assert remote.bench.controllers.learning is None and why in device.said[-1]


def test_unlearning_forgets_and_removes_the_file(remote: Harness, device: Device):
    device.learn("height.level")
    file = file_of(remote.session.path)
    assert file.is_file()
    remote.bench.controllers.unlearn("height.level")
    assert not file.exists() and remote.bench.controllers.bindings == ()
    device.turn(KNOB, 127)
    assert remote.value("height.level") == 0.25


def test_a_locked_parameter_stays_and_a_lost_one_is_named_once(remote: Harness, device: Device):
    device.learn("height.level")
    remote.session.drafts.lock("height.level", True)
    device.turn(KNOB, 127)
    device.turn(KNOB, 0)
    assert remote.value("height.level") == 0.25
    assert sum("is locked" in text for text in device.said) == 1
    write_bindings(file_of(remote.session.path), [Binding("height.levle", "", Source(1, "control", 9))])
    remote.bench.controllers._of = None  # as when the sketch is opened
    for position in (1, 2, 3):
        device.turn(9, position)
    named = [text for text in device.said if "height.levle" in text]
    assert len(named) == 1 and "did you mean 'height.level'?" in named[0]


def test_saved_bindings_play_as_soon_as_sketch_opens(remote: Harness):
    write_bindings(file_of(remote.session.path), [Binding("height.level", "", Source(3, "control", 9))])
    device = Device(remote)
    remote.frame()
    device.turn(9, 0, channel=3)
    device.turn(9, 127, channel=3)
    assert remote.value("height.level") == 1.0


def test_bindings_file_round_trips_and_errors_have_lines(tmp_path: Path):
    file = tmp_path / "a.controllers"
    bindings = (
        Binding("height.level", "", Source(16, "control", 7), fine=True),
        Binding("light.sun", "elevation", Source(1, "note", 0)),
    )
    write_bindings(file, bindings)
    assert read_bindings(file) == bindings and file.read_text("utf-8").startswith("# MIDI")
    good = file.read_text("utf-8")
    for old, new, line, words in (
        ("channel = 16", "channel = 17", 6, "expected 1 to 16"),
        ("control = 7", "control = 128", 7, "expected 0 to 127"),
        ("control = 7", "contrl = 7", 7, "did you mean 'control'?"),
        ("control = 7", 'control = "7"', 7, "a whole number"),
        ("control = 7", "control = 40", 8, "14 bits"),
        ("fine = true", "fine = 1", 8, "true or false"),
        ("format = 1", "format = 2", 2, "format = 1"),
        ("note = 0", "note = 0\ncontrol = 1", 10, "a control or a note"),
        ("[[controller]]", "[controller", 4, "not TOML"),
    ):
        file.write_text(good.replace(old, new, 1), encoding="utf-8")
        with pytest.raises(SketchError, match=words) as caught:
            read_bindings(file)
        assert caught.value.diagnostics[0].line == line, (new, caught.value.diagnostics[0].line)
    file.write_text("#" * 100_000, encoding="utf-8")
    with pytest.raises(SketchError, match="larger"):
        read_bindings(file)


def test_a_file_with_a_mistake_is_named_and_not_overwritten(remote: Harness):
    file = file_of(remote.session.path)
    file.write_text("format = 9\n", encoding="utf-8")
    device = Device(remote)
    remote.frame()
    assert "format = 9" in device.said[0]
    device.learn("height.level")
    device.turn(KNOB, 127)
    assert remote.value("height.level") == 1.0 and file.read_text("utf-8") == "format = 9\n"
    assert any("has a mistake" in text for text in device.said)


def fails(**_: object) -> None:
    raise RuntimeError("no sequencer")


def test_without_a_device_or_a_package_one_sentence_says_so(remote: Harness, monkeypatch: pytest.MonkeyPatch):
    fake_midi.DEVICES.clear()
    remote.open()
    controllers = remote.bench.controllers
    controllers.learn("height.level")
    assert controllers.learning is None and "no device is connected" in remote.notices[-1]
    fake_midi.DEVICES["one that is taken"] = []
    fake_midi.TAKEN.add("one that is taken")
    controllers.learn("height.level")
    assert controllers.learning is None
    monkeypatch.setattr(
        fake_midi, "get_devices", lambda **_: (_ for _ in ()).throw(RuntimeError("no sequencer"))
    )
    controllers.learn("height.level")
    assert remote.notices[-1] == "MIDI cannot be received here: no sequencer"
    remote.remotes.close()
    monkeypatch.delitem(sys.modules, "playground.studio.remote.midi", raising=False)
    monkeypatch.setitem(sys.modules, "mido", None)
    remote.remotes = Remotes()
    remote.remotes.attach(remote.bench, lambda: None)
    controllers.learn("height.level")
    assert remote.notices[-1].endswith(install_command("midi"))


@pytest.mark.slow
def test_hotplugged_device_is_found_and_unplugging_is_no_error(
    remote: Harness, device: Device, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.setattr("playground.studio.remote.midi.SCAN_INTERVAL", 0.05)
    device.learn("height.level")
    midi = remote.remotes.midi
    assert midi is not None and midi.devices == ["a box of knobs"]
    del fake_midi.DEVICES["a box of knobs"]
    remote.until(lambda: midi.devices == [])
    device.data = fake_midi.DEVICES.setdefault("another box", [])
    remote.until(lambda: midi.devices == ["another box"])
    device.turn(KNOB, 127)
    assert remote.value("height.level") == 1.0
    remote.remotes.close()
    assert remote.threads() == set()


@pytest.mark.slow
def test_a_flood_of_a_knob_loses_not_the_last_position(remote: Harness, device: Device):
    device.learn("height.level")
    device.turn(KNOB, 127)
    device.data.append(bytes(byte for n in range(10_000) for byte in (0xB0, KNOB, n % 128)))
    device.data.append(bytes((0xB0, KNOB, 77)))
    remote.until(lambda: abs(remote.value("height.level") - 77 / 127) < HALF)
    remote.until(lambda: not device.data and not remote.remotes.waits)
    assert remote.value("height.level") == pytest.approx(77 / 127, abs=HALF)


# ── controller menu ───────────────────────────────────────────────────────────


TERRAIN = """#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform vec2 sun = vec2(135.0, 40.0); //! direction
float kernel(ivec2 texel) { return level + 0.0 * sun.x; }
"""
FILES = {
    "terrain.glsl": TERRAIN,
    "sketch.toml": "format = 1\nsize = 9\n" + passes(height="./terrain") + map_of("height"),
}
LEVEL, SUN = "##height.level", "##height.sun-azimuth"
MENU_KNOB = Source(2, "control", 7)


def test_a_controller_is_learned_and_forgotten_by_the_menu(bare: Bare) -> None:
    controllers = bare.bench.controllers
    bare.click(LEVEL, 0.2, button=1)
    bare.click("Learn MIDI")
    assert controllers.learning is None, "nothing listens here"
    assert "MIDI cannot be received here" in bare.bench.notices.items[-1].text

    controllers.listen = lambda: ""
    bare.click(LEVEL, 0.2, button=1)
    assert "Unlearn MIDI" not in bare.places
    bare.click("Learn MIDI")
    assert controllers.learning is not None and controllers.learning.path == "height.level"
    bare.click(LEVEL, 0.2, button=1)
    bare.click("Stop learning MIDI")
    assert controllers.learning is None

    bare.click(LEVEL, 0.2, button=1)
    bare.click("Learn MIDI")
    controllers.take([(MENU_KNOB, 3)])
    bare.run_frames(1, step=SETTLES + 0.01)
    controllers.update()
    (binding,) = read_bindings(file_of(bare.session.path))
    assert (binding.path, binding.source) == ("height.level", MENU_KNOB)

    bare.click(LEVEL, 0.2, button=1)
    bare.click("Unlearn MIDI")
    assert controllers.bindings == () and not file_of(bare.session.path).exists()


def test_each_part_of_a_vector_is_learned_by_itself(bare: Bare) -> None:
    controllers = bare.bench.controllers
    controllers.listen = lambda: ""
    bare.click(SUN, 0.2, button=1)
    bare.click("Learn MIDI: elevation")
    assert (controllers.learning.path, controllers.learning.part) == ("height.sun", "elevation")
