"""A button of the panel is true for one frame; a point's pad goes over its own ranges."""

from __future__ import annotations

import pytest

from playground.studio.panel.values import value_fraction, with_fraction
from playground.studio.remote.controls import Controls

from .panel_desk import Bare

FILES = {
    "sketch.toml": """format = 1
[[pass]]
name = "a"
use = "./a"
size = 2
[view]
use = "view/map"
inputs = { shown = "a" }
""",
    "a.glsl": """#pragma kernel(output = "colour:rgba32f")
uniform vec2 place = vec2(0.0, 3.0);  //! point(-1, 1, 2, 4)
uniform bool go;            //! button
vec4 kernel(ivec2 texel) { return vec4(place, go ? 1.0 : 0.0, 1.0); }
""",
}


def test_a_press_is_seen_by_one_frame_and_changes_no_value(bare: Bare) -> None:
    pressed: list[bool] = []
    bare.session.engine.runner.before_step = lambda step: (
        pressed.append(bool(bare.session.engine.runner.pressed)) if step.path == "a" else None
    )
    bare.run_frames(3)
    label = next(label for label in bare.places if label.startswith("Go"))
    bare.click(label)
    assert pressed == [True]  # the frame after it is known from before
    values = bare.session.read_values("a")
    assert values is not None and values[0, 0, 2] == 0.0
    draft = bare.session.shown
    assert draft is not None and not draft.edits.values


def test_a_point_is_dragged_over_its_own_ranges(bare: Bare) -> None:
    label = next(label for label in bare.places if "place" in label and label + "-x" in bare.places)
    bare.point(label, 0.75)
    bare.press(True)
    bare.run_frames()
    bare.press(False)
    draft = bare.session.shown
    (result,) = (value for path, value in draft.edits.values if path == "a.place")
    assert result == (pytest.approx(0.5, abs=0.05), pytest.approx(3.0, abs=0.05))


def test_a_remote_presses_it_for_one_frame_and_sets_the_rest(bare: Bare) -> None:
    runner, pressed = bare.session.engine.runner, list[bool]()
    runner.before_step = lambda step: pressed.append(bool(runner.pressed)) if step.path == "a" else None
    controls = Controls(bare.bench)
    controls.do({"set": {"a.go": True, "a.place": [0.5, 2.5]}})
    controls.flush()
    bare.run_frames(2)
    assert pressed == [True, False]
    draft = bare.session.shown
    assert draft is not None and dict(draft.edits.values) == {"a.place": (0.5, 2.5)}
    controls.do({"set": {"a.go": False}})
    controls.flush()
    bare.run_frames(2)
    assert pressed == [True, False]


def test_a_knob_goes_over_each_range_of_a_point(bare: Bare) -> None:
    sketch = bare.session.sketch
    parameter = next(p for p in sketch.graph.passes[0].technique.parameters if p.name == "place")
    assert with_fraction(parameter, (0.0, 3.0), 0.25, 0) == (-0.5, 3.0)  # type: ignore[arg-type]
    assert with_fraction(parameter, (0.0, 3.0), 0.25, 1) == (0.0, 2.5)  # type: ignore[arg-type]
    assert value_fraction(parameter, (0.0, 3.5), 1) == pytest.approx(0.75)  # type: ignore[arg-type]
