"""The passes as a graph: what reads what, where each is; thumbnails that are drawn only when stale."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.textures import read_raw
from playground.paths import SKETCHES
from playground.studio.graph.edits import Catalogue
from playground.studio.graph.graph import (
    MAX_PLACES,
    SIDE,
    THUMBNAIL_INTERVAL,
    Pull,
    Thumbnails,
    picture_of,
    wiring_of,
)
from playground.studio.graph.layout import LANE, Layout, layout_of, nearest_node
from playground.studio.graph.panel import passes_tab
from playground.studio.theme import PANEL_WIDTH

from ..loading import load
from ..sketch_texts import passes
from .panel_desk import Bare, OpenBare
from .session_desk import GOOD, Harness, OpenSession

TERRAIN = """// terrain.glsl -- a slope from west to east
#pragma kernel(output = "height:r32f")
uniform float level = 1.0; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level * float(texel.x) / float(size.x - 1); }
"""
TINT = """// tint.glsl -- a colour
#pragma kernel(output = "colour:rgba16f")
uniform vec3 tint = vec3(0.5, 0.25, 2.0); //! colour The colour
vec4 kernel(ivec2 texel) { return vec4(tint, 1.0); }
"""
BOTH = """// both.glsl -- height and colour
#pragma kernel(output = "frame:rgba8")
uniform sampler2D height; //! input
uniform sampler2D colour; //! input
vec4 kernel(ivec2 texel) {
    return vec4(texelFetch(height, ivec2(0), 0).r + texelFetch(colour, ivec2(0), 0).rgb, 1.0);
}
"""
SKETCH = (
    "format = 1\nsize = [128, 32]\n"
    + passes(height="./terrain", colour="./tint")
    + '[view]\nuse = "./both"\n'
)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    texts = {"terrain.glsl": TERRAIN, "tint.glsl": TINT, "both.glsl": BOTH, "sketch.toml": SKETCH}
    for name, text in texts.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


def overlaps(layout: Layout) -> list[tuple[object, object]]:
    """Return the nodes and lanes of a column that touch."""
    boxes: dict[int, list[tuple[float, float, object]]] = {}
    for node, (column, y) in layout.places.items():
        boxes.setdefault(column, []).append((y - 0.5, y + 0.5, node))
    for lane, y in layout.lanes.items():
        boxes.setdefault(lane[1], []).append((y - LANE / 2, y + LANE / 2, lane))
    pairs = [(a, b) for column in boxes.values() for a, b in combinations(column, 2)]
    return [(a[2], b[2]) for a, b in pairs if a[0] < b[1] - 1e-9 and b[0] < a[1] - 1e-9]


def test_wires_go_to_the_right_and_around_the_nodes() -> None:
    random = np.random.default_rng(5)
    for _ in range(30):
        nodes = [f"n{k}" for k in range(int(random.integers(1, 14)))]
        edges = [(a, b) for k, b in enumerate(nodes) for a in nodes[:k] if random.random() < 0.3]
        layout = layout_of(nodes, edges)
        assert set(layout.places) == set(nodes) and not overlaps(layout)
        for giver, reader in edges:
            first, last = layout.places[giver][0], layout.places[reader][0]
            assert first < last and [c for c, _ in layout.route((giver, reader))] == [*range(first + 1, last)]
        assert min(y - 0.5 for _, y in layout.places.values()) > -1e-9


def test_rows_are_in_the_order_of_what_they_are_joined_to() -> None:
    places = layout_of(("a", "b", "c", "d"), (("a", "d"), ("b", "c"))).places
    assert (places["a"][1] < places["b"][1]) == (places["d"][1] < places["c"][1])  # no two edges cross


def test_arrows_lead_to_the_nearest_node_of_a_side() -> None:
    layout = layout_of(("a", "b", "c", "d"), (("a", "b"), ("a", "c"), ("b", "d"), ("c", "d")))
    assert nearest_node(layout, "a", -1, 0) == "a" and nearest_node(layout, "", 1, 0) == "a"
    assert nearest_node(layout, "a", 1, 0) in "bc" and nearest_node(layout, "d", -1, 0) in "bc"
    high, low = sorted("bc", key=lambda node: layout.places[node][1])
    assert nearest_node(layout, high, 0, 1) == low and nearest_node(layout, low, 0, -1) == high
    assert nearest_node(layout, low, 0, 1) == low


def test_a_sketch_s_passes_and_their_wires() -> None:
    outer = wiring_of(load(SKETCHES / "jacksboro.toml"))
    assert list(outer.refs.items()) == [
        ("height", "height:height"),
        ("colour", "colour:colour"),
        ("light", "light:light"),
        ("view", "view:frame"),
    ]
    assert set(outer.edges) == {
        ("height", "colour"),
        ("height", "light"),
        ("height", "view"),
        ("colour", "view"),
        ("light", "view"),
    }
    assert outer.inputs["colour"] == ("height",) and outer.outputs["view"] == ()
    assert outer.input_for("height", "height", "view") == "height"
    inner = wiring_of(load(SKETCHES / "jacksboro.toml"), "")
    assert ("view.sky", "view.land") in inner.edges and len(inner.refs) > 10
    assert all(path in ref for path, ref in inner.refs.items())


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(SKETCHES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_sketch_that_ships_has_a_graph(path: Path) -> None:
    for inside in (None, ""):
        wiring = wiring_of(load(path), inside)
        places = wiring.layout.places
        assert all(places[a][0] < places[b][0] for a, b in wiring.edges) and not overlaps(wiring.layout)


def test_a_thumbnail_is_what_its_texture_shows(folder: Path, open_session: OpenSession) -> None:
    session = open_session(folder)
    thumbnails = Thumbnails(session)
    assert thumbnails.refresh(["height:height"], 0.0) is False and thumbnails.made == 0  # no picture yet
    session.frame((16, 16))
    assert thumbnails.refresh(["height:height", "colour:colour"], 1.0)
    assert not thumbnails.refresh(["height:height", "colour:colour"], 2.0) and thumbnails.made == 2
    high, tint = thumbnails.get("height:height"), thumbnails.get("colour:colour")
    assert high is not None and tint is not None
    ramp = np.rint(np.arange(SIDE) / (SIDE - 1) * 255)
    np.testing.assert_allclose(read_raw(high)[7, :, 0], ramp, atol=1)
    assert read_raw(high).shape == (SIDE, SIDE, 4) and read_raw(high)[..., 3].min() == 255
    np.testing.assert_array_equal(
        read_raw(tint)[0, 0], [188, 137, 255, 255]
    )  # sRGB of 0.5 and 0.25; 2 is white
    thumbnails.release()


def test_only_what_is_stale_is_drawn_and_one_at_a_time(folder: Path, open_session: OpenSession) -> None:
    session = open_session(folder)
    thumbnails, names = Thumbnails(session), ["height:height", "colour:colour"]
    session.frame((16, 16))
    assert thumbnails.refresh(names, 0.0) and thumbnails.made == 1
    assert thumbnails.refresh(names, 0.5 * THUMBNAIL_INTERVAL) and thumbnails.made == 1  # too soon
    assert not thumbnails.refresh(names, THUMBNAIL_INTERVAL) and thumbnails.made == 2
    assert not thumbnails.refresh(names, 9.0) and thumbnails.made == 2
    session.drafts.set("height.level", 0.5)
    session.frame((16, 16))
    assert not thumbnails.is_current("height:height") and thumbnails.is_current("colour:colour")
    thumbnails.refresh(names, 10.0)
    assert thumbnails.made == 3 and thumbnails.is_current("height:height")
    session.show("colour:colour")  # the terrain is not in this picture: its thumbnail stays
    session.frame((16, 16))
    thumbnails.refresh(names, 11.0)
    assert thumbnails.get("height:height") is not None and not thumbnails.is_current("height:height")
    assert thumbnails.made == 3
    thumbnails.refresh(names[1:], 12.0)
    assert thumbnails.get("height:height") is None
    thumbnails.release()


def test_numbers_that_are_none_are_magenta() -> None:
    values = np.zeros((2, 3, 4), np.float32)
    values[0, 0, 0], values[1, 2, 0], values[1, 1, 0] = np.nan, 5.0, -5.0
    picture = picture_of(values, 1, encoded=False)
    assert picture[0, 0].tolist() == [255, 0, 255, 255]
    assert picture[1, 2].tolist() == [255] * 4 and picture[1, 1].tolist() == [0, 0, 0, 255]
    assert picture_of(np.full((1, 1, 4), 0.5, np.float32), 4, encoded=True)[0, 0].tolist() == [
        128,
        128,
        128,
        255,
    ]


@pytest.fixture
def passes_bare(bare: Bare) -> Bare:
    """Give a panel with the strip's tab of the passes open, and the keys in it."""
    bare.bench.tabs.append(passes_tab(bare.bench))
    bare.bench.panes.show_strip(shown=False)
    bare.run_frames(3)
    bare.key(imgui.Key.g)
    bare.run_frames(40)
    return bare


def settle(bare: Bare) -> None:
    """Draw until what was written is shown."""
    bare.run_frames(4)


def text_of(bare: Bare) -> str:
    return (bare.session.path).read_text(encoding="utf-8")


def names_of(bare: Bare) -> list[str]:
    assert bare.session.sketch is not None
    return [spec.name for spec in bare.session.sketch.graph.passes]


def test_g_opens_the_passes_and_closes_them(passes_bare: Bare) -> None:
    bare, graph = passes_bare, passes_bare.bench.inspection.graph
    assert graph.on and graph.has_keys and graph.thumbnails.made == 3
    assert bare.bench.inspection.patience(0.0) > 1e6
    bare.key(imgui.Key.g)
    bare.run_frames(3)
    assert not graph.on and not graph.has_keys
    assert graph.thumbnails.get("height:height") is None  # all of them are given back


def test_a_click_chooses_and_a_double_click_opens(passes_bare: Bare) -> None:
    bare, graph = passes_bare, passes_bare.bench.inspection.graph
    bare.click("node colour")
    assert graph.chosen == "colour" and bare.session.view.map is None
    bare.click("node colour", times=2)
    assert bare.bench.files.editing[-1].text.path.name == "tint.glsl" and not graph.has_keys
    bare.click("node height")
    bare.click("S height")
    assert bare.session.view.map is not None and bare.session.view.map.ref == "height:height"
    bare.click("S height")
    assert bare.session.view.map is None and text_of(bare) == SKETCH


def test_all_is_done_by_keys_and_undone_byte_for_byte(passes_bare: Bare) -> None:
    bare, graph, key = passes_bare, passes_bare.bench.inspection.graph, imgui.Key
    bare.key(key.right_arrow)
    assert graph.chosen == "height"
    bare.key(key.mod_ctrl, key.d)
    settle(bare)
    assert graph.chosen == "height_2" and names_of(bare) == ["height", "height_2", "colour", "view"]
    texts = [SKETCH, text_of(bare)]
    bare.key(key.mod_ctrl, key.right_arrow)
    settle(bare)
    assert names_of(bare) == ["height", "colour", "height_2", "view"]
    texts.append(text_of(bare))
    bare.key(key.w)
    assert graph.pulled is not None and graph.pulled.giver == "height_2"
    while graph.chosen != "view":
        bare.key(key.right_arrow)
    bare.key(key.enter)
    settle(bare)
    assert bare.session.sketch is not None
    assert ("height", "height_2") in dict(bare.session.sketch.graph.passes[-1].inputs).items()
    texts.append(text_of(bare))
    graph.chosen = "height"
    bare.key(key.delete)
    settle(bare)
    assert names_of(bare) == ["colour", "height_2", "view"] and not graph.chosen
    texts.append(text_of(bare))
    assert len(set(texts)) == 5
    for before in reversed(texts[:-1]):
        bare.key(key.mod_ctrl, key.z)
        settle(bare)
        assert text_of(bare) == before
    for after in texts[1:]:
        bare.key(key.mod_ctrl, key.y)
        settle(bare)
        assert text_of(bare) == after


def test_keys_of_the_window_are_its_own_again_after_esc(passes_bare: Bare) -> None:
    bare = passes_bare
    bare.key(imgui.Key.escape)
    assert not bare.bench.inspection.graph.has_keys
    bare.key(imgui.Key.m)
    assert bare.session.view.map is not None and text_of(bare) == SKETCH


def test_an_undo_leaves_what_was_edited_elsewhere(passes_bare: Bare) -> None:
    bare = passes_bare
    assert bare.bench.passes.duplicate("colour") == "colour_2"
    settle(bare)
    text = text_of(bare)
    bare.session.path.write_text("# mine\n" + text, encoding="utf-8")
    bare.session.drafts.reload()
    settle(bare)
    bare.bench.undo.undo()
    settle(bare)
    assert text_of(bare) == "# mine\n" + SKETCH
    bare.bench.undo.redo()
    settle(bare)
    clash = text_of(bare).replace('name = "colour_2"', 'name = "other"')
    bare.session.path.write_text(clash, encoding="utf-8")
    bare.session.drafts.reload()
    settle(bare)
    bare.bench.undo.undo()
    settle(bare)
    assert text_of(bare) == clash and any("changed" in note.text for note in bare.bench.notices.items)


def test_values_that_are_not_saved_outlive_an_edit_of_the_passes(passes_bare: Bare) -> None:
    bare = passes_bare
    bare.session.drafts.set("height.level", 0.5)
    bare.run_frames(2)
    bare.bench.passes.duplicate("colour")
    settle(bare)
    assert bare.session.shown is not None and dict(bare.session.shown.edits.values) == {"height.level": 0.5}
    bare.bench.undo.undo()
    settle(bare)
    assert text_of(bare) == SKETCH and dict(bare.session.shown.edits.values) == {"height.level": 0.5}
    bare.bench.undo.undo()
    settle(bare)
    assert text_of(bare) == SKETCH and not bare.session.shown.edits.values


def test_a_pass_that_cannot_be_drawn_is_undone(passes_bare: Bare) -> None:
    """The picture stays, the file says what was asked for, and an edit more or an undo goes on from it."""
    bare = passes_bare
    (bare.session.path.parent / "broken.glsl").write_text(
        '#pragma kernel(output = "height:r32f")\nuniform sampler2D height; //! input\n'
        "float kernel(ivec2 texel) { return nothing; }\n",
        encoding="utf-8",
    )
    assert bare.bench.passes.add("./broken", "height") == "broken"
    settle(bare)
    assert bare.session.error is not None and "broken" in text_of(bare) and names_of(bare)[1] == "colour"
    assert bare.bench.passes.duplicate("colour") == "colour_2"
    settle(bare)
    for _ in range(2):
        bare.bench.undo.undo()
        settle(bare)
    assert bare.session.error is None and text_of(bare) == SKETCH


def test_edits_in_a_row_do_not_wait_for_the_picture(passes_bare: Bare) -> None:
    edits = passes_bare.bench.passes
    assert edits.duplicate("height") == "height_2" and edits.duplicate("height_2") == "height_3"
    assert edits.delete("height_2")
    settle(passes_bare)
    assert names_of(passes_bare) == ["height", "height_3", "colour", "view"]


def test_the_same_edit_twice_is_two_steps(passes_bare: Bare) -> None:
    bare, edits = passes_bare, passes_bare.bench.passes
    assert edits.duplicate("colour") and edits.duplicate("colour")
    settle(bare)
    bare.bench.undo.undo()
    settle(bare)
    assert names_of(bare) == ["height", "colour", "colour_2", "view"]


def test_a_wire_is_dragged_and_one_that_closes_a_circle_refused(
    passes_bare: Bare, monkeypatch: pytest.MonkeyPatch
) -> None:
    bare, edits = passes_bare, passes_bare.bench.passes
    edits.duplicate("height")
    settle(bare)
    bare.bench.inspection.graph.leave()
    tooltips: list[str] = []
    monkeypatch.setattr(imgui, "set_tooltip", tooltips.append)

    def drag(giver: str, reader: str) -> None:
        bare.run_frames(3)
        x, y, wide, high = bare.places[f"node {giver}"]
        imgui.get_io().add_mouse_pos_event(x + wide + 6, y + high / 2)
        bare.run_frames(2)
        bare.press(True)
        assert bare.bench.inspection.graph.pulled == Pull(giver, "height")
        x, y, wide, high = bare.places[f"node {reader}"]
        for share in (0.2, 0.5):
            imgui.get_io().add_mouse_pos_event(x + share * wide, y + high / 2)
            bare.run_frames(2)
        bare.press(False)
        settle(bare)

    drag("height_2", "view")
    assert bare.session.sketch is not None
    assert dict(bare.session.sketch.graph.passes[-1].inputs)["height"] == "height_2"
    text = text_of(bare)
    drag("height_2", "height")
    assert text_of(bare) == text and any("input" in words for words in tooltips)


def test_a_wire_let_go_in_the_empty_asks_what_to_add(passes_bare: Bare) -> None:
    bare, graph = passes_bare, passes_bare.bench.inspection.graph
    x, y, wide, high = bare.places["node colour"]
    imgui.get_io().add_mouse_pos_event(x + wide + 6, y + high / 2)
    bare.run_frames(2)
    bare.press(True)
    left, top, _, _ = bare.places["canvas"]
    imgui.get_io().add_mouse_pos_event(left + 20, top + 10)
    bare.run_frames(2)
    bare.press(False)
    assert graph.chooser.is_open and (graph.chooser.after, graph.chooser.output) == ("colour", "colour")
    bare.key(imgui.Key.escape)
    assert not graph.chooser.is_open and text_of(bare) == SKETCH


def test_the_chooser_adds_what_is_searched_for_behind_a_node(passes_bare: Bare) -> None:
    bare, graph = passes_bare, passes_bare.bench.inspection.graph
    bare.key(imgui.Key.right_arrow)
    imgui.get_io().add_input_character(ord("+"))
    bare.run_frames(4)
    assert graph.chooser.is_open
    bare.type("smoo")
    bare.run_frames(3)
    assert graph.chooser.search == "smoo"
    assert graph.entries(graph.wiring(bare.session.sketch))[0].use == "generation/smooth"
    bare.key(imgui.Key.enter)
    settle(bare)
    assert names_of(bare) == ["height", "smooth", "colour", "view"] and graph.chosen == "smooth"
    assert dict(bare.session.sketch.graph.passes[-1].inputs) == {"height": "smooth"}


def test_what_goes_on_from_an_output_is_offered_first() -> None:
    catalogue = Catalogue()
    catalogue.begin(load(SKETCHES / "mixed.toml"))
    wanted = ["erosion/thermal", "texturing/height_blend", "generation/fbm", "lighting/mean_filter"]
    for use in wanted:
        catalogue.go_on(use, 0.0)
    assert [entry.use for entry in catalogue.found("", ("height",))] == wanted
    assert [e.use for e in catalogue.found("noise", ())] == []
    assert all(entry.title for entry in catalogue.entries.values())


def test_a_muted_pass_leaves_the_picture_and_not_the_file(passes_bare: Bare) -> None:
    bare, edits = passes_bare, passes_bare.bench.passes
    edits.add("generation/smooth", "height")
    settle(bare)
    ran = bare.session.engine.runs["smooth"]
    edits.mute("smooth")
    settle(bare)
    plan = bare.session.plan
    assert plan is not None and "smooth" in bare.session.view.muted
    assert not any(path.startswith("smooth") for path in bare.session.engine.record.results)
    edits.mute("smooth")
    settle(bare)
    assert not bare.session.view.muted and bare.session.engine.runs["smooth"] >= ran
    edits.mute("height")
    bare.run_frames(2)
    assert not bare.session.view.muted and "height" in bare.bench.notices.items[-1].text


def test_a_shipped_sketch_is_offered_as_a_copy(open_bare: OpenBare) -> None:
    bare = open_bare(SKETCHES / "fbm.toml")
    assert bare.bench.passes.duplicate("height") == ""
    assert bare.bench.file.asks and "playground itself" in bare.bench.file.offer
    assert not bare.bench.undo.history.can_undo


def test_passes_are_timed_while_their_graph_is_shown(passes_bare: Bare) -> None:
    bare = passes_bare
    assert bare.session.engine.options.profiling
    bare.click("Time each pass###timed")
    bare.run_frames(2)
    assert not bare.session.engine.options.profiling
    bare.click("Time each pass###timed")
    bare.key(imgui.Key.g)
    bare.run_frames(3)
    assert not bare.session.engine.options.profiling


@pytest.mark.parametrize("scale", [1.0, 1.5])
def test_the_panel_s_head_has_a_button_for_it_and_room_for_all(
    open_bare: OpenBare, folder: Path, scale: float
) -> None:
    bare = open_bare(folder, (1920, 1080), scale)
    bare.bench.tabs.append(passes_tab(bare.bench))
    bare.run_frames()
    margin = imgui.get_style().window_padding.x
    for label in "Undo Redo History Random A/B Reset Copy Save PNG Graph".split():
        x, _, width, _ = bare.places[label]
        assert margin <= x and x + width <= PANEL_WIDTH * scale - margin, label
    graph = bare.bench.inspection.graph
    assert graph.on
    bare.click("Graph")
    assert not graph.on
    bare.click("Graph")
    assert graph.on


def test_a_node_says_why_its_pass_ran_last(passes_bare: Bare, monkeypatch: pytest.MonkeyPatch) -> None:
    bare = passes_bare
    bare.session.drafts.set("colour.tint", (0.1, 0.2, 0.3))
    bare.run_frames(40)  # thumbnails are drawn meanwhile, which is no picture
    tooltips: list[str] = []
    monkeypatch.setattr(imgui, "set_tooltip", tooltips.append)
    for node, why in (("height", "the pass"), ("colour", "value tint"), ("view", "input colour")):
        bare.point(f"node {node}", 0.3)
        bare.run_frames(60)
        assert tooltips[-1].endswith(f"\nLast ran because of: {why}")


# ── nodes that are moved, wires that get a pass, all by keys ──────────────────


def drag_node(bare: Bare, node: str, x: float, y: float, *, release: bool = True) -> None:
    """Drag a node by its picture to a place in the window."""
    bare.point(f"node {node}", 0.2)
    bare.press(True)
    start = imgui.get_mouse_pos()
    for share in (0.3, 0.7, 1.0):
        imgui.get_io().add_mouse_pos_event(start.x + share * (x - start.x), start.y + share * (y - start.y))
        bare.run_frames()
    if release:
        bare.press(False)
        settle(bare)


def middle(bare: Bare, giver: str, reader: str) -> tuple[float, float]:
    """Return the middle of a wire between pins in the middle of their nodes."""
    bare.run_frames(2)
    a, b = bare.places[f"node {giver}"], bare.places[f"node {reader}"]
    return (a[0] + a[2] + b[0]) / 2, (a[1] + a[3] / 2 + b[1] + b[3] / 2) / 2


CHAIN = (
    "# A chain.\nformat = 1\nsize = [128, 32]\n\n"
    '[[pass]]\nname = "height"\nuse  = "./terrain"  # the land\n\n'
    '[[pass]]\nname   = "one"\nuse    = "generation/smooth"\ninputs = { height = "height" }\n\n'
    '[[pass]]\nname   = "two"\nuse    = "generation/smooth"\ninputs = { height = "one" }\n\n'
    '[[pass]]\nname = "aside"\nuse  = "generation/smooth"\ninputs = { height = "height" }\n\n'
    '[[pass]]\nname = "colour"\nuse  = "./tint"\n\n'
    '[view]\nuse    = "./both"\ninputs = { height = "two" }\n'
)


@pytest.fixture
def chain(passes_bare: Bare) -> Bare:
    """Give the tab of a chain of passes."""
    passes_bare.session.path.write_text(CHAIN, encoding="utf-8")
    passes_bare.session.drafts.reload()
    passes_bare.run_frames(10)
    return passes_bare


def fed(bare: Bare) -> set[tuple[str, str]]:
    sketch = bare.bench.inspection.graph.sketch
    assert sketch is not None
    return set(wiring_of(sketch).edges)


def test_a_node_that_is_dragged_stays_there_alone(chain: Bare) -> None:
    bare, graph = chain, chain.bench.inspection.graph
    left, top, _, _ = bare.places["canvas"]
    bare.run_frames(2)
    before = dict(bare.places)
    drag_node(bare, "aside", left + 150, top + 20)
    assert list(bare.session.view.places) == ["aside"] and text_of(bare) == CHAIN
    nodes = ("height", "one", "two", "colour", "view")
    assert all(bare.places[f"node {node}"] == before[f"node {node}"] for node in nodes)
    x, y, wide, _ = bare.places["node aside"]
    assert abs(x + 0.2 * wide - left - 150) < 2 and y < top + 20
    bare.bench.passes.delete("two")
    settle(bare)
    assert list(bare.session.view.places) == ["aside"], "an edit moves it nowhere"
    bare.bench.passes.delete("aside")
    settle(bare)
    assert not bare.session.view.places
    for number in range(MAX_PLACES + 3):
        graph.place(f"n{number}", (0.0, 0.0))
    assert len(bare.session.view.places) == MAX_PLACES and "n0" not in bare.session.view.places
    graph.tidy()
    assert not bare.session.view.places


def test_a_node_dropped_on_a_wire_goes_between(chain: Bare) -> None:
    bare = chain
    drag_node(bare, "aside", *middle(bare, "one", "two"))
    assert {("one", "aside"), ("aside", "two")} <= fed(bare) and ("one", "two") not in fed(bare)
    assert "# A chain." in text_of(bare) and "# the land" in text_of(bare)
    assert "aside" not in bare.session.view.places
    bare.bench.undo.undo()
    settle(bare)
    assert text_of(bare) == CHAIN


def test_a_node_that_does_not_fit_a_wire_is_red(chain: Bare, monkeypatch: pytest.MonkeyPatch) -> None:
    bare, tooltips = chain, list[str]()
    monkeypatch.setattr(imgui, "set_tooltip", tooltips.append)
    drag_node(bare, "colour", *middle(bare, "one", "two"), release=False)
    assert "no input" in tooltips[-1]
    bare.press(False)
    settle(bare)
    assert text_of(bare) == CHAIN and not bare.session.view.places, "it goes back"
    assert "no input" in bare.bench.notices.items[-1].text


def test_a_plus_on_a_wire_offers_what_fits_there(chain: Bare) -> None:
    bare, graph = chain, chain.bench.inspection.graph
    imgui.get_io().add_mouse_pos_event(*middle(bare, "one", "two"))
    bare.run_frames(3)
    bare.press(True)
    bare.press(False)
    bare.run_frames(3)
    assert graph.chooser.is_open and graph.chooser.on is not None and graph.chooser.on.reader == "two"
    graph.chooser.catalogue.go_on("", 20.0)
    entries = graph.entries(graph.wiring(bare.session.sketch))
    assert len(entries) > 10 and all(
        e.inputs and 1 in [*e.outputs.values(), *("height" in e.outputs,)] for e in entries
    )
    bare.type("thermal")
    bare.run_frames(2)
    bare.key(imgui.Key.enter)
    settle(bare)
    assert {("one", "thermal"), ("thermal", "two")} <= fed(bare) and ("one", "two") not in fed(bare)
    bare.key(imgui.Key.mod_ctrl, imgui.Key.z)
    settle(bare)
    assert text_of(bare) == CHAIN


def test_menus_of_a_wire_and_of_the_graph(chain: Bare) -> None:
    bare, graph = chain, chain.bench.inspection.graph
    x, y = middle(bare, "one", "two")
    imgui.get_io().add_mouse_pos_event(x - 12, y)
    bare.run_frames(2)
    bare.press(True, 1)
    bare.press(False, 1)
    bare.run_frames(2)
    bare.click("Disconnect###cut wire")
    settle(bare)
    assert ("one", "two") not in fed(bare)
    bare.bench.undo.undo()
    settle(bare)
    assert text_of(bare) == CHAIN
    graph.place("aside", (0.5, 3.0))
    left, top, _, high = bare.places["canvas"]
    imgui.get_io().add_mouse_pos_event(left + 4, top + high - 4)
    bare.run_frames(2)
    bare.press(True, 1)
    bare.press(False, 1)
    bare.run_frames(2)
    bare.click("Tidy: place all nodes anew###tidy graph")
    assert not bare.session.view.places


def test_wires_and_places_by_keys(chain: Bare) -> None:
    bare, graph, key = chain, chain.bench.inspection.graph, imgui.Key
    graph.chosen = "two"
    bare.key(key.mod_shift, key.left_arrow)
    assert graph.wire == ("two", "height")
    bare.key(key.insert)
    bare.run_frames(2)
    assert graph.chooser.is_open and graph.chooser.on is not None
    bare.key(key.escape)
    assert not graph.chooser.is_open and graph.has_keys
    bare.key(key.delete)
    settle(bare)
    assert ("one", "two") not in fed(bare) and ("height", "two") in fed(bare), "found by its name again"
    bare.key(key.mod_ctrl, key.z)
    settle(bare)
    assert text_of(bare) == CHAIN
    graph.chosen, places = "two", graph.wiring(bare.session.sketch).layout.places
    bare.key(key.mod_ctrl, key.mod_shift, key.down_arrow)
    assert bare.session.view.places["two"][1] == pytest.approx(places["two"][1] + 0.5)
    bare.key(key.t)
    assert not bare.session.view.places and bare.bench.tracing.on is False
    graph.chosen = "height"
    seen = []
    for _ in range(6):
        bare.key(key.tab)
        seen.append(graph.chosen)
    assert sorted(seen) == sorted(graph.wiring(bare.session.sketch).refs) and bare.bench.interface.panel_shown
    bare.key(key.mod_shift, key.tab)
    assert graph.chosen == seen[-2]


def test_arrows_follow_the_wires(chain: Bare) -> None:
    bare, graph, key = chain, chain.bench.inspection.graph, imgui.Key
    graph.chosen, seen = "two", []
    for arrow in (key.left_arrow, key.left_arrow, key.right_arrow):
        bare.key(arrow)
        seen.append(graph.chosen)
    assert seen[:2] == ["one", "height"] and seen[2] in ("one", "aside")
    graph.place("one", (9.0, 0.0))
    graph.chosen = "view"
    bare.key(key.right_arrow)
    assert graph.chosen == "one", "a node that was moved is reached where it is"


def test_a_node_opens_and_esc_leads_out(passes_bare: Bare) -> None:
    bare, graph, key = passes_bare, passes_bare.bench.inspection.graph, imgui.Key
    bare.session.path.write_text(
        SKETCH.replace("./terrain", "generation/mixed").replace("[128, 32]", "33"), encoding="utf-8"
    )
    bare.session.drafts.reload()
    bare.run_frames(10)
    graph.chosen = "height"
    bare.key(key.enter)
    bare.run_frames(2)
    inner = graph.wiring(bare.session.sketch).refs
    assert graph.inside == "height" and len(inner) > 5 and all(node.startswith("height.") for node in inner)
    bare.key(key.right_arrow)
    bare.key(key.enter)
    assert bare.bench.files.editing[-1].text.path.suffix in (".glsl", ".toml") and graph.inside == "height"
    graph.has_keys = True
    bare.key(key.escape)
    assert graph.inside is None and graph.chosen == "height" and graph.has_keys
    bare.key(key.escape)
    assert not graph.has_keys


def test_places_are_remembered_by_sketch(harness: Harness) -> None:
    harness.session.view.places["height"] = (2.5, -1.0)
    harness.frame()
    harness.close()
    harness.start("one")
    harness.frame()
    assert harness.session.view.places == {"height": (2.5, -1.0)}
    harness.drops.take([harness.folder / "two" / "sketch.toml"])
    harness.answer(GOOD)
    harness.frame()
    assert harness.name == "two" and not harness.session.view.places
