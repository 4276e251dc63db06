"""Channels of other tools' shaders: the panel's rows, edits, undo, and saving."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.paths import SKETCHES
from playground.sketch.assign import values_of
from playground.studio.bench import Workbench
from playground.studio.channels.channels import channels
from playground.studio.edits.autosave import Autosave, memory_of
from playground.studio.interface import WindowControls
from playground.studio.problems.problems import Warnings
from playground.studio.session import Session

from ..loading import load
from .panel_desk import Bare

pytestmark = pytest.mark.room("dialects")

SHADER = """void mainImage(out vec4 c, in vec2 p) {
    c = texelFetch(iChannel0, ivec2(0), 0) + texelFetch(iChannel3, ivec2(0), 0);
}
"""
FILES = {"two.frag": SHADER}


@pytest.fixture
def alone(folder: Path, any_engine: Engine, monkeypatch: pytest.MonkeyPatch) -> Bare:
    write_png(folder / "green.png", np.full((6, 5, 4), (0, 255, 0, 255), np.uint8))
    return Bare(any_engine, folder / "two.frag")


def sources(bare: Bare) -> dict[str, str]:
    return dict(bare.session.shown.edits.channels)


def warned(bare: Bare) -> list[str]:
    warnings = Warnings(lambda kernel: ())
    return [str(result) for result in warnings.of(bare.session.sketch, bare.session.plan)]


def choose(bare: Bare, channel: str, option: str) -> None:
    bare.click(f"##feeds view.{channel}")
    bare.click(option)
    bare.run_frames(3)


def test_a_channel_is_fed_by_the_chooser_and_undone(alone: Bare) -> None:
    choose(alone, "iChannel3", "picture")
    assert sources(alone) == {"view.iChannel3": "foreign/picture"}
    choose(alone, "iChannel0", "black")
    assert sources(alone)["view.iChannel0"] == "foreign/black"
    alone.bench.undo.undo()
    alone.run_frames(3)
    assert sources(alone) == {"view.iChannel3": "foreign/picture"}
    choose(alone, "iChannel3", "noise")
    assert sources(alone) == {}
    alone.close()


def test_an_image_file_gets_a_field(alone: Bare, folder: Path) -> None:
    choose(alone, "iChannel0", "image file")
    alone.click("##of view.iChannel0", 0.3)
    alone.key(imgui.Key.mod_ctrl, imgui.Key.a)
    alone.type("green.png")
    alone.key(imgui.Key.enter)
    alone.run_frames(3)
    assert alone.session.error is None
    assert dict(alone.session.shown.edits.values) == {"iChannel0.image": "green.png"}
    alone.close()


def test_the_warning_goes_once_something_feeds_the_channel(alone: Bare) -> None:
    assert any("nothing feeds iChannel0, iChannel3" in text for text in warned(alone))
    choose(alone, "iChannel0", "image file")
    assert any("nothing feeds iChannel3" in text for text in warned(alone))
    choose(alone, "iChannel3", "black")
    assert warned(alone) == []
    alone.bench.undo.undo()
    alone.run_frames(3)
    assert any("nothing feeds iChannel3" in text for text in warned(alone))
    alone.close()


def test_a_dropped_image_is_put_into_the_channel_that_is_chosen(alone: Bare, folder: Path) -> None:
    alone.drops.take([folder / "green.png"])
    alone.run_frames(3)
    offered = [label for label in alone.places if "##channel" in label]
    assert offered == ["view.iChannel0##channel view.iChannel0", "view.iChannel3##channel view.iChannel3"]
    alone.click(offered[1])
    alone.run_frames(3)
    assert alone.session.error is None and alone.drops.waiting == []
    assert sources(alone) == {"view.iChannel3": "foreign/image"}
    assert dict(alone.session.shown.edits.values) == {
        "iChannel3.image": str((folder / "green.png").resolve())
    }
    alone.drops.take([folder / "green.png"])
    alone.run_frames(3)
    offered = [label for label in alone.places if "iChannel3" in label and "##" in label]
    assert [label for label in offered if label.startswith("Image")] == [], "it is offered once, as a channel"
    alone.bench.undo.undo()
    alone.run_frames(3)
    assert sources(alone) == {}
    alone.close()


def test_a_dropped_video_and_a_sound_go_to_a_channel_too(alone: Bare, folder: Path) -> None:
    data = SKETCHES / "data"
    for name, source in (("sun_flight.mp4", "foreign/video"), ("tones.flac", "foreign/sound")):
        alone.drops.take([data / name])
        alone.run_frames(3)
        alone.click("view.iChannel0##channel view.iChannel0")
        alone.run_frames(3)
        assert alone.session.error is None and sources(alone) == {"view.iChannel0": source}
    alone.close()


def test_a_source_is_reset_by_its_cross(alone: Bare) -> None:
    choose(alone, "iChannel0", "picture")
    alone.click("##reset view.iChannel0")
    alone.run_frames(3)
    assert sources(alone) == {}
    alone.close()


def test_the_graph_and_the_history_name_what_was_chosen(alone: Bare) -> None:
    choose(alone, "iChannel0", "picture")
    alone.click("History")
    alone.run_frames(2)
    assert any("view.iChannel0: foreign/picture" in label for label in alone.places)
    alone.close()


# ── channel edits ─────────────────────────────────────────────────────────────


FIRST = """// First channel
uniform float gain = 1.0; //! slider(0, 2)
void mainImage(out vec4 c, in vec2 p) {
    c = gain * texelFetch(iChannel0, ivec2(0), 0) + 0.0 * texelFetch(iChannel1, ivec2(0), 0);
}
"""
SKETCH = 'format = 1\n[[pass]]\nname = "land"\nuse = "foreign/picture"\nsize = 8\n[view]\nuse = "./first"\n'
KERNEL = """#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level; }
"""
CHANNEL = "view.iChannel0"
GREEN, GREY = (0, 255, 0), (0, 128, 0)


class Window:
    """A session with what a window has around it, and a memory."""

    def __init__(self, engine: Engine, path: Path, edits_folder: Path) -> None:
        self.time = 0.0
        self.memory = memory_of(path, edits_folder / "state")
        result, _ = self.memory.read()
        self.session = Session(engine, path, start=result.start, now=lambda: self.time)
        self.bench = Workbench(
            self.session, WindowControls(lambda: None), folder=edits_folder, now=lambda: self.time
        )
        self.autosave = Autosave(self.session, self.memory, result, lambda: self.time)
        self.bench.actions.opens = self.autosave.open
        self.said: list[str] = []
        self.frame()

    def frame(self) -> None:
        self.time += 1.0
        self.session.frame((4, 4))
        self.bench.undo.record()
        self.bench.take_notes()
        self.said = [notice.text for notice in self.bench.notices.items]
        self.autosave.look((900, 600))
        self.autosave.write()

    def feed(self, source: str, channel: str = CHANNEL, **values: str) -> None:
        self.session.drafts.feed(channel, source, **values)
        self.frame()

    @property
    def sources(self) -> list[str]:
        assert self.session.sketch is not None
        return [channel.source for channel in channels(self.session.sketch)]

    @property
    def colour(self) -> tuple[int, ...]:
        frame = self.session.read()
        assert frame is not None and self.session.error is None
        return tuple(int(n) for n in frame.array[0, 0, :3])

    def close(self) -> None:
        self.autosave.close()
        self.session.release()


@pytest.fixture
def edits_folder(tmp_path: Path) -> Path:
    home = tmp_path / "home"
    home.mkdir()
    (home / "first.frag").write_text(FIRST, "utf-8")
    (home / "sketch.toml").write_text(SKETCH, "utf-8")
    (tmp_path / "alone").mkdir()
    (tmp_path / "alone" / "first.frag").write_text(FIRST, "utf-8")
    write_png(tmp_path / "green.png", np.full((6, 5, 4), (0, 255, 0, 255), np.uint8))
    return tmp_path


@pytest.fixture(params=["alone/first.frag", "home/sketch.toml"])
def window(request: pytest.FixtureRequest, edits_folder: Path, any_engine: Engine) -> Iterator[Window]:
    made = Window(any_engine, edits_folder / request.param, edits_folder)
    yield made
    made.close()


def test_an_image_is_fed_undone_and_done_again(window: Window, edits_folder: Path) -> None:
    before = window.colour
    window.feed("foreign/image", image=str(edits_folder / "green.png"))
    assert window.colour == GREEN and window.sources[0] == "foreign/image"
    window.bench.undo.undo()
    window.frame()
    assert window.colour == before and window.sources[0] == "foreign/noise"
    window.bench.undo.redo()
    window.frame()
    assert window.colour == GREEN


def test_what_was_chosen_is_there_in_the_next_session(
    window: Window, edits_folder: Path, any_engine: Engine
) -> None:
    window.feed("foreign/image", image=str(edits_folder / "green.png"))
    path = window.session.path
    window.close()
    again = Window(any_engine, path, edits_folder)
    assert again.colour == GREEN and again.said == []
    again.bench.actions.reset_values()
    again.frame()
    assert again.sources[0] == "foreign/noise"
    again.close()


def test_the_file_s_own_source_is_no_edit(window: Window) -> None:
    window.feed("foreign/black")
    window.feed("foreign/noise")
    assert window.session.shown is not None and window.session.shown.edits.channels == ()


def test_the_technique_of_a_stand_in_is_the_same_edit(edits_folder: Path, any_engine: Engine) -> None:
    window = Window(any_engine, edits_folder / "alone" / "first.frag", edits_folder)
    window.session.drafts.choose("iChannel0", "foreign/black")
    window.frame()
    assert window.session.shown.edits.channels == ((CHANNEL, "foreign/black"),)
    assert window.session.shown.edits.techniques == () and window.colour == (0, 0, 0)
    window.close()


def test_a_save_of_the_shader_leaves_what_was_chosen(window: Window, edits_folder: Path) -> None:
    window.feed("foreign/image", image=str(edits_folder / "green.png"))
    shader = Path(window.session.shown.file.folder) / "first.frag"
    shader.write_text(FIRST.replace("gain *", "0.5 * gain *"), "utf-8")
    window.session.drafts.reload()
    window.frame()
    assert window.colour == GREY and window.sources[0] == "foreign/image"
    shader.write_text("void mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }\n", "utf-8")
    window.session.drafts.reload()
    window.frame()
    assert window.colour == (255, 255, 255) and any(CHANNEL in text for text in window.said)


def test_a_file_that_feeds_the_channel_otherwise_wins(edits_folder: Path, any_engine: Engine) -> None:
    window = Window(any_engine, edits_folder / "home", edits_folder)
    window.feed("foreign/black")
    file = edits_folder / "home" / "sketch.toml"
    file.write_text(SKETCH + 'inputs = { iChannel0 = "land" }\n', "utf-8")
    window.session.drafts.reload()
    window.frame()
    assert window.sources[0] == "foreign/picture"
    assert any(f"{CHANNEL}: what was chosen to feed it" in text for text in window.said)
    window.close()


def test_it_is_saved_into_the_sketch(edits_folder: Path, any_engine: Engine) -> None:
    window = Window(any_engine, edits_folder / "home", edits_folder)
    window.feed("foreign/image", image=str(edits_folder / "green.png"))
    window.feed("land", "view.iChannel1")
    window.bench.actions.save_values()
    window.frame()
    assert any("saved 1 value and 2 channels into" in text for text in window.said), window.said
    assert window.session.shown is not None and window.session.shown.edits.channels == ()
    saved = load(edits_folder / "home")
    view = saved.graph.find("view")
    assert view is not None and dict(view.inputs) == {"iChannel0": "iChannel0", "iChannel1": "land"}
    assert window.colour == GREEN and (edits_folder / "home" / "green.png").is_file()
    window.bench.undo.undo()
    window.bench.undo.undo()
    window.frame()
    assert window.sources[0] == "foreign/noise"
    window.close()


def test_a_shader_alone_is_saved_as_a_sketch_next_to_it(edits_folder: Path, any_engine: Engine) -> None:
    home = edits_folder / "alone"
    window = Window(any_engine, home / "first.frag", edits_folder)
    window.feed("foreign/image", image=str(edits_folder / "green.png"))
    window.session.drafts.set("view.gain", 0.5)
    window.session.drafts.set("iChannel1.number", 7)
    window.frame()
    assert window.colour == GREY
    copied: list[str] = []
    window.bench.actions.copy_toml(copied.append)
    window.frame()
    assert copied == [] and any("is no TOML" in text for text in window.said)
    window.time += 60.0
    assert window.bench.actions.copy_is[0] == "Save a sketch"
    window.bench.actions.save_values()
    window.frame()
    assert window.session.path == home / "first_sketch.toml"
    assert window.said == [f"saved first_sketch.toml in {home}; from here on this is the sketch"]
    assert window.colour == GREY and (home / "first.frag").read_text("utf-8") == FIRST
    assert sorted(path.name for path in home.iterdir()) == ["first.frag", "first_sketch.toml", "green.png"]
    saved = load(home / "first_sketch.toml")
    assert [c.source for c in channels(saved)] == ["foreign/image", "foreign/noise"]
    window.bench.actions.visit(-1)
    window.frame()
    assert window.session.path == home / "first.frag" and window.sources[0] == "foreign/image"
    window.close()


TOY = """#iChannel0 "file://buffer.frag"
void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(0), 0); }
"""
BUFFER = """uniform float gain = 1.0; //! slider(0, 2)
void mainImage(out vec4 c, in vec2 p) { c = gain * texelFetch(iChannel1, ivec2(0), 0); }
"""


def test_a_shader_of_several_passes_is_saved_as_a_sketch_too(edits_folder: Path, any_engine: Engine) -> None:
    home = edits_folder / "alone"
    (home / "buffer.frag").write_text(BUFFER, "utf-8")
    (home / "toy.frag").write_text(TOY, "utf-8")
    window = Window(any_engine, home / "toy.frag", edits_folder)
    assert window.session.sketch is not None
    (channel,) = [c for c in channels(window.session.sketch) if c.name.endswith("iChannel1")]
    window.feed("foreign/image", channel.path, image=str(edits_folder / "green.png"))
    (gain,) = [path for path in values_of(window.session.sketch) if path.endswith("gain")]
    window.session.drafts.set(gain, 0.5)
    window.frame()
    assert window.colour == GREY
    window.bench.actions.save_a_copy()
    window.frame()
    assert window.session.path == home / "toy_sketch.toml", window.said
    assert window.colour == GREY and window.session.error is None
    window.close()


@pytest.mark.slow
def test_a_kernel_alone_is_saved_as_a_sketch_too(edits_folder: Path, any_engine: Engine) -> None:
    file = edits_folder / "alone" / "flat.glsl"
    file.write_text(KERNEL, "utf-8")
    window = Window(any_engine, file, edits_folder)
    window.session.drafts.set("height.level", 0.25)
    window.frame()
    before = window.session.read()
    window.bench.actions.save_a_copy()
    window.frame()
    assert window.session.path.name == "flat_sketch.toml" and window.session.error is None, window.said
    after = window.session.read()
    assert before is not None and after is not None
    assert np.array_equal(before.array, after.array)
    window.close()


def test_what_cannot_be_saved_says_why(edits_folder: Path, any_engine: Engine) -> None:
    file = edits_folder / "alone" / "other.fragment"
    file.write_text(FIRST, "utf-8")
    window = Window(any_engine, file, edits_folder)
    window.bench.actions.save_a_copy()
    window.frame()
    assert any(
        "a sketch uses shaders that end in .glsl, .frag or .fs, not in .fragment" in text
        for text in window.said
    )
    assert sorted(path.name for path in (edits_folder / "alone").iterdir()) == [
        "first.frag",
        "other.fragment",
    ]
    window.close()
