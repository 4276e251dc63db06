"""The panel under a mouse and keys, without a screen, and its parts: numbers, the sky's disc."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from imgui_bundle import ImVec2, imgui

from playground.data.image_files import write_png
from playground.engine.camera import look
from playground.engine.engine import Engine
from playground.paths import SKETCHES
from playground.shader.parameter import Widget
from playground.shader.widgets import WIDGETS
from playground.sketch.assign import values_of
from playground.sketch.model import Camera, Parameter
from playground.studio import draw as panel_rows
from playground.studio.draw import fitting_path, tooltip_waits
from playground.studio.keys import GESTURES, all_keys, keys_by_subject
from playground.studio.panel.panel import Panel
from playground.studio.panel.values import decimals, format_of, snapped
from playground.studio.picture.gestures import Gesture, steered
from playground.studio.problems.panel import numbered, short_place
from playground.studio.theme import PANEL_WIDTH
from playground.studio.widgets import CONTROLS, direction_at, dot_of

from ..sketch_texts import map_of, passes
from .panel_desk import Bare, OpenBare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high the hills are
uniform float turn = 0.0; //! angle The way that the hills run
uniform float rough = 1.0; //! log_slider(0.01, 100) unit("1/m") group("Shape") Waves in a metre
uniform int count = 3; //! slider(1, 9) group("Shape") How many waves
uniform vec2 sun = vec2(135.0, 40.0); //! direction group("Shape") Where the sun is
uniform int kind = 0; //! menu("round", "sharp") group("Shape") What they are like
uniform float gone = 0.5; //! slider(0, 1) group("A group whose name is longer than there is room for") Gone
float kernel(ivec2 texel) { return level; }
"""
SKETCH = (
    """format = 1
title = "Hills, with a title that is longer than any panel has room for in one line"
size = 33
"""
    + passes(height=("./terrain", "set = { level = 0.6 }"))
    + map_of("height")
    + """[[preset]]
name = "high"
set = { "height.level" = 1.0, "height.count" = 5 }
"""
)
LEVEL, COUNT = "##height.level", "##height.count"


FILES = {"terrain.glsl": TERRAIN, "sketch.toml": SKETCH}


def value(bare: Bare, name: str) -> object:
    assert bare.session.sketch is not None
    return values_of(bare.session.sketch)[f"height.{name}"]


def notices_of(bare: Bare) -> str:
    return "; ".join(notice.text for notice in bare.bench.notices.items)


def test_a_drag_sets_a_value_and_is_one_step(bare: Bare) -> None:
    bare.drag(LEVEL, 0.6, 0.9)
    moved = value(bare, "level")
    assert isinstance(moved, float) and 0.8 < moved < 1.0
    assert len(bare.bench.undo.history.steps) == 1
    bare.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert value(bare, "level") == 0.6
    bare.key(imgui.Key.mod_ctrl, imgui.Key.mod_shift, imgui.Key.z)
    assert value(bare, "level") == moved
    bare.key(imgui.Key.mod_ctrl, imgui.Key.z)
    bare.key(imgui.Key.mod_ctrl, imgui.Key.y)
    assert value(bare, "level") == moved


@pytest.mark.parametrize("by", ["a click with Ctrl", "a double click", "the menu"])
def test_a_value_is_typed_as_an_expression(bare: Bare, by: str) -> None:
    if by == "a click with Ctrl":
        imgui.get_io().add_key_event(imgui.Key.mod_ctrl, True)
        bare.click(LEVEL, 0.2)
        imgui.get_io().add_key_event(imgui.Key.mod_ctrl, False)
    elif by == "a double click":
        bare.click(LEVEL, 0.2, times=2)
    else:
        bare.click(LEVEL, 0.2, button=1)
        bare.click("Type a value")
    bare.run_frames(3)
    assert value(bare, "level") == 0.6, "the click itself has moved nothing"
    bare.type("1/8 + 1/8")
    bare.key(imgui.Key.enter)
    assert value(bare, "level") == 0.25
    assert [list(s.after.values()) for s in bare.bench.undo.history.steps][-1] == [0.25]


def test_an_invalid_value_is_reported_and_escape_leaves_it(bare: Bare) -> None:
    bare.click(LEVEL, 0.2, times=2)
    bare.run_frames(3)
    bare.type("2")
    bare.key(imgui.Key.enter)
    assert value(bare, "level") == 0.6 and "outside its range 0 to 1" in notices_of(bare)
    bare.run_frames(60)
    bare.click(LEVEL, 0.2, times=2)
    bare.run_frames(3)
    bare.type("0.125")
    bare.key(imgui.Key.escape)
    assert value(bare, "level") == 0.6


def test_resets_of_one_of_a_group_and_of_all(bare: Bare) -> None:
    def change() -> None:
        bare.session.drafts.set_all({"height.level": 0.75, "height.count": 5, "height.rough": 2.0})
        bare.run_frames(2)

    change()
    bare.click(f"{LEVEL}-reset")
    assert (value(bare, "level"), value(bare, "count")) == (0.6, 5)
    change()
    bare.click("##reset Shape")
    assert (value(bare, "level"), value(bare, "count"), value(bare, "rough")) == (0.75, 3, 1.0)
    change()
    bare.click("##reset height")
    assert (value(bare, "level"), value(bare, "count"), value(bare, "rough")) == (0.6, 3, 1.0)
    bare.bench.undo.undo()
    assert (value(bare, "level"), value(bare, "count"), value(bare, "rough")) == (0.75, 5, 2.0)
    bare.click("Reset")
    bare.click("All values and techniques")
    assert (value(bare, "level"), value(bare, "count"), value(bare, "rough")) == (0.6, 3, 1.0)


def test_a_padlock_locks_and_random_values_leave_it(bare: Bare) -> None:
    bare.point(LEVEL)
    bare.click("lock height.level")
    assert bare.session.shown is not None and bare.session.shown.edits.locked == ("height.level",)
    bare.click("Random")
    bare.click("Random values")
    assert "Random, seed 1: 6 parameters" in notices_of(bare)
    assert value(bare, "level") == 0.6 and value(bare, "rough") != 1.0
    first = dict(values_of(bare.session.sketch))  # type: ignore[arg-type]
    bare.click("Mutate")
    assert "Mutation, seed 2" in notices_of(bare)
    bare.bench.undo.undo()
    assert values_of(bare.session.sketch) == first, "random values are one step"  # type: ignore[arg-type]


def test_the_search_finds_and_only_changed_ones_show(bare: Bare) -> None:
    bare.type("/")
    bare.run_frames(2)
    bare.type("waves metre")
    bare.places.clear()
    bare.run_frames(2)
    shown = {label for label in bare.places if label.startswith("##height.")}
    assert shown == {"##height.rough"}
    bare.key(imgui.Key.escape)
    bare.run_frames(2)
    assert bare.panel.memory.filter.search == ""
    bare.session.drafts.set("height.count", 5)
    bare.click("Changed##only")
    bare.places.clear()
    bare.run_frames(2)
    assert COUNT in bare.places and LEVEL not in bare.places


def test_saved_value_has_fewest_digits_and_belongs_to_file(bare: Bare, folder: Path) -> None:
    bare.session.drafts.set("height.level", 1 / 3)
    bare.run_frames(2)
    bare.key(imgui.Key.mod_ctrl, imgui.Key.s)
    bare.run_frames(5)
    assert "set = { level = 0.33333334 }" in (folder / "sketch.toml").read_text(encoding="utf-8")
    assert "new value" not in notices_of(bare), "the file says what was set, so nothing gives way"
    bare.bench.undo.undo()
    assert value(bare, "level") == 0.6


def test_panel_footer_lines_fit_at_any_width(bare: Bare) -> None:
    for width in (240.0, 330.0, 620.0):
        bare.bench.panes.remember("panel width", width)
        bare.run_frames(3)
        panel = imgui.internal.find_window_by_name("panel")
        assert panel.content_size.y + 2 * panel.window_padding.y <= panel.size.y + 1, width


@pytest.mark.parametrize("wide", [620, 1280])
def test_no_scale_of_the_window_counts_as_a_pull(bare: Bare, wide: int) -> None:
    imgui.get_io().display_size = ImVec2(wide, 410)
    for width in (240.0, 330.0, 620.0):
        bare.bench.panes.remember("panel width", width)
        for scale in (1.37, 0.689, 1.23, 1.0):
            bare.theme.rescale(scale)
            bare.run_frames(3)
            assert bare.bench.panes.fraction("panel width", 0.0) == width, scale


def test_the_panel_keeps_the_width_to_which_it_is_pulled(bare: Bare) -> None:
    mouse, panes = imgui.get_io(), bare.bench.panes
    mouse.add_mouse_pos_event(PANEL_WIDTH - 1, 300)
    bare.run_frames(2)
    bare.press(True)
    mouse.add_mouse_pos_event(PANEL_WIDTH + 69, 300)
    bare.run_frames(2)
    assert panes.fraction("panel width", 0.0) == 0.0, "nothing is written while it is pulled"
    bare.press(False)
    bare.run_frames(2)
    assert panes.fraction("panel width", 0.0) == PANEL_WIDTH + 70
    bare.panel = Panel()
    bare.run_frames(2)
    assert imgui.internal.find_window_by_name("panel").size.x == PANEL_WIDTH + 70


def test_preset_shows_changes_since_and_new_one_is_saved(bare: Bare, folder: Path) -> None:
    bare.click("##preset")
    bare.click("high")
    assert (value(bare, "level"), value(bare, "count")) == (1.0, 5)
    assert len(bare.bench.undo.history.steps) == 1
    bare.click("Save")
    bare.click("##name")
    bare.type("mine")
    bare.click("Save preset###save preset")
    bare.run_frames(5)
    assert 'name = "mine"' in (folder / "sketch.toml").read_text(encoding="utf-8")
    assert bare.session.sketch is not None and [p.name for p in bare.session.sketch.presets] == [
        "high",
        "mine",
    ]


PRESETS = """# first of all
[[preset]]
name = "low"  # flat
set = { "height.level" = 0.25 }

# as in the Alps
[[preset]]
name = "high"
[preset.set]
"height.level" = 1.0  # the top

[[preset]]
name = "middle"
set = { "height.level" = 0.5 }
"""


def test_presets_are_moved_and_deleted_each_as_one_step(bare: Bare, folder: Path) -> None:
    path = folder / "sketch.toml"
    head = SKETCH.partition("[[preset]]")[0]
    path.write_text(head + PRESETS, encoding="utf-8")
    bare.session.drafts.reload()
    bare.run_frames(5)
    low, high, middle = PRESETS.split("\n\n")

    def names() -> list[str]:
        return [preset.name for preset in bare.session.sketch.presets] if bare.session.sketch else []

    bare.click("…###preset order")
    bare.click("Up###up 1")
    bare.run_frames(5)
    assert names() == ["high", "low", "middle"]
    assert path.read_text(encoding="utf-8") == head + "\n\n".join((high, low, middle))
    bare.click("Delete###delete 0")
    bare.run_frames(5)
    assert names() == ["low", "middle"]
    assert path.read_text(encoding="utf-8") == head + "\n\n".join((low, middle))
    assert [step.name for step in bare.bench.undo.history.steps] == [
        "Move the preset high",
        "Delete the preset high",
    ]
    for expected in (["high", "low", "middle"], ["low", "high", "middle"]):
        bare.bench.undo.undo()
        bare.run_frames(5)
        assert names() == expected
    assert path.read_text(encoding="utf-8") == head + PRESETS
    bare.bench.undo.redo()
    bare.run_frames(5)
    assert names() == ["high", "low", "middle"]


def test_presets_are_moved_and_deleted_by_keys(bare: Bare, folder: Path) -> None:
    path = folder / "sketch.toml"
    path.write_text(SKETCH.partition("[[preset]]")[0] + PRESETS, encoding="utf-8")
    bare.session.drafts.reload()
    bare.run_frames(5)
    io = imgui.get_io()
    io.config_flags |= imgui.ConfigFlags_.nav_enable_keyboard

    def names() -> list[str]:
        bare.run_frames(5)
        return [preset.name for preset in bare.session.sketch.presets] if bare.session.sketch else []

    bare.click("…###preset order")
    bare.click("low###preset 0")
    bare.key(imgui.Key.mod_ctrl, imgui.Key.down_arrow)
    assert names() == ["high", "low", "middle"]
    bare.key(imgui.Key.mod_ctrl, imgui.Key.down_arrow)
    assert names() == ["high", "middle", "low"], "the keys went with it"
    bare.key(imgui.Key.mod_ctrl, imgui.Key.up_arrow)
    assert names() == ["high", "low", "middle"]
    bare.key(imgui.Key.delete)
    assert names() == ["high", "middle"]


def test_a_preset_is_not_written_over_unasked(bare: Bare, folder: Path) -> None:
    path, before = folder / "sketch.toml", (folder / "sketch.toml").read_text(encoding="utf-8")
    bare.session.drafts.set("height.level", 0.125)
    bare.click("Save")
    bare.click("##name")
    bare.type("high")
    bare.key(imgui.Key.enter)
    bare.run_frames(5)
    assert path.read_text(encoding="utf-8") == before and "there is a preset high" in notices_of(bare)
    bare.click("Replace preset###save preset")
    bare.run_frames(5)
    assert path.read_text(encoding="utf-8") != before
    assert bare.session.sketch is not None
    assert dict(bare.session.sketch.presets[0].values)["height.level"] == 0.125


def test_a_preset_that_a_shot_uses_is_not_deleted(bare: Bare, folder: Path) -> None:
    path = folder / "sketch.toml"
    text = SKETCH + '[[shot]]\nname = "top"\npreset = "high"\n'
    path.write_text(text, encoding="utf-8")
    bare.session.drafts.reload()
    bare.run_frames(5)
    bare.bench.actions.delete_preset("high")
    assert any("shot top" in notice.text for notice in bare.bench.notices.items)
    assert path.read_text(encoding="utf-8") == text


def test_the_history_lists_every_step_and_goes_there(bare: Bare) -> None:
    for number in (0.1, 0.2, 0.3):
        bare.session.drafts.set("height.level", number)
        bare.run_frames(90)
    bare.click("History")
    bare.click("Level: the file's to 0.1##1")
    assert value(bare, "level") == 0.1 and bare.bench.undo.history.done == 1
    bare.click("Level: 0.2 to 0.3##3")
    assert value(bare, "level") == 0.3


def test_what_is_set_is_copied(bare: Bare) -> None:
    bare.session.drafts.set_all({"height.level": 0.25, "height.kind": 1})
    bare.click("Copy")
    bare.click("As --set options")
    assert bare.clipboard == "--set height.level=0.25 --set height.kind=sharp"
    bare.run_frames(25)
    bare.click("Copy")
    bare.click("As TOML")
    assert 'set = { level = 0.25, kind = "sharp" }' in bare.clipboard


def test_ctrl_s_saves(bare: Bare, folder: Path) -> None:
    bare.session.drafts.set("height.level", 0.25)
    bare.run_frames(2)
    bare.key(imgui.Key.mod_ctrl, imgui.Key.s)
    assert "set = { level = 0.25 }" in (folder / "sketch.toml").read_text(encoding="utf-8")
    assert bare.bench.actions.saved_picture is None, "and no picture"


def test_pictures_never_replace_one_another(bare: Bare, folder: Path) -> None:
    names = []
    for _ in range(3):
        bare.key(imgui.Key.s)
        names.append(bare.bench.actions.saved_picture.name)  # type: ignore[union-attr]
    stem = bare.session.sketch.name  # type: ignore[union-attr]
    assert names == [f"{stem}.png", f"{stem}-2.png", f"{stem}-3.png"]
    assert sorted(p.name for p in folder.glob("*.png")) == sorted(names)
    bare.bench.actions.folder = folder / "none"
    bare.key(imgui.Key.s)
    assert "nothing can be written here" in bare.bench.notices.items[-1].text
    assert bare.bench.actions.saved_picture.name == names[-1]  # type: ignore[union-attr]


@pytest.mark.parametrize(("size", "scale"), [((1280, 720), 1.0), ((800, 600), 1.0), ((2560, 1440), 2.0)])
def test_nothing_reaches_beyond_the_panel(
    folder: Path, open_bare: OpenBare, size: tuple[int, int], scale: float
) -> None:
    bare = open_bare(folder, size, scale)
    bare.session.drafts.set_all({"height.level": 0.75, "height.count": 5, "height.sun": (90.0, 20.0)})
    bare.places.clear()
    bare.run_frames(3)
    right = PANEL_WIDTH * scale
    for label, (x, _, wide, _) in bare.places.items():
        assert 0 <= x and x + wide <= right, label
    for name, widget in (("level", ""), ("sun", "-elevation")):
        field, cross = bare.places[f"##height.{name}{widget}"], bare.places[f"##height.{name}-reset"]
        assert field[0] + field[2] <= cross[0], "the reset is next to its field"


def test_the_key_map_shows_every_key_and_fits(folder: Path, any_engine: Engine) -> None:
    for size, scale in (((1280, 720), 1.0), ((800, 600), 1.0), ((1600, 1200), 2.0)):
        bare = Bare(any_engine, folder, size, scale)
        bare.type("?")
        bare.run_frames(3)
        window = imgui.internal.find_window_by_name("keys")
        assert window.content_size.x <= window.size.x, "what is too high is scrolled, nothing is cut off"
        assert 0 <= window.pos.x and window.pos.x + window.size.x <= size[0]
        assert 0 <= window.pos.y and window.pos.y + window.size.y <= size[1]
        bare.key(imgui.Key.escape)
        assert not bare.bench.interface.keymap_shown and not bare.quits
        bare.key(imgui.Key.f1)
        assert bare.bench.interface.keymap_shown
        imgui.get_io().add_mouse_pos_event(5, 5)
        bare.press(True)
        bare.press(False)
        assert not bare.bench.interface.keymap_shown
        bare.key(imgui.Key.escape)
        assert not bare.quits and "Ctrl+Q" in notices_of(bare)
        bare.key(imgui.Key.mod_ctrl, imgui.Key.q)
        assert bare.quits
        bare.close()


def test_the_key_map_has_every_key_by_subject() -> None:
    rows = [row for rows in keys_by_subject().values() for row in rows]
    assert len(rows) == len(set(rows)), "each once"
    named = {name for keys, _ in rows for name in keys.split(", ")}
    assert {part for key in all_keys() for part in key.name.split(", ")} <= named
    assert set(GESTURES) <= set(rows)


def test_the_key_map_is_searched_and_scrolled(open_bare: OpenBare, folder: Path) -> None:
    bare = open_bare(folder, (800, 600), 1.0)
    bare.type("?")
    bare.run_frames(3)
    rows = next(w for w in imgui.get_current_context().windows if w.name.startswith("keys/rows"))
    whole = rows.content_size.y
    assert whole > rows.size.y and rows.scroll.y == 0
    bare.key(imgui.Key.down_arrow)
    assert rows.scroll.y > 0
    bare.type("/redo")
    bare.run_frames(3)
    assert bare.bench.interface.keymap_search == "redo" and rows.content_size.y < 100
    for _ in range(3):  # it empties the field, leaves it, closes the map
        assert bare.bench.interface.keymap_shown
        bare.key(imgui.Key.escape)
    assert not bare.bench.interface.keymap_shown
    bare.type("?")
    bare.run_frames(3)
    assert bare.bench.interface.keymap_search == "" and rows.content_size.y == whole


IMAGE = """// terrain.glsl -- a height from an image
#pragma kernel(output = "height:r32f")
uniform sampler2D image;  //! file() label("Elevation")
float kernel(ivec2 texel) { return texelFetch(image, texel % textureSize(image, 0), 0).r; }
"""


def test_an_image_that_is_dropped_is_put_where_a_hand_says(folder: Path, open_bare: OpenBare) -> None:
    write_png(folder / "none.png", np.zeros((4, 4, 4), np.uint8))
    image = folder / "other" / "white.png"
    image.parent.mkdir()
    write_png(image, np.full((4, 4, 4), 255, np.uint8))
    (folder / "terrain.glsl").write_text(IMAGE, encoding="utf-8")
    text = SKETCH[: SKETCH.index("[[preset]]")].replace("level = 0.6", 'image = "none.png"')
    (folder / "sketch.toml").write_text(text, encoding="utf-8")
    bare = open_bare(folder)
    bare.drops.take([image, folder / "other" / "notes.txt"])
    assert "notes.txt is neither a sketch, a shader nor an image" in notices_of(bare)
    bare.run_frames(3)
    bare.click("Elevation   height.image##height.image")
    assert value(bare, "image") == str(image.resolve()) and bare.drops.waiting == []
    assert bare.session.read_values("height:height").max() == 1.0  # type: ignore[union-attr]
    bare.bench.undo.undo()
    assert value(bare, "image") == "none.png"
    bare.drops.take([image, image])
    bare.run_frames(3)
    bare.click("Elevation   height.image##height.image")
    assert len(bare.drops.waiting) == 1, "and the next one waits for a choice"
    bare.bench.undo.undo()
    bare.run_frames(3)
    imgui.get_io().add_mouse_pos_event(1000, 700)
    bare.press(True)
    bare.press(False)
    bare.run_frames(2)
    assert bare.drops.waiting == [] and value(bare, "image") == "none.png", "a click outside it cancels"


def test_a_sketch_that_is_dropped_opens(bare: Bare, folder: Path) -> None:
    other = folder / "two"
    other.mkdir()
    for name in ("terrain.glsl", "sketch.toml"):
        (other / name).write_bytes((folder / name).read_bytes())
    bare.session.drafts.set("height.level", 0.25)
    bare.drops.take([other])
    bare.run_frames(3)
    assert bare.session.path == other / "sketch.toml" and value(bare, "level") == 0.6
    shader = "#version 330\nout vec4 colour;\nvoid main() { colour = vec4(1.0); }\n"
    (other / "plain.frag").write_text(shader, encoding="utf-8")
    bare.drops.take([other / "plain.frag"])
    bare.run_frames(3)
    assert bare.session.path.name == "plain.frag" and bare.session.error is None
    assert bare.session.sketch is not None and bare.session.sketch.name == "plain"
    bare.drops.take([folder / "gone.toml"])
    assert "gone.toml" in notices_of(bare)
    bare.drops.take([folder / "picture.png"])
    assert "picture.png is neither" in notices_of(bare)


@pytest.mark.slow
def test_dropped_dem_opens_alone_and_saves_sketch_beside_it(bare: Bare, folder: Path) -> None:
    dem = folder / "dem.npy"
    np.save(dem, np.add.outer(np.arange(9.0), np.arange(7.0)))
    bare.drops.take([dem])
    bare.run_frames(3)
    assert bare.session.path == dem and bare.session.error is None
    assert bare.session.sketch is not None and bare.session.sketch.title == "dem"
    # Now a parameter takes one; it may still have a sketch of its own.
    bare.drops.take([dem])
    bare.run_frames(3)
    bare.click("Into a sketch of its own")
    assert bare.drops.waiting == [] and bare.session.path == dem
    bare.session.drafts.set("weights.rock_slope", 41.0)
    before = dem.read_bytes()
    bare.bench.actions.save_values()
    assert bare.session.path == folder / "dem.toml" and dem.read_bytes() == before
    assert "rock_slope = 41" in (folder / "dem.toml").read_text("utf-8")
    assert 'elevation = "dem.npy"' in (folder / "dem.toml").read_text("utf-8")


def test_unopenable_sketch_keeps_title_and_path_of_shown_one(
    bare: Bare, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = folder / "two"
    other.mkdir()
    (other / "sketch.toml").write_text("format = 1\n[view", encoding="utf-8")
    bare.drops.take([other])
    paths: list[str] = []
    monkeypatch.setattr(imgui, "text_disabled", lambda text: paths.append(text))
    monkeypatch.setattr(imgui, "set_item_tooltip", lambda text: paths.append(text))
    bare.run_frames()
    assert bare.session.error is not None and bare.session.drafts.opening
    assert str(folder / "sketch.toml") in paths and str(other / "sketch.toml") not in paths
    (other / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    (other / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    bare.session.drafts.reload()
    bare.run_frames()
    paths.clear()
    bare.run_frames()
    assert str(other / "sketch.toml") in paths


def test_a_label_s_tooltip_covers_its_whole_width(bare: Bare, monkeypatch: pytest.MonkeyPatch) -> None:
    explained: list[str] = []
    monkeypatch.setattr(panel_rows, "explain", lambda label, note: explained.append(label))
    bare.run_frames(3)
    x, y, _, high = bare.places["##height.level"]
    assert not tooltip_waits()
    imgui.get_io().add_mouse_pos_event(x - 8, y + high / 2)  # after the label's text, before the slider
    bare.run_frames(3)
    waited = 0
    while not explained:
        assert tooltip_waits() and (waited := waited + 1) < 60, "a window that sleeps would never show it"
        bare.run_frames()
    assert set(explained) == {"Level"}
    bare.run_frames(60)
    assert not tooltip_waits(), "the window may sleep"
    imgui.get_io().add_mouse_pos_event(x + 20, y + high / 2)
    bare.run_frames()
    explained.clear()
    bare.run_frames(60)
    assert not explained and not tooltip_waits()


def test_a_path_that_is_too_long_is_cut_at_its_beginning(bare: Bare) -> None:
    bare.run_frames()
    imgui.new_frame()
    path = "/terrain/of the Alps/lessons/week 3/valleys/dem.tif"
    whole = imgui.calc_text_size(path).x
    for width in (whole + 1, whole / 2, whole / 4):
        text = fitting_path(path, width)
        assert imgui.calc_text_size(text).x <= width and path.endswith(text.removeprefix("…"))
        assert (text == path) == (width > whole)
        assert text.endswith("dem.tif")
    imgui.end_frame()


def test_a_file_field_shows_the_name_its_tooltip_the_path(
    bare: Bare, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (folder / "terrain.glsl").write_text(TERRAIN + 'uniform sampler2D dem; //! file("white.png")\n', "utf-8")
    write_png(folder / "white.png", np.full((4, 4, 4), 255, np.uint8))
    bare.session.drafts.reload()
    flags: list[int] = []
    tooltips: list[str] = []
    draw = imgui.input_text

    def noted(label: str, text: str, flag: int = 0, *more: Any) -> Any:
        flags.extend([flag] if text == "white.png" else [])
        return draw(label, text, flag, *more)

    monkeypatch.setattr(imgui, "input_text", noted)
    monkeypatch.setattr(imgui, "set_tooltip", tooltips.append)
    bare.run_frames(4)
    bare.point("##height.dem")
    bare.run_frames(60)
    assert flags and all(flag & imgui.InputTextFlags_.elide_left for flag in flags)
    assert set(tooltips) == {str(folder / "white.png")}


def test_an_image_has_no_place_where_nothing_takes_a_file(bare: Bare, folder: Path) -> None:
    write_png(folder / "white.png", np.full((4, 4, 4), 255, np.uint8))
    bare.drops.take([folder / "white.png"])
    assert "no parameter of this sketch takes a file" in notices_of(bare) and bare.drops.waiting == []


def test_a_sketch_that_cannot_be_saved_is_offered_as_a_copy(tmp_path: Path, open_bare: OpenBare) -> None:
    bare = open_bare(SKETCHES / "white_noise.toml")
    bare.bench.actions.folder = tmp_path
    bare.session.drafts.set("height.seed", 4)
    bare.run_frames(2)
    bare.key(imgui.Key.mod_ctrl, imgui.Key.s)
    bare.run_frames(3)
    bare.click("Cancel")
    bare.run_frames(5)
    assert list(tmp_path.iterdir()) == []
    bare.key(imgui.Key.mod_ctrl, imgui.Key.s)
    bare.run_frames(3)
    bare.click("Save a copy")
    bare.run_frames(5)
    assert bare.session.path == tmp_path / "white_noise" / "sketch.toml" and value(bare, "seed") == 4


def test_keys_that_come_up_within_the_frame_are_heard(bare: Bare) -> None:
    bare.session.drafts.set("height.level", 0.25)
    bare.run_frames(2)
    events = imgui.get_io()
    events.add_key_event(imgui.Key.mod_ctrl, True)
    bare.run_frames()
    events.add_key_event(imgui.Key.z, True)
    events.add_key_event(imgui.Key.mod_ctrl, False)
    bare.run_frames()
    events.add_key_event(imgui.Key.z, False)
    bare.run_frames(2)
    assert value(bare, "level") == 0.6


# ── panel parts ───────────────────────────────────────────────────────────────


def test_every_widget_of_an_annotation_has_a_control():
    assert CONTROLS.keys() == {kind.control for kind in WIDGETS.values()}


@pytest.mark.parametrize(
    ("parameter", "form"),
    [
        (Parameter("a", "float", 0.0, Widget("slider", 0, 1), step=0.01), "%.2f"),
        (Parameter("a", "float", 0.0, Widget("slider", 0, 1), step=0.125, unit="m"), "%.3f m"),
        (Parameter("a", "float", 0.0, Widget("slider", 0, 1)), "%.3f"),
        (Parameter("a", "float", 0.0, Widget("slider", 0, 5000), unit="%"), "%.0f%%"),
        (Parameter("a", "float", 0.0, Widget("angle", -360, 360)), "%.1f°"),
        (Parameter("a", "float", 0.0, Widget("log_slider", 0.01, 1000), unit="1/m"), "%.4g 1/m"),
        (Parameter("a", "int", 0, Widget("slider", 0, 9), unit="m"), "%d m"),
    ],
)
def test_a_number_is_written_as_finely_as_it_can_be_set(parameter: Parameter, form: str) -> None:
    assert format_of(parameter) == form


def test_a_number_keeps_to_its_steps_and_its_range() -> None:
    parameter = Parameter("a", "float", 0.0, Widget("slider", 0.05, 1.0), step=0.1)
    assert snapped(parameter, 0.312) == pytest.approx(0.35)
    assert snapped(parameter, 0.999) == 0.95 or snapped(parameter, 0.999) == 1.0
    assert snapped(parameter, -4.0) == 0.05
    assert decimals(parameter) == 1


def test_sky_disc_middle_is_zenith_and_rim_is_horizon() -> None:
    assert dot_of(123.0, 90.0) == pytest.approx((0.0, 0.0))
    assert dot_of(90.0, 0.0) == pytest.approx((1.0, 0.0))
    assert dot_of(0.0, 0.0) == pytest.approx((0.0, 1.0))
    assert dot_of(180.0, -40.0) == pytest.approx((0.0, -1.0), abs=1e-12)


@pytest.mark.parametrize("azimuth", [0.0, 45.0, 135.0, 250.0, 359.0])
@pytest.mark.parametrize("elevation", [0.0, 10.0, 60.0])
def test_a_dot_gives_back_its_direction(azimuth: float, elevation: float) -> None:
    assert direction_at(*dot_of(azimuth, elevation)) == pytest.approx((azimuth, elevation), abs=1e-9)


def test_a_dot_outside_the_disc_is_on_the_horizon() -> None:
    assert direction_at(7.0, 0.0) == pytest.approx((90.0, 0.0))


def test_excerpt_lines_are_numbered_dedented_with_column_mark() -> None:
    lines = [(9, "    float a;"), (10, "\tfloat x = foo;"), (11, "")]
    rows, wrong = numbered(lines, 10, 12, 60)
    assert rows == [" 9 | float a;", "10 | float x = foo;", "   |           ^", "11 |"]
    assert wrong == 1
    assert numbered(lines, 10, 0, 60)[0] == [" 9 | float a;", "10 | float x = foo;", "11 |"]


@pytest.mark.parametrize("column", [1, 40, 120, 200])
def test_a_long_line_is_cut_around_its_column(column: int) -> None:
    line = "".join(chr(97 + n % 26) for n in range(200))
    rows, wrong = numbered([(4, "short"), (5, line), (6, "")], 5, column, 44)
    assert all(len(row) <= 44 for row in rows)
    assert rows[wrong][rows[wrong + 1].index("^")] == line[column - 1]


def test_places_are_named_from_the_sketchs_folder(tmp_path: Path) -> None:
    inside = tmp_path / "inc" / "wave.glsl"
    assert short_place(f"{inside}:2:7", str(tmp_path)) == "inc/wave.glsl:2:7"
    assert short_place("glsl/noise/hash.glsl:3", str(tmp_path)) == "glsl/noise/hash.glsl:3"


CAMERA = Camera(azimuth=200.0, elevation=30.0, distance=1000.0)
EYE = look(CAMERA, (1000.0, 1000.0), 100.0, (640, 480))


def project(camera: Camera, point: tuple[float, float, float]) -> np.ndarray:
    """Return where a point of the terrain is in the picture: right and up, -1..1."""
    clip = look(camera, (1000.0, 1000.0), 100.0, (640, 480)).clip_from_world @ np.array([*point, 1.0])
    return clip[:2] / clip[3]


@pytest.mark.parametrize("panning", [False, True])
def test_the_terrain_follows_the_mouse(panning: bool) -> None:
    # A point between the eye and the middle: it is on the near side of the rotation.
    near = tuple(0.7 * t + 0.3 * p for t, p in zip(EYE.target, EYE.position, strict=True))
    point = (near[0], near[1], 50.0)
    gesture = Gesture(480, across=30, down=12, orbiting=not panning, panning=panning)
    moved = project(steered(CAMERA, EYE, gesture), point) - project(CAMERA, point)
    assert moved[0] > 0, "to the right"
    assert moved[1] < 0, "downwards"


def test_the_wheel_brings_the_terrain_nearer_and_back() -> None:
    near = steered(CAMERA, EYE, Gesture(480, wheel=1.0))
    assert near.distance < CAMERA.distance
    eye = look(near, (1000.0, 1000.0), 100.0, (640, 480))
    assert steered(near, eye, Gesture(480, wheel=-1.0)).distance == pytest.approx(CAMERA.distance)


def test_the_eye_never_goes_over_the_top() -> None:
    camera = steered(CAMERA, EYE, Gesture(480, down=5000, orbiting=True))
    assert camera.elevation == 89.0


def test_a_mouse_that_only_passes_does_nothing() -> None:
    assert not Gesture(480, across=10, down=3).acts
    assert steered(CAMERA, EYE, Gesture(480, across=10)) == CAMERA


def test_a_low_panel_scrolls_with_its_head(open_bare: OpenBare, folder: Path) -> None:
    for size, scale in (((1280, 720), 2.0), ((1280, 720), 1.0)):
        bare = open_bare(folder, size, scale)
        imgui.get_io().add_mouse_pos_event(100, 600)
        bare.run_frames(3)
        rows = next(w for w in imgui.get_current_context().windows if w.name.startswith("panel/sections"))
        top = bare.places["History"][1]
        for _ in range(4):
            imgui.get_io().add_mouse_wheel_event(0, -1)
            bare.run_frames(5)
        assert rows.scroll.y > 0 and rows.size.y > 300
        assert (bare.places["History"][1] < top) == (scale == 2.0)


def test_several_loops_of_a_pass_are_folded_until_one_is_stopped(tmp_path: Path, open_bare: OpenBare) -> None:
    raised = "float kernel(ivec2 texel) { return texelFetch(below, texel, 0).r + 0.1; }\n"
    kernel = '#pragma kernel(output = "height:r32f")\nuniform sampler2D below; //! input(zero)\n' + raised
    (tmp_path / "raise.glsl").write_text(kernel, encoding="utf-8")
    inner = '[[pass]]\nname = "{}"\nuse = "./raise"\nrepeat = "{}"\nfeedback = {{ below = "height" }}\n'
    twice = inner.format("low", 3) + inner.format("high", 2) + '[outputs]\nheight = "high:height"\n'
    (tmp_path / "twice.toml").write_text(twice, encoding="utf-8")
    text = "format = 1\nsize = 5\n" + passes(height="./twice") + map_of("height")
    (tmp_path / "sketch.toml").write_text(text, encoding="utf-8")
    bare = open_bare(tmp_path)

    def sliders() -> list[str]:
        bare.places.clear()
        bare.run_frames(2)
        return [label for label in bare.places if label.startswith("##steps of")]

    assert sliders() == []
    for both in (["##steps of height.low", "##steps of height.high"], []):
        bare.run_frames()
        bare.click("Loops: 2###loops")
        assert sliders() == both
    bare.session.stop_at("height.low", 1)
    assert len(sliders()) == 2
