"""A button of the panel is true for one frame; a point's pad goes over its own ranges."""

from __future__ import annotations

import pytest

from .desk import Bare

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
    assert draft is not None
    (found,) = (value for path, value in draft.edits.values if path == "a.place")
    assert found == (pytest.approx(0.5, abs=0.05), pytest.approx(3.0, abs=0.05))
