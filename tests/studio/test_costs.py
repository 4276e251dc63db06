"""What the pictures cost: what is recorded of them, and that nothing is timed while they are hidden."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui, implot

from playground.engine.cache_keys import Keys, StepKey
from playground.engine.engine import Engine
from playground.engine.execution import FrameRecord
from playground.studio.cost.costs import Record, RunReasons

from ..variants import trust
from .panel_desk import Bare

TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level; }
"""
MESH = """// mesh.glsl -- two triangles for each of a grid's squares
#pragma draw(mesh = "grid", output = "frame:rgba8")
uniform int grid = 5; //! slider(2, 64) Vertices a side
uniform sampler2D height; //! input
vec4 vertex(vec3 corner) { return vec4(corner.xy, texelFetch(height, ivec2(0), 0).r, 1.0); }
vec4 fragment() { return vec4(1.0); }
"""
SKETCH = """format = 1
size = [33, 17]
[[pass]]
name = "height"
use = "./terrain"
[view]
use = "./mesh"
"""


@pytest.fixture
def bare(tmp_path: Path, any_engine: Engine) -> Iterator[Bare]:
    for name, text in {"terrain.glsl": TERRAIN, "mesh.glsl": MESH, "sketch.toml": SKETCH}.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    made = Bare(any_engine, tmp_path, (1280, 1400))
    yield made
    made.close()


def test_a_record_keeps_the_last_numbers_in_order() -> None:
    record = Record(4)
    for n in range(11):
        record.add({"a": n}, n, n)
        for numbers in (record.passes["a"], record.whole, record.texels, record.triangles):
            assert list(numbers) == list(range(max(0, n - 3), n + 1))


def test_a_record_keeps_its_rows_in_step() -> None:
    record = Record(3)
    record.add({"a": 1.0}, 10, 2)
    record.add({"a": 2.0, "b": 5.0}, 20, 0)
    assert list(record.passes["b"]) == [0.0, 5.0]
    assert list(record.whole) == [1.0, 7.0]
    assert record.most_expensive(1) == ["b"]
    for _ in range(3):
        record.add({"b": 1.0}, 0, 0)
    assert list(record.passes) == ["b"]  # what cost nothing for so long is gone
    assert list(record.texels) == [0.0, 0.0, 0.0]


def test_nothing_is_timed_before_it_is_looked_at(bare: Bare) -> None:
    bare.session.drafts.set("height.level", 0.25)
    bare.run_frames(3)
    assert (
        not bare.session.engine.options.profiling
        and not bare.session.times
        and not bare.bench.inspection.record.pictures
    )


def test_each_frame_is_recorded_while_the_costs_are_shown(bare: Bare) -> None:
    engine, record = bare.session.engine, bare.bench.inspection.record
    bare.click("Cost###costs")
    assert engine.options.profiling
    before = record.pictures
    for n in range(5):
        bare.session.drafts.set("height.level", 0.1 * n)
        bare.run_frames()
    bare.run_frames(4)
    assert record.pictures == before + 5  # a frame without a picture is none
    assert record.texels[-1] == 33 * 17 + 48 * 32
    assert record.triangles[-1] == engine.record.triangles == _triangles(engine, 5)
    assert set(record.passes) == {"height", "view"} and record.whole[-1] > 0
    assert np.isclose(record.whole, np.sum(list(record.passes.values()), axis=0)).all()
    assert implot.get_current_context() is not None
    bare.session.drafts.set("view.grid", 9)
    bare.run_frames(2)
    assert record.texels[-1] == 48 * 32  # the terrain was not computed again
    assert record.triangles[-1] == _triangles(engine, 9)
    assert record.passes["height"][-1] == 0
    bare.click("Cost###costs")
    assert not engine.options.profiling and record.pictures == 0 and not bare.session.times


def test_it_is_not_timed_while_the_panel_is_away(bare: Bare) -> None:
    bare.click("Cost###costs")
    assert bare.session.engine.options.profiling
    bare.bench.inspection.begin()  # a frame in which no panel is drawn
    bare.bench.inspection.update()
    assert not bare.session.engine.options.profiling


def test_programs_are_listed_with_what_they_took(bare: Bare) -> None:
    times = bare.session.engine.runner.compile_times
    assert {Path(path).name for path in times} == {"terrain.glsl", "mesh.glsl"} and min(times.values()) > 0
    bare.click("Cost###costs")
    bare.run_frames(2)
    assert any(label.endswith("###compiling") for label in bare.places)


def _triangles(engine: Engine, side: int) -> int:
    """Return what a grid has: its squares, and its skirt's, as its mesh is built."""
    from playground.engine.meshes import build_mesh

    return build_mesh("grid", (("grid", side),)).indices.size // 3


FAST = 'agrees = "exact"\n[[pass]]\nname = "height"\nuse = "./twin"\n[parameters]\nlevel = "height.level"\n'


def test_cost_switch_runs_canonical_form_and_shows_if_one_exists(bare: Bare, tmp_path: Path) -> None:
    bare.click("Cost###costs")
    bare.run_frames(2)
    assert "Plain form" not in bare.places
    (tmp_path / "twin.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "terrain.fast.toml").write_text(FAST, encoding="utf-8")
    trust(tmp_path)
    bare.session.drafts.reload()
    bare.run_frames(4)
    for plain in (True, False):
        bare.click("Plain form")
        bare.run_frames(3)
        assert bare.session.drafts.plain == plain and bare.session.plan is not None
        assert (bare.session.plan.step("height") is not None) == plain
        assert (bare.session.plan.step("height.fast.height") is None) == plain


def test_a_row_says_why_its_pass_ran_last(bare: Bare, monkeypatch: pytest.MonkeyPatch) -> None:
    reasons = bare.bench.inspection.reasons
    bare.session.drafts.set("height.level", 0.25)
    bare.run_frames(2)
    assert reasons.text("height") == "Last ran: value level"
    bare.click("Cost###costs")
    bare.session.drafts.set("height.level", 0.75)
    bare.run_frames(2)
    assert reasons.text("height") == "Last ran: value level"
    assert reasons.text("view") == "Last ran: input height"
    bare.session.drafts.set("view.grid", 9)
    bare.run_frames(2)
    assert reasons.text("height") == "Last ran: value level"  # it did not run for the last picture
    assert reasons.text("view") == "Last ran: value grid"
    tooltips: list[str] = []
    monkeypatch.setattr(imgui, "set_item_tooltip", tooltips.append)
    bare.run_frames()
    assert {"Last ran: value level", "Last ran: value grid"} <= set(tooltips)
    monkeypatch.setattr(imgui, "set_tooltip", tooltips.append)
    bare.point("View###pass")
    assert any("\nLast ran: value grid\n" in text for text in tooltips)


def test_of_what_is_inside_a_technique_each_has_a_line() -> None:
    inner = {f"light.{n}": StepKey("", "", "", "", (("value", n),)) for n in "abcdefgh"}
    reasons = RunReasons()
    reasons.add(FrameRecord(keys=Keys(inner), ran=[*inner, *inner]))
    assert reasons.text("light.b") == "Last ran: the pass"
    assert reasons.text("light").split("\n") == [
        *(f"{n} last ran: the pass" for n in "abcdef"),
        "and 2 more",
    ]
    assert reasons.text("lig") == ""
    reasons.add(FrameRecord(keys=Keys({"view": inner["light.a"]}), ran=["view"]))
    assert reasons.text("light") == ""  # it is in the sketch no more
