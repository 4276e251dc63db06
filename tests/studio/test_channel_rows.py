"""The panel's rows for channels: a chooser, a file to type, the warning that goes once something feeds it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.data.image_files import write_png
from playground.engine.engine import Engine
from playground.paths import SKETCHES
from playground.studio.problems.problems import Warnings

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
    assert bare.session.shown is not None
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
    assert alone.session.shown is not None
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
    assert alone.session.shown is not None
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
