"""A line that parts a picture, taken hold of with the mouse and moved."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.paths import GLSL
from playground.studio.picture.gestures import GRAB_DISTANCE, divider_at, divider_position, dividers_of

from ..loading import load

METHODS = GLSL / "sketches" / "lighting_methods.toml"  # three pictures, two lines


def test_the_lines_are_those_of_the_view() -> None:
    dividers = dividers_of(load(METHODS))
    assert dividers == {"view.first": pytest.approx(0.3333), "view.second": pytest.approx(0.6667)}
    moved_one = load(METHODS).with_values({"view.second": 0.9})
    assert dividers_of(moved_one)["view.second"] == pytest.approx(0.9)


@pytest.mark.parametrize(
    ("across", "path"),
    [
        (333.3, "view.first"),
        (333.3 - GRAB_DISTANCE + 0.1, "view.first"),
        (666.7 + GRAB_DISTANCE - 0.1, "view.second"),
        (333.3 + GRAB_DISTANCE + 0.2, ""),
        (0.0, ""),
    ],
)
def test_the_nearest_within_grab_distance_is_taken(across: float, path: str) -> None:
    assert divider_at(load(METHODS), across, 1000.0) == path


def test_a_sketch_without_any_has_none() -> None:
    assert divider_at(load(GLSL / "sketches" / "jacksboro.toml"), 0.0, 1000.0) == ""


def test_a_line_stays_in_the_picture() -> None:
    assert [divider_position(x, 200.0) for x in (-20.0, 0.0, 50.0, 400.0)] == [0.0, 0.0, 0.25, 1.0]


def test_its_value_is_a_share(tmp_path: Path) -> None:
    kernel = tmp_path / "parted.glsl"
    kernel.write_text(
        '#pragma kernel(output = "frame:rgba8")\n'
        "uniform float line = 0.5;  //! divider Where it is\n"
        "vec4 kernel(ivec2 texel) { return vec4(line); }\n"
    )
    sketch = load(kernel)
    [path] = dividers_of(sketch)
    assert dividers_of(sketch.with_values({path: 0.25})) == {path: 0.25}
    with pytest.raises(Exception, match="outside its range 0 to 1"):
        sketch.with_values({path: 1.5})
