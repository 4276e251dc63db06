"""The names of the parts of a divided picture: the passes that they show, and their methods."""

from __future__ import annotations

import pytest

from playground.sketch.find import find
from playground.sketch.model import Sketch
from playground.sketch.replace_technique import with_technique
from playground.studio.picture.panel import PictureRegion, parts_of

from ..loading import load


def sketch_of(name: str) -> Sketch:
    return load(find(name))


def test_three_methods_of_light_are_named_between_their_lines() -> None:
    sketch = sketch_of("lighting_methods")
    parts = parts_of(sketch)
    assert [part.name for part in parts] == ["Difference", "Product", "Ray"]
    titles = [sketch.graph.find(name).technique.title for name in ("difference", "product", "ray")]  # type: ignore[union-attr]
    assert [part.method for part in parts] == titles
    assert (parts[0].start, parts[-1].end) == (0.0, 1.0)
    assert parts[0].end == parts[1].start == pytest.approx(0.3333)
    assert parts[1].end == parts[2].start == pytest.approx(0.6667)


def test_equally_filtered_parts_are_named_by_filter_input() -> None:
    parts = parts_of(sketch_of("lighting_ray_cone"))
    assert [part.name for part in parts] == ["Ray filtered", "Cone filtered"]
    assert [part.method for part in parts] == ["Ray cast", "Soft shadows by a cone"]


def test_what_both_parts_share_is_not_named() -> None:
    names = [(part.name, part.method) for part in parts_of(sketch_of("variants"))]
    assert names == [
        ("By height", "Grass, rock and snow by height"),
        ("Splatted", "Texture splatting, four layers baked"),
    ]


def test_lines_that_cross_leave_nothing_between_them() -> None:
    sketch = sketch_of("lighting_methods").with_values({"view.first": 0.8, "view.second": 0.2})
    assert [(p.start, p.end) for p in parts_of(sketch)] == [(0.0, 0.8), (0.8, 0.8), (0.8, 1.0)]


def test_a_difference_is_one_picture_of_both() -> None:
    sketch = sketch_of("interreflection").with_values({"view.mode": "difference"})
    assert parts_of(sketch) == [PictureRegion(0.0, 1.0, "Cone against Thrown", "")]


def test_another_technique_in_a_pass_is_named_at_once() -> None:
    sketch = with_technique(sketch_of("interreflection"), "cone", "lighting/soft_cylinder")
    assert parts_of(sketch)[0].method == "Soft shadows by a cylinder"


@pytest.mark.parametrize("name", ["mixed", "profile", "lighting_hill", "night"])
def test_other_pictures_have_no_parts(name: str) -> None:
    assert parts_of(sketch_of(name)) == []
