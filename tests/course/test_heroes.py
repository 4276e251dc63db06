"""The pictures at the heads of lessons."""

from __future__ import annotations

import pytest

from playground.course.figures import hero_names, hero_of
from playground.course.library import lesson_names
from playground.course.scenes import Sketches
from playground.errors import SketchError


def test_every_lesson_has_a_picture_of_its_own_at_its_head():
    sketches, seen = Sketches(), {}
    for name in lesson_names():
        hero = hero_of(name, sketches)
        assert hero is not None, name
        assert set(hero.alt) == {"en", "fr"}
        scene = hero.scene
        key = (scene.sketch, scene.time, scene.steps)
        assert seen.setdefault(key, name) == name
    assert len(hero_names()) == len(set(hero_names()))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ('sketch = "fbm"\nalt.en = "a"', "alt in 'fr'"),
        ('sketch = "fbn"\nalt = { en = "a", fr = "b" }', "did you mean 'fbm'"),
        ('sketch = "fbm"\nwide = 1\nalt = { en = "a", fr = "b" }', "wide"),
        ('sketch = "fbm"\ncamera = { elevation = 99.0 }\nalt = { en = "a", fr = "b" }', "expected -89 to 89"),
    ],
)
def test_what_is_wrong_with_one_is_said(tmp_path, text, said):
    path = tmp_path / "heroes.toml"
    path.write_text(f"[fractals]\n{text}\n", encoding="utf-8")
    with pytest.raises(SketchError, match=said):
        hero_of("fractals", path=path)


def test_a_lesson_may_have_none():
    assert hero_of("none_of_them") is None
