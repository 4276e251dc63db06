"""Sliders: where imgui draws the knob, that the number keeps clear of it, the parts of a vector."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import imgui_bundle
import numpy as np
import pytest
from imgui_bundle import ImVec2, imgui

from playground.sketch.assign import values_of
from playground.sketch.model import Parameter
from playground.studio.theme import Theme
from playground.studio.widgets import knob_of, part_names, place_of_number, slide, slide_whole

from ..sketch_texts import map_of_height
from .panel_desk import Bare, OpenBare

WIDE = 150.0
TERRAIN = """// terrain.glsl -- a slope
#pragma kernel(output = "height:r32f")
uniform vec4 corners = vec4(0.25, 0.25, 0.25, 0.25); //! slider(0, 1) parts("SW", "SE", "NW", "NE") Heights
uniform ivec2 part = ivec2(0); //! parts("east", "north") Which
uniform int method = 0; //! menu("a choice whose name is longer than any closed list is wide", "b")
float kernel(ivec2 texel) { return corners.x + float(part.x) + float(method); }
"""
SKETCH = "format = 1\nsize = 33\n" + map_of_height()


@pytest.fixture
def screen() -> Iterator[Theme]:
    context = imgui.create_context()
    io = imgui.get_io()
    io.set_ini_filename("")
    io.display_size = ImVec2(400, 200)
    io.backend_flags |= imgui.BackendFlags_.renderer_has_textures
    yield Theme(Path(imgui_bundle.__file__).parent / "assets" / "fonts")
    imgui.destroy_context(context)


def drawn_knob(draw: object) -> tuple[float, float]:
    """Draw a slider and return where imgui has drawn its knob, from the slider's left edge."""
    for _ in range(2):
        imgui.new_frame()
        imgui.begin("w")
        imgui.set_next_item_width(WIDE)
        draw()  # type: ignore[operator]
        left = imgui.get_item_rect_min().x
        imgui.end()
        imgui.render()
        for texture in imgui.get_platform_io().textures:
            texture.set_status(imgui.ImTextureStatus.ok)
    ink = imgui.get_color_u32(imgui.Col_.slider_grab)
    lists = imgui.get_draw_data().cmd_lists
    xs = [v.pos.x - left for part in lists for v in part.vtx_buffer if v.col == ink]
    return min(xs), max(xs)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.5, 1.0])
def test_the_knob_is_where_imgui_draws_it(screen: Theme, share: float) -> None:
    least = imgui.get_style().grab_min_size
    for drawn, computed in (
        (drawn_knob(lambda: slide("##a", share, (0.0, 1.0), "%.2f")), knob_of(share, WIDE, least)),
        (
            drawn_knob(lambda: slide("##b", 100.0**share, (1.0, 100.0), "%.2f", logarithmic=True)),
            knob_of(share, WIDE, least),
        ),
        (
            drawn_knob(lambda: slide_whole("##c", round(10 * share), (0, 10), str)),
            knob_of(share, WIDE, least, 11),
        ),
    ):
        np.testing.assert_allclose(drawn, computed, atol=1.5)  # imgui rounds to whole pixels and their edges


@pytest.mark.parametrize("text", [10.0, 40.0, 65.0])
def test_a_number_keeps_clear_of_the_knob_and_inside_the_slider(text: float) -> None:
    for share in np.linspace(0, 1, 101):
        knob = knob_of(float(share), WIDE, 9.0)
        start = place_of_number(WIDE, text, knob, 3.0)
        assert start >= 0 and start + text <= WIDE
        assert start + text <= knob[0] or knob[1] <= start


def test_a_number_far_from_the_knob_is_in_the_middle() -> None:
    assert place_of_number(WIDE, 40.0, knob_of(0.0, WIDE, 9.0), 3.0) == (WIDE - 40.0) / 2


@pytest.fixture
def bare(tmp_path: Path, open_bare: OpenBare) -> Bare:
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    made = open_bare(tmp_path)
    return made


def test_vector_parameter_has_one_stacked_slider_per_component(bare: Bare) -> None:
    names = ["SW", "SE", "NW", "NE"]
    heights = [bare.places[f"##height.corners.{name}"][1] for name in names]
    assert heights == sorted(heights) and len(set(heights)) == 4
    bare.drag("##height.corners.NW", 0.25, 0.9)
    assert bare.session.sketch is not None
    south_west, south_east, north_west, north_east = values_of(bare.session.sketch)["height.corners"]  # type: ignore[misc]
    assert (south_west, south_east, north_east) == (0.25, 0.25, 0.25) and north_west > 0.8
    assert {"##height.part.east", "##height.part.north"} <= set(bare.places)


def test_a_part_is_typed_by_a_double_click_like_any_number(bare: Bare) -> None:
    bare.click("##height.corners.SE", 0.9, times=2)
    bare.run_frames(3)
    bare.type("0.1,0.2,0.3,0.4")
    bare.key(imgui.Key.enter)
    assert bare.session.sketch is not None
    assert values_of(bare.session.sketch)["height.corners"] == (0.1, 0.2, 0.3, 0.4)


def test_parts_without_names_are_x_y_z_w() -> None:
    assert part_names(Parameter("a", "vec3", (0.0, 0.0, 0.0))) == ("x", "y", "z")
    assert part_names(Parameter("a", "float", 0.0)) == ()
