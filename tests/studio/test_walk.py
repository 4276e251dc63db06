"""A walk on the terrain: the eye 1.7 m over the bilinear ground, an ordinary camera, one step of undo."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine import textures
from playground.engine.camera import look
from playground.sketch.load import load
from playground.studio.land import walk as walking
from playground.studio.land.land import keep_view, recall_view
from playground.studio.land.walk import EYE_HEIGHT, FASTEST, SLOWEST, Walk, Walker, standing_height
from playground.studio.session import Session

from ..sketch_texts import SMALL_VIEW, map_of, passes
from ..truth.land import Land
from .panel_desk import Bare
from .session_desk import OpenSession

EXTENT, RELIEF = (640.0, 320.0), 100.0
KERNEL = """#pragma kernel(output = "height:r32f")
uniform float rough = 1.0; //! slider(0, 2)
float kernel(ivec2 texel) { return rough * fract(dot(vec2(texel), vec2(0.377, 0.731))); }
"""
HEAD = "format = 1\nsize = [33, 17]\nextent = [640.0, 320.0]\nrelief = 100.0\n"
FILES = {
    "hills.glsl": KERNEL,
    "sketch.toml": HEAD + passes(height="./hills") + SMALL_VIEW,
    "map.toml": HEAD + passes(height="./hills") + map_of("height"),
}


def begun(session: Session) -> Walk:
    assert session.frame((48, 32)) is not None, session.error
    walk = Walk(session)
    walk.begin()
    assert walk.on, session.notes
    return walk


def eye_of(session: Session) -> tuple[float, float, float]:
    """Return where the picture was drawn from [m]."""
    session.frame((48, 32))
    assert session.plan is not None and session.error is None
    return session.plan.eye.position


def ground(session: Session, east: float, north: float, factor: float = 1.0) -> float:
    """Return the ground [m] in float64, from the heights that are drawn: the top of all between four texels.

    Weights of the four that meet at a place differ from the bilinear ones by t (1, -1, -1, 1), as far as none
    falls below 0.
    """
    heights = session.read_values("height:height")
    assert heights is not None
    land = Land(heights.astype(np.float64), (20.0, 20.0))
    x, y = east / 20.0, north / 20.0
    i, j = min(int(x), 31), min(int(y), 15)
    u, v = x - i, y - j
    twist = land.heights[j, i] - land.heights[j, i + 1] - land.heights[j + 1, i] + land.heights[j + 1, i + 1]
    most, least = min(u * (1 - v), (1 - u) * v), -min((1 - u) * (1 - v), u * v)
    return (float(land.at(x, y)) + max(twist * most, twist * least)) * RELIEF * factor


@pytest.mark.parametrize("place", [(3.0, 5.0), (10.0, 10.0), (639.9, 319.9), (640.0, 320.0), (127.3, 311.2)])
def test_one_stands_on_the_bilinear_ground_where_it_is_smooth(place: tuple[float, float]) -> None:
    rise = np.add.outer(np.arange(17) * 2.0, np.arange(33) * 3.0)
    land = Land(rise, (20.0, 20.0))
    expected = land.at(place[0] / 20.0, place[1] / 20.0)
    assert standing_height(rise, EXTENT, *place) == pytest.approx(float(expected), abs=1e-12)


@pytest.mark.parametrize("factor", [1.0, 2.5])
def test_the_eye_is_over_the_ground_wherever_one_walks(
    open_session: OpenSession, folder: Path, factor: float
) -> None:
    session: Session = open_session(folder)
    session.exaggerate(factor)
    walk = begun(session)
    walk.speed = 40.0
    for way in ((0.0, 1.0), (1.0, 0.0), (1.0, -1.0), (-1.0, 0.0)):
        walk.head(*way)
        for _ in range(4):
            before = walk.walker
            walk.advance(0.25)
            east, north, up = eye_of(session)
            assert walk.walker is not None and before is not None
            assert (east, north) == pytest.approx((walk.walker.east, walk.walker.north), abs=0.02)
            assert up == pytest.approx(ground(session, east, north, factor) + EYE_HEIGHT, abs=0.06 * factor)
            far = math.hypot(walk.walker.east - before.east, walk.walker.north - before.north)
            assert far == pytest.approx(10.0, abs=1e-9)
    walk.look(0.1, -0.3)
    east, north, up = eye_of(session)
    assert up == pytest.approx(ground(session, east, north, factor) + EYE_HEIGHT, abs=0.06 * factor)


def test_it_begins_at_the_ground_in_the_middle_of_the_picture(
    open_session: OpenSession, folder: Path
) -> None:
    session: Session = open_session(folder)
    session.frame((48, 32))
    assert session.plan is not None
    eye = session.plan.eye
    walk = begun(session)
    assert walk.walker is not None
    east, north = walk.walker.east, walk.walker.north
    heights = session.read_values("height:height")
    assert heights is not None
    up = float(Land(heights.astype(np.float64), (20.0, 20.0)).at(east / 20.0, north / 20.0)) * RELIEF
    clip = eye.clip_from_world @ [east, north, up, 1.0]
    assert clip[:2] / clip[3] == pytest.approx([0.0, 0.0], abs=0.02)
    ahead = [b - a for a, b in zip(eye.position[:2], (east, north), strict=True)]
    assert walk.walker.heading % 360 == pytest.approx(math.degrees(math.atan2(*ahead)) % 360, abs=0.1)


def test_nobody_walks_off_the_land() -> None:
    walker = Walker(600.0, 300.0, 45.0)
    assert walker.moved(0.0, 1e4, EXTENT) == Walker(640.0, 320.0, 45.0)
    assert walker.moved(0.0, -1e4, EXTENT) == Walker(0.0, 0.0, 45.0)
    right = walker.moved(10.0, 0.0, EXTENT)
    assert (right.east - 600.0, right.north - 300.0) == pytest.approx((7.0711, -7.0711), abs=1e-3)
    assert walker.turned(-90.0, 200.0) == Walker(600.0, 300.0, 315.0, 85.0)


def test_a_walk_reads_the_heights_once_for_each_version(
    open_session: OpenSession, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reads = []
    monkeypatch.setattr(
        walking, "read_texels", lambda *given: reads.append(given) or textures.read_texels(*given)
    )
    session: Session = open_session(folder)
    walk = begun(session)
    walk.head(0.0, 1.0)
    for _ in range(5):
        walk.advance(0.1)
        session.frame((48, 32))
    assert len(reads) == 1
    session.drafts.set("height.rough", 0.2)
    session.frame((48, 32))
    walk.head(0.0, 0.0)
    walk.advance(0.1)
    assert len(reads) == 2 and walk.on
    east, north, up = eye_of(session)
    assert up == pytest.approx(ground(session, east, north) + EYE_HEIGHT, abs=0.06)


def test_a_camera_of_ones_own_ends_it_and_a_view_keeps_it(open_session: OpenSession, folder: Path) -> None:
    session: Session = open_session(folder)
    walk = begun(session)
    assert session.sketch is not None
    keep_view(session, 3)
    kept = session.sketch.camera
    session.drafts.set_camera(None)
    walk.advance(0.1)
    assert not walk.on and session.sketch.camera == load(session.path).camera
    assert recall_view(session, 3) and session.sketch.camera == kept


def test_another_render_shows_the_same_picture(open_session: OpenSession, folder: Path) -> None:
    session: Session = open_session(folder)
    begun(session)
    east, north, up = eye_of(session)
    assert session.sketch is not None
    alone = look(session.sketch.camera, EXTENT, RELIEF, (48, 32))
    assert alone.position == pytest.approx((east, north, up), abs=1e-3)


def test_a_map_has_no_ground_to_walk_on(open_session: OpenSession, folder: Path) -> None:
    session: Session = open_session(folder / "map.toml")
    session.frame((48, 32))
    walk = Walk(session)
    walk.toggle()
    assert not walk.on and "no terrain" in session.notes[-1]


def test_speed_has_bounds(open_session: OpenSession, folder: Path) -> None:
    walk = begun(open_session(folder))
    walk.hurry(-100.0)
    assert walk.speed == SLOWEST
    walk.hurry(100.0)
    assert walk.speed == FASTEST


def test_keys_are_the_walks_until_esc_and_undo_takes_it_back(bare: Bare) -> None:
    bench, session = bare.bench, bare.session
    bare.run_frames(3)
    bare.click("Terrain###terrain")
    assert session.sketch is not None and session.shown is not None
    before = session.sketch.camera
    bare.key(imgui.Key.w)
    assert bench.walk.on
    bare.key(imgui.Key.s)
    bare.key(imgui.Key.a)
    assert bench.actions.saved_picture is None and not bench.inspection.compare.on
    io = imgui.get_io()
    io.add_key_event(imgui.Key.w, True)
    bare.run_frames(1)
    assert bench.walk.moves
    for _ in range(3):
        bench.walk.advance(0.2)
        bare.run_frames(1)
    io.add_key_event(imgui.Key.w, False)
    bare.run_frames(2)
    assert not bench.walk.moves
    bare.key(imgui.Key.escape)
    assert not bench.walk.on
    bare.run_frames(2)
    assert session.sketch.camera != before
    assert dict(session.shown.edits.values) == {"view.detail": 2}, "a vertex for each texel"
    bench.undo.undo()
    assert session.sketch.camera == before and not session.shown.edits.values
