"""Menus that have another choice in previews: only of what runs anyway, and never at rest."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.textures import read_picture
from playground.sketch.assign import values_of
from playground.studio.compare.compare import Compare
from playground.studio.picture.preview import as_preview
from playground.studio.session import Session

from ..loading import load

SIZE = (160, 90)
SKETCH = """format = 1
size = 65
extent = 640
relief = 200
[[pass]]
name = "height"
use = "generation/diamond_square"
[[pass]]
name = "light"
use = "lighting/ray_cast"
[view]
use = "view/terrain"
"""
FORM = "light.visibility.form"
LOW = (120.0, 6.0)  # a sun with long shadows


@pytest.fixture
def path(tmp_path: Path) -> Path:
    (tmp_path / "shadow.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path / "shadow.toml"


@pytest.fixture
def session(path: Path, any_engine: Engine, monkeypatch) -> Iterator[Session]:
    monkeypatch.setattr(ContextInfo, "software", True)
    with Engine(any_engine.ctx) as engine:
        result = Session(engine, path)
        result.clock.playing = False
        result.frame(SIZE)
        result.read()
        yield result
        result.release()


@pytest.fixture
def compute(any_engine: Engine) -> None:
    if not any_engine.info.compute:
        pytest.skip("this context has no compute shaders")


def form(session: Session) -> object:
    """Return the form by which the last picture's shadow was made."""
    assert session.plan is not None
    return next(
        step.values["form"]
        for step in session.plan.walk()
        if step.path.startswith("light.visibility") and "form" in step.values
    )


def shadow_runs(session: Session) -> int:
    """Return how often the pass that makes the shadow has run, in either form."""
    names = ("light.visibility", "light.visibility.fast.visibility")
    return sum(session.engine.runs[name] for name in names)


def test_only_passes_that_are_named_have_it(path: Path):
    sketch = load(path)
    assert values_of(as_preview(sketch))[FORM] == 0
    assert values_of(as_preview(sketch, faster={"light.light", "height"}))[FORM] == 0
    assert values_of(as_preview(sketch, faster={"light.visibility"}))[FORM] == 1


@pytest.mark.parametrize("of_the_group", [{"light.step_length": 2.0}, {"light.sampling": "cut down"}])
def test_not_while_something_of_its_group_is_set(path: Path, of_the_group: dict[str, object]):
    sketch = load(path).with_values(of_the_group)
    assert values_of(as_preview(sketch, faster={"light.visibility"}))[FORM] == 0


def test_it_alone_makes_a_preview(path: Path):
    sketch = load(path).with_picture(samples=1).with_values({"view.grid": 20})
    assert as_preview(sketch) is sketch
    chosen = as_preview(sketch, faster={"light.visibility"})
    assert values_of(chosen) == values_of(sketch) | {FORM: 1}


@pytest.mark.usefixtures("compute")
def test_a_dragged_sun_sweeps_and_one_at_rest_marches(session: Session, any_engine: Engine):
    sketch = load(session.path).with_values({"light.sun": (200.0, 20.0)})
    full = any_engine.render(sketch, size=SIZE).array
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    assert session.error is None and session.is_preview and form(session) == 1
    before = shadow_runs(session)
    session.drafts.set_camera(replace(session.sketch.camera, azimuth=31.0))
    session.frame(SIZE)
    assert form(session) == 1 and shadow_runs(session) == before, "nothing of the shadow has changed"
    session.drafts.set_camera(None)
    np.testing.assert_array_equal(session.read().array, full)
    assert form(session) == 0 and not session.is_preview


def test_a_camera_that_moves_leaves_the_shadow_as_it_is(session: Session):
    before = shadow_runs(session)
    for azimuth in (10.0, 11.0, 12.0):
        session.drafts.set_camera(replace(session.sketch.camera, azimuth=azimuth))
        session.frame(SIZE)
        assert session.is_preview and form(session) == 0
    assert shadow_runs(session) == before


def test_resting_preview_runs_nothing_until_full_draw(session: Session):
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    before = dict(session.engine.runs)
    session.frame(SIZE)
    assert session.engine.runs == before


@pytest.mark.usefixtures("compute")
def test_what_it_is_compared_with_has_the_same_form(session: Session, any_engine: Engine):
    """A sweeps while B does, so that the two differ by what was changed alone; at rest both march."""
    compare = Compare(session)

    def follow() -> NDArray[np.uint8]:
        picture = session.picture.texture
        assert picture is not None
        compare.follow(picture)
        assert compare.picture is not None
        return read_picture(compare.picture)

    session.drafts.set("light.sun", LOW)
    session.frame(SIZE)
    session.read()
    compare.keep()
    full = follow()
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    seen, sketch = follow(), load(session.path).with_values({"light.sun": LOW})
    assert form(session) == 1 and session.picture.drawn_size == SIZE
    swept = as_preview(sketch, faster={"light.visibility"})
    np.testing.assert_array_equal(seen, any_engine.render(swept, size=SIZE).array)
    assert (seen != any_engine.render(as_preview(sketch), size=SIZE).array).any()
    session.drafts.set("light.sun", (201.0, 20.0))
    session.frame(SIZE)
    follow()
    assert compare.draws == 1, "A has that form already"
    session.read()
    np.testing.assert_array_equal(follow(), full)
    compare.release()


def test_without_compute_shaders_it_marches(session: Session, monkeypatch):
    monkeypatch.setattr(ContextInfo, "compute", False)
    session.drafts.set("light.sun", (200.0, 20.0))
    session.frame(SIZE)
    assert session.is_preview and form(session) == 0


def test_a_save_shows_what_is_written(session: Session, path: Path):
    """Somebody who edits the march looks at it."""
    path.write_text(SKETCH.replace("relief = 200", "relief = 260"), encoding="utf-8")
    session.drafts.reload([path])
    session.frame(SIZE)
    assert session.plan is not None and session.plan.terrain.relief == 260.0
    assert form(session) == 0


@pytest.mark.usefixtures("compute")
@pytest.mark.parametrize("use", ["ray_cast", "soft_cone", "sun_disc"])
def test_the_sweep_of_a_preview_jumps_no_more_than_stated(tmp_path: Path, any_engine: Engine, use: str):
    """lighting/sun_sweep: of hard shadows 0.6 % of the texels at most, of soft ones 0.006 on average."""
    text = SKETCH.replace("ray_cast", use).replace("size = 65", "size = 257")
    (tmp_path / "soft.toml").write_text(text, encoding="utf-8")
    sketch = load(tmp_path / "soft.toml").with_values({"light.sun": (200.0, 15.0)})
    result = [
        any_engine.read(each, "light.visibility")
        for each in (sketch, as_preview(sketch, faster={"light.visibility"}))
    ]
    far = np.abs(result[0] - result[1])
    assert far.any() and far.mean() <= 0.006
