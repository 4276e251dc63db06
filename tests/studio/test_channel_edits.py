"""What feeds a channel is edited, undone, remembered, and saved; what the files change gives way or stays."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.studio.bench import Workbench
from playground.studio.channels.channels import channels
from playground.studio.edits.autosave import Autosave, memory_of
from playground.studio.interface import WindowControls
from playground.studio.session import Session

from ..loading import load

pytestmark = pytest.mark.room("dialects")

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

    def __init__(self, engine: Engine, path: Path, folder: Path) -> None:
        self.time = 0.0
        self.memory = memory_of(path, folder / "state")
        result, _ = self.memory.read()
        self.session = Session(engine, path, start=result.start, now=lambda: self.time)
        self.bench = Workbench(
            self.session, WindowControls(lambda: None), folder=folder, now=lambda: self.time
        )
        self.autosave = Autosave(self.session, self.memory, result, lambda: self.time)
        self.bench.commands.opens = self.autosave.open
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
def folder(tmp_path: Path) -> Path:
    home = tmp_path / "home"
    home.mkdir()
    (home / "first.frag").write_text(FIRST, "utf-8")
    (home / "sketch.toml").write_text(SKETCH, "utf-8")
    (tmp_path / "alone").mkdir()
    (tmp_path / "alone" / "first.frag").write_text(FIRST, "utf-8")
    write_png(tmp_path / "green.png", np.full((6, 5, 4), (0, 255, 0, 255), np.uint8))
    return tmp_path


@pytest.fixture(params=["alone/first.frag", "home/sketch.toml"])
def window(request: pytest.FixtureRequest, folder: Path, any_engine: Engine) -> Iterator[Window]:
    made = Window(any_engine, folder / request.param, folder)
    yield made
    made.close()


def test_an_image_is_fed_undone_and_done_again(window: Window, folder: Path) -> None:
    before = window.colour
    window.feed("foreign/image", image=str(folder / "green.png"))
    assert window.colour == GREEN and window.sources[0] == "foreign/image"
    window.bench.undo.undo()
    window.frame()
    assert window.colour == before and window.sources[0] == "foreign/noise"
    window.bench.undo.redo()
    window.frame()
    assert window.colour == GREEN


def test_what_was_chosen_is_there_in_the_next_session(
    window: Window, folder: Path, any_engine: Engine
) -> None:
    window.feed("foreign/image", image=str(folder / "green.png"))
    path = window.session.path
    window.close()
    again = Window(any_engine, path, folder)
    assert again.colour == GREEN and again.said == []
    again.bench.commands.reset_values()
    again.frame()
    assert again.sources[0] == "foreign/noise"
    again.close()


def test_the_file_s_own_source_is_no_edit(window: Window) -> None:
    window.feed("foreign/black")
    window.feed("foreign/noise")
    assert window.session.shown is not None and window.session.shown.edits.channels == ()


def test_the_technique_of_a_stand_in_is_the_same_edit(folder: Path, any_engine: Engine) -> None:
    window = Window(any_engine, folder / "alone" / "first.frag", folder)
    window.session.drafts.choose("iChannel0", "foreign/black")
    window.frame()
    assert window.session.shown is not None
    assert window.session.shown.edits.channels == ((CHANNEL, "foreign/black"),)
    assert window.session.shown.edits.techniques == () and window.colour == (0, 0, 0)
    window.close()


def test_a_save_of_the_shader_leaves_what_was_chosen(window: Window, folder: Path) -> None:
    window.feed("foreign/image", image=str(folder / "green.png"))
    assert window.session.shown is not None
    shader = Path(window.session.shown.file.folder) / "first.frag"
    shader.write_text(FIRST.replace("gain *", "0.5 * gain *"), "utf-8")
    window.session.drafts.reload()
    window.frame()
    assert window.colour == GREY and window.sources[0] == "foreign/image"
    shader.write_text("void mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }\n", "utf-8")
    window.session.drafts.reload()
    window.frame()
    assert window.colour == (255, 255, 255) and any(CHANNEL in text for text in window.said)


def test_a_file_that_feeds_the_channel_otherwise_wins(folder: Path, any_engine: Engine) -> None:
    window = Window(any_engine, folder / "home", folder)
    window.feed("foreign/black")
    file = folder / "home" / "sketch.toml"
    file.write_text(SKETCH + 'inputs = { iChannel0 = "land" }\n', "utf-8")
    window.session.drafts.reload()
    window.frame()
    assert window.sources[0] == "foreign/picture"
    assert any(f"{CHANNEL}: what was chosen to feed it" in text for text in window.said)
    window.close()


def test_it_is_saved_into_the_sketch(folder: Path, any_engine: Engine) -> None:
    window = Window(any_engine, folder / "home", folder)
    window.feed("foreign/image", image=str(folder / "green.png"))
    window.feed("land", "view.iChannel1")
    window.bench.commands.save_values()
    window.frame()
    assert any("saved 1 value and 2 channels into" in text for text in window.said), window.said
    assert window.session.shown is not None and window.session.shown.edits.channels == ()
    saved = load(folder / "home")
    view = saved.graph.find("view")
    assert view is not None and dict(view.inputs) == {"iChannel0": "iChannel0", "iChannel1": "land"}
    assert window.colour == GREEN and (folder / "home" / "green.png").is_file()
    window.bench.undo.undo()
    window.bench.undo.undo()
    window.frame()
    assert window.sources[0] == "foreign/noise"
    window.close()


def test_a_shader_alone_is_saved_as_a_sketch_next_to_it(folder: Path, any_engine: Engine) -> None:
    home = folder / "alone"
    window = Window(any_engine, home / "first.frag", folder)
    window.feed("foreign/image", image=str(folder / "green.png"))
    window.session.drafts.set("view.gain", 0.5)
    window.session.drafts.set("iChannel1.number", 7)
    window.frame()
    assert window.colour == GREY
    copied: list[str] = []
    window.bench.commands.copy_toml(copied.append)
    window.frame()
    assert copied == [] and any("is no TOML" in text for text in window.said)
    window.time += 60.0
    assert window.bench.commands.copy_is[0] == "Save a sketch"
    window.bench.commands.save_values()
    window.frame()
    assert window.session.path == home / "first_sketch.toml"
    assert window.said == [f"saved first_sketch.toml in {home}; from here on this is the sketch"]
    assert window.colour == GREY and (home / "first.frag").read_text("utf-8") == FIRST
    assert sorted(path.name for path in home.iterdir()) == ["first.frag", "first_sketch.toml", "green.png"]
    saved = load(home / "first_sketch.toml")
    assert [c.source for c in channels(saved)] == ["foreign/image", "foreign/noise"]
    window.bench.commands.visit(-1)
    window.frame()
    assert window.session.path == home / "first.frag" and window.sources[0] == "foreign/image"
    window.close()


TOY = """#iChannel0 "file://buffer.frag"
void mainImage(out vec4 c, in vec2 p) { c = texelFetch(iChannel0, ivec2(0), 0); }
"""
BUFFER = """uniform float gain = 1.0; //! slider(0, 2)
void mainImage(out vec4 c, in vec2 p) { c = gain * texelFetch(iChannel1, ivec2(0), 0); }
"""


def test_a_shader_of_several_passes_is_saved_as_a_sketch_too(folder: Path, any_engine: Engine) -> None:
    home = folder / "alone"
    (home / "buffer.frag").write_text(BUFFER, "utf-8")
    (home / "toy.frag").write_text(TOY, "utf-8")
    window = Window(any_engine, home / "toy.frag", folder)
    assert window.session.sketch is not None
    (channel,) = [c for c in channels(window.session.sketch) if c.name.endswith("iChannel1")]
    window.feed("foreign/image", channel.path, image=str(folder / "green.png"))
    (gain,) = [path for path in values_of(window.session.sketch) if path.endswith("gain")]
    window.session.drafts.set(gain, 0.5)
    window.frame()
    assert window.colour == GREY
    window.bench.commands.save_a_copy()
    window.frame()
    assert window.session.path == home / "toy_sketch.toml", window.said
    assert window.colour == GREY and window.session.error is None
    window.close()


@pytest.mark.slow
def test_a_kernel_alone_is_saved_as_a_sketch_too(folder: Path, any_engine: Engine) -> None:
    file = folder / "alone" / "flat.glsl"
    file.write_text(KERNEL, "utf-8")
    window = Window(any_engine, file, folder)
    window.session.drafts.set("height.level", 0.25)
    window.frame()
    before = window.session.read()
    window.bench.commands.save_a_copy()
    window.frame()
    assert window.session.path.name == "flat_sketch.toml" and window.session.error is None, window.said
    after = window.session.read()
    assert before is not None and after is not None
    assert np.array_equal(before.array, after.array)
    window.close()


def test_what_cannot_be_saved_says_why(folder: Path, any_engine: Engine) -> None:
    file = folder / "alone" / "other.fragment"
    file.write_text(FIRST, "utf-8")
    window = Window(any_engine, file, folder)
    window.bench.commands.save_a_copy()
    window.frame()
    assert any(
        "a sketch uses shaders that end in .glsl, .frag or .fs, not in .fragment" in text
        for text in window.said
    )
    assert sorted(path.name for path in (folder / "alone").iterdir()) == ["first.frag", "other.fragment"]
    window.close()
