"""The group Terrain under a mouse and keys: metres and feet, exaggeration, looks, the sun, views."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from imgui_bundle import imgui

from playground.paths import SKETCHES
from playground.sketch.model import Camera
from playground.studio.edits.edits import Draft
from playground.studio.land.land import Land, aspect_sizes, from_above, level_items, north_up, sun_items
from playground.studio.land.looks import look_of
from playground.studio.session import TURN, Session

from ..sketch_texts import SMALL_VIEW, map_of, passes
from .panel_desk import Bare, OpenBare
from .session_desk import OpenSession

FILES = {
    "hills.glsl": """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return float(texel.x) / float(size.x - 1); }
""",
    "stripes.glsl": """#pragma kernel(output = "colour:rgba8")
vec4 kernel(ivec2 texel) { return vec4(float(texel.x % 2)); }
""",
    "flat.toml": "format = 1\nsize = 33\n" + passes(stripes="./stripes") + map_of("stripes"),
    "sketch.toml": "format = 1\nsize = [33, 17]\nextent = [640.0, 320.0]\nrelief = 100.0\n"
    + passes(height="./hills", light="lighting/l_dot_n")
    + SMALL_VIEW,
}


@pytest.fixture
def bare(bare: Bare) -> Bare:
    """Give a panel whose group Terrain is open, as it is delivered."""
    bare.bench.interface.preferences.choose(panes={})
    bare.run_frames(2)
    return bare


def test_the_group_stays_as_it_was_left(bare: Bare) -> None:
    bare.click("Terrain###terrain")
    bare.places.clear()
    bare.run_frames(2)
    assert "##land.relief" not in bare.places
    assert bare.bench.interface.preferences.panes == {"terrain": 0.0}
    bare.click("Terrain###terrain")
    bare.run_frames(2)
    assert "##land.relief" in bare.places


def sketch_of(bare: Bare) -> Draft:
    shown = bare.session.shown
    assert shown is not None
    return shown


def typed(bare: Bare, label: str, text: str) -> None:
    bare.click(label, times=2)
    bare.run_frames(3)
    bare.key(imgui.Key.mod_ctrl, imgui.Key.a)
    bare.type(text)
    bare.key(imgui.Key.enter)
    bare.run_frames(4)


def test_metres_are_typed_in_metres_or_feet_and_undone(bare: Bare) -> None:
    typed(bare, "##land.relief", "250")
    assert sketch_of(bare).sketch.terrain.relief == 250.0
    bare.click("ft###unit ft")
    assert bare.bench.interface.preferences.is_in_feet
    typed(bare, "##land.relief", "1000")
    assert sketch_of(bare).sketch.terrain.relief == pytest.approx(304.8)
    bare.key(imgui.Key.mod_ctrl, imgui.Key.z)
    assert sketch_of(bare).sketch.terrain.relief == 250.0
    bare.click("##land.relief-reset")
    assert sketch_of(bare).sketch.terrain.relief == 100.0


def test_extent_size_and_base_elevation(bare: Bare) -> None:
    typed(bare, "##land.extent.y", "400")
    typed(bare, "##land.base_elevation", "-12.5")
    bare.click("##land.size")
    bare.key(imgui.Key.mod_ctrl, imgui.Key.a)
    bare.type("65x33")
    bare.key(imgui.Key.enter)
    sketch = sketch_of(bare).sketch.terrain
    assert (sketch.extent, sketch.base_elevation, sketch.size) == ((640.0, 400.0), -12.5, (65, 33))
    assert bare.session.plan is not None and bare.session.plan.terrain.size == (65, 33)
    bare.click("##land.size")
    bare.key(imgui.Key.mod_ctrl, imgui.Key.a)
    bare.type("many")
    bare.key(imgui.Key.enter)
    assert sketch_of(bare).sketch.terrain.size == (65, 33)
    assert any("size" in notice.text for notice in bare.bench.notices.items)


def test_the_sea_is_where_headers_say_and_in_the_unit(bare: Bare) -> None:
    assert [item.path for item in level_items(sketch_of(bare))] == ["view.sea_level"]
    bare.click("ft###unit ft")
    typed(bare, "##land.view.sea_level", "100")
    assert dict(sketch_of(bare).edits.values) == {"view.sea_level": 30.48}
    bare.click("##land.view.sea_level-reset")
    assert not sketch_of(bare).edits.values


def test_where_there_is_no_land_the_group_says_so(open_bare: OpenBare, folder: Path) -> None:
    bare = open_bare(folder / "flat.toml")
    bare.watch(imgui, "text_disabled")
    bare.bench.interface.preferences.choose(panes={})
    bare.run_frames(3)
    assert "##land.size" in bare.places and "##land.relief" not in bare.places
    assert any("no heights" in label for label in bare.places)


def test_metres_are_saved_into_the_sketch(bare: Bare) -> None:
    bare.click("×2###times2")
    typed(bare, "##land.relief", "250")
    bare.bench.actions.save_values()
    bare.run_frames(30, step=0.1)
    assert "relief = 250" in (bare.session.path).read_text(encoding="utf-8")
    assert bare.session.exaggeration == 2.0 and bare.session.error is None


def test_exaggeration_is_of_the_view_until_it_is_made_the_relief(bare: Bare) -> None:
    bare.click("×2###times2")
    assert bare.session.exaggeration == 2.0 and not sketch_of(bare).edits.values
    bare.click("Make it the relief###keep")
    assert bare.session.exaggeration == 1.0 and sketch_of(bare).sketch.terrain.relief == 200.0
    bare.click("×3###times3")
    bare.click("×1###times1")
    assert bare.session.exaggeration == 1.0 and sketch_of(bare).sketch.terrain.relief == 200.0


def test_a_look_is_chosen_and_natural_is_the_sketchs_own(bare: Bare) -> None:
    for chosen, name in (("Clay", "clay"), ("Natural", None)):
        bare.click("##land.look")
        bare.click(chosen)
        look = bare.session.view.look
        assert (look.name if look else None) == name and bare.session.error is None


def test_contour_lines_are_a_round_number_of_the_unit_apart(bare: Bare) -> None:
    bare.click("##land.look")
    bare.click("Contours")
    bare.run_frames(2)
    assert interval_of(bare) == 5.0, "20 lines on 100 m"
    bare.click("ft###unit ft")
    bare.run_frames(2)
    assert interval_of(bare) == pytest.approx(20 * 0.3048), "16 lines on 328 ft"
    typed(bare, "##land.interval", "50")
    assert interval_of(bare) == pytest.approx(50 * 0.3048) and bare.session.error is None


def interval_of(bare: Bare) -> float | None:
    look = bare.session.view.look
    return look.interval if look is not None else None


def test_views_are_kept_and_gone_back_to(bare: Bare) -> None:
    bare.click("Camera###camera")
    bare.click("From above###above")
    assert sketch_of(bare).sketch.camera.elevation == 89.0
    bare.click("1###view 1", button=1)
    bare.session.drafts.set_camera(Camera(azimuth=20.0))
    bare.run_frames(2)
    bare.click("North up###north")
    assert sketch_of(bare).sketch.camera.azimuth == 180.0
    bare.click("1●###view 1")
    assert sketch_of(bare).sketch.camera.elevation == 89.0
    bare.click("2###view 2")
    assert sketch_of(bare).sketch.camera.elevation == 89.0
    assert any("empty" in notice.text for notice in bare.bench.notices.items)


def test_a_turntable_turns_the_picture_and_stops_there(open_session: OpenSession, folder: Path) -> None:
    session: Session = open_session(folder)
    session.frame((48, 32))
    assert session.plan is not None and session.sketch is not None
    before, eye = session.sketch.camera, session.plan.eye.position
    session.turn_table(True)
    session.turn(5.0)
    session.frame((48, 32))
    assert session.sketch.camera == before and session.plan.eye.position != eye
    session.turn_table(False)
    assert session.sketch.camera == replace(before, azimuth=(before.azimuth + 5.0 * TURN) % 360.0)
    turned = session.plan.eye.position
    session.frame((48, 32))
    assert session.plan.eye.position == pytest.approx(turned)


def test_the_sun_is_by_the_clock_where_daylight_is_wired(open_bare: OpenBare, folder: Path) -> None:
    names = {}
    for path in (SKETCHES / "daylight.toml", folder):
        draft = sketch_of(open_bare(path))
        names[path.name] = [item.path for item in sun_items(draft)]
    assert names["daylight.toml"] == [
        f"daylight.{name}" for name in ("hour", "day", "year", "latitude", "longitude")
    ]
    assert names[folder.name] == ["light.sun"]


def test_another_sketch_is_shown_as_it_is(open_session: OpenSession, folder: Path) -> None:
    session: Session = open_session(folder)
    session.frame((48, 32))
    session.exaggerate(3.0)
    session.view.show_as(look_of("clay", session.plan))
    session.frame((48, 32))
    (folder / "other").mkdir()
    for name, text in FILES.items():
        (folder / "other" / name).write_text(text, encoding="utf-8")
    session.open(folder / "other")
    for _ in range(3):
        session.frame((48, 32))
    assert session.path.parent.name == "other" and session.view.look is None
    assert session.plan is not None and session.plan.shown_relief == 100.0


def test_sizes_keep_proportions() -> None:
    assert (129, 65) in aspect_sizes((65, 33)) and (65, 129) in aspect_sizes((33, 65))
    assert all(wide == tall for wide, tall in aspect_sizes((100, 100)))
    assert (513, 1) in aspect_sizes((33, 1))


def test_cameras_of_a_map() -> None:
    above = from_above(Camera(azimuth=20.0, target=(1.0, 2.0, 3.0)))
    assert (above.azimuth, above.target, above.distance) == (180.0, None, 0.0)
    assert north_up(Camera(azimuth=20.0, elevation=40.0)) == Camera(azimuth=180.0, elevation=40.0)


def test_feet_are_international() -> None:
    land = Land(unit="ft")
    assert land.metres(1000.0) == 304.8 and land.shown(304.8) == pytest.approx(1000.0)
