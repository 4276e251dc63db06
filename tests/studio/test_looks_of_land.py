"""Looks of a terrain: each draws any heights, by map or not, and leaves the sketch and its file alone."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.sketch.assign import find_targets
from playground.sketch.keyframes import Keyframe
from playground.sketch.load import load
from playground.sketch.map_sketch import Map
from playground.sketch.model import Preset, Shot
from playground.studio.land.looks import LOOKS, Look, interval_for, look_of, look_title
from playground.studio.session import Session

from ..sketch_texts import SMALL_VIEW, map_of, passes
from .session_desk import OpenSession

HEAD = "format = 1\nsize = 17\nextent = 160.0\nrelief = 160.0\n"
FILES = {
    # Level, then a slope of 45 degrees to the east.
    "step.glsl": """#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return max(float(texel.x - 8), 0.0) / 16.0; }
""",
    "land.toml": HEAD + passes(height="./step") + SMALL_VIEW,
    "map.toml": HEAD + passes(height="./step", light="lighting/l_dot_n") + map_of("light"),
}


@pytest.mark.parametrize("file", ["land.toml", "map.toml"])
def test_every_look_draws_and_none_changes_the_sketch(
    open_session: OpenSession, folder: Path, file: str
) -> None:
    session: Session = open_session(folder / file)
    session.frame((48, 32))
    before, pictures = session.sketch, set()
    plan = session.plan
    for name in LOOKS:
        session.view.show_as(look_of(name, plan))
        session.frame((48, 32))
        assert session.error is None and not session.notes, name
        frame = session.read()
        assert frame is not None
        pictures.add(frame.array.tobytes())
    assert len(pictures) == len(LOOKS) and session.sketch is before
    assert (folder / file).read_text(encoding="utf-8") == FILES[file]


@pytest.mark.parametrize("seen", [Look("clay", "height:height"), Map("height:height"), Map("view:picture")])
def test_what_a_sketch_says_of_its_view_goes_with_the_view(seen: Look | Map) -> None:
    """In presets, shots, keyframes and the main parameters as well: a page names them all."""
    said = (("height.level", 0.5), ("view.haze", 0.25))
    sketch = replace(
        load("l_dot_n").with_values({"view.haze": 0.25}),
        presets=(Preset("far", said),),
        shots=(Shot("far", values=said),),
        keyframes=(Keyframe(0.0, values=said),),
        main=("height.level", "view.haze"),
    )
    shown = seen.of(sketch)
    groups = [shown.presets[0].values, shown.shots[0].values, shown.keyframes[0].values]
    within = "view.seen.haze" if isinstance(seen, Map) and seen.ref.startswith("view") else ""
    assert groups == [(said[0], (within, 0.25)) if within else (said[0],)] * 3
    assert shown.main == tuple(filter(None, ("height.level", within)))
    assert dict(shown.overrides) == ({within: 0.25} if within else {})
    for path, _ in shown.overrides:
        assert find_targets(shown.graph, path)


def test_slopes_are_coloured_by_true_degrees(open_session: OpenSession, folder: Path) -> None:
    session: Session = open_session(folder / "land.toml")
    session.frame((48, 32))
    look = look_of("slope", session.plan)
    assert look is not None and session.sketch is not None
    seen = look.of(session.sketch)
    steep = session.engine.read(seen, "view.steepness:cover")
    assert steep[8, 2] == 0.0 and steep[8, 14] == pytest.approx(1.0, abs=1e-3), "level, and 45 degrees"
    session.exaggerate(0.5)
    assert np.array_equal(session.engine.read(seen, "view.steepness:cover"), steep)


def test_the_same_graph_in_the_same_look_stays_the_same(open_session: OpenSession, folder: Path) -> None:
    session: Session = open_session(folder / "land.toml")
    session.frame((48, 32))
    look = look_of("clay", session.plan)
    assert look is not None and session.sketch is not None
    assert look.of(session.sketch).graph is look.of(session.sketch).graph


def test_a_look_has_a_sun_of_its_own_that_moves_its_light_alone(
    open_session: OpenSession, folder: Path
) -> None:
    session: Session = open_session(folder / "map.toml")
    session.frame((48, 32))
    look, sketch = look_of("hypsometric", session.plan), session.sketch
    slope = look_of("slope", session.plan)
    assert look is not None and slope is not None and sketch is not None
    sun = look.sun()
    assert sun is not None and sun[1] == (315.0, 45.0) and slope.sun() is None
    turned = look.with_sun((135.0, 45.0))
    assert turned.sun() == (sun[0], (135.0, 45.0))
    seen = [one.of(sketch) for one in (look, turned)]
    lights = [session.engine.read(one, "view.sunlight:light")[8, 14, 0] for one in seen]
    assert lights[0] > lights[1], "the slope faces west"
    session.view.show_as(look)
    session.move_suns(0.25, 0.0)
    assert session.view.look is not None and session.view.look.sun() == (sun[0], (0.0, 45.0))
    assert session.sketch is sketch


@pytest.mark.parametrize(("relief", "interval"), [(840.0, 50.0), (100.0, 5.0), (9000.0, 500.0), (26.0, 2.0)])
def test_contour_intervals_are_round(relief: float, interval: float) -> None:
    assert interval_for(relief) == pytest.approx(interval)
    assert 10 <= relief / interval_for(relief) <= 25


def test_each_look_has_a_title() -> None:
    assert len({look_title(name) for name in LOOKS}) == len(LOOKS)
