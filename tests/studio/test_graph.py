"""The passes as a graph: what reads what, where each is; thumbnails that are drawn only when stale."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.textures import read_raw
from playground.paths import SKETCHES
from playground.studio.graph.graph import (
    SIDE,
    THUMBNAIL_INTERVAL,
    Thumbnails,
    node_grid,
    picture_of,
    wiring_of,
)

from ..loading import load
from ..sketch_texts import passes
from .panel_desk import Bare, OpenBare
from .session_desk import OpenSession

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


def test_a_pass_is_right_of_all_that_it_reads() -> None:
    random = np.random.default_rng(5)
    for _ in range(30):
        nodes = [f"n{k}" for k in range(int(random.integers(1, 14)))]
        edges = [(a, b) for k, b in enumerate(nodes) for a in nodes[:k] if random.random() < 0.3]
        places = node_grid(nodes, edges)
        assert set(places) == set(nodes) and len(set(places.values())) == len(nodes)
        for node in nodes:
            before = [places[a][0] for a, b in edges if b == node]
            assert places[node][0] == max(before, default=-1) + 1


def test_rows_are_in_the_order_of_what_they_are_joined_to() -> None:
    places = node_grid(("a", "b", "c", "d"), (("a", "d"), ("b", "c")))
    assert places["a"][1] < places["b"][1] and places["d"][1] < places["c"][1]  # no two edges cross


def test_a_sketch_s_passes_and_their_wires() -> None:
    outer = wiring_of(load(SKETCHES / "jacksboro.toml"), inner=False)
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
    inner = wiring_of(load(SKETCHES / "jacksboro.toml"), inner=True)
    assert ("view.sky", "view.land") in inner.edges and len(inner.refs) > 10
    assert all(path in ref for path, ref in inner.refs.items())


@pytest.mark.slow
@pytest.mark.parametrize("path", sorted(SKETCHES.glob("*.toml")), ids=lambda path: path.stem)
def test_every_sketch_that_ships_has_a_graph(path: Path) -> None:
    for inner in (False, True):
        wiring = wiring_of(load(path), inner=inner)
        assert all(wiring.places[a][0] < wiring.places[b][0] for a, b in wiring.edges)


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


def test_a_click_shows_a_texture_and_another_the_view(bare: Bare) -> None:
    graph = bare.bench.inspection.graph
    bare.run_frames(5)
    assert graph.thumbnails.made == 0 and "node colour" not in bare.places
    bare.key(imgui.Key.g)
    bare.run_frames(40)
    assert graph.thumbnails.made == 3 and bare.bench.inspection.patience(0.0) > 1e6
    bare.click("node colour")
    assert bare.session.view.map is not None and bare.session.view.map.ref == "colour:colour"
    bare.click("node view")
    assert bare.session.view.map is None
    bare.key(imgui.Key.g)
    bare.run_frames(3)
    assert graph.thumbnails.get("height:height") is None  # all of them are given back


def test_passes_are_timed_only_on_request(bare: Bare) -> None:
    bare.key(imgui.Key.g)
    bare.run_frames(3)
    assert not bare.session.engine.options.profiling
    bare.click("Time each pass")
    assert bare.session.engine.options.profiling
    bare.key(imgui.Key.g)
    bare.run_frames(3)
    assert not bare.session.engine.options.profiling


@pytest.mark.parametrize("scale", [1.0, 1.5])
def test_the_panel_s_head_has_a_button_for_it_and_room_for_all(
    open_bare: OpenBare, folder: Path, scale: float
) -> None:
    bare = open_bare(folder, (1920, 1080), scale)
    bare.run_frames()
    margin = imgui.get_style().window_padding.x
    for label in "Undo Redo History Random A/B Reset Copy Save PNG Graph".split():
        x, _, width, _ = bare.places[label]
        assert margin <= x and x + width <= bare.panel.width * scale - margin, label
    graph = bare.bench.inspection.graph
    bare.click("Graph")
    assert graph.on
    bare.click("Graph")
    assert not graph.on


def test_a_node_says_why_its_pass_ran_last(bare: Bare, monkeypatch: pytest.MonkeyPatch) -> None:
    bare.key(imgui.Key.g)
    bare.session.drafts.set("colour.tint", (0.1, 0.2, 0.3))
    bare.run_frames(40)  # thumbnails are drawn meanwhile, which is no picture
    tooltips: list[str] = []
    monkeypatch.setattr(imgui, "set_tooltip", tooltips.append)
    for node, why in (("height", "the pass"), ("colour", "value tint"), ("view", "input colour")):
        bare.point(f"node {node}")
        assert tooltips[-1].endswith(f"\nLast ran: {why}")
